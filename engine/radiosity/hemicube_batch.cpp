#include "radiosity/hemicube_batch.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"
#include "radiosity/hemicube_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lucerna {

namespace {

constexpr GLuint kPixelsUnit = 57, kDeltasUnit = 58, kCornersUnit = 59, kFrames = 9, kPixels = 2, kLargeList = 3,
                 kFactors = 4, kSources = 5, kExactList = 6;
constexpr GLuint kLists = 0, kBlocks = 1;
constexpr std::size_t kListHead = 2 * HemicubeBatch::kMostHemicubes;  ///< words: counts of two lists each
constexpr int kHemicubesEach = 4;  ///< that a lane of hemicube_points.comp visits
/// An indirect dispatch with one lane per entry reaches no further.
constexpr std::size_t kMostListed = std::size_t{65535} * HemicubeBatch::kGroup;
constexpr double kSmallSources = 0.1;  // of the area: larger sources need no special care

/// The same value for a seed and patch in every run and batch; 0..1. [Steele2014], its finaliser.
double hashed(std::uint32_t seed, std::uint32_t patch) {
  std::uint64_t z = (static_cast<std::uint64_t>(seed) << 32 | patch) + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

std::uint32_t placeOf(const std::array<glm::dvec3, 3>& corners) {
  Hash hash;
  for (const glm::dvec3& corner : corners) hash.add(corner);
  return static_cast<std::uint32_t>(hash.value() ^ hash.value() >> 32);
}

/// Of one hemicube.
struct Sizes {
  std::size_t pixels, pixelBytes, factorBytes;
  std::size_t listed;  ///< entries, at most
};

Sizes sizesOf(const HemicubeSettings& settings, std::size_t patches, std::size_t smallSources) {
  const auto resolution = static_cast<std::size_t>(settings.resolution);
  const std::size_t pixels = 3 * resolution * resolution;
  // Pixels that name their patches name at most one each, in addition to the small sources.
  const std::size_t listed = listsPatches(settings.visibility) ? std::min(patches, pixels) + smallSources : patches;
  return {pixels, pixels * sizeof(GLuint), patches * sizeof(float), listed};
}

/// Hemicubes in a batch, or an error that says which limit of the driver one exceeds.
int capacityOf(const gl::Capabilities& capabilities, const HemicubeSettings& settings, std::size_t patches,
               const Sizes& one) {
  const auto limit = static_cast<std::size_t>(std::max(capabilities.maxShaderStorageBlockSize, 1 << 24));
  const std::size_t each = std::max({one.pixelBytes, one.factorBytes, one.listed * sizeof(glm::uvec2) + 16});
  if (each > limit)
    throwMissingCapability(
        "radiosity: {} patches and hemicubes of {} pixels need storage blocks of {} bytes, this driver's limit is {} "
        "(GL_MAX_SHADER_STORAGE_BLOCK_SIZE): use longer edges or smaller hemicubes",
        patches, settings.resolution, each, limit);
  const auto texels = static_cast<std::size_t>(std::max(capabilities.maxTextureBufferSize, 1 << 16));
  if (3 * patches > texels || one.pixels > texels)
    throwMissingCapability(
        "radiosity: {} patches and hemicubes of {} pixels need buffer textures of {} texels, this driver's limit is {} "
        "(GL_MAX_TEXTURE_BUFFER_SIZE)",
        patches, settings.resolution, std::max(3 * patches, one.pixels), texels);
  // A software renderer is fastest inside the processor's cache, a GPU with work for all of its cores. Rays touch
  // little memory, so batch at least 16 hemicubes.
  const std::size_t least = settings.visibility == HemicubeVisibility::rays ? 16 * each : 0,
                    usual = std::size_t{capabilities.softwareRenderer ? 4u : 64u} << 20,
                    wanted = settings.batchBytes ? settings.batchBytes : std::max(least, usual);
  const std::size_t most = std::min({patches, std::size_t{HemicubeBatch::kMostHemicubes}, texels / one.pixels,
                                     std::max<std::size_t>(kMostListed / one.listed, 1)});
  const int batch = static_cast<int>(std::clamp<std::size_t>(std::min(wanted, limit) / each, 1, most));
  if (settings.visibility != HemicubeVisibility::itemBuffer) return batch;
  return std::clamp(std::min(batch, capabilities.maxArrayTextureLayers / 5), 1, batch);
}

gl::BufferTexture cornersOf(const RadiosityMesh& mesh) {
  std::vector<glm::vec4> corners;
  corners.reserve(3 * mesh.patches.size());
  for (const Patch& patch : mesh.patches)
    for (const glm::dvec3& corner : mesh.corners(patch))
      corners.emplace_back(glm::vec3(corner), patch.emission != glm::dvec3(0.0) ? 1.0f : 0.0f);
  return {"radiosity corners", gl::Format::rgba32f, corners.size() * sizeof(glm::vec4), corners.data()};
}

gl::BufferTexture deltaFactorsOf(const HemicubeSettings& settings) {
  std::vector<float> deltas;
  for (const double d : deltaFormFactors(settings.resolution, settings.map)) deltas.push_back(static_cast<float>(d));
  return {"delta form factors", gl::Format::r32f, deltas.size() * sizeof(float), deltas.data()};
}

/// A flag per patch, then the numbers of those flagged.
gl::Buffer sourcesOf(const std::vector<std::uint32_t>& flags) {
  std::vector<std::uint32_t> sources = flags;
  for (std::uint32_t i = 0; i < flags.size(); ++i)
    if (flags[i]) sources.push_back(i);
  return {"radiosity sources", sources.size() * sizeof(GLuint), sources.data(), gl::Usage::staticDraw};
}

gl::Buffer storage(const char* name, std::size_t bytes) {
  return gl::Buffer(name, std::max<std::size_t>(bytes, 16), nullptr, gl::Usage::dynamicCopy);
}

}  // namespace

std::vector<std::uint32_t> smallSourcesOf(const RadiosityMesh& mesh) {
  const auto emits = [](const Patch& patch) { return patch.emission != glm::dvec3(0.0); };
  double emitting = 0.0;
  for (const Patch& patch : mesh.patches) emitting += emits(patch) ? patch.area : 0.0;
  const bool small = emitting < kSmallSources * mesh.area();
  std::vector<std::uint32_t> flags;
  for (const Patch& patch : mesh.patches) flags.push_back(small && emits(patch));
  return flags;
}

HemicubeBatch::HemicubeBatch(const gl::Capabilities& capabilities, const RadiosityMesh& mesh,
                             const HemicubeSettings& settings)
    : mesh_(&mesh),
      settings_(settings),
      smallSources_(smallSourcesOf(mesh)),
      isSoftware_(capabilities.softwareRenderer),
      patchCount_(static_cast<int>(mesh.patches.size())),
      smallSourceCount_(static_cast<int>(std::count(smallSources_.begin(), smallSources_.end(), 1u))) {
  const std::size_t patches = mesh.patches.size();
  const Sizes one = sizesOf(settings, patches, static_cast<std::size_t>(smallSourceCount_));
  capacity_ = capacityOf(capabilities, settings, patches, one);
  const auto batch = static_cast<std::size_t>(capacity_);
  mostListed_ = batch * one.listed;
  corners_ = cornersOf(mesh);
  sources_ = sourcesOf(smallSources_);
  deltaFactors_ = deltaFactorsOf(settings);
  frames_ = gl::Buffer("hemicube frames", kMostHemicubes * sizeof(Frame), nullptr, gl::Usage::dynamicDraw);
  pixels_ = gl::BufferTexture("hemicube pixels", gl::Format::r32ui, batch * one.pixelBytes, nullptr);
  factors_ = storage("form factors", batch * one.factorBytes);
  factors_.clear();
  exactList_ = storage("exact form factors", 8 + mostListed_ * sizeof(glm::uvec2));
  largeList_ = storage("large patches", 16 + mostListed_ * sizeof(GLuint));
  if (listsPatches(settings.visibility)) return;
  lists_ = storage("patches by pixels", (kListHead + batch * patches) * sizeof(GLuint));
  blocks_.resize((patches + kGroup - 1) / kGroup);
  for (std::size_t i = 0; i < patches; ++i)
    for (const glm::dvec3& corner : mesh.corners(mesh.patches[i])) blocks_[i / kGroup].add(corner);
  blockList_ =
      storage("blocks of patches", blocks_.size() * ((batch + kHemicubesEach - 1) / kHemicubesEach) * sizeof(GLuint));
}

glm::dmat3 HemicubeBatch::axesOf(int index, int roll) const {
  const Patch& patch = mesh_->patches[static_cast<std::size_t>(index)];
  const auto corners = mesh_->corners(patch);
  // Towards the first corner: never parallel to the normal, whatever the patch.
  const glm::dvec3 u0 = glm::normalize(corners[0] - patch.centroid), v0 = glm::cross(patch.faceNormal, u0);
  // A hemicube is the same after a quarter of a rotation: several are spaced evenly within it.
  const std::uint32_t key = settings_.rollsByPlace ? placeOf(corners) : static_cast<std::uint32_t>(index);
  const double rotation = hashed(settings_.seed, key) + 0.25 * roll / rollsOf(settings_);
  const double angle = settings_.randomRoll ? 2.0 * std::numbers::pi * rotation : 0.0;
  const glm::dvec3 u = std::cos(angle) * u0 + std::sin(angle) * v0;
  return {u, glm::cross(patch.faceNormal, u), patch.faceNormal};
}

/// Height above a patch's plane below which a corner lies in it.
double HemicubeBatch::inPlane(const Patch& patch) const {
  return std::max(1e-4 * std::sqrt(patch.area), 4e-7 * mesh_->extent);
}

HemicubeBatch::Frame HemicubeBatch::frameOf(int index, int roll) const {
  const Patch& patch = mesh_->patches[static_cast<std::size_t>(index)];
  const glm::dmat3 axes = axesOf(index, roll);
  return {glm::vec4(glm::vec3(patch.centroid), static_cast<float>(1.0 / inPlane(patch))),
          glm::vec4(glm::vec3(axes[0]), patch.hidden), glm::vec4(glm::vec3(axes[1]), 0.0f),
          glm::vec4(glm::vec3(axes[2]), 0.0f)};
}

void HemicubeBatch::start(const HemicubeRange& range, int roll) {
  CHECK(range.first >= 0 && range.count > 0 && range.count <= capacity_ && range.first + range.count <= patchCount_,
        "rows {} + {} of {}, at most {}", range.first, range.count, patchCount_, capacity_);
  std::vector<Frame> frames;
  for (int i = 0; i < range.count; ++i) frames.push_back(frameOf(range.first + i, roll));
  frames_.upload(0, frames.size() * sizeof(Frame), frames.data());
  corners_.bind(kCornersUnit);
  frames_.bindUniform(kFrames);
  pixels_.buffer().bindStorage(kPixels);
  pixels_.bind(kPixelsUnit);
  deltaFactors_.bind(kDeltasUnit);
  factors_.bindStorage(kFactors);
  sources_.bindStorage(kSources);
  exactList_.bindStorage(kExactList);
  constexpr GLuint kNone[2] = {0, 0};
  exactList_.upload(0, sizeof kNone, kNone);
  largeList_.bindStorage(kLargeList);
  constexpr GLuint kNoGroups[4] = {0, 1, 1, 0};
  largeList_.upload(0, sizeof kNoGroups, kNoGroups);
  if (listsPatches(settings_.visibility)) return;
  constexpr std::array<GLuint, kListHead> kNoEntries{};
  lists_.upload(0, sizeof kNoEntries, kNoEntries.data());
  lists_.bindStorage(kLists);
  listBlocks(range);
}

/// For each work group's hemicubes, the blocks of patches that are not below the horizon of all of them.
void HemicubeBatch::listBlocks(const HemicubeRange& range) {
  const auto isAbove = [&](const Bounds& block, int index) {
    const Patch& patch = mesh_->patches[static_cast<std::size_t>(index)];
    const glm::dvec3 n = patch.faceNormal;
    const double height = glm::dot(n, block.centre() - patch.centroid) + glm::dot(glm::abs(n), 0.5 * block.extent());
    return height > 0.25 * inPlane(patch);  // less than 1: the shader's heights are rounded
  };
  std::vector<std::vector<GLuint>> lists;
  std::size_t longest = 1;
  for (int first = 0; first < range.count; first += kHemicubesEach) {
    std::vector<GLuint>& list = lists.emplace_back();
    for (GLuint block = 0; block < blocks_.size(); ++block) {
      bool above = false;
      for (int k = first; k < std::min(first + kHemicubesEach, range.count) && !above; ++k)
        above = isAbove(blocks_[block], range.first + k);
      if (above) list.push_back(block);
    }
    longest = std::max(longest, list.size());
  }
  std::vector<GLuint> words;
  for (std::vector<GLuint>& list : lists) {
    list.resize(longest, ~0u);
    words.insert(words.end(), list.begin(), list.end());
  }
  blockList_.upload(0, words.size() * sizeof(GLuint), words.data());
  blockList_.bindStorage(kBlocks);
  blockGroups_ = glm::ivec3(longest, lists.size(), 1);
}

void HemicubeBatch::use(const gl::Program& program, const HemicubeRange& range) const {
  const int resolution = settings_.resolution;
  program.use();
  program.set("patchCount", patchCount_);
  program.set("faceSize", resolution);
  program.set("halfFacePixels", resolution * resolution / 2);
  program.set("halfSize", 0.5f * static_cast<float>(resolution));
  program.set("pixelSize", 2.0f / static_cast<float>(resolution));
  program.set("firstPatch", range.first);
  program.set("hemicubes", range.count);
  program.set("sourceCount", smallSourceCount_);
  program.set("exactPixels", settings_.exactPixels);
  program.set("nearDistance", settings_.nearDistance);
  program.set("mostParts", settings_.mostParts);
}

// A software renderer pays for starting a work group, a GPU for cores without work.
glm::ivec3 HemicubeBatch::groupsOfLists(const HemicubeRange& range) const {
  return {isSoftware_ ? 1 : 16, range.count, 1};
}
int HemicubeBatch::groupsOfExact() const { return isSoftware_ ? 16 : 256; }

std::size_t HemicubeBatch::gpuBytes() const {
  return corners_.bytes() + sources_.bytes() + deltaFactors_.bytes() + frames_.bytes() + pixels_.bytes() +
         factors_.bytes() + exactList_.bytes() + largeList_.bytes() + lists_.bytes() + blockList_.bytes();
}

}  // namespace lucerna
