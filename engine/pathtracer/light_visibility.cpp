#include "pathtracer/light_visibility.hpp"

#include "gl/pass.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lucerna {

namespace {

constexpr GLuint kPointsBinding = 5, kCountsBinding = 6;  // GL_SHADER_STORAGE_BUFFER
constexpr GLuint kCountsUnit = 6;
constexpr int kPointsAGroup = 64;

}  // namespace

std::vector<glm::uvec4> pointsOnSurfaces(const Scene& scene, int count) {
  std::vector<double> ends(scene.triangleCount());  // of the triangles' shares of the area
  double area = 0.0;
  for (std::size_t t = 0; t < ends.size(); ++t) {
    const auto corner = [&](std::size_t k) { return glm::dvec3(scene.vertices[scene.indices[3 * t + k]].position); };
    const double own = 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
    if (std::isfinite(own)) area += own;
    ends[t] = area;
  }
  std::vector<glm::uvec4> points;
  if (!(area > 0.0) || !std::isfinite(area)) return points;
  for (int i = 0; i < count; ++i) {
    const auto at = std::upper_bound(ends.begin(), ends.end(), (i + 0.5) / count * area);
    const auto triangle = static_cast<std::uint32_t>(std::min(at - ends.begin(), std::ssize(ends) - 1));
    // The additive sequence of the plastic number, folded into the triangle [Roberts2018].
    double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    points.emplace_back(triangle, std::bit_cast<std::uint32_t>(static_cast<float>(u)),
                        std::bit_cast<std::uint32_t>(static_cast<float>(v)), 0u);
  }
  return points;
}

LightVisibility::LightVisibility(gl::ProgramLibrary& programs, const Scene& scene, const PathScene& traced,
                                 const gl::Buffer& constants) {
  const glm::dvec3 extent = scene.bounds.extent();
  const double cell = std::max({extent.x, extent.y, extent.z, 1e-30}) / kCells;
  cell_ = static_cast<float>(cell);
  min_ = glm::vec3(scene.bounds.min - traced.origin());
  cells_ = glm::clamp(glm::ivec3(glm::ceil(extent / cell)), glm::ivec3(1), glm::ivec3(kCells));
  const std::vector<glm::uvec2> zeros(static_cast<std::size_t>(cells_.x * cells_.y * cells_.z * kKinds));
  counts_ = gl::BufferTexture("light visibility", gl::Format::r32ui, zeros.size() * sizeof zeros[0], zeros.data(),
                              gl::Usage::dynamicCopy);
  const std::vector<glm::uvec4> points = pointsOnSurfaces(scene, kPoints);
  if (points.empty()) return;
  const gl::Buffer pointBuffer("light visibility points", points.size() * sizeof points[0], points.data(),
                               gl::Usage::staticDraw);
  const gl::Program& program = programs.loadCompute(
      "light visibility", "pathtracer/light_visibility.comp",
      gl::with(traced.flags(), {{"LINEAR_SEEDS", 0}, {"GLOSSY", 0}, {"SHARED_STACK", traced.rays().sharedStack()}}));
  const gl::ComputePass pass("light visibility", gl::Barrier::textureFetch, gl::Barrier::storage);
  program.use();
  constants.bindUniform(0);
  traced.bind();
  pointBuffer.bindStorage(kPointsBinding);
  counts_.buffer().bindStorage(kCountsBinding);
  setCells(program);
  program.set("pointCount", static_cast<int>(points.size()));
  pass.dispatch(glm::ivec3(static_cast<int>(points.size()), 1, 1), glm::ivec3(kPointsAGroup, 1, 1));
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
