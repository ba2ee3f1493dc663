// Where two media or dielectrics touch with faces exactly on each other, and where boundaries cross: one interface of
// the relative index, no leak.
//
// Seeds are fixed; statistical figures pass within 3.5 of their standard errors.
#include "support/media_fixture.hpp"
#include "support/media_scenes.hpp"
#include "support/media_reference.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lucerna {
namespace {

using namespace test;

class MediaInterfaces : public MediaTest {
 protected:
  /// Turns the last mesh's faces over; `otherDiagonal`: and a box's quads are cut along their other diagonals.
  static void turnLast(Scene& scene, bool otherDiagonal) {
    const Mesh& mesh = scene.meshes.back();
    for (std::uint32_t i = mesh.firstIndex; i < mesh.firstIndex + mesh.indexCount; i += 6) {
      std::uint32_t* t = &scene.indices[i];  // 0 1 2, 0 2 3 of a quad
      if (otherDiagonal) {
        const std::uint32_t q[4] = {t[0], t[1], t[2], t[5]};
        const std::uint32_t cut[6] = {q[1], q[0], q[3], q[1], q[3], q[2]};
        std::copy(cut, cut + 6, t);
      } else {
        std::swap(t[1], t[2]);
        std::swap(t[4], t[5]);
      }
    }
    for (std::uint32_t i = mesh.firstIndex; i < mesh.firstIndex + mesh.indexCount; ++i)
      scene.vertices[scene.indices[i]].normal *= -1.0f;
  }
};

TEST_F(MediaInterfaces, MilkThatFillsGlassExactlyIsAWhiteFurnace) {
  for (const bool otherDiagonal : {false, true})
    for (const bool inside : {false, true}) {
      Scene scene;
      scene.media = {homogeneous(glm::dvec3(6.0), glm::dvec3(0.0), 0.3)};
      const int glass = addBoundary(scene, Bsdf::dielectric, 1.5, -1),
                milk = addBoundary(scene, Bsdf::dielectric, 1.33, 0);
      addBox(scene, glm::dvec3(-1.0), glm::dvec3(1.0), glass);
      addBox(scene, {-0.8, -0.7, -0.9}, {0.8, 0.75, 0.9}, glass);
      turnLast(scene, otherDiagonal);  // the wall of the glass's hollow
      addBox(scene, {-0.8, -0.7, -0.9}, {0.8, 0.75, 0.9}, milk);
      scene.environment = constantEnvironment(1.0);
      scene.cameras = {inside ? cameraAt({0.1, 0.2, 0.3}, {1.0, 0.4, -0.3}, 0.9)
                              : cameraAt({2.0, 1.7, 4.0}, glm::dvec3(0.0), 0.5)};
      const double exact = inside ? 1.33 * 1.33 : 1.0;
      const PixelEstimate e = estimate(picture(scene, 128));
      std::printf("milk in glass, %s diagonals, camera %s: %.6f +- %.6f\n", otherDiagonal ? "other" : "the same",
                  inside ? "inside" : "outside", e.energy, e.energyError);
      EXPECT_NEAR(e.energy, exact, 3.5 * e.energyError + 2e-5 * exact);
      EXPECT_LT(e.energyError, 3e-4 * exact);
    }
}

TEST_F(MediaInterfaces, ReflectanceIsThatOfTheRelativeIndex) {
  // Glass of n 1.5 on water of n 1.33, faces on each other. Reflectance of two layers without absorption, all orders of
  // reflection added up without interference: R = r + t^2 r' / (1 - r r'). Were there a gap of air between them, R
  // would be 0.1105 in place of 0.0617 straight on.
  for (const bool otherDiagonal : {false, true})
    for (const double mu : {1.0, 0.3}) {
      Scene scene;
      const int glass = addBoundary(scene, Bsdf::dielectric, 1.5, -1),
                water = addBoundary(scene, Bsdf::dielectric, 1.33, -1);
      addBox(scene, {-30.0, 0.0, -30.0}, {30.0, 0.5, 30.0}, glass);
      addBox(scene, {-30.0, -0.5, -30.0}, {30.0, 0.0, 30.0}, water);
      if (otherDiagonal) {
        turnLast(scene, true);
        turnLast(scene, false);
      }
      scene.environment = halves();
      const glm::dvec3 at(0.013, 0.5, 0.007);
      scene.cameras = {cameraAt(at + 2.0 * glm::dvec3(std::sqrt(1.0 - mu * mu), mu, 0.0), at)};
      const auto cosineIn = [&](double n) { return std::sqrt(1.0 - (1.0 - mu * mu) / (n * n)); };
      const auto both = [](double r, double s) { return r + (1.0 - r) * (1.0 - r) * s / (1.0 - r * s); };
      const double top = reference::fresnel(mu, 1.0 / 1.5), between = reference::fresnel(cosineIn(1.5), 1.5 / 1.33),
                   bottom = reference::fresnel(cosineIn(1.33), 1.33);
      // Layers that absorb nothing add alike from either side.
      const double exact = both(both(top, between), bottom);
      PathTracer::Settings settings;
      settings.nextEvent = false;
      const PixelEstimate e = estimate(picture(scene, 512, settings));
      std::printf("glass on water, mu %.1f: R %.6f +- %.6f (%.6f), R + T %.6f\n", mu, e.mean.x, e.error.x, exact,
                  e.mean.x + e.mean.y);
      EXPECT_NEAR(e.mean.x, exact, 3.5 * e.error.x);
      EXPECT_LT(e.error.x, 0.005 * exact);
      EXPECT_NEAR(e.mean.x + e.mean.y, 1.0, 2e-5);
    }
}

TEST_F(MediaInterfaces, AbsorbersOnEachOtherAndOnTheFloor) {
  // Beer and Lambert through two media that touch, down to a floor that the lower one stands on, and back: by shadow
  // rays and by paths.
  Scene scene;
  scene.media = {homogeneous(glm::dvec3(0.0), {0.5, 1.0, 2.0}, 0.0),
                 homogeneous(glm::dvec3(0.0), {0.2, 0.1, 0.7}, 0.0)};
  addBox(scene, {-3.0, 0.0, -3.0}, {3.0, 0.5, 3.0}, addBoundary(scene, Bsdf::none, 1.0, 0));
  addBox(scene, {-3.0, -0.5, -3.0}, {3.0, 0.0, 3.0}, addBoundary(scene, Bsdf::none, 1.0, 1));
  Material floor;
  floor.diffuse = glm::vec3(0.5f);
  scene.materials.push_back(floor);
  addBox(scene, {-5.0, -1.5, -5.0}, {5.0, -0.5, 5.0}, 2);
  DirectionalLight sun;
  sun.direction = {0.6, -0.8, 0.0};
  sun.irradiance = glm::vec3(1.0f);
  scene.sun = sun;
  for (const bool lamp : {false, true}) {
    Scene lit = scene;
    if (lamp) {
      lit.sun.reset();
      PointLight point;
      point.position = {0.013 - 0.75 * 1.5, 1.0, 0.007};  // at the sun's angle
      point.intensity = glm::vec3(static_cast<float>((1.5 * 1.5) / 0.64));
      lit.points = {point};
    }
    lit.cameras = {cameraAt({0.013, 3.0, 0.007}, {0.013, -0.5, 0.007}, 1e-5)};
    PathTracer::Settings settings;
    settings.bounces = 1;
    const PixelEstimate e = estimate(picture(lit, 256, settings));
    for (int c = 0; c < 3; ++c) {
      const double depth = 0.5 * (lit.media[0].absorption[c] + lit.media[1].absorption[c]);
      const double exact = 0.5 / M_PI * 0.8 * std::exp(-depth * (1.0 + 1.0 / 0.8));
      std::printf("floor below two absorbers, %s, channel %d: %.6f +- %.6f (%.6f)\n", lamp ? "lamp" : "sun", c,
                  e.mean[c], e.error[c], exact);
      EXPECT_NEAR(e.mean[c], exact, 2e-6 * exact);  // absorption is a weight, without noise
    }
  }
}

TEST_F(MediaInterfaces, NestedAndOverlappingDielectricsKeepEnergy) {
  // The white furnace to a thousandth: shell of glass, milk in it, a third sphere that crosses both. With grey media,
  // and with media of three colours, where the channels' sum is what each path keeps.
  for (const bool grey : {true, false})
    for (const bool inside : {false, true}) {
      Scene scene;
      scene.media = {homogeneous(grey ? glm::dvec3(2.0) : glm::dvec3(2.0, 9.0, 0.1), glm::dvec3(0.0), 0.6),
                     homogeneous(glm::dvec3(5.0), glm::dvec3(0.0), -0.5)};
      addSphere(scene, glm::dvec3(0.0), 1.0, 3, addBoundary(scene, Bsdf::dielectric, 1.5, -1, 2));
      addSphere(scene, glm::dvec3(0.1, 0.0, 0.0), 0.8, 3, addBoundary(scene, Bsdf::dielectric, 1.33, 0, 3));
      addSphere(scene, glm::dvec3(0.9, 0.1, 0.0), 0.6, 3, addBoundary(scene, Bsdf::dielectric, 2.0, 1, 1));
      scene.cameras = {inside ? cameraAt({0.1, 0.0, 0.0}, {1.0, 0.2, 0.3}, 0.8)
                              : cameraAt({0.2, 0.3, 5.0}, glm::dvec3(0.2, 0.1, 0.0), 0.4)};
      scene.environment = constantEnvironment(1.0);
      const double exact = inside ? 1.33 * 1.33 : 1.0;
      const PixelEstimate e = estimate(picture(scene, 256));
      std::printf("nested, %s, camera %s: %.6f +- %.6f of %.4f\n", grey ? "grey" : "coloured",
                  inside ? "inside" : "outside", e.energy, e.energyError, exact);
      EXPECT_NEAR(e.energy, exact, 3.5 * e.energyError + 2e-5 * exact);
      EXPECT_LT(e.energyError, 2.5e-4 * exact);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(e.mean[c], exact, 3.5 * e.error[c] + 2e-5 * exact) << "channel " << c;
        EXPECT_LT(e.error[c], 1e-2 * exact) << "channel " << c;
      }
    }
}

}  // namespace
}  // namespace lucerna
