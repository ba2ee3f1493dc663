#include "render/lpv_frame.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// Whether the geometry volume contains surfels seen by the camera.
bool takesCameraSurfels(const LpvSettings& volume) {
  return volume.blocking && volume.iterations > 1 && volume.surfels != LpvSurfels::rsm;
}

LpvSettings volumeSettings(const RenderSettings& settings, std::size_t lightMaps, bool isGlossy) {
  LpvSettings volume = settings.lpv;
  if (!isGlossy) volume.glossy = false;
  const std::size_t views =
      (volume.surfels == LpvSurfels::camera ? 0 : lightMaps) + (takesCameraSurfels(volume) ? 1 : 0);
  volume.mergeViews = volume.blocking && views > 1;
  return volume;
}

std::optional<ReflectiveShadowMap> cameraMap(const FrameParts& parts) {
  if (!takesCameraSurfels(parts.settings.lpv)) return {};
  ReflectiveShadowMap::Settings map;
  map.size = parts.settings.rsm.size;
  map.light = ReflectiveShadowMap::Light::spot;
  map.albedo = parts.settings.lpv.bounces > 1;
  return std::optional<ReflectiveShadowMap>(std::in_place, parts.programs, parts.drawn, map);
}

}  // namespace

LpvFrame::LpvFrame(const FrameParts& parts)
    : parts_(parts),
      maps_(parts, {true, true}, parts.settings.lpv.bounces > 1),
      cameraMap_(cameraMap(parts)),
      volume_(parts.programs, parts.context.capabilities(),
              volumeSettings(parts.settings, maps_.count(), parts.features.specular)) {
  if (parts.settings.lpv.glossy && parts.features.specular) lobes_.emplace();
}

// Treats the camera as a lamp without light: the map's texels hold position, normal and area of the visible surfaces.
std::vector<ReflectiveShadowMap::Outputs> LpvFrame::recordCameraMap(gl::TimeQuery& timer, const Camera& camera) {
  if (!cameraMap_) return {};
  const gl::TimeQuery::Scope stage(timer, "camera surfels");
  const double aspect = static_cast<double>(parts_.settings.size.x) / static_cast<double>(parts_.settings.size.y);
  SpotLight eye;
  eye.position = camera.position;
  eye.direction = camera.direction;
  eye.outerAngle = std::min(std::atan(std::tan(0.5 * camera.verticalFov) * std::max(aspect, 1.0)), kLargestSpotAngle);
  eye.innerAngle = 0.0;
  return {cameraMap_->record(parts_.drawn, lightViews(eye, parts_.drawn.scene().bounds))};
}

void LpvFrame::record(gl::TimeQuery& timer, const FrameView& view) {
  const Scene& scene = parts_.drawn.scene();
  const glm::dvec4 lightPosition = glm::inverse(parts_.sun.clipFromWorld) * glm::dvec4(0.0, 0.0, -1.0, 1.0);
  const LpvInputs inputs{maps_.record(timer),
                         placeCascades(parts_.settings.lpv.cascades, scene.bounds, view.volumeCamera.position,
                                       view.volumeCamera.direction),
                         typicalIrradiance(scene), glm::vec3(lightPosition), recordCameraMap(timer, view.volumeCamera)};
  // The volume's light is kept while its grids stay in place, unless it uses surfels seen by the camera.
  const shared::CascadeConstants constants =
      lpvConstants(parts_.settings.lpv, inputs.cascades, inputs.referenceIrradiance);
  const auto liesWhere = [](const shared::CascadeGrid& a, const shared::CascadeGrid& b) {
    return a.minimum == b.minimum && a.cellSize == b.cellSize;
  };
  const bool same = parts_.settings.reuse && !cameraMap_ && cascades_.size() == inputs.cascades.size() &&
                    std::equal(cascades_.begin(), cascades_.end(), constants.cascades, liesWhere);
  if (same) {
    volume_.place(inputs);  // the blending between cascades follows the camera
    return;
  }
  cascades_.assign(constants.cascades, constants.cascades + inputs.cascades.size());
  timer.begin("injection");
  volume_.place(inputs);
  volume_.inject(inputs);
  timer.end();
  if (volume_.geometryVolume()) {
    const gl::TimeQuery::Scope stage(timer, "geometry volume");
    volume_.fillGeometryVolume(inputs);
  }
  const gl::TimeQuery::Scope stage(timer, "propagation");
  volume_.propagate();
  volume_.join();
}

double LpvFrame::largestIterations(const RenderSettings& settings, bool hasPoints) {
  constexpr double kIterationsOfTexel = 2.0;
  const double cells = settings.lpv.cascades.cells, side = settings.rsm.size;
  const double faces = hasPoints ? 6.0 / 4.0 : 1.0;  // six of half the side
  return std::max(kIterationsOfTexel * faces * side * side,
                  kIterationsOfPropagation * cells * cells * cells * settings.lpv.cascades.cascades);
}

void LpvFrame::forget() {
  maps_.forget();
  cascades_.clear();
}

gl::ShaderFlags LpvFrame::shadingFlags() const {
  gl::ShaderFlags flags = LightPropagationVolume::lookupFlags(parts_.settings.lpv);
  flags.insert(flags.begin(), {{"PROPAGATED", 1}, {"GLOSSY", isGlossy()}});
  return flags;
}

void LpvFrame::addStagePictures(std::vector<StagePicture>& pictures) const {
  maps_.addStagePictures(pictures);
  const auto add = [&](const char* name, const LpvVolume& volume) {
    pictures.push_back({StagePicture::Kind::coefficients, name, &volume[0], &volume[1], &volume[2]});
  };
  add("lpv injected light", volume_.injected());
  add("lpv propagated light", volume_.result());
}

void LpvFrame::addLeftOut(std::vector<std::string>& names) const {
  if (!volume_.geometryVolume()) {
    names.emplace_back("geometry volume");
    return;
  }
  if (!cameraMap_) names.emplace_back("camera surfels");
  if (parts_.settings.lpv.bounces == 1) names.emplace_back("light bounces");
}

}  // namespace lucerna
