// What is seen near the camera, and how near surfaces are drawn.
#include "render/near_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

/// A floor at y = 0, `side` wide, and a camera at `height` above its middle that looks along -z.
Scene floorScene(double side, double height) {
  Scene scene;
  scene.materials.resize(1);
  const auto h = static_cast<float>(0.5 * side);
  for (const glm::vec3& p : {glm::vec3(-h, 0, -h), glm::vec3(-h, 0, h), glm::vec3(h, 0, h), glm::vec3(h, 0, -h)}) {
    scene.vertices.emplace_back().position = p;
    scene.bounds.add(glm::dvec3(p));
  }
  scene.indices = {0, 1, 2, 0, 2, 3};
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.indexCount = 6;
  mesh.bounds = scene.bounds;
  Camera& camera = scene.cameras.emplace_back();
  camera.position = {0.0, height, 0.0};
  camera.direction = {0.0, 0.0, -1.0};
  camera.verticalFov = 2.0 * std::atan(0.5);
  return scene;
}

// The lower edge of the picture sees the floor where its half height is the camera's: 2 heights away.
TEST(NearPlane, AFloorIsNearestAtThePicturesEdge) {
  const Scene scene = floorScene(10000.0, 3.0);
  const double usual = 5e-4 * std::hypot(10000.0, 10000.0);
  ASSERT_EQ(nearestInView(scene, scene.cameras[0], 2.0, usual).size(), 1u);
  EXPECT_NEAR(nearestInView(scene, scene.cameras[0], 2.0, usual)[0], 6.0, 1e-9);
  EXPECT_TRUE(std::isinf(nearestInView(scene, scene.cameras[0], 2.0, 5.9)[0]));
  EXPECT_NEAR(nearPlane(scene, 2.0), 3.0, 1e-9);
}

TEST(NearPlane, WhatIsFarAwayLeavesItWhereItIs) {
  EXPECT_NEAR(nearPlane(floorScene(100.0, 3.0), 1.0), 5e-4 * std::hypot(100.0, 100.0), 1e-9);
}

// A camera that touches a surface: what is far away keeps its depth.
TEST(NearPlane, WhatIsNearerThanAMillionthOfTheSceneLeavesItWhereItIs) {
  const double diagonal = std::hypot(1e6, 1e6);
  EXPECT_NEAR(nearPlane(floorScene(1e6, 1.1e-6 * diagonal), 1.0), 1.1e-6 * diagonal, 1e-9);
  EXPECT_NEAR(nearPlane(floorScene(1e6, 0.9e-6 * diagonal), 1.0), 5e-4 * diagonal, 1e-9);
  EXPECT_NEAR(nearPlane(floorScene(1e6, 0.0), 1.0), 5e-4 * diagonal, 1e-9);
}

TEST(NearPlane, WhatIsBehindOrBesideTheViewIsNotSeen) {
  Scene scene = floorScene(10.0, 3.0);
  scene.cameras[0].direction = {0.0, 1.0, 0.0};
  scene.cameras[0].up = {0.0, 0.0, 1.0};
  EXPECT_TRUE(std::isinf(nearestInView(scene, scene.cameras[0], 1.0, 1e9)[0]));
}

}  // namespace
}  // namespace lucerna
