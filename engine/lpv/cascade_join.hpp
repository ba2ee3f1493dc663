// Turns the sums of propagation into the volume that is looked up: stored directly, or first joined over the cascades,
// so that a finer cascade also holds the coarser one's light.
#pragma once

#include "lpv/grid.hpp"

namespace lucerna {

class LpvCascadeJoin {
 public:
  LpvCascadeJoin(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const LpvSettings& settings);

  // Both read the sums bound by bindSums().
  void finish();  ///< no effect if cascades are joined
  void join();  ///< no effect if they are not
  const LpvVolume& result() const { return result_; }
  std::size_t gpuBytes() const;

 private:
  void copyResult();

  int cells_, cascades_;
  const gl::Program* finish_ = nullptr;  ///< only without joining
  const gl::Program* balance_ = nullptr;  ///< the others only with joined cascades
  const gl::Program* join_ = nullptr;
  const gl::Program* joinCoarsest_ = nullptr;
  gl::BufferTexture received_;  ///< light from the coarser cascades for the finer one
  gl::BufferTexture balances_;  ///< between one cascade and the next coarser, at half its resolution
  gl::BufferTexture balanced_;  ///< band 0 of the first steps' light, after joining
  gl::Buffer texels_;  ///< the result before it is copied to the textures
  LpvVolume result_;  ///< read by the lookup
};

}  // namespace lucerna
