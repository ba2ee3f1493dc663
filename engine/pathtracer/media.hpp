// Participating media and the boundaries that hold them, from a scene to what the path tracer's shaders read (no GL).
//
// Units: scene units of length. Sources: shaders/pathtracer/media.glsl, density.glsl and boundary.glsl.
#pragma once

#include "scene/scene.hpp"
#include "shared/media.h"

#include <array>
#include <vector>

namespace lucerna {

/// What media.glsl and density.glsl read.
struct PackedMedia {
  std::vector<shared::MediumRecord> media;  ///< as Scene::media
  std::vector<shared::DensityRecord> grids;
  std::vector<float> densities;             ///< of all grids, each followed by its blocks' bounds
};

/// Throws Error(badInput) naming the medium where a coefficient is negative or not finite, |g| is not below 1, or a grid is not usable.
/// Boxes are moved by -origin.
PackedMedia packMedia(const std::vector<Medium>& media, const glm::dvec3& origin = glm::dvec3(0.0));

/// Counts of closed boundaries around a place, 4 bits a rank (boundary.glsl).
using InsideCounts = glm::uvec4;
inline constexpr int kMaxBoundaryRanks = 32;

/// A triangle of a closed boundary, scene units.
struct BoundaryTriangle {
  glm::vec3 a, b, c;
  int rank;
};

/// What boundary.glsl reads, and the boundaries themselves. Materials that agree in priority, index, kind and medium share a rank.
struct PackedBoundaries {
  std::vector<int> rankOfMaterial;                ///< as Scene::materials; -1: bounds nothing
  std::vector<shared::InteriorRecord> interiors;  ///< by rank
  InsideCounts dielectricRanks{0u};
  std::vector<BoundaryTriangle> triangles;
};

/// Throws Error(badInput) where there are more than kMaxBoundaryRanks different ones, an index is not above 0, or a medium is missing.
/// diffuseOnly: dielectrics bound nothing, as they are drawn as walls.
PackedBoundaries rankBoundaries(const Scene& scene, bool diffuseOnly = false);

/// The box around each rank's triangles; empty where it has none.
std::vector<Bounds> boundsOfRanks(const PackedBoundaries& boundaries);
/// Whether two boxes share a point.
bool overlap(const Bounds& a, const Bounds& b);

/// Whether a boundary's mesh and another mesh, of anything but the same boundary, have boxes that share a point: their faces may coincide or cross.
bool boundariesMayTouch(const Scene& scene, const PackedBoundaries& boundaries);

/// The boundaries around a point, by the winding number of each rank's triangles [vanOosterom1983; Jacobson2013].
struct Surroundings {
  InsideCounts inside{0u};
  double openness = 0.0;  ///< largest distance of a winding number from a whole one: above 0.01 a mesh is open, or the point lies on it
};
Surroundings surroundingsOf(const PackedBoundaries& boundaries, const glm::dvec3& point);
/// boundary.glsl's iorInside: that of the highest dielectric around.
float iorInside(const PackedBoundaries& boundaries, const InsideCounts& inside);

}  // namespace lucerna
