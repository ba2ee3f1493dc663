// Triangles of polygons: they are wound as the polygon and their areas add up to its own, so they cover it once.
#include "base/error.hpp"
#include "scene/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lucerna {
namespace {

using Polygon = std::vector<glm::dvec2>;

/// Places a polygon in space: any plane, also far from the origin.
std::vector<glm::dvec3> placed(const Polygon& polygon, const glm::dvec3& u, const glm::dvec3& v,
                               const glm::dvec3& origin) {
  std::vector<glm::dvec3> corners;
  for (const glm::dvec2& p : polygon) corners.push_back(origin + p.x * u + p.y * v);
  return corners;
}

double signedArea(const Polygon& p) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const glm::dvec2 &a = p[i], &b = p[(i + 1) % p.size()];
    sum += 0.5 * (a.x * b.y - b.x * a.y);
  }
  return sum;
}

void expectCovered(const Polygon& polygon, double area, const std::string& what) {
  const glm::dvec3 u = glm::normalize(glm::dvec3(1.0, 0.3, -0.2)), away(0.1, -0.4, 1.0);
  const glm::dvec3 v = glm::normalize(away - glm::dot(away, u) * u);
  for (const bool reversed : {false, true}) {
    for (const double far : {0.0, 1e6}) {
      std::vector<glm::dvec3> corners = placed(polygon, u, v, glm::dvec3(far, -far, 0.3 * far));
      if (reversed) std::reverse(corners.begin(), corners.end());
      // Whichever corner comes first.
      for (std::size_t turn = 0; turn < corners.size(); ++turn) {
        std::rotate(corners.begin(), corners.begin() + 1, corners.end());
        std::vector<std::array<unsigned, 3>> triangles;
        appendTriangles(corners, 0, triangles);
        EXPECT_EQ(triangles.size(), corners.size() - 2) << what;
        const glm::dvec3 normal = glm::normalize(areaVector(corners));
        double positive = 0.0, negative = 0.0;
        for (const auto& t : triangles) {
          const double twice =
              glm::dot(normal, glm::cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]));
          (twice > 0.0 ? positive : negative) += 0.5 * twice;
        }
        const double tolerance = far > 0.0 ? 1e-7 : 1e-12;
        EXPECT_NEAR(positive, area, tolerance * area) << what << " from corner " << turn;
        EXPECT_NEAR(negative, 0.0, tolerance * area) << what << " from corner " << turn;
      }
    }
  }
}

TEST(Polygon, ConcaveOnesAreCoveredOnce) {
  expectCovered({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 3.0, "L");
  expectCovered({{0, 0}, {2, 1}, {0, 2}, {0.5, 1}}, 1.5, "arrow of four corners");
  expectCovered({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, 7.0, "U");
  expectCovered({{0, 0}, {5, 0}, {5, 3}, {4, 1}, {3, 3}, {2, 1}, {1, 3}, {0, 1}}, 10.0, "crown");
  Polygon star;
  for (int i = 0; i < 10; ++i)
    star.push_back((i % 2 ? 0.4 : 1.0) * glm::dvec2(std::cos(0.2 * M_PI * i), std::sin(0.2 * M_PI * i)));
  expectCovered(star, signedArea(star), "star");
  Polygon spiral;  // out along one side, back along the other
  for (int i = 0; i <= 60; ++i) spiral.push_back((1.0 + 0.1 * i) * glm::dvec2(std::cos(0.3 * i), std::sin(0.3 * i)));
  for (int i = 60; i >= 0; --i) spiral.push_back((1.5 + 0.1 * i) * glm::dvec2(std::cos(0.3 * i), std::sin(0.3 * i)));
  expectCovered(spiral, std::abs(signedArea(spiral)), "spiral");
}

TEST(Polygon, CornersOnALineAreCorners) {
  expectCovered({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, 4.0, "square with middles");
  expectCovered({{0, 0}, {0.1, 0}, {0.2, 0}, {0.3, 0}, {1, 0}, {0, 1}}, 0.5, "triangle with points on a side");
  expectCovered({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {2, 1}, {1, 1}, {0, 1}}, 3.0, "strip of middles");
  expectCovered({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 1.5}, {1, 2}, {0, 2}, {0, 1}}, 3.0, "L with middles");
  expectCovered({{0, 0}, {3, 0}, {3, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 4.5, "corners in line with each other");
}

TEST(Polygon, TouchingCornersAndEdgesAreCoveredOnce) {
  // Two squares that meet in a point, in one outline.
  expectCovered({{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}}, 2.0, "squares at a point");
  // A notch whose tip touches the opposite side: in its middle, and at a corner there.
  expectCovered({{0, 0}, {4, 0}, {4, 2}, {3, 2}, {2, 0}, {1, 2}, {0, 2}}, 6.0, "notch to a side");
  expectCovered({{0, 0}, {2, 0}, {4, 0}, {4, 2}, {3, 2}, {2, 0}, {1, 2}, {0, 2}}, 6.0, "notch to a corner");
  // Two notches that meet.
  expectCovered({{0, 0}, {1, 0}, {2, 1}, {3, 0}, {4, 0}, {4, 2}, {3, 2}, {2, 1}, {1, 2}, {0, 2}}, 6.0, "two notches");
}

TEST(Polygon, HolesJoinedByABridgeStayOpen) {
  expectCovered({{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}}, 8.0,
                "bridge at a corner");
  expectCovered(
      {{0, 0}, {3, 0}, {3, 1.5}, {2, 1.5}, {2, 1}, {1, 1}, {1, 2}, {2, 2}, {2, 1.5}, {3, 1.5}, {3, 3}, {0, 3}}, 8.0,
      "bridge in the middle of a side");
  // Two holes on one corner, and a hole that touches the outline.
  expectCovered({{0, 0},
                 {5, 0},
                 {5, 3},
                 {0, 3},
                 {0, 0},
                 {1, 1},
                 {1, 2},
                 {2, 2},
                 {2, 1},
                 {1, 1},
                 {0, 0},
                 {3, 1},
                 {3, 2},
                 {4, 2},
                 {4, 1},
                 {3, 1}},
                13.0, "two holes from a corner");
  expectCovered({{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 1.5}, {1, 2}, {2, 1.5}, {1, 1}, {0, 1.5}}, 8.0, "hole at a side");
  Polygon ring;
  for (int i = 0; i <= 24; ++i) ring.push_back(2.0 * glm::dvec2(std::cos(M_PI * i / 12), std::sin(M_PI * i / 12)));
  for (int i = 24; i >= 0; --i) ring.push_back(glm::dvec2(std::cos(M_PI * i / 12), std::sin(M_PI * i / 12)));
  expectCovered(ring, 12.0 * (4.0 - 1.0) * std::sin(M_PI / 12), "ring");
}

TEST(Polygon, RepeatedPointsAndEdgesThatLeadBackAddNothing) {
  expectCovered({{0, 0}, {1, 0}, {1, 0}, {1, 1}, {1, 1}, {1, 1}, {0, 1}}, 1.0, "repeated points");
  expectCovered({{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 3}, {1, 2}, {0, 2}}, 4.0, "antenna outside");
  expectCovered({{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {1, 2}, {0, 2}}, 4.0, "antenna inside");
  expectCovered({{0, 0}, {2, 0}, {3, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}}, 4.0, "closed twice, an antenna along a side");
}

TEST(Polygon, RandomStarsOfSmallNumbersAreCovered) {
  std::mt19937 random(1);
  for (int k = 0; k < 300; ++k) {
    // Around a centre, on a coarse grid, so that many corners fall on a line or together.
    const int count = 5 + static_cast<int>(random() % 20);
    Polygon star;
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * M_PI * i / count, radius = 1.0 + static_cast<double>(random() % 8);
      star.push_back(radius * glm::dvec2(std::cos(angle), std::sin(angle)));
    }
    expectCovered(star, signedArea(star), fmt::format("star {}", k));
  }
  for (int k = 0; k < 300; ++k) {
    // Histograms: all corners on a grid, many in line.
    Polygon steps = {{0, 0}};
    const int columns = 2 + static_cast<int>(random() % 8);
    steps.emplace_back(columns, 0.0);
    for (int c = columns; c-- > 0;) {
      const double height = 1.0 + static_cast<double>(random() % 3);
      steps.emplace_back(c + 1, height);
      steps.emplace_back(c, height);
    }
    double area = signedArea(steps);
    expectCovered(steps, area, fmt::format("histogram {}", k));
  }
}

TEST(Polygon, ACrossedOneIsCutSomehow) {
  for (const Polygon& crossed : {Polygon{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, Polygon{{0, 0}, {1, 0}, {2, 0}, {3, 0}}}) {
    std::vector<std::array<unsigned, 3>> triangles;
    appendTriangles(placed(crossed, {1, 0, 0}, {0, 1, 0}, glm::dvec3(0.0)), 7, triangles);
    ASSERT_EQ(triangles.size(), 2u);
    for (const auto& t : triangles)
      for (const unsigned i : t) EXPECT_TRUE(i >= 7 && i < 11);
  }
}

}  // namespace
}  // namespace lucerna
