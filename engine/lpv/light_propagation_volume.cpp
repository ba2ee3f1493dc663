#include "lpv/light_propagation_volume.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna {

namespace {

constexpr GLuint kConstantsBinding = 1;
constexpr glm::ivec3 kGroup{8, 8, 1};  // the fastest of those tried on llvmpipe, see README.md
constexpr std::array<const char*, 3> kChannels{"red", "green", "blue"};

}  // namespace

std::string_view nameOf(LpvFill fill) {
  return fill == LpvFill::layered ? "layered" : fill == LpvFill::atomic ? "atomic" : "fixed";
}

std::string_view nameOf(LpvPropagate propagate) { return propagate == LpvPropagate::compute ? "compute" : "layered"; }

LightPropagationVolume::LightPropagationVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                               const Settings& settings)
    : settings_(settings), haveClearTexture_(capabilities.clearTexture) {
  const CascadeSettings& c = settings.cascades;
  const Deviations& deviations = settings.deviations;
  CHECK(c.cascades >= 1 && c.cascades <= LPV_MAX_CASCADES, "cascades = {}", c.cascades);
  CHECK(c.cells >= 1 && (c.cells + 1) * c.cascades <= capabilities.max3dTextureSize, "cells = {}", c.cells);
  const bool full = settings.storage == Storage::full;
  const bool layered = settings.propagate == LpvPropagate::layered;
  const GLenum format = full ? GL_RGBA32F : GL_RGBA16F;
  const glm::ivec3 size(c.cells, c.cells, c.cells * c.cascades);
  const gl::Sampling sampling{GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_BORDER};  // outside the grid is dark
  steps_ = std::max(settings.iterations - (deviations.fewerSteps ? 1 : 0), 0);
  const bool joined = c.cascades > 1 && !deviations.sumCascades && !deviations.unjoined;
  if (settings_.handOver == 0) settings_.handOver = handOverStep(steps_, c.ratio);

  constants_ = gl::Buffer("lpv constants", sizeof(shared::LpvConstants), nullptr, GL_DYNAMIC_DRAW);
  noAttributes_ = gl::VertexArray("lpv points");
  const auto allocate = [](Volume& volume, const char* name, GLenum texelFormat, glm::ivec3 texels, const gl::Sampling& how) {
    for (std::size_t channel = 0; channel < 3; ++channel)
      volume[channel] = gl::Texture(fmt::format("lpv {} {}", name, kChannels[channel]), texelFormat, texels, how);
  };
  const gl::ShaderFlags group{{"LPV_FULL_FLOAT", full}, {"GROUP_X", kGroup.x}, {"GROUP_Y", kGroup.y}};
  const auto with = [](gl::ShaderFlags flags, const gl::ShaderFlags& more) {
    flags.insert(flags.end(), more.begin(), more.end());
    return flags;
  };

  const gl::ShaderFlags vpl{{"FLUX_UNITS", deviations.fluxUnits}, {"LOWEST_CELL", deviations.firstCell ? 1 : 0}};

  // Injection. 32-bit floats for what is summed: 16-bit sums stop growing after some 2000 equal additions.
  allocate(injected_, "injected", GL_RGBA32F, size, sampling);
  if (settings.fill == LpvFill::layered) {
    inject_ = &programs.loadRaster("lpv inject", "lpv/inject.vert", "lpv/inject.frag",
                                   with({{"LPV_FULL_FLOAT", full}}, vpl), "lpv/inject.geom");
    const std::array<const gl::Texture*, 3> targets{&injected_[0], &injected_[1], &injected_[2]};
    injectTarget_ = gl::Framebuffer("lpv inject", targets);
  } else {
    const bool fixed = settings.fill == LpvFill::fixed;
    if (!fixed && !capabilities.shaderAtomicFloat && !capabilities.shaderAtomicFp16Vector)
      throwMissingCapability("lpv.fill=atomic: the driver has neither NV_shader_atomic_fp16_vector nor NV_shader_atomic_float; "
                             "lpv.fill=fixed needs no extension");
    fillsHalfVectors_ = !fixed && !capabilities.shaderAtomicFloat;  // 16-bit sums stop growing: only where there is no other
    const gl::ShaderFlags fill{{"FILL_FIXED", fixed}, {"FILL_FLOAT", !fixed && !fillsHalfVectors_}, {"FILL_HALF", fillsHalfVectors_}};
    inject_ = &programs.loadCompute("lpv inject by atomics", "lpv/inject_atomic.comp", with(with(group, fill), vpl));
    resolve_ = &programs.loadCompute("lpv resolve", "lpv/resolve.comp", with(with(group, fill), vpl));
    allocate(counts_, "count", fixed ? GL_R32I : fillsHalfVectors_ ? GL_RGBA16F : GL_R32F,
             glm::ivec3(fillsHalfVectors_ ? size.x : 4 * size.x, size.y, size.z), {});
  }

  const bool blocked = settings.blocking && (steps_ > 1 || (steps_ == 1 && deviations.blockFirstStep));  // the first step is not, by itself
  if (blocked) {
    fillGeometryVolume_ = &programs.loadRaster("lpv geometry volume", "lpv/inject.vert", "lpv/geometry_volume.frag",
                                               {{"LPV_FULL_FLOAT", full}, {"TRUNCATE", deviations.truncate}, {"SURFEL_AREA", deviations.surfelArea},
                                                {"LOWEST_CELL", deviations.firstCell ? 1 : 0}},
                                               "lpv/geometry_volume.geom");
    const glm::ivec3 corners(c.cells + 1, c.cells + 1, (c.cells + 1) * c.cascades);
    geometryVolume_.emplace("lpv geometry volume", static_cast<GLenum>(GL_RGBA32F), corners, sampling);
    const std::array<const gl::Texture*, 1> target{&*geometryVolume_};
    geometryTarget_ = gl::Framebuffer("lpv geometry volume", target);
    if (!layered) {
      averageFaces_ = &programs.loadCompute("lpv geometry faces", "lpv/geometry_faces.comp", group);
      faces_.emplace();
      for (std::size_t axis = 0; axis < 3; ++axis)
        (*faces_)[axis] = gl::Texture(fmt::format("lpv geometry faces {}", "xyz"[axis]), format, corners);
    }
  }

  if (steps_ == 0) return;
  const gl::ShaderFlags kernel{{"SIDE_DIRECTIONS", deviations.sideDirections},
                               {"SIDE_SOLID_ANGLE", deviations.sideSolidAngle},
                               {"FOUR_PI_KERNEL", deviations.fourPiKernel},
                               {"BLOCKING_DIRECTION", deviations.blockingDirection}};
  const auto load = [&](const std::string& name, bool withBlocking, bool withInjected, bool begins) {
    if (layered)
      return &programs.loadRaster("lpv propagate layered", "lpv/propagate_layered.vert", "lpv/propagate_layered.frag",
                                  with({{"LPV_FULL_FLOAT", full}, {"BLOCKED", withBlocking}, {"BEGINS_WITH_INJECTED", withInjected}}, kernel),
                                  "lpv/propagate_layered.geom");
    return &programs.loadCompute(name, "lpv/propagate.comp",
                                 with(with(group, {{"BLOCKED", withBlocking}, {"FACE_KERNEL", deviations.kernel()},
                                                   {"BEGINS_WITH_INJECTED", withInjected}, {"BEGINS_SUM", begins}}), kernel));
  };
  propagateFirst_ = load("lpv propagate first", blocked && deviations.blockFirstStep, !deviations.fewerSteps, true);
  if (steps_ > 1) propagateFurther_ = load("lpv propagate", blocked, false, false);
  allocate(sum_, "sum", format, size, sampling);
  for (std::size_t i = 0; i < (steps_ > 1 ? 2u : 1u); ++i) allocate(fronts_[i], i == 0 ? "front even" : "front odd", format, size, sampling);
  if (joined && settings_.handOver < steps_) {
    propagateFar_ = load("lpv propagate far", blocked, false, true);
    balance_ = &programs.loadCompute("lpv balance", "lpv/balance.comp", group);
    join_ = &programs.loadCompute("lpv join", "lpv/join.comp", group);
    allocate(farSum_, "far sum", format, size, sampling);
    const int half = (c.cells + 1) / 2;
    balances_ = gl::Texture("lpv balances", GL_R32F, glm::ivec3(half), {GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE});
  }
  if (layered)
    for (std::size_t i = 0; i < (steps_ > 1 ? 2u : 1u); ++i)
      for (std::size_t far = 0; far < (join_ ? 2u : 1u); ++far) {
        Volume& front = fronts_[i];
        Volume& sum = far ? farSum_ : sum_;
        const std::array<const gl::Texture*, 6> targets{&front[0], &front[1], &front[2], &sum[0], &sum[1], &sum[2]};
        layeredTargets_[i][far] = gl::Framebuffer("lpv propagate layered", targets);
      }
}

gl::ShaderFlags LightPropagationVolume::lookupFlags(const Settings& settings) {
  return {{"LPV_FULL_FLOAT", settings.storage == Storage::full},
          {"FLUX_UNITS", settings.deviations.fluxUnits},
          {"UNWINDOWED", settings.deviations.unwindowed},
          {"SUM_CASCADES", settings.deviations.sumCascades}};
}

int LightPropagationVolume::handOverStep(int iterations, double ratio) {
  const double steps = ((1.33 * iterations - 0.33) / (ratio * ratio) + 0.33) / 1.33;
  return std::clamp(static_cast<int>(std::lround(steps)), 1, std::max(iterations, 1));
}

void LightPropagationVolume::join() {
  if (!join_) return;
  for (int k = settings_.cascades.cascades - 1; k >= 0; --k) {
    for (GLuint channel = 0; channel < 3; ++channel) {
      farSum_[channel].bind(channel);
      sum_[channel].bind(3 + channel);
    }
    if (k + 1 < settings_.cascades.cascades) {
      const gl::ComputePass pass("lpv balance", GL_TEXTURE_FETCH_BARRIER_BIT);
      balance_->use();
      balance_->set("cascade", k);
      balances_.bindImage(0, GL_WRITE_ONLY);
      pass.dispatch(balances_.size(), kGroup);
    }
    const gl::ComputePass pass("lpv join", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    join_->use();
    join_->set("cascade", k);
    balances_.bind(3);
    for (GLuint channel = 0; channel < 3; ++channel) {
      sum_[channel].bindImage(channel, GL_READ_WRITE);
      farSum_[channel].bindImage(3 + channel, GL_READ_WRITE);
    }
    pass.dispatch(glm::ivec3(settings_.cascades.cells), kGroup);
  }
}

void LightPropagationVolume::place(const Inputs& inputs) {
  CHECK(inputs.referenceIrradiance > 0.0f, "E_ref = {}", inputs.referenceIrradiance);
  CHECK(static_cast<int>(inputs.cascades.size()) == settings_.cascades.cascades, "{} cascades", inputs.cascades.size());
  shared::LpvConstants constants{};
  const int cells = settings_.cascades.cells;
  for (std::size_t k = 0; k < inputs.cascades.size(); ++k) {
    const Cascade& cascade = inputs.cascades[k];
    auto& target = constants.cascades[k];
    target.minimum = glm::vec3(cascade.minimum());
    if (settings_.deviations.truncate) {
      // int(x + 0.5) cells from the world's origin, wrong where negative; then whole world units, off the raster of cells.
      const glm::dvec3 inCells = (cascade.centre - 0.5 * cells * cascade.cellSize) / cascade.cellSize;
      target.minimum = glm::vec3(glm::trunc(glm::trunc(inCells + 0.5) * cascade.cellSize));
    }
    target.cellSize = static_cast<float>(cascade.cellSize);
    target.blendCentre = glm::vec3(cascade.centre);
    // Snapping moves the grid by up to two cells and the trilinear lookup needs half a cell more.
    const bool coarsest = k + 1 == inputs.cascades.size();
    target.blendHalf = coarsest ? 1e30f : static_cast<float>((0.5 * cells - 2.5 - settings_.lookupOffset) * cascade.cellSize);
    if (!coarsest && target.blendHalf <= 0.0f) target.blendHalf = 1e-30f;  // too few cells to blend: never used
  }
  constants.shape = {cells, settings_.cascades.cascades, 0, 0};
  constants.referenceIrradiance = inputs.referenceIrradiance;
  constants.blendBand = settings_.blendBand;
  constants.lookupOffset = settings_.lookupOffset;
  constants_.upload(0, sizeof constants, &constants);
  constants_.bind(GL_UNIFORM_BUFFER, kConstantsBinding);
}

float LightPropagationVolume::fluxScale(const ReflectiveShadowMap::Outputs& rsm) const {
  // Without units each light counts as E * albedo, whatever its texel's area.
  return settings_.deviations.fluxUnits ? 1.0f / rsm.texelArea : 1.0f;
}

void LightPropagationVolume::inject(const Inputs& inputs) {
  if (resolve_) return fillByAtomics(inputs);
  const std::array<const gl::Texture*, 3> targets{&injected_[0], &injected_[1], &injected_[2]};
  gl::clearToZero(targets, haveClearTexture_);
  gl::RasterState state;
  state.blend = gl::Blend::add;
  const gl::RasterPass pass("lpv inject", injectTarget_, state);
  inject_->use();
  noAttributes_.bind();
  for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms) {
    inject_->set("fluxScale", fluxScale(rsm));
    rsm.bind();
    glDrawArrays(GL_POINTS, 0, rsm.texelCount());
  }
}

void LightPropagationVolume::fillByAtomics(const Inputs& inputs) {
  // The largest stored coefficient that there can be: all light of all maps, reflected by white, in one cell of the finest cascade. 2^30 steps for
  // it, so that the rounding of a million lights cannot overflow 31 bits either.
  const double finest = inputs.cascades.front().cellSize;
  const double unit = inputs.referenceIrradiance * (settings_.deviations.fluxUnits ? 1.0 : finest * finest);
  double flux = 0.0;
  for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms) flux += rsm.largestFlux * static_cast<double>(fluxScale(rsm));
  const double largest = 1.0233267079464885 / 3.141592653589793 * flux / unit;  // of the sun alone E_ref cancels
  const auto fixedScale = static_cast<float>(settings_.fill == LpvFill::fixed && largest > 0.0 ? 1073741824.0 / largest : 1.0);
  const std::array<const gl::Texture*, 3> counts{&counts_[0], &counts_[1], &counts_[2]};
  gl::clearToZero(counts, haveClearTexture_);
  {
    const gl::ComputePass pass("lpv inject by atomics", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    inject_->use();
    inject_->set("fixedScale", fixedScale);
    for (GLuint channel = 0; channel < 3; ++channel) counts_[channel].bindImage(channel, GL_READ_WRITE);
    for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms) {  // atomics need no order among them
      inject_->set("fluxScale", fluxScale(rsm));
      rsm.bind();
      pass.dispatch(rsm.position.size(), kGroup);
    }
  }
  const gl::ComputePass pass("lpv resolve", GL_TEXTURE_FETCH_BARRIER_BIT);
  resolve_->set("fixedScale", fixedScale);
  resolve_->use();
  for (GLuint channel = 0; channel < 3; ++channel) {
    counts_[channel].bind(channel);
    injected_[channel].bindImage(channel, GL_WRITE_ONLY);
  }
  pass.dispatch(injected_[0].size(), kGroup);
}

void LightPropagationVolume::fillGeometryVolume(const Inputs& inputs) {
  if (!geometryVolume_) return;
  const std::array<const gl::Texture*, 1> target{&*geometryVolume_};
  gl::clearToZero(target, haveClearTexture_);
  {
    gl::RasterState state;
    state.blend = gl::Blend::add;
    const gl::RasterPass pass("lpv geometry volume", geometryTarget_, state);
    fillGeometryVolume_->use();
    noAttributes_.bind();
    for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms) {
      if (settings_.deviations.surfelArea) {
        const bool isSun = rsm.light == ReflectiveShadowMap::Light::sun;
        fillGeometryVolume_->set("lightPosition", inputs.lightPosition);
        fillGeometryVolume_->set("texelCount", isSun ? static_cast<float>(rsm.texelCount()) : 0.0f);
      }
      rsm.bind();
      glDrawArrays(GL_POINTS, 0, rsm.texelCount());
    }
  }
  if (!averageFaces_) return;
  const gl::ComputePass pass("lpv geometry faces", GL_TEXTURE_FETCH_BARRIER_BIT);
  averageFaces_->use();
  geometryVolume_->bind(0);
  for (GLuint axis = 0; axis < 3; ++axis) (*faces_)[axis].bindImage(axis, GL_WRITE_ONLY);
  pass.dispatch(geometryVolume_->size(), kGroup);
}

void LightPropagationVolume::propagate() {
  for (const gl::Program* program : {propagateFirst_, propagateFurther_, propagateFar_})
    if (program && settings_.deviations.fourPiKernel) program->set("amplifier", settings_.amplifier);
  if (settings_.propagate == LpvPropagate::layered) return propagateLayered();
  const Volume* front = &injected_;
  for (int step = 0; step < steps_; ++step) {
    const gl::ComputePass pass("lpv propagate", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    Volume& next = fronts_[static_cast<std::size_t>(step % 2)];
    const bool far = join_ && step >= settings_.handOver;
    (step == 0 ? propagateFirst_ : far && step == settings_.handOver ? propagateFar_ : propagateFurther_)->use();
    for (GLuint channel = 0; channel < 3; ++channel) {
      (*front)[channel].bind(channel);
      if (faces_) (*faces_)[channel].bind(3 + channel);
      next[channel].bindImage(channel, GL_WRITE_ONLY);
      (far ? farSum_ : sum_)[channel].bindImage(3 + channel, GL_READ_WRITE);
    }
    pass.dispatch(sum_[0].size(), kGroup);
    front = &next;
  }
}

// As published: one layered pass a step and cascade, blending adds to the sum.
void LightPropagationVolume::propagateLayered() {
  if (steps_ == 0) return;
  std::vector<const gl::Texture*> sums{&sum_[0], &sum_[1], &sum_[2]};
  if (join_) sums.insert(sums.end(), {&farSum_[0], &farSum_[1], &farSum_[2]});
  gl::clearToZero(sums, haveClearTexture_);
  const int cells = settings_.cascades.cells;
  const Volume* front = &injected_;
  for (int step = 0; step < steps_; ++step) {
    const auto next = static_cast<std::size_t>(step % 2);
    const bool far = join_ && step >= settings_.handOver;
    gl::RasterState state;
    state.blend = gl::Blend::add;
    state.firstBlended = 3;
    const gl::RasterPass pass("lpv propagate layered", layeredTargets_[next][far ? 1 : 0], state);
    const gl::Program& program = step == 0 ? *propagateFirst_ : *propagateFurther_;
    program.use();
    for (GLuint channel = 0; channel < 3; ++channel) (*front)[channel].bind(channel);
    if (geometryVolume_) geometryVolume_->bind(3);
    noAttributes_.bind();
    for (int k = 0; k < settings_.cascades.cascades; ++k) {
      program.set("cascade", k);
      program.set("firstLayer", k * cells);
      glDrawArraysInstanced(GL_TRIANGLES, 0, 3, cells);
    }
    front = &fronts_[next];
  }
}

void LightPropagationVolume::bindForLookup() const {
  constants_.bind(GL_UNIFORM_BUFFER, kConstantsBinding);
  for (GLuint channel = 0; channel < 3; ++channel) result()[channel].bind(4 + channel);
}

std::size_t LightPropagationVolume::gpuBytes() const {
  std::size_t bytes = constants_.bytes();
  const auto add = [&](const gl::Texture& texture) {
    if (texture.id()) bytes += texture.bytes();
  };
  for (std::size_t channel = 0; channel < 3; ++channel) {
    add(counts_[channel]);
    add(injected_[channel]);
    add(sum_[channel]);
    add(farSum_[channel]);
    for (const Volume& front : fronts_) add(front[channel]);
    if (faces_) add((*faces_)[channel]);
  }
  add(balances_);
  if (geometryVolume_) add(*geometryVolume_);
  return bytes;
}

}  // namespace lucerna
