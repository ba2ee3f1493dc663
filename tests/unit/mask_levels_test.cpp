// A mask's smaller versions keep its coverage (forward/mask_levels.hpp).
#include "forward/mask_levels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace lucerna {
namespace {

/// Reference: bilinear interpolation of a picture at u, v in [0, 1), in double precision. Of a mirrored one the texel
/// beyond the edge is that of the edge, too.
double interpolated(const std::vector<std::uint8_t>& texels, glm::ivec2 size, double u, double v, TextureWraps wraps) {
  const double x = u * size.x - 0.5, y = v * size.y - 0.5, fx = x - std::floor(x), fy = y - std::floor(y);
  const auto place = [](double at, int n, TextureWrap wrap) {
    const int i = static_cast<int>(at);
    return wrap == TextureWrap::repeat ? (i % n + n) % n : std::clamp(i, 0, n - 1);
  };
  const auto at = [&](double column, double row) {
    const int i = place(column, size.x, wraps.u), j = place(row, size.y, wraps.v);
    return static_cast<double>(texels[static_cast<std::size_t>(j * size.x + i)]) / 255.0;
  };
  const double left = std::floor(x), below = std::floor(y);
  return (at(left, below) * (1.0 - fx) + at(left + 1.0, below) * fx) * (1.0 - fy) +
         (at(left, below + 1.0) * (1.0 - fx) + at(left + 1.0, below + 1.0) * fx) * fy;
}

double coverageOf(const std::vector<std::uint8_t>& texels, glm::ivec2 size, TextureWraps wraps = {}) {
  constexpr int kSide = 700;
  int covered = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i)
      covered += interpolated(texels, size, (i + 0.5) / kSide, (j + 0.5) / kSide, wraps) >= 0.5;
  return covered / (static_cast<double>(kSide) * kSide);
}

/// Discs in the cells of a grid, none in its middle, which cover about `share` of the picture.
std::vector<std::uint8_t> leaves(glm::ivec2 size, int across, double share) {
  std::vector<std::uint8_t> texels;
  const double cell = static_cast<double>(size.x) / across, radius = cell * std::sqrt(share / 3.14159265358979);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const double column = std::floor((x + 0.5) / cell), row = std::floor((y + 0.5) / cell),
                   u = x + 0.5 - cell * (column + 0.5 + 0.2 * std::sin(7.0 * column + 3.0 * row)),
                   v = y + 0.5 - cell * (row + 0.5 + 0.2 * std::cos(5.0 * column - 4.0 * row));
      texels.push_back(std::hypot(u, v) < radius ? 255 : 0);
    }
  return texels;
}

TEST(MaskLevels, KeepTheCoverageOfTheMask) {
  for (const glm::ivec2& size : {glm::ivec2(128, 128), glm::ivec2(96, 96)})
    for (const double share : {0.1, 0.3, 0.6}) {
      const std::vector<std::uint8_t> texels = leaves(size, 12, share);
      const double right = coverageOf(texels, size);
      EXPECT_NEAR(maskCoverage(texels, size, {}), right, 0.01);
      const auto levels = maskLevels(texels, size, {});
      glm::ivec2 side = size;
      for (const std::vector<std::uint8_t>& level : levels) {
        side = glm::max(side / 2, glm::ivec2(1));
        ASSERT_EQ(level.size(), static_cast<std::size_t>(side.x * side.y));
        const double kept = coverageOf(level, side);
        std::printf("%d texels, %g covered: %.4f of %.4f in %d texels\n", size.x, share, kept, right, side.x);
        EXPECT_NEAR(kept, right, 0.02 + 0.05 * right) << size.x << " " << share << " " << side.x;
      }
      EXPECT_LE(side.x, size.x / 4) << "as far as they can";
      EXPECT_GT(levels.back().size(), 1u) << "one texel covers all or nothing";
    }
}

// Few texels, so that their borders count: a bar along the left edge, and a corner.
TEST(MaskLevels, BordersCountAsThePictureContinues) {
  constexpr TextureWrap kAll[] = {TextureWrap::repeat, TextureWrap::edge, TextureWrap::mirror};
  const std::vector<std::uint8_t> bar{255, 0, 0, 0, 200, 0, 0, 0, 180, 0, 0, 0}, corner{255, 90, 0, 0, 140, 255};
  for (const TextureWrap u : kAll)
    for (const TextureWrap v : kAll) {
      EXPECT_NEAR(maskCoverage(bar, {4, 3}, {u, v}), coverageOf(bar, {4, 3}, {u, v}), 4e-3);
      EXPECT_NEAR(maskCoverage(corner, {2, 3}, {u, v}), coverageOf(corner, {2, 3}, {u, v}), 4e-3);
    }
  // A clamped edge is whole up to the border: half the first texel's reach more.
  EXPECT_GT(coverageOf(bar, {4, 3}, {TextureWrap::edge, TextureWrap::edge}), 0.2);
}

TEST(MaskLevels, FullAndEmptyMasksStayAsTheyAre) {
  for (const int value : {0, 255}) {
    const std::vector<std::uint8_t> texels(6 * 4, static_cast<std::uint8_t>(value));
    const auto levels = maskLevels(texels, {6, 4}, {});
    ASSERT_EQ(levels.size(), 2u);
    for (const auto& level : levels)
      for (const std::uint8_t v : level) EXPECT_EQ(v, value);
  }
}

}  // namespace
}  // namespace lucerna
