// The hierarchy of lamps: each has a leaf, and every node holds what is below it.
#include "rays/light_hierarchy.hpp"
#include "support/light_hierarchies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace lucerna::test {
namespace {

/// Checks a pair and all below it, whose lamps are the leaves from `first` to `end`.
void checkPair(const LightHierarchy& hierarchy, const std::vector<LocalLamp>& lamps, std::uint32_t pair,
               std::size_t first, std::size_t end) {
  const HierarchyNode nodes[2] = {nodeAt(hierarchy, pair, 0), nodeAt(hierarchy, pair, 1)};
  const std::size_t split = nodes[0].link;
  EXPECT_GT(split, first);
  EXPECT_LT(split, end);
  for (int k = 0; k < 2; ++k) {
    const HierarchyNode& node = nodes[k];
    const std::size_t from = k == 0 ? first : split, to = k == 0 ? split : end;
    double intensity = 0.0;
    for (std::size_t leaf = from; leaf < to; ++leaf) {
      const LocalLamp& lamp = *std::find_if(lamps.begin(), lamps.end(),
                                            [&](const LocalLamp& l) { return l.light == hierarchy.lights[leaf]; });
      intensity += lamp.intensity;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place((corner & 1 ? lamp.max : lamp.min).x, (corner & 2 ? lamp.max : lamp.min).y,
                               (corner & 4 ? lamp.max : lamp.min).z);
        EXPECT_LE(glm::length(place - node.centre), node.radius * (1.0 + 1e-6) + 1e-6);
      }
      double between = std::acos(std::clamp(glm::dot(lamp.axis, node.axis), -1.0, 1.0));
      if (node.isTwoSided) between = std::min(between, kPi - between);
      EXPECT_LE(std::min(between + lamp.axisAngle, kPi), node.axisAngle + 2e-2);  // halves, and half of a right angle
      EXPECT_LE(lamp.emissionAngle, node.emissionAngle + 2e-2);
      EXPECT_TRUE(node.isTwoSided || !lamp.isTwoSided);
    }
    EXPECT_NEAR(node.intensity / intensity, 1.0, 1e-6);
    EXPECT_EQ(node.isLeaf, to - from == 1);
    if (!node.isLeaf) checkPair(hierarchy, lamps, k == 0 ? pair + 1 : node.link, from, to);
  }
}

TEST(LightHierarchy, NodesHoldTheirLamps) {
  for (const unsigned count : {2u, 3u, 7u, 64u, 1000u}) {
    const std::vector<LocalLamp> lamps = mixedLamps(count);
    const LightHierarchy hierarchy = lightHierarchy(lamps);
    ASSERT_EQ(hierarchy.pairs, count - 1);
    ASSERT_EQ(hierarchy.texels.size(), 4 * (count - 1) + (count + 1) / 2);
    std::vector<std::uint32_t> leaves = hierarchy.lights;
    for (std::size_t leaf = 0; leaf < count; ++leaf)
      EXPECT_EQ(hierarchy.texels[leaf / 2][leaf % 2 == 0 ? 0 : 2], leaves[leaf]);
    std::sort(leaves.begin(), leaves.end());
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(leaves[i], lamps[i].light);
    checkPair(hierarchy, lamps, 0, 0, count);
  }
}

// Lamps at the same place, and each at 0.8 of the distance of the one before: a chain without the bound.
TEST(LightHierarchy, ItsDepthIsBounded) {
  for (const bool isSame : {true, false}) {
    std::vector<LocalLamp> lamps(3000);
    double x = 1e30;
    for (std::size_t i = 0; i < lamps.size(); ++i) {
      if (!isSame) lamps[i].min = lamps[i].max = {x, 0.0, 0.0};
      x *= 0.8;
      lamps[i].axisAngle = kPi;
      lamps[i].intensity = 1.0;
      lamps[i].light = static_cast<std::uint32_t>(i);
    }
    EXPECT_LT(depthOf(lightHierarchy(lamps)), LightHierarchy::kMostDepth);
  }
}

}  // namespace
}  // namespace lucerna::test
