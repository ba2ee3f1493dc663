// Light of lamps that no ray finds, by way of water, glass and mirrors, against closed forms and optics in double
// precision (shaders/pathtracer/manifold.comp). Seeds are fixed; a mean may be 4 standard errors from its expectation.
#include "base/angles.hpp"
#include "support/media_fixture.hpp"
#include "support/media_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna::test {
namespace {

/// Unpolarised reflectance where light arrives with a cosine, index 1 before and n behind; the cosine behind.
double fresnel(double cosine, double n, double& behind) {
  behind = std::sqrt(1.0 - (1.0 - cosine * cosine) / (n * n));
  const double s = (cosine - n * behind) / (cosine + n * behind), p = (n * cosine - behind) / (n * cosine + behind);
  return 0.5 * (s * s + p * p);
}

/// Of light from all sides, by the midpoint rule.
double diffuseReflectance(double n) {
  double sum = 0.0, ignored;
  for (int k = 0; k < 1000; ++k) sum += fresnel(std::sqrt((k + 0.5) / 1000.0), n, ignored) / 1000.0;
  return sum;
}

class Manifolds : public MediaTest {
 protected:
  static int addMaterial(Scene& scene, Bsdf bsdf, float albedo) {
    Material material;
    material.bsdf = bsdf;
    material.diffuse = glm::vec3(bsdf == Bsdf::diffuse ? albedo : 0.0f);
    material.specular = glm::vec3(bsdf == Bsdf::mirror ? albedo : 0.0f);
    scene.materials.push_back(material);
    return static_cast<int>(scene.materials.size()) - 1;
  }
  /// A floor of albedo 0.5 whose upper side is y = 0.
  static Scene overFloor() {
    Scene scene;
    addBox(scene, {-20.0, -1.0, -20.0}, {20.0, 0.0, 20.0}, addMaterial(scene, Bsdf::diffuse, 0.5f));
    return scene;
  }
  static DirectionalLight sun(const glm::dvec3& direction) {
    DirectionalLight light;
    light.direction = glm::normalize(direction);
    light.irradiance = glm::vec3(1.0f);
    light.angularDiameter = 0.0;
    return light;
  }
  /// The picture's mean is what is expected, to 4 of its standard errors and `precision`.
  static void expectMean(Scene scene, const Camera& camera, std::uint32_t bounces, std::uint32_t samples,
                         double expected, double precision, PathTracer::Settings settings = {}) {
    scene.cameras = {camera};
    settings.bounces = bounces;
    const PixelEstimate e = estimate(picture(scene, samples, settings));
    std::printf("[ measured ] %.6f +- %.6f, expected %.6f\n", e.mean.y, e.error.y, expected);
    EXPECT_NEAR(e.mean.y, expected, 4.0 * e.error.y + 1e-4 * expected);
    EXPECT_LT(e.error.y, precision * expected);
  }
};

// A lamp at height H above water of depth h lights the floor at a distance rho. With the angles a in air and w in
// water, rho = H tan a + h tan w, and E = I (1 - R) sin a / (rho drho/da).
TEST_F(Manifolds, ALampShinesThroughWater) {
  const double n = 1.33, above = 2.0, depth = 1.0, rho = 0.9;
  double low = 0.0, high = 1.5;
  for (int i = 0; i < 100; ++i) {
    const double a = 0.5 * (low + high), w = std::asin(std::sin(a) / n);
    (above * std::tan(a) + depth * std::tan(w) < rho ? low : high) = a;
  }
  double cosW;
  const double a = low, cosA = std::cos(a), reflectance = fresnel(cosA, n, cosW),
               slope = above / (cosA * cosA) + depth / (cosW * cosW) * cosA / (n * cosW),
               irradiance = 10.0 * (1.0 - reflectance) * std::sin(a) / (rho * slope);
  Scene scene = overFloor();
  addBox(scene, {-8.0, -0.5, -8.0}, {8.0, depth, 8.0}, addBoundary(scene, Bsdf::dielectric, n, -1));
  scene.points = {{{0.9, above + depth, 0.0}, glm::vec3(10.0f)}};
  expectMean(scene, cameraAt({-0.3, 0.5, 0.2}, {0.0, 0.0, 0.0}), 2, 256, 0.5 / kPi * irradiance, 0.01);
  // A lamp with a ball, or an open spot, is the same from afar; a submission of few iterations changes no bit.
  scene.points.front().radius = 0.01;
  expectMean(scene, cameraAt({-0.3, 0.5, 0.2}, {0.0, 0.0, 0.0}), 2, 256, 0.5 / kPi * irradiance, 0.02);
  scene.points.clear();
  scene.spots = {{{0.9, above + depth, 0.0}, {0.0, -1.0, 0.0}, glm::vec3(10.0f), 1.2, 1.3}};
  expectMean(scene, cameraAt({-0.3, 0.5, 0.2}, {0.0, 0.0, 0.0}), 2, 256, 0.5 / kPi * irradiance, 0.01);
}

// A pane lets (1 - R) / (1 + R) of the sun through, over all orders of reflection inside [BornWolf, 7.6]; R being equal
// at both faces.
TEST_F(Manifolds, TheSunShinesThroughAPane) {
  const double n = 1.5, cosine = 0.8;
  double behind;
  const double reflectance = fresnel(cosine, n, behind), passes = 1.0 - reflectance;
  Scene scene = overFloor();
  addBox(scene, {-200.0, 1.0, -200.0}, {200.0, 1.25, 200.0}, addBoundary(scene, Bsdf::dielectric, n, -1));
  scene.sun = sun({0.6, -cosine, 0.0});
  const Camera camera = cameraAt({-0.3, 0.5, 0.2}, {0.0, 0.0, 0.0});
  expectMean(scene, camera, 3, 512, 0.5 / kPi * cosine * passes * passes, 0.01);
  // With two reflections inside as well. Light that the pane's lower face returns to the floor has five
  // scatterings too.
  const double returned = 0.5 * diffuseReflectance(n);
  expectMean(scene, camera, 5, 1024,
             0.5 / kPi * cosine * passes * passes * (1.0 + reflectance * reflectance + returned), 0.01);
}

// The sun in a mirror that stands on the floor: both suns light it.
TEST_F(Manifolds, AMirrorThrowsTheSunOntoTheFloor) {
  Scene scene = overFloor();
  addBox(scene, {1.0, 0.0, -3.0}, {1.5, 3.0, 3.0}, addMaterial(scene, Bsdf::mirror, 0.8f));
  scene.sun = sun({0.6, -0.8, 0.0});
  const Camera camera = cameraAt({-1.0, 0.5, 0.2}, {0.0, 0.0, 0.0});
  expectMean(scene, camera, 2, 256, 0.5 / kPi * 0.8 * 1.8, 0.01);
  // Where none of it comes from the mirror, the floor is as ever.
  expectMean(scene, cameraAt({-4.0, 0.5, 0.2}, {-3.0, 0.0, 0.0}), 2, 16, 0.5 / kPi * 0.8, 1e-5);
}

// A ball of glass under the sun in the zenith, on an axis with it. A ray at a distance b of the axis arrives on the
// floor at rho(b), so E = sum of T^2 b / |rho drho/db| over all b that get there.
TEST_F(Manifolds, ABallOfGlassGathersTheSun) {
  const double n = 1.5, height = 1.2, place = 0.15;
  const auto arrives = [&](double b, double& passes) {
    double cosT;
    const double cosI = std::sqrt(1.0 - b * b), reflectance = fresnel(cosI, n, cosT);
    passes = (1.0 - reflectance) * (1.0 - reflectance);
    const double i = std::acos(cosI), t = std::acos(cosT);
    // Enters at the angle i from the pole, leaves at i + pi - 2 t, in a direction turned by 2 (i - t) to the axis.
    const double out = i + kPi - 2.0 * t, turned = 2.0 * (i - t), x = std::sin(out), y = std::cos(out);
    return x - (height + y) * std::tan(turned);
  };
  double irradiance = 0.0, ignored;
  constexpr int kSteps = 200000;
  for (int k = 0; k < kSteps; ++k) {
    const double b0 = 0.9999 * k / kSteps, b1 = 0.9999 * (k + 1) / kSteps;
    for (const double at : {place, -place}) {
      const double r0 = arrives(b0, ignored) - at;
      double passes;
      const double r1 = arrives(b1, passes) - at;
      if ((r0 < 0.0) != (r1 < 0.0)) irradiance += passes * 0.5 * (b0 + b1) * (b1 - b0) / (place * std::abs(r1 - r0));
    }
  }
  Scene scene = overFloor();
  const std::size_t first = scene.vertices.size();
  addSphere(scene, {0.0, height, 0.0}, 1.0, 5, addBoundary(scene, Bsdf::dielectric, n, -1));
  for (std::size_t v = first; v < scene.vertices.size(); ++v)
    scene.vertices[v].normal =
        glm::vec3(glm::normalize(glm::dvec3(scene.vertices[v].position) - glm::dvec3(0.0, height, 0.0)));
  scene.sun = sun({0.0, -1.0, 0.0});
  scene.cameras = {cameraAt({3.0, 0.5, 0.0}, {place, 0.0, 0.0})};
  PathTracer::Settings settings;
  settings.bounces = 3;
  const PixelEstimate e = estimate(picture(scene, 256, settings));
  std::printf("[ measured ] %.5f +- %.5f, expected %.5f\n", e.mean.y, e.error.y, 0.5 / kPi * irradiance);
  EXPECT_NEAR(e.mean.y / (0.5 / kPi * irradiance), 1.0, 0.03);  // the mesh is no ball
  EXPECT_LT(e.error.y, 0.012 * e.mean.y);
}

// Sunlight that water scatters once, seen along its surface from below: L = p albedo E_w exp(-depth / cos w) (1 -
// exp(-length)), in optical lengths; E_w = E cos a (1 - R) / cos w across the beam.
TEST_F(Manifolds, WaterScattersTheSun) {
  const double n = 1.33, cosA = 0.8, under = 0.5, length = 6.0;
  double cosW;
  const double reflectance = fresnel(cosA, n, cosW), extinction = 0.7, albedo = 0.6;
  Scene scene;
  scene.media = {homogeneous(glm::dvec3(albedo * extinction), glm::dvec3((1.0 - albedo) * extinction), 0.0)};
  addBox(scene, {-20.0, -20.0, -20.0}, {length, 0.0, 20.0}, addBoundary(scene, Bsdf::dielectric, n, 0));
  const int black = addMaterial(scene, Bsdf::diffuse, 0.0f);
  addBox(scene, {length - 0.5, -21.0, -21.0}, {length + 0.5, 1.0, 21.0}, black);
  scene.sun = sun({0.6, -cosA, 0.0});
  const double across = cosA * (1.0 - reflectance) / cosW, radiance = across * albedo / (4.0 * kPi) *
                                                                      std::exp(-extinction * under / cosW) *
                                                                      (1.0 - std::exp(-extinction * (length - 0.5)));
  expectMean(scene, cameraAt({0.0, -under, 0.0}, {1.0, -under, 0.0}), 2, 512, radiance, 0.01);
}

// The light sought waits between submissions: the same bits however short they are.
TEST_F(Manifolds, SubmissionsChangeNoBit) {
  Scene scene = overFloor();
  addBox(scene, {-8.0, 1.0, -8.0}, {8.0, 1.25, 8.0}, addBoundary(scene, Bsdf::dielectric, 1.5, -1));
  scene.sun = sun({0.6, -0.8, 0.0});
  scene.cameras = {cameraAt({-0.3, 0.5, 0.2}, {0.0, 0.0, 0.0}, 0.5)};
  PathTracer::Settings settings;
  const Image whole = picture(scene, 8, settings);
  settings.submissionSeconds = 1e-6;
  EXPECT_TRUE(picture(scene, 8, settings).pixels == whole.pixels);
  settings.rays.sharedStack = true;  // the kernel for GPUs
  EXPECT_TRUE(picture(scene, 8, settings).pixels == whole.pixels);
  settings.rays.sharedStack = false;
  // Inspection names the same light.
  settings.inspectedPixel = glm::ivec2(3, 5);
  settings.size = {16, 16};
  PathTracer tracer(context(), library(), scene, settings);
  tracer.record(8);
  glm::dvec3 sum(0.0);
  for (const PathTracer::InspectedLight& light : tracer.takeInspected()) sum += glm::dvec3(light.radiance) / 8.0;
  EXPECT_NEAR(sum.y, whole.at(3, 15 - 5).y, 1e-5 * sum.y);
}

// Scenes without such lamps, or with nothing that refracts smoothly, have no program for it.
TEST_F(Manifolds, AreLeftOutWhereNothingIsSought) {
  Scene scene = overFloor();
  addBox(scene, {-8.0, 1.0, -8.0}, {8.0, 1.25, 8.0}, addBoundary(scene, Bsdf::dielectric, 1.5, -1));
  scene.environment = constantEnvironment(1.0);
  scene.cameras = {cameraAt({-0.3, 0.5, 0.2}, {0.0, 0.0, 0.0})};
  const auto bytes = [&](const Scene& some) {
    PathTracer::Settings settings;
    settings.size = {16, 16};
    return PathTracer(context(), library(), some, settings).gpuBytes();
  };
  const std::size_t without = bytes(scene);
  scene.sun = sun({0.6, -0.8, 0.0});
  EXPECT_GT(bytes(scene), without + 16 * 16 * 8 * 16);
}

}  // namespace
}  // namespace lucerna::test
