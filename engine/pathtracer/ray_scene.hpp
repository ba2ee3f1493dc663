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
  /// What bind() occupies.
  static constexpr GLuint kNodesBinding = 0, kTrianglesBinding = 1;  ///< GL_SHADER_STORAGE_BUFFER

  /// Throws Error(missingCapability) where the scene is larger than a shader storage block of the driver.
  RayScene(const Scene& scene, const gl::Capabilities& capabilities, const Settings& settings = {});

  void bind() const;
  const glm::dvec3& origin() const { return origin_; }
  const BvhStatistics& statistics() const { return statistics_; }
  std::size_t gpuBytes() const { return nodes_.bytes() + triangles_.bytes(); }

 private:
  gl::Buffer nodes_, triangles_;
  glm::dvec3 origin_;
  BvhStatistics statistics_;
};

}  // namespace lucerna
