// Scenes of the stability rows, made in memory: a room without a roof, one wall missing, lit by the sun; and what else
// its parts can make.
#pragma once

#include "scene/scene.hpp"

#include <initializer_list>
#include <string>
#include <vector>

namespace lucerna::demo::bench {

struct Room {
  double scale = 1.0;
  glm::dvec3 place{0.0};  ///< of its middle, scene units
  float albedo = 0.7f, irradiance = 3.0f;
  glm::dvec3 sun{-0.35, -1.0, -0.1};
  glm::vec3 emission{0.0f};  ///< of all surfaces
  bool closed = false;  ///< with roof and all walls, the camera inside
  bool badTriangles = false;  ///< zero area, slivers, twice the same
};

Scene makeRoom(const Room& room);

/// A scene of few surfaces, made by hand.
class SceneParts {
 public:
  explicit SceneParts(std::string name) { scene_.name = std::move(name); }
  /// Its index.
  int material(const glm::vec3& albedo, const glm::vec3& emission = glm::vec3(0.0f));
  Material& materialAt(int index) { return scene_.materials[static_cast<std::size_t>(index)]; }
  void triangles(const std::vector<glm::dvec3>& corners, const glm::vec3& normal, int material,
                 std::initializer_list<std::uint32_t> order);
  /// A rectangle, front along cross(u, v).
  void plate(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, int material);
  /// A closed box, fronts outwards.
  void box(const glm::dvec3& min, const glm::dvec3& max, int material);
  Scene& scene() { return scene_; }

 private:
  Scene scene_;
};

}  // namespace lucerna::demo::bench
