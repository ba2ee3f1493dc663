// Coated surfaces (engine/scene/coat.hpp): known answers in the path tracer, and agreement of all techniques.
#include "base/angles.hpp"
#include "support/coat_reference.hpp"
#include "support/path_scenes.hpp"
#include "support/pixel_rays.hpp"
#include "support/small_scenes.hpp"

#include "scene/coat.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna::test {
namespace {

class Coats : public PathTest {
 protected:
  static SceneBuilder floorOf(const glm::dvec3& base, const glm::dvec3& specular, double alpha) {
    SceneBuilder builder;
    const int coated = builder.material(glm::vec3(base));
    builder.materialAt(coated).specular = glm::vec3(specular);
    builder.materialAt(coated).roughness = static_cast<float>(alpha);
    builder.plate({0, 0, 0}, {0, 0, 40}, {40, 0, 0}, coated);
    builder.scene().sun.reset();
    return builder;
  }
  /// A narrow view of the origin from `angle` radians off the normal.
  static Camera at(double angle) {
    return lookingAt({5.0 * std::sin(angle), 5.0 * std::cos(angle), 0}, {0, 0, 0}, 0.02);
  }
};

// In a furnace a white base makes a coated surface white, whatever its coat; a black one leaves the coat's albedo.
TEST_F(Coats, InAWhiteFurnaceWhatTheCoatLetsInComesOut) {
  const glm::dvec3 specular{0.04, 0.3, 0.9};
  for (const double alpha : {0.001, 0.1, 0.4, 1.0})
    for (const double base : {1.0, 0.4, 0.0}) {
      SceneBuilder builder = floorOf(glm::dvec3(base), specular, alpha);
      builder.scene().environment.emplace().radiance = glm::vec3(1.0f);
      const reference::CoatedSurface surface(glm::dvec3(base), specular, alpha);
      for (const double angle : {0.1, 0.9, 1.4}) {
        const PathTracer::Statistics seen = tracer(builder.scene(), at(angle), sized(16), 256).statistics();
        const glm::dvec3 coat = surface.albedo(std::cos(angle)), expected = coat + base * (1.0 - coat);
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(seen.mean[c], expected[c], 4.0 * seen.meanError[c] + 2e-3)
              << "alpha " << alpha << " base " << base << " angle " << angle << " channel " << c;
      }
    }
}

// What arrives from i and leaves to o is what arrives from o and leaves to i.
TEST_F(Coats, AreReciprocal) {
  const double one = 0.3, other = 1.2;
  const auto towards = [](double angle) { return glm::dvec3(std::sin(angle), std::cos(angle), 0.0); };
  const auto bsdf = [&](double from, double to) {
    SceneBuilder builder = floorOf({0.7, 0.4, 0.1}, {0.04, 0.2, 0.8}, 0.3);
    builder.sun(-towards(-from), glm::vec3(1.0f));
    PathTracer::Settings settings = sized(1);
    settings.filter = PixelFilter::centre;
    return glm::dvec3(tracer(builder.scene(), at(to), settings, 1).mean().at(0, 0)) / std::cos(from);
  };
  const glm::dvec3 there = bsdf(one, other), back = bsdf(other, one);
  const glm::dvec3 expected = reference::CoatedSurface({0.7, 0.4, 0.1}, {0.04, 0.2, 0.8}, 0.3)
                                  .bsdf({std::sin(other), 0.0, std::cos(other)}, {-std::sin(one), 0.0, std::cos(one)});
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(there[c], back[c], 1e-5 * back[c]);
    EXPECT_NEAR(there[c], expected[c], 2e-3 * expected[c]);
  }
}

// The image of a lamp in a polished floor has the lamp's radiance times Fresnel's share, found by either strategy.
TEST_F(Coats, ALampHasItsMirrorImage) {
  SceneBuilder builder = floorOf(glm::dvec3(0.0), glm::dvec3(0.04), 0.001);
  const int lamp = builder.material(glm::vec3(0.0f));
  builder.materialAt(lamp).emission = glm::vec3(7.0f);
  const double angle = 0.8;
  builder.plate({-6.0 * std::sin(angle), 6.0 * std::cos(angle), 0.0}, {0, 0, 1}, {1, 0, 0}, lamp);
  PathTracer::Settings settings = sized(8);
  settings.transport = Transport::direct;
  const PathTracer::Statistics seen = tracer(builder.scene(), at(angle), settings, 256).statistics();
  const double expected = 7.0 * (0.04 + 0.96 * std::pow(1.0 - std::cos(angle), 5.0));
  EXPECT_NEAR(seen.mean.x, expected, 4.0 * seen.meanError.x + 2e-3 * expected);
}

// Techniques that take surfaces for Lambertian reflect as much light in all: a closed box of one coated material.
TEST_F(Coats, TheLambertianStandInReflectsAsMuchInAll) {
  Material material;
  material.diffuse = {0.5f, 0.3f, 0.0f};
  material.specular = {0.04f, 0.3f, 0.9f};
  material.roughness = 0.3f;
  const glm::vec3 whole = wholeReflectance(material);
  const reference::CoatedSurface surface(glm::dvec3(material.diffuse), glm::dvec3(material.specular), 0.3);
  for (int c = 0; c < 3; ++c) {
    const double mean = surface.meanAlbedo()[c];
    EXPECT_NEAR(whole[c], mean + (1.0 - mean) * static_cast<double>(material.diffuse[c]), 1e-3);
  }
}

}  // namespace
}  // namespace lucerna::test
