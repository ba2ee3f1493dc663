#include "render/renderer.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "gl/read_pictures.hpp"
#include "render/near_plane.hpp"
#include "render/techniques.hpp"
#include "rsm/lamp_choice.hpp"
#include "scene/coat.hpp"
#include "scene/parts.hpp"
#include "scene/place.hpp"
#include "scene/studio.hpp"
#include "shared/bindings.h"

#include <fmt/ranges.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <functional>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <span>
#include <utility>

namespace lucerna {

namespace {

double farPlane(const Camera& camera, const Bounds& bounds) {
  return 1.01 * std::max({glm::length(bounds.extent()), 1e-6, bounds.farthestFrom(camera.position)});
}

// The far plane is just behind the scene's farthest corner. An orthographic view begins at its camera.
glm::dmat4 clipFromWorld(const Camera& camera, const Bounds& bounds, double near, glm::ivec2 size) {
  const double aspect = static_cast<double>(size.x) / size.y, half = camera.halfHeight();
  const glm::dmat4 clipFromView =
      camera.isOrthographic() ? glm::ortho(-half * aspect, half * aspect, -half, half, 0.0, farPlane(camera, bounds))
                              : glm::perspective(camera.verticalFov, aspect, near, farPlane(camera, bounds));
  return clipFromView * glm::lookAt(camera.position, camera.position + camera.direction, camera.up);
}

gl::RasterState stateOf(const GeometryTechnique::Sides& sides, gl::Depth depth) {
  gl::RasterState state;
  state.depth = depth;
  state.cull = sides.cull;
  state.polygonOffset = sides.polygonOffset;
  return state;
}

/// Names of the techniques of which it is true, for messages.
std::string techniquesThat(const std::function<bool(const TechniqueEntry&)>& holds) {
  std::vector<std::string_view> names;
  for (const TechniqueEntry& technique : allTechniques())
    if (holds(technique)) names.push_back(technique.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Names of the drawn materials of a kind.
template <class Kind>
std::vector<std::string> namesOfDrawn(const Scene& scene, const Kind& isOfKind) {
  std::set<int> drawn;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.indexCount > 0) drawn.insert(mesh.material);
  std::vector<std::string> names;
  for (const int i : drawn)
    if (const Material& material = scene.materials[static_cast<std::size_t>(i)]; isOfKind(material))
      names.push_back("'" + material.name + "'");
  return names;
}

}  // namespace

Renderer::Renderer(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                   const RenderSettings& settings)
    : settings_(settings),
      features_(analyse(scene)),
      origin_(floatingOrigin(scene.main())),
      sceneExposure_(scene.exposure),
      exposure_(settings.exposure.value_or(scene.exposure)),
      timer_(context.capabilities().softwareRenderer),
      traced_(scene, context.capabilities()),
      frameConstants_("frame constants", sizeof(shared::FrameConstants), nullptr, gl::Usage::dynamicDraw),
      noAttributes_("full screen"),
      surfaceChunks_(settings.unmeasuredIterations),
      samples_(pixelSamples(settings.filter, settings.pixelSamples)),
      sampleTimer_(context.capabilities().softwareRenderer),
      antialiasing_(programs) {
  allocateTargets();
  const TechniqueEntry& technique = techniqueNamed(settings.technique);
  if (!technique.drawsSurfaces) {
    technique_ = technique.make(parts(context, programs, scene));
    geometry_ = dynamic_cast<GeometryTechnique*>(technique_.get());
    picture_ = dynamic_cast<PictureTechnique*>(technique_.get());
  }
  if (picture_) {
    toneMap_ = &programs.loadRaster("tone map", "lib/fullscreen.vert", "forward/tonemap.frag");
    return;
  }
  if (technique.prepare) technique.prepare(settings_, aboutOrigin(scene));
  settings_.textures.pixelSamples = settings_.filter == PixelFilter::centre ? 1 : settings_.pixelSamples;
  gpuScene_.emplace(geometry_ ? geometry_->geometry() : aboutOrigin(scene), features_, context.capabilities(),
                    settings_.textures);
  if (moved_) moved_->textures.clear();  // they are on the GPU now
  makeLights(context, programs, scene);
  warnOfWhatIsLeftOut(technique);
  warnOfWhatIsCut();
}

// What depends on the lights and on where surfaces stand; programs are those of the library.
void Renderer::makeLights(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                          const SceneChange& change) {
  const TechniqueEntry& technique = techniqueNamed(settings_.technique);
  const Scene& drawn = gpuScene_->scene();
  if (std::exchange(surfacesAreNew_, false)) {
    near_ = nearPlane(drawn, aspect());
    largeParts_.reset();
  }
  if (scene.sun) sunFrustum_ = fitSunFrustum(drawn, scene.sun->direction);
  if (!lampShadowsMade_) chooseLamps(programs);
  if (showsDirect()) makeShadowMaps(programs);
  if (technique_ && !geometry_ && !technique_->follow(change)) technique_.reset();
  if (!technique_ && technique.drawsSurfaces && technique.isNeeded(settings_, features_))
    technique_ = technique.make(parts(context, programs, scene));
  if (EnvironmentView::isNeeded(features_) && settings_.component != Component::indirect)
    environmentView_.emplace(programs, scene, shownSky(scene));
  loadPrograms(programs);
}

// Factor of the environment behind surfaces. A technique that the sky does not light draws the studio's floor without
// that light: its sky begins in that colour, so that no horizon is seen.
glm::vec3 Renderer::shownSky(const Scene& scene) const {
  const bool isLit = techniqueNamed(settings_.technique).model(settings_).environmentAndEmission;
  return scene.studio && !isLit ? studioSunShare() : glm::vec3(1.0f);
}

// Which lamps have shadow maps.
void Renderer::chooseLamps(gl::ProgramLibrary& programs) {
  const TechniqueEntry& technique = techniqueNamed(settings_.technique);
  spots_ = spotViews(gpuScene_->scene());
  points_ = pointViews(gpuScene_->scene());
  plainLamps_.clear();
  const bool reflectsLamps = technique.readsLightMaps && technique.readsLightMaps(settings_, features_);
  const bool byRays = settings_.shadows == ShadowTransport::rays, hasMaps = showsDirect() && !byRays;
  const std::size_t mostByRays = ShadowRays::kMostLights - 1;
  const bool isCrowded = spots_.size() + points_.size() > mostByRays;
  if ((hasMaps || reflectsLamps || isCrowded) && LocalLights::isNeeded(features_)) {
    const std::size_t most =
        hasMaps || reflectsLamps ? static_cast<std::size_t>(settings_.lights.shadows) : mostByRays / 2;
    const std::string_view lack = reflectsLamps ? "are in no map of light" : "";
    if (hasMaps && !reflectsLamps) leaveCoarseMapsToRays();
    for (std::vector<LightViews>* lamps : {&spots_, &points_})
      std::ranges::move(keepMostImportant(programs, *gpuScene_, *lamps, most, lack), std::back_inserter(plainLamps_));
  }
  const std::size_t byRaysToo = hasMaps ? 0 : spots_.size() + points_.size();
  if (showsDirect() && plainLamps_.size() + byRaysToo > mostByRays)
    logWarning("{} lamps: {} of them have shadows by rays, the others shine through what is before them",
               spots_.size() + points_.size() + plainLamps_.size(), mostByRays);
}

// Found when they are first asked for, and again after surfaces or cameras have moved.
std::span<const Bounds> Renderer::largeParts() {
  if (!largeParts_) largeParts_ = partsLargeInView(gpuScene_->scene());
  return *largeParts_;
}

// Lamps in whose maps a part that is large in the picture would have few texels, or none.
void Renderer::leaveCoarseMapsToRays() {
  const auto isCoarse = [&](const LightViews& lamp) {
    const int size = lamp.omnidirectional() ? settings_.lights.pointSize : settings_.lights.spotSize;
    return std::ranges::any_of(largeParts(), [&](const Bounds& part) {
      return hasFewTexels(part, lamp.texelWidth(size) * glm::distance(part.centre(), lamp.position));
    });
  };
  for (std::vector<LightViews>* lamps : {&spots_, &points_}) {
    std::ranges::copy_if(*lamps, std::back_inserter(plainLamps_), isCoarse);
    std::erase_if(*lamps, isCoarse);
  }
}

bool Renderer::follow(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                      const SceneChange& change) {
  if (!change.any()) return true;
  sceneExposure_ = scene.exposure;
  exposure_ = settings_.exposure.value_or(sceneExposure_);
  if (!(analyse(scene) == features_) || floatingOrigin(scene.main()) != origin_) return false;
  const bool movesCamerasAlone = change.meshes.empty() && !change.anyLight() && !change.materials && !change.media;
  // Takes its time, in which frames of what is there may be drawn.
  if (geometry_ && !movesCamerasAlone && !geometry_->follow(change)) return false;
  view_.reset();
  surfacesAreNew_ = surfacesAreNew_ || !change.meshes.empty() || change.views;
  if (movesCamerasAlone) return true;
  lightMoves_ = lightMoves_ || change.anyLight() || change.materials || change.media || geometry_;
  if (picture_) return picture_->follow(change);
  if (moved_) {
    Scene next = movedTo(scene, origin_);
    next.textures.clear();
    *moved_ = std::move(next);
  }
  if (geometry_) gpuScene_->replaceMeshes();
  else gpuScene_->update(change.meshes);
  if (gpuScene_->movingMeshes() > 0 && accumulates() && !objectMotion_) objectMotion_.emplace(programs, features_);
  traced_.update(change.meshes);
  shadowRays_.reset();
  if (!change.meshes.empty() || change.lamps) lampShadowsMade_ = false;
  if (!change.meshes.empty() || change.sun) sunShadowMade_ = false;
  environmentView_.reset();
  makeLights(context, programs, scene, change);
  return true;
}

// The near plane follows the scene's size, so a part of a scene that is 2000 times as wide would be cut away.
void Renderer::warnOfWhatIsCut() {
  const Scene& scene = gpuScene_->scene();
  if (scene.cameras.empty()) return;
  const std::vector<double> nearest = nearestInView(scene, scene.cameras.front(), aspect(), near_);
  std::vector<std::string> names;
  for (std::size_t m = 0; m < nearest.size(); ++m)
    if (nearest[m] < near_)
      names.push_back("'" + scene.materials[static_cast<std::size_t>(scene.meshes[m].material)].name + "'");
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  if (names.empty()) return;
  warnings_.push_back(
      fmt::format("{} within {:.3g} of the camera: not drawn, as the scene is {:.3g} wide (technique "
                  "path draws all)",
                  fmt::join(names, ", "), near_, glm::length(scene.main().extent())));
  logWarning("{}", warnings_.back());
}

void Renderer::warnOfWhatIsLeftOut(const TechniqueEntry& technique) {
  const auto warn = [&](const std::string& what) {
    warnings_.push_back(fmt::format("technique {}: {}", technique.name, what));
    logWarning("{}", warnings_.back());
  };
  const bool lacksLight = !technique.model(settings_).environmentAndEmission;
  using Media = TechniqueEntry::Media;
  const std::string lit = techniquesThat(
                              [](const TechniqueEntry&t) { return t.model(RenderSettings{}).environmentAndEmission; }) +
                          " support it",
                    draws = techniquesThat([](const TechniqueEntry&t) { return t.media == Media::all; }),
                    previews = techniquesThat([](const TechniqueEntry&t) { return t.media == Media::preview; });
  if (features_.emission && !features_.anyLight() && lacksLight)
    warn("emissive surfaces light nothing, and nothing else does, so all but them is black (" + lit + ")");
  const gl::ShaderFlags flags = technique_ ? technique_->surfaceFlags() : gl::ShaderFlags{};
  const bool reflects = std::ranges::count(flags, std::pair<std::string, int>("INDIRECT_SPECULAR", 1)) > 0;
  const std::vector<std::string> reflecting = namesOfDrawn(gpuScene_->scene(), isMostlyReflection);
  if (!reflects && settings_.component != Component::direct && !reflecting.empty())
    warn(fmt::format("what surfaces reflect or let through is left out{}: {} ({} draw it)",
                     geometry_ ? ", they look matt but for lamps' highlights" : ", but lamps' highlights",
                     fmt::join(reflecting, ", "),
                     techniquesThat([](const TechniqueEntry& t) { return t.drawsReflections; })));
  // Reflected rays find surfaces behind glass, but not the light that glass bends or a mirror throws onto them.
  const std::vector<std::string> casters = namesOfDrawn(gpuScene_->scene(), [](const Material& material) {
    return material.bsdf == Bsdf::dielectric || material.bsdf == Bsdf::mirror;
  });
  if (reflects && (features_.anyLight() || features_.emission) && !casters.empty())
    warn(fmt::format(
        "caustics are left out, the light that glass and water bend and mirrors throw back: {} ({} draws it)",
        fmt::join(casters, ", "), draws));
  const std::vector<std::string> bodies = namesOfDrawn(gpuScene_->scene(), [](const Material& material) {
    return material.bsdf == Bsdf::dielectric && material.interior >= 0;
  });
  if (!bodies.empty() && technique_ && technique_->previewsMedia())
    warn(fmt::format("media are a preview, which scatter as surfaces do: {} ({} draws them as they are)",
                     fmt::join(bodies, ", "), draws));
  else if (!bodies.empty())
    warn(fmt::format("the medium inside of a body, its colour too, is left out: {} ({} previews it, {} draws it)",
                     fmt::join(bodies, ", "), previews, draws));
  const std::vector<std::string> boundaries = namesOfDrawn(gpuScene_->scene(), [](const Material& material) {
    return material.bsdf == Bsdf::none && material.interior >= 0;
  });
  if (settings_.textures.boundaries && !boundaries.empty())
    warn(fmt::format("the boundary of a medium is drawn, and matt: {} ({} draws the medium)",
                     fmt::join(boundaries, ", "), draws));
  if (features_.environment && lacksLight) warn("the environment lights nothing (" + lit + ")");
}

FrameParts Renderer::parts(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene) {
  return {context, programs, settings_,  features_, scene,     origin_, gpuScene_,       sunFrustum_,
          spots_,  points_,  sunShadow_, traced_,   radiance_, depth_,  radianceTarget_, noAttributes_};
}

bool Renderer::showsDirect() const {
  return features_.anyLight() && settings_.component != Component::indirect && !geometry_;
}

const Scene& Renderer::aboutOrigin(const Scene& scene) {
  if (origin_ == glm::dvec3(0.0)) return scene;
  return moved_ ? *moved_ : moved_.emplace(movedTo(scene, origin_));
}

// Rays find the shadows of all lights, or only of those lamps that have no maps.
void Renderer::makeShadowMaps(gl::ProgramLibrary& programs) {
  const bool isByRays = settings_.shadows == ShadowTransport::rays;
  if (isByRays || !plainLamps_.empty()) {
    ShadowRays::Lights lights{{}, rayShadowedLamps()};
    if (isByRays && features_.directionalLight) lights.sun = gpuScene_->scene().sun;
    shadowRays_.emplace(programs, traced_.get(), origin_, lights, settings_.unmeasuredIterations);
    shadowRays_->resize(settings_.size);
  }
  if (isByRays) {
    std::vector<LightViews> lamps = spots_;
    lamps.insert(lamps.end(), points_.begin(), points_.end());
    lamps.insert(lamps.end(), plainLamps_.begin(), plainLamps_.end());
    if (lamps.empty() || lampShadowsMade_) return;
    if (!localLights_) localLights_.emplace();
    localLights_->place(programs, *gpuScene_, settings_.lights, {}, {}, lamps);
    return;
  }
  if (SunShadow::isNeeded(features_) && !sunShadowMade_) {
    SunShadow::Settings shadow = settings_.shadow;
    if (shadow.cascades.cascades == SunCascadeSettings::kAuto)
      shadow.cascades.cascades = neededCascades(gpuScene_->scene(), largeParts(),
                                                std::max(sunFrustum_.width, sunFrustum_.height) / shadow.size);
    const int cascades = shadow.cascades.cascades > 1 ? shadow.cascades.cascades : 0;
    if (!sunShadow_ || sunShadow_->cascades() != cascades) sunShadow_.emplace(programs, *gpuScene_, shadow);
  }
  if (LocalLights::isNeeded(features_) && !lampShadowsMade_) {
    LocalLights::Settings lamps = settings_.lights;
    lamps.penumbrae = settings_.shadow.filter == ShadowFilter::pcss;
    if (!localLights_) localLights_.emplace();
    localLights_->place(programs, *gpuScene_, lamps, spots_, points_, plainLamps_);
  }
}

bool Renderer::sunHasPenumbra() const {
  const std::optional<DirectionalLight>& sun = gpuScene_->scene().sun;
  return sunShadow_ && settings_.shadow.filter == ShadowFilter::pcss && sun && sun->angularDiameter > 0.0;
}

gl::ShaderFlags Renderer::shadowFlags() const {
  const bool hasMaps = settings_.shadows == ShadowTransport::map;
  const int spots = hasMaps && localLights_ ? static_cast<int>(spots_.size()) : 0,
            points = hasMaps && localLights_ ? static_cast<int>(points_.size()) : 0;
  const bool softSpots = spots > 0 && localLights_->areSpotsSoft(),
             softPoints = points > 0 && localLights_->arePointsSoft(),
             hasPenumbrae =
                 sunHasPenumbra() || (settings_.shadow.filter == ShadowFilter::pcss && (softSpots || softPoints));
  return {{"SUN", hasMaps ? sunShadow_.has_value() : shadowRays_ && features_.directionalLight},
          {"SUN_BY_RAYS", !hasMaps && shadowRays_ && features_.directionalLight},
          {"SUN_CASCADES", sunShadow_ ? sunShadow_->cascades() : 0},
          {"SHADOW_MAPS", hasMaps && (sunShadow_ || spots + points > 0)},
          {"PENUMBRA_TAPS", hasPenumbrae ? settings_.shadow.taps : 0},
          {"SPOTS", spots},
          {"POINTS", points},
          {"SOFT_SPOTS", softSpots ? spots : 0},
          {"SOFT_POINTS", softPoints ? points : 0},
          {"RAY_LAMPS", shadowRays_ ? rayShadowedLamps() : 0},
          {"SPOT_LAMPS", hasMaps ? 0 : static_cast<int>(spots_.size())},
          {"INSPECTED_LAMPS", hasMaps ? 0 : static_cast<int>(spots_.size() + points_.size())},
          {"PLAIN_LAMPS", localLights_ && localLights_->hasPlainLamps()}};
}

SurfacePrograms Renderer::surfacePrograms(gl::ProgramLibrary& programs, bool inspected) const {
  if (geometry_) return geometry_->surfacePrograms(inspected);
  const std::string shader = technique_ ? technique_->surfaceShader() : "forward/surface.frag";
  const gl::ShaderFlags own = technique_ ? technique_->surfaceFlags() : gl::ShaderFlags{};
  const auto loadSurface = [&](const std::string& name, bool masked) {
    gl::ShaderFlags flags = gpuScene_->materialFlags(masked);
    const bool showsRest = settings_.component != Component::indirect;  // emission belongs to direct light
    flags = gl::with(flags, shadowFlags());
    flags.insert(flags.end(), {{"EMISSION", features_.emission && showsRest}, {"INSPECTED", inspected}});
    for (const char* flag :
         {"HAZE", "SHOW_REFUSED", "INDIRECT_SPECULAR", "BEHIND_MEDIA"})  // 0 unless the technique sets them
      if (std::none_of(own.begin(), own.end(), [&](const auto& o) { return o.first == flag; }))
        flags.push_back({flag, 0});
    return &programs.loadRaster(name, "forward/surface.vert", shader, gl::with(flags, own));
  };
  SurfacePrograms result;
  result.opaque = loadSurface("surface opaque", false);
  if (features_.alphaMasks) result.masked = loadSurface("surface masked", true);
  return result;
}

void Renderer::loadPrograms(gl::ProgramLibrary& programs) {
  surfacePrograms_ = surfacePrograms(programs, false);
  const auto loadDepth = [&](const char* name, const char* fragment, bool masked) {
    return &programs.loadRaster(name, "forward/depth.vert", fragment,
                                {{"ALPHA_MASK", masked}, {"FROM_SUN", 0}, {"EMITTERS", features_.emission}});
  };
  depthPrograms_.opaque = loadDepth("depth opaque", "", false);
  if (features_.alphaMasks) depthPrograms_.masked = loadDepth("depth masked", "forward/depth.frag", true);
  toneMap_ = geometry_ ? geometry_->toneMap() : nullptr;
  if (!toneMap_) toneMap_ = &programs.loadRaster("tone map", "lib/fullscreen.vert", "forward/tonemap.frag");
}

void Renderer::allocateTargets() {
  radiance_ =
      gl::Texture("radiance", settings_.fullFloatTarget ? gl::Format::rgba32f : gl::Format::rgba16f, settings_.size);
  depth_ = gl::Texture("depth", gl::Format::depth32f, settings_.size);
  display_ = gl::Texture("display", gl::Format::rgba8, settings_.size);
  const std::array<const gl::Texture*, 1> radiance{&radiance_}, display{&display_};
  radianceTarget_ = gl::Framebuffer("radiance", radiance, &depth_);
  depthTarget_ = gl::Framebuffer("depth", {}, &depth_);
  displayTarget_ = gl::Framebuffer("display", display);
  multisampled_.reset();
  motionSamples_ = {};
  antialiasing_.resize(settings_.size);
  if (objectMotion_) objectMotion_->resize();
  view_.reset();
  shown_ = &radiance_;
}

void Renderer::resize(glm::ivec2 size) {
  if (size == settings_.size || size.x <= 0 || size.y <= 0) return;
  settings_.size = size;
  allocateTargets();
  if (shadowRays_) shadowRays_->resize(size);
  if (technique_) technique_->resize();
}

void Renderer::apply(const RenderSettings& settings) {
  settings_.reuse = settings.reuse;
  settings_.reprojection = settings.reprojection;
  settings_.motionSamples = settings.motionSamples;
  exposure_ = settings.exposure.value_or(sceneExposure_);
}

void Renderer::forget() {
  forgetShadows();
  view_.reset();
  antialiasing_.forget();
  if (technique_) technique_->forget();
}

void Renderer::forgetShadows() {
  sunShadowMade_ = lampShadowsMade_ = false;
  if (sunShadow_) sunShadow_->forget();
  if (localLights_) localLights_->forget();
}

int Renderer::rayShadowedLamps() const {
  const bool isByRays = settings_.shadows == ShadowTransport::rays;
  const std::size_t lamps = plainLamps_.size() + (isByRays ? spots_.size() + points_.size() : 0);
  return static_cast<int>(std::min(lamps, std::size_t{ShadowRays::kMostLights - 1}));
}

void Renderer::recordShadows(const Camera& camera, bool viewIsNew) {
  if (!settings_.reuse) forgetShadows();
  if (sunShadow_ && ((viewIsNew && sunShadow_->followsCamera()) || !sunShadowMade_)) {
    const gl::TimeQuery::Scope stage(timer_, "shadow");
    sunShadow_->record(*gpuScene_, sunFrustum_, camera, aspect(), near_);
  }
  if (localLights_ && localLights_->hasSpots() && !lampShadowsMade_) {
    const gl::TimeQuery::Scope stage(timer_, "spot shadows");
    localLights_->recordSpots(*gpuScene_);
  }
  if (localLights_ && localLights_->hasPoints() && !lampShadowsMade_) {
    const gl::TimeQuery::Scope stage(timer_, "point shadows");
    localLights_->recordPoints(*gpuScene_);
  }
  sunShadowMade_ = lampShadowsMade_ = true;
}

FrameView Renderer::viewOf(const Camera& cameraInScene, const Camera& volumeCameraInScene,
                           const glm::dvec2& offset) const {
  FrameView view{cameraInScene, volumeCameraInScene, glm::dmat4(1.0), glm::mat4(1.0f), glm::vec3(0.0f)};
  view.offset = offset;
  view.camera.position -= origin_;
  view.volumeCamera.position -= origin_;
  view.clip = clipFromWorld(view.camera, gpuScene_->scene().bounds, near_, settings_.size);
  if (offset != glm::dvec2(0.0)) {
    const glm::dvec2 moved = -2.0 * offset / glm::dvec2(settings_.size);
    view.clip = glm::translate(glm::dmat4(1.0), glm::dvec3(moved, 0.0)) * view.clip;
  }
  view.clipFromWorld = glm::mat4(view.clip);
  view.viewPoint = glm::vec3(view.camera.position);
  return view;
}

gl::Lines::View Renderer::linesView(const Camera& cameraInScene, const Bounds& boundsInScene) const {
  Camera camera = cameraInScene;
  camera.position -= origin_;
  Bounds bounds = boundsInScene;
  bounds.min -= origin_;
  bounds.max -= origin_;
  const glm::mat4 clip(clipFromWorld(camera, bounds, near_, settings_.size));
  if (camera.isOrthographic()) return {clip};  // its clip w, 1, is no distance to compare with the depth's
  return {clip, static_cast<float>(near_), static_cast<float>(farPlane(camera, bounds)), depth()};
}

void Renderer::bindFrameConstants(const FrameView& view) {
  const Scene& scene = gpuScene_->scene();
  shared::FrameConstants frame{};
  frame.clipFromWorld = view.clipFromWorld;
  frame.cameraPosition = view.viewPoint;
  frame.exposure = exposure_;
  frame.pixelSample = view.sample;
  frame.pixelSamples = settings_.pixelSamples;
  if (settings_.filter != PixelFilter::centre)
    frame.sampleArea = 1.0f / static_cast<float>(moves_ ? motionSamples() : settings_.pixelSamples);
  if (scene.sun) {
    frame.sunClipFromWorld = glm::mat4(sunFrustum_.clipFromWorld);
    frame.sunDirection = glm::vec3(scene.sun->direction);
    frame.sunIrradiance = scene.sun->irradiance;
    if (sunHasPenumbra()) frame.sunTangent = static_cast<float>(std::tan(0.5 * scene.sun->angularDiameter));
    frame.shadowNormalOffset =
        SunShadow::normalOffset(std::max(sunFrustum_.width, sunFrustum_.height) / settings_.shadow.size);
  }
  frame.background = scene.background;
  if (view.camera.isOrthographic()) frame.orthographicAxis = glm::vec3(view.camera.direction);
  bindFrameConstants(frame);
}

void Renderer::bindFrameConstants(const shared::FrameConstants& constants) {
  frameConstants_.upload(0, sizeof constants, &constants);
  frameConstants_.bindUniform(BLOCK_FRAME);
}

void Renderer::bindForShading() const {
  if (shadowRays_) shadowRays_->bindForShading();
  if (sunShadow_) sunShadow_->bindForShading();
  if (localLights_) localLights_->bindForShading();
  if (technique_) technique_->bindForShading();
}

// Both sides at once, unless the technique's geometry needs them apart.
std::span<const GeometryTechnique::Sides> Renderer::sides() const {
  static constexpr GeometryTechnique::Sides kBoth;
  return geometry_ ? geometry_->sides() : std::span(&kBoth, 1);
}

void Renderer::drawDepth(const gl::Framebuffer& target, const FrameView& view) {
  const auto all = sides();
  for (const GeometryTechnique::Sides& sides : all) {
    const gl::RasterPass pass("depth", target, stateOf(sides, gl::Depth::lessWrite));
    if (&sides == &all.front()) pass.clearDepth();
    gpuScene_->draw(depthPrograms_, view.drawn());
  }
}

const gl::Framebuffer& Renderer::surfaceTarget() {
  if (settings_.multisamples <= 1) return radianceTarget_;
  if (!multisampled_)
    multisampled_.emplace("multisampled", radiance_.format(), depth_.format(), settings_.size, settings_.multisamples);
  return multisampled_->target();
}

void Renderer::shade(const FrameView& view, bool depthIsDrawn) {
  const gl::TimeQuery::Scope stage(timer_, "shading");
  const auto all = sides();
  const gl::Framebuffer& target = surfaceTarget();
  if (!depthIsDrawn) drawDepth(depthTarget_, view);
  if (multisampled_) drawDepth(target, view);
  bindForShading();
  for (const GeometryTechnique::Sides& sides : all) {
    const gl::RasterPass pass("surfaces", target, stateOf(sides, gl::Depth::equalReadOnly));
    const bool showsBackground = settings_.component != Component::indirect;
    if (&sides == &all.front())
      pass.clearColor(0, glm::vec4(showsBackground ? gpuScene_->scene().background : glm::vec3(0.0f), 1.0f));
    if (geometry_) geometry_->draw(pass, surfacePrograms_, view);
    else
      surfaceChunks_.forEach(settings_.size, iterationsOfSurface(), 1,
                             [&](const glm::ivec2& corner, const glm::ivec2& size) {
                               pass.restrictTo(corner, size);
                               gpuScene_->draw(surfacePrograms_, view.drawn());
                             });
  }
}

// Depth is known, so that a pixel shades one surface: its textures, nine texels of the sun's shadow map, four taps of
// each lamp's, those of penumbrae, and a lookup of what a technique adds.
double Renderer::iterationsOfSurface() const {
  constexpr double kIterationsOfMaterial = 4.0, kIterationsOfSun = 9.0, kIterationsOfLamp = 4.0;
  const int suns = sunShadow_ ? std::max(sunShadow_->cascades(), 1) : 0;
  const double lamps = localLights_ ? static_cast<double>(spots_.size() + points_.size() + plainLamps_.size()) : 0.0;
  const double penumbra = settings_.shadow.filter == ShadowFilter::pcss ? 1.5 * settings_.shadow.taps : 0.0;
  return kIterationsOfMaterial + (kIterationsOfSun + penumbra) * suns + (kIterationsOfLamp + penumbra) * lamps +
         (technique_ ? technique_->iterationsOfPixel() : 0.0);
}

double Renderer::largestIterations() const {
  return std::max({surfaceChunks_.largestIterations(), shadowRays_ ? shadowRays_->largestIterations() : 0.0,
                   technique_ ? technique_->largestIterations() : 0.0});
}

// Whether the view is another than that of the frame before.
bool Renderer::beginView(const Camera& camera, const Camera& volumeCamera) {
  if (view_ && camera.seesAs(view_->camera) && volumeCamera.seesAs(view_->volumeCamera)) return false;
  view_ = View{camera, volumeCamera, std::vector<bool>(samples_.size(), false)};
  antialiasing_.clear();
  return true;
}

void Renderer::render(const Camera& camera, const Camera& volumeCamera) {
  const bool viewMoves = beginView(camera, volumeCamera), moves = moves_ = viewMoves || lightChanges();
  if (!accumulates()) {
    drawSample(0, {.isLive = true});
  } else if (!isSettled()) {
    const bool measures = moves && settings_.motionSamples == 0;
    if (measures) sampleTimer_.begin();
    const int samples = moves ? motionSamples() : 1;
    for (int i = 0; i < samples && !isSettled(); ++i) {
      const int summed = antialiasing_.count();
      const int sample = summed > 0 ? summed : moves || view_->lacksLight ? nextSample_++ % settings_.pixelSamples : 0;
      drawSample(sample, {.isFurtherSample = i > 0});
      showAccumulated(sample, moves && i == 0);
      if (measures && i == 0) sampleTimer_.split();
    }
    if (measures) chooseMotionSamples(samples);
  } else {
    bindFrameConstants(viewOf(camera, volumeCamera));  // for the exposure
  }
  toneMap();
  endFrame();
}

// Frames with all their light are added up in order; until then, and while the view moves, the running mean is shown.
void Renderer::showAccumulated(int sample, bool moves) {
  const gl::TimeQuery::Scope stage(timer_, "antialiasing");
  const bool lightMoves = std::exchange(lightMoves_, false) || lightChanges();
  const bool hasAllLight = !technique_ || technique_->isSettled();
  if (!hasAllLight) antialiasing_.clear();
  else if (sample == antialiasing_.count()) antialiasing_.add(radiance_, noAttributes_);
  view_->lacksLight = !hasAllLight;
  if (isSettled()) {
    antialiasing_.writeMean(radianceTarget_, noAttributes_);
    shown_ = &radiance_;
    return;
  }
  const FrameView centred = viewOf(view_->camera, view_->volumeCamera);
  Antialiasing::Frame frame{
      radiance_, depth_, centred.clip, centred.camera.position, samples_[static_cast<std::size_t>(sample)], lightMoves};
  if (moves && settings_.reprojection && objectMotion_ && gpuScene_->hasMoved()) {
    objectMotion_->draw(*gpuScene_, depth_, centred.clip, antialiasing_.clipBefore());
    frame.objectMotion = &objectMotion_->texture();
  }
  antialiasing_.accumulate(frame, moves, settings_.reprojection, settings_.pixelSamples, noAttributes_);
  if (settings_.reprojection) gpuScene_->keepPlaces();
  else gpuScene_->forgetPlaces();
  shown_ = &antialiasing_.shown();
}

int Renderer::motionSamples() const {
  return settings_.motionSamples > 0 ? settings_.motionSamples : std::min(motionSamples_.now(), settings_.pixelSamples);
}

void Renderer::chooseMotionSamples(int drawn) {
  for (const gl::SplitTimer::Times& times : sampleTimer_.end(drawn))
    // A frame that was on its way when the number changed tells nothing about the new one.
    if (times.label == motionSamples()) motionSamples_.add(times.first, times.second, settings_.pixelSamples);
}

bool Renderer::isSettled() const {
  if (accumulates()) return antialiasing_.count() == settings_.pixelSamples;
  return !technique_ || technique_->isSettled();
}

void Renderer::renderSamples(const Camera& camera, const Camera& volumeCamera) {
  drawSamples(camera, volumeCamera, {});
}

void Renderer::renderToTheEnd(const Camera& camera) { drawSamples(camera, camera, {true, false}); }

// All samples of one picture, with all their light where the whole picture is asked for: that of what any of them shows
// comes with the first.
void Renderer::drawSamples(const Camera& camera, const Camera& volumeCamera, FrameEffort effort) {
  beginView(camera, volumeCamera);
  moves_ = false;
  antialiasing_.clear();
  const int samples = accumulates() ? settings_.pixelSamples : 1;
  const bool findsAll = technique_ && effort.wholePicture;
  const auto drawFirst = [&] {
    for (int further = 1; findsAll && further < samples; ++further) {
      const FrameView view = viewOf(camera, volumeCamera, samples_[static_cast<std::size_t>(further)]);
      bindFrameConstants(view);
      technique_->see(timer_, view);
    }
    drawSample(0, effort);
    if (findsAll) technique_->collect(true);
  };
  drawFirst();
  for (std::size_t frames = 0; findsAll && technique_->lacksLight(frames); ++frames) drawFirst();
  effort.isFurtherSample = findsAll;
  const bool reuse = std::exchange(settings_.reuse, true);  // samples share what does not depend on the view
  for (int sample = 0; sample < samples; ++sample) {
    if (sample > 0) drawSample(sample, effort);
    if (accumulates()) antialiasing_.add(radiance_, noAttributes_);
  }
  settings_.reuse = reuse;
  if (accumulates()) antialiasing_.writeMean(radianceTarget_, noAttributes_);
  shown_ = &radiance_;
  toneMap();
  endFrame();
}

void Renderer::drawSample(int sample, FrameEffort effort) {
  if (picture_) {
    picture_->recordPicture(timer_, view_->camera, effort);
    shared::FrameConstants constants{};  // set after the technique's own constants, which share the binding
    constants.exposure = exposure_;
    bindFrameConstants(constants);
    return;
  }
  const auto index = static_cast<std::size_t>(sample);
  FrameView view = viewOf(view_->camera, view_->volumeCamera, samples_[index]);
  view.sample = sample;
  view.isNew = !view_->drawn[index];
  const bool viewIsNew = std::ranges::none_of(view_->drawn, [](bool drawn) { return drawn; });
  view_->drawn[index] = true;
  drawFrame(view, effort, viewIsNew);
}

void Renderer::drawFrame(const FrameView& view, FrameEffort effort, bool viewIsNew) {
  bindFrameConstants(view);
  recordShadows(view.camera, viewIsNew);
  if (shadowRays_) {
    const gl::TimeQuery::Scope stage(timer_, "shadow rays");
    if (localLights_) localLights_->bindForShading();  // its lamps
    shadowRays_->record({view.camera, view.offset, view.sample, settings_.pixelSamples});
  }
  const bool depthIsDrawn = technique_ && technique_->record(timer_, view, effort);
  shade(view, depthIsDrawn);
  if (environmentView_) {
    const gl::TimeQuery::Scope stage(timer_, "environment");
    environmentView_->record(surfaceTarget(), noAttributes_, view.camera, settings_.size, view.offset);
  }
  if (multisampled_) multisampled_->resolveTo(radianceTarget_);
  if (technique_) technique_->addToPicture(timer_, view);
}

void Renderer::toneMap() {
  const gl::TimeQuery::Scope stage(timer_, "tone mapping");
  const gl::RasterPass pass("tone map", displayTarget_, {});
  toneMap_->use();
  shown_->bind(0);
  gl::drawFullScreen(noAttributes_);
}

void Renderer::endFrame() {
  timer_.collect();
  if (technique_) technique_->collect(false);
  gl::throwIfReset();
  // Checked occasionally: glGetError stalls drivers with their own threads. Readers of a result check again.
  constexpr std::uint64_t kFramesBetweenLooks = 64;
  if (++frames_ % kFramesBetweenLooks == 1) gl::throwIfError("a frame");
}

void Renderer::drain() {
  timer_.drain();
  if (technique_) technique_->collect(true);
}

Image Renderer::readRadiance() const { return gl::readImage(*shown_); }

Bitmap Renderer::readDisplay() const { return gl::readBitmap(display_, settings_.size); }

std::size_t Renderer::gpuBytes() const {
  std::size_t bytes = frameConstants_.bytes() + radiance_.bytes() + depth_.bytes() + display_.bytes() +
                      antialiasing_.gpuBytes() + (objectMotion_ ? objectMotion_->gpuBytes() : 0) +
                      (multisampled_ ? multisampled_->bytes() : 0);
  if (gpuScene_) bytes += gpuScene_->gpuBytes();
  if (sunShadow_) bytes += sunShadow_->gpuBytes();
  if (localLights_) bytes += localLights_->gpuBytes();
  if (shadowRays_) bytes += shadowRays_->gpuBytes();
  bytes += traced_.gpuBytes();
  if (technique_) bytes += technique_->gpuBytes();
  if (environmentView_) bytes += environmentView_->gpuBytes();
  return bytes;
}

std::vector<StagePicture> Renderer::stagePictures() const {
  std::vector<StagePicture> pictures;
  if (sunShadow_)
    pictures.push_back(
        {StagePicture::Kind::depth, sunShadow_->followsCamera() ? "sun cascades" : "shadow map", &sunShadow_->depth()});
  if (technique_) technique_->addStagePictures(pictures);
  if (gpuScene_) pictures.push_back({StagePicture::Kind::depth, "depth", &depth_});
  if (antialiasing_.hasShown())
    pictures.push_back({StagePicture::Kind::samples, "samples a pixel", &antialiasing_.shown()});
  return pictures;
}

std::vector<std::string> Renderer::leftOut() const {
  std::vector<std::string> names;
  for (const auto& [name, needed] : features_.named())
    if (!needed) names.push_back(name);
  const std::pair<const char*, bool> stages[] = {{"shadow map", sunShadow_.has_value()},
                                                 {"shadow rays", shadowRays_.has_value()},
                                                 {"sun cascades", sunShadow_ && sunShadow_->followsCamera()},
                                                 {"spot shadow maps", localLights_ && localLights_->hasSpots()},
                                                 {"point shadow maps", localLights_ && localLights_->hasPoints()},
                                                 {"environment behind surfaces", environmentView_.has_value()}};
  for (const auto& [name, there] : stages)
    if (!there) names.emplace_back(name);
  // Stages of techniques; some share one.
  const TechniqueEntry& own = techniqueNamed(settings_.technique);
  for (const TechniqueEntry& technique : allTechniques())
    for (const std::string_view stage : technique.stages) {
      const bool isOwn = technique_ && std::ranges::find(own.stages, stage) != own.stages.end();
      if (!isOwn && std::ranges::find(names, stage) == names.end()) names.emplace_back(stage);
    }
  if (technique_) technique_->addLeftOut(names);
  return names;
}

}  // namespace lucerna
