// Injection: each texel of the reflective shadow maps is a virtual point light, a cosine lobe in the cell it lies in.
#pragma once

#include "lpv/grid.hpp"

namespace lucerna {

class LpvInjection {
 public:
  LpvInjection(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const LpvSettings& settings);

  /// Clears, then adds every virtual point light of all maps.
  void inject(const LpvInputs& inputs);
  const LpvVolume& volume() const { return volume_; }

  /// The atomic counts as floats, the three channels one after the other; nullptr with LpvFill::layered.
  gl::BufferTexture* counts() { return counts_.bytes() > 0 ? &counts_ : nullptr; }
  /// Whether the counts hold the injected light. The caller may overwrite them from here on.
  bool takeCounts() { return std::exchange(countsHold_, false); }
  std::size_t gpuBytes() const;

 private:
  float fluxScale(const ReflectiveShadowMap::Outputs& rsm) const;
  void drawLights(const LpvInputs& inputs);
  void countLights(const LpvInputs& inputs);

  LpvSettings settings_;
  bool haveClearTexture_;
  bool countsHold_ = false;
  const gl::Program* inject_ = nullptr;
  const gl::Program* resolve_ = nullptr;  ///< only with integer or half-float atomics
  LpvVolume volume_;
  gl::VertexArray noAttributes_;  ///< like the target, only with LpvFill::layered
  gl::Framebuffer target_;
  gl::BufferTexture counts_;
  LpvVolume halves_;  ///< target of half-float atomics
};

}  // namespace lucerna
