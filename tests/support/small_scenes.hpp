// Scenes of a few triangles, made in memory.
#pragma once

#include "scene/scene.hpp"

namespace lucerna::test {

/// An empty scene with a sun; add plates, then finish().
class SceneBuilder {
 public:
  SceneBuilder();
  /// Its index.
  int material(const glm::vec3& albedo);
  Material& materialAt(int index) { return scene_.materials[static_cast<std::size_t>(index)]; }
  /// A picture of 4 bytes a texel, top row first; its index.
  int texture(int width, int height, std::vector<std::uint8_t> rgba, bool hasAlpha = false);
  /// A rectangle, front along cross(edgeU, edgeV), texture coordinates 0..1; `normalSign` -1 turns the vertex normals
  /// to the back.
  void plate(const glm::dvec3& centre, const glm::dvec3& edgeU, const glm::dvec3& edgeV, int material,
             float normalSign = 1.0f);
  void triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int material);
  void sun(const glm::dvec3& direction, const glm::vec3& irradiance);
  Scene& scene() { return scene_; }

 private:
  Scene scene_;
};

/// A camera at `position` that looks at `target`.
Camera lookingAt(const glm::dvec3& position, const glm::dvec3& target, double verticalFov = 0.9);

/// A smooth scene: a room of side 10 about the origin, no roof, the wall towards +z missing, walls of different
/// colours; the sun falls in from above and the right, so that floor and left wall are lit in part.
Scene openBox(double scale = 1.0);
Camera openBoxCamera(double scale = 1.0);

}  // namespace lucerna::test
