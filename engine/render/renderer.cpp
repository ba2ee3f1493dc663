#include "render/renderer.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "scene/place.hpp"
#include "shared/frame.h"
#include "shared/sun_cascades.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace lucerna {

namespace {

constexpr GLuint kFrameBinding = 0;
constexpr GLuint kSunCascadeBinding = 4;
constexpr GLuint kShadowUnit = 2, kGatheredUnit = 7;
constexpr float kShadowNormalOffset = 1.5f;  // texels of the sun's shadow map

constexpr double kSecondsOfPiece = 0.1;  // of a frame's shadow rays

double nearPlane(const Bounds& bounds) { return 5e-4 * std::max(glm::length(bounds.extent()), 1e-6); }

// Near and far planes follow the scene: far just behind its farthest corner, near at 1/2000 of its diagonal.
glm::dmat4 clipFromWorld(const Camera& camera, const Bounds& bounds, glm::ivec2 size) {
  const double diagonal = std::max(glm::length(bounds.extent()), 1e-6);
  double farthest = diagonal;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                       corner & 4 ? bounds.max.z : bounds.min.z);
    farthest = std::max(farthest, glm::length(p - camera.position));
  }
  const double aspect = static_cast<double>(size.x) / size.y;
  return glm::perspective(camera.verticalFov, aspect, nearPlane(bounds), 1.01 * farthest) *
         glm::lookAt(camera.position, camera.position + camera.direction, camera.up);
}

std::unique_ptr<RadiosityView> makeRadiosity(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const RenderSettings& settings,
                                             const glm::dvec3& origin) {
  if (settings.technique != Technique::radiosity) return nullptr;
  using Light = RadiosityView::Light;
  RadiosityView::Settings view = settings.radiosity;
  view.light = settings.component == Component::all ? Light::all : settings.component == Component::direct ? Light::direct : Light::indirect;
  if (view.direct == RadiosityView::Direct::pixels) {
    if (const std::size_t emitters = DirectRays::emitterCount(scene); emitters > DirectRays::kMostEmitters) {
      logWarning("radiosity: {} triangles emit, more than the {} that each pixel can ask by shadow rays: direct light is a value a patch", emitters, DirectRays::kMostEmitters);
      view.direct = RadiosityView::Direct::patches;
    }
  }
  return std::make_unique<RadiosityView>(context, programs, scene, view, origin);
}

LpvReceivers::Light receivedLight(Component component) {
  return component == Component::direct ? LpvReceivers::Light::direct : component == Component::indirect ? LpvReceivers::Light::indirect : LpvReceivers::Light::all;
}

}  // namespace

Renderer::Renderer(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const RenderSettings& settings)
    : settings_(settings),
      needs_(analyse(scene)),
      origin_(exactOrigin(scene.bounds)),
      showsDirect_(needs_.anyLight() && settings.component != Component::indirect && settings.technique != Technique::radiosity),
      showsLpv_(settings.technique == Technique::lpv && settings.lpv.transport == LpvTransport::propagate && settings.component != Component::direct && LightPropagationVolume::isNeeded(needs_)),
      showsReceivers_(settings.technique == Technique::lpv && settings.lpv.transport != LpvTransport::propagate &&
                      LpvReceivers::isNeeded(needs_, settings.lpv.transport, receivedLight(settings.component))),
      showsGather_(settings.technique == Technique::rsm && settings.component != Component::direct && RsmGather::isNeeded(needs_)),
      exposure_(settings.exposure.value_or(scene.exposure)),
      timer_(context.capabilities().softwareRenderer),
      radiosity_(makeRadiosity(context, programs, scene, settings, origin_)),
      gpuScene_(radiosity_ ? radiosity_->scene() : aboutOrigin(scene), needs_, context.capabilities(), settings.textures),
      frameConstants_("frame constants", sizeof(shared::FrameConstants), nullptr, GL_DYNAMIC_DRAW),
      noAttributes_("full screen") {
  if (settings.technique == Technique::path) throwBadInput("--technique path: a picture of its own (lucerna render); there are direct, rsm, lpv, radiosity");
  if (moved_) moved_->textures.clear();  // they are on the GPU
  const Scene& drawn = gpuScene_.scene();
  if (scene.sun) sunFrustum_ = fitSunFrustum(drawn, scene.sun->direction);
  spots_ = spotViews(drawn);
  points_ = pointViews(drawn);
  const bool showsGatheredMaps = showsReceivers_ && settings.lpv.transport == LpvTransport::gather && settings.component != Component::direct;
  if ((showsDirect_ || showsLpv_ || showsGather_ || showsGatheredMaps) && LocalLights::isNeeded(needs_)) {
    keepMostImportant(programs, gpuScene_, spots_, kMaxSpotLights);
    keepMostImportant(programs, gpuScene_, points_, kMaxPointLights);
  }
  const bool showsSun = showsDirect_ && ShadowMap::isNeeded(needs_);
  const int cascades = settings.sunCascades.cascades > 1 && showsSun ? settings.sunCascades.cascades : 0;
  if (cascades > 0) {
    sunCascades_.emplace(programs, gpuScene_, "sun cascades",
                         LayeredDepth::Shape{GL_TEXTURE_2D_ARRAY, settings.shadow.size, cascades, cascades});
    sunCascadeConstants_ = gl::Buffer("sun cascades", sizeof(shared::SunCascadeConstants), nullptr, GL_DYNAMIC_DRAW);
  } else if (showsSun) {
    shadowMap_.emplace(programs, gpuScene_, settings.shadow);
  }
  if (showsDirect_ && LocalLights::isNeeded(needs_)) localLights_.emplace(programs, gpuScene_, settings.lights, spots_, points_);
  using Light = ReflectiveShadowMap::Light;
  const auto addMap = [&](Light light) {
    ReflectiveShadowMap::Settings map = settings.rsm;
    map.light = light;
    map.albedo = showsLpv_ && settings.lpv.bounces > 1;
    if (light == Light::point) map.size = std::max(map.size / 2, 1);
    rsms_.emplace_back(programs, gpuScene_, map);
  };
  if ((showsLpv_ || showsGather_ || showsGatheredMaps) && needs_.directionalLight) addMap(Light::sun);
  if (showsLpv_ || showsGather_ || showsGatheredMaps) {
    for (std::size_t i = 0; i < spots_.size(); ++i) addMap(Light::spot);
    for (std::size_t i = 0; i < points_.size(); ++i) addMap(Light::point);
  }
  if (showsGatheredMaps && needs_.emission) logWarning("lpv.transport=gather: emissive surfaces light nothing (rays has them)");
  if (showsLpv_) {
    LightPropagationVolume::Settings volume = settings.lpv;
    if (volume.blocking && volume.iterations > 1 && volume.surfels != LpvSurfels::rsm) {
      ReflectiveShadowMap::Settings map;
      map.size = settings.rsm.size;
      map.light = Light::spot;
      map.albedo = volume.bounces > 1;
      cameraMap_.emplace(programs, gpuScene_, map);
    }
    const std::size_t views = (volume.surfels == LpvSurfels::camera ? 0 : rsms_.size()) + (cameraMap_ ? 1 : 0);
    volume.mergeViews = volume.blocking && views > 1;
    lpv_.emplace(programs, context.capabilities(), volume);
  }

  if (needs_.environment && !showsReceivers_ && !radiosity_)
    logWarning("technique {}{}: the environment lights nothing (path and radiosity have its light, and lpv with lpv.transport=gather or rays)", nameOf(settings.technique),
               settings.technique == Technique::lpv ? " with lpv.transport=propagate" : "");

  const auto loadSurface = [&](const std::string& name, bool masked) {
    gl::ShaderFlags flags = gpuScene_.materialFlags(masked);
    const bool showsRest = settings.component != Component::indirect;  // specular and emission belong to direct light
    flags.insert(flags.end(), {{"DIRECT", showsSun},
                               {"SUN_CASCADES", cascades},
                               {"SPOT_LIGHTS", localLights_ ? static_cast<int>(spots_.size()) : 0},
                               {"POINT_LIGHTS", localLights_ ? static_cast<int>(points_.size()) : 0},
                               {"INDIRECT", showsLpv_},
                               {"RECEIVED", showsReceivers_},
                               {"GATHERED", showsGather_},
                               {"SHOW_REFUSED", showsGather_ && settings.gather.showRefused},
                               {"SPECULAR", needs_.specular && showsDirect_},
                               {"EMISSION", needs_.emission && showsRest}});
    const gl::ShaderFlags lookup = LightPropagationVolume::lookupFlags(settings.lpv);
    if (showsLpv_ || showsReceivers_) flags.insert(flags.end(), lookup.begin(), lookup.end());
    return &programs.loadRaster(name, "forward/surface.vert", "forward/surface.frag", flags);
  };
  if (radiosity_ && radiosity_->takesDirectRays()) directRays_.emplace(scene, context.capabilities(), settings.radiosity.shadowRays, origin_);
  if (radiosity_) {
    surfacePrograms_ = radiosity_->loadPrograms(programs, gpuScene_);
  } else {
    surfacePrograms_.opaque = loadSurface("surface opaque", false);
    if (needs_.alphaMasks) surfacePrograms_.masked = loadSurface("surface masked", true);
  }
  depthPrograms_.opaque = &programs.loadRaster("depth opaque", "forward/depth.vert", "", {{"ALPHA_MASK", 0}, {"FROM_SUN", 0}});
  if (needs_.alphaMasks)
    depthPrograms_.masked = &programs.loadRaster("depth masked", "forward/depth.vert", "forward/depth.frag", {{"ALPHA_MASK", 1}, {"FROM_SUN", 0}});
  toneMap_ = radiosity_ ? radiosity_->loadMapping(programs) : nullptr;
  if (!toneMap_) toneMap_ = &programs.loadRaster("tone map", "lib/fullscreen.vert", "forward/tonemap.frag");
  allocateTargets();
  if (EnvironmentView::isNeeded(needs_) && settings.component != Component::indirect) environmentView_.emplace(programs, scene);
  if (showsGather_ || showsReceivers_) visible_.emplace(programs, gpuScene_, depth_);
  if (showsGather_) gather_.emplace(programs, needs_, settings.gather, *visible_);
  if (showsReceivers_) receivers_.emplace(programs, context.capabilities(), scene, origin_, settings.lpv, receivedLight(settings.component));
}

const Scene& Renderer::aboutOrigin(const Scene& scene) {
  return origin_ == glm::dvec3(0.0) ? scene : moved_.emplace(movedTo(scene, origin_));
}

void Renderer::allocateTargets() {
  radiance_ = gl::Texture("radiance", settings_.fullFloatTarget ? GL_RGBA32F : GL_RGBA16F, settings_.size);
  depth_ = gl::Texture("depth", GL_DEPTH_COMPONENT32F, settings_.size);
  display_ = gl::Texture("display", GL_RGBA8, settings_.size);
  const std::array<const gl::Texture*, 1> radiance{&radiance_}, display{&display_};
  radianceTarget_ = gl::Framebuffer("radiance", radiance, &depth_);
  depthTarget_ = gl::Framebuffer("depth", {}, &depth_);
  displayTarget_ = gl::Framebuffer("display", display);
}

void Renderer::resize(glm::ivec2 size) {
  if (size == settings_.size || size.x <= 0 || size.y <= 0) return;
  settings_.size = size;
  allocateTargets();
  if (visible_) visible_->resize(depth_);
  if (gather_) gather_->resize();
  receivedClip_ = glm::dmat4(0.0);  // other pixels of the same view see other points
}

void Renderer::recordShadows(const Camera& camera) {
  if (shadowMap_ && !mapsAreMade()) {
    const gl::TimeQuery::Scope stage(timer_, "shadow");
    shadowMap_->record(gpuScene_);
  }
  if (sunCascades_) {
    const gl::TimeQuery::Scope stage(timer_, "shadow");
    const Scene& scene = gpuScene_.scene();
    const double aspect = static_cast<double>(settings_.size.x) / settings_.size.y;
    shared::SunCascadeConstants constants{};
    std::vector<LayeredDepth::View> views;
    for (const SunCascade& cascade : placeSunCascades(settings_.sunCascades, scene, scene.sun->direction, sunFrustum_, camera, aspect,
                                                      nearPlane(scene.bounds), sunCascades_->size())) {
      constants.clipFromWorld[views.size()] = glm::mat4(cascade.clipFromWorld);
      constants.normalOffset[static_cast<int>(views.size())] = kShadowNormalOffset * static_cast<float>(cascade.texel);
      views.push_back({glm::mat4(cascade.clipFromWorld), glm::vec3(0.0f)});
    }
    sunCascadeConstants_.upload(0, sizeof constants, &constants);
    sunCascadeConstants_.bind(GL_UNIFORM_BUFFER, kSunCascadeBinding);
    sunCascades_->record(gpuScene_, views);
  }
  if (localLights_ && localLights_->hasSpots() && !mapsAreMade()) {
    const gl::TimeQuery::Scope stage(timer_, "spot shadows");
    localLights_->recordSpots(gpuScene_);
  }
  if (localLights_ && localLights_->hasPoints() && !mapsAreMade()) {
    const gl::TimeQuery::Scope stage(timer_, "point shadows");
    localLights_->recordPoints(gpuScene_);
  }
}

const std::vector<ReflectiveShadowMap::Outputs>& Renderer::recordReflectiveShadowMaps() {
  if (mapsAreMade()) return rsmOutputs_;
  const gl::TimeQuery::Scope stage(timer_, "rsm");
  rsmOutputs_.clear();
  auto spot = spots_.begin(), point = points_.begin();
  for (ReflectiveShadowMap& rsm : rsms_) switch (rsm.light()) {
      case ReflectiveShadowMap::Light::sun: rsmOutputs_.push_back(rsm.record(gpuScene_, sunFrustum_.texelArea(rsm.size()))); break;
      case ReflectiveShadowMap::Light::spot: rsmOutputs_.push_back(rsm.record(gpuScene_, *spot++)); break;
      case ReflectiveShadowMap::Light::point: rsmOutputs_.push_back(rsm.record(gpuScene_, *point++)); break;
    }
  return rsmOutputs_;
}

// The camera as a lamp without light: the map's texels hold position, normal and area of what it sees.
std::vector<ReflectiveShadowMap::Outputs> Renderer::recordCameraMap(const Camera& camera) {
  if (!cameraMap_) return {};
  const gl::TimeQuery::Scope stage(timer_, "camera surfels");
  const double aspect = static_cast<double>(settings_.size.x) / static_cast<double>(settings_.size.y);
  SpotLight eye;
  eye.position = camera.position;
  eye.direction = camera.direction;
  eye.outerAngle = std::min(std::atan(std::tan(0.5 * camera.verticalFov) * std::max(aspect, 1.0)), kLargestSpotAngle);
  eye.innerAngle = 0.0;
  return {cameraMap_->record(gpuScene_, lightViews(eye, gpuScene_.scene().bounds))};
}

void Renderer::renderToTheEnd(const Camera& camera) {
  if (receivers_) rounds_ = (settings_.lpv.samples + settings_.lpv.rays - 1) / settings_.lpv.rays;
  toTheEnd_ = true;
  render(camera);
  rounds_ = 1;
  if (receivers_) receivers_->collect(true);
  while (receivers_ && receivers_->counts().waiting > 0) {
    render(camera);
    receivers_->collect(true);
  }
  toTheEnd_ = false;
}

void Renderer::forget() {
  mapsMade_ = false;
  volumeCascades_.clear();
  if (!receivers_) return;
  receivers_->forget();
  settled_ = false;
  receivedClip_ = glm::dmat4(0.0);
}

// Nothing is done for a view whose receivers have all their paths.
bool Renderer::recordReceivers(const Camera& camera, const Camera& volumeCamera, const glm::dmat4& clip) {
  receivers_->collect();
  const bool sameView = clip == receivedClip_ && volumeCamera.position == receivedVolumePosition_ && volumeCamera.direction == receivedVolumeDirection_;
  if (!sameView) {
    receivedClip_ = clip;
    receivedVolumePosition_ = volumeCamera.position;
    receivedVolumeDirection_ = volumeCamera.direction;
    receivedSince_ = receivers_->frame() + 1;
  }
  const LpvReceivers::Counts& counts = receivers_->counts();
  settled_ = sameView && counts.frame >= receivedSince_ && counts.waiting == 0;
  if (settled_ && settings_.reuse) return false;
  const bool mapsAreNew = !mapsAreMade();
  const std::vector<ReflectiveShadowMap::Outputs> none;
  const std::vector<ReflectiveShadowMap::Outputs>& maps = rsms_.empty() ? none : recordReflectiveShadowMaps();
  {
    const gl::TimeQuery::Scope stage(timer_, "geometry");
    const glm::mat4 cameraClip(clip);
    const glm::vec3 viewPoint(camera.position);
    visible_->record(gpuScene_, {&cameraClip, &viewPoint});
  }
  const gl::TimeQuery::Scope stage(timer_, "receivers");
  receivers_->update({placeCascades(settings_.lpv.cascades, gpuScene_.scene().bounds, volumeCamera.position, volumeCamera.direction), camera,
                      glm::mat4(glm::inverse(clip)), *visible_, maps, mapsAreNew, !toTheEnd_}, rounds_);
  return true;
}

// The volume's light is kept while its grids lie where they did, unless surfels come from what the camera sees.
void Renderer::recordVolume(const Camera& volumeCamera) {
  const Scene& scene = gpuScene_.scene();
  const glm::dvec4 lightPosition = glm::inverse(sunFrustum_.clipFromWorld) * glm::dvec4(0.0, 0.0, -1.0, 1.0);
  const LightPropagationVolume::Inputs inputs{
      recordReflectiveShadowMaps(), placeCascades(settings_.lpv.cascades, scene.bounds, volumeCamera.position, volumeCamera.direction),
      typicalIrradiance(scene), glm::vec3(lightPosition), recordCameraMap(volumeCamera)};
  const shared::LpvConstants constants = lpvConstants(settings_.lpv, inputs.cascades, inputs.referenceIrradiance);
  const auto liesWhere = [](const shared::LpvCascade& a, const shared::LpvCascade& b) { return a.minimum == b.minimum && a.cellSize == b.cellSize; };
  const bool same = settings_.reuse && !cameraMap_ && volumeCascades_.size() == inputs.cascades.size() &&
                    std::equal(volumeCascades_.begin(), volumeCascades_.end(), constants.cascades, liesWhere);
  if (same) {
    lpv_->place(inputs);  // where cascades fade into each other follows the camera
    return;
  }
  volumeCascades_.assign(constants.cascades, constants.cascades + inputs.cascades.size());
  timer_.begin("injection");
  lpv_->place(inputs);
  lpv_->inject(inputs);
  timer_.end();
  if (lpv_->geometryVolume()) {
    const gl::TimeQuery::Scope stage(timer_, "geometry volume");
    lpv_->fillGeometryVolume(inputs);
  }
  const gl::TimeQuery::Scope stage(timer_, "propagation");
  lpv_->propagate();
  lpv_->join();
}

void Renderer::render(const Camera& cameraInScene, const Camera& volumeCameraInScene) {
  Camera camera = cameraInScene, volumeCamera = volumeCameraInScene;
  camera.position -= origin_;
  volumeCamera.position -= origin_;
  const Scene& scene = gpuScene_.scene();
  const glm::dmat4 exactClip = clipFromWorld(camera, scene.bounds, settings_.size);
  const glm::mat4 cameraClip(exactClip);
  const glm::vec3 viewPoint(camera.position);

  shared::FrameConstants frame{};
  frame.clipFromWorld = cameraClip;
  frame.cameraPosition = viewPoint;
  frame.exposure = exposure_;
  if (scene.sun) {
    frame.sunClipFromWorld = glm::mat4(sunFrustum_.clipFromWorld);
    frame.sunDirection = glm::vec3(scene.sun->direction);
    frame.sunIrradiance = scene.sun->irradiance;
    frame.shadowNormalOffset =
        kShadowNormalOffset * static_cast<float>(std::max(sunFrustum_.width, sunFrustum_.height) / settings_.shadow.size);
    frame.shadowTexelUv = 1.0f / static_cast<float>(settings_.shadow.size);
  }
  frame.background = scene.background;
  frameConstants_.upload(0, sizeof frame, &frame);
  frameConstants_.bind(GL_UNIFORM_BUFFER, kFrameBinding);

  recordShadows(camera);

  if (gather_) {
    RsmGather::Inputs inputs{{}, glm::mat4(glm::inverse(exactClip)), static_cast<float>(2.0 * std::tan(0.5 * camera.verticalFov) / settings_.size.y)};
    auto spot = spots_.begin(), point = points_.begin();
    for (const ReflectiveShadowMap::Outputs& map : recordReflectiveShadowMaps()) {
      using Light = ReflectiveShadowMap::Light;
      inputs.maps.push_back({map, map.light == Light::spot ? &*spot++ : map.light == Light::point ? &*point++ : nullptr});
    }
    {
      const gl::TimeQuery::Scope stage(timer_, "geometry");
      visible_->record(gpuScene_, {&cameraClip, &viewPoint});
    }
    if (gather_->settings().interpolates()) {
      timer_.begin("gather low");
      gather_->gatherLow(inputs);
      timer_.end();
      const gl::TimeQuery::Scope stage(timer_, "interpolation");
      gather_->interpolate(inputs);
    }
    const gl::TimeQuery::Scope stage(timer_, "gather full");
    gather_->gatherFull(inputs);
  }

  const bool depthIsDrawn = (receivers_ && recordReceivers(camera, volumeCamera, exactClip)) || gather_;

  if (lpv_) recordVolume(volumeCamera);
  mapsMade_ = true;

  {
    const gl::TimeQuery::Scope stage(timer_, "shading");
    // Radiosity's backs are black. On edge at a silhouette, where rounding of its depth could bring one before the front that it hides behind, it is drawn
    // apart and pushed away by its slope.
    struct Sides {
      gl::Cull cull = gl::Cull::none;
      glm::vec2 polygonOffset{0.0f};
    };
    const Sides both, apart[] = {{gl::Cull::back, glm::vec2(0.0f)}, {gl::Cull::front, glm::vec2(1.0f)}};
    const auto all = radiosity_ ? std::span<const Sides>(apart) : std::span<const Sides>(&both, 1);
    if (!depthIsDrawn)
      for (const Sides& sides : all) {
        gl::RasterState state;
        state.depth = gl::Depth::lessWrite;
        state.cull = sides.cull;
        state.polygonOffset = sides.polygonOffset;
        const gl::RasterPass pass("depth", depthTarget_, state);
        if (&sides == &all.front()) pass.clearDepth();
        gpuScene_.draw(depthPrograms_, {&cameraClip, &viewPoint});
      }
    if (shadowMap_) shadowMap_->depth().bind(kShadowUnit);
    if (sunCascades_) sunCascades_->depth().bind(kShadowUnit);
    if (localLights_) localLights_->bindForShading();
    if (lpv_) lpv_->bindForLookup();
    if (receivers_) receivers_->bindForLookup();
    if (gather_) gather_->irradiance().bind(kGatheredUnit);
    if (radiosity_) radiosity_->bind();
    if (directRays_) directRays_->bind();
    for (const Sides& sides : all) {
      gl::RasterState state;
      state.depth = gl::Depth::equalReadOnly;
      state.cull = sides.cull;
      state.polygonOffset = sides.polygonOffset;
      const gl::RasterPass pass("surfaces", radianceTarget_, state);
      const bool showsBackground = settings_.component != Component::indirect;
      if (&sides == &all.front()) pass.clearColor(0, glm::vec4(showsBackground ? scene.background : glm::vec3(0.0f), 1.0f));
      if (!directRays_) {
        gpuScene_.draw(surfacePrograms_, {&cameraClip, &viewPoint});
        continue;
      }
      // Some shadow rays a pixel keep a small GPU busy for seconds: rows of pixels in pieces, each waited for.
      pieces_.emplace(kSecondsOfPiece, settings_.size.x * directRays_->turnsOfPixel(), static_cast<std::uint32_t>(settings_.size.y), settings_.unmeasuredTurns);
      for (int row = 0; row < settings_.size.y;) {
        const int rows = std::min(static_cast<int>(pieces_->units()), settings_.size.y - row);
        const gl::PieceClock clock;
        pass.restrictTo({0, row}, {settings_.size.x, rows});
        gpuScene_.draw(surfacePrograms_, {&cameraClip, &viewPoint});
        pieces_->took(static_cast<std::uint32_t>(rows), clock.seconds());
        row += rows;
      }
    }
  }

  if (environmentView_) {
    const gl::TimeQuery::Scope stage(timer_, "environment");
    environmentView_->record(radianceTarget_, noAttributes_, camera, settings_.size);
  }

  {
    const gl::TimeQuery::Scope stage(timer_, "tone mapping");
    const gl::RasterPass pass("tone map", displayTarget_, {});
    toneMap_->use();
    radiance_.bind(0);
    gl::drawFullScreen(noAttributes_);
  }
  timer_.collect();
  if (gather_) gather_->collect();
  gl::throwIfReset();
  // Now and then: asking stops drivers that have threads of their own. Whoever reads a result asks again.
  constexpr std::uint64_t kFramesBetweenLooks = 64;
  if (++frames_ % kFramesBetweenLooks == 1) gl::throwIfError("a frame");
}

void Renderer::drain() {
  timer_.drain();
  if (gather_) gather_->collect(true);
  if (receivers_) receivers_->collect(true);
}

Image Renderer::readRadiance() const {
  const std::vector<glm::vec4> texels = radiance_.readRgba();
  Image image(settings_.size.x, settings_.size.y);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = glm::vec3(texels[static_cast<std::size_t>(image.height - 1 - y) * static_cast<std::size_t>(image.width) +
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
      const glm::vec4& texel = texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(bitmap.width) + static_cast<std::size_t>(x)];
      for (int channel = 0; channel < 4; ++channel) bitmap.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * texel[channel])));
    }
  return bitmap;
}

std::size_t Renderer::gpuBytes() const {
  std::size_t bytes = gpuScene_.gpuBytes() + frameConstants_.bytes() + radiance_.bytes() + depth_.bytes() + display_.bytes();
  if (shadowMap_) bytes += shadowMap_->gpuBytes();
  if (sunCascades_) bytes += sunCascades_->gpuBytes() + sunCascadeConstants_.bytes();
  if (localLights_) bytes += localLights_->gpuBytes();
  for (const ReflectiveShadowMap& rsm : rsms_) bytes += rsm.gpuBytes();
  if (lpv_) bytes += lpv_->gpuBytes();
  if (cameraMap_) bytes += cameraMap_->gpuBytes();
  if (visible_) bytes += visible_->gpuBytes();
  if (gather_) bytes += gather_->gpuBytes();
  if (environmentView_) bytes += environmentView_->gpuBytes();
  if (receivers_) bytes += receivers_->gpuBytes();
  if (radiosity_) bytes += radiosity_->gpuBytes();
  if (directRays_) bytes += directRays_->gpuBytes();
  return bytes;
}

std::vector<std::string> Renderer::leftOut() const {
  std::vector<std::string> names;
  for (const auto& [name, needed] : needs_.named())
    if (!needed) names.push_back(name);
  if (!shadowMap_ && !sunCascades_) names.emplace_back("shadow map");
  if (!sunCascades_) names.emplace_back("sun cascades");
  if (!localLights_ || !localLights_->hasSpots()) names.emplace_back("spot shadow maps");
  if (!localLights_ || !localLights_->hasPoints()) names.emplace_back("point shadow maps");
  if (rsms_.empty()) names.emplace_back("reflective shadow map");
  if (!environmentView_) names.emplace_back("environment behind surfaces");
  if (!gather_) names.emplace_back("rsm gather");
  if (!radiosity_) names.emplace_back("radiosity");
  if (!directRays_) names.emplace_back("shadow rays");
  if (!receivers_) names.emplace_back("receivers");
  if (!lpv_) names.emplace_back("light propagation volume");
  else if (!lpv_->geometryVolume()) names.emplace_back("geometry volume");
  else {
    if (!cameraMap_) names.emplace_back("camera surfels");
    if (settings_.lpv.bounces == 1) names.emplace_back("light bounces");
  }
  return names;
}

}  // namespace lucerna
