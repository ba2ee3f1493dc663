// The studio of models without light of their own.
#include "scene/studio.hpp"
#include "scene/motion.hpp"
#include "support/small_scenes.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace lucerna;
using lucerna::test::SceneBuilder;
using lucerna::test::TempFolder;

/// Six plates about the origin that face outwards (1) or inwards (-1), without that towards `without` of +x -x +y -y +z
/// -z.
Scene box(const glm::dvec3& half, double facing, int without = -1) {
  SceneBuilder builder;
  const int grey = builder.material(glm::vec3(0.5f));
  for (int side = 0; side < 6; ++side) {
    if (side == without) continue;
    glm::dvec3 normal(0.0), u(0.0);
    normal[side / 2] = side % 2 == 0 ? 1.0 : -1.0;
    u[(side / 2 + 1) % 3] = 1.0;
    const glm::dvec3 v = glm::cross(facing * normal, u);
    builder.plate(normal * half, 2.0 * u * half, 2.0 * v * half, grey);
  }
  return builder.scene();
}

glm::dvec2 mostOfFrame(const Scene& scene, const Camera& camera) {
  glm::dvec2 most(0.0);
  const glm::dvec3 right = glm::cross(camera.direction, camera.up);
  for (const Vertex& vertex : scene.vertices) {
    const glm::dvec3 p = glm::dvec3(vertex.position) - camera.position;
    const double z = glm::dot(p, camera.direction), half = z * std::tan(0.5 * camera.verticalFov);
    EXPECT_GT(z, 0.0);
    most = glm::max(most, glm::abs(glm::dvec2(glm::dot(p, right) / (16.0 / 9.0), glm::dot(p, camera.up))) / half);
  }
  return most;
}

TEST(Studio, AModelFillsTwoThirdsOfTheFrame) {
  for (const glm::dvec3& half : {glm::dvec3(1, 1, 1), glm::dvec3(9, 0.1, 2), glm::dvec3(0.02, 3, 0.01)}) {
    const Scene scene = box(half, 1.0);
    const Camera camera = studioView(scene);
    const glm::dvec2 most = mostOfFrame(scene, camera);
    EXPECT_NEAR(std::max(most.x, most.y), 2.0 / 3.0, 1e-4) << half.x;  // of positions in single precision
    EXPECT_NEAR(glm::dot(camera.up, camera.direction), 0.0, 1e-12);
  }
}

TEST(Studio, AnOpenBoxIsSeenThroughItsOpening) {
  for (int side : {0, 1, 4, 5}) {
    const Scene scene = box({2, 1, 2}, -1.0, side);
    glm::dvec3 out(0.0);
    out[side / 2] = side % 2 == 0 ? 1.0 : -1.0;
    const Camera camera = studioView(scene);
    EXPECT_NEAR(glm::dot(camera.direction, out), -1.0, 1e-9) << side;
    EXPECT_GT(glm::dot(camera.position, out), 2.0) << side;
    EXPECT_LT(glm::dot(studioSun(camera), out), 0.0) << side;
  }
  // From outside: solid ones, and a box that is open above.
  EXPECT_LT(studioView(box({2, 1, 2}, 1.0)).direction.x, -0.4);
  EXPECT_LT(studioView(box({2, 1, 2}, -1.0, 2)).direction.x, -0.4);
}

TEST(Studio, AClosedRoomWithLightOfItsOwnIsSeenFromWithin) {
  for (const glm::dvec3& half : {glm::dvec3(2, 1, 3), glm::dvec3(5, 0.2, 0.1), glm::dvec3(1, 9, 1)}) {
    Scene room = box(half, -1.0);
    const Camera camera = studioView(room);
    EXPECT_TRUE(glm::all(glm::lessThan(glm::abs(camera.position), half))) << half.x;
    EXPECT_GT(glm::dot(camera.direction, -camera.position), 0.5 * std::hypot(half.x, half.z)) << "from one end";
    EXPECT_EQ(camera.direction.y, 0.0);
    // Also around a pillar in its middle, by the lamp.
    Scene ring = room;
    ring.points.push_back({{0.7 * half.x, 0.0, 0.7 * half.z}, glm::vec3(1.0f)});
    const auto first = static_cast<std::uint32_t>(ring.vertices.size());
    const Scene pillar = box({0.2 * half.x, half.y, 0.2 * half.z}, 1.0);
    ring.vertices.insert(ring.vertices.end(), pillar.vertices.begin(), pillar.vertices.end());
    for (const std::uint32_t index : pillar.indices) ring.indices.push_back(first + index);
    const Camera around = studioView(ring);
    EXPECT_TRUE(glm::all(glm::lessThan(glm::abs(around.position), half))) << half.x;
    EXPECT_FALSE(glm::all(glm::lessThan(glm::abs(around.position), 0.2 * half))) << half.x;
    room.defaultSun = true;  // no other light: within it would be black
    EXPECT_GT(glm::length(studioView(room).position), glm::length(half)) << half.x;
  }
}

// The floor's radiance is that below the horizon: albedo / pi of the irradiance by the sun and by the picture's upper
// half.
TEST(Studio, TheSkyBeginsInTheFloorsColour) {
  const DirectionalLight sun{studioSun(studioView(box({1, 1, 1}, 1.0))), {10.0f, 9.6f, 9.0f}, 0.01};
  const Image sky = studioSky(sun, 256);
  glm::dvec3 ofSky(0.0);
  for (int row = 0; row < sky.height / 2; ++row) {
    const double top = std::cos(std::numbers::pi * row / sky.height),
                 bottom = std::cos(std::numbers::pi * (row + 1) / sky.height);
    ofSky += std::numbers::pi * (top * top - bottom * bottom) *
             glm::dvec3(sky.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(sky.width)]);
  }
  const glm::dvec3 floor(sky.pixels.back());
  const glm::dvec3 lit =
      static_cast<double>(kFloorAlbedo) / std::numbers::pi * (-sun.direction.y * glm::dvec3(sun.irradiance) + ofSky);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(floor[c] / lit[c], 1.0, 1e-4);
  // No band: from row to row it changes by less than a step of 8 bits sees.
  for (int row = 1; row < sky.height; ++row) {
    const auto at = [&](int r) {
      return sky.pixels[static_cast<std::size_t>(r) * static_cast<std::size_t>(sky.width)];
    };
    for (int c = 0; c < 3; ++c) EXPECT_LT(std::abs(at(row)[c] - at(row - 1)[c]) / floor[c], 0.02) << row;
  }
}

TEST(Studio, PilotLampsAreNoLightButWhatShinesOnSomethingIs) {
  const auto lit = [](Scene scene, std::size_t mesh) {
    Material glow = scene.materials[static_cast<std::size_t>(scene.meshes[mesh].material)];
    glow.emission = glm::vec3(1.0f);
    scene.meshes[mesh].material = static_cast<int>(scene.materials.size());
    scene.materials.push_back(glow);
    return scene;
  };
  EXPECT_TRUE(glowsOutwards(lit(box({1, 1, 1}, 1.0), 2)));  // a side of a solid box
  EXPECT_FALSE(glowsOutwards(lit(box({1, 1, 1}, -1.0), 2)));  // a ceiling
  SceneBuilder lampOverFloor;
  const int grey = lampOverFloor.material(glm::vec3(0.5f));
  lampOverFloor.plate({0, 0, 0}, {0, 0, 6}, {6, 0, 0}, grey);
  lampOverFloor.plate({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, grey);
  EXPECT_FALSE(glowsOutwards(lit(lampOverFloor.scene(), 1)));
  // Two thirds of its light meet a plate that hides less than half of what the middle sees.
  SceneBuilder lampOverPlate;
  const int white = lampOverPlate.material(glm::vec3(0.5f));
  lampOverPlate.plate({-0.8, 0, -0.8}, {0, 0, 1.6}, {1.6, 0, 0}, white);
  lampOverPlate.plate({-0.1, 0.5, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, white);
  EXPECT_FALSE(glowsOutwards(lit(lampOverPlate.scene(), 1)));
}

TEST(Studio, TheFloorIsBelowAndSurvivesMotion) {
  Scene still = box({1, 2, 1}, 1.0);
  still.bounds.add({-1, -2, -1});
  still.bounds.add({1, 2, 1});
  const std::size_t before = still.triangleCount();
  addFloor(still);
  EXPECT_GT(still.triangleCount(), before);
  EXPECT_NEAR(still.bounds.min.y, -2.0, 1e-3);
  EXPECT_LT(still.bounds.min.y, -2.0);
  EXPECT_GT(still.bounds.max.x, 4.0);
  for (std::uint32_t i = still.meshes.back().firstIndex; i < still.indices.size(); i += 3) {
    const auto at = [&](std::uint32_t k) { return glm::dvec3(still.vertices[still.indices[i + k]].position); };
    EXPECT_GT(glm::cross(at(1) - at(0), at(2) - at(0)).y, 0.0);
  }
  const TempFolder folder;
  folder.write("m.obj", "v -1 0 -1\nv 1 0 -1\nv 0 1 1\no lid\nf 1 2 3\n");
  folder.write("s.json", R"({"model": "m.obj", "objects": {"lid": {"translation": {"times": [0, 1], "values":
    [[0, 0, 0], [0, 5, 0]]}}}})");
  Scene moving = loadScene(folder.path() / "s.json");
  ASSERT_TRUE(moving.motion && moving.studio);
  addFloor(moving);
  const Bounds floor = moving.meshes.back().bounds;
  poseAt(moving, 1.0);
  EXPECT_NEAR(moving.vertices[moving.indices[moving.meshes.back().firstIndex]].position.y, floor.min.y, 1e-6);
  EXPECT_NEAR(moving.vertices.front().position.y, 5.0, 1e-5);
}

}  // namespace
