#include "render/irradiance_cache_frame.hpp"

namespace lucerna {

namespace {

IrradianceCache::Light cachedLight(Component component) {
  using Light = IrradianceCache::Light;
  return component == Component::direct     ? Light::direct
         : component == Component::indirect ? Light::indirect
                                            : Light::all;
}

std::optional<LightMaps> lightMaps(const FrameParts& parts) {
  if (!IrradianceCacheFrame::takesMaps(parts.settings, parts.features)) return {};
  return std::optional<LightMaps>(std::in_place, parts, LightMaps::Lights{true, true}, false);
}

}  // namespace

bool IrradianceCacheFrame::isNeeded(const RenderSettings& settings, const SceneFeatures& features) {
  return settings.technique == Technique::irradianceCache &&
         IrradianceCache::isNeeded(features, settings.cache, cachedLight(settings.component));
}

IrradianceCacheFrame::IrradianceCacheFrame(const FrameParts& parts, const gl::Texture& depth)
    : parts_(parts),
      maps_(lightMaps(parts)),
      visible_(parts.programs, parts.drawn, depth),
      cache_(parts.programs, parts.context.capabilities(), parts.scene, parts.origin, parts.settings.cache,
             cachedLight(parts.settings.component)) {}

void IrradianceCacheFrame::resize(const gl::Texture& depth) {
  visible_.resize(depth);
  clip_ = glm::dmat4(0.0);  // other pixels of the same view see other points
}

bool IrradianceCacheFrame::record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort) {
  cache_.collect();
  const Camera& volume = view.volumeCamera;
  const bool sameView =
      view.clip == clip_ && volume.position == volumePosition_ && volume.direction == volumeDirection_;
  if (!sameView) {
    clip_ = view.clip;
    volumePosition_ = volume.position;
    volumeDirection_ = volume.direction;
    since_ = cache_.frame() + 1;
  }
  const IrradianceCache::Counts& counts = cache_.counts();
  settled_ = sameView && counts.frame >= since_ && counts.waiting == 0;
  if (settled_ && parts_.settings.reuse) return false;
  const bool mapsAreNew = hasMaps() ? maps_->willBeDrawn() : !parts_.settings.reuse;
  const std::vector<ReflectiveShadowMap::Outputs> none;
  const std::vector<ReflectiveShadowMap::Outputs>& maps = maps_ ? maps_->record(timer) : none;
  {
    const gl::TimeQuery::Scope stage(timer, "geometry");
    visible_.record(parts_.drawn, view.drawn());
  }
  const gl::TimeQuery::Scope stage(timer, "irradiance cache");
  const IrradianceCacheSettings& cache = parts_.settings.cache;
  const int rounds = effort.wholePicture ? (cache.samples + cache.rays - 1) / cache.rays : 1;
  const glm::dvec2 size(visible_.size());
  cache_.update({placeCascadesAround(cache.cascades, parts_.drawn.scene().bounds, volume, size.x / size.y), view.camera,
                 glm::mat4(glm::inverse(view.clip)), visible_, maps, mapsAreNew, effort.fadesIn},
                rounds);
  return true;
}

Image IrradianceCacheFrame::readFromCells(const CascadeSettings& cascades, float blendBand, int paths) const {
  return cache_.readFromCells(cascades,
                              placeCascades(cascades, parts_.drawn.scene().bounds, volumePosition_, volumeDirection_),
                              blendBand, paths);
}

void IrradianceCacheFrame::forget() {
  if (maps_) maps_->forget();
  cache_.forget();
  settled_ = false;
  clip_ = glm::dmat4(0.0);
}

gl::ShaderFlags IrradianceCacheFrame::shadingFlags() const {
  gl::ShaderFlags flags = IrradianceCache::lookupFlags(parts_.settings.cache);
  flags.insert(flags.begin(), {"IRRADIANCE_CACHE", 1});
  return flags;
}

}  // namespace lucerna
