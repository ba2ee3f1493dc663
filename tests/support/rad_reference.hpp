// Radiosity in double precision, without pictures: closed-form factors from a point to polygons that see each other
// wholly.
#pragma once

#include "radiosity/original/rad_file.hpp"

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace lucerna::test {

/// The share of the hemisphere about `normal`, cosine weighted, that a triangle covers: Lambert's formula. The triangle
/// lies above the horizon.
double pointToTriangle(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& a, const glm::dvec3& b,
                       const glm::dvec3& c);

/// The number received at every triangle's centroid, all seeing all (a convex hollow): Jacobi until nothing changes by
/// 1e-12.
std::vector<double> receivedInConvex(std::span<const RadTriangle> triangles);

/// The unit cube from within, `n` x `n` cells of two triangles a face; the light is the middle 2 x 2 cells of the
/// ceiling. Power e, everything reflects ro.
std::vector<RadTriangle> litUnitCube(int n, float ro, std::uint32_t e);

/// The unit sphere from within: an icosahedron halved `levels` times along every edge; those whose middle lies above
/// `y` emit e.
std::vector<RadTriangle> sphereInside(int levels, float ro, double y, std::uint32_t e);

}  // namespace lucerna::test
