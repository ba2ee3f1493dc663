// Depth and normals of the visible surfaces, drawn before shading, for techniques that start from pixels.
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace lucerna {

class VisibleSurfaces {
 public:
  /// depth: of the picture's size, owned by the caller, since shading reuses it.
  VisibleSurfaces(gl::ProgramLibrary& programs, const GpuScene& scene, const gl::Texture& depth);
  void resize(const gl::Texture& depth);

  /// Draws depth and normals with forward/surface.vert; the frame's uniform block must be bound.
  void record(const GpuScene& scene, const GpuScene::View& view) const;
  /// For a program in use that includes shaders/forward/visible.glsl: units 3 and 4.
  void bind(const gl::Program& program, const glm::mat4& worldFromClip) const;
  const gl::Texture& normal() const { return normal_; }
  glm::ivec2 size() const { return normal_.size2d(); }
  std::size_t gpuBytes() const { return normal_.bytes(); }

 private:
  SurfacePrograms programs_;
  const gl::Texture* depth_ = nullptr;
  gl::Texture normal_;  ///< RGBA16F, unit, on the viewer's side
  gl::Framebuffer target_;
};

}  // namespace lucerna
