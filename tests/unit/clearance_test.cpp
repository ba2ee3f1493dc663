// Clearance grids: exact distances, against all triangles one by one and known answers; what counts as dense.
#include "pathtracer/clearance.hpp"
#include "scene/features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lucerna {
namespace {

TEST(Clearance, DistancesToATriangleAreKnown) {
  const Corners triangle{glm::dvec3(0, 0, 0), glm::dvec3(4, 0, 0), glm::dvec3(0, 3, 0)};
  EXPECT_DOUBLE_EQ(distanceTo(triangle, {1, 1, 2}), 2.0);  // its inside
  EXPECT_DOUBLE_EQ(distanceTo(triangle, {1, 1, -2}), 2.0);
  EXPECT_DOUBLE_EQ(distanceTo(triangle, {2, -3, 4}), 5.0);  // an edge
  EXPECT_DOUBLE_EQ(distanceTo(triangle, {7, 0, 4}), 5.0);  // a corner
  EXPECT_NEAR(distanceTo(triangle, {4, 3, 0}), 2.4, 1e-15);  // the hypotenuse
  const Corners line{glm::dvec3(0), glm::dvec3(2, 0, 0), glm::dvec3(1, 0, 0)};
  EXPECT_DOUBLE_EQ(distanceTo(line, {1.5, 3, 0}), 3.0);
  EXPECT_DOUBLE_EQ(distanceTo({glm::dvec3(1), glm::dvec3(1), glm::dvec3(1)}, glm::dvec3(1, 1, 3)), 2.0);
}

TEST(Clearance, CellsHoldTheDistanceToTheNearestTriangle) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto point = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  std::vector<Corners> triangles;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 at = 1.5 * point();
    triangles.push_back({at, at + 0.2 * point(), at + 0.2 * point()});
  }
  triangles.push_back({glm::dvec3(NAN), point(), point()});  // left out
  const ClearanceGrid grid = clearanceGrid(triangles, {-1.0, -0.5, -0.9}, {1.0, 0.3, 1.0}, 32);
  triangles.pop_back();
  EXPECT_EQ(grid.size, glm::ivec3(32, 13, 31));
  EXPECT_DOUBLE_EQ(grid.cell, 2.0 / 32.0);
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const glm::dvec3 centre = grid.min + grid.cell * (glm::dvec3(x, y, z) + 0.5);
        double nearest = std::numeric_limits<double>::infinity();
        for (const Corners& triangle : triangles) nearest = std::min(nearest, distanceTo(triangle, centre));
        const double radius = grid.radius[static_cast<std::size_t>(x + grid.size.x * (y + grid.size.y * z))];
        ASSERT_LE(radius, nearest);
        ASSERT_GE(radius, nearest * (1.0 - 2e-6));
      }
}

TEST(Clearance, DenseIsWhatScattersManyTimes) {
  Medium medium;
  const auto dense = [&](glm::vec3 scattering, glm::vec3 absorption, float g, double extent) {
    medium.scattering = scattering, medium.absorption = absorption, medium.anisotropy = glm::vec3(g);
    return isDense(medium, extent);
  };
  EXPECT_TRUE(dense({18.2f, 20.4f, 22.4f}, {0.0015f, 0.0046f, 0.02f}, 0.7f, 20.0));  // a block of milk
  EXPECT_FALSE(dense({18.2f, 20.4f, 22.4f}, {0.0015f, 0.0046f, 0.02f}, 0.7f, 0.01));  // a film of it
  EXPECT_TRUE(dense({0.0f, 0.0f, 22.4f}, {9.0f, 9.0f, 0.02f}, 0.7f, 20.0));  // one channel is enough
  EXPECT_FALSE(dense({7.8f, 8.1f, 8.5f}, {4.8f, 6.6f, 8.8f}, 0.9f, 100.0));  // espresso absorbs first
  EXPECT_FALSE(dense({0.0f, 0.0f, 0.0f}, {0.1f, 0.2f, 0.3f}, 0.0f, 100.0));
  EXPECT_FALSE(dense({0.05f, 0.05f, 0.05f}, {0.0f, 0.0f, 0.0f}, 0.99f, 300.0));  // straight on
}

}  // namespace
}  // namespace lucerna
