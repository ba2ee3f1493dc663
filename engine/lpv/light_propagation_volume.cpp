#include "lpv/light_propagation_volume.hpp"

#include "shared/bindings.h"
#include "base/error.hpp"
#include "gl/draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna {

namespace {

constexpr std::size_t kCellBytes = 16;  // of four coefficients in a buffer
// Bindings of storage buffers: of the steps (lpv/propagate.comp) and of what makes the result from the sums
// (lpv/join.comp).
constexpr GLuint kFrontBuffer = 0, kNextBuffer = 1, kSumBuffer = 2, kFacesBuffer = 3, kBricksBuffer = 4;
constexpr GLuint kReceivedBuffer = 0, kResultBuffer = 1, kBalancedBuffer = 2, kBalancesBuffer = 3;
constexpr glm::ivec3 kGroup{8, 8, 1};  // the fastest of those tried on llvmpipe, see README.md
constexpr double kSmallestCosine = 0.05;  // to which the reflective shadow map bounds a texel's area
constexpr int kBrick = 4;  // cells a side, as in lpv/bricks.glsl
constexpr std::array<GLuint, 4> kNoBricks{64, 0, 1, 0};  // groups of the dispatch, a row at a time, and their count
constexpr std::array<const char*, 3> kChannels{"red", "green", "blue"};

}  // namespace

LightPropagationVolume::Settings LightPropagationVolume::withItsPasses(Settings settings) {
  if (!settings.deviations.halfGrids) return settings;
  settings.fill = LpvFill::layered;
  if (settings.propagate == LpvPropagate::compute) settings.propagate = LpvPropagate::layered;
  return settings;
}

LightPropagationVolume::LightPropagationVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                               const Settings& wanted)
    : settings_(withItsPasses(wanted)), haveClearTexture_(capabilities.clearTexture) {
  const Settings& settings = settings_;
  const CascadeSettings& c = settings.cascades;
  const Deviations& deviations = settings.deviations;
  CHECK(c.cascades >= 1 && c.cascades <= LPV_MAX_CASCADES, "cascades = {}", c.cascades);
  CHECK(settings.tile >= 1 && settings.tile <= 16, "tile = {}", settings.tile);
  CHECK(c.cells >= 1 && (c.cells + 1) * c.cascades <= capabilities.max3dTextureSize, "cells = {}", c.cells);
  const bool full = settings.storage == Storage::full;
  const bool layered = settings.propagate != LpvPropagate::compute;
  const GLenum format = full ? GL_RGBA32F : GL_RGBA16F;
  const glm::ivec3 size(c.cells, c.cells, c.cells * c.cascades);
  const auto cellsOf = [](const glm::ivec3& texels) {
    return static_cast<std::size_t>(texels.x) * static_cast<std::size_t>(texels.y) * static_cast<std::size_t>(texels.z);
  };
  const std::size_t volumeBytes = 3 * cellsOf(size) * kCellBytes;
  const gl::Sampling sampling{GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_BORDER};  // dark outside the grid
  steps_ = std::max(settings.iterations - (deviations.fewerSteps ? 1 : 0), 0);
  const bool joined = c.cascades > 1 && !deviations.sumCascades && !deviations.unjoined;
  if (settings_.handOver == 0) settings_.handOver = handOverStep(steps_, c.ratio);

  constants_ = gl::Buffer("lpv constants", sizeof(shared::LpvConstants), nullptr, GL_DYNAMIC_DRAW);
  noAttributes_ = gl::VertexArray("lpv points");
  const auto allocate = [](Volume& volume, const char* name, GLenum texelFormat, glm::ivec3 texels,
                           const gl::Sampling& how) {
    for (std::size_t channel = 0; channel < 3; ++channel)
      volume[channel] = gl::Texture(fmt::format("lpv {} {}", name, kChannels[channel]), texelFormat, texels, how);
  };
  const auto buffer = [&](const std::string& name, GLenum texelFormat, std::size_t bytes) {
    if (bytes / gl::bytesPerTexel(texelFormat) > static_cast<std::size_t>(capabilities.maxTextureBufferSize))
      throwMissingCapability(
          "{}: {} bytes; the largest texture buffer of the driver has {} texels (GL_MAX_TEXTURE_BUFFER_SIZE)", name,
          bytes, capabilities.maxTextureBufferSize);
    return gl::BufferTexture(name, texelFormat, bytes, nullptr, GL_DYNAMIC_COPY);
  };
  const gl::ShaderFlags group{{"LPV_FULL_FLOAT", full}, {"GROUP_X", kGroup.x}, {"GROUP_Y", kGroup.y}};
  const auto with = [](gl::ShaderFlags flags, const gl::ShaderFlags& more) {
    flags.insert(flags.end(), more.begin(), more.end());
    return flags;
  };

  const gl::ShaderFlags vpl{{"FLUX_UNITS", deviations.fluxUnits}, {"LOWEST_CELL", deviations.firstCell ? 1 : 0}};
  const gl::ShaderFlags tile{{"TILE", settings.tile}};

  // 32-bit floats for what is summed: 16-bit sums stop growing after some 2000 equal additions.
  const GLenum grid = deviations.halfGrids ? GL_RGBA16F : GL_RGBA32F;
  allocate(injected_, "injected", grid, size, sampling);
  if (settings.fill == LpvFill::layered) {
    inject_ = &programs.loadRaster("lpv inject", "lpv/inject.vert", "lpv/inject.frag",
                                   with({{"LPV_FULL_FLOAT", full}, {"REFLECTS", 0}}, vpl), "lpv/inject.geom");
    const std::array<const gl::Texture*, 3> targets{&injected_[0], &injected_[1], &injected_[2]};
    injectTarget_ = gl::Framebuffer("lpv inject", targets);
  } else {
    const bool fixed = settings.fill == LpvFill::fixed;
    if (!fixed && !capabilities.shaderAtomicFloat && !capabilities.shaderAtomicFp16Vector)
      throwMissingCapability(
          "lpv.fill=atomic: the driver has neither NV_shader_atomic_fp16_vector nor NV_shader_atomic_float; "
          "lpv.fill=fixed needs no extension");
    fillsHalfVectors_ =
        !fixed && !capabilities.shaderAtomicFloat;  // 16-bit sums stop growing: only where there is no other
    const gl::ShaderFlags fill{
        {"FILL_FIXED", fixed}, {"FILL_FLOAT", !fixed && !fillsHalfVectors_}, {"FILL_HALF", fillsHalfVectors_}};
    inject_ = &programs.loadCompute("lpv inject by atomics", "lpv/inject_atomic.comp",
                                    with(with(with(group, fill), vpl), tile));
    if (fixed || fillsHalfVectors_)
      resolve_ = &programs.loadCompute("lpv resolve", "lpv/resolve.comp", with(with(group, fill), vpl));
    if (fillsHalfVectors_) allocate(counts_, "count", GL_RGBA16F, size, {});
    fronts_[0] = buffer("lpv front even", GL_RGBA32F, volumeBytes);
  }

  if (settings.bounces == kAllBounces)
    throwBadInput("lpv.bounces=all: lpv.transport=propagate needs a number of bounces");
  if (settings.bounces > 1 && (!settings.blocking || steps_ < 2))
    throwBadInput(
        "lpv.bounces={}: the geometry volume reflects light; this needs two iterations and lpv.blocking other than off",
        settings.bounces);
  const gl::ShaderFlags kernel{{"FACE_KERNEL", deviations.kernel()},
                               {"SIDE_DIRECTIONS", deviations.sideDirections},
                               {"SIDE_SOLID_ANGLE", deviations.sideSolidAngle},
                               {"FOUR_PI_KERNEL", deviations.fourPiKernel},
                               {"BLOCKING_DIRECTION", deviations.blockingDirection}};
  const bool blocked =
      settings.blocking &&
      (steps_ > 1 || (steps_ == 1 && deviations.blockFirstStep));  // the first step is not blocked by default
  if (blocked) {
    fillGeometryVolume_ = &programs.loadRaster("lpv geometry volume", "lpv/inject.vert", "lpv/geometry_volume.frag",
                                               {{"LPV_FULL_FLOAT", full},
                                                {"TRUNCATE", deviations.truncate},
                                                {"SURFEL_AREA", deviations.surfelArea},
                                                {"LOWEST_CELL", deviations.firstCell ? 1 : 0},
                                                {"REFLECTS", reflects()}},
                                               "lpv/geometry_volume.geom");
    const glm::ivec3 corners(c.cells + 1, c.cells + 1, (c.cells + 1) * c.cascades);
    // Views are merged in place, in images of 32 bits.
    geometryVolume_.emplace("lpv geometry volume", settings.mergeViews ? static_cast<GLenum>(GL_RGBA32F) : grid,
                            corners, sampling);
    const auto allocateView = [&](const std::string& name, gl::Texture& reflectance, const gl::Texture& potential,
                                  gl::Framebuffer& target) {
      std::vector<const gl::Texture*> targets{&potential};
      if (reflects()) {
        reflectance = gl::Texture(name + " reflectance", GL_RGBA32F, corners);
        targets.push_back(&reflectance);
      }
      target = gl::Framebuffer(name, targets);
    };
    allocateView("lpv geometry volume", reflectance_, *geometryVolume_, geometryTarget_);
    if (settings.mergeViews) {
      mergeViews_ =
          &programs.loadCompute("lpv merge views", "lpv/merge_views.comp", with(group, {{"REFLECTS", reflects()}}));
      viewPotential_ = gl::Texture("lpv view", GL_RGBA32F, corners);
      allocateView("lpv view", viewReflectance_, viewPotential_, viewTarget_);
    }
    // Several views are merged, and reflection needs an albedo: then by blending, with any fill.
    if (settings.fill != LpvFill::layered && !fillsHalfVectors_ && !settings.mergeViews && !reflects() &&
        !deviations.surfelArea) {
      const gl::ShaderFlags fill{{"FILL_FIXED", settings.fill == LpvFill::fixed},
                                 {"FILL_FLOAT", settings.fill == LpvFill::atomic},
                                 {"TRUNCATE", deviations.truncate}};
      countSurfels_ = &programs.loadCompute("lpv count surfels", "lpv/count_surfels.comp",
                                            with(with(with(group, fill), vpl), tile));
      potential_ = buffer("lpv geometry volume's counts", GL_RGBA32F, cellsOf(corners) * kCellBytes);
    }
    if (!layered) {
      const auto average = [&](bool fromBuffer) {
        return &programs.loadCompute("lpv geometry faces", "lpv/geometry_faces.comp",
                                     with(with(group, {{"FROM_BUFFER", fromBuffer}}), kernel));
      };
      averageFaces_ = average(false);
      if (countSurfels_) averageCountedFaces_ = average(true);
      faces_ = buffer("lpv geometry faces", GL_RGBA32F, 3 * cellsOf(corners) * kCellBytes);
    }
  }

  if (steps_ == 0) return;
  allocate(result_, "result", format, size, sampling);
  const bool joins = joined && settings_.handOver < steps_;
  const gl::ShaderFlags from = with(group, {{"FROM_BUFFER", !layered}, {"JOINED", joins}});
  if (joins) {
    const int pairs = (c.cells + 1) / 2;
    balance_ = &programs.loadCompute("lpv balance", "lpv/balance.comp", from);
    join_ = &programs.loadCompute("lpv join", "lpv/join.comp", with(from, {{"HAS_COARSER", 1}}));
    joinCoarsest_ = &programs.loadCompute("lpv join coarsest", "lpv/join.comp", with(from, {{"HAS_COARSER", 0}}));
    received_ = buffer("lpv received", GL_RGBA32F, volumeBytes);
    balances_ = buffer("lpv balances", GL_R32F, cellsOf(glm::ivec3(pairs)) * sizeof(float));
    balanced_ = buffer("lpv balanced", GL_R32F, cellsOf(size) * sizeof(float));
  } else {
    finish_ = &programs.loadCompute("lpv finish", "lpv/finish.comp", from);
  }
  resultTexels_ = gl::Buffer("lpv result texels", 3 * result_[0].bytes(), nullptr, GL_DYNAMIC_COPY);
  if (reflects()) {
    allocate(source_, "source", GL_RGBA32F, size, sampling);
    reflect_ = &programs.loadCompute("lpv reflect", "lpv/reflect.comp", from);
  }
  const bool firstBlocked = blocked && deviations.blockFirstStep;
  if (!layered) {
    const auto load = [&](const std::string& name, bool first, bool withBlocking) {
      return &programs.loadCompute(
          name, "lpv/propagate.comp",
          with(with(group, {{"FIRST", first}, {"WITH_INJECTED", !deviations.fewerSteps}, {"BLOCKED", withBlocking}}),
               kernel));
    };
    begin_ = &programs.loadCompute("lpv begin", "lpv/begin.comp", group);
    markBricks_ = &programs.loadCompute("lpv mark bricks", "lpv/mark_bricks.comp", group);
    listBricks_ = &programs.loadCompute("lpv list bricks", "lpv/list_bricks.comp", group);
    propagateFirst_ = load("lpv propagate first", true, firstBlocked);
    if (steps_ > 1) propagateFurther_ = load("lpv propagate", false, blocked);
    for (std::size_t i = 0; i < 2; ++i)
      if (fronts_[i].bytes() == 0)
        fronts_[i] = buffer(i == 0 ? "lpv front even" : "lpv front odd", GL_RGBA32F, volumeBytes);
    sums_ = buffer("lpv sums", GL_RGBA32F, volumeBytes);
    if (joins) farSums_ = buffer("lpv far sums", GL_RGBA32F, volumeBytes);
    const int bricksOfAxis = (c.cells + kBrick - 1) / kBrick;
    brickCount_ = bricksOfAxis * bricksOfAxis * bricksOfAxis * c.cascades;
    bricks_ = gl::Buffer("lpv bricks", sizeof kNoBricks + 3 * static_cast<std::size_t>(brickCount_) * sizeof(GLuint),
                         nullptr, GL_DYNAMIC_COPY);
    return;
  }
  allocate(sum_, "sum", grid, size, sampling);
  if (joins) allocate(farSum_, "far sum", grid, size, sampling);
  const auto load = [&](bool withBlocking, bool withInjected) {
    return &programs.loadRaster("lpv propagate layered", "lpv/propagate_layered.vert", "lpv/propagate_layered.frag",
                                with({{"LPV_FULL_FLOAT", full},
                                      {"POINTS", settings.propagate == LpvPropagate::layered},
                                      {"BLOCKED", withBlocking},
                                      {"BEGINS_WITH_INJECTED", withInjected}},
                                     kernel),
                                "lpv/propagate_layered.geom");
  };
  propagateFirst_ = load(firstBlocked, !deviations.fewerSteps);
  if (steps_ > 1) propagateFurther_ = load(blocked, false);
  for (std::size_t i = 0; i < (steps_ > 1 ? 2u : 1u); ++i) {
    allocate(layeredFronts_[i], i == 0 ? "front even" : "front odd", grid, size, sampling);
    for (std::size_t far = 0; far < (joins ? 2u : 1u); ++far) {
      const Volume& front = layeredFronts_[i];
      const Volume& sum = far ? farSum_ : sum_;
      const std::array<const gl::Texture*, 6> targets{&front[0], &front[1], &front[2], &sum[0], &sum[1], &sum[2]};
      layeredTargets_[i][far] = gl::Framebuffer("lpv propagate layered", targets);
    }
  }
}

gl::ShaderFlags LightPropagationVolume::lookupFlags(const Settings& settings) {
  return {{"LPV_FULL_FLOAT", settings.storage == Storage::full},
          {"FLUX_UNITS", settings.deviations.fluxUnits},
          {"FLUX_LOOKUP", lookupOf(settings) == LpvLookup::flux},
          {"UNWINDOWED", settings.deviations.unwindowed},
          {"SUM_CASCADES", settings.deviations.sumCascades}};
}

int LightPropagationVolume::handOverStep(int iterations, double ratio) {
  const double steps = ((1.33 * iterations - 0.33) / (ratio * ratio) + 0.33) / 1.33;
  return std::clamp(static_cast<int>(std::lround(steps)), 1, std::max(iterations, 1));
}

void LightPropagationVolume::bindSums() const {
  if (settings_.propagate == LpvPropagate::compute) {
    sums_.bind(0);
    if (join_) farSums_.bind(3);
    return;
  }
  for (GLuint channel = 0; channel < 3; ++channel) {
    sum_[channel].bind(channel);
    if (join_) farSum_[channel].bind(3 + channel);
  }
}

// From the buffer to the textures that are filtered: see lpv/result.glsl.
void LightPropagationVolume::copyResult() {
  for (std::size_t channel = 0; channel < 3; ++channel)
    result_[channel].copyFrom(resultTexels_, channel * result_[channel].bytes());
}

void LightPropagationVolume::join() {
  if (!join_) return;
  bindSums();
  balances_.bind(7);
  for (int k = settings_.cascades.cascades - 1; k >= 0; --k) {
    const bool coarsest = k + 1 == settings_.cascades.cascades;
    if (!coarsest) {
      const gl::ComputePass pass("lpv balance", GL_TEXTURE_FETCH_BARRIER_BIT);
      balance_->use();
      balance_->set("cascade", k);
      balanced_.bind(6);
      balances_.buffer().bind(GL_SHADER_STORAGE_BUFFER, kBalancesBuffer);
      pass.dispatch(glm::ivec3((settings_.cascades.cells + 1) / 2), kGroup);
    }
    const gl::ComputePass pass("lpv join", GL_TEXTURE_FETCH_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
    const gl::Program& program = coarsest ? *joinCoarsest_ : *join_;
    program.use();
    program.set("cascade", k);
    received_.bind(6);
    received_.buffer().bind(GL_SHADER_STORAGE_BUFFER, kReceivedBuffer);
    resultTexels_.bind(GL_SHADER_STORAGE_BUFFER, kResultBuffer);
    balanced_.buffer().bind(GL_SHADER_STORAGE_BUFFER, kBalancedBuffer);
    pass.dispatch(glm::ivec3(settings_.cascades.cells), kGroup);
  }
  copyResult();
}

shared::LpvConstants lpvConstants(const LightPropagationVolume::Settings& settings,
                                  const std::vector<Cascade>& cascades, float referenceIrradiance) {
  CHECK(referenceIrradiance > 0.0f, "E_ref = {}", referenceIrradiance);
  CHECK(static_cast<int>(cascades.size()) == settings.cascades.cascades, "{} cascades", cascades.size());
  shared::LpvConstants constants{};
  const int cells = settings.cascades.cells;
  const float offset = LightPropagationVolume::offsetOf(settings);
  for (std::size_t k = 0; k < cascades.size(); ++k) {
    const Cascade& cascade = cascades[k];
    auto& target = constants.cascades[k];
    target.minimum = glm::vec3(cascade.minimum());
    if (settings.deviations.truncate) {
      // int(x + 0.5) cells from the world's origin, wrong where negative; then whole world units, off the raster of
      // cells.
      const glm::dvec3 inCells = (cascade.centre - 0.5 * cells * cascade.cellSize) / cascade.cellSize;
      target.minimum = glm::vec3(glm::trunc(glm::trunc(inCells + 0.5) * cascade.cellSize));
    }
    target.cellSize = static_cast<float>(cascade.cellSize);
    target.blendCentre = glm::vec3(cascade.centre);
    // Snapping moves the grid by up to two cells and the trilinear lookup needs half a cell more.
    const bool coarsest = k + 1 == cascades.size();
    target.blendHalf = coarsest ? 1e30f : static_cast<float>((0.5 * cells - 2.5 - offset) * cascade.cellSize);
    if (!coarsest && target.blendHalf <= 0.0f) target.blendHalf = 1e-30f;  // too few cells to blend: never used
  }
  constants.shape = {cells, settings.cascades.cascades, 0, 0};
  constants.referenceIrradiance = referenceIrradiance;
  constants.blendBand = settings.blendBand;
  constants.lookupOffset = offset;
  return constants;
}

void LightPropagationVolume::place(const Inputs& inputs) {
  const shared::LpvConstants constants = lpvConstants(settings_, inputs.cascades, inputs.referenceIrradiance);
  constants_.upload(0, sizeof constants, &constants);
  constants_.bind(GL_UNIFORM_BUFFER, BLOCK_LPV);
}

float LightPropagationVolume::fluxScale(const ReflectiveShadowMap::Outputs& rsm) const {
  // Without units each light counts as E * albedo, whatever its texel's area.
  return settings_.deviations.fluxUnits ? 1.0f / rsm.texelArea : 1.0f;
}

void LightPropagationVolume::inject(const Inputs& inputs) {
  if (settings_.fill != LpvFill::layered) return fillByAtomics(inputs);
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
    gl::drawPoints(rsm.texelCount());
  }
}

void LightPropagationVolume::fillByAtomics(const Inputs& inputs) {
  // The largest stored coefficient that there can be: all light of all maps, reflected by white, in one cell of the
  // finest cascade. 2^30 steps for it, so that the rounding of a million lights cannot overflow 31 bits either.
  const double finest = inputs.cascades.front().cellSize;
  const double unit = inputs.referenceIrradiance * (settings_.deviations.fluxUnits ? 1.0 : finest * finest);
  double flux = 0.0;
  for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms)
    flux += rsm.largestFlux * static_cast<double>(fluxScale(rsm));
  const double largest = 1.0233267079464885 / 3.141592653589793 * flux / unit;  // of the sun alone E_ref cancels
  const auto fixedScale =
      static_cast<float>(settings_.fill == LpvFill::fixed && largest > 0.0 ? 1073741824.0 / largest : 1.0);
  fronts_[0].clear();
  if (fillsHalfVectors_) {
    const std::array<const gl::Texture*, 3> counts{&counts_[0], &counts_[1], &counts_[2]};
    gl::clearToZero(counts, haveClearTexture_);
  }
  {
    const gl::ComputePass pass("lpv inject by atomics",
                               GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                                   GL_SHADER_STORAGE_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
    inject_->use();
    inject_->set("fixedScale", fixedScale);
    fronts_[0].buffer().bind(GL_SHADER_STORAGE_BUFFER, kFrontBuffer);
    if (fillsHalfVectors_)
      for (GLuint channel = 0; channel < 3; ++channel) counts_[channel].bindImage(channel, GL_READ_WRITE);
    for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms) {  // atomics need no order
      inject_->set("fluxScale", fluxScale(rsm));
      rsm.bind();
      pass.dispatch(rsm.position.size(), kGroup * glm::ivec3(settings_.tile, settings_.tile, 1));
    }
  }
  if (fillsHalfVectors_) {
    const gl::ComputePass pass("lpv resolve", GL_TEXTURE_FETCH_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
    resolve_->use();
    for (GLuint channel = 0; channel < 3; ++channel) counts_[channel].bind(channel);
    fronts_[0].buffer().bind(GL_SHADER_STORAGE_BUFFER, kFrontBuffer);
    pass.dispatch(injected_[0].size(), kGroup);
  } else if (resolve_) {
    resolveCounts(fronts_[0], injected_[0].size(), 3, fixedScale);
  }
  for (std::size_t channel = 0; channel < 3; ++channel)
    injected_[channel].copyFrom(fronts_[0].buffer(), channel * injected_[channel].bytes());
  frontIsInjected_ = true;
}

void LightPropagationVolume::resolveCounts(const gl::BufferTexture& counts, const glm::ivec3& size, int channels,
                                           float fixedScale) {
  const gl::ComputePass pass("lpv resolve", GL_TEXTURE_FETCH_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
  resolve_->use();
  resolve_->set("fixedScale", fixedScale);
  resolve_->set("size", size);
  resolve_->set("channels", channels);
  counts.buffer().bind(GL_SHADER_STORAGE_BUFFER, kFrontBuffer);
  pass.dispatch(size, kGroup);
}

// The integers' unit follows from the area of all texels together, known only for the sun's map.
bool LightPropagationVolume::countsSurfels(const std::vector<const ReflectiveShadowMap::Outputs*>& maps) const {
  if (!countSurfels_) return false;
  return settings_.fill != LpvFill::fixed ||
         std::all_of(maps.begin(), maps.end(), [](const ReflectiveShadowMap::Outputs* map) {
           return map->light == ReflectiveShadowMap::Light::sun;
         });
}

void LightPropagationVolume::countSurfels(const std::vector<const ReflectiveShadowMap::Outputs*>& maps,
                                          const Inputs& inputs) {
  // The largest coefficient that there can be: all texels of all maps in one cell of the finest cascade, and as steep
  // as they are counted.
  const double finest = inputs.cascades.front().cellSize;
  double area = 0.0;
  for (const ReflectiveShadowMap::Outputs* map : maps)
    area += map->texelCount() * static_cast<double>(map->texelArea) / kSmallestCosine;
  const double largest = 1.0233267079464885 * area / (finest * finest);
  const auto fixedScale = static_cast<float>(resolve_ && largest > 0.0 ? 1073741824.0 / largest : 1.0);
  potential_.clear();
  {
    const gl::ComputePass pass("lpv count surfels", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                                                        GL_PIXEL_BUFFER_BARRIER_BIT);
    countSurfels_->use();
    countSurfels_->set("fixedScale", fixedScale);
    potential_.buffer().bind(GL_SHADER_STORAGE_BUFFER, kFrontBuffer);
    for (const ReflectiveShadowMap::Outputs* map : maps) {
      map->bind();
      pass.dispatch(map->position.size(), kGroup * glm::ivec3(settings_.tile, settings_.tile, 1));
    }
  }
  if (resolve_) resolveCounts(potential_, geometryVolume_->size(), 1, fixedScale);
  geometryVolume_->copyFrom(potential_.buffer(), 0);
}

void LightPropagationVolume::drawSurfels(const Inputs& inputs, const ReflectiveShadowMap::Outputs& map,
                                         const gl::Framebuffer& target) {
  gl::RasterState state;
  state.blend = gl::Blend::add;
  const gl::RasterPass pass("lpv geometry volume", target, state);
  fillGeometryVolume_->use();
  noAttributes_.bind();
  if (settings_.deviations.surfelArea) {
    const bool isSun = map.light == ReflectiveShadowMap::Light::sun;
    fillGeometryVolume_->set("lightPosition", inputs.lightPosition);
    fillGeometryVolume_->set("texelCount", isSun ? static_cast<float>(map.texelCount()) : 0.0f);
  }
  map.bind();
  gl::drawPoints(map.texelCount());
}

void LightPropagationVolume::mergeView() {
  const gl::ComputePass pass("lpv merge views", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                                                    GL_FRAMEBUFFER_BARRIER_BIT);
  mergeViews_->use();
  viewPotential_.bind(0);
  geometryVolume_->bindImage(0, GL_READ_WRITE);
  if (reflects()) {
    viewReflectance_.bind(1);
    reflectance_.bindImage(1, GL_WRITE_ONLY);
  }
  pass.dispatch(viewPotential_.size(), kGroup);
}

void LightPropagationVolume::fillGeometryVolume(const Inputs& inputs) {
  if (!geometryVolume_) return;
  std::vector<const ReflectiveShadowMap::Outputs*> maps;
  if (settings_.surfels != LpvSurfels::camera)
    for (const ReflectiveShadowMap::Outputs& map : inputs.rsms) maps.push_back(&map);
  if (settings_.surfels != LpvSurfels::rsm)
    for (const ReflectiveShadowMap::Outputs& map : inputs.views) maps.push_back(&map);
  const bool counted = countsSurfels(maps);
  if (counted) countSurfels(maps, inputs);
  else drawAllSurfels(maps, inputs);
  if (!averageFaces_) return;
  const gl::ComputePass pass("lpv geometry faces", GL_TEXTURE_FETCH_BARRIER_BIT);
  if (counted) {
    averageCountedFaces_->use();
    potential_.bind(0);
  } else {
    averageFaces_->use();
    geometryVolume_->bind(0);
  }
  faces_.buffer().bind(GL_SHADER_STORAGE_BUFFER, kFacesBuffer);
  pass.dispatch(geometryVolume_->size(), kGroup);
}

void LightPropagationVolume::drawAllSurfels(const std::vector<const ReflectiveShadowMap::Outputs*>& maps,
                                            const Inputs& inputs) {
  std::vector<const gl::Texture*> targets{&*geometryVolume_};
  if (reflects()) targets.push_back(&reflectance_);
  gl::clearToZero(targets, haveClearTexture_);
  bool merges = false;  // the first map needs none
  for (const ReflectiveShadowMap::Outputs* map : maps) {
    CHECK(!reflects() || map->albedo, "a map without albedo for {} bounces", settings_.bounces);
    if (merges) {
      std::vector<const gl::Texture*> view{&viewPotential_};
      if (reflects()) view.push_back(&viewReflectance_);
      gl::clearToZero(view, haveClearTexture_);
    }
    drawSurfels(inputs, *map, merges ? viewTarget_ : geometryTarget_);
    if (merges) mergeView();
    merges = settings_.mergeViews;
  }
}

void LightPropagationVolume::propagate() {
  if (steps_ == 0) return;
  for (const gl::Program* program : {propagateFirst_, propagateFurther_})
    if (program && settings_.deviations.fourPiKernel) program->set("amplifier", settings_.amplifier);
  propagateFrom(injected_);
  for (int bounce = 1; bounce < settings_.bounces; ++bounce) {
    reflect(bounce == 1);
    propagateFrom(source_);
  }
}

void LightPropagationVolume::reflect(bool first) {
  const gl::ComputePass pass("lpv reflect", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  reflect_->use();
  reflect_->set("first", first ? 1 : 0);
  reflect_->set("sourceShare", settings_.deviations.fewerSteps ? 0.0f : 1.0f);
  bindSums();
  for (GLuint channel = 0; channel < 3; ++channel) {
    injected_[channel].bind(6 + channel);
    source_[channel].bindImage(channel, GL_READ_WRITE);
  }
  geometryVolume_->bind(9);
  reflectance_.bind(10);
  pass.dispatch(source_[0].size(), kGroup);
}

void LightPropagationVolume::propagateFrom(const Volume& source) {
  if (settings_.propagate == LpvPropagate::compute) propagateByCompute(source);
  else propagateLayered(source);
  if (!finish_) return;
  {
    const gl::ComputePass pass("lpv finish", GL_PIXEL_BUFFER_BARRIER_BIT);
    finish_->use();
    bindSums();
    resultTexels_.bind(GL_SHADER_STORAGE_BUFFER, kResultBuffer);
    pass.dispatch(injected_[0].size(), kGroup);
  }
  copyResult();
}

void LightPropagationVolume::propagateByCompute(const Volume& source) {
  // Cells without a dispatched brick are never written, so they must be dark.
  fronts_[1].clear();
  sums_.clear();
  if (join_) farSums_.clear();
  bricks_.clear();
  bricks_.upload(0, sizeof kNoBricks, kNoBricks.data());
  bricks_.bind(GL_SHADER_STORAGE_BUFFER, kBricksBuffer);
  const glm::ivec3 size = injected_[0].size();
  if (!frontIsInjected_) {
    const gl::ComputePass pass("lpv begin", GL_TEXTURE_FETCH_BARRIER_BIT);
    begin_->use();
    for (GLuint channel = 0; channel < 3; ++channel) source[channel].bind(channel);
    fronts_[0].buffer().bind(GL_SHADER_STORAGE_BUFFER, kFrontBuffer);
    pass.dispatch(size, kGroup);
  }
  {
    const gl::ComputePass pass("lpv mark bricks", GL_SHADER_STORAGE_BARRIER_BIT);
    markBricks_->use();
    markBricks_->set("everywhere", settings_.everyBrick ? 1 : 0);
    fronts_[0].bind(0);
    pass.dispatch(size, kGroup);
  }
  frontIsInjected_ = false;  // the second step overwrites it
  if (faces_.bytes() > 0) faces_.bind(1);
  for (int step = 0; step < steps_; ++step) {
    {
      const gl::ComputePass pass("lpv list bricks", GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
      listBricks_->use();
      pass.dispatch(glm::ivec3(brickCount_, 1, 1), glm::ivec3(64, 1, 1));
    }
    const gl::ComputePass pass("lpv propagate", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    (step == 0 ? propagateFirst_ : propagateFurther_)->use();
    const gl::BufferTexture& sums = join_ && step >= settings_.handOver ? farSums_ : sums_;
    fronts_[static_cast<std::size_t>(step % 2)].bind(0);
    sums.bind(2);
    fronts_[static_cast<std::size_t>((step + 1) % 2)].buffer().bind(GL_SHADER_STORAGE_BUFFER, kNextBuffer);
    sums.buffer().bind(GL_SHADER_STORAGE_BUFFER, kSumBuffer);
    pass.dispatchIndirect(bricks_);
  }
}

// As published: one layered pass per step and cascade, blending adds to the sum. One point per cell, or one triangle
// per slice.
void LightPropagationVolume::propagateLayered(const Volume& source) {
  std::vector<const gl::Texture*> sums{&sum_[0], &sum_[1], &sum_[2]};
  if (join_) sums.insert(sums.end(), {&farSum_[0], &farSum_[1], &farSum_[2]});
  gl::clearToZero(sums, haveClearTexture_);
  const int cells = settings_.cascades.cells;
  const Volume* front = &source;
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
      program.set("cells", cells);
      if (settings_.propagate == LpvPropagate::layered) gl::drawPoints(cells * cells * cells);
      else gl::drawTriangles(3, cells);
    }
    front = &layeredFronts_[next];
  }
}

void LightPropagationVolume::bindForLookup() const {
  constants_.bind(GL_UNIFORM_BUFFER, BLOCK_LPV);
  for (GLuint channel = 0; channel < 3; ++channel) result()[channel].bind(UNIT_LPV_RED + channel);
}

std::size_t LightPropagationVolume::gpuBytes() const {
  std::size_t bytes = constants_.bytes() + bricks_.bytes() + resultTexels_.bytes();
  for (const gl::BufferTexture* buffer :
       {&fronts_[0], &fronts_[1], &sums_, &farSums_, &potential_, &faces_, &received_, &balances_, &balanced_})
    bytes += buffer->bytes();
  const auto add = [&](const gl::Texture& texture) {
    if (texture.id()) bytes += texture.bytes();
  };
  for (const gl::Texture* texture : {&reflectance_, &viewPotential_, &viewReflectance_}) add(*texture);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    add(counts_[channel]);
    add(source_[channel]);
    add(injected_[channel]);
    add(result_[channel]);
    add(sum_[channel]);
    add(farSum_[channel]);
    for (const Volume& front : layeredFronts_) add(front[channel]);
  }
  if (geometryVolume_) add(*geometryVolume_);
  return bytes;
}

}  // namespace lucerna
