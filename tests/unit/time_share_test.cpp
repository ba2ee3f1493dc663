// Work beside frames keeps to its share of their time, whatever a piece of it takes.
#include "base/time_share.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace lucerna {
namespace {

struct Played {
  TimeShare time;
  double longestPiece = 0.0;
};

/// Frames that take `rest` seconds by themselves, and pieces as long as the one before says that they will be, more or
/// less.
Played play(double rest, double piece, double share, int frames) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> about(0.5, 1.5);
  Played played;
  double expected = 0.0, inFrame = 0.0;
  for (int i = 0; i < frames; ++i) {
    played.time.frame(about(random) * rest + inFrame, share, std::max(4.0 * expected, 1.5 * share * rest));
    inFrame = 0.0;
    while (played.time.left() - inFrame >= expected) {
      expected = about(random) * piece;
      inFrame += expected;
      played.longestPiece = std::max(played.longestPiece, expected);
    }
    played.time.spend(inFrame);
  }
  return played;
}

TEST(TimeShare, FramesBecomeLongerByTheShareAlone) {
  constexpr int kFrames = 2000;
  for (const double share : {0.01, 0.1, 0.9})
    for (const double rest : {0.002, 0.0167, 0.4})
      for (const double piece : {0.0005, 0.02, 0.3}) {
        const Played played = play(rest, piece, share, kFrames);
        const double most = share * played.time.rest();
        EXPECT_NEAR(played.time.rest(), kFrames * rest, 0.05 * kFrames * rest);
        EXPECT_LE(played.time.spent(), most + played.time.longest()) << share << " " << rest << " " << piece;
        // What is saved up is used: all but four pieces, and what a frame of many small ones leaves over.
        EXPECT_GE(played.time.spent(), 0.75 * most - 6.0 * played.longestPiece) << share << " " << rest << " " << piece;
      }
}

// As long as frames that include the work earned more of it, each made the next one longer.
TEST(TimeShare, WorkEarnsNothing) {
  TimeShare time;
  time.frame(0.1, 0.9, 1.0);
  time.spend(0.09);
  time.frame(0.1 + 0.09, 0.9, 1.0);
  EXPECT_NEAR(time.left(), 0.09, 1e-12);
  EXPECT_NEAR(time.rest(), 0.2, 1e-12);
}

TEST(TimeShare, IdleTimeIsNeitherEarnedNorSpent) {
  TimeShare time;
  time.frame(0.1, 0.1, 1.0);
  time.idle(0.03);
  time.frame(0.05, 0.1, 1.0);
  EXPECT_NEAR(time.rest(), 0.12, 1e-12);
  EXPECT_EQ(time.spent(), 0.0);
  EXPECT_NEAR(time.left(), 0.012, 1e-12);
}

TEST(TimeShare, ALongFrameIsNotSavedUp) {
  TimeShare time;
  time.frame(100.0, 0.1, 0.08);
  EXPECT_NEAR(time.left(), 0.08, 1e-12);
}

// A piece that took too long is paid back before the next one begins.
TEST(TimeShare, TooMuchIsPaidBack) {
  TimeShare time;
  time.frame(0.1, 0.1, 0.02);
  time.spend(0.045);
  int frames = 0;
  for (; time.left() < 0.0; ++frames) time.frame(0.1, 0.1, 0.02);
  EXPECT_EQ(frames, 4);
}

}  // namespace
}  // namespace lucerna
