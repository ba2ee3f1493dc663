// Scenes for participating media whose pictures are numbers: every pixel measures the same quantity (no GL).
#pragma once

#include "scene/scene.hpp"

namespace lucerna::test {

/// A closed box, outward normals, a mesh of its own.
void addBox(Scene& scene, const glm::dvec3& min, const glm::dvec3& max, int material);
/// A closed sphere by subdivision of an octahedron, 8 * 4^level triangles, of the true sphere's volume, outward flat
/// normals.
void addSphere(Scene& scene, const glm::dvec3& centre, double radius, int level, int material);
/// Index of the new material.
int addBoundary(Scene& scene, Bsdf bsdf, double ior, int interior, int priority = 0);
Medium homogeneous(const glm::dvec3& scattering, const glm::dvec3& absorption, double g);
/// Of one value in all channels; depth: the optical depth of a length of 1.
Medium grey(double albedo, double depth, double g);

/// Light 1 in red from directions with y > 0, light 1 in green from those with y < 0.
Environment halves();
Environment constantEnvironment(double radiance);

/// A camera whose pixels all look the same way.
Camera cameraAt(const glm::dvec3& from, const glm::dvec3& to, double fov = 1e-4);

/// A slab of thickness 1 between y = -1/2 and 1/2, so wide that nothing leaves by its sides, seen from above at a
/// cosine; the environment is halves(). By reciprocity red is the plane albedo and green the transmittance for light
/// that comes in at that cosine [Chandrasekhar1960]. ior 1 stands for Bsdf::none.
Scene slab(const Medium& medium, double ior, double cosine, double halfWidth = 30.0);

}  // namespace lucerna::test
