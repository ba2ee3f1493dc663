#include "radiosity/hemicubes.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"
#include "rays/ray_scene.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <future>
#include <map>
#include <numbers>
#include <numeric>

namespace lucerna {

namespace {

constexpr GLuint kItemsUnit = 56, kKeysUnit = 57, kDeltasUnit = 58, kCornersUnit = 59, kFrames = 9, kKeys = 2,
                 kFactors = 4, kSources = 5, kExactList = 6, kKeptList = 7, kLargeList = 3;
constexpr int kGroup = 64;
constexpr int kHemicubesEach = 8;
constexpr std::size_t kMostKept =
    std::size_t{65535} * kGroup;  // maximum reach of an indirect dispatch with one lane per entry
constexpr std::size_t kMostHemicubes = 256;  // limit in hemicube.glsl: their frames take 16 KiB, which every driver has
constexpr double kSmallSources = 0.1;  // of the area: larger sources need no special care
constexpr int kExactGroups = 256;
constexpr double kSecondsOfPiece = 0.25, kTurnsOfPatch = 8.0,
                 kTurnsOfPixel = 32.0;  // by raster: a patch's setup; a pixel's layers
constexpr int kMeasured = 32;  // hemicubes in a batch for measuring the cost
constexpr int kCompared = 8;  // hemicubes whose sights are compared

/// The same value for a seed and patch in every run and batch; 0..1. [Steele2014], its finaliser.
double hashed(std::uint32_t seed, std::uint32_t patch) {
  std::uint64_t z = (static_cast<std::uint64_t>(seed) << 32 | patch) + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

gl::Buffer storage(const char* name, std::size_t bytes) {
  return gl::Buffer(name, std::max<std::size_t>(bytes, 16), nullptr, gl::Usage::dynamicCopy);
}

}  // namespace

namespace {
/// Approximate work of a hemicube: gl/pieces.hpp.
struct Turns {
  double rays, raster;
};
Turns turnsOfHemicube(const RadiosityMesh& mesh, int resolution) {
  const double pixels = 3.0 * resolution * resolution, patches = static_cast<double>(mesh.patches.size());
  return {gl::kTurnsOfRay * pixels, kTurnsOfPatch * patches + kTurnsOfPixel * pixels};
}

double mostTurnsOfHemicube(const RadiosityMesh& mesh, int resolution) {
  const Turns turns = turnsOfHemicube(mesh, resolution);
  return std::max(turns.rays, turns.raster);
}
}  // namespace

HemicubeVisibility visibilityByCount(const RadiosityMesh& mesh, int resolution) {
  const Turns turns = turnsOfHemicube(mesh, resolution);
  return turns.raster <= turns.rays ? HemicubeVisibility::raster : HemicubeVisibility::rays;
}

Hemicubes::~Hemicubes() = default;

Hemicubes::Hemicubes(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const RadiosityMesh& mesh,
                     const HemicubeSettings& settings, const RayScene* rays)
    : mesh_(&mesh),
      settings_(settings),
      patchCount_(static_cast<int>(mesh.patches.size())),
      rays_(rays),
      pieces_(kSecondsOfPiece, mostTurnsOfHemicube(mesh, settings.resolution), kMostHemicubes,
              settings.unmeasuredIterations) {
  CHECK(settings.resolution >= 2 && settings.resolution % 2 == 0, "hemicubes of {} pixels", settings.resolution);
  if (settings_.visibility == HemicubeVisibility::automatic) choose(programs, capabilities);
  const auto patches = static_cast<std::size_t>(patchCount_);
  const auto limit = static_cast<std::size_t>(std::max(capabilities.maxShaderStorageBlockSize, 1 << 24));
  const std::size_t keyBytes = 3 * static_cast<std::size_t>(settings.resolution * settings.resolution) * sizeof(GLuint),
                    factorBytes = patches * sizeof(float);
  const bool items = listsKept();
  double emitting = 0.0;
  for (const Patch& patch : mesh.patches) emitting += patch.emission != glm::dvec3(0.0) ? patch.area : 0.0;
  const bool smallSources = emitting < kSmallSources * mesh.area();
  for (const Patch& patch : mesh.patches) smallSources_.push_back(smallSources && patch.emission != glm::dvec3(0.0));
  std::vector<std::uint32_t> sources = smallSources_;
  for (std::uint32_t i = 0; i < patches; ++i)
    if (smallSources_[i]) sources.push_back(i);
  sourceCount_ = static_cast<int>(sources.size() - patches);
  // Pixels that name their patches name at most one each, in addition to the small sources.
  const std::size_t listed = items ? std::min(patches, keyBytes / sizeof(GLuint)) + sources.size() - patches : patches;
  const std::size_t each = std::max({keyBytes, factorBytes, listed * sizeof(glm::uvec2) + 16});
  if (each > limit)
    throwMissingCapability(
        "radiosity: {} patches and hemicubes of {} pixels need storage blocks of {} bytes, this driver's limit is {} "
        "(GL_MAX_SHADER_STORAGE_BLOCK_SIZE): use longer edges or smaller hemicubes",
        patches, settings.resolution, each, limit);
  const auto texels = static_cast<std::size_t>(std::max(capabilities.maxTextureBufferSize, 1 << 16));
  if (3 * patches > texels || keyBytes / sizeof(GLuint) > texels)
    throwMissingCapability(
        "radiosity: {} patches and hemicubes of {} pixels need buffer textures of {} texels, this driver's limit is {} "
        "(GL_MAX_TEXTURE_BUFFER_SIZE)",
        patches, settings.resolution, std::max(3 * patches, keyBytes / sizeof(GLuint)), texels);
  // A software renderer is fastest inside the processor's cache, a GPU with work for all of its cores. Rays touch
  // little memory, so batch at least 16 hemicubes.
  const std::size_t some = settings_.visibility == HemicubeVisibility::rays ? 16 * each : 0;
  const std::size_t wanted = settings.batchBytes
                                 ? settings.batchBytes
                                 : std::max(some, std::size_t{capabilities.softwareRenderer ? 4u : 64u} << 20);
  batch_ =
      static_cast<int>(std::clamp<std::size_t>(std::min(wanted, limit) / each, 1,
                                               std::min({patches, kMostHemicubes, texels * sizeof(GLuint) / keyBytes,
                                                         std::max<std::size_t>(kMostKept / listed, 1)})));
  if (settings_.visibility == HemicubeVisibility::itemBuffer)
    batch_ = std::clamp(std::min(batch_, capabilities.maxArrayTextureLayers / 5), 1, batch_);

  std::vector<glm::vec4> corners;
  corners.reserve(3 * patches);
  for (const Patch& patch : mesh.patches)
    for (const glm::dvec3& corner : mesh.corners(patch)) corners.emplace_back(glm::vec3(corner), 0.0f);
  std::vector<float> deltas;
  for (const double d : deltaFormFactors(settings.resolution, settings.map)) deltas.push_back(static_cast<float>(d));
  corners_ =
      gl::BufferTexture("radiosity corners", gl::Format::rgba32f, corners.size() * sizeof(glm::vec4), corners.data());
  sources_ = gl::Buffer("radiosity sources", sources.size() * sizeof(GLuint), sources.data(), gl::Usage::staticDraw);
  deltaFactors_ =
      gl::BufferTexture("delta form factors", gl::Format::r32f, deltas.size() * sizeof(float), deltas.data());
  const auto batch = static_cast<std::size_t>(batch_);
  frames_ = gl::Buffer("hemicube frames", kMostHemicubes * sizeof(Frame), nullptr, gl::Usage::dynamicDraw);
  keys_ = gl::BufferTexture("hemicube pixels", gl::Format::r32ui, batch * keyBytes, nullptr);
  factors_ = storage("form factors", batch * factorBytes);
  factors_.clear();
  if (items) keptList_ = storage("kept patches", 16 + batch * listed * sizeof(glm::uvec2));
  exactList_ = storage("exact form factors", 8 + batch * listed * sizeof(glm::uvec2));
  largeList_ = storage("large patches", 16 + batch * listed * sizeof(GLuint));
  // A ray looks for the small sources that no pixel hit.
  const bool asksForSources = sourceCount_ > 0 && settings_.exactPixels > 0;
  if (!rays_ && (asksForSources || settings_.visibility == HemicubeVisibility::rays)) {
    ownRays_ = std::make_unique<RayScene>(sceneOf(mesh), capabilities);
    rays_ = ownRays_.get();
  }
  if (settings_.visibility == HemicubeVisibility::raster) {
    depth_ = &programs.loadCompute("hemicube depth", "radiosity/hemicube_depth.comp", {{"LARGE", 0}});
    depthLarge_ = &programs.loadCompute("hemicube depth large", "radiosity/hemicube_depth.comp", {{"LARGE", 1}});
  } else if (settings_.visibility == HemicubeVisibility::rays) {
    traceRays_ = &programs.loadCompute("hemicube rays", "radiosity/hemicube_rays.comp",
                                       {{"ALPHA_MASKS", 0}, {"SHARED_STACK", rays_->sharedStack()}});
  } else {
    const glm::ivec3 layers(settings.resolution, settings.resolution, 5 * batch_);
    ItemBuffer& buffer = itemBuffer_.emplace();
    buffer.items = gl::Texture("hemicube items", gl::Format::r32ui, layers, {}, 1, gl::TextureKind::array);
    buffer.depth = gl::Texture("hemicube depth", gl::Format::depth32f, layers, {}, 1, gl::TextureKind::array);
    const std::array<const gl::Texture*, 1> colors{&buffer.items};
    buffer.target = gl::Framebuffer("hemicube items", colors, &buffer.depth);
    buffer.noAttributes = gl::VertexArray("hemicube items");
    buffer.draw = &programs.loadRaster("hemicube items", "radiosity/hemicube_item.vert", "radiosity/hemicube_item.frag",
                                       {}, "radiosity/hemicube_item.geom");
    buffer.sum = &programs.loadCompute("hemicube items sum", "radiosity/hemicube_items.comp");
  }
  const bool drawn = settings_.visibility == HemicubeVisibility::itemBuffer;
  sum_ = &programs.loadCompute("hemicube sum", "radiosity/hemicube_sum.comp",
                               {{"LARGE", 0}, {"ITEMS", items}, {"DRAWN", drawn}});
  sumLarge_ = &programs.loadCompute("hemicube sum large", "radiosity/hemicube_sum.comp",
                                    {{"LARGE", 1}, {"ITEMS", items}, {"DRAWN", drawn}});
  exact_ = &programs.loadCompute("hemicube exact", "radiosity/hemicube_exact.comp",
                                 {{"ITEMS", items},
                                  {"SOURCES", asksForSources},
                                  {"ALPHA_MASKS", 0},
                                  {"SHARED_STACK", asksForSources ? rays_->sharedStack() : 0}});
}

// A driver's rasteriser may lose triangles, as NVIDIA's did (docs/drivers.md): the item buffer must see what raster
// sees, but for some pixels along silhouettes.
bool Hemicubes::seesAsRaster(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                             Hemicubes& drawn) const {
  HemicubeSettings settings = settings_;
  settings.visibility = HemicubeVisibility::raster;
  Hemicubes raster(programs, capabilities, *mesh_, settings, rays_);
  const double allowed = 0.01 + 4.0 / (3.0 * settings.resolution * settings.resolution);
  for (int k = 0; k < kCompared; ++k) {
    const int patch = static_cast<int>(static_cast<std::int64_t>(patchCount_ - 1) * k / (kCompared - 1));
    const auto seen = [patch](Hemicubes& hemicubes) {
      const FormFactorRows row = rowsOf(hemicubes.draw(patch, 1, 0));
      return static_cast<double>(row.fronts[0]) + static_cast<double>(row.backs[0]);
    };
    if (std::abs(seen(drawn) - seen(raster)) > allowed) return false;
  }
  return true;
}

void Hemicubes::choose(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities) {
  // Raster first: if all the work takes it less time than compiling and measuring the others would, they are skipped.
  for (const HemicubeVisibility one :
       {HemicubeVisibility::raster, HemicubeVisibility::rays, HemicubeVisibility::itemBuffer}) {
    if (!costs_.empty() && costs_[0].milliseconds * patchCount_ < 1000.0 * settings_.worthMeasuring) break;
    HemicubeSettings settings = settings_;
    settings.visibility = one;
    Hemicubes hemicubes(programs, capabilities, *mesh_, settings, rays_);
    const int count = std::min(hemicubes.pieceSize(), kMeasured);
    Cost cost{one, 0.0};
    for (int k = 0; k < 3; ++k) {  // the first run warms up; then the better of two positions
      const int first = static_cast<int>(static_cast<std::int64_t>(patchCount_ - count) * k / 2);
      const auto start = Clock::now();
      hemicubes.draw(first, count, 0);
      const double took = std::chrono::duration<double, std::milli>(Clock::now() - start).count() / count;
      if (k == 1 || (k == 2 && took < cost.milliseconds)) cost.milliseconds = took;
    }
    if (one == HemicubeVisibility::itemBuffer && !seesAsRaster(programs, capabilities, hemicubes)) {
      logWarning("radiosity: on this driver the item buffer loses what rays and raster see, so it is not used");
      continue;
    }
    costs_.push_back(cost);
  }
  const auto best = std::min_element(costs_.begin(), costs_.end(),
                                     [](const Cost& a, const Cost& b) { return a.milliseconds < b.milliseconds; });
  settings_.visibility = best->visibility;
  std::string measured;
  for (const Cost& cost : costs_)
    measured += fmt::format("{}{} {:.3g} ms", measured.empty() ? "" : ", ", nameOf(cost.visibility), cost.milliseconds);
  logInfo("radiosity: hemicubes by {} (a hemicube: {}{})", nameOf(settings_.visibility), measured,
          costs_.size() == 1 ? "; too few to measure the other methods" : "");
}

Hemicubes::Frame Hemicubes::frameOf(int index, int roll) const {
  const Patch& patch = mesh_->patches[static_cast<std::size_t>(index)];
  const auto corners = mesh_->corners(patch);
  // Towards the first corner: never parallel to the normal, whatever the patch.
  const glm::dvec3 u0 = glm::normalize(corners[0] - patch.centroid), v0 = glm::cross(patch.faceNormal, u0);
  // A hemicube is the same after a quarter turn: several are spread evenly over that.
  const double turns = hashed(settings_.seed, static_cast<std::uint32_t>(index)) + 0.25 * roll / rolls();
  const double angle = settings_.randomRoll ? 2.0 * std::numbers::pi * turns : 0.0;
  const glm::dvec3 u = std::cos(angle) * u0 + std::sin(angle) * v0, v = glm::cross(patch.faceNormal, u);
  const double inPlane = std::max(1e-4 * std::sqrt(patch.area), 4e-7 * mesh_->extent);
  return {glm::vec4(glm::vec3(patch.centroid), static_cast<float>(1.0 / inPlane)),
          glm::vec4(glm::vec3(u), patch.hidden), glm::vec4(glm::vec3(v), 0.0f),
          glm::vec4(glm::vec3(patch.faceNormal), 0.0f)};
}

DrawnHemicubes Hemicubes::draw(int first, int count, int roll) {
  // The hemicubes' frames, and the buffers that all programs read and write.
  CHECK(first >= 0 && count > 0 && count <= batch_ && first + count <= patchCount_, "rows {} + {} of {}, at most {}",
        first, count, patchCount_, batch_);
  const auto start = Clock::now();
  std::vector<Frame> frames;
  for (int i = 0; i < count; ++i) frames.push_back(frameOf(first + i, roll));
  frames_.upload(0, frames.size() * sizeof(Frame), frames.data());
  corners_.bind(kCornersUnit);
  frames_.bindUniform(kFrames);
  keys_.buffer().bindStorage(kKeys);
  keys_.bind(kKeysUnit);
  deltaFactors_.bind(kDeltasUnit);
  factors_.bindStorage(kFactors);
  sources_.bindStorage(kSources);
  exactList_.bindStorage(kExactList);
  constexpr GLuint kNone[2] = {0, 0};
  exactList_.upload(0, sizeof kNone, kNone);
  largeList_.bindStorage(kLargeList);
  constexpr GLuint kNoGroups[4] = {0, 1, 1, 0};
  largeList_.upload(0, sizeof kNoGroups, kNoGroups);
  constexpr gl::Barrier kStorage = gl::Barrier::storage, kWithCounts = kStorage | gl::Barrier::command;
  const glm::ivec3 triangles((count + kHemicubesEach - 1) / kHemicubesEach, patchCount_, 1),
      trianglesGroup(1, kGroup, 1);
  // Pixels in rows along z: an axis has 65,535 groups.
  constexpr int kRow = 1024 * kGroup;
  const int all = 3 * settings_.resolution * settings_.resolution;
  const glm::ivec3 pixels(std::min(all, kRow), count, (all + kRow - 1) / kRow), pixelsGroup(kGroup, 1, 1);
  // Visibility of each pixel: all triangles over all pixels, the item buffer, or one ray per pixel.
  if (!listsKept()) {
    keys_.buffer().clear();
    for (const gl::Program* program : {depth_, depthLarge_}) {
      const gl::ComputePass pass(program->name(),
                                 program == depth_ ? kWithCounts : kStorage | gl::Barrier::textureFetch);
      begin(*program, first, count);
      if (program == depth_) pass.dispatch(triangles, trianglesGroup);
      else pass.dispatchIndirect(largeList_);
    }
  } else {
    const auto sources = static_cast<GLuint>(count * sourceCount_);
    const GLuint begun[4] = {(sources + kGroup - 1) / kGroup, 1, 1, sources};
    keptList_.upload(0, sizeof begun, begun);
    keptList_.bindStorage(kKeptList);
    if (itemBuffer_) {
      gl::RasterState state;
      state.depth = gl::Depth::lessWrite;
      const gl::RasterPass pass("hemicube items", itemBuffer_->target, state);
      gl::clearWords(0, glm::uvec4(0u));
      pass.clearDepth();
      begin(*itemBuffer_->draw, first, count);
      itemBuffer_->draw->set("inverseFar", static_cast<float>(0.5 / mesh_->extent));
      itemBuffer_->noAttributes.bind();
      gl::drawTriangles(3 * patchCount_, count);
    }
    const gl::Program& program = itemBuffer_ ? *itemBuffer_->sum : *traceRays_;
    const gl::ComputePass pass(program.name(), kWithCounts);
    begin(program, first, count);
    if (itemBuffer_) {
      itemBuffer_->items.bind(kItemsUnit);
    } else {
      rays_->bind();
      program.set("raysOrigin", glm::vec3(rays_->origin()));
    }
    pass.dispatch(pixels, pixelsGroup);
  }
  // Turn pixels into form factors, then replace near pairs by their closed form.
  for (const gl::Program* program : {sum_, sumLarge_, exact_}) {
    const gl::ComputePass pass(program->name(), program == sum_ ? kWithCounts : kStorage);
    begin(*program, first, count);
    if (program == exact_ && rays_) {
      rays_->bind();
      program->set("raysOrigin", glm::vec3(rays_->origin()));
    }
    if (program == sum_ && listsKept()) pass.dispatchIndirect(keptList_);
    else if (program == sum_) pass.dispatch(triangles, trianglesGroup);
    else if (program == sumLarge_) pass.dispatchIndirect(largeList_);
    else pass.dispatch(glm::ivec3(kExactGroups, 1, 1), glm::ivec3(1));
  }
  // Read back.
  DrawnHemicubes drawn;
  drawn.first = first;
  drawn.count = count;
  drawn.patchCount = patchCount_;
  if (listsKept()) {
    constexpr std::size_t kHead = 2;  // the list begins with a dispatch
    drawn.kept = staging_.read<glm::uvec2>(keptList_, kHead + staging_.readFirst<std::array<GLuint, 4>>(keptList_)[3]);
    drawn.kept.erase(drawn.kept.begin(), drawn.kept.begin() + kHead);
  } else {
    drawn.factors =
        staging_.read<float>(factors_, static_cast<std::size_t>(count) * static_cast<std::size_t>(patchCount_));
  }
  drawn.exact = staging_.read<glm::uvec2>(exactList_, 1 + staging_.readFirst<GLuint>(exactList_));
  drawn.exact.erase(drawn.exact.begin());
  gl::throwIfReset();
  gl::throwIfError("hemicubes");
  pieces_.took(static_cast<std::uint32_t>(count), secondsSince(start));
  return drawn;
}

std::vector<DrawnHemicubes> Hemicubes::drawRolls(int first, int count) {
  std::vector<DrawnHemicubes> drawn;
  for (int roll = 0; roll < rolls(); ++roll) drawn.push_back(draw(first, count, roll));
  return drawn;
}

int Hemicubes::pieceSize() const { return std::min(batch_, static_cast<int>(pieces_.units())); }

FormFactorRows Hemicubes::rows(int first, int count) {
  CHECK(count > 0 && count <= batch_, "{} hemicubes, at most {}", count, batch_);
  FormFactorRows all;
  all.first = first;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (const int end = first + count; first < end;) {
    const FormFactorRows piece = meanRowsOf(drawRolls(first, std::min(end - first, pieceSize())));
    append(all.counts, piece.counts), append(all.fronts, piece.fronts), append(all.backs, piece.backs);
    append(all.patches, piece.patches), append(all.factors, piece.factors);
    first += static_cast<int>(piece.counts.size());
  }
  return all;
}

void Hemicubes::stream(int first, int end, const std::function<void(const FormFactorRows&)>& take,
                       const std::function<bool(int done)>& goOn) {
  std::future<void> taken;
  for (bool stopped = false; first < end && !stopped;) {
    std::vector<DrawnHemicubes> drawn = drawRolls(first, std::min(end - first, pieceSize()));
    first += drawn.front().count;
    if (taken.valid()) taken.get();
    taken = std::async(std::launch::async,
                       [&take, batch = std::move(drawn)]() mutable { take(meanRowsOf(std::move(batch))); });
    stopped = goOn && !goOn(first);
  }
  if (taken.valid()) taken.get();
}

void Hemicubes::begin(const gl::Program& program, int first, int count) const {
  program.use();
  program.set("patchCount", patchCount_);
  program.set("faceSize", settings_.resolution);
  program.set("halfFacePixels", settings_.resolution * settings_.resolution / 2);
  program.set("halfSize", 0.5f * static_cast<float>(settings_.resolution));
  program.set("pixelSize", 2.0f / static_cast<float>(settings_.resolution));
  program.set("firstPatch", first);
  program.set("hemicubes", count);
  program.set("hemicubesEach", kHemicubesEach);
  program.set("sourceCount", sourceCount_);
  program.set("exactPixels", settings_.exactPixels);
  program.set("nearDistance", settings_.nearDistance);
  program.set("mostParts", settings_.mostParts);
}

namespace {

FormFactorRows rowsOfListed(const DrawnHemicubes& drawn) {
  struct Entry {
    std::uint32_t at;
    float byPixels, factor;
  };
  std::vector<Entry> entries;
  entries.reserve(drawn.kept.size());
  for (const glm::uvec2& kept : drawn.kept)
    entries.push_back({kept.x, std::bit_cast<float>(kept.y), std::bit_cast<float>(kept.y)});
  for (const glm::uvec2& exact : drawn.exact) entries[exact.x].factor = std::bit_cast<float>(exact.y);
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.at < b.at; });
  FormFactorRows result;
  result.first = drawn.first;
  auto entry = entries.begin();
  for (int row = 0; row < drawn.count; ++row) {
    const auto begin = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(drawn.patchCount);
    const std::size_t before = result.patches.size();
    double front = 0.0, back = 0.0;
    for (; entry != entries.end() && entry->at - begin < static_cast<std::uint32_t>(drawn.patchCount); ++entry) {
      (entry->byPixels > 0.0f ? front : back) += std::abs(static_cast<double>(entry->byPixels));
      if (!(entry->factor > 0.0f)) continue;
      result.patches.push_back(entry->at - begin);
      result.factors.push_back(entry->factor);
    }
    result.fronts.push_back(static_cast<float>(front));
    result.backs.push_back(static_cast<float>(back));
    result.counts.push_back(static_cast<std::uint32_t>(result.patches.size() - before));
  }
  return result;
}

}  // namespace

FormFactorRows rowsOf(DrawnHemicubes drawn) {
  if (drawn.factors.empty()) return rowsOfListed(drawn);
  const auto patches = static_cast<std::size_t>(drawn.patchCount), rowCount = static_cast<std::size_t>(drawn.count);
  FormFactorRows result;
  result.first = drawn.first;
  std::size_t entries = 0;
  for (std::size_t row = 0; row < rowCount; ++row) {
    // Eight sums side by side, so that the processor adds them at once; always the same eight, for identical bits.
    const float* factors = drawn.factors.data() + row * patches;
    double fronts[8] = {}, backs[8] = {};
    std::size_t seen = 0;
    for (std::size_t i = 0; i < patches; ++i) {
      fronts[i % 8] += static_cast<double>(std::max(factors[i], 0.0f));
      backs[i % 8] += static_cast<double>(std::max(-factors[i], 0.0f));
      seen += factors[i] > 0.0f;
    }
    entries += seen;
    result.fronts.push_back(static_cast<float>(std::accumulate(fronts, fronts + 8, 0.0)));
    result.backs.push_back(static_cast<float>(std::accumulate(backs, backs + 8, 0.0)));
  }
  for (const glm::uvec2& exact : drawn.exact) drawn.factors[exact.x] = std::bit_cast<float>(exact.y);
  result.patches.resize(entries + drawn.exact.size() + 1);
  result.factors.resize(result.patches.size());
  std::size_t at = 0;
  for (std::size_t row = 0; row < rowCount; ++row) {
    const float* factors = drawn.factors.data() + row * patches;
    const std::size_t before = at;
    for (std::size_t i = 0; i < patches; ++i) {  // overwritten by the next entry if empty: avoids a mispredicted branch
      result.patches[at] = static_cast<std::uint32_t>(i);
      result.factors[at] = factors[i];
      at += factors[i] > 0.0f;
    }
    result.counts.push_back(static_cast<std::uint32_t>(at - before));
  }
  result.patches.resize(at);
  result.factors.resize(at);
  return result;
}

std::size_t Hemicubes::gpuBytes() const {
  return corners_.bytes() + sources_.bytes() + deltaFactors_.bytes() + frames_.bytes() + keys_.bytes() +
         factors_.bytes() + keptList_.bytes() + exactList_.bytes() + largeList_.bytes() + staging_.bytes() +
         (ownRays_ ? ownRays_->gpuBytes() : 0) +
         (itemBuffer_ ? itemBuffer_->items.bytes() + itemBuffer_->depth.bytes() : 0);
}

FormFactorRows meanRowsOf(std::vector<DrawnHemicubes> drawn) {
  if (drawn.size() == 1) return rowsOf(std::move(drawn.front()));
  std::vector<FormFactorRows> rolls;
  for (DrawnHemicubes& one : drawn) rolls.push_back(rowsOf(std::move(one)));
  const double share = 1.0 / static_cast<double>(rolls.size());
  std::vector<std::size_t> at(rolls.size(), 0);
  FormFactorRows mean;
  mean.first = rolls.front().first;
  for (std::size_t row = 0; row < rolls.front().counts.size(); ++row) {
    std::map<std::uint32_t, double> factors;  // by patch
    double fronts = 0.0, backs = 0.0;
    for (std::size_t r = 0; r < rolls.size(); ++r) {
      for (const std::size_t end = at[r] + rolls[r].counts[row]; at[r] < end; ++at[r])
        factors[rolls[r].patches[at[r]]] += share * static_cast<double>(rolls[r].factors[at[r]]);
      fronts += share * static_cast<double>(rolls[r].fronts[row]);
      backs += share * static_cast<double>(rolls[r].backs[row]);
    }
    for (const auto& [patch, factor] : factors) {
      mean.patches.push_back(patch);
      mean.factors.push_back(static_cast<float>(factor));
    }
    mean.counts.push_back(static_cast<std::uint32_t>(factors.size()));
    mean.fronts.push_back(static_cast<float>(fronts));
    mean.backs.push_back(static_cast<float>(backs));
  }
  return mean;
}

}  // namespace lucerna
