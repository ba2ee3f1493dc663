// How work is cut into chunks, without a GPU.
#include "gl/chunks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lucerna::gl {
namespace {

constexpr std::uint32_t kPlenty = 1u << 30;

TEST(Chunks, BeginWithinWhatIsSafeUnmeasured) {
  for (const double iterationsOfUnit : {1.0, 1000.0, 512.0 * 512.0, 1e7, 0x1p26}) {
    const ChunkSize chunks(0.05, iterationsOfUnit, kPlenty);
    EXPECT_LE(chunks.units() * iterationsOfUnit, kUnmeasuredIterations);
    EXPECT_GT((chunks.units() + 1) * iterationsOfUnit, kUnmeasuredIterations);
  }
  EXPECT_EQ(ChunkSize(0.05, 1e12, kPlenty).units(), 1u);  // what cannot be cut
  EXPECT_EQ(ChunkSize(0.05, 1.0, 7).units(), 7u);
}

TEST(Chunks, FollowTheClock) {
  // A GPU of a given speed: after some chunks each takes what it shall, from below and from above.
  for (const double turnsPerSecond : {1e7, 3e8, 5e9}) {
    ChunkSize chunks(0.05, 1000.0, kPlenty);
    const auto time = [&] { return chunks.units() * 1000.0 / turnsPerSecond; };
    double before = 1e30;
    for (int i = 0; i < 12; ++i) {
      const std::uint32_t units = chunks.units();
      chunks.took(units, time());
      EXPECT_LE(chunks.units(), 2 * units);
      before = time();
    }
    EXPECT_NEAR(before, std::min(0.05, kMostOverUnmeasured * kUnmeasuredIterations / turnsPerSecond), 0.001);
  }
}

TEST(Chunks, NeverExceedWhatIsSafeWhateverWasMeasured) {
  ChunkSize chunks(0.05, 1000.0, kPlenty);
  for (int i = 0; i < 100; ++i) chunks.took(chunks.units(), 0.0);
  EXPECT_NEAR(chunks.units() * 1000.0, kMostOverUnmeasured * kUnmeasuredIterations, 1000.0);
  EXPECT_NEAR(chunks.largestIterations(), kMostOverUnmeasured * kUnmeasuredIterations, 1000.0);
  chunks.setIterationsOfUnit(10.0);  // most work items are done: the others may go on for longer
  chunks.took(chunks.units(), 0.0);
  EXPECT_GT(chunks.units() * 10.0, 5e5);
  for (int i = 0; i < 100; ++i) chunks.took(chunks.units(), 0.0);
  EXPECT_NEAR(chunks.units() * 10.0, kMostOverUnmeasured * kUnmeasuredIterations, 10.0);
  ChunkSize slow(0.05, 1000.0, kPlenty);
  for (int i = 0; i < 100; ++i) slow.took(slow.units(), 1000.0);
  EXPECT_EQ(slow.units(), 1u);
}

TEST(Chunks, ALastSmallerOneDoesNotHoldTheNextBack) {
  ChunkSize chunks(0.05, 1000.0, kPlenty);
  const std::uint32_t units = chunks.units();
  chunks.took(1, 0.001);
  EXPECT_EQ(chunks.units(), units);
  chunks.took(units / 2, 0.1);  // but one that was too slow does
  EXPECT_EQ(chunks.units(), units / 4);
}

TEST(Chunks, BeginAnewWhereNothingIsKnown) {
  ChunkSize chunks(0.05, 1000.0, kPlenty);
  const std::uint32_t first = chunks.units();
  chunks.took(first, 0.0);
  EXPECT_GT(chunks.units(), first);
  chunks.restart();
  EXPECT_EQ(chunks.units(), first);
  chunks.took(first, 0.2);
  chunks.restart();
  EXPECT_EQ(chunks.units(), first / 4);  // what was found too slow is
}

}  // namespace
}  // namespace lucerna::gl
