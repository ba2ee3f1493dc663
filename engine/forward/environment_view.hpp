// Draws the environment behind the surfaces, as the path tracer sees it: radiance where the depth is still 1.
//
// In: a camera, a target with the scene's depth. Out: radiance in the target's first attachment. A picture is read
// bilinearly, while paths use the texel that contains the direction. The two agree at texel centres and differ between
// them by at most the difference of neighbouring texels.
#pragma once

#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "scene/features.hpp"

#include <optional>

namespace lucerna {

class EnvironmentView {
 public:
  /// `factor`: of its radiance.
  EnvironmentView(gl::ProgramLibrary& programs, const Scene& scene, const glm::vec3& factor);

  static bool isNeeded(const SceneFeatures& features) { return features.environment; }

  /// `target` has the given size; its depth has been drawn with the same camera. `offset`: of what pixels show from
  /// their centres, in pixels.
  void record(const gl::Framebuffer& target, const gl::VertexArray& noAttributes, const Camera& camera, glm::ivec2 size,
              const glm::dvec2& offset) const;
  std::size_t gpuBytes() const { return picture_ ? picture_->bytes() : 0; }

 private:
  std::optional<gl::Texture> picture_;
  glm::vec3 radiance_;
  glm::vec2 turn_;  ///< cosine and sine of the rotation
  const gl::Program* program_;
};

}  // namespace lucerna
