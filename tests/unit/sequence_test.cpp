// What sequences of pictures show, by sequences whose lag, ghosts and flicker are known.
#include "measure/sequence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>
#include <vector>

namespace lucerna::measure {
namespace {

constexpr int kMoments = 16, kWidth = 64, kHeight = 8;

/// A bright bar with soft edges that moves by two pixels a moment.
Image bar(double moment) {
  Image image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double d = (x - 8.0 - 2.0 * moment) / 4.0;
      image.at(x, y) = glm::vec3(static_cast<float>(0.2 + std::exp(-d * d)));
    }
  return image;
}

class Sequence : public testing::Test {
 protected:
  Image noisy(Image image, float sigma) {
    std::normal_distribution<float> normal;
    for (glm::vec3& p : image.pixels) p += sigma * glm::vec3(normal(random_), normal(random_), normal(random_));
    return image;
  }
  std::vector<Reference> references(float sigma = 0.0f) {
    std::vector<Reference> result;
    for (int k = 0; k < kMoments; ++k) {
      Reference& r = result.emplace_back();
      r.mean = noisy(bar(k), sigma);
      r.standardError = Image(kWidth, kHeight, glm::vec3(sigma));
    }
    return result;
  }
  template <class Picture>
  static std::vector<Image> pictures(const Picture& picture) {
    std::vector<Image> result;
    for (int k = 0; k < kMoments; ++k) result.push_back(picture(k));
    return result;
  }
  std::mt19937 random_{7};
};

TEST_F(Sequence, RightPicturesHaveNoErrorAndNoLag) {
  for (const float sigma : {0.0f, 0.05f}) {
    const SequenceErrors e = sequenceErrors(pictures(bar), references(sigma));
    EXPECT_LT(e.worst, sigma > 0.0f ? 0.05 : 1e-7);
    EXPECT_NEAR(e.lag, 0.0, 0.051);
    EXPECT_NEAR(e.ghosts, 0.0, 0.03);
    EXPECT_NEAR(e.flicker, 1.0, sigma > 0.0f ? 0.1 : 1e-6);
  }
}

TEST_F(Sequence, ALagIsFoundInMoments) {
  for (const double lag : {-0.5, 0.5, 1.0, 2.0, 3.0})
    for (const float sigma : {0.0f, 0.05f})
      EXPECT_NEAR(sequenceErrors(pictures([&](int k) { return bar(k - lag); }), references(sigma)).lag, lag, 0.11)
          << lag << " " << sigma;
}

TEST_F(Sequence, GhostsAreTheShareOfThePictureBefore) {
  for (const float share : {0.25f, 0.5f, 1.0f})
    for (const float sigma : {0.0f, 0.05f}) {
      const auto ghostly = pictures([&](int k) {
        Image image = bar(k);
        const Image before = bar(k - 1);
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
          image.pixels[i] += share * (before.pixels[i] - image.pixels[i]);
        return image;
      });
      EXPECT_NEAR(sequenceErrors(ghostly, references(sigma)).ghosts, share, 0.03) << sigma;
    }
}

// A lamp that grows dim over a few moments, drawn without the light of further bounces: in each pixel another share.
TEST_F(Sequence, LightThatIsMissingInAllMomentsIsNoLag) {
  const auto lit = [](double moment) {
    Image image = bar(3);
    const auto strength = static_cast<float>(1.0 - 0.9 / (1.0 + std::exp(8.0 - moment)));
    for (glm::vec3& p : image.pixels) p *= strength;
    return image;
  };
  const auto lacking = [&](double moment) {
    Image image = lit(moment);
    for (int x = 0; x < kWidth; ++x)
      for (int y = 0; y < kHeight; ++y) image.at(x, y) *= x % 4 == 0 ? 0.0f : 0.3f + 0.01f * static_cast<float>(x);
    return image;
  };
  for (const float sigma : {0.0f, 0.02f}) {
    std::vector<Reference> right = references(sigma);
    for (int k = 0; k < kMoments; ++k) right[static_cast<std::size_t>(k)].mean = noisy(lit(k), sigma);
    for (const double lag : {0.0, 1.0}) {
      const SequenceErrors e = sequenceErrors(pictures([&](int k) { return lacking(k - lag); }), right);
      EXPECT_GT(e.mean, 0.4);
      EXPECT_NEAR(e.lag, lag, 0.051) << sigma;
      EXPECT_NEAR(e.ghosts, lag, 0.06) << sigma;
    }
  }
}

TEST_F(Sequence, FlickerIsWhatTheReferencesLack) {
  const std::vector<Reference> still = references();
  const double own = sequenceErrors(pictures(bar), still).flicker;
  EXPECT_NEAR(own, 1.0, 1e-6);
  // Brightness by turns 1 + a and 1 - a: second differences of 4 a P.
  const float a = 0.05f;
  const auto blinking = pictures([&](int k) {
    Image image = bar(k);
    for (glm::vec3& p : image.pixels) p *= 1.0f + (k % 2 == 0 ? a : -a);
    return image;
  });
  double own2 = 0.0, all2 = 0.0;
  for (int k = 1; k + 1 < kMoments; ++k)
    for (int x = 0; x < kWidth; ++x) {
      const auto p = [&](int m) { return static_cast<double>(bar(m).at(x, 0).x); };
      const double s = k % 2 == 0 ? a : -a, o = p(k - 1) - 2.0 * p(k) + p(k + 1),
                   d = (1 - s) * p(k - 1) - 2.0 * (1 + s) * p(k) + (1 - s) * p(k + 1);
      own2 += o * o;
      all2 += d * d;
    }
  EXPECT_NEAR(sequenceErrors(blinking, still).flicker, std::sqrt(all2 / own2), 1e-3);
}

TEST_F(Sequence, TwoPicturesHaveErrorsAlone) {
  const std::vector<Reference> all = references();
  const std::vector<Image> both{bar(2), bar(2)};
  const SequenceErrors e = sequenceErrors(both, std::span(all).subspan(2, 2));
  EXPECT_EQ(e.l2[0], 0.0);
  EXPECT_GT(e.l2[1], 0.1);
  EXPECT_TRUE(std::isnan(e.lag) && std::isnan(e.ghosts) && std::isnan(e.flicker));
}

TEST_F(Sequence, WhatDoesNotChangeHasNoLag) {
  std::vector<Reference> same = references();
  for (Reference& r : same) r.mean = bar(3);
  const SequenceErrors e = sequenceErrors(pictures([](int) { return bar(3); }), same);
  EXPECT_TRUE(std::isnan(e.lag) && std::isnan(e.ghosts) && std::isnan(e.flicker));
  EXPECT_EQ(e.worst, 0.0);
}

}  // namespace
}  // namespace lucerna::measure
