// How many samples a frame in motion has, from the times of the frames before (forward/motion_samples.hpp).
#include "forward/motion_samples.hpp"

#include <gtest/gtest.h>

#include <random>

namespace lucerna {
namespace {

/// Where the number comes to rest, each time varying by up to `noise` of itself.
int restOf(double first, double further, int most, double noise = 0.0) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> factor(1.0 - noise, 1.0 + noise);
  MotionSamples count;
  int changes = 0;
  for (int frame = 0; frame < 80; ++frame) {
    const int last = count.now();
    count.add(first * factor(random), further * (last - 1) * factor(random), most);
    if (frame > 20 && count.now() != last) ++changes;
  }
  EXPECT_LE(changes, count.now() == 1 || count.now() == 2 ? 2 : 0) << first << " " << further;  // a look at two samples
  return count.now();
}

TEST(MotionSamples, AllAfterTheFirstTakeHalfOfItsTime) {
  EXPECT_EQ(restOf(200.0, 10.0, 16), 8);  // 70 of 100 ms; 16 would take 150
  EXPECT_EQ(restOf(200.0, 6.0, 16), 16);  // 90 of 100
  EXPECT_EQ(restOf(300.0, 175.0, 16), 1);  // one more takes more than half
  EXPECT_EQ(restOf(100.0, 45.0, 16), 2);
}

TEST(MotionSamples, OrWhatIsLeftOfASixtiethOfASecond) {
  EXPECT_EQ(restOf(2.0, 0.9, 16), 16);  // 2 + 13.5 of 16.7 ms
  EXPECT_EQ(restOf(2.0, 1.0, 16), 8);  // 16 would take 17
  EXPECT_EQ(restOf(12.0, 4.0, 16), 2);
}

TEST(MotionSamples, NoMoreThanAPictureHas) {
  EXPECT_EQ(restOf(2.0, 0.1, 16), 16);
  EXPECT_EQ(restOf(2.0, 0.1, 4), 4);
  EXPECT_EQ(restOf(2.0, 0.1, 1), 1);
}

TEST(MotionSamples, TheNumberStaysWhileTimesVaryByATenth) {
  for (const double further : {6.6, 8.0, 14.2, 20.0, 33.0, 60.0, 99.0, 120.0}) restOf(200.0, further, 64, 0.1);
}

}  // namespace
}  // namespace lucerna
