// Distances from points in a box to the nearest triangle, so that a walk through a dense medium needs no rays (no GL).
//
// Lengths in scene units. Exact distances at the centres of cubic cells; from any point p the nearest triangle is at
// least radius(c) - |p - c| away, whichever cell's centre c is.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <vector>

namespace lucerna {

using Corners = std::array<glm::dvec3, 3>;

/// Distance from a point to a triangle; a triangle without area counts as its longest side.
double distanceTo(const Corners& triangle, const glm::dvec3& point);

struct ClearanceGrid {
  glm::dvec3 min{0.0};  ///< corner of the first cell
  double cell = 0.0;  ///< edge
  glm::ivec3 size{0};  ///< cells
  std::vector<float> radius;  ///< x fastest; rounded down. Infinite without triangles
};

/// `cells` along the box's longest side, a power of two. Uses all cores; corners that are not finite are ignored.
ClearanceGrid clearanceGrid(const std::vector<Corners>& triangles, const glm::dvec3& min, const glm::dvec3& max,
                            int cells);

}  // namespace lucerna
