// The gather from a reflective shadow map held against exact answers, by its CPU reference implementation and the
// engine's own sample pattern.
#include "rsm/rsm_gather.hpp"
#include "support/rsm_maps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lucerna {
namespace {

using reference::GatherOptions;
using reference::NearField;
using test::cornerIrradiance;
using test::cornerMap;

const glm::dvec3 kUp(0.0, 0.0, 1.0);

double luminance(const glm::dvec3& c) { return (c.x + c.y + c.z) / 3.0; }

/// Mean and standard error of the estimate over independent shifts of the pattern.
struct Estimate {
  double mean = 0.0, standardError = 0.0;
};
template <class F>
Estimate estimate(int trials, RsmGather::Weight weight, int samples, std::uint32_t seed, F&& value,
                  double exponent = 1.0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < trials; ++i) {
    const glm::dvec2 shift(unit(random), unit(random));
    const double v = value(RsmGather::pattern(samples, weight, shift, exponent));
    sum += v;
    squares += v * v;
  }
  const double mean = sum / trials;
  return {mean, std::sqrt(std::max(squares / trials - mean * mean, 0.0) / (trials - 1))};
}

TEST(RsmGatherForm, PolygonFormFactorsAreExact) {
  // A square parallel to the receiver, on its axis [Howell, configuration factor catalogue B-3]: four corners of a/c x
  // a/c.
  const double a = 0.7, c = 1.3, x = a / c;
  const double corner = 2.0 * x / std::sqrt(1.0 + x * x) * std::atan(x / std::sqrt(1.0 + x * x)) / (2.0 * M_PI);
  const glm::dvec3 square[] = {{a, a, c}, {-a, a, c}, {-a, -a, c}, {a, -a, c}};
  EXPECT_NEAR(reference::polygonFormFactor(square, kUp), 4.0 * corner, 1e-14);
  // Cut by the horizon: a wall through it gives what the wall above it alone gives; below it there is nothing.
  const glm::dvec3 through[] = {{c, -a, -3.0}, {c, a, -3.0}, {c, a, 2.0}, {c, -a, 2.0}},
                   above[] = {{c, -a, 0.0}, {c, a, 0.0}, {c, a, 2.0}, {c, -a, 2.0}};
  EXPECT_NEAR(reference::polygonFormFactor(through, kUp), reference::polygonFormFactor(above, kUp), 1e-14);
  EXPECT_EQ(reference::polygonFormFactor(through, glm::dvec3(-1.0, 0.0, 0.0)), 0.0);
}

TEST(RsmGatherCorner, AllTexelsGiveTheExactAnswerHoweverNear) {
  // Square texels of 0.15625, so that h goes from a hundred-and-fiftieth of a texel to six. The surfels tile the wall:
  // what is left is the midpoint rule's error where a surfel is taken for a point, 1/20 (t/d)^2 for this kernel, d = 2
  // t being the least.
  const reference::RsmMap map = cornerMap({640, 64});
  std::printf("h       h/texel  exact    quad    disc    clamp   none  (over exact)\n");
  for (const double h : {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0}) {
    const auto at = [&](NearField nearField) {
      return luminance(reference::bruteForceIrradiance(map, {h, 0.0, 0.0}, kUp, {2.0, nearField, 0.15625})) /
             cornerIrradiance(h);
    };
    std::printf("%-7g %-8.4f %.4f  %.4f  %.4f  %.4f  %.4f\n", h, h / 0.15625, cornerIrradiance(h), at(NearField::quad),
                at(NearField::disc), at(NearField::clamp), at(NearField::none));
    EXPECT_NEAR(at(NearField::quad), 1.0, 0.015) << h;
    if (h < 0.02) {  // no clamp may drop this to 0: every other bound does, as the texel's centre cannot tell where its
                     // light comes from
      EXPECT_LT(at(NearField::disc), 0.5) << h;
      EXPECT_LT(at(NearField::clamp), 0.5) << h;
      EXPECT_LT(at(NearField::none), 0.5) << h;
    }
    if (h > 0.9) { EXPECT_NEAR(at(NearField::disc), 1.0, 0.01); }
  }
}

TEST(RsmGatherCorner, ElongatedTexelsToo) {
  // The same error, with d from sqrt(2) times the longer edge on.
  for (const glm::ivec2& size : {glm::ivec2(128, 128), glm::ivec2(1024, 64), glm::ivec2(2048, 16)})
    for (const double h : {0.001, 0.1, 1.0})
      EXPECT_NEAR(
          luminance(reference::bruteForceIrradiance(cornerMap(size), {h, 0.0, 0.0}, kUp, {})) / cornerIrradiance(h),
          1.0, 0.03)
          << size.x << " " << h;
}

TEST(RsmGatherCorner, TheSampledEstimateIsTheSum) {
  const reference::RsmMap map = cornerMap({640, 64});
  const GatherOptions options{2.0, NearField::quad};
  for (const double h : {0.001, 0.03, 0.3, 1.0}) {
    const glm::dvec3 x(h, 0.0, 0.0);
    const Estimate e = estimate(100, RsmGather::Weight::unbiased, 16384,
                                11,  // the radius is 1280 texels: 13 samples fall on the nearest one
                                [&](const auto& pattern) {
                                  return luminance(reference::gather(map, pattern, x, kUp, 0.0, options).irradiance);
                                });
    EXPECT_NEAR(e.mean / cornerIrradiance(h), 1.0, 3.0 * e.standardError / cornerIrradiance(h) + 0.015) << h;
    EXPECT_LT(e.standardError / e.mean, 0.05) << h;
  }
}

TEST(RsmGatherWeight, UnbiasedOnRandomScenes) {
  // 3 standard errors: over 40 points a false alarm has a chance of 1 - 0.9973^40 = 10 %, so two may stray, and none
  // beyond 4.5. All of the map: by a wide radius, and by the samples beyond a narrow one.
  const reference::RsmMap map = test::randomMap({48, 36}, 3);
  const RsmGather::Settings usual;
  for (const double exponent : {1.0, usual.exponent()}) {
    const GatherOptions options{exponent > 1.0 ? static_cast<double>(usual.farthest()) : 1.5, NearField::quad, 0.0,
                                exponent > 1.0};
    int strays = 0;
    for (const test::SurfacePoint& p : test::randomPoints(map, 40, 4)) {
      const double exact = luminance(reference::bruteForceIrradiance(map, p.position, p.normal, options));
      const auto value = [&](const auto& pattern) {
        return luminance(reference::gather(map, pattern, p.position, p.normal, 0.7, options).irradiance);
      };
      const Estimate e = estimate(60, RsmGather::Weight::unbiased, 400, 5, value, exponent);
      strays += std::abs(e.mean - exact) > 3.0 * e.standardError + 1e-12 ? 1 : 0;
      EXPECT_LE(std::abs(e.mean - exact), 4.5 * e.standardError + 1e-12);
    }
    EXPECT_LE(strays, 2) << exponent;
  }
}

TEST(RsmGatherWeight, ThePublishedOneHasItsKnownFactors) {
  // A constant integrand over the disc: 2/3. One peaked at the centre, exp(-(r / 0.1 R)^2): 13.3 % after a rescale by
  // 3/2.
  const auto integral = [](RsmGather::Weight weight, auto&& f) {
    double sum = 0.0;
    const auto pattern = RsmGather::pattern(1 << 16, weight);
    for (const glm::vec4& s : pattern)
      sum += static_cast<double>(s.z) * f(std::hypot(static_cast<double>(s.x), static_cast<double>(s.y)));
    return 2.0 * sum / static_cast<double>(pattern.size());  // over pi R^2
  };
  const auto one = [](double) { return 1.0; };
  const auto peak = [](double r) { return std::exp(-100.0 * r * r); };
  EXPECT_NEAR(integral(RsmGather::Weight::unbiased, one), 1.0, 1e-5);
  EXPECT_NEAR(integral(RsmGather::Weight::published, one), 2.0 / 3.0, 1e-5);
  EXPECT_NEAR(integral(RsmGather::Weight::unbiased, peak), 0.01, 1e-6);
  EXPECT_NEAR(1.5 * integral(RsmGather::Weight::published, peak) / integral(RsmGather::Weight::unbiased, peak), 0.133,
              5e-4);
}

TEST(RsmGatherWeight, TheMapsResolutionDoesNotChangeTheLight) {
  const auto mean = [](int n) {
    const reference::RsmMap map = cornerMap({5 * n, n});
    double sum = 0.0;
    for (int i = 0; i < 40; ++i)
      sum += luminance(reference::gather(map, RsmGather::pattern(400, RsmGather::Weight::unbiased),
                                         {0.05 * (i + 1), 0.1 * i, 0.0}, kUp, 0.0, {})
                           .irradiance);
    return sum / 40.0;
  };
  const double reference = mean(256);
  for (const int n : {64, 128, 512}) EXPECT_NEAR(mean(n) / reference, 1.0, 0.05) << n;
}

TEST(RsmGatherWeight, ScaleInvariant) {
  for (const double scale : {0.01, 100.0}) {
    const reference::RsmMap one = test::randomMap({24, 18}, 8), scaled = test::randomMap({24, 18}, 8, scale);
    const auto pattern = RsmGather::pattern(400, RsmGather::Weight::unbiased);
    for (const test::SurfacePoint& p : test::randomPoints(one, 20, 9)) {
      const double expected = luminance(reference::gather(one, pattern, p.position, p.normal, 0.0, {}).irradiance);
      EXPECT_NEAR(luminance(reference::gather(scaled, pattern, scale * p.position, p.normal, 0.0, {}).irradiance),
                  expected, 1e-9 * expected);
    }
  }
}

}  // namespace
}  // namespace lucerna
