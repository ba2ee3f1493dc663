// Key-frame files and the natural cubic spline, against its defining properties.
#include "base/angles.hpp"
#include "scene/key_frames.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::TempFolder;

KeyFrame keyAt(const glm::dvec3& position, const glm::dvec3& direction = {0, 0, -1}, const glm::dvec3& up = {0, 1, 0}) {
  KeyFrame key;
  key.position = position;
  key.direction = direction;
  key.up = up;
  return key;
}

std::vector<KeyFrame> wildKeys() {
  return {keyAt({0, 0, 0}), keyAt({3, 1, -2}, {1, 0, 0}), keyAt({2, 5, 1}, {0, 0.5, 1}),
          keyAt({-4, 2, 0}, {-1, 0.2, 0.3}), keyAt({1, -1, 7})};
}

glm::dvec3 position(const Spline& spline, double t) { return spline.at(t).position; }

/// Second derivative from one side: three points at t, t + h, t + 2h give it exactly at t + h for a cubic, and two such
/// values extrapolate to t exactly, as a cubic's second derivative is linear.
glm::dvec3 secondDerivative(const Spline& spline, double t, double h) {
  const auto centred = [&](double s) {
    return (position(spline, s + h) - 2.0 * position(spline, s) + position(spline, s - h)) / (h * h);
  };
  return 2.0 * centred(t + h) - centred(t + 2.0 * h);
}

TEST(SplineTest, PassesThroughItsKeys) {
  const std::vector<KeyFrame> keys = wildKeys();
  const Spline spline(keys);
  EXPECT_EQ(spline.segmentCount(), 4);
  EXPECT_EQ(spline.viewCount(), 4 * 200 + 1);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Camera camera = spline.view(static_cast<int>(i) * 200);
    EXPECT_LT(glm::distance(camera.position, keys[i].position), 1e-12);
    EXPECT_LT(glm::distance(camera.direction, glm::normalize(keys[i].direction)), 1e-12);
  }
}

TEST(SplineTest, SecondDerivativeIsZeroAtBothEnds) {
  const Spline spline(wildKeys());
  EXPECT_LT(glm::length(secondDerivative(spline, 0.0, 0.1)), 1e-9);
  EXPECT_LT(glm::length(secondDerivative(spline, 4.0, -0.1)), 1e-9);
  EXPECT_GT(glm::length(secondDerivative(spline, 2.0, 0.1)), 1.0);  // so that the zero above says something
}

TEST(SplineTest, FirstAndSecondDerivativesAreContinuousAtKeys) {
  const Spline spline(wildKeys());
  for (const double key : {1.0, 2.0, 3.0}) {
    EXPECT_LT(glm::distance(secondDerivative(spline, key, 0.1), secondDerivative(spline, key, -0.1)), 1e-9) << key;
    const double h = 1e-4;
    const glm::dvec3 before =
        (3.0 * position(spline, key) - 4.0 * position(spline, key - h) + position(spline, key - 2 * h)) / (2 * h);
    const glm::dvec3 after =
        (-3.0 * position(spline, key) + 4.0 * position(spline, key + h) - position(spline, key + 2 * h)) / (2 * h);
    EXPECT_LT(glm::distance(before, after), 1e-5) << key;
  }
}

// Keys 0, 1, 0 by hand: tangents 1.5, 0, -1.5, so that y(u) = 1.5 u - 0.5 u^3 on the first half and mirrored on the
// second. The last tangent is where a public implementation has a bracket misplaced.
TEST(SplineTest, ThreeKeysAgreeWithTheSolutionByHand) {
  const Spline spline({keyAt({0, 0, 0}), keyAt({1, 1, 0}), keyAt({2, 0, 0})});
  for (int i = 0; i <= 20; ++i) {
    const double u = i / 20.0, expected = 1.5 * u - 0.5 * u * u * u;
    EXPECT_NEAR(position(spline, u).y, expected, 1e-12);
    EXPECT_NEAR(position(spline, 2.0 - u).y, expected, 1e-12);
    EXPECT_NEAR(position(spline, u).x, u, 1e-12);
  }
}

TEST(SplineTest, ReversedKeysGiveTheReversedPath) {
  const std::vector<KeyFrame> keys = wildKeys();
  const Spline forward(keys), backward({keys.rbegin(), keys.rend()});
  for (int i = 0; i <= 40; ++i)
    EXPECT_LT(glm::distance(position(forward, i / 10.0), position(backward, 4.0 - i / 10.0)), 1e-12);
}

TEST(SplineTest, EquallySpacedKeysOnALineGiveUniformMotion) {
  const Spline two({keyAt({1, 2, 3}), keyAt({3, 2, 1})});
  EXPECT_LT(glm::distance(position(two, 0.25), glm::dvec3(1.5, 2, 2.5)), 1e-14);
  std::vector<KeyFrame> keys;
  for (int i = 0; i < 6; ++i) keys.push_back(keyAt({1e6 + i, -2.0 * i, 0.5 * i}));
  const Spline spline(keys);
  for (int i = 0; i <= 50; ++i) {
    const double t = i / 10.0;
    EXPECT_LT(glm::distance(position(spline, t), glm::dvec3(1e6 + t, -2.0 * t, 0.5 * t)), 1e-9);
  }
}

TEST(SplineTest, DirectionAndUpStayUnitAndPerpendicular) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto any = [&] { return glm::dvec3(normal(random), normal(random), normal(random)); };
  std::vector<KeyFrame> keys;
  for (int i = 0; i < 40; ++i) keys.push_back(keyAt(any(), glm::normalize(any()), glm::normalize(any())));
  // Opposite directions and rolls: the spline passes through zero halfway.
  keys.push_back(keyAt({0, 0, 0}, {1, 0, 0}));
  keys.push_back(keyAt({0, 0, 0}, {-1, 0, 0}, {0, -1, 0}));
  const Spline spline(keys);
  for (int i = 0; i < spline.viewCount(); ++i) {
    const Camera c = spline.view(i);
    ASSERT_NEAR(glm::length(c.direction), 1.0, 1e-12) << i;
    ASSERT_NEAR(glm::length(c.up), 1.0, 1e-12) << i;
    ASSERT_NEAR(glm::dot(c.direction, c.up), 0.0, 1e-9) << i;
  }
  const Spline opposite({keyAt({0, 0, 0}, {1, 0, 0}), keyAt({0, 0, 0}, {-1, 0, 0}, {0, -1, 0})});
  const Camera middle = opposite.at(0.5);
  EXPECT_NEAR(glm::length(middle.direction), 1.0, 1e-12);
  EXPECT_NEAR(glm::length(middle.up), 1.0, 1e-12);
  EXPECT_NEAR(glm::dot(middle.direction, middle.up), 0.0, 1e-12);
  EXPECT_EQ(middle.direction, glm::dvec3(-1, 0, 0));  // the nearest key's, where the spline's is lost
  EXPECT_EQ(middle.up, glm::dvec3(0, -1, 0));
}

// From looking ahead over the zenith to looking back: neither direction nor up may jump.
TEST(SplineTest, LookingOverThePoleDoesNotFlip) {
  const Spline spline({keyAt({0, 0, 0}, {0, 0, -1}, {0, 1, 0}), keyAt({0, 0, 0}, {0, 1, 0}, {0, 0, 1}),
                       keyAt({0, 0, 0}, {0, 0, 1}, {0, -1, 0})});
  for (int i = 1; i < spline.viewCount(); ++i) {
    const Camera a = spline.view(i - 1), b = spline.view(i);
    ASSERT_GT(glm::dot(a.direction, b.direction), 0.999) << i;
    ASSERT_GT(glm::dot(a.up, b.up), 0.999) << i;
  }
}

TEST(SplineTest, FieldOfViewIsInterpolatedAndStaysPossible) {
  std::vector<KeyFrame> keys = {keyAt({0, 0, 0}), keyAt({1, 0, 0})};
  EXPECT_EQ(Spline(keys).view(7).verticalFov, Camera{}.verticalFov);
  keys[0].verticalFov = 0.5;
  keys[1].verticalFov = 1.0;
  EXPECT_NEAR(Spline(keys).at(0.5).verticalFov, 0.75, 1e-12);
  keys = {keyAt({0, 0, 0}), keyAt({1, 0, 0}), keyAt({2, 0, 0}), keyAt({3, 0, 0})};
  for (std::size_t i = 0; i < 4; ++i)
    keys[i].verticalFov = i < 2 ? 0.01 : 3.1;  // overshoots below 0 and above 180 degrees
  const Spline spline(keys);
  for (int i = 0; i < spline.viewCount(); ++i) {
    ASSERT_GT(spline.view(i).verticalFov, 0.0);
    ASSERT_LT(spline.view(i).verticalFov, 3.1416);
  }
}

TEST(SplineTest, ParametersOutsideAreClamped) {
  const Spline spline(wildKeys());
  EXPECT_EQ(position(spline, -1.0), position(spline, 0.0));
  EXPECT_EQ(position(spline, 99.0), position(spline, 4.0));
}

TEST(SplinePlaybackTest, ShowsEveryViewWhenFastAndSkipsWhenSlow) {
  const SplinePlayback playback(601);
  for (int i = 0; i < 601; ++i) ASSERT_EQ(playback.viewAt(i / 60.0), i);
  EXPECT_EQ(playback.viewAt(0.99 / 60.0), 0);
  EXPECT_EQ(playback.viewAt(5.0), 300);  // whatever was shown before: the walk keeps its duration
  EXPECT_EQ(playback.viewAt(-1.0), 0);
}

TEST(SplinePlaybackTest, EndsAfterTheLastView) {
  const SplinePlayback playback(10, 0.5);
  EXPECT_EQ(playback.duration(), 5.0);
  EXPECT_EQ(playback.viewAt(4.99), 9);
  EXPECT_EQ(playback.viewAt(5.0), std::nullopt);
  EXPECT_EQ(playback.viewAt(1e300), std::nullopt);
  EXPECT_EQ(playback.viewAt(std::nan("")), std::nullopt);
}

TEST(KeyFrameFiles, AreRead) {
  const TempFolder folder;
  const auto file = folder.write("walk.txt",
                                 "# a comment\n\n"
                                 "p 1 -2.5 3e1  d 0 0 -2  u 0 3 0  r 1 0 0  f 60 a 1.777\r\n"
                                 "  \t \n"
                                 "u 0 1 0\td 1 1 0 p 4 5 6 # words in any order\n");
  const std::vector<KeyFrame> keys = readKeyFrames(file).camera;
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[0].position, glm::dvec3(1, -2.5, 30));
  EXPECT_EQ(keys[0].direction, glm::dvec3(0, 0, -1));
  EXPECT_EQ(keys[0].up, glm::dvec3(0, 1, 0));
  EXPECT_NEAR(*keys[0].verticalFov, 60.0 * kDegree, 1e-12);
  EXPECT_EQ(keys[1].position, glm::dvec3(4, 5, 6));
  EXPECT_FALSE(keys[1].verticalFov);
  EXPECT_NEAR(glm::dot(keys[1].direction, keys[1].up), 0.0, 1e-12);
}

TEST(KeyFrameFiles, MovesAreReadBesideTheCamera) {
  const TempFolder folder;
  const auto file = folder.write("walk.txt",
                                 "move lantern t -1 p 1 2 3\n"
                                 "p 0 0 0 d 0 0 -1 u 0 1 0\n"
                                 "move \"old lamp\" p 4 5 6 t 0 # words in any order\n"
                                 "p 1 0 0 d 0 0 -1 u 0 1 0\n"
                                 "move lantern t 2.5 p -1 0 1e1\n");
  const KeyFrames keys = readKeyFrames(file);
  EXPECT_EQ(keys.camera.size(), 2u);
  ASSERT_EQ(keys.moves.size(), 2u);
  EXPECT_EQ(keys.moves[0].name, "lantern");
  EXPECT_EQ(keys.moves[0].line, 1);
  EXPECT_EQ(keys.moves[0].times, (std::vector<double>{-1.0, 2.5}));
  EXPECT_EQ(keys.moves[0].offsets, (std::vector<glm::dvec3>{{1, 2, 3}, {-1, 0, 10}}));
  EXPECT_EQ(keys.moves[1].name, "old lamp");
  EXPECT_EQ(keys.moves[1].line, 3);
  EXPECT_TRUE(readKeyFrames(folder.write("carried.txt", "move lantern t 0 p 1 2 3\n")).camera.empty());
}

TEST(KeyFrameFiles, ErrorsNameFileAndLine) {
  const TempFolder folder;
  const std::string good = "p 0 0 0 d 0 0 -1 u 0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"p 0 0 d 0 0 -1 u 0 1 0", "'d' after 'p'"},
      {"p 0 0 0 d 0 0 -1 u 0 1", "end of line"},
      {"p 0 0 nan d 0 0 -1 u 0 1 0", "finite"},
      {"p 0 0 1e999 d 0 0 -1 u 0 1 0", "finite"},
      {"p 0 0 1x d 0 0 -1 u 0 1 0", "'1x'"},
      {"p 0 0 0 d 0 0 0 u 0 1 0", "zero"},
      {"p 0 0 0 d 0 0 -1 u 0 0 0", "zero"},
      {"p 0 0 0 d 0 2 0 u 0 -1 0", "parallel"},
      {"p 0 0 0 d 0 0 -1", "no up"},
      {"d 0 0 -1 u 0 1 0", "no position"},
      {"p 0 0 0 u 0 1 0", "no viewing direction"},
      {"p 0 0 0 d 0 0 -1 u 0 1 0 f 180", "between 0 and 180"},
      {"p 0 0 0 d 0 0 -1 u 0 1 0 f 0", "between 0 and 180"},
      {"q 0 0 0", "unknown word 'q'"},
      {"move", "no name after 'move'"},
      {"move \"a b t 0 p 0 0 0", "closing quote"},
      {"move a t 0 p 0 0", "end of line"},
      {"move a p 0 0 0", "no time"},
      {"move a t 0", "no position"},
      {"move a t 0 p 0 0 0 d 0 0 1", "unknown word 'd'"},
      {"move late t 5 p 0 0 0", "time 5 of 'late', expected one after 5"},
      {"0 0 0", "unknown word '0'"},
  };
  for (const auto& [line, what] : cases) {
    const auto file = folder.write("walk.txt", "move late t 5 p 0 0 0\n# comment\n" + line + "\n" + good);
    const std::string message = badInputMessage([&] { readKeyFrames(file); });
    EXPECT_NE(message.find("walk.txt:3: "), std::string::npos) << line << ": " << message;
    EXPECT_NE(message.find(what), std::string::npos) << line << ": " << message;
  }
  for (const std::string& content : {std::string(), std::string("# nothing\n"), good}) {
    const auto file = folder.write("short.txt", content);
    EXPECT_NE(badInputMessage([&] { readKeyFrames(file); }).find("short.txt: "), std::string::npos);
  }
  EXPECT_NE(badInputMessage([&] { readKeyFrames(folder / "none.txt"); }).find("none.txt: no such file"),
            std::string::npos);
}

}  // namespace
}  // namespace lucerna
