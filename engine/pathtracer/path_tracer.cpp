#include "pathtracer/path_tracer.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "gl/pass.hpp"
#include "pathtracer/clearance.hpp"
#include "pathtracer/film.hpp"
#include "rays/view_rays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

namespace lucerna {

namespace {

constexpr GLuint kConstantsBinding = 0;  // GL_UNIFORM_BUFFER
constexpr GLuint kStateBinding = 5, kMediaBinding = 6, kInteriorsBinding = 7, kGridsBinding = 0,
                 kDensitiesBinding = 1;  // GL_SHADER_STORAGE_BUFFER
constexpr GLuint kClearancesUnit = 3, kCastersUnit = 5;
constexpr int kGroupSide = 8, kGroupPixels = kGroupSide * kGroupSide;
constexpr int kClearanceCells = 64;
// With walks a submission has rounds: of rays, each of which counts 4 iterations and more, and of walks.
constexpr std::uint32_t kRoundIterations = 512;
// llvmpipe leaves all loops of a shader after 65,535 iterations, counted together for all lanes of a vector (8, at most
// 16).
constexpr std::uint32_t kSoftwareIterations = 3500, kMostIterations = 1u << 16;
constexpr std::uint32_t kLoopsOfLinearSeeds = 32;  // published random numbers have loops, which no lane counts
constexpr double kLanesOfTile =
    512.0 * 512.0;  // on a GPU; a smaller tile, also on a software renderer, begins with as many iterations per lane
/// The beginning of StateBlock (path.glsl); std430 aligns the following vectors of the lanes to 16 bytes.
struct StateHeader {
  std::uint32_t leakedPaths = 0, wrongCrossings = 0, longest = 0, allIterations = 0, collisions = 0;
  std::uint32_t finished = 0, padding[2]{};
  std::array<std::uint32_t, 6> heads{}, tails{};  ///< of the queues
};
static_assert(sizeof(StateHeader) % 16 == 0);
constexpr std::size_t kStateHeaderBytes = sizeof(StateHeader), kVec4Bytes = 16;
constexpr std::size_t kPathWords = 6, kSpilledWords = 8, kSpilledInteriorWords = 17,
                      kManifoldWords = 8;  // STATE_WORDS of path.glsl
/// For the inspected pixel: room for the light contributions of a pass of kInspectedSamples.
constexpr std::size_t kInspectedHead = 1 + PATH_INSPECTED_PLACES, kInspectedRecords = 32768,
                      kInspectedWords = kInspectedHead + kInspectedRecords * PATH_INSPECTED_RECORD;
constexpr std::uint32_t kInspectedSamples = 64;

/// Whether every lamp is in the open, where the index is 1. Conservative: emissive triangles are tested by bounding
/// box.
bool areLampsOutside(const Scene& scene, const PackedBoundaries& boundaries) {
  std::vector<Bounds> refracting = boundsOfRanks(boundaries);
  for (std::size_t rank = 0; rank < refracting.size(); ++rank)
    if ((boundaries.dielectricRanks[static_cast<int>(rank / 8)] >> (4 * (rank % 8)) & 15u) == 0) refracting[rank] = {};
  const auto isOutside = [&](const Bounds& lamp) {
    return std::none_of(refracting.begin(), refracting.end(), [&](const Bounds& box) { return overlap(lamp, box); });
  };
  for (const Mesh& mesh : scene.meshes) {
    if (scene.materials[static_cast<std::size_t>(mesh.material)].emission == glm::vec3(0.0f)) continue;
    for (std::uint32_t i = mesh.firstIndex; i + 2 < mesh.firstIndex + mesh.indexCount; i += 3) {
      Bounds box;
      for (std::uint32_t k = i; k < i + 3; ++k) box.add(glm::dvec3(scene.vertices[scene.indices[k]].position));
      if (!isOutside(box)) return false;
    }
  }
  const auto isPlaceOutside = [&](const glm::dvec3& place) {
    return isOutside({glm::dvec3(glm::vec3(place)), glm::dvec3(glm::vec3(place))});
  };
  return std::all_of(scene.points.begin(), scene.points.end(),
                     [&](const PointLight& light) { return isPlaceOutside(light.position); }) &&
         std::all_of(scene.spots.begin(), scene.spots.end(),
                     [&](const SpotLight& light) { return isPlaceOutside(light.position); });
}

constexpr int kMostCasters = 32;

/// The surfaces that lamps are sought by way of (shaders/pathtracer/manifold.comp): mirrors and smooth boundaries that
/// refract. A mesh each; those beyond kMostCasters share the last.
struct Casters {
  std::vector<glm::vec4> balls;  ///< around them, in the ray caster's space: centre, radius
  std::vector<glm::uvec4> parts;  ///< their first triangle in the list, their number, bits of their area
  std::vector<glm::uvec2> triangles;  ///< number in the scene, bits of the share of the area up to its end
};

Casters castersOf(const Scene& scene, const glm::dvec3& origin) {
  std::vector<std::vector<const Mesh*>> groups;
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    const bool isSmooth =
        (material.bsdf == Bsdf::dielectric || material.bsdf == Bsdf::conductor) && material.roughness == 0.0f;
    if (!isSmooth && material.bsdf != Bsdf::mirror) continue;
    if (groups.size() < kMostCasters) groups.emplace_back();
    groups.back().push_back(&mesh);
  }
  Casters casters;
  for (const std::vector<const Mesh*>& group : groups) {
    Bounds box;
    double area = 0.0;
    const std::size_t first = casters.triangles.size();
    std::vector<double> ends;
    for (const Mesh* mesh : group) {
      box.add(mesh->bounds.min);
      box.add(mesh->bounds.max);
      for (std::uint32_t t = mesh->firstIndex / 3; t < (mesh->firstIndex + mesh->indexCount) / 3; ++t) {
        const auto corner = [&](std::size_t k) {
          return glm::dvec3(scene.vertices[scene.indices[3 * std::size_t{t} + k]].position);
        };
        area += 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
        ends.push_back(area);
        casters.triangles.emplace_back(t, 0u);
      }
    }
    for (std::size_t k = 0; k < ends.size(); ++k)
      casters.triangles[first + k].y = std::bit_cast<std::uint32_t>(static_cast<float>(ends[k] / area));
    casters.balls.emplace_back(glm::vec3(0.5 * (box.min + box.max) - origin),
                               static_cast<float>(0.5 * glm::length(box.extent())));
    casters.parts.emplace_back(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(ends.size()),
                               std::bit_cast<std::uint32_t>(static_cast<float>(area)), 0u);
  }
  return casters;
}

int groupsOf(const glm::ivec2& size) {
  const glm::ivec2 groups = (size + kGroupSide - 1) / kGroupSide;
  return groups.x * groups.y;
}

/// Whether a pixel's number, as in findPixel() of path.glsl, is one of a tile of this size.
bool isWithin(std::uint32_t number, const glm::ivec2& size) {
  const int group = static_cast<int>(number) / kGroupPixels, within = static_cast<int>(number) % kGroupPixels,
            columns = (size.x + kGroupSide - 1) / kGroupSide;
  return group % columns * kGroupSide + within % kGroupSide < size.x &&
         group / columns * kGroupSide + within / kGroupSide < size.y;
}

/// Side of a tile whose lanes' state fits in a storage block.
int tileSideOn(const gl::Capabilities& capabilities, std::size_t stateWords) {
  int side = capabilities.softwareRenderer ? 128 : 512;
  const auto bytes = [&] {
    return kStateHeaderBytes +
           static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * stateWords * kVec4Bytes;
  };
  while (bytes() > static_cast<std::size_t>(capabilities.maxShaderStorageBlockSize)) side /= 2;
  return side;
}

}  // namespace

PathTracer::PathTracer(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                       const Settings& settings)
    : settings_(settings),
      features_(analyse(scene)),
      constantsBuffer_("path constants", sizeof(shared::PathConstants), nullptr, gl::Usage::dynamicDraw),
      mostIterations_(!context.capabilities().softwareRenderer ? kMostIterations
                      : settings.deviations.linearSeeds        ? kSoftwareIterations / kLoopsOfLinearSeeds
                                                               : kSoftwareIterations),
      clearTexture_(context.capabilities().clearTexture),
      iterations_(settings.submissionSeconds, kLanesOfTile, mostIterations_) {
  const gl::Capabilities& capabilities = context.capabilities();
  CHECK(settings.size.x > 0 && settings.size.y > 0, "{} x {} pixels", settings.size.x, settings.size.y);
  if (settings.diffuseOnly)
    features_.mirrors = features_.conductors = features_.dielectrics = features_.roughDielectrics = false;

  // The scene: boundaries, lamps, media.
  boundaries_ = rankBoundaries(scene, settings.diffuseOnly);
  touching_ = boundariesMayTouch(scene, boundaries_);
  lampsOutside_ =
      features_.dielectrics && !settings.deviations.straightShadowRays && areLampsOutside(scene, boundaries_);
  const bool published = settings.deviations.distanceWithoutPdf || settings.deviations.boostedInteraction;
  features_.denseMedia = features_.denseMedia && features_.dielectrics && settings.walks && !published &&
                         (!settings.nextEvent || lampsOutside_);
  scene_.emplace(scene, features_, capabilities,
                 PathScene::Settings{
                     .diffuseOnly = settings.diffuseOnly,
                     .nextEvent = settings.nextEvent,
                     .rays = settings.rays,
                     .sunApart = asksSunApart(),
                     .fewestOfHierarchy = settings.deviations == PathDeviations{} ? settings.fewestOfHierarchy : 0},
                 boundaries_.rankOfMaterial);
  scene_->fill(constants_);
  sceneHash_ = scene_->hash();
  if (seeksByManifolds()) {
    const Casters casters = castersOf(scene, scene_->origin());
    casters_ = casters.balls;
    casterParts_ = casters.parts;
    if (!casters_.empty())
      casterTriangles_ = gl::BufferTexture("path casters", gl::Format::rg32ui,
                                           casters.triangles.size() * sizeof(glm::uvec2), casters.triangles.data());
  }
  if (knowsVisibility()) {
    constantsBuffer_.upload(0, sizeof constants_, &constants_);
    lightVisibility_.emplace(programs, scene, *scene_, constantsBuffer_);
  }
  if (features_.denseMedia) addClearances(scene);
  if (features_.dielectrics || features_.nullBoundaries)
    interiors_ = storageOf("path interiors", boundaries_.interiors, capabilities);
  if (features_.media) {
    checkOuterMedium(scene, features_);
    PackedMedia packed = packMedia(scene.media, scene_->origin());
    markSplitMedia(scene, packed);
    media_ = storageOf("path media", packed.media, capabilities);
    interiors_ = storageOf("path interiors", boundaries_.interiors, capabilities);
    outerMedium_ = scene.cameraMedium;
    const auto add = [&](const auto& values) { sceneHash_.bytes(values.data(), values.size() * sizeof values[0]); };
    add(packed.media), add(packed.grids), add(packed.densities);
    if (features_.heterogeneousMedia) {
      grids_ = storageOf("path density grids", packed.grids, capabilities);
      densities_ = storageOf("path densities", packed.densities, capabilities);
    }
  }
  // What is constant over the picture.
  static_assert(kFilterNodes == 4 * std::extent_v<decltype(constants_.filterQuantiles)>);
  if (settings.filter != PixelFilter::centre && settings.filter != PixelFilter::box) {
    const auto quantiles = filterQuantiles(settings.filter);
    for (std::size_t i = 0; i < quantiles.size(); ++i)
      constants_.filterQuantiles[i / 4][static_cast<int>(i % 4)] = quantiles[i];
  }
  constants_.background = scene.background;
  constants_.seed = settings.seed;
  constants_.minScatterings = 0;
  constants_.maxScatterings = settings.bounces;
  switch (settings.transport) {
    case Transport::all: break;
    case Transport::direct: constants_.maxScatterings = std::min(settings.bounces, 1u); break;
    case Transport::indirect: constants_.minScatterings = 2; break;
    case Transport::oneBounce:
    case Transport::oneBounceUnoccluded:
      constants_.minScatterings = 2;
      constants_.maxScatterings = std::min(settings.bounces, 2u);
      break;
  }

  tileSide_ = tileSideOn(capabilities, stateWords());
  allocateFilm();
  program_ = &programs.loadCompute("path tracing", "pathtracer/path.comp", kernelFlags());
  if (!casters_.empty()) {
    gl::ShaderFlags flags = kernelFlags();
    flags.push_back({"MOST_CASTERS", kMostCasters});
    manifoldProgram_ = &programs.loadCompute("specular manifolds", "pathtracer/manifold.comp", flags);
  }
  if (walks()) walkProgram_ = &programs.loadCompute("walks in media", "pathtracer/walk.comp", kernelFlags());
  setCamera(scene.cameras.empty() ? Camera{} : scene.cameras.front());
}

void PathTracer::allocateFilm() {
  const glm::ivec2 tile = settings_.inspectedPixel ? glm::ivec2(1) : glm::min(settings_.size, glm::ivec2(tileSide_));
  // Of whole groups.
  const glm::ivec2 groups = (tile + kGroupSide - 1) / kGroupSide;
  const std::size_t lanes = static_cast<std::size_t>(groups.x * groups.y) * kGroupSide * kGroupSide;
  constants_.picture = glm::ivec4(settings_.size, static_cast<int>(lanes), 0);
  const std::size_t inspection = settings_.inspectedPixel ? kInspectedWords : 0;
  state_ =
      gl::Buffer("path state", kStateHeaderBytes + (lanes * stateWords() + 2 * queueLength() + inspection) * kVec4Bytes,
                 nullptr, gl::Usage::dynamicCopy);
  filmMean_ = gl::Texture("film mean", gl::Format::rgba32ui, filmSize());
  filmM2_ = gl::Texture("film M2", gl::Format::rgba32ui, filmSize());
  filmRest_ = gl::Texture("film rest", gl::Format::rgba32ui, filmSize());
  for (gl::Texture& texture : kept_) texture = gl::Texture("film kept", gl::Format::rgba32ui, tile);
}

void PathTracer::resize(glm::ivec2 size) {
  CHECK(size.x > 0 && size.y > 0, "{} x {} pixels", size.x, size.y);
  settings_.size = size;
  allocateFilm();
}

gl::ShaderFlags PathTracer::flags() const {
  const bool asked = scene_->hasLights();
  gl::ShaderFlags all = scene_->flags();
  all.insert(all.end(), {{"DIFFUSE_ONLY", settings_.diffuseOnly},
                         {"MIRRORS", features_.mirrors},
                         {"DIELECTRICS", features_.dielectrics},
                         {"INTERIORS", hasInteriors()},
                         {"TOUCHING", hasInteriors() && touching_},
                         {"MANIFOLDS", !casters_.empty()},
                         {"MEDIA", features_.media},
                         {"LAMPS_OUTSIDE", lampsOutside_},
                         {"CANDIDATES", lightCandidates()},
                         {"LIGHT_VISIBILITY", lightVisibility_.has_value()},
                         {"WALKS", features_.denseMedia},
                         {"SPLITS_BOUNDARIES", features_.dielectrics && !settings_.deviations.rouletteWithoutDivision},
                         {"SPLITS_FLIGHTS", splitsFlights_},
                         {"HETEROGENEOUS", features_.heterogeneousMedia},
                         {"VOLUME_EMISSION", features_.volumeEmission},
                         {"GLOSSY", features_.conductors || features_.roughDielectrics || scene_->hasCoats()},
                         {"ROUGH_DIELECTRICS", features_.roughDielectrics},
                         {"BACKGROUND", features_.background},
                         {"MIS", asked && (features_.emission || features_.environmentPicture) &&
                                     settings_.transport != Transport::oneBounceUnoccluded},
                         {"SCATTERED_LIGHT", features_.emission || features_.environment || features_.volumeEmission},
                         {"DISTANCE_WITHOUT_PDF", settings_.deviations.distanceWithoutPdf},
                         {"BOOSTED_INTERACTION", settings_.deviations.boostedInteraction},
                         {"ROULETTE_WITHOUT_DIVISION", settings_.deviations.rouletteWithoutDivision},
                         {"STRAIGHT_SHADOW_RAYS", settings_.deviations.straightShadowRays},
                         {"ROULETTE_AT_SURFACES", settings_.deviations.rouletteAtSurfaces},
                         {"UNATTENUATED_SHADOW_RAYS", settings_.deviations.unattenuatedShadowRays},
                         {"UNSCALED_REFRACTION", settings_.deviations.unscaledRefraction},
                         {"LINEAR_SEEDS", settings_.deviations.linearSeeds},
                         {"FIXED_EPSILON", settings_.deviations.fixedEpsilon},
                         {"PIXEL_FILTER", filterFlag(settings_.filter)},
                         {"UNOCCLUDED", settings_.transport == Transport::oneBounceUnoccluded},
                         {"FRESNEL_AMPLITUDES", settings_.deviations.fresnelAmplitudes},
                         {"FRESNEL_SCHLICK", settings_.deviations.schlick}});
  return all;
}

int PathTracer::filterFlag(PixelFilter filter) {
  return filter == PixelFilter::centre ? 0 : filter == PixelFilter::box ? 1 : 2;
}

std::size_t PathTracer::stateWords() const {
  const std::size_t manifold = casters_.empty() ? 0 : kManifoldWords;
  if (scene_->rays().sharedStack() == 0) return kPathWords + manifold;
  return (hasInteriors() ? kSpilledInteriorWords : kSpilledWords) + manifold;
}

gl::ShaderFlags PathTracer::kernelFlags() const {
  gl::ShaderFlags all = flags();
  all.insert(all.end(), {{"SHARED_STACK", scene_->rays().sharedStack()},
                         {"STATE_WORDS", static_cast<int>(stateWords())},
                         {"SHARES_PIXELS", sharesPixels()},
                         {"INSPECTED", settings_.inspectedPixel.has_value()},
                         {"HALVES", settings_.halves},
                         {"SHADOW_AT_ONCE", scene_->rays().sharedStack() == 0 && !hasInteriors()}});
  return all;
}

// Flights split in all media that scatter, but where paths walk: there what scatters takes a hundred times as long.
void PathTracer::markSplitMedia(const Scene& scene, PackedMedia& packed) {
  const PathDeviations& deviations = settings_.deviations;
  if (features_.volumeEmission || deviations.rouletteWithoutDivision || deviations.distanceWithoutPdf ||
      deviations.boostedInteraction)
    return;
  for (std::size_t m = 0; m < packed.media.size(); ++m) {
    const bool isWalked = std::any_of(boundaries_.interiors.begin(), boundaries_.interiors.end(), [&](const auto& i) {
      return i.medium == static_cast<int>(m) && i.clearance >= 0;
    });
    if (isWalked || scene.media[m].scattering == glm::vec3(0.0f)) continue;
    packed.media[m].splits = 1;
    splitsFlights_ = true;
  }
}

void PathTracer::addClearances(const Scene& scene) {
  std::vector<Corners> triangles(scene.triangleCount());
  std::vector<int> ranks(triangles.size(), -1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      triangles[t][k] = glm::dvec3(scene.vertices[scene.indices[3 * t + k]].position) - scene_->origin();
  for (const Mesh& mesh : scene.meshes)
    std::fill_n(ranks.begin() + mesh.firstIndex / 3, mesh.indexCount / 3,
                boundaries_.rankOfMaterial[static_cast<std::size_t>(mesh.material)]);
  std::vector<Clearance> clearances;
  const std::vector<Bounds> bounds = boundsOfRanks(boundaries_);
  for (std::size_t rank = 0; rank < boundaries_.interiors.size(); ++rank) {
    shared::InteriorRecord& interior = boundaries_.interiors[rank];
    const double extent = glm::length(bounds[rank].extent());
    if (interior.medium < 0 || !(extent > 0.0)) continue;
    const Medium& medium = scene.media[static_cast<std::size_t>(interior.medium)];
    if (!isDense(medium, extent)) continue;
    std::vector<bool> isBoundary(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) isBoundary[t] = ranks[t] == static_cast<int>(rank);
    const glm::dvec3 extinction = glm::dvec3(medium.scattering) + glm::dvec3(medium.absorption);
    const ClearanceGrid grid =
        clearanceGrid(triangles, isBoundary, bounds[rank].min - scene_->origin(), bounds[rank].max - scene_->origin(),
                      kClearanceCells, 1.0 / std::max({extinction.x, extinction.y, extinction.z}));
    interior.clearance = static_cast<int>(clearances.size());
    interior.cell = static_cast<float>(grid.cell);
    interior.min = glm::vec3(grid.min);
    interior.size = glm::ivec4(grid.size, 0);
    clearances.insert(clearances.end(), grid.clearances.begin(), grid.clearances.end());
  }
  features_.denseMedia = !clearances.empty();
  if (features_.denseMedia)
    clearances_ = gl::BufferTexture("path clearances", gl::Format::rgba32ui, clearances.size() * sizeof(Clearance),
                                    clearances.data());
}

void PathTracer::setCamera(const Camera& camera) {
  setView(constants_, camera, scene_->origin(), settings_.size);
  if (hasInteriors()) {
    const Surroundings surroundings = surroundingsOf(boundaries_, camera.position);
    // Reported when paths start there: another camera may be set first.
    cameraWarning_ =
        surroundings.openness > 0.01
            ? fmt::format("camera {}: lies on a closed boundary, or inside one that is open by {:.3g} of a sphere",
                          camera.name, surroundings.openness)
            : std::string();
    cameraInside_ = surroundings.inside;
    cameraIor_ = iorInside(boundaries_, cameraInside_);
  }
  leakedPaths_ = wrongCrossings_ = iterationsTaken_ = collisions_ = 0.0;
  const std::array<const gl::Texture*, 3> film{&filmMean_, &filmM2_, &filmRest_};
  gl::clearToZero(film, clearTexture_);
  constants_.picture.w = 0;
  done_ = passTarget_ = 0;
  tile_ = 0;
  tileBegun_ = false;
}

void PathTracer::setFirstSample(std::uint32_t first) {
  CHECK(done_ == 0 && tile_ == 0 && !tileBegun_, "{} samples are there", done_);
  constants_.picture.w = static_cast<int>(first);
}

void PathTracer::setSeed(std::uint32_t seed) {
  CHECK(done_ == 0 && tile_ == 0 && !tileBegun_, "{} samples are there", done_);
  constants_.seed = seed;
}

std::uint64_t PathTracer::identity() const {
  shared::PathConstants constants = constants_;
  constants.tile = glm::ivec4(0);
  constants.sampleTarget = constants.iterations = 0;
  constants.picture.z = constants.picture.w = 0;  // parts of the samples belong to the same picture
  Hash hash = sceneHash_;
  hash.bytes(&constants, sizeof constants);
  for (const auto& [name, value] : flags()) {
    hash.bytes(name.data(), name.size());
    hash.bytes(&value, sizeof value);
  }
  if (settings_.halves) hash.add(std::uint64_t{2});
  return hash.value();
}

std::vector<std::uint8_t> PathTracer::checkpoint() const {
  Film film;
  film.identity = identity();
  film.size = filmSize();
  film.halves = settings_.halves;
  film.first = static_cast<std::uint32_t>(constants_.picture.w);
  const std::array<const gl::Texture*, 3> films{&filmMean_, &filmM2_, &filmRest_};
  const std::array<std::vector<glm::uvec4>*, 3> planes{&film.mean, &film.m2, &film.rest};
  for (std::size_t f = 0; f < films.size(); ++f) {
    std::vector<glm::uvec4>& words = *planes[f];
    words = films[f]->readWords();
    if (!tileBegun_) continue;
    const auto [corner, size] = tile();
    const std::vector<glm::uvec4> before = kept_[f].readWords();
    for (int y = 0; y < size.y; ++y)
      std::copy_n(before.begin() + static_cast<std::ptrdiff_t>(y) * kept_[f].size().x, size.x,
                  words.begin() + static_cast<std::ptrdiff_t>(corner.y + y) * filmSize().x + corner.x);
  }
  return bytesOf(film);
}

void PathTracer::resume(const std::vector<std::uint8_t>& bytes, const std::string& name) {
  const Film film = filmOf(bytes, name);
  if (film.halves != settings_.halves)
    throwBadInput("{}: a checkpoint of a picture {} --denoise; this one is {} it", name,
                  film.halves ? "with" : "without", settings_.halves ? "with" : "without");
  if (film.size != filmSize())
    throwBadInput("{}: a checkpoint of {} x {} pixels; this picture has {} x {}", name, film.size.x,
                  film.size.y / (film.halves ? 2 : 1), settings_.size.x, settings_.size.y);
  if (film.identity != identity()) throwBadInput("{}: a checkpoint of another scene, view or setting", name);
  filmMean_.upload(gl::Texels::rgbaWord, film.mean.data());
  filmM2_.upload(gl::Texels::rgbaWord, film.m2.data());
  filmRest_.upload(gl::Texels::rgbaWord, film.rest.data());
  constants_.picture.w = static_cast<int>(film.first);
  if (settings_.halves) {
    std::array<std::uint32_t, 2> least{kUnlimited, kUnlimited};
    const std::size_t half = film.mean.size() / 2;
    for (std::size_t i = 0; i < film.mean.size(); ++i) least[i / half] = std::min(least[i / half], film.mean[i].w);
    // The first half has the same number or one more; where it was stopped in between, it has more.
    done_ = least[0] > least[1] ? 2 * least[1] + 1 : 2 * least[0];
  } else {
    done_ = kUnlimited;
    for (const glm::uvec4& word : film.mean) done_ = std::min(done_, word.w);
  }
  passTarget_ = done_;
  tile_ = 0;
  tileBegun_ = false;
}

PathTracer::Tile PathTracer::tile() const {
  if (settings_.inspectedPixel) return {*settings_.inspectedPixel, glm::ivec2(1)};
  const int columns = (settings_.size.x + tileSide_ - 1) / tileSide_, half = tile_ / tilesOfPicture(),
            within = tile_ % tilesOfPicture();
  const glm::ivec2 corner = tileSide_ * glm::ivec2(within % columns, within / columns);
  return {corner + glm::ivec2(0, half * settings_.size.y), glm::min(glm::ivec2(tileSide_), settings_.size - corner)};
}

int PathTracer::tilesOfPicture() const {
  const glm::ivec2 tiles = (settings_.size + tileSide_ - 1) / tileSide_;
  return settings_.inspectedPixel ? 1 : tiles.x * tiles.y;
}

int PathTracer::tileCount() const { return tilesOfPicture() * (settings_.halves ? 2 : 1); }

// The first half has one more of an odd number.
std::uint32_t PathTracer::samplesOfTile(std::uint32_t samples) const {
  if (!settings_.halves) return samples;
  return tile_ < tilesOfPicture() ? samples / 2 + samples % 2 : samples / 2;
}

// The layout is that of shared/path_tracer.h.
void PathTracer::readInspected() {
  const std::vector<glm::uvec4> words = state_.read<glm::uvec4>();
  const std::size_t base =
      kStateHeaderBytes / kVec4Bytes + stateWords() * static_cast<std::size_t>(constants_.picture.z);
  const std::size_t told = words[base].x, kept = std::min(told, kInspectedRecords);
  if (kept < told) logWarning("{} of {} lights of the inspected pixel did not fit", told - kept, told);
  const auto place = [&](std::size_t i) {
    return glm::dvec3(std::bit_cast<float>(words[i].x), std::bit_cast<float>(words[i].y),
                      std::bit_cast<float>(words[i].z));
  };
  for (std::size_t r = 0; r < kept; ++r) {
    const std::size_t at = base + kInspectedHead + r * PATH_INSPECTED_RECORD, end = at + 2 + PATH_INSPECTED_PLACES;
    const glm::uvec4 about = words[at + 1];
    InspectedLight light{glm::vec3(place(at)), words[at].w,      about.x, about.y, about.z, {},
                         place(end),           words[end].w != 0};
    for (std::size_t i = 0; i < about.w; ++i) light.places.push_back(place(at + 2 + i) + scene_->origin());
    if (!light.infinite) light.end += scene_->origin();
    inspected_.push_back(std::move(light));
  }
}

void PathTracer::dropUnfinishedPass() {
  if (!tileBegun_) return;
  const auto [corner, size] = tile();
  gl::copyTexels(kept_[0], {0, 0}, filmMean_, corner, size);
  gl::copyTexels(kept_[1], {0, 0}, filmM2_, corner, size);
  gl::copyTexels(kept_[2], {0, 0}, filmRest_, corner, size);
  tileBegun_ = false;
}

bool PathTracer::sharesPixels() const {
  return !settings_.inspectedPixel && (scene_->rays().sharedStack() == 0 || walks() || !casters_.empty());
}

std::size_t PathTracer::queueLength() const {
  return sharesPixels() ? std::bit_ceil(static_cast<std::size_t>(constants_.picture.z)) : 0;
}

bool PathTracer::submit(std::uint32_t samples, Passes passes) {
  if (done_ >= samples) return false;
  if (!cameraWarning_.empty()) logWarning("{}", std::exchange(cameraWarning_, {}));
  if (passTarget_ == done_ || passTarget_ > samples) {
    // At the end of a pass, lanes wait for the last path of a tile. With passes that double the samples they wait
    // rarely, and pictures still come early.
    const std::uint32_t most = settings_.inspectedPixel ? kInspectedSamples : features_.media ? 1024 : 64;
    passTarget_ = done_ + std::min(samples - done_, passes == Passes::whole ? most : std::clamp(done_, 1u, most));
    if (!tileBegun_) tile_ = 0;
  }
  const auto [corner, size] = tile();
  const double lanes = static_cast<double>(size.x) * size.y;
  const bool begins = !tileBegun_;
  if (begins) {
    state_.clear();
    finished_ = 0;
    turn_ = 0;
    if (sharesPixels()) {
      // All pixels wait, by number. Those of its groups that lie beyond the tile's edge do not: a lane must find one in
      // every submission, as each may have time for one only.
      std::vector<glm::uvec4> queue;
      for (std::uint32_t number = 0; number < static_cast<std::uint32_t>(groupsOf(size) * kGroupPixels); ++number)
        if (isWithin(number, size)) queue.emplace_back(number, 0, 0, 0);
      StateHeader header;
      header.tails[0] = static_cast<std::uint32_t>(queue.size());
      state_.upload(0, sizeof header, &header);
      state_.upload(kStateHeaderBytes + static_cast<std::size_t>(constants_.picture.z) * stateWords() * kVec4Bytes,
                    queue.size() * kVec4Bytes, queue.data());
    }
    iterations_.restart();
    iterations_.setIterationsOfUnit(lanes);
    gl::copyTexels(filmMean_, corner, kept_[0], {0, 0}, size);
    gl::copyTexels(filmM2_, corner, kept_[1], {0, 0}, size);
    gl::copyTexels(filmRest_, corner, kept_[2], {0, 0}, size);
  }
  const StateHeader zeros{};
  state_.upload(0, offsetof(StateHeader, heads), &zeros);

  const auto start = Clock::now();
  dispatch(corner, size, samplesOfTile(passTarget_));
  const auto header = counters_.readFirst<StateHeader>(state_);
  gl::throwIfReset();
  gl::throwIfError("path tracing");
  finished_ += header.finished;
  const auto unfinished = static_cast<std::uint32_t>(lanes) - finished_;
  CHECK(unfinished == 0 || header.allIterations > 0, "path tracing has lost {} pixels: a loop was left early",
        unfinished);
  leakedPaths_ += header.leakedPaths;
  wrongCrossings_ += header.wrongCrossings;
  iterationsTaken_ += header.allIterations;
  collisions_ += header.collisions;
  const auto taken = static_cast<std::uint64_t>(lanes) * header.longest;
  largest_ = std::max(largest_, taken);
  if (begins) largestBegun_ = std::max(largestBegun_, taken);
  const double seconds = secondsSince(start);
  iterations_.setIterationsOfUnit(std::max(unfinished, 1u));  // the others are finished
  iterations_.took(iterations_.units(), seconds);
  tileBegun_ = unfinished > 0;
  if (!tileBegun_ && settings_.inspectedPixel) readInspected();
  if (!tileBegun_ && ++tile_ == tileCount()) {
    done_ = passTarget_;
    tile_ = 0;
  }
  return done_ < samples;
}

// Only lamps that no ray finds are sought. Published forms have no such search.
bool PathTracer::seeksByManifolds() const {
  return features_.anyLight() && settings_.nextEvent && !settings_.diffuseOnly &&
         settings_.deviations == PathDeviations{} && settings_.transport != Transport::oneBounceUnoccluded;
}

// Not where media and manifolds draw single lights, the sun among them. Published forms take one light as it is drawn.
bool PathTracer::asksSunApart() const {
  const bool drawsSingle = hasInteriors() || (seeksByManifolds() && (features_.mirrors || features_.conductors));
  return !drawsSingle && settings_.deviations == PathDeviations{};
}

// Published forms take one light as it is drawn, and a single one without a size gives no choice.
int PathTracer::lightCandidates() const {
  constexpr int kCandidates = 2;
  const bool hasChoice = scene_->lightCount() > 1 || features_.emission || features_.environmentPicture;
  return scene_->hasLights() && hasChoice && settings_.deviations == PathDeviations{} ? kCandidates : 1;
}

bool PathTracer::knowsVisibility() const {
  const int kinds = (features_.directionalLight ? 1 : 0) + (features_.environmentPicture ? 1 : 0) +
                    (features_.emission || features_.spotLights || features_.pointLights ? 1 : 0);
  return lightCandidates() > 1 && kinds > 1 && !hasInteriors() && settings_.transport != Transport::oneBounceUnoccluded;
}

void PathTracer::bind(const gl::Program& program) {
  program.use();
  scene_->bind();
  if (lightVisibility_) lightVisibility_->bind(program);
  constantsBuffer_.bindUniform(kConstantsBinding);
  state_.bindStorage(kStateBinding);
  if (hasInteriors()) {
    interiors_.bindStorage(kInteriorsBinding);
    program.set("outerMedium", outerMedium_);
    program.set("dielectricRanks", boundaries_.dielectricRanks);
    program.set("cameraInside", cameraInside_);
    program.set("cameraIor", cameraIor_);
  }
  if (features_.denseMedia) clearances_.bind(kClearancesUnit);
  if (sharesPixels()) {
    program.set("turn", turn_);
    program.set("queueMask", static_cast<unsigned>(queueLength() - 1));
  }
  if (features_.media) media_.bindStorage(kMediaBinding);
  if (features_.heterogeneousMedia) {
    grids_.bindStorage(kGridsBinding);
    densities_.bindStorage(kDensitiesBinding);
  }
}

void PathTracer::dispatch(glm::ivec2 corner, glm::ivec2 size, std::uint32_t target) {
  constants_.tile = glm::ivec4(corner, size);
  constants_.sampleTarget = target;
  const std::uint32_t iterations = iterations_.units(),
                      rounds = walks() ? (iterations + kRoundIterations - 1) / kRoundIterations : 1;
  constants_.iterations = walks() ? std::min(iterations, kRoundIterations) : iterations;
  constantsBuffer_.upload(0, sizeof constants_, &constants_);
  const int unfinished = size.x * size.y - static_cast<int>(finished_),
            groups = sharesPixels() ? (unfinished + kGroupPixels - 1) / kGroupPixels : groupsOf(size);
  for (std::uint32_t round = 0; round < rounds; ++round, turn_ = 1 - turn_) {
    tracePaths(groups);
    if (walks()) walkPaths(groups);
    if (!casters_.empty()) seekWays(groups);
  }
}

void PathTracer::tracePaths(int groups) {
  const gl::ComputePass pass("path tracing", gl::Barrier::storage | gl::Barrier::image | gl::Barrier::textureFetch,
                             gl::Barrier::image);
  bind(*program_);
  filmMean_.bindImage(0, gl::Access::readWrite);
  filmM2_.bindImage(1, gl::Access::readWrite);
  filmRest_.bindImage(2, gl::Access::readWrite);
  pass.dispatch(glm::ivec3(kGroupSide * groups, kGroupSide, 1), glm::ivec3(kGroupSide, kGroupSide, 1));
}

void PathTracer::walkPaths(int groups) {
  const gl::ComputePass pass("walks in media", gl::Barrier::storage);
  bind(*walkProgram_);
  filmMean_.bindImage(0, gl::Access::read);
  pass.dispatch(glm::ivec3(kGroupSide * groups, kGroupSide, 1), glm::ivec3(kGroupSide, kGroupSide, 1));
}

// Light that paths have asked for, through refracting boundaries.
void PathTracer::seekWays(int groups) {
  const gl::ComputePass pass("specular manifolds", gl::Barrier::storage);
  bind(*manifoldProgram_);
  manifoldProgram_->set("casterCount", static_cast<int>(casters_.size()));
  for (std::size_t i = 0; i < casters_.size(); ++i) {
    manifoldProgram_->set(fmt::format("casters[{}]", i), casters_[i]);
    manifoldProgram_->set(fmt::format("casterParts[{}]", i), casterParts_[i]);
  }
  casterTriangles_.bind(kCastersUnit);
  filmMean_.bindImage(0, gl::Access::read);
  pass.dispatch(glm::ivec3(kGroupSide * groups, kGroupSide, 1), glm::ivec3(kGroupSide, kGroupSide, 1));
}

std::vector<PathTracer::Pixel> PathTracer::readFilm() const {
  const std::vector<glm::uvec4> mean = filmMean_.readWords(), m2 = filmM2_.readWords();
  const auto floats = [](const glm::uvec4& w) {
    return glm::vec3(std::bit_cast<float>(w.x), std::bit_cast<float>(w.y), std::bit_cast<float>(w.z));
  };
  const auto pixelAt = [&](std::size_t i) { return Pixel{floats(mean[i]), floats(m2[i]), mean[i].w}; };
  std::vector<Pixel> pixels(static_cast<std::size_t>(settings_.size.x) * static_cast<std::size_t>(settings_.size.y));
  double found = 0.0, ofIndependent = 0.0;  // squared errors, summed over pixels and channels
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = pixelAt(i);
    if (!settings_.halves) continue;
    // Both halves as one [ChanGolubLeVeque1983, pairwise update].
    const Pixel a = pixels[i], b = pixelAt(i + pixels.size());
    const double n = a.samples, m = b.samples;
    if (b.samples == 0) continue;
    const glm::dvec3 difference = glm::dvec3(b.mean) - glm::dvec3(a.mean);
    found += glm::dot(difference, difference) * (n * m / ((n + m) * (n + m)));
    pixels[i] = {glm::vec3(glm::dvec3(a.mean) + difference * (m / (n + m))),
                 glm::vec3(glm::dvec3(a.m2) + glm::dvec3(b.m2) + difference * difference * (n * m / (n + m))),
                 a.samples + b.samples};
    ofIndependent += glm::dot(glm::dvec3(pixels[i].m2), glm::dvec3(1.0)) / ((n + m) * (n + m - 1.0));
  }
  // Samples of a half are spread more evenly than independent ones; by how much, the halves' difference says, if there
  // are pixels enough to know it within a tenth.
  constexpr std::size_t kEnough = 256;
  if (pixels.size() >= kEnough && found > 0.0 && ofIndependent > 0.0)
    for (Pixel& pixel : pixels) pixel.m2 *= static_cast<float>(found / ofIndependent);
  return pixels;
}

namespace {
template <class Pixels, class Value>
Image toImage(const Pixels& pixels, glm::ivec2 size, Value value) {
  Image image(size.x, size.y);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x)
      image.at(x, size.y - 1 - y) =
          value(pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x)]);
  return image;
}

}  // namespace

Image PathTracer::mean() const {
  return toImage(readFilm(), settings_.size, [](const Pixel& p) { return p.mean; });
}

Image PathTracer::standardError() const {
  return toImage(readFilm(), settings_.size, [](const Pixel& p) { return standardErrorOf({p.mean, p.m2, p.samples}); });
}

PathTracer::Statistics PathTracer::statistics() const {
  std::vector<FilmPixel> pixels;
  for (const Pixel& p : readFilm()) pixels.push_back({p.mean, p.m2, p.samples});
  const FilmStatistics film = statisticsOf(pixels);
  Statistics result;
  result.fewestSamples = film.fewestSamples;
  result.mostSamples = film.mostSamples;
  result.samples = film.samples;
  result.mean = film.mean;
  result.meanError = film.meanError;
  result.standardError = film.standardError;
  result.relativeError = film.relativeError;
  result.leakedPaths = leakedPaths_;
  result.wrongCrossings = wrongCrossings_;
  result.iterations = iterationsTaken_;
  result.collisions = collisions_;
  return result;
}

std::size_t PathTracer::gpuBytes() const {
  std::size_t bytes = scene_->gpuBytes() + state_.bytes() + counters_.bytes() + constantsBuffer_.bytes() +
                      media_.bytes() + interiors_.bytes() + grids_.bytes() + densities_.bytes() + clearances_.bytes() +
                      casterTriangles_.bytes() + (lightVisibility_ ? lightVisibility_->gpuBytes() : 0) +
                      filmMean_.bytes() + filmM2_.bytes() + filmRest_.bytes();
  for (const gl::Texture& texture : kept_) bytes += texture.bytes();
  return bytes;
}

}  // namespace lucerna
