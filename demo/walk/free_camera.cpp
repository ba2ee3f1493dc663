#include "walk/free_camera.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

void FreeCamera::move(const HostInput& input, double seconds) {
  constexpr double kRadiansPerPixel = 0.003;
  constexpr double kSteepest = 1.55;  // just short of straight up, where the horizon would flip
  double yaw = std::atan2(camera_.direction.x, -camera_.direction.z);
  double pitch = std::asin(std::clamp(camera_.direction.y, -1.0, 1.0));
  yaw += kRadiansPerPixel * input.mouseDelta.x;
  pitch = std::clamp(pitch - kRadiansPerPixel * input.mouseDelta.y, -kSteepest, kSteepest);
  camera_.direction = {std::cos(pitch) * std::sin(yaw), std::sin(pitch), -std::cos(pitch) * std::cos(yaw)};
  const glm::dvec3 right(std::cos(yaw), 0.0, std::sin(yaw));
  camera_.up = glm::cross(right, camera_.direction);
  const double step = speed_ * seconds * (input.fast ? 4.0 : 1.0);
  camera_.position +=
      step * (input.move.x * right + glm::dvec3(0.0, input.move.y, 0.0) + input.move.z * camera_.direction);
}

}  // namespace lucerna::demo
