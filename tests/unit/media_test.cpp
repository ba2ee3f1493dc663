// Media and boundaries packed for the path tracer, without GL.
#include "base/error.hpp"
#include "pathtracer/media.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace lucerna {
namespace {

/// A closed box of a material, outward normals.
void addBox(Scene& scene, const glm::vec3& min, const glm::vec3& max, int material) {
  Mesh mesh;
  mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  mesh.material = material;
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (int i = 0; i < 8; ++i) {
    Vertex v;
    v.position = {i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z};
    scene.vertices.push_back(v);
  }
  const std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads)
    for (const int k : {0, 1, 2, 0, 2, 3}) scene.indices.push_back(first + q[k]);
  mesh.indexCount = 36;
  scene.meshes.push_back(mesh);
}

int addBoundary(Scene& scene, Bsdf bsdf, float ior, int interior, int priority) {
  Material m;
  m.bsdf = bsdf;
  m.ior = ior;
  m.interior = interior;
  m.priority = priority;
  scene.materials.push_back(m);
  return static_cast<int>(scene.materials.size()) - 1;
}

TEST(PackedMediaUnit, CoefficientsKeepTheirDigits) {
  Medium medium;
  medium.scattering = {18.2052f, 0.0f, 0.5f};
  medium.absorption = {0.00153f, 0.0f, 0.0f};
  medium.anisotropy = {0.75f, -0.3f, 1e-7f};
  const auto record = packMedia({medium}).media.at(0);
  EXPECT_FLOAT_EQ(record.albedo.x, static_cast<float>(18.2052 / 18.20673));
  EXPECT_EQ(record.albedo.y, 0.0f);  // vacuum in that channel: no 0 / 0
  EXPECT_EQ(record.albedo.z, 1.0f);
  EXPECT_FLOAT_EQ(record.oneMinusG.x, 0.25f);
  EXPECT_EQ(record.oneMinusG.z, static_cast<float>(1.0 - 1e-7));
  EXPECT_EQ(record.oneMinusG.y, record.oneMinusG.z) << "a channel that does not scatter follows another";
  EXPECT_EQ(record.greyExtinction, 0);
}

TEST(PackedMediaUnit, LightFromAfarNeedsAMediumThatEnds) {
  Scene scene;
  scene.media = {Medium{}};
  scene.media[0].scattering = glm::vec3(1.0f);
  scene.cameraMedium = 0;
  const auto check = [](const Scene& s) { checkOuterMedium(s, analyse(s)); };
  EXPECT_NO_THROW(check(scene)) << "no light at all";
  scene.sun = DirectionalLight{};
  scene.sun->irradiance = glm::vec3(1.0f);
  EXPECT_THROW(check(scene), Error);
  Scene red = scene, grid = scene, lamp = scene, bounded = scene, sky = scene;
  red.media[0].scattering.x = 0.0f;
  EXPECT_NO_THROW(check(red)) << "a clear channel";
  grid.media[0].grid = DensityGrid{{1, 1, 1}, {1.0f}, glm::dvec3(0.0), glm::dvec3(1.0)};
  EXPECT_NO_THROW(check(grid));
  lamp.points = {PointLight{}};
  lamp.points[0].intensity = glm::vec3(1.0f);
  EXPECT_NO_THROW(check(lamp));
  bounded.cameraMedium = -1;
  EXPECT_NO_THROW(check(bounded));
  sky.sun.reset();
  sky.background = glm::vec3(1.0f);
  EXPECT_THROW(check(sky), Error);
}

TEST(PackedMediaUnit, RefusesWhatCannotBe) {
  Medium good;
  good.scattering = glm::vec3(1.0f);
  EXPECT_NO_THROW(packMedia({good}));
  Medium negative = good, infinite = good, forward = good, badGrid = good, badDensity = good;
  negative.absorption.y = -1e-3f;
  infinite.scattering.x = std::numeric_limits<float>::infinity();
  forward.anisotropy.z = 1.0f;
  badGrid.grid = DensityGrid{{2, 2, 2}, {1.0f}, glm::dvec3(0.0), glm::dvec3(1.0)};
  badDensity.grid = DensityGrid{{1, 1, 1}, {std::numeric_limits<float>::quiet_NaN()}, glm::dvec3(0.0), glm::dvec3(1.0)};
  for (const Medium& bad : {negative, infinite, forward, badGrid, badDensity}) EXPECT_THROW(packMedia({bad}), Error);
  Scene scene;
  for (int i = 0; i < kMaxBoundaryRanks + 1; ++i)
    addBoundary(scene, Bsdf::dielectric, 1.1f + 0.01f * static_cast<float>(i), -1, 0);
  EXPECT_THROW(rankBoundaries(scene), Error);
  scene.materials.pop_back();
  EXPECT_NO_THROW(rankBoundaries(scene));
  scene.materials.back().interior = 3;
  EXPECT_THROW(rankBoundaries(scene), Error);
}

TEST(SurroundingsUnit, WindingNumbersCountNestedBoxes) {
  Scene scene;
  const int glass = addBoundary(scene, Bsdf::dielectric, 1.5f, -1, 1),
            water = addBoundary(scene, Bsdf::dielectric, 1.33f, -1, 0);
  addBoundary(scene, Bsdf::diffuse, 1.0f, -1, 0);
  addBox(scene, glm::vec3(-2.0f), glm::vec3(2.0f), glass);
  addBox(scene, glm::vec3(-1.0f), glm::vec3(1.0f), water);
  addBox(scene, glm::vec3(-0.5f), glm::vec3(3.0f), glass);  // overlaps both
  addBox(scene, glm::vec3(-9.0f), glm::vec3(9.0f), 2);  // bounds nothing
  const PackedBoundaries packed = rankBoundaries(scene);
  ASSERT_EQ(packed.rankOfMaterial, (std::vector<int>{1, 0, -1}));
  const auto counts = [&](const glm::dvec3& p) {
    const Surroundings s = surroundingsOf(packed, p);
    EXPECT_LT(s.openness, 1e-9);
    return s.inside.x;
  };
  EXPECT_EQ(counts({5.0, 0.0, 0.0}), 0u);
  EXPECT_EQ(counts({-1.5, 0.0, 0.0}), 0x10u);
  EXPECT_EQ(counts({-0.75, 0.1, 0.2}), 0x11u);
  EXPECT_EQ(counts({0.3, 0.1, 0.2}), 0x21u);
  EXPECT_EQ(counts({2.5, 2.5, 2.5}), 0x10u);
  scene.meshes[0].indexCount -= 6;  // a side less
  EXPECT_GT(surroundingsOf(rankBoundaries(scene), {-1.5, 0.0, 0.0}).openness, 0.05);
}

TEST(BoundariesUnit, WhatLiesWithinAnotherComesAfterItWhateverTheOrder) {
  for (const bool innerFirst : {false, true}) {
    Scene scene;
    scene.media.resize(2);
    const int first = addBoundary(scene, Bsdf::none, 1.0f, 0, 0), second = addBoundary(scene, Bsdf::none, 1.0f, 1, 0);
    const int inner = innerFirst ? first : second, outer = innerFirst ? second : first;
    addBox(scene, glm::vec3(-2.0f), glm::vec3(2.0f), outer);
    addBox(scene, glm::vec3(-1.0f), glm::vec3(1.0f), inner);
    const auto rankOf = [&](int material) {
      return rankBoundaries(scene).rankOfMaterial[static_cast<std::size_t>(material)];
    };
    EXPECT_EQ(rankOf(outer), 0);
    EXPECT_EQ(rankOf(inner), 1);
    scene.materials[static_cast<std::size_t>(outer)].priority = 1;  // a priority is stronger
    EXPECT_EQ(rankOf(outer), 1);
  }
}

TEST(BoundariesUnit, MediaThatCrossNeedAPriority) {
  Scene scene;
  scene.media.resize(2);
  const int a = addBoundary(scene, Bsdf::none, 1.0f, 0, 0), b = addBoundary(scene, Bsdf::none, 1.0f, 1, 0);
  scene.materials[static_cast<std::size_t>(a)].name = "smoke";
  scene.materials[static_cast<std::size_t>(b)].name = "steam";
  addBox(scene, glm::vec3(-2.0f), glm::vec3(2.0f), a);
  addBox(scene, glm::vec3(-1.0f), glm::vec3(3.0f), b);
  try {
    rankBoundaries(scene);
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("smoke and steam"), std::string::npos) << error.what();
  }
  scene.materials[static_cast<std::size_t>(a)].priority = 1;
  EXPECT_NO_THROW(rankBoundaries(scene));
  Scene beside;  // a face in common is not an overlap
  beside.media.resize(2);
  addBox(beside, glm::vec3(-1.0f), glm::vec3(1.0f), addBoundary(beside, Bsdf::none, 1.0f, 0, 0));
  addBox(beside, glm::vec3(1.0f, -1.0f, -1.0f), glm::vec3(3.0f, 1.0f, 1.0f),
         addBoundary(beside, Bsdf::none, 1.0f, 1, 0));
  EXPECT_NO_THROW(rankBoundaries(beside));
}

TEST(SurroundingsUnit, BoundariesThatMayTouchOtherSurfacesAreTold) {
  Scene scene;
  const int glass = addBoundary(scene, Bsdf::dielectric, 1.5f, -1, 0),
            water = addBoundary(scene, Bsdf::dielectric, 1.33f, -1, 0);
  const int wall = addBoundary(scene, Bsdf::diffuse, 1.0f, -1, 0);
  const auto touching = [&](const glm::vec3& min, int material) {
    Scene with = scene;
    addBox(with, min, min + glm::vec3(1.0f), material);
    for (Mesh& mesh : with.meshes)
      for (std::uint32_t i = 0; i < mesh.indexCount; ++i)
        mesh.bounds.add(glm::dvec3(with.vertices[with.indices[mesh.firstIndex + i]].position));
    return boundariesMayTouch(with, rankBoundaries(with));
  };
  addBox(scene, glm::vec3(0.0f), glm::vec3(1.0f), glass);
  EXPECT_TRUE(touching({1.0f, 0.0f, 0.0f}, water));  // a face of each
  EXPECT_TRUE(touching({0.0f, -1.0f, 0.0f}, wall));  // stands on it
  EXPECT_FALSE(touching({1.1f, 0.0f, 0.0f}, water));
  EXPECT_FALSE(touching({1.0f, 0.0f, 0.0f}, glass));  // one and the same boundary
  scene = Scene{};
  addBoundary(scene, Bsdf::diffuse, 1.0f, -1, 0), addBoundary(scene, Bsdf::diffuse, 1.0f, -1, 0);
  addBox(scene, glm::vec3(0.0f), glm::vec3(1.0f), 0);
  EXPECT_FALSE(touching({1.0f, 0.0f, 0.0f}, 1));
}

}  // namespace
}  // namespace lucerna
