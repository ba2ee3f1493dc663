// A hierarchy of lamps for next-event estimation [ContyKulla2018]: lamps are drawn from the root on, at each node by
// what either half may bring to the shaded point, so that many lamps cost little noise. No GL.
//
// A node bounds its lamps: a ball around them, a cone of their axes, and the sum of their intensities. Its importance
// at a point is intensity * emission * reception / distance^2: with the cosine at the lamps and that at the receiver as
// large as any lamp within might have them, and never quite 0, so that a choice by it is unbiased whatever it says.
// Split by the surface area orientation heuristic, with squared diagonals for areas, as lamps may lie in a line.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace lucerna {

/// A lamp that is not at infinity. Its radiant intensity in a direction is at most `intensity`, times the cosine to the
/// closest direction within axisAngle of the axis, and nothing beyond emissionAngle of that.
struct LocalLamp {
  glm::dvec3 min{0.0}, max{0.0};  ///< bounds
  glm::dvec3 axis{0.0, 0.0, 1.0};  ///< unit
  double axisAngle = 0.0;  ///< half angle, up to pi: every direction
  double emissionAngle = 0.0;
  bool isTwoSided = false;  ///< along -axis as well
  double intensity = 0.0;  ///< above 0
  std::uint32_t light = 0;  ///< its number in the table of lights
  float density = 0.0f;  ///< for its leaf: LightTable::pickDensity of a triangle
};

/// What the shaders read (rays/light_hierarchy.glsl, light_leaves.glsl), in texels of 4 words. First the leaves, two in
/// a texel: number of the light, bits of its density. Then four for each pair of siblings, two of them for a sibling:
/// its ball, centre and radius; its intensity, its axis (packNormal), the cosines of the two angles (halves), and a
/// link. Pairs are in depth-first order: a first sibling's children are the next pair. Its link is the first leaf of
/// the second sibling, whose own link is the number of the pair of its children; with kLeaf where a sibling is a lamp.
struct LightHierarchy {
  static constexpr std::uint32_t kLeaf = 0x80000000u, kTwoSided = 0x40000000u;
  static constexpr int kMostDepth = 48;
  std::vector<glm::uvec4> texels;
  std::uint32_t pairs = 0;
  std::vector<std::uint32_t> lights;  ///< of the leaves, in their order
  std::size_t firstPair() const { return (lights.size() + 1) / 2; }  ///< its texel
};

/// Of a hierarchy of so many lamps.
constexpr std::size_t hierarchyTexels(std::size_t lamps) { return (lamps + 1) / 2 + 4 * (lamps - 1); }

/// At least one lamp, at most 2^29. One has no pair.
LightHierarchy lightHierarchy(const std::vector<LocalLamp>& lamps);

}  // namespace lucerna
