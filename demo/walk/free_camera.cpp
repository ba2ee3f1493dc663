#include "walk/free_camera.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

constexpr double kRadiansPerPixel = 0.003, kOrbitPerPixel = 0.008;
constexpr double kSteepest = 1.55;  // just short of straight up, where the horizon would flip
constexpr double kDollyPerStep = 0.85;  // of the distance

}  // namespace

void FreeCamera::turn(const glm::dvec2& radians) {
  const double yaw = std::atan2(camera_.direction.x, -camera_.direction.z) + radians.x;
  const double pitch =
      std::clamp(std::asin(std::clamp(camera_.direction.y, -1.0, 1.0)) - radians.y, -kSteepest, kSteepest);
  camera_.direction = {std::cos(pitch) * std::sin(yaw), std::sin(pitch), -std::cos(pitch) * std::cos(yaw)};
  camera_.up = glm::cross(glm::dvec3(std::cos(yaw), 0.0, std::sin(yaw)), camera_.direction);
}

void FreeCamera::move(const HostInput& input, double seconds) {
  if (input.move == glm::dvec3(0.0)) return;
  turn(glm::dvec2(0.0));  // levels the horizon
  const glm::dvec3 right = glm::cross(camera_.direction, camera_.up);
  const double step = speed_ * seconds * (input.fast ? 4.0 : 1.0);
  camera_.position +=
      step * (input.move.x * right + glm::dvec3(0.0, input.move.y, 0.0) + input.move.z * camera_.direction);
}

void FreeCamera::look(const HostInput& input) {
  if (input.holds(MouseButton::left) && input.mouseDelta != glm::dvec2(0.0)) turn(kRadiansPerPixel * input.mouseDelta);
}

void FreeCamera::orbit(const HostInput& input, double distance, int height) {
  const bool pans = input.holds(MouseButton::middle) || (input.holds(MouseButton::left) && input.fast);
  if (pans) {
    const double seen = camera_.isOrthographic() ? static_cast<double>(camera_.orthographicHeight)
                                                 : 2.0 * distance * std::tan(0.5 * camera_.verticalFov);
    const glm::dvec3 right = glm::normalize(glm::cross(camera_.direction, camera_.up));
    const glm::dvec2 moved = seen / std::max(height, 1) * input.mouseDelta;
    camera_.position += moved.y * glm::cross(right, camera_.direction) - moved.x * right;
  } else if (input.holds(MouseButton::left) && input.mouseDelta != glm::dvec2(0.0)) {
    const glm::dvec3 pivot = camera_.position + distance * camera_.direction;
    turn(kOrbitPerPixel * input.mouseDelta);
    camera_.position = pivot - distance * camera_.direction;
  }
  if (input.wheel.y != 0.0) {
    const double left = std::pow(kDollyPerStep, input.wheel.y);
    if (camera_.isOrthographic()) camera_.orthographicHeight *= left;
    camera_.position += (1.0 - left) * distance * camera_.direction;
  }
}

}  // namespace lucerna::demo
