#include "lpv/propagation.hpp"

#include "gl/draw.hpp"
#include "gl/pass.hpp"
#include "gl/chunks.hpp"

#include <vector>

namespace lucerna {

namespace {

// Storage blocks of lpv/propagate.comp.
constexpr GLuint kNextBuffer = 1, kSumBuffer = 2, kBricksBuffer = 4;
constexpr int kBrick = 4;  // cells per side, as in lpv/bricks.glsl
constexpr std::array<GLuint, 4> kNoBricks{64, 0, 1, 0};  // groups of the dispatch, row by row, and their count

bool isFirstBlocked(const LpvSettings& settings) { return settings.isBlocked() && settings.deviations.blockFirstStep; }

void setAmplifier(const LpvSettings& settings, std::initializer_list<const gl::Program*> programs) {
  if (!settings.deviations.fourPiKernel) return;
  for (const gl::Program* program : programs)
    if (program) program->set("amplifier", settings.amplifier);
}

}  // namespace

// ---------------------------------------------------------------------------------------------- compute

LpvComputePropagation::LpvComputePropagation(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                             const LpvSettings& settings, bool haveCounts)
    : settings_(settings) {
  const LpvGrid grid(settings);
  size_ = grid.size;
  const auto load = [&](const std::string& name, bool first, bool blocked) {
    return &programs.loadCompute(
        name, "lpv/propagate.comp",
        gl::with(gl::with(grid.flags,
                          {{"FIRST", first}, {"WITH_INJECTED", !settings.deviations.fewerSteps}, {"BLOCKED", blocked}}),
                 grid.kernel));
  };
  begin_ = &programs.loadCompute("lpv begin", "lpv/begin.comp", grid.flags);
  markBricks_ = &programs.loadCompute("lpv mark bricks", "lpv/mark_bricks.comp", grid.flags);
  listBricks_ = &programs.loadCompute("lpv list bricks", "lpv/list_bricks.comp", grid.flags);
  first_ = load("lpv propagate first", true, isFirstBlocked(settings));
  if (settings.steps() > 1) further_ = load("lpv propagate", false, settings.isBlocked());
  const auto buffer = [&](const char* name) {
    return lpvBuffer(capabilities, name, gl::Format::rgba32f, grid.volumeBytes());
  };
  if (!haveCounts) wavefronts_[0] = buffer("lpv wavefront even");
  wavefronts_[1] = buffer("lpv wavefront odd");
  sums_ = buffer("lpv sums");
  if (settings.joins()) farSums_ = buffer("lpv far sums");
  const int bricksOfAxis = (settings.cascades.cells + kBrick - 1) / kBrick;
  brickCount_ = bricksOfAxis * bricksOfAxis * bricksOfAxis * settings.cascades.cascades;
  bricks_ = gl::Buffer("lpv bricks", sizeof kNoBricks + 3 * static_cast<std::size_t>(brickCount_) * sizeof(GLuint),
                       nullptr, gl::Usage::dynamicCopy);
}

void LpvComputePropagation::run(const LpvVolume& source, LpvInjection& injection, const LpvGeometryVolume* geometry) {
  const std::array<gl::BufferTexture*, 2> wavefronts{injection.counts() ? injection.counts() : &wavefronts_[0],
                                                     &wavefronts_[1]};
  const bool begun = injection.takeCounts();  // the second step overwrites them
  setAmplifier(settings_, {first_, further_});
  // Cells without a dispatched brick are never written, so they must be dark.
  wavefronts[1]->clear();
  sums_.clear();
  if (settings_.joins()) farSums_.clear();
  bricks_.clear();
  bricks_.upload(0, sizeof kNoBricks, kNoBricks.data());
  bricks_.bindStorage(kBricksBuffer);
  if (!begun) {
    const gl::ComputePass pass("lpv begin", gl::Barrier::textureFetch);
    begin_->use();
    for (GLuint channel = 0; channel < 3; ++channel) source[channel].bind(channel);
    wavefronts[0]->buffer().bindStorage(kLpvWavefrontBuffer);
    pass.dispatch(size_, kLpvGroup);
  }
  {
    const gl::ComputePass pass("lpv mark bricks", gl::Barrier::storage);
    markBricks_->use();
    markBricks_->set("everywhere", settings_.everyBrick ? 1 : 0);
    wavefronts[0]->bind(0);
    pass.dispatch(size_, kLpvGroup);
  }
  if (geometry) geometry->faces().bind(1);
  for (int step = 0; step < settings_.steps(); ++step) {
    {
      const gl::ComputePass pass("lpv list bricks", gl::Barrier::storage | gl::Barrier::command);
      listBricks_->use();
      pass.dispatch(glm::ivec3(brickCount_, 1, 1), glm::ivec3(64, 1, 1));
    }
    gl::Submission::add(kIterationsOfPropagation * size_.x * size_.y * size_.z);
    const gl::ComputePass pass("lpv propagate", gl::Barrier::textureFetch | gl::Barrier::storage);
    (step == 0 ? first_ : further_)->use();
    const gl::BufferTexture& sums = settings_.joins() && step >= settings_.handOver ? farSums_ : sums_;
    wavefronts[static_cast<std::size_t>(step % 2)]->bind(0);
    sums.bind(2);
    wavefronts[static_cast<std::size_t>((step + 1) % 2)]->buffer().bindStorage(kNextBuffer);
    sums.buffer().bindStorage(kSumBuffer);
    pass.dispatchIndirect(bricks_);
  }
}

void LpvComputePropagation::bindSums() const {
  sums_.bind(0);
  if (settings_.joins()) farSums_.bind(3);
}

std::size_t LpvComputePropagation::gpuBytes() const {
  return wavefronts_[0].bytes() + wavefronts_[1].bytes() + sums_.bytes() + farSums_.bytes() + bricks_.bytes();
}

// ---------------------------------------------------------------------------------------------- layered

LpvLayeredPropagation::LpvLayeredPropagation(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                             const LpvSettings& settings)
    : settings_(settings), haveClearTexture_(capabilities.clearTexture), noAttributes_("lpv cells") {
  const LpvGrid grid(settings);
  const auto load = [&](bool blocked, bool withInjected) {
    return &programs.loadRaster("lpv propagate layered", "lpv/propagate_layered.vert", "lpv/propagate_layered.frag",
                                gl::with({{"GRID_FULL_FLOAT", settings.storage == LpvSettings::Storage::full},
                                          {"BLOCKED", blocked},
                                          {"BEGINS_WITH_INJECTED", withInjected}},
                                         grid.kernel),
                                "lpv/propagate_layered.geom");
  };
  first_ = load(isFirstBlocked(settings), !settings.deviations.fewerSteps);
  if (settings.steps() > 1) further_ = load(settings.isBlocked(), false);
  sum_ = lpvVolume("sum", grid.summed, grid.size, kLpvSampling);
  if (settings.joins()) farSum_ = lpvVolume("far sum", grid.summed, grid.size, kLpvSampling);
  for (std::size_t i = 0; i < (settings.steps() > 1 ? 2u : 1u); ++i) {
    wavefronts_[i] = lpvVolume(i == 0 ? "wavefront even" : "wavefront odd", grid.summed, grid.size, kLpvSampling);
    for (std::size_t far = 0; far < (settings.joins() ? 2u : 1u); ++far) {
      const LpvVolume& wavefront = wavefronts_[i];
      const LpvVolume& sum = far ? farSum_ : sum_;
      const std::array<const gl::Texture*, 6> targets{&wavefront[0], &wavefront[1], &wavefront[2],
                                                      &sum[0],       &sum[1],       &sum[2]};
      targets_[i][far] = gl::Framebuffer("lpv propagate layered", targets);
    }
  }
}

void LpvLayeredPropagation::run(const LpvVolume& source, const LpvGeometryVolume* geometry) {
  setAmplifier(settings_, {first_, further_});
  std::vector<const gl::Texture*> sums{&sum_[0], &sum_[1], &sum_[2]};
  if (settings_.joins()) sums.insert(sums.end(), {&farSum_[0], &farSum_[1], &farSum_[2]});
  gl::clearToZero(sums, haveClearTexture_);
  const int cells = settings_.cascades.cells;
  const LpvVolume* wavefront = &source;
  for (int step = 0; step < settings_.steps(); ++step) {
    const auto next = static_cast<std::size_t>(step % 2);
    const bool far = settings_.joins() && step >= settings_.handOver;
    gl::RasterState state;
    state.blend = gl::Blend::add;
    state.firstBlended = 3;
    gl::Submission::add(kIterationsOfPropagation * cells * cells * cells * settings_.cascades.cascades);
    const gl::RasterPass pass("lpv propagate layered", targets_[next][far ? 1 : 0], state);
    const gl::Program& program = step == 0 ? *first_ : *further_;
    program.use();
    for (GLuint channel = 0; channel < 3; ++channel) (*wavefront)[channel].bind(channel);
    if (geometry) geometry->potential().bind(3);
    noAttributes_.bind();
    for (int k = 0; k < settings_.cascades.cascades; ++k) {
      program.set("cascade", k);
      program.set("firstLayer", k * cells);
      program.set("cells", cells);
      gl::drawPoints(cells * cells * cells);
    }
    wavefront = &wavefronts_[next];
  }
}

void LpvLayeredPropagation::bindSums() const {
  for (GLuint channel = 0; channel < 3; ++channel) {
    sum_[channel].bind(channel);
    if (settings_.joins()) farSum_[channel].bind(3 + channel);
  }
}

std::size_t LpvLayeredPropagation::gpuBytes() const {
  return bytesOf(sum_) + bytesOf(farSum_) + bytesOf(wavefronts_[0]) + bytesOf(wavefronts_[1]);
}

}  // namespace lucerna
