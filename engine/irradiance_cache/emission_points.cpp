#include "irradiance_cache/emission_points.hpp"

#include "base/angles.hpp"
#include "base/radical_inverse.hpp"
#include "base/error.hpp"
#include "scene/texture_mean.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace lucerna {

namespace {

/// Every third bit, from the lowest of ten.
std::uint32_t spread3(std::uint32_t v) {
  std::uint32_t result = 0;
  for (std::uint32_t bit = 0; bit < 10; ++bit) result |= (v >> bit & 1u) << 3 * bit;
  return result;
}
/// The even bits of a number: x of a place along the curve of [Morton1966]; of number / 2 they are y.
std::uint32_t evenBits(std::uint32_t v) {
  std::uint32_t result = 0;
  for (std::uint32_t bit = 0; bit < 16; ++bit) result |= (v >> 2 * bit & 1u) << bit;
  return result;
}

struct Emitter {
  std::array<glm::dvec3, 3> corners;
  std::array<glm::vec2, 3> texCoords;
  const Material* material;
  double area, weight;  ///< weight: probability of picking it
  std::uint64_t order;  ///< faces of one way together, neighbours next to each other
};

std::uint64_t orderOf(const Bounds& bounds, const glm::dvec3& at, const glm::dvec3& normal) {
  const glm::dvec3 extent = glm::max(bounds.extent(), glm::dvec3(1e-300));
  const glm::uvec3 cell(glm::clamp((at - bounds.min) / extent * 1023.0, glm::dvec3(0.0), glm::dvec3(1023.0)));
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  const auto face = static_cast<std::uint64_t>(2 * axis + (normal[axis] < 0.0 ? 1 : 0));
  return face << 30 | (spread3(cell.x) | spread3(cell.y) << 1 | spread3(cell.z) << 2);
}

std::vector<Emitter> emittersOf(const Scene& scene, const std::vector<float>& pickDensity) {
  std::vector<Emitter> emitters;
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    for (std::uint32_t i = mesh.firstIndex; i + 2 < mesh.firstIndex + mesh.indexCount; i += 3) {
      if (pickDensity.empty() || !(pickDensity[i / 3] > 0.0f)) continue;
      Emitter emitter{};
      for (std::uint32_t k = 0; k < 3; ++k) {
        const Vertex& vertex = scene.vertices[scene.indices[i + k]];
        emitter.corners[k] = glm::dvec3(vertex.position);
        emitter.texCoords[k] = vertex.texCoord;
      }
      const glm::dvec3 cross =
          glm::cross(emitter.corners[1] - emitter.corners[0], emitter.corners[2] - emitter.corners[0]);
      emitter.material = &material;
      emitter.area = 0.5 * glm::length(cross);
      emitter.weight = static_cast<double>(pickDensity[i / 3]) * emitter.area;
      if (!(emitter.weight > 0.0) || !std::isfinite(emitter.weight)) continue;
      emitter.order =
          orderOf(scene.main(), (emitter.corners[0] + emitter.corners[1] + emitter.corners[2]) / 3.0, cross);
      emitters.push_back(emitter);
    }
  }
  std::stable_sort(emitters.begin(), emitters.end(),
                   [](const Emitter& a, const Emitter& b) { return a.order < b.order; });
  return emitters;
}

struct Point {
  glm::dvec3 position, normal, flux;
  double area;
  std::uint64_t order;
};

/// `count` points of a triangle of which `expected` were, each with the picture's mean around it. Together they emit
/// what the triangle does; of triangles with less than one point each, those with a point emit for the others.
void addPoints(const Scene& scene, const Emitter& emitter, std::uint32_t count, double expected,
               std::vector<Point>& points) {
  const Material& material = *emitter.material;
  const Texture* picture =
      material.emissionTexture >= 0 ? &scene.textures[static_cast<std::size_t>(material.emissionTexture)] : nullptr;
  const std::size_t first = points.size();
  glm::dvec3 sum(0.0);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double root = std::sqrt((i + 0.5) / count), turn = radicalInverse(i) + 0.5 / count;
    const double b = root * (1.0 - turn), c = root * turn, a = 1.0 - b - c;
    Point point{};
    point.position = a * emitter.corners[0] + b * emitter.corners[1] + c * emitter.corners[2];
    point.flux = glm::dvec3(material.emission);
    if (picture) {
      const auto& uv = emitter.texCoords;
      const glm::vec2 at =
                          static_cast<float>(a) * uv[0] + static_cast<float>(b) * uv[1] + static_cast<float>(c) * uv[2],
                      middle = (uv[0] + uv[1] + uv[2]) / 3.0f;
      const float shrink = 1.0f / std::sqrt(static_cast<float>(count));
      point.flux = glm::dvec3(material.emissionScale) *
                   meanTexture(*picture, {at + shrink * (uv[0] - middle), at + shrink * (uv[1] - middle),
                                          at + shrink * (uv[2] - middle)});
    }
    point.normal =
        glm::normalize(glm::cross(emitter.corners[1] - emitter.corners[0], emitter.corners[2] - emitter.corners[0]));
    point.area = emitter.area / expected;
    sum += point.flux;
    points.push_back(point);
  }
  const glm::dvec3 radiance = picture ? glm::dvec3(material.emissionScale) * meanTexture(*picture, emitter.texCoords)
                                      : glm::dvec3(material.emission);
  const double stands = emitter.area / std::max(expected < 1.0 ? expected : count, 1e-300);
  for (std::size_t i = first; i < points.size(); ++i)
    for (int channel = 0; channel < 3; ++channel)
      points[i].flux[channel] =
          sum[channel] > 0.0 ? points[i].flux[channel] * radiance[channel] * count / sum[channel] * kPi * stands : 0.0;
}

}  // namespace

EmissionPoints emissionPoints(const Scene& scene, const std::vector<float>& pickDensity, const glm::dvec3& origin,
                              int size) {
  CHECK(size >= 2 && std::has_single_bit(static_cast<unsigned>(size)), "size = {}", size);
  const auto texels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  EmissionPoints result;
  result.size = size;
  for (auto* values : {&result.position, &result.normal, &result.flux}) values->assign(texels, glm::vec4(0.0f));
  const std::vector<Emitter> emitters = emittersOf(scene, pickDensity);
  double total = 0.0;
  for (const Emitter& emitter : emitters) total += emitter.weight;
  if (!(total > 0.0)) return result;

  // Systematic sampling of half the texels: the other half is the triangles' other sides.
  const double wanted = 0.5 * static_cast<double>(texels);
  result.areaOverDensity = total / wanted;
  std::vector<Point> points;
  double reached = 0.0;
  for (const Emitter& emitter : emitters) {
    const double expected = wanted * emitter.weight / total, before = reached;
    reached += expected;
    const auto count = static_cast<std::uint32_t>(std::floor(reached + 0.5 - 1e-9) - std::floor(before + 0.5 - 1e-9));
    if (count > 0) addPoints(scene, emitter, count, expected, points);
  }
  const std::size_t sides = std::min(points.size(), texels / 2);
  points.resize(sides);
  for (std::size_t i = 0; i < sides; ++i) {
    points.push_back(points[i]);
    points.back().normal = -points[i].normal;
  }
  for (Point& point : points) point.order = orderOf(scene.main(), point.position, point.normal);
  std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.order < b.order; });
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto place = static_cast<std::uint32_t>(i);
    const std::size_t texel = static_cast<std::size_t>(evenBits(place >> 1)) * static_cast<std::size_t>(size) +
                              static_cast<std::size_t>(evenBits(place));
    result.position[texel] = glm::vec4(glm::vec3(points[i].position - origin), 1.0f);
    result.normal[texel] = glm::vec4(glm::vec3(points[i].normal), 1.0f);
    result.flux[texel] = glm::vec4(glm::vec3(points[i].flux), static_cast<float>(points[i].area));
  }
  return result;
}

}  // namespace lucerna
