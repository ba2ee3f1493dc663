// How often light of each kind reaches the surfaces in each cell of a scene's box (shaders/pathtracer/
// light_visibility.comp), for the choice among lights: a sun that walls keep out, a sky above a room [Guo2020]. Only
// how fast the noise goes depends on it.
#pragma once

#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "rays/path_scene.hpp"
#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace lucerna {

class LightVisibility {
 public:
  static constexpr int kCells = 16;  ///< along the longest side of the box
  static constexpr int kKinds = 3;  ///< the sun, the environment, lamps
  static constexpr int kRays = 32768;  ///< in the box; 8 more to lights from what each meets

  /// `constants`: uniform block 0, with the scene's environment. Traces the rays.
  LightVisibility(gl::ProgramLibrary& programs, const Scene& scene, const PathScene& traced,
                  const gl::Buffer& constants);
  /// Unit 6 and the uniforms of light_cells.glsl.
  void bind(const gl::Program& program) const;
  /// Of each cell (x fastest) and kind: rays, and those that reached their light.
  std::vector<glm::uvec2> counts() const { return counts_.buffer().read<glm::uvec2>(); }
  std::size_t gpuBytes() const { return counts_.bytes(); }

 private:
  void setCells(const gl::Program& program) const;

  glm::vec3 min_;  ///< of the box, in the ray caster's space
  float cell_;  ///< edge
  glm::ivec3 cells_;
  gl::BufferTexture counts_;
};

}  // namespace lucerna
