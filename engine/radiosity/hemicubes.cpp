#include "radiosity/hemicubes.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna {

namespace {

constexpr GLuint kCorners = 0, kFrames = 1, kKeys = 2, kDeltaFactors = 3, kFactors = 4, kSources = 5, kExactList = 6, kShares = 7, kLargeList = 8;
constexpr int kGroup = 64;
constexpr int kTrianglesEach = 8;  // so that a hemicube's frame is read once for eight triangles
constexpr double kSmallSources = 0.1;  // of the area: sources that cover more need no care, each pixel meets one
constexpr double kWholeShare = 268435456.0;  // of hemicube_sum.comp
constexpr int kExactGroups = 256;

/// The same for a seed and a patch in every run and batch; 0..1. [Steele2014], its finaliser.
double hashed(std::uint32_t seed, std::uint32_t patch) {
  std::uint64_t z = (static_cast<std::uint64_t>(seed) << 32 | patch) + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

gl::Buffer storage(const char* name, std::size_t bytes) { return gl::Buffer(name, std::max<std::size_t>(bytes, 16), nullptr, GL_DYNAMIC_COPY); }

}  // namespace

Hemicubes::Hemicubes(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const RadiosityMesh& mesh, const HemicubeSettings& settings)
    : mesh_(&mesh), settings_(settings), patchCount_(static_cast<int>(mesh.patches.size())) {
  CHECK(settings.resolution >= 2 && settings.resolution % 2 == 0, "hemicubes of {} pixels", settings.resolution);
  const auto patches = static_cast<std::size_t>(patchCount_);
  const auto limit = static_cast<std::size_t>(std::max(capabilities.maxShaderStorageBlockSize, 1 << 24));
  const std::size_t keyBytes = 3 * static_cast<std::size_t>(settings.resolution * settings.resolution) * sizeof(GLuint), factorBytes = patches * sizeof(float);
  const std::size_t each = std::max(keyBytes, 2 * factorBytes + 8);
  if (9 * factorBytes > limit || each > limit)
    throwMissingCapability("radiosity: {} patches and hemicubes of {} pixels need storage blocks of {} bytes, this driver's end at {}: use longer edges or smaller hemicubes",
                           patches, settings.resolution, std::max(9 * factorBytes, each), limit);
  // A software renderer does best inside the processor's cache, a GPU with work for all of its cores.
  const std::size_t wanted = settings.batchBytes ? settings.batchBytes : std::size_t{capabilities.softwareRenderer ? 4u : 64u} << 20;
  batch_ = static_cast<int>(std::clamp<std::size_t>(std::min(wanted, limit) / each, 1, std::min<std::size_t>(patches, 1024)));

  std::vector<float> corners;
  corners.reserve(9 * patches);
  double emitting = 0.0;
  for (const Patch& patch : mesh.patches) emitting += patch.emission != glm::dvec3(0.0) ? patch.area : 0.0;
  const bool smallSources = emitting < kSmallSources * mesh.area();
  for (const Patch& patch : mesh.patches) {
    for (const glm::dvec3& corner : mesh.corners(patch))
      for (int axis = 0; axis < 3; ++axis) corners.push_back(static_cast<float>(corner[axis]));
    smallSources_.push_back(smallSources && patch.emission != glm::dvec3(0.0));
  }
  std::vector<float> deltas;
  for (const double d : deltaFormFactors(settings.resolution, settings.map)) deltas.push_back(static_cast<float>(d));
  corners_ = gl::Buffer("radiosity corners", corners.size() * sizeof(float), corners.data(), GL_STATIC_DRAW);
  sources_ = gl::Buffer("radiosity sources", smallSources_.size() * sizeof(GLuint), smallSources_.data(), GL_STATIC_DRAW);
  deltaFactors_ = gl::Buffer("delta form factors", deltas.size() * sizeof(float), deltas.data(), GL_STATIC_DRAW);
  const auto batch = static_cast<std::size_t>(batch_);
  frames_ = storage("hemicube frames", batch * sizeof(Frame));
  keys_ = storage("hemicube pixels", batch * keyBytes);
  factors_ = storage("form factors", batch * factorBytes);
  exactList_ = storage("exact form factors", 8 + batch * patches * sizeof(glm::uvec2));
  shares_ = storage("hemicube shares", batch * sizeof(glm::uvec2));
  largeList_ = storage("large patches", 16 + batch * patches * sizeof(GLuint));
  depth_ = &programs.loadCompute("hemicube depth", "radiosity/hemicube_depth.comp", {{"LARGE", 0}});
  depthLarge_ = &programs.loadCompute("hemicube depth large", "radiosity/hemicube_depth.comp", {{"LARGE", 1}});
  sum_ = &programs.loadCompute("hemicube sum", "radiosity/hemicube_sum.comp", {{"LARGE", 0}});
  sumLarge_ = &programs.loadCompute("hemicube sum large", "radiosity/hemicube_sum.comp", {{"LARGE", 1}});
  exact_ = &programs.loadCompute("hemicube exact", "radiosity/hemicube_exact.comp");
}

Hemicubes::Frame Hemicubes::frameOf(int index) const {
  const Patch& patch = mesh_->patches[static_cast<std::size_t>(index)];
  const auto corners = mesh_->corners(patch);
  // Towards the first corner: never parallel to the normal, whatever the patch.
  const glm::dvec3 u0 = glm::normalize(corners[0] - patch.centroid), v0 = glm::cross(patch.faceNormal, u0);
  const double roll = settings_.randomRoll ? 2.0 * std::numbers::pi * hashed(settings_.seed, static_cast<std::uint32_t>(index)) : 0.0;
  const glm::dvec3 u = std::cos(roll) * u0 + std::sin(roll) * v0, v = glm::cross(patch.faceNormal, u);
  const double inPlane = std::max(1e-4 * std::sqrt(patch.area), 4e-7 * mesh_->extent);
  return {glm::vec4(glm::vec3(patch.centroid), static_cast<float>(1.0 / inPlane)), glm::vec4(glm::vec3(u), 0.0f), glm::vec4(glm::vec3(v), 0.0f),
          glm::vec4(glm::vec3(patch.faceNormal), 0.0f)};
}

FormFactorRows Hemicubes::rows(int first, int count) {
  CHECK(first >= 0 && count > 0 && count <= batch_ && first + count <= patchCount_, "rows {} + {} of {}, at most {}", first, count, patchCount_, batch_);
  std::vector<Frame> frames;
  for (int i = 0; i < count; ++i) frames.push_back(frameOf(first + i));
  frames_.upload(0, frames.size() * sizeof(Frame), frames.data());
  keys_.clear();
  corners_.bind(GL_SHADER_STORAGE_BUFFER, kCorners);
  frames_.bind(GL_SHADER_STORAGE_BUFFER, kFrames);
  keys_.bind(GL_SHADER_STORAGE_BUFFER, kKeys);
  deltaFactors_.bind(GL_SHADER_STORAGE_BUFFER, kDeltaFactors);
  factors_.bind(GL_SHADER_STORAGE_BUFFER, kFactors);
  sources_.bind(GL_SHADER_STORAGE_BUFFER, kSources);
  shares_.clear();
  shares_.bind(GL_SHADER_STORAGE_BUFFER, kShares);
  exactList_.bind(GL_SHADER_STORAGE_BUFFER, kExactList);
  constexpr GLuint kNone[2] = {0, 0};
  exactList_.upload(0, sizeof kNone, kNone);
  largeList_.bind(GL_SHADER_STORAGE_BUFFER, kLargeList);
  constexpr GLuint kNoGroups[4] = {0, 1, 1, 0};
  largeList_.upload(0, sizeof kNoGroups, kNoGroups);
  const glm::ivec3 work((patchCount_ + kTrianglesEach - 1) / kTrianglesEach, count, 1), group(kGroup, 1, 1);
  for (const gl::Program* program : {depth_, depthLarge_, sum_, sumLarge_, exact_}) {
    const gl::ComputePass pass(program->name(), GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    program->use();
    program->set("patchCount", patchCount_);
    program->set("faceSize", settings_.resolution);
    program->set("firstPatch", first);
    program->set("trianglesEach", kTrianglesEach);
    program->set("exactPixels", settings_.exactPixels);
    program->set("nearDistance", settings_.nearDistance);
    program->set("mostParts", settings_.mostParts);
    if (program == depthLarge_ || program == sumLarge_)
      pass.dispatchIndirect(largeList_);
    else
      pass.dispatch(program == exact_ ? glm::ivec3(kExactGroups * kGroup, 1, 1) : work, group);
  }
  const std::vector<float> dense = factors_.read<float>();
  const std::vector<glm::uvec2> shares = shares_.read<glm::uvec2>();
  FormFactorRows result;
  result.first = first;
  for (int row = 0; row < count; ++row) {
    const float* factors = dense.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(patchCount_);
    const std::size_t before = result.patches.size();
    for (int i = 0; i < patchCount_; ++i)
      if (factors[i] > 0.0f) {
        result.patches.push_back(static_cast<std::uint32_t>(i));
        result.factors.push_back(factors[i]);
      }
    result.counts.push_back(static_cast<std::uint32_t>(result.patches.size() - before));
    const glm::dvec2 share = glm::dvec2(shares[static_cast<std::size_t>(row)]) / kWholeShare;
    result.fronts.push_back(static_cast<float>(share.x));
    result.backs.push_back(static_cast<float>(share.y));
  }
  return result;
}

std::size_t Hemicubes::gpuBytes() const {
  return corners_.bytes() + sources_.bytes() + deltaFactors_.bytes() + frames_.bytes() + keys_.bytes() + factors_.bytes() + exactList_.bytes() + shares_.bytes() + largeList_.bytes();
}

}  // namespace lucerna
