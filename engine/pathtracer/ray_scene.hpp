// A scene's triangles and their hierarchy on the GPU, for programs that include shaders/pathtracer/bvh.glsl.
//
// Space: rays are given and hits are found in the scene moved by -origin() (see bvh.hpp): subtract it in double from cameras and lights.
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "pathtracer/bvh.hpp"

#include <optional>

namespace lucerna {

struct RaySceneSettings {
  BvhSettings bvh;
  bool moves = false;  ///< update() will be called: the hierarchy is kept in main memory too
  std::optional<bool> sharedStack;  ///< compute programs keep the stack of a traversal in shared memory; not set: they do but on software renderers
};

class RayScene {
 public:
  using Settings = RaySceneSettings;
  /// Texture units that bind() occupies.
  static constexpr GLuint kNodesUnit = 60, kTrianglesUnit = 61;

  /// Throws Error(missingCapability) where the scene is larger than a buffer texture of the driver.
  RayScene(const Scene& scene, const gl::Capabilities& capabilities, const Settings& settings = {});

  /// Takes over corners that have moved in the same scene: refits where that can be done, else builds anew, which may move origin().
  void update(const Scene& scene);

  void bind() const;
  /// Flag SHARED_STACK for compute programs of at most 64 invocations a group: entries of the stack, 0 where it is a local array.
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
  gl::BufferTexture nodes_, triangles_;
  glm::dvec3 origin_{0.0};
  BvhStatistics statistics_;
};

}  // namespace lucerna
