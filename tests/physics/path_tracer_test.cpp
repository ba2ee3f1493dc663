// The path tracer against exact answers. Statistical tests: seeds are fixed; a mean may be 4 standard errors from its
// expectation (two-sided probability 6e-5 a channel).
#include "base/angles.hpp"
#include "scene/texture_mean.hpp"
#include "support/path_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna::test {
namespace {

constexpr double kSignificant = 4.0;

class PathFurnaceTest : public PathTest {
 protected:
  /// Largest difference of a pixel from `value`.
  static double farthest(const PathTracer& tracer, double value) {
    double worst = 0.0;
    for (const glm::vec3& p : tracer.mean().pixels)
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(p[c] - value));
    return worst;
  }
  const Camera view_ = lookingAt({2.0, 1.6, 4.0}, {0.0, 0.0, 0.0}, 0.8);
};

TEST_F(PathFurnaceTest, WhatReflectsEverythingCannotBeSeen) {
  SceneBuilder builder = inEnvironment(1.0f);
  const int white = builder.material(glm::vec3(1.0f));
  addBox(builder, 0.7, white);
  builder.plate({0, -0.7, 0}, {0, 0, 6}, {6, 0, 0}, white);  // light goes to and fro between box and floor
  EXPECT_LT(farthest(tracer(builder.scene(), view_, 24, 8), 1.0), 2e-6);
}

TEST_F(PathFurnaceTest, MirrorsAndGlassCannotBeSeenEither) {
  for (const Bsdf bsdf : {Bsdf::mirror, Bsdf::dielectric, Bsdf::none}) {
    SceneBuilder builder = inEnvironment(1.0f);
    const int material = builder.material(glm::vec3(1.0f)), white = builder.material(glm::vec3(1.0f));
    builder.materialAt(material).bsdf = bsdf;
    builder.materialAt(material).specular = glm::vec3(1.0f);
    addBox(builder, 0.7, material);
    addBox(builder, 0.3, white, false, {0, -1.1, 0});
    EXPECT_LT(farthest(tracer(builder.scene(), view_, 24, 8), 1.0), 2e-6) << static_cast<int>(bsdf);
  }
}

TEST_F(PathFurnaceTest, APictureOfOneRadianceIsTheSameAsAConstant) {
  SceneBuilder builder = inEnvironment(0.5f);
  builder.scene().environment->picture = Image(16, 8, glm::vec3(2.0f));
  addBox(builder, 0.7, builder.material(glm::vec3(1.0f)));
  const PathTracer result = tracer(builder.scene(), view_, 24, 64);
  EXPECT_LT(deviations(result.statistics(), glm::dvec3(1.0)), kSignificant);
  EXPECT_GT(result.statistics().meanError.x, 0.0);
  EXPECT_LT(result.statistics().meanError.x, 2e-3);
}

// All walls shine alike: L = emission / (1 - albedo), with at most n scatterings emission (1 - albedo^(n + 1)) / (1 -
// albedo).
TEST_F(PathFurnaceTest, ClosedRoomThatShines) {
  SceneBuilder builder;
  builder.scene().sun.reset();
  const int wall = builder.material({0.8f, 0.5f, 0.0f});
  builder.materialAt(wall).emission = glm::vec3(1.0f, 2.0f, 3.0f);
  addBox(builder, 1.0, wall, true);
  const Camera inside = lookingAt({0.2, 0.1, 0.3}, {1.0, 0.7, -0.9}, 1.0);
  for (const bool nextEvent : {true, false})
    for (const std::uint32_t bounces : {PathTracer::kUnlimited, 0u, 3u}) {
      PathTracer::Settings settings = sized(32);
      settings.nextEvent = nextEvent;
      settings.bounces = bounces;
      const auto expected = [&](double albedo, double emission) {
        return emission * (bounces == PathTracer::kUnlimited ? 1.0 : 1.0 - std::pow(albedo, bounces + 1.0)) /
               (1.0 - albedo);
      };
      const PathTracer::Statistics result = tracer(builder.scene(), inside, settings, 32).statistics();
      EXPECT_LT(deviations(result, glm::dvec3(expected(0.8f, 1.0), expected(0.5, 2.0), 3.0)), kSignificant)
          << nextEvent << " " << bounces;
      EXPECT_LT(result.meanError.x, 0.05);
    }
}

class PathDirectTest : public PathTest {
 protected:
  /// The floor y = 0 about the origin, seen from above by one pixel of hardly any width.
  SceneBuilder floor(float albedo = 0.5f) {
    SceneBuilder builder;
    builder.scene().sun.reset();
    builder.plate({0, 0, 0}, {0, 0, 20}, {20, 0, 0}, builder.material(glm::vec3(albedo)));
    return builder;
  }
  PathTracer::Statistics seen(const Scene& scene, std::uint32_t samples = 4, PathTracer::Settings settings = sized(1)) {
    return tracer(scene, lookingAt({3.0, 4.0, 1.0}, {0, 0, 0}, 1e-5), settings, samples).statistics();
  }
  /// Irradiance at the origin, normal +y, from a rectangle of exitance pi * `radiance`, both sides, by midpoints in
  /// double.
  static double irradiance(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, double radiance) {
    constexpr int kSteps = 400;
    const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
    const double area = glm::length(glm::cross(u, v)) / (kSteps * kSteps);
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const glm::dvec3 p = centre + ((i + 0.5) / kSteps - 0.5) * u + ((j + 0.5) / kSteps - 0.5) * v;
        const double d2 = glm::dot(p, p);
        sum += std::max(p.y, 0.0) * std::abs(glm::dot(normal, p)) / (d2 * d2);
      }
    return radiance * sum * area;
  }
};

TEST_F(PathDirectTest, LampsOfOneDirectionAreExact) {
  SceneBuilder sun = floor();
  sun.sun({0.3, -0.8, 0.2}, {1.0f, 2.0f, 3.0f});
  const double cosine = 0.8 / std::sqrt(0.09 + 0.64 + 0.04);
  EXPECT_NEAR(seen(sun.scene()).mean.y, 0.5 / kPi * 2.0 * cosine, 1e-6);

  SceneBuilder point = floor();
  point.scene().points.push_back({{1.0, 2.0, -0.5}, {7.0f, 8.0f, 9.0f}});
  const double d2 = 1.0 + 4.0 + 0.25;
  EXPECT_NEAR(seen(point.scene()).mean.z, 0.5 / kPi * 9.0 * 2.0 / (d2 * std::sqrt(d2)), 1e-6);

  SceneBuilder spot = floor();
  spot.scene().spots.push_back(
      {{0.0, 2.0, 0.0}, glm::normalize(glm::dvec3(std::tan(0.25), -1.0, 0.0)), glm::vec3(4.0f), 0.2, 0.4});
  const double t = (std::cos(0.25) - std::cos(0.4)) / (std::cos(0.2) - std::cos(0.4));
  EXPECT_NEAR(seen(spot.scene()).mean.x, 0.5 / kPi * 4.0 / 4.0 * t * t * (3.0 - 2.0 * t), 1e-5);

  // All three: one is asked at a time, so it becomes a mean.
  SceneBuilder all = floor();
  all.scene().sun = sun.scene().sun;
  all.scene().points = point.scene().points;
  all.scene().spots = spot.scene().spots;
  const PathTracer::Statistics result = seen(all.scene(), 4000);
  const double expected = 0.5 / kPi * (2.0 * cosine + 8.0 * 2.0 / (d2 * std::sqrt(d2)) + t * t * (3.0 - 2.0 * t));
  EXPECT_LT(std::abs(result.mean.y - expected) / result.meanError.y, kSignificant);
}

TEST_F(PathDirectTest, ARectangleOfLight) {
  for (const bool nextEvent : {true, false}) {
    SceneBuilder builder = floor();
    const int lamp = builder.material(glm::vec3(0.0f));
    builder.materialAt(lamp).emission = {1.0f, 2.0f, 4.0f};
    const glm::dvec3 centre(0.4, 1.0, -0.2), u(1.2, 0.3, 0.0), v(0.0, 0.2, 0.9);
    builder.plate(centre, u, v, lamp);
    PathTracer::Settings settings = sized(1);
    settings.nextEvent = nextEvent;
    settings.size = {16, 16};
    const PathTracer::Statistics result = seen(builder.scene(), nextEvent ? 64 : 256, settings);
    const double expected = 0.5 / kPi * irradiance(centre, u, v, 1.0);
    EXPECT_LT(deviations(result, expected * glm::dvec3(1, 2, 4)), kSignificant) << nextEvent;
    EXPECT_LT(result.meanError.x, 0.01 * expected);
  }
}

// A lamp of 4 by 2 texels of different colours, one triangle of it far brighter than the other. Its light is read
// bilinearly, repeated.
TEST_F(PathDirectTest, ALampThatShinesByAPicture) {
  const glm::dvec3 centre(0.4, 1.0, -0.2), u(1.2, 0.3, 0.0), v(0.0, 0.2, 0.9);
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < 8; ++i)
    rgba.insert(rgba.end(), {static_cast<std::uint8_t>(i < 3 ? 255 : 20 * i), static_cast<std::uint8_t>(30 * (i % 3)),
                             i == 5 ? std::uint8_t{200} : std::uint8_t{0}, 255});
  const auto texel = [&](int x, int y, int c) {  // rows from the bottom, repeated
    return static_cast<double>(linearFromSrgb(
        static_cast<float>(rgba[static_cast<std::size_t>(4 * ((1 - (y & 1)) * 4 + (x & 3)) + c)]) / 255.0f));
  };
  const auto radiance = [&](double s, double t, int c) {
    const double px = 4.0 * s - 0.5, py = 2.0 * t - 0.5, x0 = std::floor(px), y0 = std::floor(py);
    const int x = static_cast<int>(x0), y = static_cast<int>(y0);
    const double low = texel(x, y, c) + (px - x0) * (texel(x + 1, y, c) - texel(x, y, c));
    const double high = texel(x, y + 1, c) + (px - x0) * (texel(x + 1, y + 1, c) - texel(x, y + 1, c));
    return low + (py - y0) * (high - low);
  };
  constexpr int kSteps = 400;
  const glm::dvec3 normal = glm::normalize(glm::cross(u, v)), scale(1.0, 2.0, 4.0);
  glm::dvec3 expected(0.0);
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double s = (i + 0.5) / kSteps, t = (j + 0.5) / kSteps;
      const glm::dvec3 p = centre + (s - 0.5) * u + (t - 0.5) * v;
      const double d2 = glm::dot(p, p);
      for (int c = 0; c < 3; ++c)
        expected[c] += 0.5 / kPi * scale[c] * radiance(s, t, c) * p.y * std::abs(glm::dot(normal, p)) / (d2 * d2) *
                       glm::length(glm::cross(u, v)) / (kSteps * kSteps);
    }
  PathTracer::Statistics both[2];
  for (const bool nextEvent : {true, false}) {
    SceneBuilder builder = floor();
    const int lamp = builder.material(glm::vec3(0.0f)), picture = builder.texture(4, 2, rgba);
    builder.materialAt(lamp).emissionTexture = picture;
    builder.materialAt(lamp).emissionScale = scale;
    builder.materialAt(lamp).emission =
        glm::vec3(scale) * glm::vec3(meanColour(builder.scene().textures[static_cast<std::size_t>(picture)].bitmap));
    builder.plate(centre, u, v, lamp);
    PathTracer::Settings settings = sized(16);
    settings.nextEvent = nextEvent;
    both[nextEvent] = seen(builder.scene(), nextEvent ? 256 : 512, settings);
    EXPECT_LT(deviations(both[nextEvent], expected), kSignificant) << nextEvent;
    EXPECT_LT(both[nextEvent].meanError.x, 0.01 * expected.x);
    std::printf("a lamp by a picture, %s: %.5f %.5f %.5f +- %.5f of %.5f %.5f %.5f\n", nextEvent ? "asked" : "found",
                both[nextEvent].mean.x, both[nextEvent].mean.y, both[nextEvent].mean.z, both[nextEvent].meanError.x,
                expected.x, expected.y, expected.z);
  }
  EXPECT_LT(deviations(both[0], both[1]), kSignificant);
}

TEST_F(PathDirectTest, AnEnvironmentWithABrightSpot) {
  SceneBuilder builder = floor();
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  environment.picture = Image(32, 16, glm::vec3(0.2f, 0.0f, 0.1f));
  environment.picture->at(5, 3) = {200.0f, 100.0f, 50.0f};
  environment.rotation = 1.1;
  builder.scene().environment = environment;
  double sum[3] = {};
  for (int y = 0; y < 8; ++y) {  // the upper half; irradiance of a row by the integral of cos over its solid angle
    const double top = std::cos(kPi * y / 16), bottom = std::cos(kPi * (y + 1) / 16);
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c)
        sum[c] += environment.picture->at(x, y)[c] * (2.0 * kPi / 32) * 0.5 * (top * top - bottom * bottom);
  }
  for (const bool nextEvent : {true, false}) {
    PathTracer::Settings settings = sized(32);
    settings.nextEvent = nextEvent;
    const PathTracer::Statistics result = seen(builder.scene(), nextEvent ? 32 : 128, settings);
    EXPECT_LT(deviations(result, 0.5 / kPi * glm::dvec3(sum[0], sum[1], sum[2])), kSignificant) << nextEvent;
    EXPECT_LT(result.meanError.x / result.mean.x, nextEvent ? 0.01 : 0.05);
  }
}

TEST_F(PathDirectTest, TheEnvironmentIsTurnedAsItSays) {
  // A picture of one bright texel at u = 0.75 (direction +x), turned by a quarter about +y: +x goes to -z.
  SceneBuilder builder = floor();
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  environment.picture = Image(8, 4, glm::vec3(0.0f));
  environment.picture->at(6, 1) = glm::vec3(1.0f);
  environment.picture->at(5, 1) = glm::vec3(1.0f);
  environment.rotation = 0.5 * kPi;
  builder.scene().environment = environment;
  const Camera up = lookingAt({0, 1, 0}, {0.0, 1.4, -1.0}, 0.1), side = lookingAt({0, 1, 0}, {1.0, 1.4, 0.0}, 0.1);
  EXPECT_NEAR(tracer(builder.scene(), up, 4, 1).statistics().mean.x, 1.0, 1e-6);
  EXPECT_NEAR(tracer(builder.scene(), side, 4, 1).statistics().mean.x, 0.0, 1e-6);
}

// Sunlight along -x falls on a wall; the floor gets none of it but what the wall reflects, E albedo times the form
// factor.
TEST_F(PathDirectTest, OneBounceWithAndWithoutOcclusion) {
  const auto make = [&](bool screen) {
    SceneBuilder builder = floor(0.5f);
    builder.sun({-1.0, 0.0, 0.0}, glm::vec3(3.0f));
    builder.plate({-1.5, 1.0, 0.0}, {0, 2, 0}, {0, 0, 2}, builder.material(glm::vec3(0.6f)));
    if (screen)
      builder.plate({-0.7, 0.5, 0.0}, {0, 0, 9}, {0.8, 0, 0},
                    builder.material(glm::vec3(0.9f)));  // along the light: gets none
    return builder;
  };
  const double expected = 0.5 / kPi * irradiance({-1.5, 1.0, 0.0}, {0, 2, 0}, {0, 0, 2}, 3.0 * 0.6f / kPi);
  PathTracer::Settings settings = sized(32);
  const auto result = [&](bool screen, Transport transport) {
    settings.transport = transport;
    SceneBuilder builder = make(screen);
    return seen(builder.scene(), 16, settings);
  };
  for (const bool screen : {false, true}) {
    EXPECT_LT(deviations(result(screen, Transport::oneBounceUnoccluded), glm::dvec3(expected)), kSignificant) << screen;
  }
  EXPECT_LT(deviations(result(false, Transport::oneBounce), glm::dvec3(expected)), kSignificant);
  EXPECT_LT(result(true, Transport::oneBounce).mean.x, 0.9 * expected);
  EXPECT_EQ(result(false, Transport::direct).mean.x, 0.0);
  settings.bounces = 2;
  EXPECT_LT(deviations(result(false, Transport::indirect), glm::dvec3(expected)), kSignificant);
}

}  // namespace
}  // namespace lucerna::test
