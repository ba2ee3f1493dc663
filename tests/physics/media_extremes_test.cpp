// Extreme media: exact values where there are any, finite and bounded where there are none. Figures pass within 3.5 of
// their standard errors, taken from the spread of pixels, which are independent; seeds are fixed. What takes a minute
// is done where LUCERNA_LONG_TESTS is set.
//
// Others of the kind: tests/physics/media_test.cpp (|g| 0.99, ratios of 1000 between channels, no extinction, n 1.0001,
// bounded submissions), tests/gl/media_functions_test.cpp (functions at the ends of their range),
// tests/gl/ray_caster_test.cpp (slivers, giants, far places).
#include "support/media_fixture.hpp"
#include "support/media_scenes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace lucerna {
namespace {

using namespace test;

class MediaExtremes : public MediaTest {
 protected:
  static void expectExact(const char* what, double value, double error, double exact, double worst) {
    std::printf("%-44s exact %.7g  measured %.7g +- %.2g (%.2f %%)  z %+.2f\n", what, exact, value, error,
                100.0 * error / exact, (value - exact) / error);
    EXPECT_NEAR(value, exact, 3.5 * error) << what;
    EXPECT_LT(error, worst * std::abs(exact)) << what;
  }
};

PathTracer::Settings found() {
  PathTracer::Settings settings;
  settings.nextEvent = false;
  return settings;
}

TEST_F(MediaExtremes, OpticalDepthOfAMillionth) {
  // No collision in a million paths; but light from a lamp is asked for on every flight. Scattered once: the integral
  // along the line of sight.
  for (const double depth : {1e-6, 1e-3}) {
    Scene scene = slab(grey(1.0, depth, 0.0), 1.0, 1.0);
    scene.environment.reset();
    PointLight lamp;
    lamp.position = {20.0, 30.0, 5.0};
    lamp.intensity = glm::vec3(1e9f);
    scene.points = {lamp};
    double exact = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const glm::dvec3 p(0.013, 0.5 - (i + 0.5) / 1000.0, 0.007), to = lamp.position - p;
      const double r = glm::length(to), cosine = to.y / r, in = (i + 0.5) / 1000.0;
      exact += 1e-3 * depth * 1e9 / (r * r) / (4.0 * std::numbers::pi) * std::exp(-depth * in * (1.0 + 1.0 / cosine));
    }
    PathTracer::Settings settings;
    settings.bounces = 1;
    const PixelEstimate e = estimate(picture(scene, 256, settings));
    std::printf("lamp on tau %g: %.7g +- %.1g (%.7g)\n", depth, e.mean.x, e.error.x, exact);
    EXPECT_NEAR(e.mean.x, exact, 3.5 * e.error.x + 1e-4 * exact);  // hardly any noise; places are rounded
  }
}

TEST_F(MediaExtremes, OpticalDepthOfAThousandth) {
  const PixelEstimate e = estimate(picture(slab(grey(1.0, 1e-3, 0.0), 1.0, 1.0), isLong() ? 131072 : 8192, found()));
  expectExact("R tau 1e-3, a 1", e.mean.x, e.error.x, 4.9975038e-4, isLong() ? 0.007 : 0.03);
  EXPECT_NEAR(e.mean.x + e.mean.y, 1.0, 3.5 * 3.0 * e.energyError);  // what scatters is followed now and then
}

TEST_F(MediaExtremes, OpticalDepthsOfAHundredAndAThousand) {
  // 200 and 2000 collisions a path, of which one in 60 or 600 gets through: UT1 = UTU sqrt(3)/4 H(1), UTU = 4/3 / (tau
  // + 2 * 0.7104461).
  const PixelEstimate hundred = estimate(picture(slab(grey(1.0, 100.0, 0.0), 1.0, 1.0), 100, found()));
  expectExact("T tau 100, a 1", hundred.mean.y, hundred.error.y, .016553, 0.06);
  EXPECT_NEAR(hundred.mean.x + hundred.mean.y, 1.0, 1e-5);
  if (isLong()) {
    const PixelEstimate thousand = estimate(picture(slab(grey(1.0, 1000.0, 0.0), 1.0, 1.0), 2048, found()));
    expectExact("T tau 1000, a 1", thousand.mean.y, thousand.error.y, 1.67644315e-3, 0.04);
    EXPECT_NEAR(thousand.mean.x + thousand.mean.y, 1.0,
                3.5 * std::hypot(thousand.error.x, thousand.error.y));  // a path of a million events meets roulette
  } else {
    // 256 paths, of which 0.43 are expected below: more than 4 come once in ten thousand seeds.
    const PixelEstimate thousand = estimate(picture(slab(grey(1.0, 1000.0, 0.0), 1.0, 1.0), 1, found()));
    std::printf("tau 1000: R %.6f T %.6f\n", thousand.mean.x, thousand.mean.y);
    EXPECT_LE(thousand.mean.y, 4.0 / 256.0);
    EXPECT_NEAR(thousand.mean.x + thousand.mean.y, 1.0, 1e-5);
  }
}

TEST_F(MediaExtremes, HardlyAnyAbsorptionBehindGlass) {
  // a 0.99999, g 0.9, n 1.5: thousands of collisions a path, all inside of total reflection.
  const PixelEstimate e = estimate(picture(slab(grey(.99999, 30000.0, .9), 1.5, 1.0), isLong() ? 64 : 1, found()));
  expectExact("R a 0.99999, g 0.9, n 1.5", e.mean.x, e.error.x, .945706, isLong() ? 0.002 : 0.02);
}

TEST_F(MediaExtremes, ALimitOfScatteringsLeavesOutWhatItShould) {
  // Of a half-space of albedo 1 the share H(1) / sqrt(pi n) is not back after n scatterings [Chandrasekhar1960]; for
  // these n by a walk in double.
  const std::pair<std::uint32_t, double> rows[] = {{64, .2005}, {256, .1029}};
  for (const auto& [bounces, share] : rows) {
    PathTracer::Settings settings = found();
    settings.bounces = bounces;
    const PixelEstimate e = estimate(picture(slab(grey(1.0, 1000.0, 0.0), 1.0, 1.0), 512, settings));
    std::printf("not back after %u scatterings: %.5f +- %.5f (%.4f)\n", bounces, 1.0 - e.mean.x, e.error.x, share);
    EXPECT_NEAR(1.0 - e.mean.x, share, 3.5 * e.error.x + 5e-5);
    EXPECT_LT(e.error.x, 0.0015);
    EXPECT_EQ(e.mean.y, 0.0);
  }
}

TEST_F(MediaExtremes, AThousandthOfAnisotropyIsNotTakenForNone) {
  // g 0.001 against g 0 by the same random numbers, as the difference of 2.4e-4 drowns in the noise of either.
  const Image none = picture(slab(grey(.9, 1.0, 0.0), 1.0, 1.0), 2048, found()),
              little = picture(slab(grey(.9, 1.0, .001), 1.0, 1.0), 2048, found());
  Image difference = none;
  for (std::size_t i = 0; i < none.pixels.size(); ++i) difference.pixels[i] = none.pixels[i] - little.pixels[i];
  const PixelEstimate e = estimate(difference);
  expectExact("R(g 0) - R(g 0.001)", e.mean.x, e.error.x, .267410 - .267168, 0.25);
}

TEST_F(MediaExtremes, FarFromTheOriginThePictureIsTheSame) {
  const auto moved = [&](double by) {
    Scene scene = slab(grey(.9, 2.0, .75), 1.5, 0.5);
    const glm::dvec3 shift(by, -by, 2.0 * by);
    for (Vertex& v : scene.vertices) v.position += glm::vec3(shift);
    for (Mesh& mesh : scene.meshes) mesh.bounds = {mesh.bounds.min + shift, mesh.bounds.max + shift};
    scene.bounds = {scene.bounds.min + shift, scene.bounds.max + shift};
    for (Camera& camera : scene.cameras) camera.position += shift;
    return estimate(picture(scene, 256, found()));
  };
  const PixelEstimate here = moved(0.0);
  for (const double by : {16384.0, 1048576.0}) {  // where floats still have the slab's corners
    const PixelEstimate there = moved(by);
    EXPECT_NEAR(there.mean.x, here.mean.x, 3.5 * std::hypot(here.error.x, there.error.x)) << by;
    EXPECT_NEAR(there.mean.y, here.mean.y, 3.5 * std::hypot(here.error.y, there.error.y)) << by;
    EXPECT_LT(there.error.x, 0.01 * here.mean.x);
  }
}

TEST_F(MediaExtremes, ALampExactlyOnABoundary) {
  // On the face of an absorber, above a floor: all of it is in between, or nothing, according to the face.
  Scene scene;
  scene.media = {homogeneous(glm::dvec3(0.0), {1.0, 2.0, 0.0}, 0.0)};
  addBox(scene, {-3.0, -0.5, -3.0}, {3.0, 0.5, 3.0}, addBoundary(scene, Bsdf::none, 1.0, 0));
  Material floor;
  floor.diffuse = glm::vec3(0.5f);
  scene.materials.push_back(floor);
  addBox(scene, {-5.0, -3.0, -5.0}, {5.0, -2.0, 5.0}, 1);
  for (const double y : {0.5, -0.5}) {
    PointLight lamp;
    lamp.position = {0.0, y, 0.0};
    lamp.intensity = glm::vec3(1.0f);
    scene.points = {lamp};
    scene.cameras = {cameraAt({0.4, -1.0, 0.0}, {0.0, -2.0, 0.0}, 1e-5)};
    PathTracer::Settings settings;
    settings.bounces = 1;
    const PixelEstimate e = estimate(picture(scene, 4, settings, 4));
    const double r = y + 2.0;
    for (int c = 0; c < 3; ++c) {
      const double depth = y > 0.0 ? std::array{1.0, 2.0, 0.0}[static_cast<std::size_t>(c)] : 0.0;
      EXPECT_NEAR(e.mean[c], 0.5 / std::numbers::pi / (r * r) * std::exp(-depth), 2e-5) << y << " " << c;
    }
  }
}

}  // namespace
}  // namespace lucerna
