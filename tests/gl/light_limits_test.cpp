// Light at its limits, against closed forms: narrow lamps, lamps in a surface's plane, dense media under the sun, media
// within media, surfaces that are wound the other way. Statistical tests: seeds are fixed; 4 standard errors.
#include "base/angles.hpp"
#include "support/media_scenes.hpp"
#include "support/path_scenes.hpp"

#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace lucerna::test {
namespace {

class LightLimits : public PathTest {
 protected:
  double pathMean(const Scene& scene, std::uint32_t samples, double& error,
                  std::uint32_t bounces = PathTracer::kUnlimited) {
    PathTracer::Settings settings = sized(8);
    settings.bounces = bounces;
    const PathTracer::Statistics s = tracer(scene, scene.cameras.front(), settings, samples).statistics();
    error = s.meanError.x;
    return s.mean.x;
  }
  double picture(const Scene& scene, const std::string& technique, Component component = Component::direct,
                 double longestEdge = 1.0) {
    RenderSettings settings;
    settings.technique = technique;
    settings.component = component;
    settings.size = {8, 8};
    settings.fullFloatTarget = true;
    settings.of<RadiosityView::Settings>().solution.patches.longestEdge = longestEdge;
    settings.of<RadiosityView::Settings>().direct = RadiosityView::Direct::pixels;
    Renderer renderer(context(), library(), scene, settings);
    renderer.renderToTheEnd(scene.cameras.front());
    double sum = 0.0;
    for (const glm::vec3& p : renderer.readRadiance().pixels) sum += static_cast<double>(p.x) / 64.0;
    return sum;
  }
};

/// Irradiance over pi, below the centre, of a rectangle of radiance 1 and sides 2a and 2b [Howell B-3].
double belowRectangle(double a, double b, double height) {
  const double x = a / height, y = b / height, rx = std::sqrt(1.0 + x * x), ry = std::sqrt(1.0 + y * y);
  return 2.0 / kPi * (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry));
}

Scene needleOverFloor(double width, double height) {
  SceneBuilder builder;
  builder.scene().sun.reset();
  builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, builder.material(glm::vec3(0.5f)));
  const int lamp = builder.material(glm::vec3(0.0f));
  builder.materialAt(lamp).emission = glm::vec3(static_cast<float>(1.0 / width));
  const glm::dvec3 along(std::cos(0.3), 0.0, std::sin(0.3)), across(-std::sin(0.3), 0.0, std::cos(0.3));
  builder.plate({0, height, 0}, 2.0 * along, width * across, lamp);
  Camera camera = lookingAt({1e-4, 0.5 * height, 0}, {0, 0, 0}, 1e-3);
  builder.scene().cameras = {camera};
  return builder.scene();
}

TEST_F(LightLimits, ANarrowLampDoesNotShadeItself) {
  for (const double width : {0.1, 1e-3, 1e-4, 1e-6}) {
    const double expected = 0.5 * belowRectangle(1.0, 0.5 * width, 0.2) / width;
    const Scene scene = needleOverFloor(width, 0.2);
    double error = 0.0;
    const double mean = pathMean(scene, 512, error, 1);
    EXPECT_NEAR(mean, expected, 4.0 * error + 1e-4 * expected) << width;
    EXPECT_LT(error, 0.01 * expected);
    EXPECT_NEAR(picture(scene, "radiosity"), expected, 1e-3 * expected) << width;
  }
}

/// A floor at -1 and a ceiling at 0.7 of albedo 0.6; the lamps are added.
Scene underCeiling(const glm::dvec3& lamp, bool spot) {
  SceneBuilder builder;
  builder.scene().sun.reset();
  const int wall = builder.material(glm::vec3(0.6f));
  builder.plate({0, -1, 0}, {0, 0, 4}, {4, 0, 0}, wall);
  builder.plate({0, 0.7, 0}, {4, 0, 0}, {0, 0, 4}, wall);
  if (spot) builder.scene().spots.push_back({lamp, {0, -1, 0}, glm::vec3(1.0f), 1.3, 1.4});
  else builder.scene().points.push_back({lamp, glm::vec3(1.0f)});
  builder.scene().cameras = {lookingAt({0.31, 0.2, 0.1}, {0.3, -1, 0.1}, 1e-3)};
  return builder.scene();
}

TEST_F(LightLimits, ALampInTheCeilingsPlaneLightsTheRoom) {
  const glm::dvec3 lamp(0.1, static_cast<double>(0.7f), 0.2);
  const glm::dvec3 to = lamp - glm::dvec3(0.3, -1.0, 0.1);
  const double expected = 0.6 / kPi * to.y / std::pow(glm::dot(to, to), 1.5);
  for (const bool spot : {false, true}) {
    const Scene scene = underCeiling(lamp, spot);
    double error = 0.0;
    EXPECT_NEAR(pathMean(scene, 32, error, 1), expected, 2e-3 * expected) << spot;
    for (const char* technique : {"direct", "rsm", "irradiance-cache", "radiosity"})
      EXPECT_NEAR(picture(scene, technique), expected, 2e-3 * expected) << technique << spot;
  }
}

TEST_F(LightLimits, AnEmissivePlateInTheCeilingsPlaneEqualsOneBelow) {
  const auto scene = [](double y) {
    Scene room = underCeiling({0.0, 0.0, 0.0}, false);
    room.points.clear();
    SceneBuilder builder;
    builder.scene() = room;
    const int lamp = builder.material(glm::vec3(0.0f));
    builder.materialAt(lamp).emission = glm::vec3(5.0f);
    builder.plate({0.1, y, 0.2}, {0.5, 0, 0}, {0, 0, 0.5}, lamp);
    return builder.scene();
  };
  double error = 0.0, errorBelow = 0.0;
  const double flush = pathMean(scene(0.7), 512, error, 1), below = pathMean(scene(0.69999), 512, errorBelow, 1);
  EXPECT_NEAR(flush, below, 4.0 * (error + errorBelow));
  for (const Component component : {Component::direct, Component::all}) {
    const double under = picture(scene(0.69999), "radiosity", component, 0.5);
    EXPECT_NEAR(picture(scene(0.7), "radiosity", component, 0.5), under, 5e-3 * under) << nameOf(component);
  }
}

TEST_F(LightLimits, ADenseMediumUnderTheSunIsExactAtItsFace) {
  // Scattered once: albedo / (4 pi) mu0 / (mu + mu0); all: times H(mu) H(mu0) [Chandrasekhar1960], for 40 and 25
  // degrees and an albedo of 0.8.
  const double sun = 40.0 * kPi / 180.0, view = 25.0 * kPi / 180.0;
  for (const double halfWidth : {1.0, 10.0})
    for (const bool once : {true, false}) {
      Scene scene;
      addBox(scene, glm::dvec3(-halfWidth, -1, -halfWidth), glm::dvec3(halfWidth, 0, halfWidth),
             addBoundary(scene, Bsdf::none, 1.0, 0));
      scene.media = {grey(0.8, 1e6, 0.0)};
      scene.sun = DirectionalLight{{std::sin(sun), -std::cos(sun), 0.0}, glm::vec3(1.0f)};
      scene.cameras = {lookingAt({-0.3 * std::tan(view), 0.3, 0.0}, {0, 0, 0}, 1e-3)};
      scene.cameras[0].up = {0, 0, 1};
      double error = 0.0;
      const double mean = pathMean(scene, once ? 128 : 2048, error, once ? 1 : PathTracer::kUnlimited),
                   expected = once ? 0.0291613 : 0.0697929;
      EXPECT_NEAR(mean, expected, 4.0 * error + 1e-4 * expected) << halfWidth << once;
      EXPECT_LT(error, 0.01 * expected);
    }
}

/// A closed room with a lamp below its ceiling, each wound so that its front faces inwards and down, or the other way;
/// `lamp`: an emissive plate, else an omnidirectional one.
Scene windings(bool room, bool plate, bool lamp) {
  SceneBuilder builder;
  builder.scene().sun.reset();
  const int wall = builder.material(glm::vec3(0.6f));
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 centre(0.0), u(0.0), v(0.0);
      centre[axis] = side;
      u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2.0;
      const bool in = (side < 0.0) == room;
      builder.plate(centre, in ? u : v, in ? v : u, wall);
    }
  if (lamp) {
    const int light = builder.material(glm::vec3(0.0f));
    builder.materialAt(light).emission = glm::vec3(4.0f);
    const glm::dvec3 u(0.5, 0, 0), v(0, 0, 0.5);
    builder.plate({0, 0.5, 0}, plate ? u : v, plate ? v : u, light);
  } else {
    builder.scene().points.push_back({{0.1, 0.5, 0.0}, glm::vec3(1.0f)});
  }
  builder.scene().cameras = {lookingAt({0.5, 0.2, 0.6}, {-0.3, -1, -0.2}, 0.9)};
  return builder.scene();
}

TEST_F(LightLimits, RadiosityIsThatOfPathsHoweverSurfacesAreWound) {
  for (const bool lamp : {true, false}) {
    double error = 0.0;
    const double expected = pathMean(windings(true, true, lamp), 2048, error);
    EXPECT_LT(error, 0.01 * expected);
    for (const auto& [room, plate] :
         {std::pair{true, true}, std::pair{true, false}, std::pair{false, true}, std::pair{false, false}})
      EXPECT_NEAR(picture(windings(room, plate, lamp), "radiosity", Component::all, 0.3), expected,
                  4.0 * error + 0.01 * expected)
          << lamp << room << plate;
  }
}

}  // namespace
}  // namespace lucerna::test
