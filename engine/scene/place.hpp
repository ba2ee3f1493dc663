// A scene moved near the origin (no GL, pure): float rounding then depends on the scene's size, not on its position.
#pragma once

#include "scene/scene.hpp"

namespace lucerna {

/// The middle of `bounds` along each axis on which they lie between m and 2 m from zero: there the difference of any
/// coordinate and this origin is exact in float [Sterbenz1974]. 0 along the other axes, whose coordinates are at most
/// twice the bounds' extent. Representable in float.
glm::dvec3 floatingOrigin(const Bounds& bounds);

/// `scene` relative to `origin`: surfaces, lamps, media, cameras and bounds. Exact for floatingOrigin() of its own
/// bounds.
Scene movedTo(const Scene& scene, const glm::dvec3& origin);

}  // namespace lucerna
