// First-person camera: W A S D and Q E move, dragging with the left button looks around (the original's
// CControlCamera).
#pragma once

#include "host/host.hpp"
#include "scene/scene.hpp"

namespace lucerna::demo {

class FreeCamera {
 public:
  /// speed: scene units per second; shift multiplies it by four.
  FreeCamera(const Camera& camera, double speed) : camera_(camera), speed_(speed) {}

  void place(const Camera& camera) { camera_ = camera; }
  /// Moves according to the keyboard and mouse input of the last `seconds`. The horizon stays level.
  void move(const HostInput& input, double seconds);
  const Camera& camera() const { return camera_; }
  double speed() const { return speed_; }
  void setSpeed(double speed) { speed_ = speed; }
  void setFieldOfView(double radians) { camera_.verticalFov = radians; }

 private:
  Camera camera_;
  double speed_;
};

}  // namespace lucerna::demo
