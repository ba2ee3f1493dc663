// From the sums of propagation to what is looked up: stored as the result, or before that joined over the cascades, so
// that a finer one has the coarser one's light too.
#pragma once

#include "lpv/grid.hpp"

namespace lucerna {

class LpvCascadeJoin {
 public:
  LpvCascadeJoin(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const LpvSettings& settings);

  // Both read the sums where bindSums() has put them.
  void finish();  ///< no effect where cascades are joined
  void join();  ///< no effect where they are not
  const LpvVolume& result() const { return result_; }
  std::size_t gpuBytes() const;

 private:
  void copyResult();

  int cells_, cascades_;
  const gl::Program* finish_ = nullptr;  ///< only where nothing is joined
  const gl::Program* balance_ = nullptr;  ///< the others only where cascades are joined
  const gl::Program* join_ = nullptr;
  const gl::Program* joinCoarsest_ = nullptr;
  gl::BufferTexture received_;  ///< light from the coarser cascades for the finer one
  gl::BufferTexture balances_;  ///< between one cascade and the next coarser, at half its resolution
  gl::BufferTexture balanced_;  ///< band 0 of the first steps' light as joined
  gl::Buffer texels_;  ///< the result before it is copied to the textures
  LpvVolume result_;  ///< read by the lookup
};

}  // namespace lucerna
