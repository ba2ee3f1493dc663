// Pixel filters: densities, their quantiles, and the samples that rasterised frames are drawn for.
#include "base/angles.hpp"
#include "base/named_values.hpp"
#include "base/pixel_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace lucerna {
namespace {

constexpr PixelFilter kFilters[] = {PixelFilter::box, PixelFilter::gaussian, PixelFilter::blackmanHarris};

/// Of the filter below an offset, by the midpoint rule.
double shareBelow(PixelFilter filter, double offset) {
  constexpr int kSteps = 20000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) sum += filterDensity(filter, -2.0 + (offset + 2.0) * (i + 0.5) / kSteps);
  return sum * (offset + 2.0) / kSteps;
}

TEST(PixelFilterTest, DensitiesAreEvenAndOfWholeOne) {
  for (const PixelFilter filter : kFilters) {
    EXPECT_NEAR(shareBelow(filter, 2.0), 1.0, 2e-4) << nameOf(filter);
    for (double x = 0.01; x < 2.0; x += 0.07)
      EXPECT_EQ(filterDensity(filter, x), filterDensity(filter, -x)) << nameOf(filter) << " " << x;
  }
}

TEST(PixelFilterTest, QuantilesAreThoseOfTheDensity) {
  for (const PixelFilter filter : kFilters) {
    const auto quantiles = filterQuantiles(filter);
    for (std::size_t i = 0; i < quantiles.size(); ++i)
      EXPECT_NEAR(shareBelow(filter, quantiles[i]),
                  0.5 - 0.5 * std::cos(kPi * static_cast<double>(i) / (kFilterNodes - 1.0)), 2e-4)
          << nameOf(filter) << " " << i;
  }
}

TEST(PixelFilterTest, SamplesHaveTheFiltersVariance) {
  for (const PixelFilter filter : kFilters) {
    double right = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const double x = -2.0 + (i + 0.5) * 1e-3;
      right += 1e-3 * x * x * filterDensity(filter, x);
    }
    const auto samples = pixelSamples(filter, 1024);
    for (int axis = 0; axis < 2; ++axis) {
      double sum = 0.0;
      for (const glm::dvec2& s : samples) sum += s[axis] * s[axis] / 1024.0;
      EXPECT_NEAR(sum / right, 1.0, 0.02) << nameOf(filter) << " axis " << axis;
    }
  }
}

/// The area of the unit square about the origin on the side dot(p, direction) < place.
double areaBelow(const glm::dvec2& direction, double place) {
  const double c = std::abs(direction.x), s = std::abs(direction.y);
  if (std::min(c, s) < 1e-9) return std::clamp(place + 0.5, 0.0, 1.0);
  const auto g = [](double x) { return x > 0.0 ? 0.5 * x * x : 0.0; };
  return (g(place + 0.5 * (c + s)) - g(place + 0.5 * (c - s)) - g(place - 0.5 * (c - s)) + g(place - 0.5 * (c + s))) /
         (c * s);
}

// Root mean square error of an edge's share over its places, in the worst of all directions. Of 16 places on a line it
// would be 0.018.
TEST(PixelFilterTest, EdgesOfAllDirectionsAreCoveredEvenly) {
  for (const auto& [count, most] :
       {std::pair(4, 0.135), std::pair(8, 0.07), std::pair(16, 0.041), std::pair(64, 0.017)}) {
    const auto samples = pixelSamples(PixelFilter::box, count);
    double worst = 0.0;
    for (int degrees = 0; degrees < 180; ++degrees) {
      const double angle = degrees * M_PI / 180.0;
      const glm::dvec2 direction(std::cos(angle), std::sin(angle));
      double squares = 0.0;
      constexpr int kPlaces = 301;
      for (int k = 0; k < kPlaces; ++k) {
        const double place = -0.75 + 1.5 * k / (kPlaces - 1.0);
        const auto below =
            std::ranges::count_if(samples, [&](const auto& s) { return glm::dot(s, direction) < place; });
        squares += std::pow(static_cast<double>(below) / count - areaBelow(direction, place), 2.0) / kPlaces;
      }
      worst = std::max(worst, std::sqrt(squares));
    }
    EXPECT_LT(worst, most) << count;
  }
}

TEST(PixelFilterTest, SamplesAreStratifiedAboutTheCentre) {
  EXPECT_EQ(pixelSamples(PixelFilter::box, 1).front(), glm::dvec2(0.0));
  EXPECT_EQ(pixelSamples(PixelFilter::centre, 16)[7], glm::dvec2(0.0));
  for (int n = 1; n <= 64; ++n) {
    glm::dvec2 mean(0.0);
    for (const glm::dvec2& s : pixelSamples(PixelFilter::box, n)) {
      mean += s / static_cast<double>(n);
      EXPECT_LE(std::max(std::abs(s.x), std::abs(s.y)), 0.5) << n;
    }
    EXPECT_NEAR(std::max(std::abs(mean.x), std::abs(mean.y)), 0.0, 1e-3) << n;
  }
  // One of 16 in each sixteenth of the width, of the height, and in each of 4 x 4 cells.
  std::set<int> columns, rows, cells;
  for (const glm::dvec2& s : pixelSamples(PixelFilter::box, 16)) {
    const auto place = [](double x, int n) { return static_cast<int>((x + 0.5) * n); };
    columns.insert(place(s.x, 16));
    rows.insert(place(s.y, 16));
    cells.insert(4 * place(s.y, 4) + place(s.x, 4));
  }
  EXPECT_EQ(columns.size(), 16u);
  EXPECT_EQ(rows.size(), 16u);
  EXPECT_EQ(cells.size(), 16u);
}

}  // namespace
}  // namespace lucerna
