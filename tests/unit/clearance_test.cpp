// Clearance grids: exact distances, against all triangles one by one and known answers; what counts as dense.
#include "base/packed_normal.hpp"
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

/// Small triangles around the box of the grid below, in any direction.
std::vector<Corners> scatteredTriangles(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto point = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  std::vector<Corners> triangles;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 at = 1.5 * point();
    triangles.push_back({at, at + 0.2 * point(), at + 0.2 * point()});
  }
  triangles.push_back({glm::dvec3(NAN), point(), point()});  // left out
  return triangles;
}

const Clearance& cellOf(const ClearanceGrid& grid, int x, int y, int z) {
  return grid.clearances[static_cast<std::size_t>(x + grid.size.x * (y + grid.size.y * z))];
}

TEST(Clearance, CellsHoldTheDistanceToTheNearestTriangle) {
  std::mt19937 random(5);
  std::vector<Corners> triangles = scatteredTriangles(random);
  const ClearanceGrid grid =
      clearanceGrid(triangles, std::vector<bool>(triangles.size()), {-1.0, -0.5, -0.9}, {1.0, 0.3, 1.0}, 32, 0.05);
  triangles.pop_back();
  EXPECT_EQ(grid.size, glm::ivec3(32, 13, 31));
  EXPECT_DOUBLE_EQ(grid.cell, 2.0 / 32.0);
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const glm::dvec3 centre = grid.min + grid.cell * (glm::dvec3(x, y, z) + 0.5);
        double nearest = std::numeric_limits<double>::infinity();
        for (const Corners& triangle : triangles) nearest = std::min(nearest, distanceTo(triangle, centre));
        const double radius = cellOf(grid, x, y, z).radius;
        ASSERT_LE(radius, nearest);
        ASSERT_GE(radius, nearest * (1.0 - 2e-6));
      }
}

TEST(Clearance, NormalsAreUnitVectorsToWithinAPackingStep) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  double worst = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    worst = std::max(worst, glm::length(unpackNormal(packNormal(n)) - n));
  }
  // Half a step in both coordinates moves the octahedron's point by (1, 1, 2) / 2 steps, where it is nearest to 0.
  EXPECT_LT(worst, std::sqrt(6.0) * 0.5 / 32767.0 * std::sqrt(3.0));
  for (const glm::dvec3& axis : {glm::dvec3(0, 0, -1), glm::dvec3(0, -1, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1)})
    EXPECT_EQ(unpackNormal(packNormal(axis)), axis);
}

TEST(Clearance, WithinReachAllTrianglesLieBeyondThePlane) {
  std::mt19937 random(7);
  std::vector<Corners> triangles = scatteredTriangles(random);
  std::vector<bool> isBoundary(triangles.size());
  for (std::size_t i = 0; i < isBoundary.size(); ++i) isBoundary[i] = i % 2 == 0;
  const ClearanceGrid grid = clearanceGrid(triangles, isBoundary, {-1.0, -0.5, -0.9}, {1.0, 0.3, 1.0}, 16, 0.05);
  triangles.pop_back();
  int planes = 0, farther = 0;
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const Clearance& clearance = cellOf(grid, x, y, z);
        if (!(clearance.reach > 0.0f)) continue;
        ++planes;
        farther += clearance.reach > 1.2f * clearance.radius;
        const glm::dvec3 centre = grid.min + grid.cell * (glm::dvec3(x, y, z) + 0.5),
                         normal = unpackNormal(clearance.normal);
        for (const Corners& triangle : triangles) {
          if (distanceTo(triangle, centre) > clearance.reach) continue;
          for (const glm::dvec3& corner : triangle)
            ASSERT_GE(glm::dot(normal, corner - centre), static_cast<double>(clearance.depth) - 1e-7);
        }
      }
  EXPECT_GT(planes, 1000);
  EXPECT_GT(farther, 500);
}

TEST(Clearance, BesideAFlatWallTheReachIsThatOfManyFreePaths) {
  // The floor of a room, its outside below. Beside it the ball of a cell ends at the wall, the half-space does not.
  const double size = 10.0;
  std::vector<Corners> triangles{{glm::dvec3(0, 0, 0), glm::dvec3(size, 0, 0), glm::dvec3(size, 0, size)},
                                 {glm::dvec3(0, 0, 0), glm::dvec3(size, 0, size), glm::dvec3(0, 0, size)}};
  const std::vector<bool> isBoundary{true, true};
  const double freePath = 0.1;
  const ClearanceGrid grid = clearanceGrid(triangles, isBoundary, {0, -size, 0}, {size, size, size}, 64, freePath);
  for (const int y : {30, 31, 32, 33}) {  // the wall lies between 31 and 32
    const Clearance& clearance = cellOf(grid, 16, y, 16);
    const double above = (y + 0.5) * grid.cell - size;
    const glm::dvec3 normal = unpackNormal(clearance.normal);
    EXPECT_NEAR(clearance.radius, std::abs(above), 1e-5);
    EXPECT_GT(clearance.reach, 8.0 * freePath);
    EXPECT_NEAR(std::abs(normal.y), 1.0, 1e-9);
    // outwards of the boundary: its normal is (0, -1, 0)
    EXPECT_NEAR(clearance.depth, above, 1e-5) << y;
  }
  // Of a wall that is no boundary the cell's side is seen.
  const ClearanceGrid seen = clearanceGrid(triangles, {false, false}, {0, -size, 0}, {size, size, size}, 64, freePath);
  EXPECT_NEAR(cellOf(seen, 16, 31, 16).depth, 0.5 * grid.cell, 1e-5);
  EXPECT_NEAR(unpackNormal(cellOf(seen, 16, 31, 16).normal).y, 1.0, 1e-9);
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
