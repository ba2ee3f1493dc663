// Camera rays through the centres of a picture's pixels, in double precision, made without the engine.
#pragma once

#include "scene/scene.hpp"

#include <cmath>

namespace lucerna::test {

/// Direction (length arbitrary) through the centre of the pixel (x, y), top row first; perspective.
inline glm::dvec3 pixelRay(const Camera& camera, int x, int y, glm::ivec2 size) {
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up));
  const glm::dvec3 up = glm::cross(right, camera.direction);
  const double t = std::tan(0.5 * camera.verticalFov), aspect = static_cast<double>(size.x) / size.y;
  return camera.direction + ((2.0 * x + 1.0) / size.x - 1.0) * t * aspect * right +
         (1.0 - (2.0 * y + 1.0) / size.y) * t * up;
}

/// Where that ray meets the plane of height `y`.
inline glm::dvec3 onPlane(const Camera& camera, const glm::dvec3& ray, double y) {
  return camera.position + (y - camera.position.y) / ray.y * ray;
}

}  // namespace lucerna::test
