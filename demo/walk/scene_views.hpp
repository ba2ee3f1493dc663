// Debug views that no technique draws. Two count for each pixel: the surfaces in it (overdraw) and the nodes of the
// hierarchy that its ray visits. Three are drawn in the scene: the light in a propagation volume's cells as lobes,
// records as disks. Their programs and buffers are made at first use and dropped with the view.
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/context.hpp"
#include "gl/lines.hpp"
#include "rays/ray_scene.hpp"
#include "render/renderer.hpp"

#include <optional>
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

/// The views that are drawn in the scene as lines.
enum class Glyphs { none, lobes, geometry, records };
constexpr std::array<std::string_view, 4> kGlyphNames{"nothing", "lobes of cells", "geometry volume", "cache records"};

/// Lines relative to the renderer's origin(), empty if its technique has nothing of the kind. Lobes show intensity by
/// direction in the `most` brightest cells of a cascade; the largest is half a cell long. Records show at most `most`
/// of a cascade's records that are in the picture, as disks on their surfaces in the colour of their irradiance; the
/// choice stays the same while the camera moves. Reads textures back, so it waits for the GPU.
std::vector<gl::Lines::Line> glyphsOf(Glyphs glyphs, const Renderer& renderer, const Scene& scene, const Camera& camera,
                                      int cascade, int most);

}  // namespace lucerna::demo
