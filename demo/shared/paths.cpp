#include "shared/paths.hpp"

#include "scene/scene_file.hpp"

#include <cmath>

namespace lucerna::demo {

namespace {

// Once around the middle of the scene's bounds, looking at the centre.
std::vector<KeyFrame> orbit(const Scene& scene) {
  const glm::dvec3 centre = scene.bounds.centre();
  const Camera& first = scene.cameras.front();
  const glm::dvec3 arm = first.position - centre;
  std::vector<KeyFrame> keys;
  for (int i = 0; i <= 8; ++i) {
    const double angle = 2.0 * M_PI * i / 8.0;
    const glm::dvec3 turned(std::cos(angle) * arm.x + std::sin(angle) * arm.z, arm.y,
                            std::cos(angle) * arm.z - std::sin(angle) * arm.x);
    const glm::dvec3 direction = glm::length(turned) > 0.0 ? -glm::normalize(turned) : glm::dvec3(0.0, 0.0, -1.0);
    keys.push_back({centre + turned, direction, {0.0, 1.0, 0.0}, first.verticalFov});
  }
  return keys;
}

}  // namespace

Spline pathOf(const Scene& scene) {
  return Spline(scene.keyFrames.empty() ? orbit(scene) : keyFramesOf(scene, scene.keyFrames));
}

}  // namespace lucerna::demo
