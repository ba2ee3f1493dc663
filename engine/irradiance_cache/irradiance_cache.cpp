#include "irradiance_cache/irradiance_cache.hpp"

#include "base/error.hpp"
#include "forward/light_views.hpp"
#include "gl/pass.hpp"
#include "gl/chunks.hpp"
#include "irradiance_cache/small_lamps.hpp"
#include "rays/light_table.hpp"
#include "rays/view_rays.hpp"
#include "shared/bindings.h"
#include "shared/irradiance_cache.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

constexpr std::uint32_t kSegmentsOfAll = 64;  // of a path that meets no records; it misses a share of albedo^64
constexpr std::uint32_t kSoftwareIterations = 2000,
                        kMostIterations = 1u << 16;  // like the path tracer's, less one segment
constexpr std::uint32_t kBounces = 12;  // frames in which light still changes once the scene has come to rest
constexpr float kBandOfPicture = 0.2f;  // of Settings::blendBand: in a finished picture nothing moves
constexpr std::size_t kMostPaths = std::size_t{1} << 20;  // per submission
constexpr std::size_t kKeyPixels = std::size_t{1} << 23;  // number that a key distinguishes

float largest(const glm::vec3& v) { return std::max({v.x, v.y, v.z}); }

/// Typical irradiance from lamps, emissive surfaces and the sky.
float typicalOf(const Scene& scene) {
  constexpr float kPi = 3.14159265f;
  float result = analyse(scene).anyLight() ? typicalIrradiance(scene) : 0.0f;
  for (const Material& material : scene.materials) result = std::max(result, kPi * largest(material.emission));
  if (scene.environment) {
    const glm::dvec3 mean = scene.environment->picture ? meanRadiance(*scene.environment->picture) : glm::dvec3(1.0);
    result = std::max(result, kPi * largest(scene.environment->radiance * glm::vec3(mean)));
  }
  return result > 0.0f ? std::clamp(result, 1e-30f, 1e30f) : 1.0f;
}

std::size_t lampsOf(const Scene& scene) { return scene.spots.size() + scene.points.size() + (scene.sun ? 1 : 0); }

/// Whether the camera jumped, so that there is no previous picture to stay consistent with.
bool isCut(const Cascade& before, const Cascade& now) {
  constexpr std::int64_t kCells = 4;
  const glm::i64vec3 moved = glm::abs(now.firstCell - before.firstCell);
  return std::max({moved.x, moved.y, moved.z}) > kCells;
}

}  // namespace

bool IrradianceCache::isNeeded(const SceneFeatures& features, const IrradianceCacheSettings& settings, Light light) {
  if (settings.transport == CacheTransport::gather) return LightGather::partsOf(features, settings, light).any();
  const bool extended = features.emission || features.environment;
  return light == Light::direct ? extended : features.indirect || extended;
}

IrradianceCache::IrradianceCache(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                                 const PathScene& traced, const glm::dvec3& origin,
                                 const IrradianceCacheSettings& settings, Light light, bool wholePictures)
    : settings_(settings),
      programs_(&programs),
      scene_(traced),
      rayOrigin_(scene_.origin() - origin),
      referenceIrradiance_(typicalOf(scene)),
      typicalIrradiance_(referenceIrradiance_),
      blendBand_((wholePictures ? kBandOfPicture : 1.0f) * settings.blendBand),
      clearTexture_(capabilities.clearTexture),
      cached_(settings.bounces == IrradianceCacheSettings::kAllBounces && light != Light::direct) {
  CHECK(settings.rays >= 1 && settings.rays <= CACHE_LANES && CACHE_LANES % settings.rays == 0, "rays = {}",
        settings.rays);
  // Slots of the grids, and the maximum number of records in them.
  const auto cells = static_cast<std::size_t>(settings.cascades.cells),
             cascades = static_cast<std::size_t>(settings.cascades.cascades);
  const int layers = settings.cascades.cells * settings.cascades.cascades * CACHE_FACES;
  if (layers > capabilities.max3dTextureSize)
    throwMissingCapability(
        "cache.cells={}: records take {} layers of a 3D texture; this driver has at most {} (GL_MAX_3D_TEXTURE_SIZE)",
        settings.cascades.cells, layers, capabilities.max3dTextureSize);
  const int lanes = settings.transport == CacheTransport::rays ? settings.rays : CACHE_LANES;  // per record
  slots_ = cells * cells * cells * cascades * CACHE_FACES;
  // Surfaces cross a grid in about cells^2 cells; times four, for the faces that each normal covers.
  capacity_ = std::min(slots_, 24 * cells * cells * cascades);

  // Allocate tables, records and their irradiance.
  const auto words = [&](const std::string& name, std::size_t count) {
    if (count > static_cast<std::size_t>(capabilities.maxTextureBufferSize))
      throwMissingCapability(
          "{}: {} texels; this driver's texture buffers have at most {} (GL_MAX_TEXTURE_BUFFER_SIZE)", name, count,
          capabilities.maxTextureBufferSize);
    return gl::BufferTexture(name, gl::Format::r32ui, count * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  };
  slotTable_ = words("cache slots", slots_);
  keys_ = words("cache keys", slots_);
  seen_ = words("cache seen", capacity_);
  for (gl::Buffer& buffer : records_)
    buffer = gl::Buffer("cache records", capacity_ * sizeof(shared::CacheRecord), nullptr, gl::Usage::dynamicCopy);
  for (gl::Buffer& buffer : work_)
    buffer = gl::Buffer("cache records' work", kWorkWords * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  lit_ = gl::Buffer("cache lit records",
                    std::min(capacity_, kMostPaths / static_cast<std::size_t>(lanes)) * sizeof(GLuint), nullptr,
                    gl::Usage::dynamicCopy);
  for (gl::Buffer* buffer : {&cascadeConstants_, &cascadeConstantsBefore_})
    *buffer = gl::Buffer("cache cascades", sizeof(shared::CascadeConstants), nullptr, gl::Usage::dynamicDraw);
  constants_ = gl::Buffer("cache record constants", sizeof(shared::CacheConstants), nullptr, gl::Usage::dynamicDraw);
  pathConstants_ = gl::Buffer("cache path constants", sizeof(shared::PathConstants), nullptr, gl::Usage::dynamicDraw);
  const gl::Sampling linear{gl::Filter::linear, gl::Filter::linear, gl::Wrap::border};
  irradiance_ = gl::Texture("cache irradiance", settings.fullFloat ? gl::Format::rgba32f : gl::Format::rgba16f,
                            glm::ivec3(settings.cascades.cells, settings.cascades.cells, layers), linear);
  // An empty list is one point long: mark always has it bound.
  prefetchPoints_ = gl::Buffer("cache prefetch points",
                               static_cast<std::size_t>(std::max(settings.prefetch, 1)) * sizeof(shared::PrefetchPoint),
                               nullptr, gl::Usage::dynamicCopy);
  smooths_ = wholePictures && settings.transport == CacheTransport::rays && settings.smooths;
  if (wholePictures && settings.transport == CacheTransport::rays && settings.split > 1) {
    constexpr std::size_t kMostParts = std::size_t{1} << 19;
    const auto side = static_cast<std::size_t>(settings.split), ofTile = side * side * side;
    split_ = std::make_unique<Split>();
    split_->mostTiles = std::max(std::min(slots_, kMostParts) / ofTile, std::size_t{1});
    split_->tiles = words("cache tiles", slots_);
    split_->slots = words("cache parts", split_->mostTiles * ofTile);
    split_->light = gl::BufferTexture("cache light of parts", gl::Format::rgba32f,
                                      split_->mostTiles * ofTile * sizeof(glm::vec4), nullptr, gl::Usage::dynamicCopy);
  }
  ring_ = std::make_unique<gl::ReadBackRing>("cache record counts", kWorkWords * sizeof(GLuint));

  // Select the light that paths carry, and the programs of every transport.
  scene_.fill(path_);
  path_.minScatterings = light == Light::indirect ? 2 : 1;
  path_.maxScatterings = light == Light::direct ? 1
                         : settings.bounces == IrradianceCacheSettings::kAllBounces
                             ? 0xffffu
                             : static_cast<std::uint32_t>(settings.bounces) + 1;
  path_.iterations = capabilities.softwareRenderer ? kSoftwareIterations : kMostIterations;
  if (cached_ || settings.transport == CacheTransport::gather) emissiveBodies_ = emissiveBodies(scene, scene_.origin());

  const gl::ShaderFlags common = lookupFlags(settings);
  const gl::ShaderFlags& rays = rays_ = rayFlags(lanes);
  mark_ = &programs.loadCompute("cache mark records", "irradiance_cache/mark.comp",
                                gl::with(common, {{"CLAIM", 0}, {"PARTS", 0}}));
  claim_ = &programs.loadCompute("cache claim records", "irradiance_cache/mark.comp",
                                 gl::with(common, {{"CLAIM", 1}, {"PARTS", 0}}));
  keep_ = &programs.loadCompute("cache keep records", "irradiance_cache/keep.comp",
                                gl::with(common, {{"FOLLOWS", 0}, {"KEEPS", 0}}));
  const int split = split_ ? settings.split : 0;
  list_ = &programs.loadCompute("cache list records", "irradiance_cache/list.comp",
                                gl::with(rays, {{"SPLIT", split}, {"FEWER_PATHS", smooths_}}));
  if (split_) {
    split_->store =
        &programs.loadCompute("cache store parts", "irradiance_cache/parts.comp", gl::with(common, {{"SPLIT", split}}));
    for (const int claims : {0, 1})
      split_->find[static_cast<std::size_t>(claims)] =
          &programs.loadCompute(claims ? "cache claim parts" : "cache mark parts", "irradiance_cache/mark.comp",
                                gl::with(common, {{"CLAIM", claims}, {"PARTS", 1}, {"SPLIT", split}}));
  }
  if (settings.transport == CacheTransport::rays)
    paths_ = &programs.loadCompute("cache paths", "irradiance_cache/paths.comp",
                                   gl::with(rays, {{"CACHED", cached_}, {"FROM_CELLS", 0}, {"KEEPS", 0}}));
  if (settings.prefetch > 0)
    prefetch_ = &programs.loadCompute("cache prefetch points", "irradiance_cache/prefetch.comp", rays);
  store_ = &programs.loadCompute("cache store records", "irradiance_cache/store.comp",
                                 gl::with(common, {{"SMOOTHS", smooths_}}));
  if (settings.transport == CacheTransport::gather)
    gather_ = std::make_unique<LightGather>(programs, capabilities, scene, origin, settings, light, scene_, common);
  forget();
}

gl::ShaderFlags IrradianceCache::lookupFlags(const IrradianceCacheSettings& settings) {
  return {{"GRID_FULL_FLOAT", settings.fullFloat}, {"SHOWS_PARTS", 0}};
}

gl::ShaderFlags IrradianceCache::pictureFlags() const {
  if (!split_) return lookupFlags(settings_);
  return {{"GRID_FULL_FLOAT", settings_.fullFloat}, {"SHOWS_PARTS", 1}, {"SPLIT", settings_.split}};
}

gl::ShaderFlags IrradianceCache::rayFlags(int lanes, bool glossy) const {
  return gl::with(
      gl::with(lookupFlags(settings_), scene_.flags()),
      {{"LINEAR_SEEDS", 0}, {"GLOSSY", glossy}, {"SHARED_STACK", scene_.rays().sharedStack()}, {"PATHS", lanes}});
}

void IrradianceCache::forget() {
  slotTable_.clear();
  if (split_) split_->clear();
  seen_.clear();
  for (gl::Buffer& buffer : work_) buffer.upload(0, kWorkWords * sizeof(GLuint), noWork().data());
  const std::array<const gl::Texture*, 1> textures{&irradiance_};
  gl::clearToZero(textures, clearTexture_);
  cascades_.clear();
  counts_ = {};
  settles_ = false;
  if (kept_) kept_->areValid = false;
  if (gather_) gather_->forget();
}

bool IrradianceCache::follow(const Scene& scene, const std::vector<Bounds>& moved, bool lampsAlone) {
  // What is gathered holds where surfaces, emission and sky stay: trees and light of bounces follow the lights' maps.
  if (gather_ ? !(lampsAlone && moved.empty()) : rays_ != rayFlags(settings_.rays)) return false;
  if (!keepFollowed_) {
    const bool lightsAll = cached_ && path_.minScatterings <= 1;
    if (settings_.keepsHits && lightsAll && !gather_ && lampsOf(scene) <= CACHE_MOST_LAMPS) makeKept();
    keepFollowed_ =
        &programs_->loadCompute("cache keep records", "irradiance_cache/keep.comp",
                                gl::with(lookupFlags(settings_), {{"FOLLOWS", 1}, {"KEEPS", kept_ != nullptr}}));
  }
  if (kept_) kept_->allAnew = kept_->allAnew || !lampsAlone;
  moved_.insert(moved_.end(), moved.begin(), moved.end());
  scene_.fill(path_);
  if (cached_ && !(lampsAlone && moved.empty())) emissiveBodies_ = emissiveBodies(scene, scene_.origin());
  typicalIrradiance_ = typicalOf(scene);
  prefetchedFrom_.reset();
  followed_ = true;
  return true;
}

void IrradianceCache::place(const Inputs& inputs) {
  const shared::CascadeConstants grids =
      cascadeConstants(settings_.cascades, inputs.cascades, blendBand_, referenceIrradiance_);
  std::swap(cascadeConstants_, cascadeConstantsBefore_);
  cascadeConstants_.upload(0, sizeof grids, &grids);
  if (cascades_.empty()) cascadeConstantsBefore_.upload(0, sizeof grids, &grids);
  shared::CacheConstants constants{};
  for (std::size_t k = 0; k < inputs.cascades.size(); ++k)
    constants.firstCell[k] = glm::ivec4(glm::ivec3(inputs.cascades[k].firstCell), 0);
  constants.rayOrigin = glm::vec3(rayOrigin_);
  constants.frame = frame_ = nextFrame();
  constants.capacity = static_cast<std::uint32_t>(capacity_);
  constants.mostSegments =
      std::min(path_.maxScatterings,
               settings_.bounces == IrradianceCacheSettings::kAllBounces ? kSegmentsOfAll : path_.maxScatterings);
  const glm::ivec2 size = inputs.visible.size();
  const std::size_t pixels = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
  constants.prefetch = inputs.fades ? static_cast<std::uint32_t>(settings_.prefetch) : 0;
  constants.markEvery = static_cast<std::uint32_t>(pixels / (kKeyPixels - constants.prefetch) + 1);
  // Smaller than the coarsest cell: others are small beside none.
  const float coarsest =
      std::max(static_cast<float>(inputs.cascades.back().cellSize), gather_ ? gather_->bounceCell() : 0.0f);
  const auto last = std::ranges::lower_bound(emissiveBodies_, coarsest, {}, &glm::vec4::w);
  constants.smallLamps = static_cast<std::uint32_t>(
      std::min(static_cast<std::size_t>(last - emissiveBodies_.begin()), std::size_t{CACHE_MOST_SMALL_LAMPS}));
  std::copy_n(emissiveBodies_.begin(), constants.smallLamps, std::begin(constants.smallLamp));
  constants_.upload(0, sizeof constants, &constants);
  show(inputs);
}

void IrradianceCache::show(const Inputs& inputs) {
  const glm::ivec2 size = inputs.visible.size();
  setView(path_, inputs.camera, rayOrigin_, size, inputs.offset);
  path_.picture = glm::ivec4(size, 0, 0);
  pathConstants_.upload(0, sizeof path_, &path_);
}

void IrradianceCache::bindRecords() const {
  cascadeConstants_.bindUniform(BLOCK_CASCADES);
  constants_.bindUniform(BLOCK_CACHE);
  pathConstants_.bindUniform(BLOCK_CACHE_PATHS);
  records_[0].bindStorage(CACHE_RECORDS_BUFFER);
  work_[0].bindStorage(CACHE_WORK_BUFFER);
}

// After the grids have moved, copies records that are still inside to a new list and enters them in the slots.
void IrradianceCache::keep(const gl::Program& program) {
  std::swap(records_[0], records_[1]);
  std::swap(work_[0], work_[1]);
  work_[0].upload(0, kWorkWords * sizeof(GLuint), noWork().data());
  slotTable_.clear();
  if (split_) split_->clear();
  const gl::ComputePass pass("cache keep records", gl::Barrier::storage | gl::Barrier::textureFetch);
  program.use();
  bindRecords();
  if (followed_) {
    program.set("movedBoxes", static_cast<unsigned>(moved_.size()));
    movedBoxes_.buffer().bindStorage(CACHE_MOVED_BUFFER);
  }
  if (followed_ && kept_) {
    std::swap(kept_->hits[0], kept_->hits[1]);
    kept_->hits[1].bindStorage(CACHE_HITS_BEFORE_BUFFER);
    kept_->hits[0].bindStorage(CACHE_HITS_BUFFER);
  }
  records_[1].bindStorage(CACHE_RECORDS_BUFFER);
  records_[0].bindStorage(CACHE_KEPT_BUFFER);
  slotTable_.buffer().bindStorage(CACHE_SLOTS_BUFFER);
  work_[1].bindStorage(CACHE_WORK_BEFORE_BUFFER);
  pass.dispatchIndirect(work_[1]);
}

// Finds the prefetch points, unless they are those of the frame before.
void IrradianceCache::findPrefetchPoints() {
  if (!prefetch_ || prefetchedFrom_ == path_.cameraPosition) return;
  const gl::ComputePass pass("cache prefetch points", gl::Barrier::storage);
  prefetch_->use();
  bindRecords();
  scene_.bind();
  prefetchPoints_.bindStorage(CACHE_FOUND_BUFFER);
  pass.dispatch(glm::ivec3(settings_.prefetch, 1, 1), glm::ivec3(64, 1, 1));
  prefetchedFrom_ = path_.cameraPosition;
}

void IrradianceCache::mark(const Inputs& inputs) {
  if (inputs.fades) findPrefetchPoints();
  claim(inputs, {mark_, claim_}, slotTable_);
}

// Marks slots, then makes records of the pixels that have found an empty one.
void IrradianceCache::claim(const Inputs& inputs, const std::array<const gl::Program*, 2>& programs,
                            gl::BufferTexture& slots) {
  keys_.buffer().clear(0xffffffffu);
  const glm::ivec2 picture = inputs.visible.size();
  const int rowsOfPrefetch = inputs.fades ? (settings_.prefetch + picture.x - 1) / picture.x : 0;
  const glm::ivec3 size(picture.x, picture.y + rowsOfPrefetch, 1), group(8, 8, 1);
  const std::size_t bytes = static_cast<std::size_t>(size.x * size.y) * sizeof(GLuint);
  if (claiming_.bytes() < bytes)
    claiming_ = gl::Buffer("cache pixels that claim", bytes, nullptr, gl::Usage::dynamicCopy);
  const std::array<GLuint, kWorkWords> none = noWork();
  work_[0].upload(kClaimGroups * sizeof(GLuint), (kWorkWords - kClaimGroups) * sizeof(GLuint), &none[kClaimGroups]);
  const auto bind = [&](const gl::Program& program) {
    program.use();
    bindRecords();
    inputs.visible.bind(program, inputs.worldFromClip);
    slots.bind(UNIT_CACHE_SLOTS);
    if (split_) split_->tiles.bind(UNIT_CACHE_TILES);
    prefetchPoints_.bindStorage(CACHE_PREFETCH_BUFFER);
    claiming_.bindStorage(CACHE_CLAIMING_BUFFER);
  };
  {
    const gl::ComputePass pass("cache mark records",
                               gl::Barrier::storage | gl::Barrier::textureFetch | gl::Barrier::command);
    bind(*programs[0]);
    seen_.buffer().bindStorage(CACHE_SEEN_BUFFER);
    keys_.buffer().bindStorage(CACHE_KEYS_BUFFER);
    pass.dispatch(size, group);
  }
  const gl::ComputePass pass("cache claim records",
                             gl::Barrier::storage | gl::Barrier::textureFetch | gl::Barrier::command);
  bind(*programs[1]);
  keys_.bind(UNIT_CACHE_KEYS);
  slots.buffer().bindStorage(CACHE_SLOTS_BUFFER);
  pass.dispatchIndirect(work_[0], kClaimGroups * sizeof(GLuint));
}

// Places the records found, splits the cells where they are close to other surfaces, and finds records for the parts.
void IrradianceCache::split(const Inputs& inputs) {
  if (!split_) return;
  list(0);
  claim(inputs, split_->find, split_->slots);
}

// Lists visible records with fewer paths than `target`.
void IrradianceCache::list(int target, bool countsFading, bool parts) {
  std::array<GLuint, kWorkWords> none = noWork();
  none[kFrame] = frame_;
  work_[0].upload(kWaiting * sizeof(GLuint), (kTraced - kWaiting) * sizeof(GLuint), &none[kWaiting]);
  bindRecords();
  cascadeConstantsBefore_.bindUniform(BLOCK_CASCADES);  // new records look up the light shown in their place before
  irradiance_.bind(UNIT_CACHE);
  scene_.bind();
  lit_.bindStorage(CACHE_LIST_BUFFER);
  const gl::ComputePass pass("cache list records",
                             gl::Barrier::storage | gl::Barrier::command | gl::Barrier::textureFetch);
  list_->use();
  list_->set("mostLit", static_cast<unsigned>(lit_.bytes() / sizeof(GLuint)));
  list_->set("pathTarget", static_cast<unsigned>(target));
  list_->set("countsFading", countsFading ? 1 : 0);
  if (split_) {
    list_->set("shareOfParts", settings_.splitShare);
    list_->set("listsParts", parts ? 1 : 0);
    list_->set("mostTiles", static_cast<unsigned>(split_->mostTiles));
    split_->tiles.buffer().bindStorage(CACHE_TILES_BUFFER);
  }
  slotTable_.bind(UNIT_CACHE_SLOTS);
  seen_.bind(UNIT_CACHE_SEEN);
  pass.dispatchIndirect(work_[0]);
  cascadeConstants_.bindUniform(BLOCK_CASCADES);
}

std::array<GLuint, IrradianceCache::kWorkWords> IrradianceCache::noWork() {
  std::array<GLuint, kWorkWords> words{0, 1, 1};
  for (std::size_t part = kLitGroups; part < kTraced; part += 3) words[part + 1] = words[part + 2] = 1;
  words[kClaimGroups + 1] = words[kClaimGroups + 2] = 1;
  return words;
}

void IrradianceCache::dispatchListed(const gl::ComputePass& pass, const gl::Program& program, const gl::Buffer& work) {
  for (unsigned part = 0; part < CACHE_PARTS; ++part) {
    program.set("firstGroup", part * CACHE_PART_GROUPS);
    pass.dispatchIndirect(work, (kLitGroups + 3 * part) * sizeof(GLuint));
  }
}

void IrradianceCache::light(int target, bool parts) {
  list(target, false, parts);
  const gl::ComputePass pass("cache paths", gl::Barrier::storage);
  paths_->use();
  irradiance_.bind(UNIT_CACHE);
  gl::Submission::add(mostIterations());
  dispatchListed(pass, *paths_, work_[0]);
}

void IrradianceCache::makeKept() {
  const gl::ShaderFlags paths = gl::with(rays_, {{"CACHED", 1}, {"FROM_CELLS", 0}, {"KEEPS", 1}});
  kept_ = std::make_unique<KeptHits>();
  kept_->lamps = &programs_->loadCompute("cache light of lamps", "irradiance_cache/lamps.comp", rays_);
  for (int moved = 0; moved < 2; ++moved)
    kept_->retrace[static_cast<std::size_t>(moved)] = &programs_->loadCompute(
        "cache paths to trace again", "irradiance_cache/retrace.comp", gl::with(rays_, {{"MOVED", moved}}));
  kept_->trace = &programs_->loadCompute("cache kept paths", "irradiance_cache/paths.comp", paths);
  kept_->relight =
      &programs_->loadCompute("cache relight records", "irradiance_cache/relight.comp", lookupFlags(settings_));
  const std::size_t hits = std::min(capacity_, std::size_t{CACHE_KEEPING}) * CACHE_HITS;
  for (gl::Buffer& buffer : kept_->hits)
    buffer = gl::Buffer("cache hits", hits * sizeof(shared::CacheHit), nullptr, gl::Usage::dynamicCopy);
  kept_->traced = gl::Buffer("cache traced paths", hits * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  kept_->light = gl::BufferTexture("cache light", gl::Format::rgba32f, capacity_ * sizeof(glm::vec4), nullptr,
                                   gl::Usage::dynamicCopy);
}

// After surfaces or lights have moved: all records are lit by what their paths hit; only paths that meet what has moved
// are traced again.
void IrradianceCache::relight() {
  KeptHits& kept = *kept_;
  list(0);  // places new records
  kept.light.buffer().clear(0);  // what paths make records for has no light yet
  {
    const gl::ComputePass pass("cache light of lamps", gl::Barrier::storage | gl::Barrier::textureFetch);
    kept.lamps->use();
    bindRecords();
    scene_.bind();
    kept.light.buffer().bindStorage(CACHE_LIST_BUFFER);
    pass.dispatchIndirect(work_[0]);
  }
  {
    const GLuint none = 0;
    work_[0].upload(kTraced * sizeof(GLuint), sizeof none, &none);
    const gl::ComputePass pass("cache paths to trace again", gl::Barrier::storage | gl::Barrier::command);
    const gl::Program& retrace = *kept.retrace[moved_.empty() ? 0 : 1];
    retrace.use();
    if (!moved_.empty()) retrace.set("movedBoxes", static_cast<int>(moved_.size()));
    retrace.set("allAnew", kept.areValid ? 0 : 1);
    retrace.set("budget", settings_.tracedPaths == IrradianceCacheSettings::kAllPaths
                              ? ~0u
                              : static_cast<unsigned>(settings_.tracedPaths));
    kept.traced.bindStorage(CACHE_LIST_BUFFER);
    kept.hits[0].bindStorage(CACHE_HITS_BUFFER);
    movedBoxes_.bind(UNIT_CACHE_MOVED);
    slotTable_.bind(UNIT_CACHE_SLOTS);
    kept.light.bind(UNIT_CACHE_LIGHT);
    pass.dispatchIndirect(work_[0]);
  }
  gl::Submission::add(static_cast<double>(kept.traced.bytes() / sizeof(GLuint)) * kIterationsOfPath);
  for (unsigned part = 0; part < CACHE_PARTS; ++part) {  // each sees the records that those before have made
    const gl::ComputePass pass("cache kept paths",
                               gl::Barrier::storage | gl::Barrier::command | gl::Barrier::textureFetch);
    kept.trace->use();
    kept.trace->set("firstGroup", part * CACHE_PART_GROUPS);
    irradiance_.bind(UNIT_CACHE);
    slotTable_.buffer().bindStorage(CACHE_SLOTS_OF_PATHS_BUFFER);
    pass.dispatchIndirect(work_[0], (kLitGroups + 3 * part) * sizeof(GLuint));
  }
  const gl::ComputePass pass("cache relight records", gl::Barrier::storage);
  kept.relight->use();
  pass.dispatchIndirect(work_[0]);
  kept.areValid = true;
  lit_.bindStorage(CACHE_LIST_BUFFER);
}

// New records gather all their light; then they are final while the maps stay.
void IrradianceCache::gather(const Inputs& inputs) {
  bindRecords();
  gather_->update(inputs.maps, inputs.mapsAreNew);
  list(1);
  gather_->gather(inputs.maps, work_[0], kLitGroups * sizeof(GLuint), lit_.bytes() / sizeof(GLuint));
}

void IrradianceCache::store(float mostChange) {
  const std::array<const gl::Texture*, 1> textures{&irradiance_};
  gl::clearToZero(textures, clearTexture_);
  const gl::ComputePass pass("cache store records", gl::Barrier::storage | gl::Barrier::textureFetch,
                             gl::Barrier::image);
  store_->use();
  store_->set("enoughPaths", static_cast<unsigned>(std::min(settings_.samples, settings_.leastRays)));
  store_->set("mostChange", mostChange);
  if (smooths_) store_->set("pathsOfRound", static_cast<float>(settings_.rays));
  bindRecords();
  slotTable_.bind(UNIT_CACHE_SLOTS);
  irradiance_.bindImage(0, gl::Access::write);
  pass.dispatchIndirect(work_[0]);
}

// Parts are for the picture alone: no path ends at them.
void IrradianceCache::storeParts() {
  if (!split_) return;
  const gl::ComputePass parts("cache store parts", gl::Barrier::storage);
  split_->store->use();
  split_->store->set("pathsOfRound", static_cast<float>(settings_.rays));
  bindRecords();
  irradiance_.bind(UNIT_CACHE);
  slotTable_.bind(UNIT_CACHE_SLOTS);
  split_->slots.bind(UNIT_CACHE_PART_SLOTS);
  split_->tiles.bind(UNIT_CACHE_TILES);
  split_->light.buffer().bindStorage(CACHE_PARTS_BUFFER);
  parts.dispatchIndirect(work_[0]);
}

// Stored values are of the order of the scene's light, also when that has become another.
void IrradianceCache::beginToFollow(bool fades) {
  constexpr float kMuch = 16.0f;
  const float change = typicalIrradiance_ / referenceIrradiance_;
  if (!fades || change > kMuch || change < 1.0f / kMuch) {
    referenceIrradiance_ = typicalIrradiance_;
    forget();
    return;
  }
  std::vector<shared::MovedBox> boxes;
  for (const Bounds& box : moved_) boxes.push_back({glm::vec3(box.min), 0.0f, glm::vec3(box.max), 0.0f});
  boxes.resize(std::max(boxes.size(), std::size_t{1}));
  const std::size_t bytes = boxes.size() * sizeof(shared::MovedBox);
  if (movedBoxes_.bytes() < bytes)
    movedBoxes_ = gl::BufferTexture("cache moved boxes", gl::Format::rgba32f, bytes, nullptr, gl::Usage::dynamicDraw);
  movedBoxes_.upload(0, bytes, boxes.data());
}

// Each frame brings light one bounce further; in the last one all paths are traced, as in a view at rest.
bool IrradianceCache::stillSettles() {
  settles_ = settles_ && frame_ < followedIn_ + kBounces;
  return settles_;
}

IrradianceCache::Found IrradianceCache::findRecords(const Inputs& inputs) {
  if (settles_ && !inputs.fades) forget();  // a whole picture is that of a new cache
  const bool settles = !followed_ && stillSettles();
  if (followed_) {
    beginToFollow(inputs.fades);
    settles_ = cached_ && !gather_ && !cascades_.empty();
    followedIn_ = nextFrame();
  }
  followed_ = followed_ || settles;
  const bool moved = !cascades_.empty() &&
                     !std::equal(cascades_.begin(), cascades_.end(), inputs.cascades.begin(), inputs.cascades.end(),
                                 [](const Cascade& a, const Cascade& b) { return a.firstCell == b.firstCell; });
  const bool isEmpty = cascades_.empty(), cut = isEmpty || isCut(cascades_.front(), inputs.cascades.front());
  const float mostChange = inputs.fades && !cut && !followed_ ? settings_.mostChange : 0.0f;
  place(inputs);
  cascades_ = inputs.cascades;
  // Where other light than that of lamps has changed nothing kept holds: records in view are lit as new ones are.
  const bool isLast = settles && nextFrame() >= followedIn_ + kBounces;
  const bool relights = kept_ && followed_ && !isLast && !isEmpty && !kept_->allAnew;
  // Nor where cascades have moved: hits know records by their slots, which belong to other cells now.
  if (kept_ && (moved || isEmpty || kept_->allAnew)) kept_->areValid = false, kept_->allAnew = false;
  if (followed_ && !isEmpty) keep(*keepFollowed_);
  else if (moved) keep(*keep_);
  followed_ = false;
  mark(inputs);
  split(inputs);
  return {relights, mostChange};
}

void IrradianceCache::see(const Inputs& inputs) {
  findRecords(inputs);
  sees_ = true;
  list(0);  // records are placed by the view that has found them
}

void IrradianceCache::update(const Inputs& inputs, int rounds) {
  const auto [relights, mostChange] = findRecords(inputs);
  sees_ = false;
  if (relights) relight();
  moved_.clear();
  if (settings_.transport == CacheTransport::gather) {
    gather(inputs);
    store(mostChange);
    list(1, true);
    ring_->copy(work_[0]);
    return;
  }
  // Paths of parts begin when they can end at records.
  const int roundsOfCells = cached_ && split_ ? 1 : 0;
  for (int round = 0; round < rounds + roundsOfCells && !relights; ++round) {
    if (cached_ && round > 0) store(mostChange);
    light(settings_.samples, round >= roundsOfCells);
  }
  for (int paths = relights ? 0 : rounds * settings_.rays; paths < std::min(settings_.leastRays, settings_.samples);
       paths += settings_.rays)
    light(settings_.leastRays);
  store(mostChange);
  storeParts();
  list(settings_.samples, true);  // the remaining work
  ring_->copy(work_[0]);
}

void IrradianceCache::bindForLookup() const {
  cascadeConstants_.bindUniform(BLOCK_CASCADES);
  constants_.bindUniform(BLOCK_CACHE);
  irradiance_.bind(UNIT_CACHE);
  if (split_) {
    split_->tiles.bind(UNIT_CACHE_TILES);
    split_->light.bind(UNIT_CACHE_PARTS);
  }
}

void IrradianceCache::bindForRays() const {
  bindForLookup();
  pathConstants_.bindUniform(BLOCK_CACHE_PATHS);
  scene_.bind();
}

std::vector<InspectedPart> IrradianceCache::inspect(const glm::vec3& position, const glm::vec3& normal) const {
  const InspectedParts parts((split_ ? 48 : 24) * MAX_CASCADES);
  {
    const gl::Program& program =
        programs_->loadCompute("cache inspect records", "irradiance_cache/inspect.comp", pictureFlags());
    const gl::ComputePass pass("cache inspect records");
    program.use();
    bindRecords();
    bindForLookup();
    slotTable_.bind(UNIT_CACHE_SLOTS);
    if (split_) split_->slots.bind(UNIT_CACHE_PART_SLOTS);
    program.set("inspectedPosition", position);
    program.set("inspectedNormal", normal);
    parts.bind();
    pass.dispatch(glm::ivec3(1), glm::ivec3(1));
  }
  return parts.read();
}

std::vector<IrradianceCache::Shown> IrradianceCache::shown() const {
  const std::size_t count = std::min<std::size_t>(work_[0].read<GLuint>()[kWanted], capacity_);
  std::vector<Shown> result;
  if (count == 0) return result;
  for (const shared::CacheRecord& r : records_[0].read<shared::CacheRecord>(count)) {
    if (r.triangle == CACHE_UNPLACED || r.triangle == CACHE_NOWHERE || r.paths == 0 ||
        r.cell.w >= settings_.cascades.cascades * CACHE_FACES)
      continue;
    result.push_back({r.position, r.normal, r.shown, r.blendWeight, glm::ivec3(r.cell), r.cell.w / CACHE_FACES,
                      r.cell.w % CACHE_FACES});
  }
  return result;
}

void IrradianceCache::collect(bool wait) {
  for (std::vector<GLuint> words = ring_->fetch(wait); !words.empty(); words = ring_->fetch(wait)) {
    counts_.records = std::min<std::uint64_t>(words[kWanted], capacity_);
    counts_.left = words[kWanted] - counts_.records;
    counts_.waiting = words[kWaiting];
    counts_.traced = words[kTraced];
    counts_.frame = words[kFrame];
  }
}

std::size_t IrradianceCache::mostFrames() const {
  const std::size_t lit = lit_.bytes() / sizeof(GLuint), lists = (capacity_ + lit - 1) / lit;
  const auto paths = static_cast<std::size_t>(settings_.rays);
  const std::size_t each = settings_.transport == CacheTransport::gather
                               ? 1
                               : (static_cast<std::size_t>(settings_.samples) + paths - 1) / paths;
  return (lists + 1) * each + 1;
}

double IrradianceCache::mostIterations() const {
  if (gather_) return gather_->mostIterations();
  return static_cast<double>(lit_.bytes() / sizeof(GLuint)) * settings_.rays * kIterationsOfPath;
}

std::size_t IrradianceCache::gpuBytes() const {
  std::size_t bytes = cascadeConstants_.bytes() + cascadeConstantsBefore_.bytes() + constants_.bytes() +
                      pathConstants_.bytes() + lit_.bytes() + slotTable_.bytes() + keys_.bytes() + seen_.bytes() +
                      claiming_.bytes() + irradiance_.bytes() + prefetchPoints_.bytes() + movedBoxes_.bytes() +
                      ring_->bytes() + (gather_ ? gather_->gpuBytes() : 0);
  for (std::size_t i = 0; i < 2; ++i) bytes += records_[i].bytes() + work_[i].bytes();
  if (split_) bytes += split_->tiles.bytes() + split_->slots.bytes() + split_->light.bytes();
  if (kept_) bytes += kept_->hits[0].bytes() + kept_->hits[1].bytes() + kept_->traced.bytes() + kept_->light.bytes();
  return bytes;
}

}  // namespace lucerna
