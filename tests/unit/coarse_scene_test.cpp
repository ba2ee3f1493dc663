// Coarser models of scenes for the published radiosity program: how many patches, what is kept, what is refused.
#include "base/error.hpp"
#include "radiosity/original/coarse_scene.hpp"
#include "support/radiosity_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace lucerna {
namespace {

using test::cubeRoom;
using test::lambertian;
using test::SceneBuilder;

/// A room of 2 n^2 triangles a wall with a lamp of two triangles under its ceiling.
Scene roomWithLamp(int n) {
  Scene scene = cubeRoom(n, 0.5, 0.0);
  SceneBuilder lamp;
  lamp.plate({-0.1, 0.45, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, lambertian(lamp, 0.0, 7.0));
  const Scene other = lamp.scene();
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  Mesh mesh = other.meshes.front();
  mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  mesh.material = static_cast<int>(scene.materials.size());
  scene.materials.push_back(other.materials.front());
  scene.vertices.insert(scene.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const std::uint32_t index : other.indices) scene.indices.push_back(first + index);
  scene.meshes.push_back(mesh);
  return scene;
}

double powerOf(const RadiosityMesh& mesh) {
  double sum = 0.0;
  for (const Patch& patch : mesh.patches) sum += patch.area * patch.emission.x;
  return sum;
}

TEST(CoarseScene, ARoomKeepsItsWallsItsLampAndItsPower) {
  const Scene fine = roomWithLamp(16);
  const CoarseScene coarse = coarserScene(fine, PatchSettings{}, 300);
  EXPECT_EQ(coarse.triangles, fine.triangleCount());
  EXPECT_GT(coarse.cell, 1.0 / 16.0);
  const RadiosityMesh before = makePatches(fine, {}), after = makePatches(coarse.scene, {});
  EXPECT_LE(after.patches.size(), 300u);
  EXPECT_GT(after.patches.size(), 100u);  // the finest that fits
  EXPECT_NEAR(powerOf(after), powerOf(before), 1e-6 * powerOf(before));
  EXPECT_NEAR(powerOf(before), 0.04 * 7.0, 1e-6);
  // A closed room stays closed: each edge has two walls, and what they enclose keeps its size and faces inwards.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double volume = 0.0;
  for (const Patch& patch : after.patches) {
    if (patch.emission.x > 0.0) continue;
    EXPECT_NEAR(patch.reflectance.x, 0.5, 1e-6);
    const auto c = after.corners(patch);
    volume -= glm::dot(c[0], glm::cross(c[1], c[2])) / 6.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = patch.point[k], b = patch.point[(k + 1) % 3];
      ++edges[{std::min(a, b), std::max(a, b)}];
    }
  }
  for (const auto& [edge, walls] : edges) EXPECT_EQ(walls, 2);
  EXPECT_GT(volume, 0.7);
  EXPECT_LT(volume, 1.0 + 1e-6);
  EXPECT_NEAR(coarse.area, after.area() / before.area(), 1e-6);
}

TEST(CoarseScene, ASceneThatFitsIsKept) {
  const Scene room = cubeRoom(2, 0.5, 3.0);
  const CoarseScene same = coarserScene(room, PatchSettings{}, 48);
  EXPECT_EQ(same.cell, 0.0);
  EXPECT_EQ(same.area, 1.0);
  EXPECT_EQ(same.scene.indices, room.indices);
}

TEST(CoarseScene, OfTrianglesThatBecomeOneTheLargestStays) {
  SceneBuilder builder;
  const int small = lambertian(builder, 0.2), large = lambertian(builder, 0.8);
  builder.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, small);
  builder.triangle({0, 0, 0.01}, {1.1, 0, 0.01}, {0, 1.1, 0.01}, large);
  builder.triangle({0, 0, 0.02}, {0, 1, 0.02}, {1, 0, 0.02}, small);  // the other front
  const RadiosityMesh mesh = makePatches(coarserScene(builder.scene(), 0.5).scene, {});
  ASSERT_EQ(mesh.patches.size(), 2u);
  for (const Patch& patch : mesh.patches)
    EXPECT_NEAR(patch.reflectance.x, patch.faceNormal.z > 0.0 ? 0.8 : 0.2, 1e-6) << patch.faceNormal.z;
}

TEST(CoarseScene, WhereTheEdgeIsFreeAFewLargeTrianglesAreCutIntoAsManyAsFit) {
  const Scene room = cubeRoom(1, 0.5, 3.0);  // 12 triangles; a twentieth of its side would make thousands
  PatchSettings patches;
  patches.longestEdge = 0.05;
  const CoarseScene same = coarserSceneAndEdge(room, patches, 500);
  EXPECT_EQ(same.cell, 0.0);
  EXPECT_EQ(same.scene.indices, room.indices);
  patches.longestEdge = same.longestEdge;
  const std::size_t count = makePatches(room, patches).patches.size();
  EXPECT_LE(count, 500u);
  EXPECT_GT(count, 100u);
  EXPECT_GT(same.longestEdge, 0.05);
}

TEST(CoarseScene, WhereTheEdgeIsFreeAFineSceneIsJoinedAndItsEdgesAreSixCells) {
  PatchSettings patches;
  patches.longestEdge = 0.05;
  const CoarseScene coarse = coarserSceneAndEdge(roomWithLamp(16), patches, 300);
  EXPECT_GT(coarse.cell, 1.0 / 16.0);
  EXPECT_NEAR(coarse.longestEdge, 6.0 * coarse.cell, 1e-9);
  patches.longestEdge = coarse.longestEdge;
  const std::size_t count = makePatches(coarse.scene, patches).patches.size();
  EXPECT_LE(count, 300u);
  EXPECT_GT(count, 100u);
}

TEST(CoarseScene, LampsThatAreTooManyAreRefused) {
  try {
    coarserScene(cubeRoom(16, 0.5, 3.0), PatchSettings{}, 100);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("emissive triangles are kept"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lucerna
