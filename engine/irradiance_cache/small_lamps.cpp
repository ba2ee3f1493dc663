#include "irradiance_cache/small_lamps.hpp"

#include "scene/parts.hpp"

#include <algorithm>

namespace lucerna {

std::vector<glm::vec4> emissiveBodies(const Scene& scene, const glm::dvec3& origin) {
  const std::vector<Bounds> parts = connectedParts(scene, [&](const Mesh& mesh) {
    const glm::vec3& emission = scene.materials[static_cast<std::size_t>(mesh.material)].emission;
    return std::max({emission.x, emission.y, emission.z}) > 0.0f;
  });
  std::vector<glm::vec4> bodies;
  for (const Bounds& b : parts)
    bodies.emplace_back(glm::vec3(b.centre() - origin), static_cast<float>(0.5 * glm::length(b.extent())));
  std::ranges::sort(bodies, {}, &glm::vec4::w);
  return bodies;
}

}  // namespace lucerna
