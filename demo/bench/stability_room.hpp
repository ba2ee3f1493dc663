// Scenes of the stability rows, built in memory: a room without a roof and with one wall missing, lit by the sun; and
// other scenes from the same parts.
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
  glm::vec3 emission{0.0f};  ///< for all surfaces
  bool closed = false;  ///< with roof and all walls, the camera inside
  bool badTriangles = false;  ///< zero area, slivers, duplicates
};

Scene makeRoom(const Room& room);

/// A scene of a few surfaces.
class SceneParts {
 public:
  explicit SceneParts(std::string name) { scene_.name = std::move(name); }
  /// Returns its index.
  int material(const glm::vec3& albedo, const glm::vec3& emission = glm::vec3(0.0f));
  Material& materialAt(int index) { return scene_.materials[static_cast<std::size_t>(index)]; }
  void triangles(const std::vector<glm::dvec3>& corners, const glm::vec3& normal, int material,
                 std::initializer_list<std::uint32_t> order);
  /// A rectangle whose front faces cross(u, v).
  void plate(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, int material);
  /// A closed box, fronts facing out.
  void box(const glm::dvec3& min, const glm::dvec3& max, int material);
  Scene& scene() { return scene_; }

 private:
  Scene scene_;
};

}  // namespace lucerna::demo::bench
