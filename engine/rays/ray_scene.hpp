// A scene's triangles and their hierarchy on the GPU, for programs that include shaders/rays/bvh.glsl.
//
// Space: rays and hits are in the scene moved by -origin() (see bvh.hpp): subtract it in double from cameras and
// lights.
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "rays/bvh.hpp"
#include "shared/bindings.h"

#include <optional>

namespace lucerna {

struct RaySceneSettings {
  BvhSettings bvh;
  bool moves = false;  ///< update() will be called: keep the hierarchy in main memory too
  std::optional<bool>
      sharedStack;  ///< traversal stacks of compute programs in shared memory; not set: except on software renderers
};

/// Calls upload(first, count) for the runs that rising numbers make up; short gaps belong to a run.
template <class Upload>
void forRuns(const std::vector<std::uint32_t>& numbers, const Upload& upload) {
  constexpr std::uint32_t kShortGap = 64;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] - numbers[end - 1] <= kShortGap) ++end;
    upload(std::size_t{numbers[i]}, std::size_t{numbers[end - 1]} - numbers[i] + 1);
    i = end;
  }
}

class RayScene {
 public:
  using Settings = RaySceneSettings;
  /// Texture units that bind() occupies.
  static constexpr GLuint kNodesUnit = UNIT_BVH_NODES, kTrianglesUnit = UNIT_BVH_TRIANGLES;

  /// Throws Error(missingCapability) if the scene exceeds the driver's limit of buffer textures.
  RayScene(const Scene& scene, const gl::Capabilities& capabilities, const Settings& settings = {});

  /// Meshes of the same scene have moved, or their materials emit light now or no more: refits the hierarchy if
  /// possible, else builds it anew, which may move origin().
  void update(const Scene& scene, std::span<const std::size_t> meshes);

  void bind() const;
  /// Flag SHARED_STACK for compute programs of at most 64 invocations per group: entries of the stack, 0 if it is a
  /// local array.
  int sharedStack() const;
  const glm::dvec3& origin() const { return origin_; }
  const BvhStatistics& statistics() const { return statistics_; }
  std::size_t gpuBytes() const { return nodes_.bytes() + triangles_.bytes(); }

 private:
  void upload(const Scene& scene, const Bvh& bvh);

  Settings settings_;
  std::size_t limit_;  // bytes of a buffer texture
  bool sharedStack_;
  std::optional<Bvh> bvh_;
  std::optional<BvhRefit> refit_;
  gl::BufferTexture nodes_, triangles_;
  glm::dvec3 origin_{0.0};
  BvhStatistics statistics_;
};

}  // namespace lucerna
