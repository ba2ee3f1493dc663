#include "rays/view_rays.hpp"

namespace lucerna {

void setView(shared::PathConstants& constants, const Camera& camera, const glm::dvec3& origin, glm::ivec2 size,
             const glm::dvec2& offset) {
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                   up = glm::cross(right, camera.direction);
  const double pixel = 2.0 * camera.halfHeight() / size.y;
  constants.pixelRight = glm::vec3(pixel * right);
  constants.pixelUp = glm::vec3(pixel * up);
  constants.isOrthographic = camera.isOrthographic();
  const glm::dvec3 moved = pixel * (offset.x * right + offset.y * up);
  if (camera.isOrthographic()) {
    constants.cameraPosition = glm::vec3(camera.position + moved - origin);
    constants.firstPixel = glm::vec3(camera.direction);
  } else {
    constants.cameraPosition = glm::vec3(camera.position - origin);
    constants.firstPixel =
        glm::vec3(camera.direction - 0.5 * size.x * pixel * right - 0.5 * size.y * pixel * up + moved);
  }
}

}  // namespace lucerna
