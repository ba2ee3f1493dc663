// A bounding volume hierarchy of a scene's triangles, for shaders/rays/bvh.glsl. No GL.
//
// Space: the scene moved by -origin, so that no precision is lost far from the world's origin; lengths in scene units.
// An axis is moved only if the scene lies so far along it that every difference is exact in float, so the triangles
// keep their exact shape. Sources: binned surface area heuristic [Wald2007], collapse to eight children and node layout
// [Ylitie2017]; engine/pathtracer/README.md, section "Ray casting".
#pragma once

#include "scene/scene.hpp"
#include "shared/bvh.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lucerna {

struct BvhSettings {
  int threads = 0;  ///< for building; 0: all cores. The result is the same.
  double splitBudget = 0.3;  ///< spatial splits add at most this fraction of references [Stich2009]; 0: none
  /// Meshes that will move: each has a subtree of its own, whole triangles alone, so that none of the others' boxes
  /// grow with it.
  std::vector<std::size_t> moving = {};
};

struct BvhStatistics {
  std::size_t triangles = 0;  ///< that rays can hit
  std::size_t degenerate = 0;  ///< dropped: no area, or a corner that is not finite
  std::size_t references = 0;  ///< from leaves to triangles; above `triangles` if spatial splits paid off
  std::size_t nodes = 0, leaves = 0;
  int depth = 0;  ///< of the deepest node; the root has 1
  double sahCost =
      0.0;  ///< expected cost of a ray that hits the root's box: 1 per node visit, kBvhTriangleCost per triangle
  double seconds = 0.0;  ///< wall clock
};

/// Cost of a triangle test, in node visits, measured on llvmpipe.
inline constexpr float kBvhTriangleCost = 0.25f;

/// Ready for upload.
struct Bvh {
  std::vector<shared::BvhNode> nodes;  ///< never empty: 0 is the root
  std::vector<shared::BvhTriangle> triangles;  ///< in the order of the leaves
  glm::dvec3 origin{0.0};  ///< world position of the space's origin
  float magnitude = 0.0f;  ///< largest coordinate in that space
  BvhStatistics statistics;
};

/// For any scene, even an empty one.
Bvh buildBvh(const Scene& scene, const BvhSettings& settings = {});

/// The box of a node's child that exists, in the hierarchy's space.
Bounds boundsOfChild(const shared::BvhNode& node, std::size_t child);

/// Fits a hierarchy to meshes that have moved, for the price of those.
class BvhRefit {
 public:
  /// In Bvh::nodes and Bvh::triangles, rising.
  struct Changed {
    std::vector<std::uint32_t> nodes, triangles;
  };
  /// Of a hierarchy as built of that scene.
  BvhRefit(const Bvh& bvh, const Scene& scene);
  ~BvhRefit();
  BvhRefit(BvhRefit&&) noexcept;
  BvhRefit& operator=(BvhRefit&&) noexcept;

  /// `meshes`: whose corners, or whose material's emission, are others. False if the hierarchy must be built anew,
  /// whatever it is now: the scene has other triangles, others of them are degenerate, the space needs another origin,
  /// or the boxes have become kMostGrowth as large.
  bool refit(Bvh& bvh, const Scene& scene, std::span<const std::size_t> meshes, Changed& changed);

 private:
  static constexpr double kMostGrowth = 1.5;
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace lucerna
