// The window's camera. First person: W A S D and Q E move, dragging with the left button looks around (the original's
// CControlCamera). Around a point, as viewers of models do: the left button orbits, the middle one pans, the wheel
// moves closer.
#pragma once

#include "host/host.hpp"
#include "scene/scene.hpp"

namespace lucerna::demo {

class FreeCamera {
 public:
  /// speed: scene units per second; shift multiplies it by four.
  FreeCamera(const Camera& camera, double speed) : camera_(camera), speed_(speed) {}

  void place(const Camera& camera) { camera_ = camera; }
  /// Moves by the keys held for `seconds`.
  void move(const HostInput& input, double seconds);
  /// Turns as the mouse was dragged. The horizon stays level.
  void look(const HostInput& input);
  /// Orbits, pans and dollies about the point that is `distance` before the camera, in a picture of this height in
  /// pixels.
  void orbit(const HostInput& input, double distance, int height);
  const Camera& camera() const { return camera_; }
  double speed() const { return speed_; }
  void setSpeed(double speed) { speed_ = speed; }
  void setFieldOfView(double radians) { camera_.verticalFov = radians; }

 private:
  void turn(const glm::dvec2& radians);

  Camera camera_;
  double speed_;
};

}  // namespace lucerna::demo
