#include "lpv/injection.hpp"

#include "base/error.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"

#include <array>

namespace lucerna {

LpvInjection::LpvInjection(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                           const LpvSettings& settings)
    : settings_(settings), haveClearTexture_(capabilities.clearTexture) {
  const LpvGrid grid(settings);
  volume_ = lpvVolume("injected", grid.summed, grid.size, kLpvSampling);
  if (settings.fill == LpvFill::layered) {
    const bool full = settings.storage == LpvSettings::Storage::full;
    inject_ =
        &programs.loadRaster("lpv inject", "lpv/inject.vert", "lpv/inject.frag",
                             gl::with({{"GRID_FULL_FLOAT", full}, {"REFLECTS", 0}}, grid.lights), "lpv/inject.geom");
    const std::array<const gl::Texture*, 3> targets{&volume_[0], &volume_[1], &volume_[2]};
    target_ = gl::Framebuffer("lpv inject", targets);
    noAttributes_ = gl::VertexArray("lpv points");
    return;
  }
  if (settings.fill == LpvFill::atomic && !capabilities.shaderAtomicFloat && !capabilities.shaderAtomicFp16Vector)
    throwMissingCapability(
        "lpv.fill=atomic: the driver has neither NV_shader_atomic_fp16_vector nor NV_shader_atomic_float; "
        "lpv.fill=fixed needs no extension");
  const gl::ShaderFlags flags = gl::with(gl::with(grid.flags, countFlags(settings, capabilities)), grid.lights);
  inject_ = &programs.loadCompute("lpv inject by atomics", "lpv/inject_atomic.comp",
                                  gl::with(flags, {{"TILE", settings.tile}}));
  const bool halves = countsHalfFloats(settings, capabilities);
  if (settings.fill == LpvFill::fixed || halves)
    resolve_ = &programs.loadCompute("lpv resolve", "lpv/resolve.comp", flags);
  if (halves) halves_ = lpvVolume("count", gl::Format::rgba16f, grid.size, {});
  counts_ = lpvBuffer(capabilities, "lpv wavefront even", gl::Format::rgba32f, grid.volumeBytes());
}

float LpvInjection::fluxScale(const ReflectiveShadowMap::Outputs& rsm) const {
  // Without units each light counts as E * albedo, whatever its texel's area.
  return settings_.deviations.fluxUnits ? 1.0f / rsm.texelArea : 1.0f;
}

void LpvInjection::inject(const LpvInputs& inputs) {
  if (settings_.fill == LpvFill::layered) drawLights(inputs);
  else countLights(inputs);
}

void LpvInjection::drawLights(const LpvInputs& inputs) {
  const std::array<const gl::Texture*, 3> targets{&volume_[0], &volume_[1], &volume_[2]};
  gl::clearToZero(targets, haveClearTexture_);
  gl::RasterState state;
  state.blend = gl::Blend::add;
  const gl::RasterPass pass("lpv inject", target_, state);
  inject_->use();
  noAttributes_.bind();
  for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms) {
    inject_->set("fluxScale", fluxScale(rsm));
    rsm.bind();
    gl::drawPoints(rsm.texelCount());
  }
}

void LpvInjection::countLights(const LpvInputs& inputs) {
  // Upper bound of a stored coefficient: all light of all maps, reflected by white, in one cell of the finest cascade.
  const double finest = inputs.cascades.front().cellSize;
  const double unit = inputs.referenceIrradiance * (settings_.deviations.fluxUnits ? 1.0 : finest * finest);
  double flux = 0.0;
  for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms)
    flux += rsm.largestFlux * static_cast<double>(fluxScale(rsm));
  const double largest = 1.0233267079464885 / 3.141592653589793 * flux / unit;  // with only the sun, E_ref cancels
  const float scale = fixedScale(settings_, largest);
  const bool halves = halves_[0].id() != 0;
  counts_.clear();
  if (halves) {
    const std::array<const gl::Texture*, 3> targets{&halves_[0], &halves_[1], &halves_[2]};
    gl::clearToZero(targets, haveClearTexture_);
  }
  {
    // Counts that are not resolved are read as the first wavefront.
    const gl::Barrier read = halves || !resolve_ ? gl::Barrier::textureFetch : gl::Barrier::none;
    const gl::ComputePass pass("lpv inject by atomics", gl::Barrier::storage | read);
    inject_->use();
    inject_->set("fixedScale", scale);
    counts_.buffer().bindStorage(kLpvWavefrontBuffer);
    if (halves)
      for (GLuint channel = 0; channel < 3; ++channel) halves_[channel].bindImage(channel, gl::Access::readWrite);
    for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms) {  // atomics need no order
      inject_->set("fluxScale", fluxScale(rsm));
      rsm.bind();
      pass.dispatch(rsm.position.size(), kLpvGroup * glm::ivec3(settings_.tile, settings_.tile, 1));
    }
  }
  if (halves) {
    const gl::ComputePass pass("lpv resolve", gl::Barrier::textureFetch);
    resolve_->use();
    for (GLuint channel = 0; channel < 3; ++channel) halves_[channel].bind(channel);
    counts_.buffer().bindStorage(kLpvWavefrontBuffer);
    pass.dispatch(volume_[0].size(), kLpvGroup);
  } else if (resolve_) {
    resolveCounts(*resolve_, counts_, volume_[0].size(), 3, scale);
  }
  for (std::size_t channel = 0; channel < 3; ++channel)
    volume_[channel].copyFrom(counts_.buffer(), channel * volume_[channel].bytes());
  countsHold_ = true;
}

std::size_t LpvInjection::gpuBytes() const { return bytesOf(volume_) + bytesOf(halves_) + counts_.bytes(); }

}  // namespace lucerna
