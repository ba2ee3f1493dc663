// A triangle's parts: where they lie, and which of them a point lies in.
#include "scene/triangle_parts.hpp"

#include <gtest/gtest.h>

#include <random>

namespace lucerna {
namespace {

TEST(TriangleParts, CentroidsLieInTheirOwnPartAndAddUpToTheTriangles) {
  for (int n = 1; n <= 8; ++n) {
    const std::vector<glm::dvec2> centroids = partCentroids(n);
    ASSERT_EQ(centroids.size(), static_cast<std::size_t>(n * n));
    glm::dvec2 mean(0.0);
    for (int k = 0; k < n * n; ++k) {
      EXPECT_EQ(partAt(n, centroids[static_cast<std::size_t>(k)]), k) << n;
      mean += centroids[static_cast<std::size_t>(k)] / static_cast<double>(n * n);
    }
    EXPECT_NEAR(mean.x, 1.0 / 3.0, 1e-12);
    EXPECT_NEAR(mean.y, 1.0 / 3.0, 1e-12);
  }
}

TEST(TriangleParts, APointLiesInThePartWhoseCornersAreAboutIt) {
  // A part is its centroid's triangle, or that upside down: a point in it is nowhere a third of an edge beyond the
  // centroid, in any of three coordinates.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int k = 0; k < 20000; ++k) {
    const int n = 1 + k % 8;
    glm::dvec2 at(uniform(random), uniform(random));
    if (at.x + at.y > 1.0) at = 1.0 - at;
    const glm::dvec2 away = (at - partCentroids(n)[static_cast<std::size_t>(partAt(n, at))]) * static_cast<double>(n);
    const double third = 1.0 / 3.0 + 1e-9, largest = std::max({away.x, away.y, -away.x - away.y}),
                 least = std::min({away.x, away.y, -away.x - away.y});
    EXPECT_TRUE((least > -third && largest < 2.0 * third) || (largest < third && least > -2.0 * third))
        << n << " " << at.x << " " << at.y;
  }
  EXPECT_EQ(partAt(4, {1.0, 0.0}), 15);  // corners
  EXPECT_EQ(partAt(4, {0.0, 1.0}), 6);
  EXPECT_EQ(partAt(4, {0.0, 0.0}), 0);
}

}  // namespace
}  // namespace lucerna
