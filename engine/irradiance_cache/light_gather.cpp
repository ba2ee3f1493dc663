#include "irradiance_cache/light_gather.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"
#include "gl/chunks.hpp"
#include "irradiance_cache/bounce_cache.hpp"
#include "irradiance_cache/emission_points.hpp"
#include "rays/light_table.hpp"
#include "rsm/rsm_gather.hpp"
#include "scene/coat.hpp"
#include "scene/texture_mean.hpp"
#include "shared/irradiance_cache.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace lucerna {

namespace {

constexpr std::size_t kLinkBytes = 12;  // of a ray: a point's number and the albedo there
constexpr int kMostBounces = 64;
constexpr int kRaysOfLane = 2;  // around a record
constexpr int kDeepest = 13;  // of a light tree: maps have at most 8192 texels a side
constexpr int kEmissionSize = 64;  // texels per side of the emissive surfaces' map
constexpr double kLeft = 1.0 / 512.0;  // share of the light that all bounces may leave out

/// Largest mean albedo of a material of the scene, 0..1.
double largestAlbedo(const Scene& scene) {
  double largest = 0.0;
  for (const Mesh& mesh : scene.meshes) {
    Material material = scene.materials[static_cast<std::size_t>(mesh.material)];
    if (material.diffuseTexture >= 0)
      material.diffuse *=
          glm::vec3(meanColour(scene.textures[static_cast<std::size_t>(material.diffuseTexture)].bitmap));
    const glm::vec3 albedo = wholeReflectance(material);
    largest = std::max(largest, static_cast<double>(std::max({albedo.x, albedo.y, albedo.z})));
  }
  return std::min(largest, 1.0);
}

/// Bounces after which a share kLeft of the light is left, in a closed room of that albedo.
int bouncesOfAll(double albedo) {
  if (albedo <= kLeft) return 1;
  return albedo >= 1.0 ? kMostBounces
                       : static_cast<int>(std::clamp(std::ceil(std::log(kLeft) / std::log(albedo)), 1.0,
                                                     static_cast<double>(kMostBounces)));
}

}  // namespace

/// The records that a dispatch works on: `count`, or at most as many, with the groups of each part in a buffer.
struct LightGather::Targets {
  const gl::Buffer* groups = nullptr;
  std::size_t offset = 0, count = 0;

  /// iterations: of a lane.
  void dispatch(const gl::ComputePass& pass, const gl::Program& program, double iterations) const {
    for (std::size_t first = 0; first < count; first += CACHE_PART_GROUPS) {
      const std::size_t size = std::min<std::size_t>(count - first, CACHE_PART_GROUPS);
      gl::Submission::add(iterations * CACHE_LANES * static_cast<double>(size));
      program.set("firstGroup", static_cast<unsigned>(first));
      if (groups) pass.dispatchIndirect(*groups, offset + first / CACHE_PART_GROUPS * 3 * sizeof(GLuint));
      else pass.dispatch(glm::ivec3(static_cast<int>(size), 1, 1), glm::ivec3(1));
    }
  }
};

double LightGather::iterationsOfLane(int depth, int top, int layers) {
  const double coarsest = std::ceil(layers * std::exp2(2 * top) / CACHE_LANES);
  // Opening; then three siblings on each level, and the coarsest nodes. Texels near by. The way to a leaf, and a ray.
  return CACHE_MOST_OPENING + 3.0 * (depth - top) + coarsest + CACHE_MOST_NEAR + 4.0 * depth + gl::kIterationsOfRay;
}

double LightGather::mostIterations() const {
  const double iterations =
      std::max(iterationsOfLane(kDeepest, LightTree::kTop, 6), kRaysOfLane * gl::kIterationsOfRay);
  return iterations * CACHE_LANES * CACHE_PART_GROUPS;
}

LightGather::Parts LightGather::partsOf(const SceneFeatures& features, const IrradianceCacheSettings& settings,
                                        CachedLight light) {
  const bool own = light != CachedLight::indirect, reflected = light != CachedLight::direct;
  const bool extended = features.emission || features.environment, lamps = features.anyLight() && features.indirect;
  Parts parts;
  parts.maps = lamps && reflected;
  parts.bounces = reflected && (extended || (lamps && settings.bounces != 1));
  parts.emission = features.emission && (own || parts.bounces);
  parts.hemisphere = parts.bounces || (own && extended);
  parts.mapsOfBounces = parts.bounces && lamps && settings.bounces != 1;
  return parts;
}

LightGather::LightGather(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                         const glm::dvec3& origin, const IrradianceCacheSettings& settings, CachedLight light,
                         const PathScene& paths, const gl::ShaderFlags& common)
    : visibility_(settings.visibility), programs_(&programs), capabilities_(&capabilities), paths_(&paths) {
  const SceneFeatures features = analyse(scene);
  parts_ = partsOf(features, settings, light);
  const bool own = ownEmission_ = light != CachedLight::indirect;
  const gl::ShaderFlags rays = gl::with(
      gl::with(common, paths.flags()),
      {{"LINEAR_SEEDS", 0}, {"GLOSSY", 0}, {"SHARED_STACK", paths.rays().sharedStack()}, {"PATHS", CACHE_LANES}});
  const auto load = [&](const char* name, bool perspective, bool shared) {
    return &programs.loadCompute(name, "irradiance_cache/gather/gather.comp",
                                 gl::with(rays, {{"PERSPECTIVE", perspective},
                                                 {"SHARED_WITH_RAYS", shared},
                                                 {"VISIBILITY", static_cast<int>(visibility_)},
                                                 {"NEAR", static_cast<int>(RsmGather::Near::quad)},
                                                 {"MAP_LIGHT", 0}}));
  };
  if (parts_.maps && features.directionalLight) sun_ = load("cache gather sun", false, false);
  if (parts_.maps && (features.spotLights || features.pointLights)) lamp_ = load("cache gather lamp", true, false);
  if (parts_.emission) {
    emission_ = load("cache gather emission", true, true);
    makeEmission(programs, capabilities, scene, origin);
  }
  if (parts_.hemisphere)
    hemisphere_ = &programs.loadCompute(
        "cache gather hemisphere", "irradiance_cache/gather/hemisphere.comp",
        gl::with(rays, {{"OWN", own}, {"BOUNCED", parts_.bounces}, {"LINKS", 0}, {"RAYS", kRaysOfLane}}));
  // The records' own rays are a bounce too.
  passes_ = (settings.bounces == IrradianceCacheSettings::kAllBounces ? bouncesOfAll(largestAlbedo(scene))
                                                                      : settings.bounces) -
            1;
  if (parts_.bounces)
    makeBounces(programs, capabilities, scene, origin, settings.bounceCells,
                gl::with(rays, {{"OWN", 1}, {"BOUNCED", 1}, {"LINKS", 1}, {"RAYS", 1}}));
  if (!(sun_ || lamp_ || emission_)) return;
  const glm::dvec3 extent = scene.main().extent();
  rayEnd_ = static_cast<float>(1e-4 * std::max({extent.x, extent.y, extent.z}));
}

void LightGather::makeEmission(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                               const glm::dvec3& origin) {
  const EmissionPoints points =
      emissionPoints(scene, lightTable(scene, paths_->origin()).pickDensity, origin, kEmissionSize);
  areaOverDensity_ = static_cast<float>(points.areaOverDensity);
  const auto make = [&](const char* name, const std::vector<glm::vec4>& texels) {
    gl::Texture texture(name, gl::Format::rgba32f, glm::ivec3(kEmissionSize, kEmissionSize, 1), {}, 1,
                        gl::TextureKind::array);
    texture.upload(gl::Texels::rgbaFloat, texels.data());
    return texture;
  };
  emissionPosition_ = make("cache emission position", points.position);
  emissionNormal_ = make("cache emission normal", points.normal);
  emissionFlux_ = make("cache emission flux", points.flux);
  emissionTree_.emplace(programs, capabilities, kEmissionSize, 1, LightTree::Area::mean);
}

ReflectiveShadowMap::Outputs LightGather::emissionMap() const {
  return {emissionPosition_, emissionNormal_, emissionFlux_};
}

void LightGather::makeBounces(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                              const glm::dvec3& origin, int bounceCells, const gl::ShaderFlags& around) {
  const BounceCache bounce = bounceCache(scene, bounceCells);
  points_ = bounce.points.size();
  bounceMinimum_ = glm::vec3(bounce.minimum - paths_->origin());
  bounceCell_ = static_cast<float>(bounce.cellSize);
  bounceCells_ = bounce.cells;
  std::vector<shared::CacheRecord> points(points_);
  std::vector<glm::vec4> places(points_);  // w: bits of the next layer's number
  for (std::size_t i = 0; i < points_; ++i) {
    const BounceCache::Point& from = bounce.points[i];
    shared::CacheRecord& to = points[i];
    to = {};
    to.cell = from.place;
    to.triangle = from.triangle;
    to.state = from.front ? CACHE_FRONT : 0u;
    to.second = from.barycentrics.x;
    to.third = from.barycentrics.y;
    to.position = glm::vec3(from.position - origin);
    to.normal = from.normal;
    places[i] = glm::vec4(glm::vec3(from.position - paths_->origin()), std::bit_cast<float>(from.next));
  }
  std::vector<GLuint> list(points_);
  std::iota(list.begin(), list.end(), 0u);
  pointData_ = storageOf("bounce cache", points, capabilities);
  list_ = storageOf("cache bounce list", list, capabilities);
  const std::size_t count = std::max<std::size_t>(points_, 1), linkBytes = count * CACHE_LANES * kLinkBytes;
  if (linkBytes > static_cast<std::size_t>(capabilities.maxShaderStorageBlockSize))
    throwMissingCapability(
        "cache bounces: {} bytes; this driver's storage blocks have at most {} (GL_MAX_SHADER_STORAGE_BLOCK_SIZE)",
        linkBytes, capabilities.maxShaderStorageBlockSize);
  links_ = gl::Buffer("cache bounce links", linkBytes, nullptr, gl::Usage::dynamicCopy);
  if (bounce.slots.size() > static_cast<std::size_t>(capabilities.maxTextureBufferSize))
    throwMissingCapability(
        "cache bounces: {} texels; this driver's texture buffers have at most {} (GL_MAX_TEXTURE_BUFFER_SIZE)",
        bounce.slots.size(), capabilities.maxTextureBufferSize);
  slots_ = gl::BufferTexture("cache bounce slots", gl::Format::r32ui, bounce.slots.size() * sizeof(GLuint),
                             bounce.slots.data());
  places.resize(count);
  places_ = gl::BufferTexture("cache bounce places", gl::Format::rgba32f, count * sizeof(glm::vec4), places.data(),
                              gl::Usage::dynamicCopy);
  for (gl::BufferTexture& light : light_)
    light = gl::BufferTexture("cache bounced light", gl::Format::rgba32f, count * sizeof(glm::vec4), nullptr,
                              gl::Usage::dynamicCopy);
  trace_ = &programs.loadCompute("cache trace bounces", "irradiance_cache/gather/hemisphere.comp", around);
  bounce_ = &programs.loadCompute("cache bounce", "irradiance_cache/gather/bounce.comp", {});
}

void LightGather::gatherTree(const gl::Program& program, const ReflectiveShadowMap::Outputs& map, const LightTree& tree,
                             const Targets& targets, bool last) const {
  const gl::ComputePass pass("cache gather", gl::Barrier::storage);
  program.use();
  program.set("last", last ? 1u : 0u);
  if (&program == emission_) {
    program.set("raysAround", static_cast<float>(CACHE_LANES * (targets.groups ? kRaysOfLane : 1)));
    program.set("cell", targets.groups ? 0.0f : bounceCell_);
  }
  if (visibility_ == GatherVisibility::rays) {
    paths_->bind();
    program.set("rayEnd", rayEnd_);
  }
  if (&program == sun_ && visibility_ == GatherVisibility::rays)
    map.position.bind(UNIT_CACHE_MAP), map.normal.bind(UNIT_CACHE_MAP + 1), map.flux.bind(UNIT_CACHE_MAP + 2);
  else if (&program == sun_) map.bind();
  tree.bind(program, UNIT_CACHE_TREE);
  targets.dispatch(pass, program, iterationsOfLane(tree.depth(), tree.top(), tree.layers()));
}

void LightGather::gatherHemisphere(const gl::Program& program, const Targets& targets, bool last) const {
  const gl::ComputePass pass("cache gather hemisphere", gl::Barrier::storage | gl::Barrier::textureFetch);
  program.use();
  program.set("last", last ? 1u : 0u);
  program.set("areaOverDensity", areaOverDensity_);
  program.set("bounceMinimum", bounceMinimum_);
  program.set("bounceCell", bounceCell_);
  program.set("bounceCells", bounceCells_);
  paths_->bind();
  if (parts_.bounces) {
    slots_.bind(UNIT_CACHE_BOUNCE_SLOTS);
    light_[0].bind(UNIT_CACHE_BOUNCED);
    links_.bindStorage(CACHE_LINKS_BUFFER);
    places_.bind(UNIT_CACHE_BOUNCE_PLACES);
    places_.buffer().bindStorage(CACHE_BOUNCED_BUFFER);
  }
  targets.dispatch(pass, program, kRaysOfLane * gl::kIterationsOfRay);
}

void LightGather::update(const std::vector<ReflectiveShadowMap::Outputs>& maps, bool mapsAreNew) {
  if (!stale_ && !mapsAreNew) return;
  if (parts_.maps)
    for (std::size_t i = 0; i < maps.size(); ++i) {
      if (trees_.size() <= i)
        trees_.emplace_back(*programs_, *capabilities_, maps[i].position.size().x, maps[i].position.size().z);
      trees_[i].build(maps[i]);
    }
  if (emissionTree_ && stale_) emissionTree_->build(emissionMap());
  stale_ = false;
  if (!parts_.bounces || points_ == 0) return;

  // The points' own light of emissive surfaces and the sky, where their rays lead, and one bounce of sun and lamps.
  pointData_.bindStorage(CACHE_RECORDS_BUFFER);
  list_.bindStorage(CACHE_LIST_BUFFER);
  const Targets targets{nullptr, 0, points_};
  if (!probed_) {
    trace_->set("probes", 1);
    gatherHemisphere(*trace_, targets, false);
    probed_ = true;
  }
  trace_->set("probes", 0);
  gatherHemisphere(*trace_, targets, false);
  if (emissionTree_) gatherTree(*emission_, emissionMap(), *emissionTree_, targets, false);
  const int start = passes_ % 2;
  bounce(start, true);
  if (parts_.mapsOfBounces)
    for (std::size_t i = 0; i < maps.size(); ++i)
      gatherTree(maps[i].light == ReflectiveShadowMap::Light::sun ? *sun_ : *lamp_, maps[i], trees_[i], targets, false);
  // And all of that again by way of the surfaces that their rays have met.
  for (int i = 0; i < passes_; ++i) bounce((start + i + 1) % 2, false);
}

void LightGather::bounce(int to, bool first) {
  gl::Submission::add(static_cast<double>(points_) * CACHE_LANES);
  const gl::ComputePass pass("cache bounce", gl::Barrier::storage | gl::Barrier::textureFetch);
  bounce_->use();
  bounce_->set("first", first ? 1 : 0);
  bounce_->set("points", static_cast<unsigned>(points_));
  pointData_.bindStorage(CACHE_RECORDS_BUFFER);
  links_.bindStorage(CACHE_LINKS_BUFFER);
  light_[1 - to].bind(UNIT_CACHE_BOUNCED);
  light_[to].buffer().bindStorage(CACHE_BOUNCED_BUFFER);
  pass.dispatch(glm::ivec3(static_cast<int>(points_), 1, 1), glm::ivec3(CACHE_LANES, 1, 1));
}

void LightGather::gather(const std::vector<ReflectiveShadowMap::Outputs>& maps, const gl::Buffer& groups,
                         std::size_t offset, std::size_t most) {
  const Targets targets{&groups, offset, most};
  const bool emission = emission_ && ownEmission_, around = hemisphere_ != nullptr;
  if (parts_.maps)
    for (std::size_t i = 0; i < maps.size(); ++i)
      gatherTree(maps[i].light == ReflectiveShadowMap::Light::sun ? *sun_ : *lamp_, maps[i], trees_[i], targets,
                 !emission && !around && i + 1 == maps.size());
  if (emission) gatherTree(*emission_, emissionMap(), *emissionTree_, targets, false);
  if (around) gatherHemisphere(*hemisphere_, targets, true);
}

std::size_t LightGather::gpuBytes() const {
  std::size_t bytes = emissionPosition_.bytes() + emissionNormal_.bytes() + emissionFlux_.bytes() +
                      (emissionTree_ ? emissionTree_->gpuBytes() : 0) + pointData_.bytes() + list_.bytes() +
                      links_.bytes() + slots_.bytes() + places_.bytes() + light_[0].bytes() + light_[1].bytes();
  for (const LightTree& tree : trees_) bytes += tree.gpuBytes();
  return bytes;
}

}  // namespace lucerna
