// Order statistics, and work that is stopped (no GL).
#include "base/error.hpp"
#include "base/statistics.hpp"
#include "base/stop_watch.hpp"
#include "rays/bvh.hpp"
#include "support/small_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace lucerna {
namespace {

// Ranks of the tables for 95 % (David and Nagaraja 2003): n = 6: 1 and 6, n = 10: 2 and 9, n = 20: 6 and 15.
TEST(Statistics, TheMediansIntervalHasTheRanksOfTheSignTest) {
  for (const auto& [n, low, high] : {std::array{6, 1, 6}, std::array{10, 2, 9}, std::array{20, 6, 15}}) {
    std::vector<double> values;
    for (int i = n; i >= 1; --i) values.push_back(i);
    const MedianInterval interval = medianInterval(values);
    EXPECT_EQ(interval.low, low) << n;
    EXPECT_EQ(interval.high, high) << n;
  }
  EXPECT_TRUE(std::isnan(medianInterval(std::vector<double>{1, 2, 3, 4, 5}).low));
}

TEST(Statistics, TheMediansIntervalHoldsItInNineteenOfTwentySamples) {
  std::mt19937 random(1);
  std::lognormal_distribution<double> skewed(0.0, 1.0);  // median 1
  constexpr int kRuns = 4000;
  int held = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> values(10);
    for (double& v : values) v = skewed(random);
    const MedianInterval interval = medianInterval(values);
    held += interval.low <= 1.0 && 1.0 <= interval.high;
  }
  EXPECT_NEAR(static_cast<double>(held) / kRuns, 0.9785, 0.01);  // 1 - 22 / 1024
}

TEST(StopWatch, AHierarchyEndsWhereAStopIsWanted) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  test::SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f));
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 p(in(random), in(random), in(random));
    builder.triangle(p, p + glm::dvec3(0.1, 0, 0), p + glm::dvec3(0, 0.1, 0), material);
  }
  int asked = 0;
  {
    const StopWatch watch([&](const LongWork& work) { return ++asked > 3 || work.share > 0.9; });
    EXPECT_THROW(buildBvh(builder.scene()), Stopped);
  }
  EXPECT_EQ(asked, 4);
  EXPECT_NO_THROW(buildBvh(builder.scene()));
}

}  // namespace
}  // namespace lucerna
