// How far surfaces of moving objects have gone in the picture since the frame before, for the reprojection of that
// frame (forward/reproject.frag). Only what has moved is drawn, and only while it moves.
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

#include <glm/glm.hpp>

#include <cstddef>
#include <optional>

namespace lucerna {

class ObjectMotion {
 public:
  ObjectMotion(gl::ProgramLibrary& programs, const SceneFeatures& features);

  /// Draws the meshes that have moved since GpuScene::keepPlaces(), where `depth` has them, which was drawn with the
  /// frame constants now bound. `clip`, `clipBefore`: from world, of this frame and the one before.
  void draw(const GpuScene& scene, const gl::Texture& depth, const glm::dmat4& clip, const glm::dmat4& clipBefore);

  /// xy: from the place now to the one before, in normalised device coordinates; z: the distance along the view before
  /// over that now; w: 1 where a mesh has moved.
  const gl::Texture& texture() const { return *texture_; }
  void resize() { texture_.reset(); }
  std::size_t gpuBytes() const { return texture_ ? texture_->bytes() : 0; }

 private:
  SurfacePrograms programs_;
  std::optional<gl::Texture> texture_;
  std::optional<gl::Framebuffer> target_;
};

}  // namespace lucerna
