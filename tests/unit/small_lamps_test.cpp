// Parts of meshes: what hangs together, what of it a picture shows large; emissive ones as bodies, with balls around.
#include "irradiance_cache/small_lamps.hpp"
#include "scene/parts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

namespace lucerna {
namespace {

/// A square of two triangles with corners of their own, in a plane of constant y.
void addSquare(Scene& scene, const glm::vec3& corner, float side, int material) {
  const auto first = static_cast<std::uint32_t>(scene.indices.size());
  const std::array<glm::vec2, 6> places{{{0, 0}, {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}}};
  for (const glm::vec2& p : places) {
    scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.emplace_back().position = corner + side * glm::vec3(p.x, 0.0f, p.y);
  }
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.firstIndex = first;
  mesh.indexCount = 6;
  mesh.material = material;
}

TEST(EmissiveBodies, AreWhatHangsTogetherSmallestFirst) {
  Scene scene;
  scene.materials.resize(3);
  scene.materials[1].emission = glm::vec3(0.0f, 0.0f, 1.0f);
  scene.materials[2].emission = glm::vec3(1.0f);
  addSquare(scene, {0, 0, 0}, 8.0f, 0);  // dark
  addSquare(scene, {0, 1, 0}, 2.0f, 1);
  addSquare(scene, {2, 1, 2}, 2.0f, 2);  // shares a corner, of another mesh
  addSquare(scene, {6, 1, 0}, 1.0f, 1);
  const std::vector<glm::vec4> bodies = emissiveBodies(scene, {1.0, 1.0, 1.0});
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies[0], glm::vec4(5.5f, 0.0f, -0.5f, std::sqrt(0.5f)));
  EXPECT_EQ(bodies[1], glm::vec4(1.0f, 0.0f, 1.0f, std::sqrt(8.0f)));
}

TEST(Parts, AreLargeInViewByTheirShareOfItsHeight) {
  Scene scene;
  scene.materials.resize(1);
  addSquare(scene, {0, 0, 0}, 100.0f, 0);
  addSquare(scene, {50, 1, 50}, 1.0f, 0);  // sqrt(2) across: a twentieth of 28.3
  EXPECT_EQ(connectedParts(scene, [](const Mesh&) { return true; }).size(), 2u);
  Camera& camera = scene.cameras.emplace_back();
  camera.verticalFov = 2.0 * std::atan(0.5);  // as high as far
  for (const auto& [height, expected] : {std::pair{100.0, 1u}, {30.0, 1u}, {28.0, 2u}}) {
    camera.position = {50.5, 1.0 + height, 50.5};
    EXPECT_EQ(partsLargeInView(scene).size(), expected) << height;
  }
}

TEST(EmissiveBodies, NothingEmits) {
  Scene scene;
  scene.materials.resize(1);
  addSquare(scene, {0, 0, 0}, 1.0f, 0);
  EXPECT_TRUE(emissiveBodies(scene, glm::dvec3(0.0)).empty());
}

}  // namespace
}  // namespace lucerna
