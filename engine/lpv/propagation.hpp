// Propagation: light moves on by a cell a step, and what passed through each cell is added up. Two ways: all cascades
// in one dispatch a step, or as published, a layered pass a step and cascade.
#pragma once

#include "lpv/geometry_volume.hpp"
#include "lpv/grid.hpp"
#include "lpv/injection.hpp"

#include <array>

namespace lucerna {

/// Gathers in cells that light has reached, brick by brick (lpv/propagate.comp). Fronts and sums are buffers of three
/// channels one after the other.
class LpvComputePropagation {
 public:
  LpvComputePropagation(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const LpvSettings& settings,
                        bool haveCounts);
  /// From the injected light, or what is reflected of it. `injection`'s counts serve as a front. `geometry`: nullptr
  /// where nothing is blocked.
  void run(const LpvVolume& source, LpvInjection& injection, const LpvGeometryVolume* geometry);
  /// Units 0 and, of steps after the hand-over, 3.
  void bindSums() const;
  std::size_t gpuBytes() const;

 private:
  LpvSettings settings_;
  glm::ivec3 size_;
  int brickCount_ = 0;  ///< of all cascades, lit or not
  const gl::Program* begin_ = nullptr;
  const gl::Program* markBricks_ = nullptr;
  const gl::Program* listBricks_ = nullptr;
  const gl::Program* first_ = nullptr;
  const gl::Program* further_ = nullptr;  ///< blocked if blocking is on
  std::array<gl::BufferTexture, 2> fronts_;  ///< the first only where there are no counts
  gl::BufferTexture sums_, farSums_;  ///< of the first steps and, where cascades are joined, those after the hand-over
  gl::Buffer bricks_;  ///< reached by light (lpv/bricks.glsl)
};

/// Draws a point a cell, or a triangle a slice, into the layers of 3D textures; blending adds to the sum.
class LpvLayeredPropagation {
 public:
  LpvLayeredPropagation(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                        const LpvSettings& settings);
  void run(const LpvVolume& source, const LpvGeometryVolume* geometry);
  /// Units 0 to 2 and, of steps after the hand-over, 3 to 5.
  void bindSums() const;
  std::size_t gpuBytes() const;

 private:
  LpvSettings settings_;
  bool haveClearTexture_;
  const gl::Program* first_ = nullptr;
  const gl::Program* further_ = nullptr;  ///< blocked if blocking is on
  gl::VertexArray noAttributes_;
  std::array<LpvVolume, 2> fronts_;
  LpvVolume sum_, farSum_;  ///< of the first steps and, where cascades are joined, those after the hand-over
  std::array<std::array<gl::Framebuffer, 2>, 2> targets_;  ///< front x (sum, far sum)
};

}  // namespace lucerna
