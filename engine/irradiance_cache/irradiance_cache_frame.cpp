#include "irradiance_cache/irradiance_cache_frame.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace lucerna {

namespace {

IrradianceCache::Light cachedLight(Component component) {
  using Light = IrradianceCache::Light;
  return component == Component::direct     ? Light::direct
         : component == Component::indirect ? Light::indirect
                                            : Light::all;
}

/// The weakest and the strongest of several lights.
struct Strengths {
  float least = std::numeric_limits<float>::infinity(), most = 0.0f;

  void add(const glm::vec3& light) {
    const float strength = std::max({light.x, light.y, light.z});
    if (strength > 0.0f) least = std::min(least, strength), most = std::max(most, strength);
  }
  /// Half floats hold a light only beside one up to 1e4 times as strong.
  bool fitHalfFloats() const {
    constexpr float kMostRatio = 1e4f;
    return most / kMostRatio <= least;
  }
};

IrradianceCacheSettings cacheSettings(const FrameParts& parts) {
  IrradianceCacheSettings settings = parts.settings.of<IrradianceCacheSettings>();
  Strengths lamps, surfaces;  // intensities; radiances
  for (const SpotLight& lamp : parts.scene.spots) lamps.add(lamp.intensity);
  for (const PointLight& lamp : parts.scene.points) lamps.add(lamp.intensity);
  for (const Material& material : parts.scene.materials)
    surfaces.add(material.emissionTexture >= 0 ? material.emissionScale : material.emission);
  if (parts.scene.environment) surfaces.add(parts.scene.environment->radiance);
  settings.fullFloat = settings.fullFloat || !lamps.fitHalfFloats() || !surfaces.fitHalfFloats();
  return settings;
}

std::optional<LightMaps> lightMaps(const FrameParts& parts) {
  if (!IrradianceCacheFrame::takesMaps(parts.settings, parts.features)) return {};
  return std::optional<LightMaps>(std::in_place, parts, false);
}

}  // namespace

bool IrradianceCacheFrame::isNeeded(const RenderSettings& settings, const SceneFeatures& features) {
  return IrradianceCache::isNeeded(features, settings.of<IrradianceCacheSettings>(), cachedLight(settings.component));
}

void IrradianceCacheFrame::prepare(RenderSettings& settings, const Scene& scene) {
  settings.textures.boundaries =
      !Reflections::showsClouds(analyse(scene), settings.of<IrradianceCacheSettings>().reflections);
}

IrradianceCacheFrame::IrradianceCacheFrame(const FrameParts& parts)
    : parts_(parts),
      maps_(lightMaps(parts)),
      visible_(parts.programs, parts.drawn(), parts.depth),
      cache_(parts.programs, parts.context.capabilities(), parts.scene, parts.traced.get(), parts.origin,
             cacheSettings(parts), cachedLight(parts.settings.component), parts.settings.wholePictures) {
  if (parts.scene.motion)
    for (const Mesh& mesh : parts.drawn().scene().meshes) meshes_.push_back(mesh.bounds);
  makeReflections();
}

void IrradianceCacheFrame::makeReflections() {
  if (!Reflections::isNeeded(parts_.features, settings().reflections)) return;
  std::optional<Bodies> bodies;
  if (Bodies::isNeeded(parts_.features))
    bodies.emplace(parts_.scene, parts_.traced.get().origin(), parts_.context.capabilities());
  reflections_.emplace(parts_.programs, parts_.context.capabilities(), parts_.scene, parts_.features,
                       cache_.rayFlags(1, true), settings().reflections, parts_.traced.get().hasCoats(),
                       parts_.settings.unmeasuredIterations, std::move(bodies));
  reflections_->resize(visible_.size());
}

bool IrradianceCacheFrame::follow(const SceneChange& change) {
  if (cacheSettings(parts_).fullFloat != cache_.settings().fullFloat) return false;
  const Scene& drawn = parts_.drawn().scene();
  std::vector<Bounds> moved;
  for (const std::size_t mesh : change.meshes) {
    const Bounds& now = drawn.meshes[mesh].bounds;
    moved.push_back(meshes_[mesh]);
    moved.push_back(now);
    meshes_[mesh] = now;
  }
  const bool lampsAlone = !change.materials && !change.environment && !change.media;
  if (!cache_.follow(parts_.scene, moved, lampsAlone)) return false;
  if (maps_ && !maps_->follow()) return false;
  makeReflections();
  settled_ = false;
  return true;
}

void IrradianceCacheFrame::resize() {
  visible_.resize(parts_.depth);
  if (reflections_) reflections_->resize(visible_.size());
}

bool IrradianceCacheFrame::record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort) {
  cache_.collect();
  const Camera& volume = view.volumeCamera;
  volumePosition_ = volume.position;
  volumeDirection_ = volume.direction;
  if (view.isNew) since_ = cache_.nextFrame();
  const IrradianceCache::Counts& counts = cache_.counts();
  settled_ = !view.isNew && counts.frame >= since_ && counts.waiting == 0 && !cache_.settles();
  const bool isLit = (settled_ && parts_.settings.reuse) || effort.isFurtherSample;
  const bool reflectsAnew = reflections_ && parts_.settings.pixelSamples > 1;  // another point of each pixel
  if (isLit && !reflectsAnew) return false;
  const Reflections::Share share =
      reflections_ ? reflections_->shareOf(view.sample, parts_.settings.pixelSamples, effort) : Reflections::Share{};
  if (isLit && share.rays == 0) {
    reflections_->clear();
    return false;
  }
  // A live picture's first frame has no records yet: reflections of it would be paths of many surfaces.
  const bool reflects = reflections_ && (effort.wholePicture || counts.frame > 0);
  const bool mapsAreNew = hasMaps() ? maps_->willBeDrawn() : !parts_.settings.reuse;
  const std::vector<ReflectiveShadowMap::Outputs> none;
  const std::vector<ReflectiveShadowMap::Outputs>& maps = maps_ && !isLit ? maps_->record(timer) : none;
  recordSurfaces(timer, view);
  const gl::TimeQuery::Scope stage(timer, "irradiance cache");
  const IrradianceCacheSettings& cache = settings();
  const int rounds = effort.wholePicture ? (cache.samples + cache.rays - 1) / cache.rays : 1;
  const IrradianceCache::Inputs seen = inputs(view, maps, mapsAreNew, effort.fadesIn);
  if (isLit) cache_.show(seen);
  else cache_.update(seen, rounds);
  if (reflects)
    reflections_->record(view.sample, share, visible_, seen.worldFromClip, [&] { cache_.bindForRays(); });
  else if (reflections_) reflections_->clear();
  return true;
}

void IrradianceCacheFrame::see(gl::TimeQuery& timer, const FrameView& view) {
  recordSurfaces(timer, view);
  const gl::TimeQuery::Scope stage(timer, "irradiance cache");
  cache_.see(inputs(view, {}, false, false));
}

void IrradianceCacheFrame::recordSurfaces(gl::TimeQuery& timer, const FrameView& view) {
  const gl::TimeQuery::Scope stage(timer, "geometry");
  visible_.record(parts_.drawn(), view.drawn());
}

IrradianceCache::Inputs IrradianceCacheFrame::inputs(const FrameView& view,
                                                     const std::vector<ReflectiveShadowMap::Outputs>& maps,
                                                     bool mapsAreNew, bool fades) const {
  const glm::dvec2 size(visible_.size());
  return {placeCascadesAround(settings().cascades, parts_.drawn().scene().mainAround(view.volumeCamera.position),
                              view.volumeCamera, size.x / size.y),
          view.camera,
          view.offset,
          glm::mat4(glm::inverse(view.clip)),
          visible_,
          maps,
          mapsAreNew,
          fades};
}

Image IrradianceCacheFrame::readFromCells(const CascadeSettings& cascades, float blendBand, int paths) const {
  return cache_.readFromCells(
      cascades,
      placeCascades(cascades, parts_.drawn().scene().mainAround(volumePosition_), volumePosition_, volumeDirection_),
      blendBand, paths);
}

void IrradianceCacheFrame::forget() {
  if (maps_) maps_->forget();
  cache_.forget();
  settled_ = false;
}

bool IrradianceCacheFrame::lacksLight(std::size_t frames) const {
  const IrradianceCache::Counts& counts = cache_.counts();
  if (counts.waiting == 0) return false;
  if (frames > cache_.mostFrames())
    throw Error(ErrorKind::fault, fmt::format("internal error: after {} frames {} records of {} still lack light",
                                              frames, counts.waiting, counts.records));
  return true;
}

void IrradianceCacheFrame::addShares(const InspectedPixel& pixel, PixelInspection& answer) {
  const glm::dvec3 position = answer.surface->position, reflection = answer.surface->albedo / kPi;
  answer.isFiltered = true;
  for (const InspectedPart& part :
       cache_.inspect(pixel.terms[INSPECTED_POSITION], pixel.terms[INSPECTED_MESH_NORMAL])) {
    const int cascades = settings().cascades.cascades;
    const std::string name = fmt::format("{} {} {} {} of cascade {}", part.number.w < cascades ? "record" : "part",
                                         part.number.x, part.number.y, part.number.z, part.number.w % cascades + 1);
    if (answer.add("irradiance cache", name, reflection * glm::dvec3(part.irradiance),
                   {position, glm::dvec3(part.place) + parts_.origin}))
      answer.shares.back().weight = part.weight;
  }
}

void IrradianceCacheFrame::addStagePictures(std::vector<StagePicture>& pictures) const {
  if (maps_) maps_->addStagePictures(pictures);
  pictures.push_back({StagePicture::Kind::normal, "normals", &visible_.normal()});
  pictures.push_back({StagePicture::Kind::irradiance, "irradiance cache", &cache_.irradiance()});
}

void IrradianceCacheFrame::addLeftOut(std::vector<std::string>& names) const {
  if (!reflections_) names.emplace_back("reflections");
  if (!hasMaps()) names.emplace_back("reflective shadow map");
}

std::string IrradianceCacheFrame::summary() const {
  const IrradianceCache::Counts& c = cache_.counts();
  std::string line = fmt::format("{} records, {} paths each", c.records, cache_.settings().samples);
  if (c.waiting > 0) line += fmt::format("; {} incomplete", c.waiting);
  if (c.left > 0) line += fmt::format("; {} without room (cache.cells)", c.left);
  return line + "\n";
}

}  // namespace lucerna
