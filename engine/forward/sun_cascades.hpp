// Cascaded shadow maps of the sun: placement of the cascades (no GL, pure).
//
// The view frustum is cut along its depth by the practical split scheme [Zhang2006, section 3.2]: C_i = lambda n
// (f/n)^(i/m) + (1 - lambda) (n + (f - n) i/m). A cascade is the square around its slice's bounding sphere, across the
// rays: its size does not depend on the camera's direction. Its centre moves by whole texels of a grid fixed in the
// world, so its texels stay where they are while the camera moves and turns: nothing shimmers. In depth it covers the
// whole scene, so that casters anywhere towards the sun are included. A cascade that would be larger than the scene is
// the scene's own frustum.
#pragma once

#include "forward/sun_frustum.hpp"
#include "scene/scene.hpp"
#include "shared/sun_cascades.h"

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace lucerna {

struct SunCascadeSettings {
  static constexpr int kAuto = 0;
  int cascades = kAuto;  ///< 1: one map for the whole scene, no cascades at all; at most SUN_MAX_CASCADES, which is
                         ///< also what kAuto means where one map's texels are too wide for a mesh or a part in view
  double split = 0.9;  ///< lambda: 0 uniform, 1 logarithmic. Near planes lie at 1/2000 of the scene, so 0.5 would be
                       ///< nearly uniform
};

/// Whether a part of a scene has too few texels of a map across to have a shadow. texel: their width there.
bool hasFewTexels(const Bounds& part, double texel);

/// The number of cascades that kAuto stands for. texel: side of a texel of a map of the whole scene, scene units;
/// parts: those that a picture shows large (scene/parts.hpp).
int neededCascades(const Scene& scene, std::span<const Bounds> parts, double texel);

/// The split distances along the view axis, cascades + 1 of them, from near to far exactly. 0 < near < far.
std::vector<double> splitDistances(double near, double far, int cascades, double lambda);

struct SunCascade {
  glm::dmat4 clipFromWorld{1.0};
  double texel = 1.0;  ///< side of a texel, scene units
};

/// Finest first. The depth range that is split reaches from `near` to the first of diagonal * 2^(i/4), i = 0, 1, ...,
/// that contains the whole scene, so that sizes do not change with every camera movement. mapSize: texels per side;
/// aspect: width over height.
std::vector<SunCascade> placeSunCascades(const SunCascadeSettings& settings, const Scene& scene,
                                         const glm::dvec3& sunDirection, const SunFrustum& whole, const Camera& camera,
                                         double aspect, double near, int mapSize);

}  // namespace lucerna
