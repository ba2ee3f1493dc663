#include "lpv/light_propagation_volume.hpp"

#include "base/error.hpp"

#include <array>

namespace lucerna {

namespace {

constexpr GLuint kConstantsBinding = 1;
constexpr glm::ivec3 kGroup{8, 8, 1};  // the fastest of those tried on llvmpipe, see README.md
constexpr std::array<const char*, 3> kChannels{"red", "green", "blue"};

}  // namespace

LightPropagationVolume::LightPropagationVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                               const Settings& settings)
    : settings_(settings), haveClearTexture_(capabilities.clearTexture) {
  const CascadeSettings& c = settings.cascades;
  CHECK(c.cascades >= 1 && c.cascades <= LPV_MAX_CASCADES, "cascades = {}", c.cascades);
  CHECK(c.cells >= 1 && (c.cells + 1) * c.cascades <= capabilities.max3dTextureSize, "cells = {}", c.cells);
  const bool full = settings.storage == Storage::full;
  const GLenum format = full ? GL_RGBA32F : GL_RGBA16F;
  const glm::ivec3 size(c.cells, c.cells, c.cells * c.cascades);
  const gl::Sampling sampling{GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_BORDER};  // outside the grid is dark

  constants_ = gl::Buffer("lpv constants", sizeof(shared::LpvConstants), nullptr, GL_DYNAMIC_DRAW);
  noAttributes_ = gl::VertexArray("lpv points");

  const gl::ShaderFlags storage{{"LPV_FULL_FLOAT", full}};
  inject_ = &programs.loadRaster("lpv inject", "lpv/inject.vert", "lpv/inject.frag", storage, "lpv/inject.geom");
  std::vector<const gl::Texture*> targets;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    // 32-bit floats for what is summed by blending: 16-bit sums stop growing after some 2000 equal additions.
    injected_[channel] = gl::Texture(fmt::format("lpv injected {}", kChannels[channel]), GL_RGBA32F, size, sampling);
    targets.push_back(&injected_[channel]);
  }
  injectTarget_ = gl::Framebuffer("lpv inject", targets);

  const bool blocked = settings.blocking && settings.iterations > 1;  // the first step is never blocked
  if (blocked) {
    fillGeometryVolume_ = &programs.loadRaster("lpv geometry volume", "lpv/inject.vert", "lpv/geometry_volume.frag", storage,
                                               "lpv/geometry_volume.geom");
    averageFaces_ = &programs.loadCompute("lpv geometry faces", "lpv/geometry_faces.comp",
                                          {{"LPV_FULL_FLOAT", full}, {"GROUP_X", kGroup.x}, {"GROUP_Y", kGroup.y}});
    const glm::ivec3 corners(c.cells + 1, c.cells + 1, (c.cells + 1) * c.cascades);
    geometryVolume_.emplace("lpv geometry volume", static_cast<GLenum>(GL_RGBA32F), corners);
    const std::array<const gl::Texture*, 1> target{&*geometryVolume_};
    geometryTarget_ = gl::Framebuffer("lpv geometry volume", target);
    faces_.emplace();
    for (std::size_t axis = 0; axis < 3; ++axis)
      (*faces_)[axis] = gl::Texture(fmt::format("lpv geometry faces {}", "xyz"[axis]), format, corners);
  }

  if (settings.iterations > 0) {
    const auto load = [&](const std::string& name, bool withBlocking, bool first) {
      return &programs.loadCompute(name, "lpv/propagate.comp",
                                   {{"LPV_FULL_FLOAT", full}, {"GROUP_X", kGroup.x}, {"GROUP_Y", kGroup.y},
                                    {"BLOCKED", withBlocking}, {"FIRST_STEP", first}});
    };
    propagateFirst_ = load("lpv propagate first", false, true);
    if (settings.iterations > 1) propagateFurther_ = load("lpv propagate", blocked, false);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      sum_[channel] = gl::Texture(fmt::format("lpv sum {}", kChannels[channel]), format, size, sampling);
      for (std::size_t i = 0; i < (settings.iterations > 1 ? 2u : 1u); ++i)
        fronts_[i][channel] = gl::Texture(fmt::format("lpv front {} {}", i, kChannels[channel]), format, size, sampling);
    }
  }

  if (settings.iterations > 0 && c.cascades > 1) {
    const gl::ShaderFlags flags{{"LPV_FULL_FLOAT", full}, {"GROUP_X", kGroup.x}, {"GROUP_Y", kGroup.y}};
    coarsen_ = &programs.loadCompute("lpv coarsen", "lpv/coarsen.comp", flags);
    compose_ = &programs.loadCompute("lpv join", "lpv/compose.comp", flags);
    const int half = (c.cells + 1) / 2;
    for (std::size_t channel = 0; channel < 3; ++channel)
      coarsened_[channel] = gl::Texture(fmt::format("lpv coarsened {}", kChannels[channel]), format,
                                        glm::ivec3(half, half, half * (c.cascades - 1)), sampling);
  }
}

void LightPropagationVolume::join() {
  if (!coarsen_) return;
  {
    const gl::ComputePass pass("lpv coarsen", GL_TEXTURE_FETCH_BARRIER_BIT);
    coarsen_->use();
    for (GLuint channel = 0; channel < 3; ++channel) {
      sum_[channel].bind(channel);
      coarsened_[channel].bindImage(channel, GL_WRITE_ONLY);
    }
    pass.dispatch(coarsened_[0].size(), kGroup);
  }
  for (int k = settings_.cascades.cascades - 2; k >= 0; --k) {
    const gl::ComputePass pass("lpv join", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    compose_->use();
    compose_->set("cascade", k);
    for (GLuint channel = 0; channel < 3; ++channel) {
      coarsened_[channel].bind(channel);
      sum_[channel].bind(3 + channel);
      sum_[channel].bindImage(channel, GL_READ_WRITE);
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

void LightPropagationVolume::drawTexels(const Inputs& inputs) const {
  noAttributes_.bind();
  for (const ReflectiveShadowMap::Outputs& rsm : inputs.rsms) {
    rsm.position.bind(0);
    rsm.normal.bind(1);
    rsm.flux.bind(2);
    glDrawArrays(GL_POINTS, 0, rsm.texelCount());
  }
}

void LightPropagationVolume::inject(const Inputs& inputs) {
  std::array<const gl::Texture*, 3> targets{&injected_[0], &injected_[1], &injected_[2]};
  gl::clearToZero(targets, haveClearTexture_);
  gl::RasterState state;
  state.blend = gl::Blend::add;
  const gl::RasterPass pass("lpv inject", injectTarget_, state);
  inject_->use();
  drawTexels(inputs);
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
    drawTexels(inputs);
  }
  const gl::ComputePass pass("lpv geometry faces", GL_TEXTURE_FETCH_BARRIER_BIT);
  averageFaces_->use();
  geometryVolume_->bind(0);
  for (GLuint axis = 0; axis < 3; ++axis) (*faces_)[axis].bindImage(axis, GL_WRITE_ONLY);
  pass.dispatch(geometryVolume_->size(), kGroup);
}

void LightPropagationVolume::propagate() {
  const Volume* front = &injected_;
  for (int step = 0; step < settings_.iterations; ++step) {
    const gl::ComputePass pass("lpv propagate", GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    Volume& next = fronts_[static_cast<std::size_t>(step % 2)];
    (step == 0 ? propagateFirst_ : propagateFurther_)->use();
    for (GLuint channel = 0; channel < 3; ++channel) {
      (*front)[channel].bind(channel);
      if (step > 0 && faces_) (*faces_)[channel].bind(3 + channel);
      next[channel].bindImage(channel, GL_WRITE_ONLY);
      sum_[channel].bindImage(3 + channel, GL_READ_WRITE);
    }
    pass.dispatch(sum_[0].size(), kGroup);
    front = &next;
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
    add(injected_[channel]);
    add(sum_[channel]);
    add(coarsened_[channel]);
    for (const Volume& front : fronts_) add(front[channel]);
    if (faces_) add((*faces_)[channel]);
  }
  if (geometryVolume_) add(*geometryVolume_);
  return bytes;
}

}  // namespace lucerna
