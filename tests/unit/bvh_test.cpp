// The hierarchy as built: every triangle lies in the boxes above it, nothing is lost, the depth is bounded. No GL.
#include "rays/bvh.hpp"
#include "support/small_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>

namespace lucerna {
namespace {

using test::SceneBuilder;

struct Decoded {
  std::multiset<std::uint32_t> triangles;
  int depth = 0, outside = 0;
  std::size_t nodes = 0;
};

// Boxes of a node in double, and everything below it. A triangle's corners must lie in every box above it where it was
// not split.
void walk(const Bvh& bvh, std::size_t n, int depth, std::vector<Bounds>& above, Decoded& out) {
  const shared::BvhNode& node = bvh.nodes.at(n);
  ++out.nodes;
  out.depth = std::max(out.depth, depth);
  std::size_t child = node.firstChild;
  for (std::uint32_t k = 0; k < BVH_WIDTH; ++k) {
    const std::uint32_t meta = node.meta[k / 4] >> 8 * (k % 4) & 255u;
    if (meta == 0) continue;
    Bounds box;
    glm::dvec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const double step = std::ldexp(1.0, static_cast<int>(node.exponents >> 8 * axis & 255u) - 127);
      const std::size_t word = 2 * static_cast<std::size_t>(axis) + k / 4;
      low[axis] = static_cast<double>(node.origin[axis]) + step * (node.low[word] >> 8 * (k % 4) & 255u);
      high[axis] = static_cast<double>(node.origin[axis]) + step * (node.high[word] >> 8 * (k % 4) & 255u);
    }
    box.add(low), box.add(high);
    above.push_back(box);
    if (node.exponents >> (24 + k) & 1u) {
      EXPECT_EQ(meta, 1u << 5 | (24u + k));
      walk(bvh, child++, depth + 1, above, out);
    } else {
      for (std::uint32_t bits = meta >> 5, t = node.firstTriangle + (meta & 31u); bits; bits >>= 1, ++t) {
        const shared::BvhTriangle& triangle = bvh.triangles.at(t);
        out.triangles.insert(triangle.id & BVH_TRIANGLE_ID_MASK);
        for (const glm::vec3& corner : {triangle.a, triangle.b, triangle.c})
          for (const Bounds& b : above)
            for (int axis = 0; axis < 3; ++axis)
              out.outside += corner[axis] < b.min[axis] || corner[axis] > b.max[axis];
      }
    }
    above.pop_back();
  }
}

Decoded decode(const Bvh& bvh) {
  Decoded out;
  std::vector<Bounds> above;
  walk(bvh, 0, 1, above, out);
  return out;
}

Scene soup(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  const auto point = [&] { return glm::dvec3(in(random), in(random), in(random)); };
  SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f));
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 p = point();
    builder.triangle(p, p + size * point(), p + size * point(), material);
  }
  return builder.scene();
}

TEST(BvhBuild, HoldsEveryTriangleInEveryBoxAboveIt) {
  const Scene scene = soup(20000, 0.05, 1);
  const Bvh bvh = buildBvh(scene, {.splitBudget = 0.0});
  const Decoded d = decode(bvh);
  EXPECT_EQ(d.outside, 0);
  EXPECT_EQ(d.triangles.size(), 20000u);
  EXPECT_EQ(std::set(d.triangles.begin(), d.triangles.end()).size(), 20000u);
  EXPECT_EQ(d.nodes, bvh.statistics.nodes);
  EXPECT_EQ(d.depth, bvh.statistics.depth);
  EXPECT_LE(d.depth, 10);
}

TEST(BvhBuild, SpatialSplitsStayInTheirBudgetAndPay) {
  // Small ones everywhere, and long thin ones along diagonals, whose boxes are nearly all air.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f));
  for (int i = 0; i < 4900; ++i) {
    const glm::dvec3 p(in(random), in(random), in(random));
    builder.triangle(p, p + glm::dvec3(0.02, 0.01, 0.0), p + glm::dvec3(0.0, 0.01, 0.02), material);
  }
  for (int i = 0; i < 100; ++i) {
    const double y = in(random), z = in(random);
    builder.triangle({-1, y, z}, {1, -y, -z}, {-0.99, y, z}, material);
  }
  const Scene& scene = builder.scene();
  const Bvh whole = buildBvh(scene, {.splitBudget = 0.0}), split = buildBvh(scene, {.splitBudget = 0.5});
  EXPECT_EQ(whole.statistics.references, 5000u);
  EXPECT_GT(split.statistics.references, 5200u);
  EXPECT_LE(split.statistics.references, 7500u);
  EXPECT_LT(split.statistics.sahCost, 0.97 * whole.statistics.sahCost);
  const Decoded d = decode(split);
  EXPECT_EQ(std::set(d.triangles.begin(), d.triangles.end()).size(), 5000u);
}

TEST(BvhBuild, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene = soup(30000, 0.1, 3);
  const Bvh one = buildBvh(scene, {.threads = 1}), four = buildBvh(scene, {.threads = 4});
  ASSERT_EQ(one.nodes.size(), four.nodes.size());
  ASSERT_EQ(one.triangles.size(), four.triangles.size());
  EXPECT_EQ(std::memcmp(one.nodes.data(), four.nodes.data(), one.nodes.size() * sizeof one.nodes[0]), 0);
  EXPECT_EQ(std::memcmp(one.triangles.data(), four.triangles.data(), one.triangles.size() * sizeof one.triangles[0]),
            0);
}

TEST(BvhBuild, DropsAndCountsWhatHasNoArea) {
  SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f));
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  builder.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, material);
  builder.triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, material);
  builder.triangle({3, 3, 3}, {3, 3, 3}, {3, 3, 3}, material);
  builder.triangle({0, 0, nan}, {1, 0, 0}, {0, 1, 0}, material);
  builder.triangle({0, 0, 0}, {infinite, 0, 0}, {0, 1, 0}, material);
  const Bvh bvh = buildBvh(builder.scene());
  EXPECT_EQ(bvh.statistics.triangles, 1u);
  EXPECT_EQ(bvh.statistics.degenerate, 4u);
  EXPECT_EQ(decode(bvh).triangles, (std::multiset<std::uint32_t>{0}));
  EXPECT_EQ(bvh.magnitude, 1.0f);
  EXPECT_EQ(buildBvh(Scene{}).nodes.size(), 1u);
}

TEST(BvhBuild, BoundsTheDepthOfTheNastiest) {
  // Each triangle is so much smaller than the last that the surface area heuristic cuts them off one by one.
  SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f));
  for (int i = 0; i < 3000; ++i) {
    const double s = std::pow(0.975, i) * 1e6;
    builder.triangle({s, 0, 0}, {0, s, 0}, {0, 0, s}, material);
    builder.triangle({-s, 0, 0}, {0, -s, 0}, {0, 0, -s}, material);
  }
  const Bvh bvh = buildBvh(builder.scene());
  EXPECT_LE(bvh.statistics.depth, BVH_MAX_DEPTH);
  EXPECT_EQ(decode(bvh).depth, bvh.statistics.depth);
  EXPECT_GE(bvh.statistics.triangles, 5900u);
}

TEST(BvhBuild, MovesTheOriginOnlyWhereThatIsExact) {
  SceneBuilder far;
  const int material = far.material(glm::vec3(0.5f));
  far.triangle({1e6, 1, -1}, {1e6 + 2, 1, 1}, {1e6 + 1, 2, 0.3}, material);
  const Bvh bvh = buildBvh(far.scene());
  EXPECT_EQ(bvh.origin, glm::dvec3(1e6 + 1, 1.5, 0.0));
  const shared::BvhTriangle& t = bvh.triangles.at(0);
  const glm::vec3 corners[] = {t.a, t.b, t.c};
  for (std::size_t k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(static_cast<double>(corners[k][axis]) + bvh.origin[axis],
                static_cast<double>(far.scene().vertices[far.scene().indices[k]].position[axis]));
}

TEST(BvhBuild, KeepsThePlaneOfASliverAndWhatEmits) {
  SceneBuilder builder;
  const int wall = builder.material(glm::vec3(0.5f)), lamp = builder.material(glm::vec3(0.0f));
  builder.materialAt(lamp).emission = glm::vec3(1.0f);
  const glm::dvec3 a(0.3, 0.7, -0.2), along(1.1, 0.4, 0.9), across(-3e-5, 7e-5, 2e-5);
  builder.triangle(a, a + along, a + 0.4 * along + across, wall);
  builder.triangle(a, a + along, a + along + across, lamp);
  const Bvh bvh = buildBvh(builder.scene());
  ASSERT_EQ(bvh.triangles.size(), 2u);
  for (const shared::BvhTriangle& t : bvh.triangles) {
    const bool emits = (t.id & BVH_TRIANGLE_EMISSIVE) != 0;
    EXPECT_EQ(emits, (t.id & BVH_TRIANGLE_ID_MASK) == 1u);
    const int axis = static_cast<int>(t.id >> BVH_TRIANGLE_AXIS_SHIFT & 3u);
    glm::dvec3 normal(0.0);
    normal[axis] = 1.0;
    normal[(axis + 1) % 3] = static_cast<double>(t.normal1);
    normal[(axis + 2) % 3] = static_cast<double>(t.normal2);
    for (const double component : {normal.x, normal.y, normal.z}) EXPECT_LE(std::abs(component), 1.0);
    for (const glm::vec3& corner : {t.b, t.c})
      EXPECT_NEAR(glm::dot(normal, glm::dvec3(corner) - glm::dvec3(t.a)), 0.0, 3e-7);
  }
}

TEST(BvhBuild, RefitsWhereTheTrianglesAreTheSame) {
  Scene scene = soup(2000, 0.1, 4);
  Bvh bvh = buildBvh(scene, {.splitBudget = 0.0});
  for (Vertex& v : scene.vertices) v.position *= glm::vec3(1.5f, 0.5f, 1.0f);
  ASSERT_TRUE(refitBvh(bvh, scene));
  const Decoded d = decode(bvh);
  EXPECT_EQ(d.outside, 0);
  EXPECT_EQ(d.triangles.size(), 2000u);
  scene.vertices[scene.indices[0]].position.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(refitBvh(bvh, scene));
  scene = soup(2001, 0.1, 4);
  EXPECT_FALSE(refitBvh(bvh, scene));
}

}  // namespace
}  // namespace lucerna
