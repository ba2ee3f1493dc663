// Patches from scenes: areas, fronts, welding, what is left out, and refinement that keeps the mesh whole.
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "radiosity/form_factor_matrix.hpp"
#include "radiosity/patches.hpp"
#include "support/radiosity_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace lucerna {
namespace {

using test::cubeRoom;
using test::lambertian;
using test::SceneBuilder;

TEST(RadiosityPatches, ACubeIsWeldedAndItsLightStopsAtEdges) {
  const RadiosityMesh mesh = makePatches(cubeRoom(2, 0.5, 3.0), {});
  ASSERT_EQ(mesh.patches.size(), 48u);
  EXPECT_EQ(mesh.points.size(), 26u);  // 8 corners, 12 edge middles, 6 face centres
  EXPECT_EQ(mesh.lightVertices, 6u * 9u);  // each wall its own
  EXPECT_NEAR(mesh.area(), 6.0, 1e-12);
  for (const Patch& p : mesh.patches) {
    EXPECT_LT(glm::dot(p.faceNormal, p.centroid), -0.4);  // inwards
    EXPECT_NEAR(p.reflectance.y, 0.5, 1e-7);
    EXPECT_NEAR(p.emission.x, 3.0, 1e-6);
  }
}

TEST(RadiosityPatches, WhatCannotBeComputedIsLeftOutAndCounted) {
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5);
  builder.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, m);
  builder.triangle({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, m);  // the other side: a sheet of two fronts
  builder.triangle({1, 0, 0}, {0, 1, 0}, {0, 0, 0}, m);  // the first again
  builder.triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, m);  // a line
  builder.triangle({0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}, m);
  const RadiosityMesh mesh = makePatches(builder.scene(), {});
  EXPECT_EQ(mesh.patches.size(), 2u);
  EXPECT_EQ(mesh.duplicates, 1u);
  EXPECT_EQ(mesh.degenerate, 1u);
  EXPECT_EQ(mesh.notFinite, 1u);
}

TEST(RadiosityPatches, TheFrontIsWhereTheShadingNormalsAre) {
  SceneBuilder builder;
  builder.plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, lambertian(builder, 0.5), -1.0f);
  const RadiosityMesh mesh = makePatches(builder.scene(), {});
  EXPECT_EQ(mesh.flipped, 2u);
  for (const Patch& p : mesh.patches) EXPECT_NEAR(p.faceNormal.z, -1.0, 1e-12);
}

TEST(RadiosityPatches, RefusesWhatWouldMakeLight) {
  const auto refuses = [](double reflectance, double exitance) {
    try {
      makePatches(cubeRoom(1, reflectance, exitance), {});
    } catch (const Error& e) { return e.kind() == ErrorKind::badInput; }
    return false;
  };
  EXPECT_TRUE(refuses(1.01, 0.0));
  EXPECT_TRUE(refuses(std::nan(""), 0.0));
  EXPECT_TRUE(refuses(0.5, -1.0));
  EXPECT_TRUE(refuses(0.5, INFINITY));
  EXPECT_FALSE(refuses(1.0, 1.0));
  EXPECT_THROW(makePatches(SceneBuilder().scene(), {}), Error);
}

TEST(RadiosityPatches, SubdivisionKeepsAreaFrontsAndEdges) {
  PatchSettings settings;
  settings.longestEdge = 0.2;
  SceneBuilder builder;
  addSphere(builder, 1.0, 0, true, [&, m = lambertian(builder, 0.5)](const glm::dvec3&) { return m; });
  const RadiosityMesh whole = makePatches(builder.scene(), {}), mesh = makePatches(builder.scene(), settings);
  EXPECT_GT(mesh.patches.size(), 1000u);
  EXPECT_NEAR(mesh.area(), whole.area(), 1e-9);
  EXPECT_EQ(test::countTJunctions(mesh), 0u);
  double leastQuality = 1.0;
  for (const Patch& p : mesh.patches) {
    const auto c = mesh.corners(p);
    double squares = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 edge = c[(k + 1) % 3] - c[k];
      EXPECT_LE(glm::length(edge), 0.2 * (1.0 + 1e-8));
      squares += glm::dot(edge, edge);
    }
    leastQuality = std::min(leastQuality, 4.0 * std::sqrt(3.0) * p.area / squares);  // 1 for an equilateral triangle
    EXPECT_LT(glm::dot(p.faceNormal, p.centroid), 0.0);
  }
  EXPECT_GT(leastQuality, 0.4);
  // Closed as before: every edge has two patches.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Patch& p : mesh.patches)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax({p.point[k], p.point[(k + 1) % 3]})];
  for (const auto& [edge, count] : edges) ASSERT_EQ(count, 2);
}

TEST(RadiosityPatches, LocalRefinementSpreadsNoFurtherThanItMust) {
  const Scene scene = cubeRoom(4, 0.5, 0.0);
  const RadiosityMesh mesh = makePatches(scene, {});
  std::vector<std::uint32_t> parent;
  const RadiosityMesh finer = refined(
      scene, mesh, {}, [](std::size_t i, int) { return i == 5; }, &parent);
  EXPECT_EQ(test::countTJunctions(mesh), 0u);
  EXPECT_EQ(test::countTJunctions(finer), 0u);
  EXPECT_GT(finer.patches.size(), mesh.patches.size() + 3);
  EXPECT_LT(finer.patches.size(), mesh.patches.size() + 20);
  ASSERT_EQ(parent.size(), finer.patches.size());
  EXPECT_EQ(std::count(parent.begin(), parent.end(), 5u), 4);
}

TEST(RadiosityPatches, TexturesGiveEachPatchItsOwnMean) {
  SceneBuilder builder;
  const int m = lambertian(builder, 0.8);
  builder.materialAt(m).diffuseTexture =
      builder.texture(2, 1, {0, 0, 0, 255, 255, 255, 255, 255});  // left black, right white
  builder.materialAt(m).emissionTexture = builder.materialAt(m).diffuseTexture;
  builder.materialAt(m).emission = glm::vec3(0.5f);
  builder.materialAt(m).emissionScale = glm::vec3(1.0f);
  builder.plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, m);
  PatchSettings settings;
  settings.longestEdge = 0.26;
  const RadiosityMesh mesh = makePatches(builder.scene(), settings);
  double sum = 0.0;
  for (const Patch& p : mesh.patches) {
    EXPECT_NEAR(p.reflectance.x, p.centroid.x < 0.0 ? 0.0 : 0.8, 1e-6);
    EXPECT_NEAR(p.emission.x, p.centroid.x < 0.0 ? 0.0 : std::numbers::pi, 1e-6);
    sum += p.area * p.reflectance.x;
  }
  EXPECT_NEAR(sum, 0.4, 1e-6);
}

TEST(RadiosityPatches, ATJunctionIsFound) {
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5);
  builder.triangle({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, m);
  builder.triangle({0, 0, 0}, {1, -1, 0}, {1, 0, 0}, m);
  EXPECT_EQ(test::countTJunctions(makePatches(builder.scene(), {})), 1u);
}

TEST(RadiosityPatches, WorkOnAllCoresIsDoneOnceEach) {
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, std::size_t{255}, std::size_t{256}, std::size_t{10007}}) {
    std::vector<int> times(count, 0);
    onAllCores(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++times[i];
    });
    EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int t) { return t == 1; })) << count;
  }
}

}  // namespace
}  // namespace lucerna
