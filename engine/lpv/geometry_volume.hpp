// The geometry volume: surfels of the lights' maps or of the camera's view, as a blocking potential at the corners of
// cells and, for further bounces, their albedo.
#pragma once

#include "lpv/grid.hpp"

#include <optional>
#include <vector>

namespace lucerna {

class LpvGeometryVolume {
 public:
  LpvGeometryVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const LpvSettings& settings);

  void fill(const LpvInputs& inputs);
  const gl::Texture& potential() const { return *potential_; }
  /// Potential at the faces perpendicular to x, y, z; only with LpvPropagate::compute.
  const gl::BufferTexture& faces() const { return faces_; }
  /// Albedo A / s^2 of the surfels; only with several bounces.
  const gl::Texture& reflectance() const { return reflectance_; }
  std::size_t gpuBytes() const;

 private:
  using Maps = std::vector<const ReflectiveShadowMap::Outputs*>;
  bool canCount(const Maps& maps) const;
  void count(const Maps& maps, const LpvInputs& inputs);
  void draw(const Maps& maps, const LpvInputs& inputs);
  void draw(const ReflectiveShadowMap::Outputs& map, const LpvInputs& inputs, const gl::Framebuffer& target);
  void mergeView();

  LpvSettings settings_;
  bool haveClearTexture_;
  const gl::Program* fill_ = nullptr;
  const gl::Program* mergeViews_ = nullptr;  ///< only with several views
  const gl::Program* count_ = nullptr;  ///< only with 32-bit atomics
  const gl::Program* resolve_ = nullptr;  ///< only with integer atomics
  const gl::Program* averageFaces_ = nullptr;  ///< from the texture; only with LpvPropagate::compute
  const gl::Program* averageCountedFaces_ = nullptr;  ///< from the atomics' counts
  gl::VertexArray noAttributes_;
  std::optional<gl::Texture> potential_;
  gl::Texture reflectance_;
  gl::Framebuffer target_;
  gl::Texture viewPotential_, viewReflectance_;  ///< of one view, before it is merged
  gl::Framebuffer viewTarget_;
  gl::BufferTexture counts_;  ///< the potential as counted by atomics
  gl::BufferTexture faces_;
};

}  // namespace lucerna
