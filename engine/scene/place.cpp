#include "scene/place.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

void move(Bounds& bounds, const glm::dvec3& origin) {
  if (bounds.empty()) return;
  bounds.min -= origin;
  bounds.max -= origin;
}

}  // namespace

glm::dvec3 floatingOrigin(const Bounds& bounds) {
  glm::dvec3 origin(0.0);
  if (bounds.empty()) return origin;
  for (int k = 0; k < 3; ++k) {
    const double low = bounds.min[k], high = bounds.max[k];
    const double near = std::min(std::abs(low), std::abs(high)), far = std::max(std::abs(low), std::abs(high));
    if ((low > 0.0 || high < 0.0) && far <= 2.0 * near)
      origin[k] = static_cast<double>(static_cast<float>(0.5 * low + 0.5 * high));
  }
  return origin;
}

Scene movedTo(const Scene& scene, const glm::dvec3& origin) {
  Scene moved = scene;
  for (Vertex& vertex : moved.vertices) vertex.position = glm::vec3(glm::dvec3(vertex.position) - origin);
  for (Mesh& mesh : moved.meshes) move(mesh.bounds, origin);
  move(moved.bounds, origin);
  if (moved.mainBounds) move(*moved.mainBounds, origin);
  for (SpotLight& light : moved.spots) light.position -= origin;
  for (PointLight& light : moved.points) light.position -= origin;
  for (Camera& camera : moved.cameras) camera.position -= origin;
  for (Medium& medium : moved.media)
    if (medium.grid) {
      medium.grid->min -= origin;
      medium.grid->max -= origin;
    }
  return moved;
}

}  // namespace lucerna
