#include "lpv/lpv_frame.hpp"

#include "base/angles.hpp"
#include "base/log.hpp"
#include "shared/lpv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lucerna {

namespace {

/// Whether the geometry volume contains surfels seen by the camera.
bool takesCameraSurfels(const LpvSettings& volume) {
  return volume.blocking && volume.iterations > 1 && volume.surfels != LpvSurfels::rsm;
}

LpvSettings volumeSettings(const RenderSettings& settings, std::size_t lightMaps, bool isGlossy) {
  LpvSettings volume = settings.of<LpvSettings>();
  if (!isGlossy) volume.glossy = false;
  const std::size_t views =
      (volume.surfels == LpvSurfels::camera ? 0 : lightMaps) + (takesCameraSurfels(volume) ? 1 : 0);
  volume.mergeViews = volume.blocking && views > 1;
  return volume;
}

std::optional<ReflectiveShadowMap> cameraMap(const FrameParts& parts) {
  const auto& lpv = parts.settings.of<LpvSettings>();
  if (!takesCameraSurfels(lpv)) return {};
  ReflectiveShadowMap::Settings map;
  map.size = parts.settings.of<ReflectiveShadowMap::Settings>().size;
  map.light = ReflectiveShadowMap::Light::spot;
  map.albedo = lpv.bounces > 1;
  return std::optional<ReflectiveShadowMap>(std::in_place, parts.programs, parts.drawn(), map);
}

}  // namespace

bool LpvFrame::needsVolume(const RenderSettings& settings, const SceneFeatures& features) {
  return settings.component != Component::direct && LightPropagationVolume::isNeeded(features);
}

namespace {

/// The published grid lies before the camera, with cells of a fixed size. Where the first view is outside of the scene
/// they are as wide as it takes to reach the scene's far end.
void reachScene(CascadeSettings& cascades, const Scene& scene) {
  if (cascades.heldInScene || cascades.cellSize > 0.0 || scene.bounds.empty() || scene.cameras.empty()) return;
  const Bounds& main = scene.main();
  const glm::dvec3 eye = scene.cameras.front().position, nearest = glm::clamp(eye, main.min, main.max);
  if (eye == nearest) return;
  const glm::dvec3 extent = main.extent();
  const double farthest = glm::length(eye - nearest) + glm::length(extent);
  const double scenes = cascades.spanOfScene * std::max({extent.x, extent.y, extent.z}) / cascades.cells;
  cascades.cellSize = std::max(scenes, 2.0 * farthest / (cascades.cells * (1.0 + cascades.push)));
}

}  // namespace

void LpvFrame::prepare(RenderSettings& settings, const Scene& scene) {
  reachScene(settings.of<LpvSettings>().cascades, scene);
  if (!settings.of<LpvSettings>().shafts) return;
  const bool hasHaze = hazeOf(scene).has_value();
  if (!hasHaze)
    logWarning(
        "lpv.shafts: the scene has no homogeneous medium, within a boundary of bsdf none or about the camera: nothing "
        "scatters");
  settings.of<ReflectiveShadowMap::Settings>().haze = hasHaze;
  settings.textures.boundaries = !hasHaze;
  if (hasHaze) settings.shadows = ShadowTransport::map;  // points in the air look into it
}

LpvFrame::LpvFrame(const FrameParts& parts) : parts_(parts) {
  const RenderSettings& frame = parts.settings;
  if (needsVolume(frame, parts.features)) {
    maps_.emplace(parts, settings().bounces > 1);
    cameraMap_ = cameraMap(parts);
    volume_.emplace(parts.programs, parts.context.capabilities(),
                    volumeSettings(frame, maps_->count(), parts.features.specular));
    if (settings().glossy && parts.features.specular) lobes_.emplace();
  }
  const std::optional<Haze> haze = settings().shafts ? hazeOf(parts.drawn().scene()) : std::nullopt;
  if (!haze) return;
  LightShafts::Settings shafts;
  shafts.steps = settings().shaftSteps;
  shafts.sun = parts.sunShadow.has_value();
  shafts.sunCascades = parts.sunShadow ? parts.sunShadow->cascades() : 0;
  shafts.volume = volume_.has_value();
  shafts.fullFloat = frame.fullFloatTarget;
  shafts.lookup = LightPropagationVolume::lookupFlags(settings());
  shafts.unmeasuredIterations = frame.unmeasuredIterations;
  shafts_.emplace(parts.programs, *haze, shafts);
}

// Treats the camera as a lamp without light: the map's texels hold position, normal and area of the visible surfaces.
std::vector<ReflectiveShadowMap::Outputs> LpvFrame::recordCameraMap(gl::TimeQuery& timer, const Camera& camera) {
  if (!cameraMap_) return {};
  const gl::TimeQuery::Scope stage(timer, "camera surfels");
  const double aspect = static_cast<double>(parts_.settings.size.x) / static_cast<double>(parts_.settings.size.y);
  SpotLight eye;
  eye.position = camera.position;
  eye.direction = camera.direction;
  const double toEdge = camera.halfHeight() * std::max(aspect, 1.0);
  eye.outerAngle = std::min(std::atan(toEdge), kLargestSpotAngle);
  if (camera.isOrthographic()) {  // a cone that holds the view from its plane on
    eye.outerAngle = std::atan(1.0);
    eye.position -= toEdge * camera.direction;
  }
  eye.innerAngle = 0.0;
  return {cameraMap_->record(parts_.drawn(), lightViews(eye, parts_.drawn().scene()))};
}

bool LpvFrame::follow(const SceneChange&) {
  forget();
  return !shafts_ && (!maps_ || maps_->follow());  // shafts know the sun's maps
}

bool LpvFrame::record(gl::TimeQuery& timer, const FrameView& view, FrameEffort) {
  if (shafts_) shafts_->bind();
  if (!volume_) return false;
  const Scene& scene = parts_.drawn().scene();
  const glm::dvec4 lightPosition = glm::inverse(parts_.sun.clipFromWorld) * glm::dvec4(0.0, 0.0, -1.0, 1.0);
  const LpvInputs inputs{maps_->record(timer),
                         placeCascades(settings().cascades, scene.mainAround(view.volumeCamera.position),
                                       view.volumeCamera.position, view.volumeCamera.direction),
                         typicalIrradiance(scene), glm::vec3(lightPosition), recordCameraMap(timer, view.volumeCamera)};
  // The volume's light is kept while its grids stay in place, unless it uses surfels seen by the camera.
  const shared::CascadeConstants constants = lpvConstants(settings(), inputs.cascades, inputs.referenceIrradiance);
  const auto liesWhere = [](const shared::CascadeGrid& a, const shared::CascadeGrid& b) {
    return a.minimum == b.minimum && a.cellSize == b.cellSize;
  };
  const bool same = parts_.settings.reuse && !cameraMap_ && cascades_.size() == inputs.cascades.size() &&
                    std::equal(cascades_.begin(), cascades_.end(), constants.cascades, liesWhere);
  if (same) {
    volume_->place(inputs);  // the blending between cascades follows the camera
    return false;
  }
  cascades_.assign(constants.cascades, constants.cascades + inputs.cascades.size());
  timer.begin("injection");
  volume_->place(inputs);
  volume_->inject(inputs);
  timer.end();
  if (volume_->geometryVolume()) {
    const gl::TimeQuery::Scope stage(timer, "geometry volume");
    volume_->fillGeometryVolume(inputs);
  }
  const gl::TimeQuery::Scope stage(timer, "propagation");
  volume_->propagate();
  volume_->join();
  return false;
}

void LpvFrame::addToPicture(gl::TimeQuery& timer, const FrameView& view) {
  if (!shafts_) return;
  const gl::TimeQuery::Scope stage(timer, "light shafts");
  if (parts_.sunShadow) parts_.sunShadow->bindForShading();
  if (volume_) bindForShading();
  shafts_->record(parts_.radiance, parts_.depth, view.clip);
}

double LpvFrame::largestIterations(const RenderSettings& settings, bool hasPoints) {
  constexpr double kIterationsOfTexel = 2.0;
  const CascadeSettings& grids = settings.of<LpvSettings>().cascades;
  const double cells = grids.cells, side = settings.of<ReflectiveShadowMap::Settings>().size;
  const double faces = hasPoints ? 6.0 / 4.0 : 1.0;  // six of half the side
  return std::max(kIterationsOfTexel * faces * side * side,
                  kIterationsOfPropagation * cells * cells * cells * grids.cascades);
}

double LpvFrame::largestIterations() const {
  const double ofVolume = volume_ ? largestIterations(parts_.settings, !parts_.points.empty()) : 0.0;
  return std::max(ofVolume, shafts_ ? shafts_->largestIterations() : 0.0);
}

double LpvFrame::iterationsOfPixel() const {
  constexpr double kIterationsOfLookup = 24.0, kIterationsOfCell = 8.0;
  return (volume_ ? kIterationsOfLookup : 0.0) +
         (lobes_ ? LPV_GLOSSY_RAYS * kIterationsOfCell * settings().glossySteps : 0.0);
}

void LpvFrame::forget() {
  if (maps_) maps_->forget();
  cascades_.clear();
}

std::string LpvFrame::surfaceShader() const { return volume_ ? "lpv/surface.frag" : FrameTechnique::surfaceShader(); }

gl::ShaderFlags LpvFrame::surfaceFlags() const {
  gl::ShaderFlags flags{{"HAZE", shafts_.has_value()}};
  if (!volume_) return flags;
  flags.push_back({"INDIRECT_SPECULAR", lobes_.has_value()});
  return gl::with(flags, LightPropagationVolume::lookupFlags(settings()));
}

void LpvFrame::bindForShading() const {
  if (volume_) volume_->bindForLookup();
  if (lobes_) lobes_->bind();
}

void LpvFrame::addShares(const InspectedPixel& pixel, PixelInspection& answer) {
  if (volume_) addVolumeShares(pixel, answer);
  if (shafts_)
    answer.add("medium", "light shafts, less what the medium takes",
               answer.radiance - glm::dvec3(pixel.terms[INSPECTED_RADIANCE]));
}

void LpvFrame::addVolumeShares(const InspectedPixel& pixel, PixelInspection& answer) {
  const glm::dvec3 position = answer.surface->position, reflection = answer.surface->albedo / kPi;
  answer.isFiltered = true;
  std::map<int, glm::dvec3> ofCascade;
  for (const InspectedPart& part :
       volume_->inspect(parts_.programs, pixel.terms[INSPECTED_POSITION], pixel.terms[INSPECTED_NORMAL])) {
    const glm::dvec3 irradiance(part.irradiance);
    ofCascade.try_emplace(part.number.w, 0.0).first->second += irradiance;
    const std::string name =
        fmt::format("cell {} {} {} of cascade {}", part.number.x, part.number.y, part.number.z, part.number.w + 1);
    const std::vector<glm::dvec3> places{position, glm::dvec3(part.place) + parts_.origin};
    if (!answer.add("lpv", name, reflection * irradiance, places)) continue;
    answer.shares.back().weight = part.weight;
    answer.shares.back().lobe = {part.red, part.green, part.blue};
  }
  glm::dvec3 cut(0.0);  // the lookup clamps each channel of a cascade at 0
  for (const auto& [cascade, sum] : ofCascade) cut += glm::max(sum, glm::dvec3(0.0)) - sum;
  answer.add("lpv", "light below 0, cut off", reflection * cut, {position});
  answer.add("lpv", "glossy reflection", glm::dvec3(pixel.terms[INSPECTED_GLOSSY]), {position});
}

void LpvFrame::addStagePictures(std::vector<StagePicture>& pictures) const {
  if (!volume_) return;
  maps_->addStagePictures(pictures);
  const auto add = [&](const char* name, const LpvVolume& volume) {
    pictures.push_back({StagePicture::Kind::coefficients, name, &volume[0], &volume[1], &volume[2]});
  };
  add("lpv injected light", volume_->injected());
  add("lpv propagated light", volume_->result());
}

void LpvFrame::addLeftOut(std::vector<std::string>& names) const {
  if (!volume_) names.insert(names.end(), {"reflective shadow map", "light propagation volume"});
  if (!shafts_) names.emplace_back("light shafts");
  if (!lobes_) names.emplace_back("glossy reflection");
  if (!volume_) return;
  if (!volume_->geometryVolume()) {
    names.emplace_back("geometry volume");
    return;
  }
  if (!cameraMap_) names.emplace_back("camera surfels");
  if (settings().bounces == 1) names.emplace_back("light bounces");
}

std::string LpvFrame::summary() const {
  if (!volume_ || cascades_.empty()) return "";
  std::string sizes;
  for (const shared::CascadeGrid& cascade : cascades_)
    sizes += fmt::format("{}{:.3g}", sizes.empty() ? "" : ", ", cascade.cellSize);
  return fmt::format("cells of {} scene units; reflected light passes through walls thinner than two cells\n", sizes);
}

std::size_t LpvFrame::gpuBytes() const {
  return (maps_ ? maps_->gpuBytes() : 0) + (cameraMap_ ? cameraMap_->gpuBytes() : 0) +
         (volume_ ? volume_->gpuBytes() : 0) + (lobes_ ? lobes_->gpuBytes() : 0) + (shafts_ ? shafts_->gpuBytes() : 0);
}

}  // namespace lucerna
