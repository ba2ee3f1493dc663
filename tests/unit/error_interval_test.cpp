// The interval about a picture's error holds the true error as often as it says, when the reference is sampled.
#include "measure/error_interval.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using lucerna::Image;
using lucerna::measure::ErrorInterval;
using lucerna::measure::nrmseInterval;

struct Sampled {
  Image mean, error;
};

/// `samples` of each pixel, lognormal as paths' contributions are, channels of a pixel fully correlated.
Sampled sampled(const Image& exact, int samples, double sigma, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Sampled result{Image(exact.width, exact.height), Image(exact.width, exact.height)};
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < samples; ++k) {
      const double x = std::exp(sigma * normal(random) - 0.5 * sigma * sigma);  // mean 1
      sum += x;
      squares += x * x;
    }
    const double mean = sum / samples, variance = (squares / samples - mean * mean) / (samples - 1);
    result.mean.pixels[i] = glm::vec3(glm::dvec3(exact.pixels[i]) * mean);
    result.error.pixels[i] = glm::vec3(glm::dvec3(exact.pixels[i]) * std::sqrt(std::max(variance, 0.0)));
  }
  return result;
}

Image exactPicture() {
  Image exact(48, 32);
  for (int y = 0; y < exact.height; ++y)
    for (int x = 0; x < exact.width; ++x)
      exact.at(x, y) = glm::vec3(0.2f + 0.02f * static_cast<float>(x), 0.5f, 0.1f + 0.01f * static_cast<float>(y));
  return exact;
}

double nrmse(const Image& a, const Image& b) {
  double squares = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      squares += std::pow(static_cast<double>(a.pixels[i][c]) - b.pixels[i][c], 2.0);
      sum += b.pixels[i][c];
    }
  const double count = 3.0 * static_cast<double>(a.pixels.size());
  return std::sqrt(squares / count) / (sum / count);
}

TEST(ErrorInterval, WithoutNoiseItIsThePlainError) {
  const Image exact = exactPicture(), none(exact.width, exact.height);
  Image image = exact;
  for (glm::vec3& p : image.pixels) p *= 1.1f;
  const ErrorInterval e = nrmseInterval(image, exact, none);
  EXPECT_NEAR(e.value, nrmse(image, exact), 1e-9);
  EXPECT_NEAR(e.low, e.value, 1e-9);
  EXPECT_NEAR(e.high, e.value, 1e-9);
  EXPECT_EQ(nrmseInterval(exact, exact, none).value, 0.0);
}

// 200 sampled references for each of pictures that are off by nothing, by less than the noise and by much more, from 16
// samples a pixel on.
TEST(ErrorInterval, HoldsTheTrueErrorInAtLeast95OfAHundred) {
  const Image exact = exactPicture();
  std::mt19937 random(7);
  for (const double sigma : {0.3, 1.0})
    for (const float off : {0.0f, 0.02f, 0.3f}) {
      Image image = exact;
      for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] *= 1.0f + off * (i % 3 == 0 ? 1.0f : -0.5f);
      const double error = nrmse(image, exact);
      int held = 0;
      double width = 0.0;
      constexpr int kTrials = 200;
      for (int trial = 0; trial < kTrials; ++trial) {
        const Sampled reference = sampled(exact, 16, sigma, random);
        const ErrorInterval e = nrmseInterval(image, reference.mean, reference.error);
        held += e.low <= error && error <= e.high;
        EXPECT_LE(e.low, e.value);
        EXPECT_LE(e.value, e.high);
        width += (e.high - e.low) / kTrials;
      }
      EXPECT_GE(held, 190) << "sigma " << sigma << ", off by " << off << ", exact " << error << ", mean width "
                           << width;
      if (off > 0.1f) { EXPECT_LT(width, sigma * error) << "an interval that holds everything says nothing"; }
    }
}

}  // namespace
