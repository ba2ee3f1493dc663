#include "walk/gizmo.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

constexpr float kReach = 7.0f;  // pixels: grabbing distance around an axis

std::vector<glm::dvec3*> lampsOf(Scene& scene) {
  std::vector<glm::dvec3*> lamps;
  for (SpotLight& light : scene.spots) lamps.push_back(&light.position);
  for (PointLight& light : scene.points) lamps.push_back(&light.position);
  return lamps;
}

glm::dvec3 axisOf(int axis) {
  glm::dvec3 direction(0.0);
  direction[axis] = 1.0;
  return direction;
}

double lengthOf(const Scene& scene) { return 0.08 * glm::length(scene.bounds.extent()); }

float distanceToSegment(const glm::vec2& p, const glm::vec2& a, const glm::vec2& b) {
  const glm::vec2 along = b - a;
  const float t = std::clamp(glm::dot(p - a, along) / std::max(glm::dot(along, along), 1e-6f), 0.0f, 1.0f);
  return glm::length(p - a - t * along);
}

}  // namespace

std::optional<glm::vec2> Gizmo::Screen::at(const glm::dvec3& place) const {
  const glm::vec4 clip = view.clipFromWorld * glm::vec4(glm::vec3(place - origin), 1.0f);
  if (clip.w < view.near) return {};
  const glm::vec2 inPicture = 0.5f * glm::vec2(clip) / clip.w + 0.5f;
  const glm::vec2 fromBelow = placement.middle + (inPicture - placement.centre) * placement.scale;
  return glm::vec2(fromBelow.x, static_cast<float>(height) - fromBelow.y);
}

bool Gizmo::take(Scene& scene, const Screen& screen, const glm::vec2& cursor, bool held) {
  const std::vector<glm::dvec3*> lamps = lampsOf(scene);
  if (held && !heldBefore_) {
    float nearest = kReach;
    for (std::size_t i = 0; i < lamps.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const auto from = screen.at(*lamps[i]), to = screen.at(*lamps[i] + lengthOf(scene) * axisOf(axis));
        if (!from || !to) continue;
        const float distance = distanceToSegment(cursor, *from, *to);
        if (distance >= nearest) continue;
        nearest = distance;
        grip_ = Grip{i, axis, cursor, *lamps[i]};
      }
  }
  heldBefore_ = held;
  if (!grip_ || grip_->lamp >= lamps.size()) {
    grip_.reset();
    return false;
  }
  // The lamp follows the cursor along the projected axis: the point on the axis whose projection is nearest to the
  // lamp's projection plus the cursor's drag.
  const glm::dvec3 axis = axisOf(grip_->axis);
  if (const auto from = screen.at(grip_->place), to = screen.at(grip_->place + lengthOf(scene) * axis);
      held && from && to) {
    const glm::vec2 along = *to - *from;
    const float pixels2 = glm::dot(along, along);
    if (pixels2 > 1.0f)
      *lamps[grip_->lamp] =
          grip_->place + lengthOf(scene) * static_cast<double>(glm::dot(cursor - grip_->start, along) / pixels2) * axis;
  }
  if (!held) grip_.reset();
  return true;
}

std::vector<gl::Lines::Line> Gizmo::lines(const Scene& scene, const glm::dvec3& origin) const {
  std::vector<gl::Lines::Line> lines;
  std::vector<glm::dvec3> places;
  for (const SpotLight& light : scene.spots) places.push_back(light.position);
  for (const PointLight& light : scene.points) places.push_back(light.position);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const glm::dvec3& place = places[i];
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec4 color(0.25f, 0.25f, 0.25f, 1.0f);
      color[axis] = 1.0f;
      if (grip_ && grip_->lamp == i && grip_->axis == axis) color = {1.0f, 1.0f, 0.3f, 1.0f};
      lines.push_back({glm::vec3(place - origin), glm::vec3(place + lengthOf(scene) * axisOf(axis) - origin), color});
    }
  }
  return lines;
}

}  // namespace lucerna::demo
