#include "lpv/grid.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"

#include <array>

namespace lucerna {

LpvGrid::LpvGrid(const LpvSettings& settings) {
  const CascadeSettings& c = settings.cascades;
  const LpvSettings::Deviations& deviations = settings.deviations;
  size = {c.cells, c.cells, c.cells * c.cascades};
  corners = {c.cells + 1, c.cells + 1, (c.cells + 1) * c.cascades};
  summed = deviations.halfGrids ? gl::Format::rgba16f : gl::Format::rgba32f;
  flags = {{"GRID_FULL_FLOAT", settings.storage == LpvSettings::Storage::full},
           {"GROUP_X", kLpvGroup.x},
           {"GROUP_Y", kLpvGroup.y}};
  kernel = {{"FACE_KERNEL", deviations.kernel()},
            {"SIDE_DIRECTIONS", deviations.sideDirections},
            {"SIDE_SOLID_ANGLE", deviations.sideSolidAngle},
            {"FOUR_PI_KERNEL", deviations.fourPiKernel},
            {"BLOCKING_DIRECTION", deviations.blockingDirection}};
  lights = {{"FLUX_UNITS", deviations.fluxUnits}, {"LOWEST_CELL", deviations.firstCell ? 1 : 0}};
}

std::size_t LpvGrid::volumeBytes() const { return 3 * texelCount(size) * kLpvCellBytes; }

std::size_t texelCount(const glm::ivec3& size) {
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
}

LpvVolume lpvVolume(const char* name, gl::Format format, const glm::ivec3& size, const gl::Sampling& sampling) {
  constexpr std::array<const char*, 3> kChannels{"red", "green", "blue"};
  LpvVolume volume;
  for (std::size_t channel = 0; channel < 3; ++channel)
    volume[channel] = gl::Texture(fmt::format("lpv {} {}", name, kChannels[channel]), format, size, sampling);
  return volume;
}

std::size_t bytesOf(const LpvVolume& volume) {
  std::size_t bytes = 0;
  for (const gl::Texture& texture : volume)
    if (texture.id()) bytes += texture.bytes();
  return bytes;
}

gl::BufferTexture lpvBuffer(const gl::Capabilities& capabilities, const std::string& name, gl::Format format,
                            std::size_t bytes) {
  if (bytes / gl::bytesPerTexel(format) > static_cast<std::size_t>(capabilities.maxTextureBufferSize))
    throwMissingCapability(
        "{}: {} bytes; the largest texture buffer of the driver has {} texels (GL_MAX_TEXTURE_BUFFER_SIZE)", name,
        bytes, capabilities.maxTextureBufferSize);
  return gl::BufferTexture(name, format, bytes, nullptr, gl::Usage::dynamicCopy);
}

bool countsHalfFloats(const LpvSettings& settings, const gl::Capabilities& capabilities) {
  return settings.fill == LpvFill::atomic && !capabilities.shaderAtomicFloat;
}

gl::ShaderFlags countFlags(const LpvSettings& settings, const gl::Capabilities& capabilities) {
  const bool halves = countsHalfFloats(settings, capabilities), fixed = settings.fill == LpvFill::fixed;
  return {{"FILL_FIXED", fixed}, {"FILL_FLOAT", !fixed && !halves}, {"FILL_HALF", halves}};
}

float fixedScale(const LpvSettings& settings, double largest) {
  return settings.fill == LpvFill::fixed && largest > 0.0 ? static_cast<float>(1073741824.0 / largest) : 1.0f;
}

void resolveCounts(const gl::Program& resolve, const gl::BufferTexture& counts, const glm::ivec3& size, int channels,
                   float scale) {
  const gl::ComputePass pass("lpv resolve", gl::Barrier::textureFetch);
  resolve.use();
  resolve.set("fixedScale", scale);
  resolve.set("size", size);
  resolve.set("channels", channels);
  counts.buffer().bindStorage(kLpvWavefrontBuffer);
  pass.dispatch(size, kLpvGroup);
}

}  // namespace lucerna
