// Debug views that no technique makes: how many surfaces lie in a pixel, how many nodes of the hierarchy its ray
// visits; the light in the cells of a propagation volume as lobes, voxels as boxes, receivers as disks, in the scene.
// What they need is made when they are looked at for the first time, and dropped with the view.
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/context.hpp"
#include "gl/lines.hpp"
#include "rays/ray_scene.hpp"
#include "render/renderer.hpp"

#include <optional>
#include <vector>

namespace lucerna::demo {

/// Counts a pixel; the first is none of these.
enum class CountView { none, overdraw, visits };
constexpr std::array<std::string_view, 3> kCountViewNames{"nothing", "surfaces a pixel", "visits a ray"};

class CountViews {
 public:
  /// `scene` must outlive it.
  CountViews(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const glm::dvec3& origin);

  /// Colours from black (0) over red and yellow to white (`white` and more). clipFromWorld: about `origin`.
  const gl::Texture& record(CountView view, const Camera& camera, const glm::mat4& clipFromWorld, glm::ivec2 size,
                            float white);
  float most() const { return most_; }  ///< of the last picture's counts
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
  // That the picture is of.
  CountView view_ = CountView::none;
  glm::mat4 clip_{0.0f};
  std::vector<float> counts_;
};

/// What is drawn in the scene as lines.
enum class Glyphs { none, lobes, geometry, voxels, receivers };
constexpr std::array<std::string_view, 5> kGlyphNames{"nothing", "lobes of cells", "geometry volume",
                                                      "visibility voxels", "receivers"};

/// About the renderer's origin(); empty where its technique has none of it. Lobes: intensity by direction in each of
/// the `most` brightest cells of a cascade, the largest half a cell long. Receivers: `most` of those of a cascade in
/// the picture, the same ones while the camera moves, as disks on their surfaces in the colour of their irradiance.
/// Reads textures back: waits for the GPU.
std::vector<gl::Lines::Line> glyphsOf(Glyphs glyphs, const Renderer& renderer, const Scene& scene, const Camera& camera,
                                      int cascade, int most);

}  // namespace lucerna::demo
