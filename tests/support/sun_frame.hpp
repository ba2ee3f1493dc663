// The frame's uniform block as a map of the sun needs it.
#pragma once

#include "forward/sun_frustum.hpp"
#include "gl/objects.hpp"
#include "shared/frame.h"

namespace lucerna::test {

/// Binds the sun of a scene, seen by that frustum, to block 0 for as long as the buffer lives.
inline gl::Buffer bindSunFrame(const Scene& scene, const SunFrustum& frustum) {
  shared::FrameConstants frame{};
  frame.sunClipFromWorld = glm::mat4(frustum.clipFromWorld);
  frame.sunDirection = glm::vec3(scene.sun->direction);
  frame.sunIrradiance = scene.sun->irradiance;
  gl::Buffer constants("frame", sizeof frame, &frame, gl::Usage::staticDraw);
  constants.bindUniform(0);
  return constants;
}

}  // namespace lucerna::test
