// Emissive surfaces as bodies: connected triangles and a ball around them. Records close to a small one hold light that
// changes within a cell (shaders/irradiance_cache/small_lamps.glsl). No GL, pure.
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <vector>

namespace lucerna {

/// Around each set of emissive triangles that share corners: centre less `origin`; w: radius. Smallest first.
std::vector<glm::vec4> emissiveBodies(const Scene& scene, const glm::dvec3& origin);

}  // namespace lucerna
