// Debug views that no technique draws. They count for each pixel the surfaces in it (overdraw) or the nodes of the
// hierarchy that its ray visits. Their programs and buffers are made at first use and dropped with the view.
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "rays/ray_scene.hpp"

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace lucerna::demo {

/// What is counted for each pixel; the first entry stands for nothing.
enum class CountView { none, overdraw, visits };
constexpr std::array<std::string_view, 3> kCountViewNames{"nothing", "surfaces a pixel", "visits a ray"};

class CountViews {
 public:
  /// `scene` must outlive this object.
  CountViews(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const glm::dvec3& origin);

  /// Draws the counts in colours from black (0) through red and yellow to white (`white` or more).
  /// clipFromWorld is relative to `origin`.
  const gl::Texture& record(CountView view, const Camera& camera, const glm::mat4& clipFromWorld, glm::ivec2 size,
                            float white);
  float most() const { return most_; }  ///< the largest count in the last picture
  float mean() const { return mean_; }

 private:
  std::vector<float> surfaces(const glm::mat4& clipFromWorld, glm::ivec2 size);
  std::vector<float> visits(const Camera& camera, glm::ivec2 size);

  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  const Scene& scene_;
  glm::dvec3 origin_;
  std::optional<Scene> moved_;
  std::optional<GpuScene> drawn_;
  std::optional<RayScene> rays_;
  gl::Texture result_;
  float most_ = 0.0f, mean_ = 0.0f;
  // What the stored picture shows.
  CountView view_ = CountView::none;
  glm::mat4 clip_{0.0f};
  std::vector<float> counts_;
};

}  // namespace lucerna::demo
