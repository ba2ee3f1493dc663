// The error that the denoiser states, and the shares of its candidates: exact answers.
#include "pathtracer/denoiser.hpp"
#include "support/denoise_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lucerna::test {
namespace {

TEST(DenoisedError, IsTheRootOfTheMeanSquareOverTheMean) {
  std::vector<DenoisedBlock> blocks(12, {3.0 * 64 * 0.04, 3.0 * 64 * 0.06, 3.0 * 64 * 0.25, 64.0});
  const DenoisedError error = denoisedError(blocks, 4, 2.0);
  EXPECT_TRUE(error.known);
  EXPECT_NEAR(error.value, std::sqrt(0.05) / 2.0, 1e-12);
  EXPECT_NEAR(error.raw, 0.25, 1e-12);
  // Blocks that do not differ leave the two estimates as the interval's ends.
  EXPECT_NEAR(error.low, std::sqrt(0.04) / 2.0, 1e-9);
  EXPECT_NEAR(error.high, std::sqrt(0.06) / 2.0, 1e-9);
}

TEST(DenoisedError, IsUnknownWithoutBlocksOrLight) {
  EXPECT_FALSE(denoisedError({}, 1, 1.0).known);
  EXPECT_FALSE(denoisedError(std::vector<DenoisedBlock>(1, {1.0, 1.0, 1.0, 64.0}), 1, 1.0).known);
  EXPECT_FALSE(denoisedError(std::vector<DenoisedBlock>(4, {0.0, 0.0, 0.0, 64.0}), 2, 0.0).known);
  EXPECT_FALSE(denoisedError(std::vector<DenoisedBlock>(4, {0.0, 0.0, 0.0, 0.0}), 2, 1.0).known);
}

constexpr int kViews = 2000;

/// Views of kViews whose interval holds the true error. A raw picture of normal noise: in each block `values` times two
/// halves, whose standard deviation is drawn by scaleOf, each for `channels` alike.
template <class ScaleOf>
int viewsHeld(std::mt19937& random, std::size_t blockCount, int columns, int values, double channels,
              const ScaleOf& scaleOf) {
  std::normal_distribution<double> normal;
  int held = 0;
  for (int view = 0; view < kViews; ++view) {
    std::vector<DenoisedBlock> blocks(blockCount);
    double truth = 0.0, count = 0.0;
    for (DenoisedBlock& b : blocks) {
      for (int i = 0; i < values; ++i) {
        const double scale = scaleOf();
        const double a = scale * normal(random), c = scale * normal(random);
        b.error += channels * (a - c) * (a - c) / 4.0;
        truth += channels * (a + c) * (a + c) / 4.0;
        count += channels;
      }
      b.heldOut = b.raw = b.error;
      b.pixels = 64.0;
    }
    const DenoisedError error = denoisedError(blocks, columns, 1.0);
    const double own = std::sqrt(truth / count);
    held += own >= error.low && own <= error.high;
  }
  return held;
}

// The estimate (A - B)^2 / 4 and the true (R - t)^2 are independent and equally spread.
TEST(DenoisedError, HoldsTheTrueErrorOfNormalNoiseInNinetyNineOfAHundredViews) {
  std::mt19937 random(1);
  const int held = viewsHeld(random, 24, 6, 3 * 64, 1.0, [] { return 1.0; });
  // 99 % less four standard errors of 2000 trials, and what the scatter of neighbours costs a small sample.
  EXPECT_GE(held, static_cast<int>(0.97 * kViews));
  EXPECT_LT(held, kViews);
}

// One pixel in 250 holds almost all of the error: a dozen of them in a picture. 97 of 100 views are held, 95 without
// the skewness.
TEST(DenoisedError, HoldsTheTrueErrorWhereRarePixelsMakeIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  const int held = viewsHeld(random, 48, 8, 64, 3.0, [&] { return uniform(random) < 0.004 ? 20.0 : 0.1; });
  EXPECT_GE(held, static_cast<int>(0.96 * kViews)) << held;
}

TEST(DenoiserShares, AreTheMinimum) {
  using Vector = std::array<double, 4>;
  const auto value = [](const Vector& c, const std::array<Vector, 4>& g, const Vector& l) {
    double v = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      v += 2.0 * c[i] * l[i];
      for (std::size_t j = 0; j < 4; ++j) v += l[i] * g[i][j] * l[j];
    }
    return v;
  };
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  for (int trial = 0; trial < 200; ++trial) {
    Vector c{};
    std::array<Vector, 4> g{};
    std::array<std::array<double, 6>, 4> d{};
    for (auto& row : d)
      for (double& v : row) v = normal(random);
    for (std::size_t i = 0; i < 4; ++i) {
      c[i] = normal(random) - 1.0;
      for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t k = 0; k < 6; ++k) g[i][j] += d[i][k] * d[j][k];
    }
    const Vector best = bestShares(c, g);
    double sum = 0.0;
    for (const double l : best) {
      EXPECT_GE(l, -1e-9);
      sum += l;
    }
    EXPECT_LE(sum, 1.0 + 1e-9);
    for (int other = 0; other < 200; ++other) {
      Vector l{};
      double all = -std::log(uniform(random));
      for (double& v : l) all += v = -std::log(uniform(random));
      for (double& v : l) v /= all;
      EXPECT_LE(value(c, g, best), value(c, g, l) + 1e-9);
    }
  }
}

}  // namespace
}  // namespace lucerna::test
