#include "pathtracer/light_visibility.hpp"

#include "gl/pass.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

constexpr GLuint kCountsBinding = 6;  // GL_SHADER_STORAGE_BUFFER
constexpr GLuint kCountsUnit = 6;
constexpr int kRayGroup = 64;

}  // namespace

LightVisibility::LightVisibility(gl::ProgramLibrary& programs, const Scene& scene, const PathScene& traced,
                                 const gl::Buffer& constants) {
  const glm::dvec3 extent = scene.main().extent();
  const double cell = std::max({extent.x, extent.y, extent.z, 1e-30}) / kCells;
  cell_ = static_cast<float>(cell);
  min_ = glm::vec3(scene.main().min - traced.origin());
  cells_ = glm::clamp(glm::ivec3(glm::ceil(extent / cell)), glm::ivec3(1), glm::ivec3(kCells));
  const std::vector<glm::uvec2> zeros(static_cast<std::size_t>(cells_.x * cells_.y * cells_.z * kKinds));
  counts_ = gl::BufferTexture("light visibility", gl::Format::r32ui, zeros.size() * sizeof zeros[0], zeros.data(),
                              gl::Usage::dynamicCopy);
  const gl::Program& program = programs.loadCompute(
      "light visibility", "pathtracer/light_visibility.comp",
      gl::with(traced.flags(), {{"LINEAR_SEEDS", 0}, {"GLOSSY", 0}, {"SHARED_STACK", traced.rays().sharedStack()}}));
  const gl::ComputePass pass("light visibility", gl::Barrier::textureFetch);
  program.use();
  constants.bindUniform(0);
  traced.bind();
  counts_.buffer().bindStorage(kCountsBinding);
  setCells(program);
  program.set("rayCount", kRays);
  pass.dispatch(glm::ivec3(kRays, 1, 1), glm::ivec3(kRayGroup, 1, 1));
}

void LightVisibility::setCells(const gl::Program& program) const {
  program.set("lightCellsMin", min_);
  program.set("lightCellSize", cell_);
  program.set("lightCells", cells_);
}

void LightVisibility::bind(const gl::Program& program) const {
  setCells(program);
  counts_.bind(kCountsUnit);
}

}  // namespace lucerna
