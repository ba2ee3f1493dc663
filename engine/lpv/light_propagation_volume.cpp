#include "lpv/light_propagation_volume.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"
#include "shared/bindings.h"

#include <cmath>

namespace lucerna {

namespace {

LpvSettings checked(const LpvSettings& settings, const gl::Capabilities& capabilities) {
  const CascadeSettings& c = settings.cascades;
  CHECK(c.cascades >= 1 && c.cascades <= MAX_CASCADES, "cascades = {}", c.cascades);
  CHECK(settings.tile >= 1 && settings.tile <= 16, "tile = {}", settings.tile);
  CHECK(c.cells >= 1 && (c.cells + 1) * c.cascades <= capabilities.max3dTextureSize, "cells = {}", c.cells);
  if (settings.reflects() && (!settings.blocking || settings.steps() < 2))
    throwBadInput(
        "lpv.bounces={}: the geometry volume reflects light; this needs two iterations and lpv.blocking other than off",
        settings.bounces);
  if (settings.glossy && !settings.isBlocked())
    throwBadInput(
        "lpv.glossy=on: the geometry volume ends reflected rays; this needs two iterations and lpv.blocking other than "
        "off");
  return settings.resolved();
}

}  // namespace

int lpvHandOverStep(int iterations, double ratio) {
  const double steps = ((1.33 * iterations - 0.33) / (ratio * ratio) + 0.33) / 1.33;
  return std::clamp(static_cast<int>(std::lround(steps)), 1, std::max(iterations, 1));
}

LpvSettings LpvSettings::resolved() const {
  LpvSettings settings = *this;
  if (settings.handOver == 0) settings.handOver = lpvHandOverStep(steps(), cascades.ratio);
  if (!deviations.halfGrids) return settings;
  settings.fill = LpvFill::layered;
  if (settings.propagate == LpvPropagate::compute) settings.propagate = LpvPropagate::layered;
  return settings;
}

LightPropagationVolume::LightPropagationVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                               const LpvSettings& wanted)
    : settings_(checked(wanted, capabilities)),
      constants_("lpv constants", sizeof(shared::CascadeConstants), nullptr, gl::Usage::dynamicDraw),
      injection_(programs, capabilities, settings_) {
  if (settings_.isBlocked()) geometry_.emplace(programs, capabilities, settings_);
  if (settings_.steps() == 0) return;
  join_.emplace(programs, capabilities, settings_);
  const bool layered = settings_.propagate != LpvPropagate::compute;
  if (layered) layered_.emplace(programs, capabilities, settings_);
  else compute_.emplace(programs, capabilities, settings_, injection_.counts() != nullptr);
  if (!settings_.reflects()) return;
  const LpvGrid grid(settings_);
  source_ = lpvVolume("source", gl::Format::rgba32f, grid.size, kLpvSampling);
  reflect_ = &programs.loadCompute("lpv reflect", "lpv/reflect.comp",
                                   gl::with(grid.flags, {{"FROM_BUFFER", !layered}, {"JOINED", settings_.joins()}}));
}

gl::ShaderFlags LightPropagationVolume::lookupFlags(const LpvSettings& settings) {
  return {{"GRID_FULL_FLOAT", settings.storage == LpvSettings::Storage::full},
          {"FLUX_UNITS", settings.deviations.fluxUnits},
          {"FLUX_LOOKUP", settings.lookupUsed() == LpvLookup::flux},
          {"UNWINDOWED", settings.deviations.unwindowed},
          {"SUM_CASCADES", settings.deviations.sumCascades}};
}

shared::CascadeConstants lpvConstants(const LpvSettings& settings, const std::vector<Cascade>& cascades,
                                      float referenceIrradiance) {
  shared::CascadeConstants constants =
      cascadeConstants(settings.cascades, cascades, settings.blendBand, referenceIrradiance, settings.offset());
  for (std::size_t k = 0; k < cascades.size() && settings.deviations.truncate; ++k) {
    // int(x + 0.5) cells from the world's origin, wrong for negative x; then whole world units, off the cell grid.
    const Cascade& cascade = cascades[k];
    const glm::dvec3 inCells = (cascade.centre - 0.5 * settings.cascades.cells * cascade.cellSize) / cascade.cellSize;
    constants.cascades[k].minimum = glm::vec3(glm::trunc(glm::trunc(inCells + 0.5) * cascade.cellSize));
  }
  constants.shape.z = settings.glossySteps;
  return constants;
}

void LightPropagationVolume::place(const LpvInputs& inputs) {
  const shared::CascadeConstants constants = lpvConstants(settings_, inputs.cascades, inputs.referenceIrradiance);
  constants_.upload(0, sizeof constants, &constants);
  constants_.bindUniform(BLOCK_CASCADES);
}

void LightPropagationVolume::inject(const LpvInputs& inputs) { injection_.inject(inputs); }

void LightPropagationVolume::fillGeometryVolume(const LpvInputs& inputs) {
  if (geometry_) geometry_->fill(inputs);
}

void LightPropagationVolume::propagate() {
  if (!join_) return;
  propagateFrom(injected());
  for (int bounce = 1; bounce < settings_.bounces; ++bounce) {
    reflect(bounce == 1);
    propagateFrom(source_);
  }
}

void LightPropagationVolume::propagateFrom(const LpvVolume& source) {
  const LpvGeometryVolume* geometry = geometry_ ? &*geometry_ : nullptr;
  if (compute_) compute_->run(source, injection_, geometry);
  else layered_->run(source, geometry);
  bindSums();
  join_->finish();
}

void LightPropagationVolume::join() {
  if (!join_) return;
  bindSums();
  join_->join();
}

void LightPropagationVolume::bindSums() const {
  if (compute_) compute_->bindSums();
  else layered_->bindSums();
}

// Adds the light reflected by the surfels to the source of the next bounce.
void LightPropagationVolume::reflect(bool first) {
  const gl::ComputePass pass("lpv reflect", gl::Barrier::textureFetch | gl::Barrier::image, gl::Barrier::image);
  reflect_->use();
  reflect_->set("first", first ? 1 : 0);
  reflect_->set("sourceShare", settings_.deviations.fewerSteps ? 0.0f : 1.0f);
  bindSums();
  for (GLuint channel = 0; channel < 3; ++channel) {
    injected()[channel].bind(6 + channel);
    source_[channel].bindImage(channel, gl::Access::readWrite);
  }
  geometry_->potential().bind(9);
  geometry_->reflectance().bind(10);
  pass.dispatch(source_[0].size(), kLpvGroup);
}

void LightPropagationVolume::bindForLookup() const {
  constants_.bindUniform(BLOCK_CASCADES);
  for (GLuint channel = 0; channel < 3; ++channel) result()[channel].bind(UNIT_LPV_RED + channel);
  if (settings_.glossy) geometry_->potential().bind(UNIT_LPV_GEOMETRY);
}

std::vector<InspectedPart> LightPropagationVolume::inspect(gl::ProgramLibrary& programs, const glm::vec3& position,
                                                           const glm::vec3& normal) const {
  const InspectedParts parts(8 * MAX_CASCADES);
  {
    const gl::Program& program = programs.loadCompute("lpv inspect", "lpv/inspect.comp", lookupFlags(settings_));
    const gl::ComputePass pass("lpv inspect");
    program.use();
    bindForLookup();
    program.set("inspectedPosition", position);
    program.set("inspectedNormal", normal);
    parts.bind();
    pass.dispatch(glm::ivec3(1), glm::ivec3(1));
  }
  return parts.read();
}

std::size_t LightPropagationVolume::gpuBytes() const {
  return constants_.bytes() + injection_.gpuBytes() + (geometry_ ? geometry_->gpuBytes() : 0) +
         (compute_ ? compute_->gpuBytes() : 0) + (layered_ ? layered_->gpuBytes() : 0) +
         (join_ ? join_->gpuBytes() : 0) + bytesOf(source_);
}

}  // namespace lucerna
