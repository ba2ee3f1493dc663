#include "render/renderer.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "rsm/lamp_choice.hpp"
#include "scene/place.hpp"
#include "shared/bindings.h"
#include "shared/lpv.h"
#include "shared/sun_cascades.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace lucerna {

namespace {

constexpr float kShadowNormalOffset = 0.1f;  // texels of the sun's shadow map

double farPlane(const Camera& camera, const Bounds& bounds) {
  double farthest = std::max(glm::length(bounds.extent()), 1e-6);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                       corner & 4 ? bounds.max.z : bounds.min.z);
    farthest = std::max(farthest, glm::length(p - camera.position));
  }
  return 1.01 * farthest;
}

double nearPlane(const Bounds& bounds) { return 5e-4 * std::max(glm::length(bounds.extent()), 1e-6); }

// Near and far planes follow the scene: far just behind its farthest corner, near at 1/2000 of its diagonal.
glm::dmat4 clipFromWorld(const Camera& camera, const Bounds& bounds, glm::ivec2 size) {
  const double aspect = static_cast<double>(size.x) / size.y;
  return glm::perspective(camera.verticalFov, aspect, nearPlane(bounds), farPlane(camera, bounds)) *
         glm::lookAt(camera.position, camera.position + camera.direction, camera.up);
}

}  // namespace

Renderer::Renderer(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                   const RenderSettings& settings)
    : settings_(settings),
      features_(analyse(scene)),
      origin_(floatingOrigin(scene.bounds)),
      sceneExposure_(scene.exposure),
      exposure_(settings.exposure.value_or(scene.exposure)),
      timer_(context.capabilities().softwareRenderer),
      frameConstants_("frame constants", sizeof(shared::FrameConstants), nullptr, gl::Usage::dynamicDraw),
      noAttributes_("full screen"),
      surfaceChunks_(settings.unmeasuredIterations) {
  allocateTargets();
  const Technique technique = settings.technique;
  if (technique == Technique::path) {
    path_.emplace(context, programs, scene, settings_);
    toneMap_ = &programs.loadRaster("tone map", "lib/fullscreen.vert", "forward/tonemap.frag");
    return;
  }
  if (technique == Technique::radiosity) radiosity_.emplace(context, programs, scene, settings_, origin_);
  const std::optional<Haze> haze = asksForShafts() ? hazeOf(aboutOrigin(scene)) : std::nullopt;
  if (asksForShafts() && !haze)
    logWarning(
        "lpv.shafts: the scene has no homogeneous medium, within a boundary of bsdf none or about the camera: nothing "
        "scatters");
  settings_.rsm.haze = haze.has_value();
  settings_.textures.boundaries = !haze;
  gpuScene_.emplace(radiosity_ ? radiosity_->scene() : aboutOrigin(scene), features_, context.capabilities(),
                    settings_.textures);
  if (moved_) moved_->textures.clear();  // they are on the GPU now
  const Scene& drawn = gpuScene_->scene();
  if (scene.sun) sunFrustum_ = fitSunFrustum(drawn, scene.sun->direction);
  spots_ = spotViews(drawn);
  points_ = pointViews(drawn);
  const bool reflectsLamps = LpvFrame::isNeeded(settings, features_) || RsmFrame::isNeeded(settings, features_) ||
                             IrradianceCacheFrame::takesMaps(settings, features_);
  if ((showsDirect() || reflectsLamps) && LocalLights::isNeeded(features_)) {
    keepMostImportant(programs, *gpuScene_, spots_, LocalLights::kMostSpots);
    keepMostImportant(programs, *gpuScene_, points_, LocalLights::kMostPoints);
  }
  if (showsDirect()) makeShadowMaps(programs);

  const FrameParts frame{context, programs,   settings_,   features_, scene,
                         origin_, *gpuScene_, sunFrustum_, spots_,    points_};
  if (RsmFrame::isNeeded(settings, features_)) rsm_.emplace(frame, depth_);
  if (LpvFrame::isNeeded(settings, features_)) lpv_.emplace(frame);
  if (IrradianceCacheFrame::isNeeded(settings, features_)) cache_.emplace(frame, depth_);
  if (EnvironmentView::isNeeded(features_) && settings.component != Component::indirect)
    environmentView_.emplace(programs, scene);
  if (haze) makeShafts(programs, *haze);
  loadPrograms(programs);

  if (features_.environment && !cache_ && !radiosity_)
    logWarning("technique {}: the environment lights nothing (path, radiosity and irradiance-cache support it)",
               nameOf(technique));
}

bool Renderer::showsDirect() const {
  return features_.anyLight() && settings_.component != Component::indirect && !radiosity_;
}

const Scene& Renderer::aboutOrigin(const Scene& scene) {
  if (origin_ == glm::dvec3(0.0)) return scene;
  return moved_ ? *moved_ : moved_.emplace(movedTo(scene, origin_));
}

bool Renderer::asksForShafts() const { return settings_.technique == Technique::lpv && settings_.lpv.shafts; }

void Renderer::makeShafts(gl::ProgramLibrary& programs, const Haze& haze) {
  LightShafts::Settings shafts;
  shafts.steps = settings_.lpv.shaftSteps;
  shafts.sun = showsSun();
  shafts.sunCascades = sunCascades_ ? settings_.sunCascades.cascades : 0;
  shafts.volume = lpv_.has_value();
  shafts.fullFloat = settings_.fullFloatTarget;
  shafts.lookup = LightPropagationVolume::lookupFlags(settings_.lpv);
  shafts.unmeasuredIterations = settings_.unmeasuredIterations;
  shafts_.emplace(programs, haze, shafts);
}

void Renderer::makeShadowMaps(gl::ProgramLibrary& programs) {
  const bool showsSunLight = ShadowMap::isNeeded(features_);
  const int cascades = settings_.sunCascades.cascades;
  if (showsSunLight && cascades > 1) {
    sunCascades_.emplace(programs, *gpuScene_, "sun cascades",
                         LayeredDepth::Shape{gl::TextureKind::array, settings_.shadow.size, cascades, cascades, true});
    sunCascadeConstants_ =
        gl::Buffer("sun cascades", sizeof(shared::SunCascadeConstants), nullptr, gl::Usage::dynamicDraw);
  } else if (showsSunLight) {
    shadowMap_.emplace(programs, *gpuScene_, settings_.shadow);
  }
  if (LocalLights::isNeeded(features_)) localLights_.emplace(programs, *gpuScene_, settings_.lights, spots_, points_);
}

SurfacePrograms Renderer::surfacePrograms(gl::ProgramLibrary& programs, bool asked) const {
  if (radiosity_) return radiosity_->loadPrograms(programs, *gpuScene_, asked);
  const auto loadSurface = [&](const std::string& name, bool masked) {
    gl::ShaderFlags flags = gpuScene_->materialFlags(masked);
    const bool showsRest = settings_.component != Component::indirect;  // specular and emission belong to direct light
    flags.insert(flags.end(), {{"SUN", showsSun()},
                               {"SUN_CASCADES", sunCascades_ ? settings_.sunCascades.cascades : 0},
                               {"HAZE", shafts_.has_value()},
                               {"SPOTS", localLights_ ? static_cast<int>(spots_.size()) : 0},
                               {"POINTS", localLights_ ? static_cast<int>(points_.size()) : 0},
                               {"SPECULAR", features_.specular && showsDirect()},
                               {"EMISSION", features_.emission && showsRest},
                               {"ASKED", asked}});
    gl::ShaderFlags own;  // of the technique: one of the first three below; the others are 0
    forTechniques(*this, [&](const auto& technique) {
      if constexpr (requires { technique.shadingFlags(); }) own = technique.shadingFlags();
    });
    flags.insert(flags.end(), own.begin(), own.end());
    for (const char* flag : {"PROPAGATED", "IRRADIANCE_CACHE", "GATHERED", "SHOW_REFUSED", "GLOSSY"})
      if (std::none_of(own.begin(), own.end(), [&](const auto& o) { return o.first == flag; }))
        flags.push_back({flag, 0});
    return &programs.loadRaster(name, "forward/surface.vert", "forward/surface.frag", flags);
  };
  SurfacePrograms result;
  result.opaque = loadSurface("surface opaque", false);
  if (features_.alphaMasks) result.masked = loadSurface("surface masked", true);
  return result;
}

void Renderer::loadPrograms(gl::ProgramLibrary& programs) {
  surfacePrograms_ = surfacePrograms(programs, false);
  depthPrograms_.opaque =
      &programs.loadRaster("depth opaque", "forward/depth.vert", "", {{"ALPHA_MASK", 0}, {"FROM_SUN", 0}});
  if (features_.alphaMasks)
    depthPrograms_.masked = &programs.loadRaster("depth masked", "forward/depth.vert", "forward/depth.frag",
                                                 {{"ALPHA_MASK", 1}, {"FROM_SUN", 0}});
  toneMap_ = radiosity_ ? radiosity_->loadMapping(programs) : nullptr;
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
}

void Renderer::resize(glm::ivec2 size) {
  if (size == settings_.size || size.x <= 0 || size.y <= 0) return;
  settings_.size = size;
  allocateTargets();
  forTechniques(*this, [&](auto& technique) {
    if constexpr (requires { technique.resize(depth_); }) technique.resize(depth_);
  });
  if (path_) path_->resize(size);
}

void Renderer::apply(const RenderSettings& settings) {
  settings_.reuse = settings.reuse;
  exposure_ = settings.exposure.value_or(sceneExposure_);
}

void Renderer::forget() {
  shadowsMade_ = false;
  forTechniques(*this, [](auto& technique) {
    if constexpr (requires { technique.forget(); }) technique.forget();
  });
}

void Renderer::recordShadows(const Camera& camera) {
  const bool areMade = settings_.reuse && shadowsMade_;
  if (shadowMap_ && !areMade) {
    const gl::TimeQuery::Scope stage(timer_, "shadow");
    shadowMap_->record(*gpuScene_);
  }
  if (sunCascades_) {
    const gl::TimeQuery::Scope stage(timer_, "shadow");
    const Scene& scene = gpuScene_->scene();
    const double aspect = static_cast<double>(settings_.size.x) / settings_.size.y;
    shared::SunCascadeConstants constants{};
    std::vector<LayeredDepth::View> views;
    for (const SunCascade& cascade : placeSunCascades(settings_.sunCascades, scene, scene.sun->direction, sunFrustum_,
                                                      camera, aspect, nearPlane(scene.bounds), sunCascades_->size())) {
      constants.clipFromWorld[views.size()] = glm::mat4(cascade.clipFromWorld);
      constants.normalOffset[static_cast<int>(views.size())] = kShadowNormalOffset * static_cast<float>(cascade.texel);
      views.push_back({glm::mat4(cascade.clipFromWorld), glm::vec3(0.0f)});
    }
    sunCascadeConstants_.upload(0, sizeof constants, &constants);
    sunCascadeConstants_.bindUniform(BLOCK_SUN_CASCADES);
    sunCascades_->record(*gpuScene_, views);
  }
  if (localLights_ && localLights_->hasSpots() && !areMade) {
    const gl::TimeQuery::Scope stage(timer_, "spot shadows");
    localLights_->recordSpots(*gpuScene_);
  }
  if (localLights_ && localLights_->hasPoints() && !areMade) {
    const gl::TimeQuery::Scope stage(timer_, "point shadows");
    localLights_->recordPoints(*gpuScene_);
  }
  shadowsMade_ = true;
}

FrameView Renderer::viewOf(const Camera& cameraInScene, const Camera& volumeCameraInScene) const {
  FrameView view{cameraInScene, volumeCameraInScene, glm::dmat4(1.0), glm::mat4(1.0f), glm::vec3(0.0f)};
  view.camera.position -= origin_;
  view.volumeCamera.position -= origin_;
  view.clip = clipFromWorld(view.camera, gpuScene_->scene().bounds, settings_.size);
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
  return {glm::mat4(clipFromWorld(camera, bounds, settings_.size)), static_cast<float>(nearPlane(bounds)),
          static_cast<float>(farPlane(camera, bounds)), depth()};
}

void Renderer::bindFrameConstants(const FrameView& view) {
  const Scene& scene = gpuScene_->scene();
  shared::FrameConstants frame{};
  frame.clipFromWorld = view.clipFromWorld;
  frame.cameraPosition = view.viewPoint;
  frame.exposure = exposure_;
  if (scene.sun) {
    frame.sunClipFromWorld = glm::mat4(sunFrustum_.clipFromWorld);
    frame.sunDirection = glm::vec3(scene.sun->direction);
    frame.sunIrradiance = scene.sun->irradiance;
    frame.shadowNormalOffset =
        kShadowNormalOffset *
        static_cast<float>(std::max(sunFrustum_.width, sunFrustum_.height) / settings_.shadow.size);
  }
  frame.background = scene.background;
  bindFrameConstants(frame);
}

void Renderer::bindFrameConstants(const shared::FrameConstants& constants) {
  frameConstants_.upload(0, sizeof constants, &constants);
  frameConstants_.bindUniform(BLOCK_FRAME);
}

void Renderer::bindForShading() const {
  if (shadowMap_) shadowMap_->depth().bind(UNIT_SUN_SHADOW);
  if (sunCascades_) {
    sunCascades_->depth().bind(UNIT_SUN_SHADOW);
    sunCascadeConstants_.bindUniform(BLOCK_SUN_CASCADES);
  }
  if (localLights_) localLights_->bindForShading();
  forTechniques(*this, [](const auto& technique) {
    if constexpr (requires { technique.bindForShading(); }) technique.bindForShading();
  });
}

void Renderer::shade(const FrameView& view, bool depthIsDrawn) {
  const gl::TimeQuery::Scope stage(timer_, "shading");
  using Sides = RadiosityFrame::Sides;
  const Sides both;
  const auto all = radiosity_ ? RadiosityFrame::sides() : std::span<const Sides>(&both, 1);
  if (!depthIsDrawn)
    for (const Sides& sides : all) {
      gl::RasterState state;
      state.depth = gl::Depth::lessWrite;
      state.cull = sides.cull;
      state.polygonOffset = sides.polygonOffset;
      const gl::RasterPass pass("depth", depthTarget_, state);
      if (&sides == &all.front()) pass.clearDepth();
      gpuScene_->draw(depthPrograms_, view.drawn());
    }
  bindForShading();
  for (const Sides& sides : all) {
    gl::RasterState state;
    state.depth = gl::Depth::equalReadOnly;
    state.cull = sides.cull;
    state.polygonOffset = sides.polygonOffset;
    const gl::RasterPass pass("surfaces", radianceTarget_, state);
    const bool showsBackground = settings_.component != Component::indirect;
    if (&sides == &all.front())
      pass.clearColor(0, glm::vec4(showsBackground ? gpuScene_->scene().background : glm::vec3(0.0f), 1.0f));
    if (radiosity_) radiosity_->draw(pass, *gpuScene_, surfacePrograms_, view);
    else
      surfaceChunks_.forEach(settings_.size, iterationsOfSurface(), 1,
                             [&](const glm::ivec2& corner, const glm::ivec2& size) {
                               pass.restrictTo(corner, size);
                               gpuScene_->draw(surfacePrograms_, view.drawn());
                             });
  }
}

// Depth is known, so that a pixel shades one surface: its textures, nine texels of the sun's shadow map, four taps of
// each lamp's, and a lookup of what a technique adds.
double Renderer::iterationsOfSurface() const {
  constexpr double kIterationsOfMaterial = 4.0, kIterationsOfSun = 9.0, kIterationsOfLamp = 4.0,
                   kIterationsOfIndirect = 24.0;
  const int suns = sunCascades_ ? settings_.sunCascades.cascades : static_cast<int>(shadowMap_.has_value());
  const double lamps = localLights_ ? static_cast<double>(spots_.size() + points_.size()) : 0.0;
  constexpr double kIterationsOfCell = 8.0;
  const double glossy =
      lpv_ && lpv_->isGlossy() ? LPV_GLOSSY_RAYS * kIterationsOfCell * settings_.lpv.glossySteps : 0.0;
  return kIterationsOfMaterial + kIterationsOfSun * suns + kIterationsOfLamp * lamps +
         (lpv_ || cache_ ? kIterationsOfIndirect : 0.0) + glossy;
}

double Renderer::largestIterations() const {
  double largest = std::max(surfaceChunks_.largestIterations(), shafts_ ? shafts_->largestIterations() : 0.0);
  forTechniques(*this, [&](const auto& technique) {
    if constexpr (requires { technique.largestIterations(); })
      largest = std::max(largest, technique.largestIterations());
  });
  return largest;
}

void Renderer::recordShafts(const FrameView& view) {
  const gl::TimeQuery::Scope stage(timer_, "light shafts");
  if (shadowMap_) shadowMap_->depth().bind(UNIT_SUN_SHADOW);
  if (sunCascades_) sunCascades_->depth().bind(UNIT_SUN_SHADOW);
  if (lpv_) lpv_->bindForShading();
  shafts_->record(radiance_, depth_, view.clip);
}

void Renderer::render(const Camera& camera, const Camera& volumeCamera) { renderFrame(camera, volumeCamera, {}); }

void Renderer::renderToTheEnd(const Camera& camera) {
  renderFrame(camera, camera, {true, false});
  if (!cache_) return;
  cache_->collect(true);
  const IrradianceCache& cache = cache_->cache();
  for (std::size_t frames = 0; cache.counts().waiting > 0; ++frames) {
    if (frames > cache.mostFrames())
      throw Error(ErrorKind::fault, fmt::format("internal error: after {} frames {} records of {} still lack light",
                                                frames, cache.counts().waiting, cache.counts().records));
    renderFrame(camera, camera, {false, false});
    cache_->collect(true);
  }
}

void Renderer::renderFrame(const Camera& camera, const Camera& volumeCamera, FrameEffort effort) {
  if (path_) {
    path_->record(timer_, camera, radianceTarget_, noAttributes_, effort.wholePicture);
    shared::FrameConstants constants{};  // set after the path tracer's own constants, which share the binding
    constants.exposure = exposure_;
    bindFrameConstants(constants);
  } else {
    const FrameView view = viewOf(camera, volumeCamera);
    bindFrameConstants(view);
    if (shafts_) shafts_->bind();
    recordShadows(view.camera);
    if (rsm_) rsm_->record(timer_, view);
    const bool depthIsDrawn = (cache_ && cache_->record(timer_, view, effort)) || rsm_;
    if (lpv_) lpv_->record(timer_, view);
    shade(view, depthIsDrawn);
    if (environmentView_) {
      const gl::TimeQuery::Scope stage(timer_, "environment");
      environmentView_->record(radianceTarget_, noAttributes_, view.camera, settings_.size);
    }
    if (shafts_) recordShafts(view);
  }
  {
    const gl::TimeQuery::Scope stage(timer_, "tone mapping");
    const gl::RasterPass pass("tone map", displayTarget_, {});
    toneMap_->use();
    radiance_.bind(0);
    gl::drawFullScreen(noAttributes_);
  }
  timer_.collect();
  if (rsm_) rsm_->collect();
  gl::throwIfReset();
  // Checked occasionally: glGetError stalls drivers with their own threads. Readers of a result check again.
  constexpr std::uint64_t kFramesBetweenLooks = 64;
  if (++frames_ % kFramesBetweenLooks == 1) gl::throwIfError("a frame");
}

void Renderer::drain() {
  timer_.drain();
  if (rsm_) rsm_->collect(true);
  if (cache_) cache_->collect(true);
}

Image Renderer::readRadiance() const {
  const std::vector<glm::vec4> texels = radiance_.readRgba();
  Image image(settings_.size.x, settings_.size.y);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) =
          glm::vec3(texels[static_cast<std::size_t>(image.height - 1 - y) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(x)]);
  return image;
}

Bitmap Renderer::readDisplay() const {
  const std::vector<glm::vec4> texels = display_.readRgba();
  Bitmap bitmap;
  bitmap.width = settings_.size.x;
  bitmap.height = settings_.size.y;
  bitmap.rgba.reserve(4 * texels.size());
  for (int y = bitmap.height - 1; y >= 0; --y)
    for (int x = 0; x < bitmap.width; ++x) {
      const glm::vec4& texel =
          texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(bitmap.width) + static_cast<std::size_t>(x)];
      for (int channel = 0; channel < 4; ++channel)
        bitmap.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * texel[channel])));
    }
  return bitmap;
}

std::size_t Renderer::gpuBytes() const {
  std::size_t bytes = frameConstants_.bytes() + radiance_.bytes() + depth_.bytes() + display_.bytes();
  if (gpuScene_) bytes += gpuScene_->gpuBytes();
  if (shadowMap_) bytes += shadowMap_->gpuBytes();
  if (sunCascades_) bytes += sunCascades_->gpuBytes() + sunCascadeConstants_.bytes();
  if (localLights_) bytes += localLights_->gpuBytes();
  forTechniques(*this, [&](const auto& technique) { bytes += technique.gpuBytes(); });
  if (environmentView_) bytes += environmentView_->gpuBytes();
  if (shafts_) bytes += shafts_->gpuBytes();
  return bytes;
}

std::vector<StagePicture> Renderer::stagePictures() const {
  std::vector<StagePicture> pictures;
  if (shadowMap_) pictures.push_back({StagePicture::Kind::depth, "shadow map", &shadowMap_->depth()});
  if (sunCascades_) pictures.push_back({StagePicture::Kind::depth, "sun cascades", &sunCascades_->depth()});
  forTechniques(*this, [&](const auto& technique) {
    if constexpr (requires { technique.addStagePictures(pictures); }) technique.addStagePictures(pictures);
  });
  if (!path_) pictures.push_back({StagePicture::Kind::depth, "depth", &depth_});
  return pictures;
}

std::vector<std::string> Renderer::leftOut() const {
  std::vector<std::string> names;
  for (const auto& [name, needed] : features_.named())
    if (!needed) names.push_back(name);
  const bool hasMaps = rsm_ || (lpv_ && lpv_->hasMaps()) || (cache_ && cache_->hasMaps());
  const std::pair<const char*, bool> stages[] = {{"shadow map", showsSun()},
                                                 {"sun cascades", sunCascades_.has_value()},
                                                 {"spot shadow maps", localLights_ && localLights_->hasSpots()},
                                                 {"point shadow maps", localLights_ && localLights_->hasPoints()},
                                                 {"reflective shadow map", hasMaps},
                                                 {"environment behind surfaces", environmentView_.has_value()},
                                                 {"rsm gather", rsm_.has_value()},
                                                 {"radiosity", radiosity_.has_value()},
                                                 {"shadow rays", radiosity_ && radiosity_->hasShadowRays()},
                                                 {"irradiance cache", cache_.has_value()},
                                                 {"light propagation volume", lpv_.has_value()},
                                                 {"light shafts", shafts_.has_value()},
                                                 {"glossy reflection", lpv_ && lpv_->isGlossy()}};
  for (const auto& [name, there] : stages)
    if (!there) names.emplace_back(name);
  if (lpv_) lpv_->addLeftOut(names);
  return names;
}

}  // namespace lucerna
