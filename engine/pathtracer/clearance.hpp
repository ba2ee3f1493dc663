// How free of triangles the surroundings of a point are, so that a walk through a dense medium needs no rays (no GL).
//
// Lengths in scene units. For each cell of a box, with its centre c:
// - a ball of `radius` about c holds no triangle: from any point p the nearest one is at least radius - |p - c| away;
// - in the larger ball of `reach` all triangles lie beyond a plane: none has a point x with normal (x - c) < depth. Two
//   points of that ball on this side of the plane see each other, which a walk beside a wall needs.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace lucerna {

using Corners = std::array<glm::dvec3, 3>;

/// Distance from a point to a triangle; a triangle without area counts as its longest side.
double distanceTo(const Corners& triangle, const glm::dvec3& point);

/// As the shaders read it.
struct Clearance {
  std::uint32_t normal = 0;  ///< packed; points to the triangles
  float depth = 0.0f;
  float reach = 0.0f;  ///< 0: no plane serves
  float radius = 0.0f;  ///< rounded down. Infinite without triangles
};

struct ClearanceGrid {
  glm::dvec3 min{0.0};  ///< corner of the first cell
  double cell = 0.0;  ///< edge
  glm::ivec3 size{0};  ///< cells
  std::vector<Clearance> clearances;  ///< x fastest
};

/// `cells` along the box's longest side, a power of two. Uses all cores; corners that are not finite are ignored.
/// isBoundary: per triangle, whether it bounds the walk's medium, which is then behind it (the other side of its
/// normal); other triangles are seen from the cell. freePath: the mean one, which weighs a plane's reach against its
/// distance from the wall.
ClearanceGrid clearanceGrid(const std::vector<Corners>& triangles, const std::vector<bool>& isBoundary,
                            const glm::dvec3& min, const glm::dvec3& max, int cells, double freePath);

}  // namespace lucerna
