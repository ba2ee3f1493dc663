#include "support/rsm_maps.hpp"

#include <cmath>
#include <random>

namespace lucerna::test {

reference::RsmMap cornerMap(glm::ivec2 size) {
  reference::RsmMap map;
  map.size = size;
  map.corner = {0.0, -50.0, 0.0};
  map.right = {0.0, 1.0, 0.0};
  map.up = {0.0, 0.0, 1.0};
  map.direction = {-1.0, 0.0, 0.0};
  map.width = 100.0;
  map.height = kCornerHeight;
  map.texels.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x)
      map.at(x, y) = {map.rayOrigin(x, y), {1.0, 0.0, 0.0}, glm::dvec3(map.texelArea()), 1.0, true};
  return map;
}

double cornerIrradiance(double h) { return 0.5 * (1.0 - h / std::hypot(h, kCornerHeight)); }

reference::RsmMap randomMap(glm::ivec2 size, std::uint32_t seed, double scale) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0), both(-1.0, 1.0);
  reference::RsmMap map;
  map.size = size;
  map.direction = glm::normalize(glm::dvec3(0.3, -1.0, 0.4));
  map.right = glm::normalize(glm::cross(map.direction, glm::dvec3(0.0, 1.0, 0.0)));
  map.up = glm::cross(map.right, map.direction);
  map.width = 12.0 * scale;
  map.height = 9.0 * scale;
  map.corner = -0.5 * (map.right * map.width + map.up * map.height);
  map.texels.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      glm::dvec3 normal;
      do normal = glm::dvec3(both(random), both(random), both(random));
      while (glm::length(normal) > 1.0 || glm::length(normal) < 0.1 ||
             std::abs(glm::dot(normal, map.direction)) < 0.02);
      normal = glm::normalize(normal);
      if (glm::dot(normal, map.direction) > 0.0) normal = -normal;
      const glm::dvec3 position = map.rayOrigin(x, y) + map.direction * (3.0 * scale * both(random));
      const glm::dvec3 flux = glm::dvec3(unit(random), unit(random), unit(random)) * map.texelArea();
      map.at(x, y) = {position, normal, flux, -glm::dot(normal, map.direction), unit(random) > 0.1};
    }
  return map;
}

void roundToFloat(reference::RsmMap& map) {
  for (reference::RsmMap::Texel& texel : map.texels) {
    texel.position = glm::dvec3(glm::vec3(texel.position));
    texel.normal = glm::dvec3(glm::vec3(texel.normal));
    texel.flux = glm::dvec3(glm::vec3(texel.flux));
    texel.cosine = static_cast<double>(static_cast<float>(texel.cosine));
  }
}

std::vector<SurfacePoint> randomPoints(const reference::RsmMap& map, int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> both(-1.0, 1.0);
  std::vector<SurfacePoint> points;
  const double scale = map.width / 12.0;
  while (static_cast<int>(points.size()) < count) {
    const glm::dvec3 normal(both(random), both(random), both(random));
    if (glm::length(normal) < 0.1) continue;
    const glm::dvec3 position = map.corner + map.right * (map.width * (0.5 + 0.4 * both(random))) +
                                map.up * (map.height * (0.5 + 0.4 * both(random))) +
                                map.direction * (3.0 * scale * both(random));
    points.push_back({glm::dvec3(glm::vec3(position)), glm::dvec3(glm::vec3(glm::normalize(normal)))});
  }
  return points;
}

}  // namespace lucerna::test
