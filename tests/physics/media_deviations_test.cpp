// What each deviation of the published path tracer of participating media costs: the known wrong value with it, the
// right one without. Statistical figures pass within 3.5 of their standard errors; seeds are fixed.
#include "pathtracer/path_tracer.hpp"
#include "support/gl_fixture.hpp"
#include "support/media_scenes.hpp"
#include "support/media_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

using namespace test;

class MediaDeviations : public SharedProgramsTest {
 protected:
  PathTracer::Statistics measure(const Scene& scene, std::uint32_t samples, const PathDeviations& deviations) {
    PathTracer::Settings settings;
    settings.size = {16, 16};
    settings.nextEvent = scene.environment ? false : true;
    settings.deviations = deviations;
    PathTracer tracer(context(), library(), scene, settings);
    tracer.record(samples);
    return tracer.statistics();
  }
  /// Reflectance in red and transmittance in green.
  void expectSlab(const char* what, const PathTracer::Statistics& s, double reflectance, double transmittance,
                  double rounding = 0.0) {
    std::printf("%-34s R %.5f +- %.5f (%.5f)  T %.5f +- %.5f (%.5f)\n", what, s.mean.x, s.meanError.x, reflectance,
                s.mean.y, s.meanError.y, transmittance);
    EXPECT_NEAR(s.mean.x, reflectance, 3.5 * s.meanError.x + rounding) << what;
    EXPECT_NEAR(s.mean.y, transmittance, 3.5 * s.meanError.y + rounding) << what;
    EXPECT_LT(s.meanError.x, 0.0025) << what;
  }
};

TEST_F(MediaDeviations, DistanceWithoutPdf) {
  // Drawn from sigma exp(-sigma t) and weighted by exp(-sigma t) again: a medium without absorption renders as one of
  // twice the extinction that scatters half of it. Slab of tau 1, a = 1, against tau 2, a = 0.5.
  const Scene scene = slab(grey(1.0, 1.0, 0.0), 1.0, 1.0);
  expectSlab("corrected", measure(scene, 256, {}), .341329, .658671);
  expectSlab("distance-without-pdf", measure(scene, 256, {.distanceWithoutPdf = true}), .112833, .189322);
}

TEST_F(MediaDeviations, BoostedInteraction) {
  // An albedo of 0.2 renders as one of 0.5.
  const Scene scene = slab(grey(0.2, 1.0, 0.0), 1.0, 1.0);
  const reference::SlabResult right = reference::walkSlab(0.2, 1.0, 0.0, 1.0, 1.0, 2000000, 1);
  expectSlab("corrected", measure(scene, 256, {}), right.reflectance, right.transmittance,
             3.5 * right.transmittanceError);
  expectSlab("boosted-interaction", measure(scene, 256, {.boostedInteraction = true}), .099119, .446058);
}

TEST_F(MediaDeviations, RouletteWithoutDivision) {
  // Each scattering keeps 0.95 of a path that nothing absorbs: a half-space of albedo 1 renders as one of 0.95
  // [Chandrasekhar1960].
  const Scene scene = slab(grey(1.0, 60.0, 0.0), 1.0, 1.0);
  const auto right = measure(scene, 64, {});
  EXPECT_NEAR(right.mean.x + right.mean.y, 1.0, 1e-5);
  EXPECT_GT(right.mean.x, 0.95);
  expectSlab("roulette-without-division", measure(scene, 256, {.rouletteWithoutDivision = true}), .535540991, 0.0,
             1e-6);
}

TEST_F(MediaDeviations, RouletteAtSurfaces) {
  // Divided, it is unbiased wherever it is played. Undivided it takes a twentieth a turn of the loop, of which a way
  // through a medium is one, however often it scatters: that half-space of albedo 1 gives back 0.95, where roulette at
  // each collision leaves 0.54.
  const Scene thin = slab(grey(.9, 2.0, .75), 1.5, 1.0);
  const auto right = measure(thin, 512, {}), atSurfaces = measure(thin, 512, {.rouletteAtSurfaces = true});
  EXPECT_NEAR(atSurfaces.mean.x, right.mean.x, 3.5 * std::hypot(right.meanError.x, atSurfaces.meanError.x));
  EXPECT_NEAR(atSurfaces.mean.y, right.mean.y, 3.5 * std::hypot(right.meanError.y, atSurfaces.meanError.y));
  const Scene deep = slab(grey(1.0, 60.0, 0.0), 1.0, 1.0);
  const auto kept = measure(deep, 64, {.rouletteWithoutDivision = true, .rouletteAtSurfaces = true});
  std::printf("roulette-at-surfaces: thin slab %.5f, %.5f (%.5f, %.5f), half-space without division %.5f\n",
              atSurfaces.mean.x, atSurfaces.mean.y, right.mean.x, right.mean.y, kept.mean.x + kept.mean.y);
  EXPECT_NEAR(kept.mean.x + kept.mean.y, 0.95, 3.5 * std::sqrt(0.95 * 0.05 / (16 * 16 * 64)));
}

TEST_F(MediaDeviations, UnattenuatedShadowRays) {
  // A diffuse floor under a layer of optical depth 1 that only absorbs, a point light 3 units above: exp(-1) / 9 of the
  // intensity arrives, of which the published test for shadow takes nothing away.
  Scene scene;
  scene.media = {homogeneous(glm::dvec3(0.0), glm::dvec3(1.0), 0.0)};
  addBox(scene, {-5.0, 0.0, -5.0}, {5.0, 1.0, 5.0}, addBoundary(scene, Bsdf::none, 1.0, 0));
  Material floor;
  floor.diffuse = glm::vec3(0.5f);
  scene.materials.push_back(floor);
  addBox(scene, {-1.0, -2.0, -1.0}, {1.0, -1.0, 1.0}, 1);
  PointLight light;
  light.position = {0.0, 2.0, 0.0};
  light.intensity = glm::vec3(1.0f);
  scene.points = {light};
  scene.cameras = {cameraAt({0.3, -0.5, 0.0}, {0.0, -1.0, 0.0})};
  PathTracer::Settings settings;
  settings.bounces = 1;
  for (const bool on : {false, true}) {
    settings.size = {4, 4};
    settings.deviations.unattenuatedShadowRays = on;
    PathTracer tracer(context(), library(), scene, settings);
    tracer.record(4);
    const double value = tracer.statistics().mean.x, exact = std::exp(-1.0) / 9.0 * 0.5 / M_PI;
    std::printf("unattenuated-shadow-rays %s: %.6f, exact %.6f\n", on ? "on " : "off", value, exact);
    EXPECT_NEAR(value, on ? exact * std::exp(1.0) : exact, 1e-5);
  }
}

TEST_F(MediaDeviations, UnscaledRefraction) {
  // A boundary conserves L / n^2: a camera in a ball of n 1.5 sees 2.25 of the 1 around it, and the published sum
  // (equation 5.7) sees 1. Light that only passes through keeps its value either way: the furnace below.
  Scene scene;
  addSphere(scene, glm::dvec3(0.0), 1.0, 3, addBoundary(scene, Bsdf::dielectric, 1.5, -1));
  scene.environment = constantEnvironment(1.0);
  scene.cameras = {cameraAt({0.1, 0.2, 0.0}, {0.0, 0.0, 1.0})};
  EXPECT_NEAR(measure(scene, 16, {}).mean.x, 2.25, 1e-4);
  EXPECT_NEAR(measure(scene, 16, {.unscaledRefraction = true}).mean.x, 1.0, 1e-4);
}

TEST_F(MediaDeviations, FresnelAmplitudesAndSchlick) {
  const Scene scene = slab(grey(.9, 1.0, .75), 1.5, 1.0);
  expectSlab("corrected", measure(scene, 512, {}), .115171, .681242);
  expectSlab("fresnel-amplitudes", measure(scene, 512, {.fresnelAmplitudes = true}), .0684, .7152, 5e-5);
  expectSlab("schlick", measure(scene, 512, {.schlick = true}), .1135, .6880, 5e-5);
}

TEST_F(MediaDeviations, StraightShadowRays) {
  // A diffuse floor one unit below the surface of water, seen from inside, a point light one unit above: exact is
  // 0.319294, a straight line of length 2 gives 1/4, and a line that is no path of light gives nothing.
  Scene scene;
  addBox(scene, {-5.0, -3.0, -5.0}, {5.0, 0.0, 5.0}, addBoundary(scene, Bsdf::dielectric, 1.33, -1));
  Material floor;
  floor.diffuse = glm::vec3(0.5f);
  scene.materials.push_back(floor);
  addBox(scene, {-1.0, -2.0, -1.0}, {1.0, -1.0, 1.0}, 1);
  PointLight light;
  light.position = {0.0, 1.0, 0.0};
  light.intensity = glm::vec3(1.0f);
  scene.points = {light};
  scene.cameras = {cameraAt({0.3, -0.5, 0.0}, {0.0, -1.0, 0.0})};
  PathTracer::Settings settings;
  const double exact = 0.319294 * 0.5 / M_PI, straight = 0.25 * 0.5 / M_PI;
  settings.bounces = 1;
  for (const bool on : {false, true}) {
    settings.size = {4, 4};
    settings.deviations.straightShadowRays = on;
    PathTracer tracer(context(), library(), scene, settings);
    tracer.record(4);
    const double value = tracer.statistics().mean.x;
    std::printf("straight-shadow-rays %s: %.6f, exact %.6f\n", on ? "on " : "off", value, exact);
    EXPECT_NEAR(value, on ? straight : 0.0, 1e-5);
  }
}

TEST_F(MediaDeviations, LinearSeeds) {
  // The number of the pixel is the whole state: the picture of the next seed is this one, a pixel further on.
  const Scene scene = slab(grey(.9, 2.0, .75), 1.0, 1.0);
  const auto row = [&](std::uint32_t seed, bool linear) {
    PathTracer::Settings settings;
    settings.size = {8, 1};
    settings.seed = seed;
    settings.filter = PixelFilter::centre;
    settings.deviations.linearSeeds = linear;
    PathTracer tracer(context(), library(), scene, settings);
    tracer.record(64);
    return tracer.mean();
  };
  const Image a = row(0, true), b = row(1, true), c = row(0, false), d = row(1, false);
  int same = 0;
  for (int x = 0; x < 7; ++x) {
    EXPECT_NEAR(a.at(x + 1, 0).x, b.at(x, 0).x, 0.05f) << x;  // but for what the pixels see
    EXPECT_NEAR(a.at(x + 1, 0).y, b.at(x, 0).y, 0.05f) << x;
    same += std::abs(c.at(x + 1, 0).x - d.at(x, 0).x) < 1e-3f && std::abs(c.at(x + 1, 0).y - d.at(x, 0).y) < 1e-3f;
  }
  EXPECT_LT(same, 3);
}

TEST_F(MediaDeviations, FixedEpsilon) {
  // The same slab two thousand times smaller: rays that enter it start beyond its other side, and end there.
  Scene scene = slab(grey(.9, 2.0, .75), 1.0, 1.0);
  const double scale = 1.0 / 2048.0;
  for (Vertex& v : scene.vertices) v.position *= static_cast<float>(scale);
  for (Mesh& mesh : scene.meshes) mesh.bounds = {scale * mesh.bounds.min, scale * mesh.bounds.max};
  scene.bounds = {scale * scene.bounds.min, scale * scene.bounds.max};
  scene.media[0].scattering /= static_cast<float>(scale);
  scene.media[0].absorption /= static_cast<float>(scale);
  for (Camera& camera : scene.cameras) camera.position *= scale;
  expectSlab("corrected, small", measure(scene, 512, {}), .097395, .660958);
  const auto wrong = measure(scene, 64, {.fixedEpsilon = true});
  std::printf("fixed-epsilon R %.5f T %.5f, %g paths leaked\n", wrong.mean.x, wrong.mean.y, wrong.leakedPaths);
  EXPECT_LT(wrong.mean.x, 0.02);
  EXPECT_LT(wrong.mean.y, 0.02);
}

TEST_F(MediaDeviations, TheOriginalIsBiasedOnTheSlabAndTheCorrectedIsNot) {
  // All that --fidelity original turns on, on slabs of known reflectance and transmittance [vandeHulst1980, volume 2,
  // table 35], adding-doubling: more than 3 standard errors off, and far more, while the corrected estimator is
  // within 3.
  const PathDeviations original{true, true, true, true, false, true, true, true, true, true, true};
  const struct {
    double depth, ior, reflectance, transmittance;
  } rows[] = {{2.0, 1.0, .0973946, .6609577}, {1.0, 1.5, .115171, .681242}};
  for (const auto& row : rows) {
    const Scene scene = slab(grey(.9, row.depth, .75), row.ior, 1.0);
    for (const bool isOriginal : {false, true}) {
      const auto s = measure(scene, isOriginal ? 512 : 1024, isOriginal ? original : PathDeviations{});
      const double zR = (s.mean.x - row.reflectance) / s.meanError.x,
                   zT = (s.mean.y - row.transmittance) / s.meanError.y;
      std::printf("n %.1f %-9s R %.5f +- %.5f (%.5f, z %+.1f)  T %.5f +- %.5f (%.5f, z %+.1f)\n", row.ior,
                  isOriginal ? "original" : "corrected", s.mean.x, s.meanError.x, row.reflectance, zR, s.mean.y,
                  s.meanError.y, row.transmittance, zT);
      if (isOriginal) {
        EXPECT_GT(std::abs(zR), 3.0);
        EXPECT_GT(std::abs(zT), 3.0);
      } else {
        EXPECT_LT(std::abs(zR), 3.0);
        EXPECT_LT(std::abs(zT), 3.0);
        EXPECT_LT(s.meanError.x, 0.01 * row.reflectance);
      }
    }
  }
}

/// A suite of its own: thirteen programs for few samples each, which Mesa's compiler does not optimize
/// (tests/CMakeLists.txt).
class MediaFurnaceOfDeviations : public MediaDeviations {};

TEST_F(MediaFurnaceOfDeviations, AllOfThemInTheWhiteFurnace) {
  // A ball of n 1.33 full of a medium without absorption, tau 4 across, in an environment of 1: 1 wherever one looks.
  Scene scene;
  scene.media = {homogeneous(glm::dvec3(2.0), glm::dvec3(0.0), 0.6)};
  addSphere(scene, glm::dvec3(0.0), 1.0, 3, addBoundary(scene, Bsdf::dielectric, 1.33, 0));
  scene.environment = constantEnvironment(1.0);
  scene.cameras = {cameraAt({0.0, 0.0, 6.0}, glm::dvec3(0.0), 0.2)};
  const std::pair<const char*, PathDeviations> cases[] = {
      {"corrected", {}},
      {"distance-without-pdf", {.distanceWithoutPdf = true}},
      {"boosted-interaction", {.boostedInteraction = true}},
      {"roulette-without-division", {.rouletteWithoutDivision = true}},
      {"fresnel-amplitudes", {.fresnelAmplitudes = true}},
      {"schlick", {.schlick = true}},
      {"straight-shadow-rays", {.straightShadowRays = true}},
      {"linear-seeds", {.linearSeeds = true}},
      {"fixed-epsilon", {.fixedEpsilon = true}},
      {"roulette-at-surfaces", {.rouletteAtSurfaces = true}},
      {"unattenuated-shadow-rays", {.unattenuatedShadowRays = true}},
      {"unscaled-refraction", {.unscaledRefraction = true}},
      {"all of the original", {true, true, true, true, false, true, true, true, true, true, true}}};
  for (const auto& [name, deviations] : cases) {
    const auto s = measure(scene, 64, deviations);
    std::printf("white furnace, %-28s %.5f +- %.5f\n", name, s.mean.x, s.meanError.x);
    const bool loses = deviations.distanceWithoutPdf || deviations.rouletteWithoutDivision;
    if (loses) {
      EXPECT_LT(s.mean.x, 0.9) << name;
    } else {
      EXPECT_NEAR(s.mean.x, 1.0, 1e-4) << name;  // the others keep energy, which is why a furnace alone proves little
    }
  }
}

}  // namespace
}  // namespace lucerna
