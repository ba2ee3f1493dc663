// How coarse the window's picture is in motion.
#include "walk/motion_scale.hpp"

#include <gtest/gtest.h>

#include <initializer_list>

namespace lucerna::demo {
namespace {

TEST(MotionScale, SlowFramesBecomeCoarseAtOnceAndFastOnesStayWhole) {
  MotionScale fast(false), slow(false), half(false);
  for (int frame = 0; frame < 5; ++frame) {
    EXPECT_EQ(fast.next(true), 1.0f);
    fast.took(0.19);
  }
  EXPECT_EQ(half.next(true), 1.0f);
  half.took(0.7);
  EXPECT_EQ(half.next(true), 0.5f);
  EXPECT_EQ(slow.next(true), 1.0f);
  slow.took(5.0);
  EXPECT_EQ(slow.next(true), 0.25f);
  slow.took(0.6);  // as coarse as it gets
  EXPECT_EQ(slow.next(true), 0.25f);
}

TEST(MotionScale, AtRestThePictureBecomesWholeInStepsAndMotionIsAsCoarseAsBefore) {
  MotionScale scale(true);
  EXPECT_EQ(scale.next(true), 0.25f) << "a software renderer's first frame";
  scale.took(0.5);
  for (const float expected : {0.5f, 1.0f, 1.0f}) {
    EXPECT_EQ(scale.next(false), expected);
    scale.took(5.0);  // of no consequence
  }
  EXPECT_EQ(scale.next(true), 0.25f);
  scale.showWhole();
  EXPECT_EQ(scale.next(false), 1.0f);
}

TEST(MotionScale, BecomesFinerWhereThatIsInTime) {
  MotionScale scale(true);
  const auto frame = [&](double seconds) {
    const float shown = scale.next(true);
    scale.took(seconds);
    return shown;
  };
  EXPECT_EQ(frame(0.04), 0.25f);  // 0.16 s would be too close
  EXPECT_EQ(frame(0.03), 0.25f);
  EXPECT_EQ(frame(0.12), 0.5f);
  EXPECT_EQ(frame(0.02), 0.5f);
  EXPECT_EQ(frame(0.08), 1.0f);
  EXPECT_EQ(frame(0.08), 1.0f);
}

}  // namespace
}  // namespace lucerna::demo
