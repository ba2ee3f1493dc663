// A small CPU ray caster for tests: which triangle of a scene a ray meets first. Double precision, a median-split BVH,
// Moller-Trumbore intersection (T. Moller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997).
#pragma once

#include "scene/scene.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace lucerna::test {

struct RayHit {
  double distance = 0.0;  ///< in lengths of the ray's direction
  std::size_t triangle = 0;
  glm::dvec3 normal{0.0};  ///< of the plane, by the winding, unit
};

class RayCaster {
 public:
  explicit RayCaster(const Scene& scene);

  /// The first hit at a distance in (0, farthest); alpha masks are not looked at.
  std::optional<RayHit> firstHit(const glm::dvec3& origin, const glm::dvec3& direction, double farthest = 1e300) const;

  /// The smallest distance to a hit in 26 directions: along axes, face and space diagonals. `farthest` where there is
  /// none.
  double clearance(const glm::dvec3& point, double farthest) const;

 private:
  struct Node {
    Bounds bounds;
    std::size_t begin = 0, end = 0;  ///< into order_
    std::size_t right = 0;  ///< the left child follows its parent; 0 marks a leaf
  };
  std::size_t build(std::size_t begin, std::size_t end);
  glm::dvec3 corner(std::size_t triangle, int k) const;

  const Scene& scene_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace lucerna::test
