// Closed and open scenes for radiosity, as patches made in memory.
#pragma once

#include "radiosity/solution.hpp"
#include "support/small_scenes.hpp"

#include <functional>

namespace lucerna::test {

/// A material of one reflectance and one emitted exitance.
int lambertian(SceneBuilder& builder, double reflectance, double exitance = 0.0);

/// The inside of a cube of side 1 about the origin, its six walls each of n x n squares of two triangles, in the order
/// floor (y = -1/2), ceiling, back (z = -1/2), front, left (x = -1/2), right; `material(wall, u, v)` with u, v the
/// centre of a square, 0..1.
Scene cubeRoom(int n, const std::function<int(SceneBuilder&, int wall, double u, double v)>& material);
/// The same, all of one material.
Scene cubeRoom(int n, double reflectance, double exitance);

/// Without a sun.
Scene dark(Scene scene);

/// A triangle a patch, hemicubes of 32 pixels, solved to a guaranteed `error`.
RadiositySolutionSettings wholeTriangles(double error = 1e-6);
/// Form factors by pixels alone, without closed forms.
HemicubeSettings pixelsAlone(int resolution);

/// A sphere of triangles from a subdivided icosahedron, seen from inside (front within) or outside.
void addSphere(SceneBuilder& builder, double radius, int level, bool inside,
               const std::function<int(const glm::dvec3& centroid)>& material);

struct Box {
  glm::dvec3 low, high;
  bool holds(const glm::dvec3& p) const {
    return glm::all(glm::greaterThan(p, low)) && glm::all(glm::lessThan(p, high));
  }
};
/// Six plates, fronts outwards or inwards; the bottom may lack.
void addBox(SceneBuilder& builder, const Box& box, int material, bool inside = false, bool bottom = true);

/// Vertices inside another patch's edge, where light leaks through cracks. Each counts once; quadratic.
std::size_t countTJunctions(const RadiosityMesh& mesh);

}  // namespace lucerna::test
