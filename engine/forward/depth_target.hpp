// Draws depth into a map frame after frame. While its views stay and meshes move, the depth of all meshes that have
// never moved is kept in a second map, and only the others are drawn, over a copy of it: the same bits, as the nearest
// depth does not depend on the order. Nothing of it is made before something has moved.
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/pass.hpp"

#include <glm/glm.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lucerna {

class DepthTarget {
 public:
  /// depth: a map, or those of its layers that one draw fills.
  DepthTarget(const std::string& name, gl::Texture depth);

  /// A view's matrix for positions relative to `place`.
  struct View {
    glm::mat4 clipFromPlace;
    glm::vec3 place;
    bool operator==(const View&) const = default;
  };
  /// Draws what has changed since the last time; the programs' uniforms are those of the views.
  void record(const GpuScene& scene, const SurfacePrograms& programs, const gl::RasterState& state,
              std::span<const View> views);
  /// All is drawn in the next frame.
  void forget() { views_.clear(); }
  const gl::Texture& depth() const { return depth_; }
  /// Of the second map.
  std::size_t keptBytes() const { return still_ ? still_->bytes() : 0; }

 private:
  std::string name_;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
  std::vector<View> views_;  ///< of the last frame; none: all must be drawn
  std::size_t poses_ = 0;  ///< GpuScene::poses() then
  std::optional<gl::Texture> still_;  ///< depth of the meshes that have not moved
  std::size_t stillWithout_ = 0;  ///< GpuScene::movingMeshes() then; 0: not drawn under views_
};

}  // namespace lucerna
