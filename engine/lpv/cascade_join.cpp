#include "lpv/cascade_join.hpp"

#include "gl/pass.hpp"

namespace lucerna {

namespace {

// Storage blocks of lpv/finish.comp, lpv/balance.comp and lpv/join.comp.
constexpr GLuint kReceivedBuffer = 0, kResultBuffer = 1, kBalancedBuffer = 2, kBalancesBuffer = 3;

}  // namespace

LpvCascadeJoin::LpvCascadeJoin(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                               const LpvSettings& settings)
    : cells_(settings.cascades.cells), cascades_(settings.cascades.cascades) {
  const LpvGrid grid(settings);
  const bool full = settings.storage == LpvSettings::Storage::full;
  result_ = lpvVolume("result", full ? gl::Format::rgba32f : gl::Format::rgba16f, grid.size, kLpvSampling);
  texels_ = gl::Buffer("lpv result texels", 3 * result_[0].bytes(), nullptr, gl::Usage::dynamicCopy);
  const gl::ShaderFlags from = gl::with(
      grid.flags, {{"FROM_BUFFER", settings.propagate == LpvPropagate::compute}, {"JOINED", settings.joins()}});
  if (!settings.joins()) {
    finish_ = &programs.loadCompute("lpv finish", "lpv/finish.comp", from);
    return;
  }
  balance_ = &programs.loadCompute("lpv balance", "lpv/balance.comp", from);
  join_ = &programs.loadCompute("lpv join", "lpv/join.comp", gl::with(from, {{"HAS_COARSER", 1}}));
  joinCoarsest_ = &programs.loadCompute("lpv join coarsest", "lpv/join.comp", gl::with(from, {{"HAS_COARSER", 0}}));
  received_ = lpvBuffer(capabilities, "lpv received", gl::Format::rgba32f, grid.volumeBytes());
  balances_ = lpvBuffer(capabilities, "lpv balances", gl::Format::r32f,
                        texelCount(glm::ivec3((cells_ + 1) / 2)) * sizeof(float));
  balanced_ = lpvBuffer(capabilities, "lpv balanced", gl::Format::r32f, texelCount(grid.size) * sizeof(float));
}

void LpvCascadeJoin::finish() {
  if (!finish_) return;
  {
    const gl::ComputePass pass("lpv finish", gl::Barrier::storage);
    finish_->use();
    texels_.bindStorage(kResultBuffer);
    pass.dispatch(result_[0].size(), kLpvGroup);
  }
  copyResult();
}

void LpvCascadeJoin::join() {
  if (!join_) return;
  balances_.bind(7);
  for (int k = cascades_ - 1; k >= 0; --k) {
    const bool coarsest = k + 1 == cascades_;
    if (!coarsest) {
      const gl::ComputePass pass("lpv balance", gl::Barrier::storage | gl::Barrier::textureFetch);
      balance_->use();
      balance_->set("cascade", k);
      balanced_.bind(6);
      balances_.buffer().bindStorage(kBalancesBuffer);
      pass.dispatch(glm::ivec3((cells_ + 1) / 2), kLpvGroup);
    }
    const gl::ComputePass pass("lpv join", gl::Barrier::storage | gl::Barrier::textureFetch);
    const gl::Program& program = coarsest ? *joinCoarsest_ : *join_;
    program.use();
    program.set("cascade", k);
    received_.bind(6);
    received_.buffer().bindStorage(kReceivedBuffer);
    texels_.bindStorage(kResultBuffer);
    balanced_.buffer().bindStorage(kBalancedBuffer);
    pass.dispatch(glm::ivec3(cells_), kLpvGroup);
  }
  copyResult();
}

// Copies the result from the buffer to the filtered textures: see lpv/result.glsl.
void LpvCascadeJoin::copyResult() {
  for (std::size_t channel = 0; channel < 3; ++channel)
    result_[channel].copyFrom(texels_, channel * result_[channel].bytes());
}

std::size_t LpvCascadeJoin::gpuBytes() const {
  return received_.bytes() + balances_.bytes() + balanced_.bytes() + texels_.bytes() + bytesOf(result_);
}

}  // namespace lucerna
