// Grids of a light propagation volume: their shape, textures and buffers, and the settings common to all programs.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "lpv/settings.hpp"

#include <string>

namespace lucerna {

constexpr glm::ivec3 kLpvGroup{8, 8, 1};  // the fastest of those tried on llvmpipe, see docs/measurements/lpv.md
constexpr GLuint kLpvWavefrontBuffer = 0;  // the fastest tried on llvmpipe, see docs/measurements/lpv.md
constexpr std::size_t kLpvCellBytes = 16;  // four coefficients in a buffer
constexpr gl::Sampling kLpvSampling{gl::Filter::linear, gl::Filter::linear, gl::Wrap::border};  // dark outside the grid

struct LpvGrid {
  explicit LpvGrid(const LpvSettings& settings);

  glm::ivec3 size;  ///< cells of all cascades, stacked along z
  glm::ivec3 corners;  ///< the same for their corners
  gl::Format summed;  ///< format of sums: 32-bit floats, as 16-bit sums stop growing after about 2000 additions
  gl::ShaderFlags flags;  ///< of compute programs
  gl::ShaderFlags kernel;  ///< deviations of the propagation kernel
  gl::ShaderFlags lights;  ///< deviations of the injection

  std::size_t volumeBytes() const;  ///< three channels in a buffer
};

std::size_t texelCount(const glm::ivec3& size);
LpvVolume lpvVolume(const char* name, gl::Format format, const glm::ivec3& size, const gl::Sampling& sampling);
std::size_t bytesOf(const LpvVolume& volume);  ///< 0 if never allocated
/// Throws Error(missingCapability) if the driver's texture buffers are too small.
gl::BufferTexture lpvBuffer(const gl::Capabilities& capabilities, const std::string& name, gl::Format format,
                            std::size_t bytes);

/// Whether atomics add four half floats at once. 16-bit sums stop growing, so this is the last resort.
bool countsHalfFloats(const LpvSettings& settings, const gl::Capabilities& capabilities);
/// Flags of lpv/resolve.comp and of the programs whose counts it reads.
gl::ShaderFlags countFlags(const LpvSettings& settings, const gl::Capabilities& capabilities);
/// Counts per unit for LpvFill::fixed: 2^30 for the largest possible sum, so that the rounding of a million lights
/// cannot overflow 31 bits either. Other fills: 1.
float fixedScale(const LpvSettings& settings, double largest);
/// Converts integers to floats in place. `resolve`: lpv/resolve.comp.
void resolveCounts(const gl::Program& resolve, const gl::BufferTexture& counts, const glm::ivec3& size, int channels,
                   float scale);

}  // namespace lucerna
