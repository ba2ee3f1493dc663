// Single steps of a light propagation volume for the debug view: the light G_k that step k brought into the cells, and
// how much of the injected light it is. Made once for a view, by volumes of 0, 1, 2, ... steps, whose sums differ by
// it.
#pragma once

#include "frame/stage_picture.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "frame/render_settings.hpp"
#include "scene/scene.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace lucerna::demo {

class LpvSteps {
 public:
  /// `settings`: of technique lpv. `note` is called before each step, and may throw to stop. One cascade: light that
  /// leaves its grid is gone.
  LpvSteps(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, RenderSettings settings,
           const Camera& camera, const std::function<void(int step)>& note);

  int slices() const { return size_.z; }
  int steps() const { return static_cast<int>(energies_.size()) - 1; }
  /// Flux of all cells by step, over that of the injected light, step 0.
  const std::vector<float>& energies() const { return energies_; }
  /// The light of step k alone. Valid until the next call.
  StagePicture picture(int k);

 private:
  using Texels = std::array<std::vector<glm::vec4>, 3>;
  glm::ivec3 size_{0};
  std::vector<Texels> light_;
  std::vector<float> energies_;
  int shown_ = -1;
  std::array<gl::Texture, 3> textures_;
};

}  // namespace lucerna::demo
