// Hierarchies of lamps: what their texels say, and the probabilities of their lamps in double precision.
#pragma once

#include "base/angles.hpp"
#include "rays/light_hierarchy.hpp"

#include <cstdint>
#include <vector>

namespace lucerna::test {

/// Points, spots and triangles by turns, in a box of 20 by 3 by 20, light numbers from 5 on.
std::vector<LocalLamp> mixedLamps(std::size_t count);

struct HierarchyNode {
  glm::dvec3 centre, axis;
  double radius, intensity, axisAngle, emissionAngle;
  bool isTwoSided, isLeaf;
  std::uint32_t link;
};
HierarchyNode nodeAt(const LightHierarchy& hierarchy, std::uint32_t pair, int sibling);

/// Levels of pairs below the first.
int depthOf(const LightHierarchy& hierarchy);

/// Of each leaf, by angles; normal: zero takes light from all sides.
std::vector<double> probabilities(const LightHierarchy& hierarchy, const glm::dvec3& position,
                                  const glm::dvec3& normal);

}  // namespace lucerna::test
