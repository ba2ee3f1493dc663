#include "irradiance_cache/small_lamps.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace lucerna {

std::vector<glm::vec4> emissiveBodies(const Scene& scene, const glm::dvec3& origin) {
  // Sets of places that triangles connect: each place points to another of its set, the last one to itself.
  std::map<std::array<float, 3>, std::size_t> places;
  std::vector<std::size_t> next;
  const auto lastOf = [&](std::size_t place) {
    while (next[place] != place) place = next[place] = next[next[place]];
    return place;
  };
  for (const Mesh& mesh : scene.meshes) {
    const glm::vec3& emission = scene.materials[static_cast<std::size_t>(mesh.material)].emission;
    if (!(std::max({emission.x, emission.y, emission.z}) > 0.0f)) continue;
    for (std::uint32_t i = mesh.firstIndex; i < mesh.firstIndex + mesh.indexCount; ++i) {
      const glm::vec3& p = scene.vertices[scene.indices[i]].position;
      const std::size_t place = places.try_emplace({p.x, p.y, p.z}, places.size()).first->second;
      if (place == next.size()) next.push_back(place);
      const glm::vec3& first = scene.vertices[scene.indices[i - (i - mesh.firstIndex) % 3]].position;
      next[lastOf(place)] = lastOf(places.at({first.x, first.y, first.z}));
    }
  }

  std::vector<Bounds> bounds(next.size());
  for (const auto& [p, place] : places) bounds[lastOf(place)].add(glm::dvec3(p[0], p[1], p[2]));
  std::vector<glm::vec4> bodies;
  for (const Bounds& b : bounds)
    if (!b.empty())
      bodies.emplace_back(glm::vec3(b.centre() - origin), static_cast<float>(0.5 * glm::length(b.extent())));
  std::ranges::sort(bodies, {}, &glm::vec4::w);
  return bodies;
}

}  // namespace lucerna
