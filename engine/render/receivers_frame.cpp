#include "render/receivers_frame.hpp"

namespace lucerna {

namespace {

LpvReceivers::Light receivedLight(Component component) {
  using Light = LpvReceivers::Light;
  return component == Component::direct     ? Light::direct
         : component == Component::indirect ? Light::indirect
                                            : Light::all;
}

std::optional<LightMaps> lightMaps(const FrameParts& parts) {
  if (!ReceiversFrame::takesMaps(parts.settings, parts.needs)) return {};
  return std::optional<LightMaps>(std::in_place, parts, LightMaps::Lights{true, true}, false);
}

}  // namespace

bool ReceiversFrame::isNeeded(const RenderSettings& settings, const SceneNeeds& needs) {
  return settings.technique == Technique::lpv && settings.lpv.transport != LpvTransport::propagate &&
         LpvReceivers::isNeeded(needs, settings.lpv, receivedLight(settings.component));
}

ReceiversFrame::ReceiversFrame(const FrameParts& parts, const gl::Texture& depth)
    : parts_(parts),
      maps_(lightMaps(parts)),
      visible_(parts.programs, parts.drawn, depth),
      receivers_(parts.programs, parts.context.capabilities(), parts.scene, parts.origin, parts.settings.lpv,
                 receivedLight(parts.settings.component)) {}

void ReceiversFrame::resize(const gl::Texture& depth) {
  visible_.resize(depth);
  clip_ = glm::dmat4(0.0);  // other pixels of the same view see other points
}

bool ReceiversFrame::record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort) {
  receivers_.collect();
  const Camera& volume = view.volumeCamera;
  const bool sameView =
      view.clip == clip_ && volume.position == volumePosition_ && volume.direction == volumeDirection_;
  if (!sameView) {
    clip_ = view.clip;
    volumePosition_ = volume.position;
    volumeDirection_ = volume.direction;
    since_ = receivers_.frame() + 1;
  }
  const LpvReceivers::Counts& counts = receivers_.counts();
  settled_ = sameView && counts.frame >= since_ && counts.waiting == 0;
  if (settled_ && parts_.settings.reuse) return false;
  const bool mapsAreNew = hasMaps() ? maps_->willBeDrawn() : !parts_.settings.reuse;
  const std::vector<ReflectiveShadowMap::Outputs> none;
  const std::vector<ReflectiveShadowMap::Outputs>& maps = maps_ ? maps_->record(timer) : none;
  {
    const gl::TimeQuery::Scope stage(timer, "geometry");
    visible_.record(parts_.drawn, view.drawn());
  }
  const gl::TimeQuery::Scope stage(timer, "receivers");
  const LpvSettings& lpv = parts_.settings.lpv;
  const int rounds = effort.wholePicture ? (lpv.samples + lpv.rays - 1) / lpv.rays : 1;
  const glm::dvec2 size(visible_.size());
  receivers_.update({placeReceiverCascades(lpv.cascades, parts_.drawn.scene().bounds, volume, size.x / size.y),
                     view.camera, glm::mat4(glm::inverse(view.clip)), visible_, maps, mapsAreNew, effort.fadesIn},
                    rounds);
  return true;
}

Image ReceiversFrame::readFromCells(int paths) const {
  return receivers_.readFromCells(placeCascades(parts_.settings.lpv.cascades, parts_.drawn.scene().bounds,
                                                volumePosition_, volumeDirection_),
                                  paths);
}

void ReceiversFrame::forget() {
  if (maps_) maps_->forget();
  receivers_.forget();
  settled_ = false;
  clip_ = glm::dmat4(0.0);
}

gl::ShaderFlags ReceiversFrame::shadingFlags() const {
  gl::ShaderFlags flags = LightPropagationVolume::lookupFlags(parts_.settings.lpv);
  flags.insert(flags.begin(), {"RECEIVED", 1});
  return flags;
}

}  // namespace lucerna
