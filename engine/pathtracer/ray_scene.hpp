// A scene's triangles and their hierarchy on the GPU, for programs that include shaders/pathtracer/bvh.glsl.
//
// Space: rays are given and hits are found in the scene moved by -origin() (see bvh.hpp): subtract it in double from cameras and lights.
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "pathtracer/bvh.hpp"

namespace lucerna {

class RayScene {
 public:
  using Settings = BvhSettings;
  /// Texture units that bind() occupies.
  static constexpr GLuint kNodesUnit = 60, kTrianglesUnit = 61;

  /// Throws Error(missingCapability) where the scene is larger than a buffer texture of the driver.
  RayScene(const Scene& scene, const gl::Capabilities& capabilities, const Settings& settings = {});

  void bind() const;
  const glm::dvec3& origin() const { return origin_; }
  const BvhStatistics& statistics() const { return statistics_; }
  std::size_t gpuBytes() const { return nodes_.bytes() + triangles_.bytes(); }

 private:
  gl::BufferTexture nodes_, triangles_;
  glm::dvec3 origin_;
  BvhStatistics statistics_;
};

}  // namespace lucerna
