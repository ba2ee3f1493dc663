// A bounding volume hierarchy of a scene's triangles, for shaders/pathtracer/bvh.glsl. No GL.
//
// Space: the scene moved by -origin, so that far from the world's origin no precision is lost; lengths in scene units. A coordinate axis
// is moved only where the scene lies so far along it that every difference is exact in float, so the triangles are those of the scene.
// Sources: binned surface area heuristic [Wald2007]; README.md, section "Ray casting".
#pragma once

#include "scene/scene.hpp"
#include "shared/bvh.h"

#include <cstddef>
#include <vector>

namespace lucerna {

struct BvhSettings {
  int leafTriangles = 4;  ///< at most, 1..16
};

struct BvhStatistics {
  std::size_t triangles = 0;   ///< that rays can hit
  std::size_t degenerate = 0;  ///< dropped: no area, or a corner that is not finite
  std::size_t nodes = 0, leaves = 0;
  int depth = 0;         ///< of the deepest leaf; the root's children have depth 1
  double sahCost = 0.0;  ///< expected cost of a ray that meets the root's box: 1 a node visit, 1 a triangle
  double seconds = 0.0;  ///< wall clock
};

/// Ready for upload.
struct Bvh {
  shared::BvhHeader header;
  std::vector<shared::BvhNode> nodes;          ///< never empty: 0 is the root
  std::vector<shared::BvhTriangle> triangles;  ///< in the order of the leaves
  glm::dvec3 origin{0.0};                      ///< world position of the space's origin
  BvhStatistics statistics;
};

/// Any scene, also an empty one.
Bvh buildBvh(const Scene& scene, const BvhSettings& settings = {});

}  // namespace lucerna
