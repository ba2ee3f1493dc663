// Inside of Hemicubes: the buffers and uniforms of a batch, shared by all passes and all methods of visibility.
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "radiosity/hemicube_settings.hpp"
#include "radiosity/patches.hpp"

#include <cstdint>
#include <vector>

namespace lucerna {

/// Hemicubes of patches `first` to `first + count - 1`, made by one submission.
struct HemicubeRange {
  int first = 0, count = 0;
};

/// The buffers of a batch, their bindings, and the uniforms that its programs read (shaders/radiosity/hemicube.glsl).
class HemicubeBatch {
 public:
  static constexpr int kGroup = 64;  ///< work items of a group
  static constexpr int kMostHemicubes = 256;  ///< limit in hemicube.glsl: frames of 16 KiB, which every driver has

  /// Throws Error(missingCapability) if the driver's storage blocks or buffer textures cannot hold the corners or one
  /// hemicube. `settings.visibility` is not automatic.
  HemicubeBatch(const gl::Capabilities& capabilities, const RadiosityMesh& mesh, const HemicubeSettings& settings);

  int patchCount() const { return patchCount_; }
  /// Hemicubes that the buffers hold.
  int capacity() const { return capacity_; }
  int resolution() const { return settings_.resolution; }
  double extent() const { return mesh_->extent; }
  /// A flag per patch: smallSourcesOf().
  const std::vector<std::uint32_t>& smallSources() const { return smallSources_; }
  int smallSourceCount() const { return smallSourceCount_; }

  /// Of a hemicube: u, v and the patch's normal.
  glm::dmat3 axesOf(int patch, int roll) const;
  /// Binds all buffers, empties the lists and uploads the frames of one roll.
  void start(const HemicubeRange& range, int roll);
  /// Makes a program current, with its uniforms.
  void use(const gl::Program& program, const HemicubeRange& range) const;
  /// Work groups of blocks of patches, each of several hemicubes (hemicube_points.comp), after start().
  const glm::ivec3& groupsOfBlocks() const { return blockGroups_; }
  /// Work groups along x that share each hemicube's lists (hemicube_lists.glsl).
  glm::ivec3 groupsOfLists(const HemicubeRange& range) const;
  /// Work groups that share the list of closed forms.
  int groupsOfExact() const;

  gl::BufferTexture& pixels() { return pixels_; }
  gl::Buffer& factors() { return factors_; }
  /// Most entries that a batch's hemicubes list, if pixels name their patches.
  std::size_t mostListed() const { return mostListed_; }
  const gl::Buffer& exactList() const { return exactList_; }
  const gl::Buffer& largeList() const { return largeList_; }
  std::size_t gpuBytes() const;

 private:
  struct Frame {
    glm::vec4 origin, u, v, n;
  };
  Frame frameOf(int patch, int roll) const;
  double inPlane(const Patch& patch) const;
  void listBlocks(const HemicubeRange& range);

  const RadiosityMesh* mesh_;
  HemicubeSettings settings_;
  std::vector<std::uint32_t> smallSources_;
  bool isSoftware_ = false;
  int patchCount_ = 0, smallSourceCount_ = 0, capacity_ = 0;
  std::size_t mostListed_ = 0;
  gl::BufferTexture corners_, deltaFactors_, pixels_;
  gl::Buffer sources_, frames_, factors_, exactList_, largeList_, lists_, blockList_;
  std::vector<Bounds> blocks_;  ///< of kGroup patches each
  glm::ivec3 blockGroups_{0};
};

/// Hemicubes per patch: one, unless they are turned at random.
inline int rollsOf(const HemicubeSettings& settings) { return settings.randomRoll ? settings.rolls : 1; }

/// Whether pixels name the patches that they see, so that later passes visit only those.
inline bool listsPatches(HemicubeVisibility visibility) { return visibility != HemicubeVisibility::raster; }

/// 1 for emissive patches, if they are small compared with the scene: pixels miss them, so they get closed forms.
std::vector<std::uint32_t> smallSourcesOf(const RadiosityMesh& mesh);

}  // namespace lucerna
