// How work is cut into pieces, without a GPU.
#include "gl/pieces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace lucerna::gl {
namespace {

constexpr std::uint32_t kPlenty = 1u << 30;

TEST(Pieces, BeginWithinWhatIsSafeUnmeasured) {
  for (const double turnsOfUnit : {1.0, 1000.0, 512.0 * 512.0, 1e7, 0x1p26}) {
    const PieceSize pieces(0.05, turnsOfUnit, kPlenty);
    EXPECT_LE(pieces.units() * turnsOfUnit, kUnmeasuredTurns);
    EXPECT_GT((pieces.units() + 1) * turnsOfUnit, kUnmeasuredTurns);
  }
  EXPECT_EQ(PieceSize(0.05, 1e12, kPlenty).units(), 1u);  // what cannot be cut
  EXPECT_EQ(PieceSize(0.05, 1.0, 7).units(), 7u);
}

TEST(Pieces, FollowTheClock) {
  // A GPU of a given speed: after some pieces each takes what it shall, from below and from above.
  for (const double turnsPerSecond : {1e7, 3e8, 5e9}) {
    PieceSize pieces(0.05, 1000.0, kPlenty);
    const auto time = [&] { return pieces.units() * 1000.0 / turnsPerSecond; };
    double before = 1e30;
    for (int i = 0; i < 12; ++i) {
      const std::uint32_t units = pieces.units();
      pieces.took(units, time());
      EXPECT_LE(pieces.units(), 2 * units);
      before = time();
    }
    EXPECT_NEAR(before, std::min(0.05, kMostOverUnmeasured * kUnmeasuredTurns / turnsPerSecond), 0.001);
  }
}

TEST(Pieces, NeverExceedWhatIsSafeWhateverWasMeasured) {
  PieceSize pieces(0.05, 1000.0, kPlenty);
  for (int i = 0; i < 100; ++i) pieces.took(pieces.units(), 0.0);
  EXPECT_NEAR(pieces.units() * 1000.0, kMostOverUnmeasured * kUnmeasuredTurns, 1000.0);
  EXPECT_NEAR(pieces.largestTurns(), kMostOverUnmeasured * kUnmeasuredTurns, 1000.0);
  pieces.setTurnsOfUnit(10.0);  // most work items are done: the others may go on for longer
  pieces.took(pieces.units(), 0.0);
  EXPECT_GT(pieces.units() * 10.0, 5e5);
  for (int i = 0; i < 100; ++i) pieces.took(pieces.units(), 0.0);
  EXPECT_NEAR(pieces.units() * 10.0, kMostOverUnmeasured * kUnmeasuredTurns, 10.0);
  PieceSize slow(0.05, 1000.0, kPlenty);
  for (int i = 0; i < 100; ++i) slow.took(slow.units(), 1000.0);
  EXPECT_EQ(slow.units(), 1u);
}

TEST(Pieces, ALastSmallerOneDoesNotHoldTheNextBack) {
  PieceSize pieces(0.05, 1000.0, kPlenty);
  const std::uint32_t units = pieces.units();
  pieces.took(1, 0.001);
  EXPECT_EQ(pieces.units(), units);
  pieces.took(units / 2, 0.1);  // but one that was too slow does
  EXPECT_EQ(pieces.units(), units / 4);
}

TEST(Pieces, BeginAnewWhereNothingIsKnown) {
  PieceSize pieces(0.05, 1000.0, kPlenty);
  const std::uint32_t first = pieces.units();
  pieces.took(first, 0.0);
  EXPECT_GT(pieces.units(), first);
  pieces.restart();
  EXPECT_EQ(pieces.units(), first);
  pieces.took(first, 0.2);
  pieces.restart();
  EXPECT_EQ(pieces.units(), first / 4);  // what was found too slow is
}

}  // namespace
}  // namespace lucerna::gl
