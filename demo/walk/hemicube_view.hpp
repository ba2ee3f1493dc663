// The hemicube of a patch for the debug view: its five faces unfolded, once in the colours of the patches that its
// pixels see, once in the weights of the pixels. Made once for a patch.
#pragma once

#include "gl/objects.hpp"
#include "radiosity/solution.hpp"
#include "scene/scene.hpp"

#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

class HemicubeView {
 public:
  /// `solution`: of `scene`, made with `settings`. `exposure`: of the patches' exitances.
  HemicubeView(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
               const RadiositySolution& solution, const RadiositySolutionSettings& settings, std::uint32_t patch,
               float exposure);

  const gl::Texture& picture() const { return picture_; }  ///< values, bottom row first
  /// What the picture shows.
  const std::vector<std::string>& lines() const { return lines_; }
  std::uint32_t patch() const { return patch_; }
  double seen() const { return seen_; }  ///< share of the hemisphere that shows fronts, by the pixels' weights

 private:
  gl::Texture picture_;
  std::vector<std::string> lines_;
  std::uint32_t patch_;
  double seen_ = 0.0;
};

/// The front that a pixel's centre shows, counted from the top left; none if there is none.
std::optional<std::uint32_t> patchAt(const RadiosityMesh& mesh, const Camera& camera, glm::ivec2 pixel,
                                     glm::ivec2 size);

}  // namespace lucerna::demo
