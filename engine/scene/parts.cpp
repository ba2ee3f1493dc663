#include "scene/parts.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>
#include <unordered_map>

namespace lucerna {

namespace {

struct PlaceHash {
  std::size_t operator()(const glm::vec3& p) const {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k)  // + 0: the two zeros are one place
      hash = (hash ^ std::bit_cast<std::uint32_t>(p[k] + 0.0f)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return static_cast<std::size_t>(hash);
  }
};

}  // namespace

std::vector<Bounds> connectedParts(const Scene& scene, const std::function<bool(const Mesh&)>& isWanted) {
  // Sets of places: each points to another of its set, the last one to itself.
  std::unordered_map<glm::vec3, std::size_t, PlaceHash> places;
  std::vector<std::size_t> next;
  std::vector<glm::vec3> positions;
  const auto lastOf = [&](std::size_t place) {
    while (next[place] != place) place = next[place] = next[next[place]];
    return place;
  };
  for (const Mesh& mesh : scene.meshes) {
    if (!isWanted(mesh)) continue;
    std::size_t first = 0;  // of the triangle
    for (std::uint32_t i = 0; i < mesh.indexCount; ++i) {
      const glm::vec3& p = scene.vertices[scene.indices[mesh.firstIndex + i]].position;
      const std::size_t place = places.try_emplace(p, next.size()).first->second;
      if (place == next.size()) next.push_back(place), positions.push_back(p);
      if (i % 3 == 0) first = place;
      next[lastOf(place)] = lastOf(first);
    }
  }

  std::vector<Bounds> bounds(next.size()), parts;
  for (std::size_t place = 0; place < next.size(); ++place) bounds[lastOf(place)].add(glm::dvec3(positions[place]));
  std::ranges::copy_if(bounds, std::back_inserter(parts), [](const Bounds& b) { return !b.empty(); });
  return parts;
}

std::vector<Bounds> partsLargeInView(const Scene& scene) {
  constexpr double kLeastShare = 0.05;
  std::vector<Bounds> parts = connectedParts(scene, [](const Mesh&) { return true; });
  std::erase_if(parts, [&](const Bounds& part) {
    return std::ranges::none_of(scene.cameras, [&](const Camera& camera) {
      const double distance = glm::distance(glm::clamp(camera.position, part.min, part.max), camera.position);
      const double height = 2.0 * camera.halfHeight() * (camera.isOrthographic() ? 1.0 : distance);
      return glm::length(part.extent()) >= kLeastShare * height;
    });
  });
  return parts;
}

}  // namespace lucerna
