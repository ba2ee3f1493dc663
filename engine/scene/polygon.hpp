// Cuts polygons into triangles (no GL, pure).
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <span>
#include <vector>

namespace lucerna {

/// Appends the triangles of a polygon to `triangles`, as indices into `corners` plus `first`, wound as the polygon.
/// They cover what the polygon encloses: it may be concave, have corners on a line, repeated points, corners that touch
/// another one or an edge, and holes joined by a bridge (two edges back and forth). Of n corners they are n - 2; only
/// repeated points and edges that lead back make some of zero area. Of a polygon that crosses itself the result is some
/// cover of it.
void appendTriangles(std::span<const glm::dvec3> corners, unsigned first,
                     std::vector<std::array<unsigned, 3>>& triangles);

/// Twice the polygon's area along its normal (M. Newell's sum of cross products).
glm::dvec3 areaVector(std::span<const glm::dvec3> corners);

}  // namespace lucerna
