// Propagation: light moves by one cell per step, and the light that passes through each cell is summed. Two ways: all
// cascades in one dispatch per step, or, as published, one layered pass per step and cascade.
#pragma once

#include "lpv/geometry_volume.hpp"
#include "lpv/grid.hpp"
#include "lpv/injection.hpp"

#include <array>

namespace lucerna {

/// Of a cell and step (gl/chunks.hpp): 6 neighbours, 5 faces each.
constexpr double kIterationsOfPropagation = 30.0;

/// Gathers in the cells that light has reached, brick by brick (lpv/propagate.comp). Wavefronts and sums are buffers of
/// three channels, one after the other.
class LpvComputePropagation {
 public:
  LpvComputePropagation(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const LpvSettings& settings,
                        bool haveCounts);
  /// Propagates the injected light, or what is reflected of it. `injection`'s counts serve as a wavefront. `geometry`:
  /// nullptr without blocking.
  void run(const LpvVolume& source, LpvInjection& injection, const LpvGeometryVolume* geometry);
  /// Units 0 and, for the steps after the hand-over, 3.
  void bindSums() const;
  std::size_t gpuBytes() const;

 private:
  LpvSettings settings_;
  glm::ivec3 size_;
  int brickCount_ = 0;  ///< in all cascades, lit or not
  const gl::Program* begin_ = nullptr;
  const gl::Program* markBricks_ = nullptr;
  const gl::Program* listBricks_ = nullptr;
  const gl::Program* first_ = nullptr;
  const gl::Program* further_ = nullptr;  ///< with blocking, if it is on
  std::array<gl::BufferTexture, 2> wavefronts_;  ///< the first one only if there are no counts
  gl::BufferTexture sums_, farSums_;  ///< of the first steps and, with joined cascades, those after the hand-over
  gl::Buffer bricks_;  ///< reached by light (lpv/bricks.glsl)
};

/// Draws one point per cell or one triangle per slice into the layers of 3D textures; blending adds to the sum.
class LpvLayeredPropagation {
 public:
  LpvLayeredPropagation(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                        const LpvSettings& settings);
  void run(const LpvVolume& source, const LpvGeometryVolume* geometry);
  /// Units 0 to 2 and, for the steps after the hand-over, 3 to 5.
  void bindSums() const;
  std::size_t gpuBytes() const;

 private:
  LpvSettings settings_;
  bool haveClearTexture_;
  const gl::Program* first_ = nullptr;
  const gl::Program* further_ = nullptr;  ///< with blocking, if it is on
  gl::VertexArray noAttributes_;
  std::array<LpvVolume, 2> wavefronts_;
  LpvVolume sum_, farSum_;  ///< of the first steps and, with joined cascades, those after the hand-over
  std::array<std::array<gl::Framebuffer, 2>, 2> targets_;  ///< wavefront x (sum, far sum)
};

}  // namespace lucerna
