// The sun's orthographic frustum around a scene (no GL, pure): shadow map and reflective shadow map share it.
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

namespace lucerna {

struct SunFrustum {
  glm::dmat4 clipFromWorld{1.0};
  double width = 1.0, height = 1.0;  ///< scene units across the rays

  /// Area across the rays of one texel of a map of size x size texels.
  double texelArea(int size) const { return width * height / (static_cast<double>(size) * size); }
};

/// Encloses every vertex of the scene, with a margin of 0.5 %. It does not depend on the camera, so nothing flickers.
SunFrustum fitSunFrustum(const Scene& scene, const glm::dvec3& sunDirection);

}  // namespace lucerna
