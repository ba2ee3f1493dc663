// The clear sky: the publication's values, how much light it is beside the sun, and its picture.
#include "scene/clear_sky.hpp"

#include "base/angles.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lucerna {
namespace {

using test::badInputMessage;

const glm::dvec3 kLuminance(0.2126, 0.7152, 0.0722);

/// Azimuth 0 is -z, as in the middle of a picture.
glm::dvec3 direction(double zenith, double azimuth) {
  return {std::sin(zenith) * std::sin(azimuth), std::cos(zenith), -std::sin(zenith) * std::cos(azimuth)};
}
DirectionalLight sunAt(double zenith, double azimuth = 0.0, const glm::vec3& irradiance = {10.0f, 9.0f, 8.0f}) {
  return {-direction(zenith, azimuth), irradiance};
}

/// Irradiance of the ground by the picture's upper half.
glm::dvec3 onGround(const Image& picture) {
  glm::dvec3 sum(0.0);
  for (int y = 0; y < picture.height / 2; ++y) {
    const double top = std::cos(kPi * y / picture.height), bottom = std::cos(kPi * (y + 1) / picture.height);
    for (int x = 0; x < picture.width; ++x)
      sum += kPi / picture.width * (top * top - bottom * bottom) * glm::dvec3(picture.at(x, y));
  }
  return sum;
}

// Turbidity, the sun's zenith angle, zenith angle and azimuth from the sun of a direction; luminance over the zenith's
// and chromaticity, computed from the publication's tables by a program of its own, in double.
TEST(ClearSky, DistributionAndColourAreThePublications) {
  const double rows[][7] = {
      {3, 0.6, 0, 0, 1.000000000, 0.250730480, 0.256721040},
      {3, 0.6, 1, 0.5, 1.538688361, 0.266989405, 0.275791725},
      {2, 1.2, 1.4, 3, 4.142530311, 0.276910754, 0.295776790},
      {6, 0.3, 0.9, kPi / 2, 0.506783908, 0.265130188, 0.286946322},
      {10, 1.5, 1.5, 0.1, 3.076444445, 0.473686842, 0.424938503},
      {1.7, 0.9, 0.2, 2, 1.025011104, 0.234323390, 0.236463043},
  };
  for (const auto& [turbidity, sun, zenith, azimuth, luminance, x, y] : rows) {
    const SkyColour colour = skyColour(turbidity, direction(sun, 0.7), direction(zenith, 0.7 + azimuth));
    EXPECT_NEAR(colour.luminance, luminance, 2e-9) << turbidity << " " << sun;
    EXPECT_NEAR(colour.x, x, 2e-9);
    EXPECT_NEAR(colour.y, y, 2e-9);
  }
}

TEST(ClearSky, ColoursAreThoseOfSrgbWithTheirLuminance) {
  const glm::dvec3 white = linearSrgb({2.0, 0.3127, 0.3290}), red = linearSrgb({1.0, 0.64, 0.33}),
                   green = linearSrgb({1.0, 0.30, 0.60}), blue = linearSrgb({1.0, 0.15, 0.06});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 2.0, 1e-3);
  EXPECT_NEAR(red.x, 1.0 / 0.2126, 5e-3);
  EXPECT_NEAR(green.y, 1.0 / 0.7152, 2e-3);
  EXPECT_NEAR(blue.z, 1.0 / 0.0722, 2e-2);
  for (const SkyColour& outside : {SkyColour{1.0, 0.08, 0.5}, SkyColour{1.0, 0.6, 0.4}, SkyColour{1.0, 0.46, 0.49}}) {
    const glm::dvec3 rgb = linearSrgb(outside);
    EXPECT_NEAR(glm::dot(rgb, kLuminance), 1.0, 1e-3);
    EXPECT_NEAR(std::min({rgb.x, rgb.y, rgb.z}), 0.0, 1e-12);
  }
}

// The Illuminating Engineering Society's clear sky (RP-21, 1984), fitted to measurements: sun 127.5 exp(-0.21 m), sky
// 0.8 + 15.5 sqrt(cos zenith), klx. Its extinction is a turbidity of 2.1.
TEST(ClearSky, SunAndSkyAreAboutThoseMeasured) {
  for (const double zenith : {0.0, 20.0, 40.0, 60.0, 75.0, 85.0}) {
    const double cosine = std::cos(zenith * kDegree);
    EXPECT_NEAR(skyIlluminance(2.1, zenith * kDegree) / (0.8 + 15.5 * std::sqrt(cosine)), 1.0, 0.25)
        << zenith;  // 0.83 in the zenith, 1.21 at 75 degrees
    if (zenith <= 75.0) {
      EXPECT_NEAR(sunIlluminance(2.1, zenith * kDegree) / (127.5 * std::exp(-0.21 / cosine)), 1.0, 0.03) << zenith;
    }
  }
}

TEST(ClearSky, NoMoreLightComesDownThanArrives) {
  for (double turbidity = 1.7; turbidity <= 10.0; turbidity += 0.1)
    for (double zenith = 0.0; zenith <= 80.0; zenith += 5.0) {
      const double cosine = std::cos(zenith * kDegree);
      EXPECT_LT(sunIlluminance(turbidity, zenith * kDegree) * cosine + skyIlluminance(turbidity, zenith * kDegree),
                127.5 * cosine)
          << turbidity << " " << zenith;
    }
}

TEST(ClearSky, IrradianceIsToTheSunsAsTheirIlluminances) {
  for (const double turbidity : {2.0, 3.0, 6.0})
    for (const double zenith : {0.0, 0.6, 1.3}) {
      const DirectionalLight sun = sunAt(zenith, 1.0);
      const double expected = glm::dot(glm::dvec3(sun.irradiance), kLuminance) * skyIlluminance(turbidity, zenith) /
                              sunIlluminance(turbidity, zenith);
      const Image picture = clearSkyPicture({turbidity, 0.2}, sun);
      EXPECT_NEAR(glm::dot(onGround(picture), kLuminance), expected, 1e-6 * expected);
      // The picture's texels are the formula's: its integral by a rule of its own, in zenith angle and azimuth.
      glm::dvec3 sum(0.0);
      const int n = 400;
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < 2 * n; ++k) {
          const double t = (i + 0.5) * 0.5 * kPi / n, p = (k + 0.5) * kPi / n;
          sum += std::sin(t) * std::cos(t) * 0.5 * (kPi / n) * (kPi / n) *
                 linearSrgb(skyColour(turbidity, direction(zenith, 1.0), direction(t, p)));
        }
      const glm::dvec3 ratio = onGround(picture) / sum;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(ratio[c] / (expected / glm::dot(sum, kLuminance)), 1.0, 1e-3);
    }
}

TEST(ClearSky, ThePictureIsTheFormulasByDirection) {
  const double zenith = 0.9;
  const Image picture = clearSkyPicture({3.0, 0.0}, sunAt(zenith, -2.0), 64);
  const auto formula = [&](int x, int y) {
    return linearSrgb(
        skyColour(3.0, direction(zenith, -2.0), direction(kPi * (y + 0.5) / 64, 2.0 * kPi * ((x + 0.5) / 128 - 0.5))));
  };
  const double scale = static_cast<double>(picture.at(0, 0).x) / formula(0, 0).x;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 128; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(picture.at(x, y)[c], scale * formula(x, y)[c], 1e-5 * scale * formula(x, y)[c]) << x << " " << y;
}

TEST(ClearSky, IsSymmetricAboutTheSunsMeridianAndTurnsWithIt) {
  const Image ahead = clearSkyPicture({3.0, 0.2}, sunAt(0.8), 32),
              right = clearSkyPicture({3.0, 0.2}, sunAt(0.8, 0.5 * kPi), 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(ahead.at(x, y)[c], ahead.at(63 - x, y)[c], 1e-5f * ahead.at(x, y)[c]);
        ASSERT_NEAR(ahead.at(x, y)[c], right.at((x + 16) % 64, y)[c], 1e-5f * ahead.at(x, y)[c]);
      }
  // It is brightest about the sun, blue away from it.
  EXPECT_GT(ahead.at(32, 8).y, 3.0f * ahead.at(0, 8).y);
  EXPECT_GT(ahead.at(0, 8).z, 2.0f * ahead.at(0, 8).x);
}

TEST(ClearSky, BelowTheHorizonIsTheGroundInItsLight) {
  const DirectionalLight sun = sunAt(0.7);
  const Image picture = clearSkyPicture({3.0, 0.3}, sun, 16), black = clearSkyPicture({3.0, 0.0}, sun, 16);
  const glm::dvec3 expected = 0.3 / kPi * (std::cos(0.7) * glm::dvec3(sun.irradiance) + onGround(picture));
  for (int y = 8; y < 16; ++y)
    for (int x = 0; x < 32; ++x) {
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(picture.at(x, y)[c], expected[c], 1e-5 * expected[c]);
      ASSERT_EQ(black.at(x, y), glm::vec3(0.0f));
    }
}

TEST(ClearSky, IsRadianceForEveryTurbidityAndSunAboveTheHorizon) {
  for (double turbidity = 1.7; turbidity <= 10.0; turbidity += 8.3 / 20)
    for (double zenith = 0.0; zenith <= 90.0; zenith += 2.5) {
      DirectionalLight sun = sunAt(zenith * kDegree, 0.3);
      if (zenith == 90.0) sun.direction.y = 0.0;
      for (const glm::vec3& p : clearSkyPicture({turbidity, 1.0}, sun, 16).pixels)
        for (int c = 0; c < 3; ++c)
          ASSERT_TRUE(std::isfinite(p[c]) && p[c] >= 0.0f) << turbidity << " " << zenith << " " << p[c];
    }
}

TEST(ClearSky, WhatItCannotBeIsRefused) {
  EXPECT_NE(badInputMessage([] { clearSkyPicture({}, sunAt(90.1 * kDegree)); }).find("below the horizon"),
            std::string::npos);
  for (const double turbidity : {1.6, 10.1, std::nan("")})
    EXPECT_NE(badInputMessage([&] {
                clearSkyPicture({turbidity, 0.2}, sunAt(0.0));
              }).find("turbidity"),
              std::string::npos);
  for (const double ground : {-0.1, 1.1, std::nan("")})
    EXPECT_NE(badInputMessage([&] { clearSkyPicture({3.0, ground}, sunAt(0.0)); }).find("albedo"), std::string::npos);
}

}  // namespace
}  // namespace lucerna
