// A scene moved near the origin (no GL, pure): what the GPU computes in float is then rounded by the scene's size, not by its place.
#pragma once

#include "scene/scene.hpp"

namespace lucerna {

/// Where the middle of `bounds` is, along each axis on which all of them lie between m and 2 m from zero: there the difference of any coordinate and this
/// origin is exact in float [Sterbenz1974]. 0 along the others, whose coordinates are no larger than twice the bounds' extent. A float along each axis.
glm::dvec3 exactOrigin(const Bounds& bounds);

/// `scene` seen from `origin`: surfaces, lamps, media, cameras and bounds. Exact for the origin of its own bounds.
Scene movedTo(const Scene& scene, const glm::dvec3& origin);

}  // namespace lucerna
