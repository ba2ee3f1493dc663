// Participating media and their boundaries, packed for the path tracer's shaders (no GL).
//
// Units: scene units of length. Sources: shaders/pathtracer/media.glsl, density.glsl and boundary.glsl.
#pragma once

#include "scene/features.hpp"
#include "scene/scene.hpp"
#include "shared/media.h"

#include <array>
#include <vector>

namespace lucerna {

/// Input of media.glsl and density.glsl.
struct PackedMedia {
  std::vector<shared::MediumRecord> media;  ///< as Scene::media
  std::vector<shared::DensityRecord> grids;
  std::vector<float> densities;  ///< of all grids, each followed by its blocks' bounds
};

/// Throws Error(badInput) naming the medium if a coefficient is negative or not finite, |g| is not below 1, or a grid
/// is unusable. Boxes are moved by -origin.
PackedMedia packMedia(const std::vector<Medium>& media, const glm::dvec3& origin = glm::dvec3(0.0));

/// Light from infinitely far does not get through Scene::cameraMedium, which has no end, unless a channel of it is
/// clear or it is a grid. Throws Error(badInput) if there is no other light, since paths without absorption would then
/// look for it almost for ever; warns if there is, and if such paths find nothing that ends them.
void checkOuterMedium(const Scene& scene, const SceneFeatures& features);

/// Counts of closed boundaries around a point, 4 bits per rank (boundary.glsl).
using InsideCounts = glm::uvec4;
inline constexpr int kMaxBoundaryRanks = 32;

/// A triangle of a closed boundary, scene units.
struct BoundaryTriangle {
  glm::vec3 a, b, c;
  int rank;
};

/// Input of boundary.glsl, and the boundaries themselves. Materials with the same priority, index, kind and medium
/// share a rank.
struct PackedBoundaries {
  std::vector<int> rankOfMaterial;  ///< as Scene::materials; -1: no boundary
  std::vector<shared::InteriorRecord> interiors;  ///< by rank
  InsideCounts dielectricRanks{0u};
  std::vector<BoundaryTriangle> triangles;
};

/// Throws Error(badInput) if there are more than kMaxBoundaryRanks different ones, an index is not above 0, or a medium
/// is missing. diffuseOnly: dielectrics are walls, not boundaries.
PackedBoundaries rankBoundaries(const Scene& scene, bool diffuseOnly = false);

/// The box around each rank's triangles; may be empty.
std::vector<Bounds> boundsOfRanks(const PackedBoundaries& boundaries);
/// Whether two boxes share a point.
bool overlap(const Bounds& a, const Bounds& b);

/// Whether the boxes of a boundary's mesh and of another mesh, not of the same boundary, share a point: their faces may
/// coincide or cross.
bool boundariesMayTouch(const Scene& scene, const PackedBoundaries& boundaries);

/// The boundaries around a point, by the winding number of each rank's triangles [vanOosterom1983; Jacobson2013].
struct Surroundings {
  InsideCounts inside{0u};
  double openness = 0.0;  ///< largest distance of a winding number from an integer: above 0.01 a mesh is open, or the
                          ///< point lies on it
};
Surroundings surroundingsOf(const PackedBoundaries& boundaries, const glm::dvec3& point);
/// boundary.glsl's iorInside: the index of the highest dielectric around.
float iorInside(const PackedBoundaries& boundaries, const InsideCounts& inside);

}  // namespace lucerna
