// The hierarchy as built: every triangle lies in the boxes above it, nothing is lost, the depth is bounded. No GL.
#include "rays/bvh.hpp"
#include "support/small_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
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

/// In ten meshes in a row.
Scene soupInMeshes() {
  Scene scene = soup(2000, 0.1, 4);
  const auto count = static_cast<std::uint32_t>(scene.indices.size() / 10);
  scene.meshes.resize(10, scene.meshes.front());
  for (std::uint32_t m = 0; m < 10; ++m) {
    scene.meshes[m].firstIndex = m * count, scene.meshes[m].indexCount = count;
    for (std::uint32_t i = m * count; i < (m + 1) * count; ++i)
      scene.vertices[scene.indices[i]].position.x += 2.0f * static_cast<float>(m);
  }
  return scene;
}

void moveMesh(Scene& scene, std::size_t mesh, const glm::vec3& way) {
  const Mesh& m = scene.meshes[mesh];
  std::set<std::uint32_t> corners(scene.indices.begin() + m.firstIndex,
                                  scene.indices.begin() + m.firstIndex + m.indexCount);
  for (const std::uint32_t v : corners) scene.vertices[v].position += way;
}

TEST(BvhBuild, FollowsMeshesThatMove) {
  Scene scene = soupInMeshes();
  for (const double budget : {0.0, 0.3}) {
    Bvh bvh = buildBvh(scene, {.splitBudget = budget});
    BvhRefit refit(bvh, scene);
    for (const std::size_t mesh : {3u, 7u, 3u}) {
      moveMesh(scene, mesh, glm::vec3(0.1f, -0.05f, 0.02f));
      const std::vector<shared::BvhNode> before = bvh.nodes;
      BvhRefit::Changed changed;
      ASSERT_TRUE(refit.refit(bvh, scene, std::array{mesh}, changed));
      const Decoded d = decode(bvh);
      if (budget == 0.0) {
        EXPECT_EQ(d.outside, 0);
        EXPECT_EQ(d.triangles.size(), 2000u);
        EXPECT_EQ(changed.triangles.size(), 200u);
      }
      EXPECT_LT(changed.nodes.size(), bvh.nodes.size() / 4);
      // Each triangle is as a hierarchy made anew has it, and what is not named is as it was.
      const Bvh anew = buildBvh(scene);
      EXPECT_EQ(bvh.magnitude, anew.magnitude);
      std::map<std::uint32_t, shared::BvhTriangle> right;
      for (const shared::BvhTriangle& t : anew.triangles) right[t.id & BVH_TRIANGLE_ID_MASK] = t;
      for (const shared::BvhTriangle& t : bvh.triangles)
        EXPECT_EQ(std::memcmp(&t, &right.at(t.id & BVH_TRIANGLE_ID_MASK), sizeof t), 0);
      for (std::size_t n = 0; n < before.size(); ++n)
        EXPECT_TRUE(std::ranges::binary_search(changed.nodes, n) ||
                    std::memcmp(&before[n], &bvh.nodes[n], sizeof before[n]) == 0);
    }
  }
}

TEST(BvhBuild, MovingMeshesHaveSubtreesOfTheirOwn) {
  Scene scene = soupInMeshes();
  for (const std::size_t mesh : {3u, 7u})
    moveMesh(scene, mesh, glm::vec3(8.0f - 2.0f * static_cast<float>(mesh), 0, 0));
  const BvhSettings apart{.splitBudget = 0.3, .moving = {3, 7}};  // both begin amid mesh 4
  Bvh bvh = buildBvh(scene, apart);
  BvhRefit refit(bvh, scene);
  const auto decoded = [&] { return decode(buildBvh(scene, {.splitBudget = 0.0, .moving = {3, 7}})); };
  EXPECT_EQ(decoded().outside, 0);
  EXPECT_EQ(decoded().triangles.size(), 2000u);
  for (int step = 0; step < 20; ++step)
    for (const std::size_t mesh : {3u, 7u}) {
      moveMesh(scene, mesh, glm::vec3(0.5f, 0.0f, mesh == 3 ? 0.2f : -0.2f));
      BvhRefit::Changed changed;
      ASSERT_TRUE(refit.refit(bvh, scene, std::array{mesh}, changed)) << step;  // though it crosses all the others
      ASSERT_EQ(changed.triangles.size(), 200u);  // each once: no split
      EXPECT_LT(changed.nodes.size(), 60u);  // of about 200
    }
}

TEST(BvhBuild, KnowsWhatEmitsNow) {
  Scene scene = soupInMeshes();
  scene.materials.push_back(scene.materials.front());
  scene.meshes[2].material = 1;
  Bvh bvh = buildBvh(scene);
  BvhRefit refit(bvh, scene);
  for (const float emission : {3.0f, 0.0f}) {
    scene.materials[1].emission = glm::vec3(emission);
    BvhRefit::Changed changed;
    ASSERT_TRUE(refit.refit(bvh, scene, std::array<std::size_t, 1>{2}, changed));
    for (const shared::BvhTriangle& t : bvh.triangles)
      EXPECT_EQ((t.id & BVH_TRIANGLE_EMISSIVE) != 0, emission > 0.0f && (t.id & BVH_TRIANGLE_ID_MASK) / 200 == 2);
  }
}

TEST(BvhBuild, IsBuiltAnewWhereItWouldBeBad) {
  const Scene rest = soupInMeshes();
  Bvh bvh = buildBvh(rest);
  const std::array<std::size_t, 1> first{0};
  const auto follows = [&](const Scene& scene) {
    Bvh copy = bvh;
    BvhRefit::Changed changed;
    return BvhRefit(bvh, rest).refit(copy, scene, first, changed);
  };
  EXPECT_TRUE(follows(rest));
  Scene far = rest;
  moveMesh(far, 0, glm::vec3(100.0f, 0.0f, 0.0f));
  EXPECT_FALSE(follows(far));
  Scene broken = rest;
  broken.vertices[broken.indices[0]].position.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(follows(broken));
  EXPECT_FALSE(follows(soup(2001, 0.1, 4)));
}

}  // namespace
}  // namespace lucerna
