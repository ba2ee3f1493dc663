// Form factors in double precision, made without the engine: closed forms for rectangles and points, and a matrix of
// rectangles.
#pragma once

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace lucerna::reference {

/// Share of the hemisphere about `normal` at `point` that a polygon (either sense) fills, cosine-weighted; what lies
/// below the horizon is cut off.
double pointToPolygon(const glm::dvec3& point, const glm::dvec3& normal, std::span<const glm::dvec3> polygon);

/// Unit squares face to face at a distance: closed form.
double opposedSquares(double distance);

struct Rectangle {
  glm::dvec3 corner, u, v;  // front along cross(u, v)
  double area() const { return glm::length(glm::cross(u, v)); }
};
/// Mean over `from`, by order x order points of Gauss-Legendre, of pointToPolygon; nothing between the two.
double areaToArea(const Rectangle& from, const Rectangle& to, int order = 4);

/// The walls of a unit cube in n x n squares each, floor, ceiling, back, front, left, right, fronts inwards.
std::vector<Rectangle> cubeSquares(int n);

}  // namespace lucerna::reference
