// The irradiance cache: irradiance at points of surfaces against exact
// answers and the path tracer, what must not change it, what is kept from frame to frame and what happens when there is
// no room.
//
// Noise: a pixel is filtered from some four records of as many paths as the settings say, so that the pixels'
// standard deviation over the root of a quarter of the records bounds the error of a picture's mean where the picture
// is of one value; kSignificant of these are allowed.
#include "base/angles.hpp"
#include "base/data.hpp"
#include "base/error.hpp"
#include "irradiance_cache/bounce_cache.hpp"
#include "irradiance_cache/emission_points.hpp"
#include "irradiance_cache/irradiance_cache.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "irradiance_cache/settings.hpp"
#include "measure/image_errors.hpp"
#include "pathtracer/path_tracer.hpp"
#include "rays/light_table.hpp"
#include "render/renderer.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "support/faulty_shaders.hpp"
#include "support/form_factor_reference.hpp"
#include "support/largest_difference.hpp"
#include "support/long_tests.hpp"
#include "support/path_scenes.hpp"
#include "support/pixel_rays.hpp"
#include "shared/glyphs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <numbers>
#include <random>
#include <tuple>

namespace lucerna {
namespace {

using test::largestDifference;
using test::lookingAt;
using test::SceneBuilder;

constexpr double kSignificant = 4.0;
constexpr int kAll = IrradianceCacheSettings::kAllBounces;

class IrradianceCacheGl : public test::SharedProgramsTest {
 protected:
  static RenderSettings settings(int bounces, int samples, Component component = Component::all, int size = 64) {
    RenderSettings s;
    s.component = component;
    s.size = glm::ivec2(size);
    s.fullFloatTarget = true;
    s.shadow.size = s.lights.spotSize = s.lights.pointSize = 512;
    s.technique = "irradiance-cache";
    s.of<IrradianceCacheSettings>().cascades.cells = 16;
    s.of<IrradianceCacheSettings>().cascades.cascades = 2;
    s.of<IrradianceCacheSettings>().bounces = bounces;
    s.of<IrradianceCacheSettings>().samples = samples;
    s.of<IrradianceCacheSettings>().fullFloat = true;
    return s;
  }
  struct Picture {
    Image image;
    IrradianceCache::Counts counts;
  };
  static Picture picture(const Scene& scene, const Camera& camera, const RenderSettings& s) {
    Renderer renderer(context(), library(), scene, s);
    renderer.renderToTheEnd(camera);
    renderer.drain();
    EXPECT_EQ(cacheOf(renderer.technique())->counts().waiting, 0u);
    return {renderer.readRadiance(), cacheOf(renderer.technique())->counts()};
  }
  static void report(const std::string& what, double value) {
    std::cout << "[ measured ] " << what << ": " << value << "\n";
  }

  /// Of a picture that ought to show one value: how many standard errors of its mean it is off, in the worst channel.
  static double deviationsFrom(const Picture& seen, const glm::dvec3& expected) {
    const glm::dvec3 mean = meanOf(seen.image);
    double worst = 0.0;
    for (int c = 0; c < 3; ++c) {
      double square = 0.0;
      for (const glm::vec3& p : seen.image.pixels) square += std::pow(static_cast<double>(p[c]) - mean[c], 2.0);
      const double deviation = std::sqrt(square / static_cast<double>(seen.image.pixels.size()));
      const double error = deviation / std::sqrt(0.25 * static_cast<double>(seen.counts.records));
      worst = std::max(worst, std::abs(mean[c] - expected[c]) / std::max(error, 1e-5 * std::abs(expected[c]) + 1e-30));
    }
    return worst;
  }
};

double largestValue(const Image& image) { return largestDifference(image, Image(image.width, image.height)); }

/// sqrt(sum d^2 / sum r^2): a black picture has 1.
double relativeError(const Image& seen, const Image& reference) {
  double difference = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(seen.pixels[i]) - glm::dvec3(reference.pixels[i]), r(reference.pixels[i]);
    difference += glm::dot(d, d);
    scale += glm::dot(r, r);
  }
  return std::sqrt(difference / scale);
}

// ---- exact answers
// -----------------------------------------------------------------------------------------------------

/// A closed room whose walls all shine alike.
Scene furnace(const glm::vec3& albedo, const glm::vec3& emission) {
  SceneBuilder builder;
  builder.scene().sun.reset();
  const int wall = builder.material(albedo);
  builder.materialAt(wall).emission = emission;
  test::addBox(builder, 1.0, wall, true);
  return builder.scene();
}
const Camera kInside = lookingAt({0.2, 0.1, 0.3}, {1.0, 0.7, -0.9}, 1.0);

TEST_F(IrradianceCacheGl, AClosedRoomThatShines) {
  // L = emission (1 + a + ... + a^(N + 1)): seen itself, its light, and that reflected up to N times; emission / (1 -
  // a) with all.
  const Scene scene = furnace({0.8f, 0.5f, 0.0f}, {1.0f, 2.0f, 3.0f});
  for (const int bounces : {1, 2, 5, kAll}) {
    const Picture seen = picture(scene, kInside, settings(bounces, bounces == kAll ? 1024 : 256));
    glm::dvec3 expected;
    const glm::dvec3 albedo(0.8f, 0.5f, 0.0f), emission(1.0, 2.0, 3.0);
    for (int c = 0; c < 3; ++c)
      expected[c] =
          emission[c] * (bounces == kAll ? 1.0 : 1.0 - std::pow(albedo[c], bounces + 2.0)) / (1.0 - albedo[c]);
    const glm::dvec3 mean = meanOf(seen.image);
    report(fmt::format("furnace, bounces {}: red over expected", bounces == kAll ? "all" : std::to_string(bounces)),
           mean.x / expected.x);
    report("green", mean.y / expected.y);
    // Records that give each other light pass their noise on as they do light: up to 1 / (1 - albedo) times.
    const double errors = deviationsFrom(seen, expected) * (bounces == kAll ? 1.0 - albedo.x : 1.0);
    report("standard errors off", errors);
    EXPECT_LT(errors, kSignificant) << bounces;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1.0, 0.01) << bounces << ", channel " << c;
  }
}

TEST_F(IrradianceCacheGl, ARoomThatReflectsNearlyEverythingIsBoundedAndBrightens) {
  constexpr double kAlbedo = 1.0 - 1e-6;
  const Scene scene = furnace(glm::vec3(static_cast<float>(kAlbedo)), glm::vec3(1.0f));
  const auto mean = [&](int bounces, int samples) {
    const Image image = picture(scene, kInside, settings(bounces, samples)).image;
    for (const glm::vec3& p : image.pixels) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
    return meanOf(image).x;
  };
  // emission once for each time that it may be reflected.
  double before = 0.0;
  for (const int bounces : {1, 4, 16}) {
    const double now = mean(bounces, 64);
    EXPECT_NEAR(now / (bounces + 2.0), 1.0, 0.02) << bounces;
    EXPECT_GT(now, before);
    before = now;
  }
  // All: more with every frame that is added, never more than there is.
  double few = mean(kAll, 64), more = mean(kAll, 256), most = mean(kAll, 1024);
  report("all bounces, 64, 256, 1024 paths", few);
  report("", more);
  report("", most);
  EXPECT_GT(more, 1.05 * few);
  EXPECT_GT(most, 1.05 * more);
  EXPECT_LT(most, 1.0 / (1.0 - kAlbedo));
}

/// A floor of albedo 1/2 alone.
SceneBuilder floorAlone() {
  SceneBuilder builder = test::inEnvironment(1.0f);
  builder.plate({0, 0, 0}, {0, 0, 8}, {8, 0, 0}, builder.material(glm::vec3(0.5f)));
  return builder;
}
const Camera kAboveFloor = lookingAt({0, 4, 0}, {0, 0, 0}, 0.6);

TEST_F(IrradianceCacheGl, AFloorUnderAConstantSky) {
  // E = pi L, whatever is drawn: radiance L / 2.
  SceneBuilder builder = floorAlone();
  builder.scene().environment->radiance = {2.0f, 0.5f, 1e-3f};
  for (const Component component : {Component::all, Component::direct}) {
    const Picture seen = picture(builder.scene(), kAboveFloor, settings(1, 16, component));
    EXPECT_GT(seen.counts.records, 16u);
    for (const glm::vec3& p : seen.image.pixels)
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(p[c] / (0.5f * builder.scene().environment->radiance[c]), 1.0f, 1e-5f);
  }
  EXPECT_EQ(largestValue(picture(builder.scene(), kAboveFloor, settings(1, 16, Component::indirect)).image), 0.0);
}

// A driver on which paths do not count would be waited for without end.
TEST_F(IrradianceCacheGl, ThatStillWaitWhenAllPathsAreTracedAreAnError) {
  const test::FaultyShaders shaders;
  shaders.plant("irradiance_cache/paths.comp", "records[index].paths = paths;", "");
  SceneBuilder builder = floorAlone();
  builder.scene().environment->radiance = glm::vec3(1.0f);
  gl::ProgramLibrary broken(shaders.path());
  Renderer renderer(context(), broken, builder.scene(), settings(1, 16));
  try {
    renderer.renderToTheEnd(kAboveFloor);
    ADD_FAILURE() << "it ended";
  } catch (const Error& error) {
    EXPECT_NE(std::string_view(error.what()).find("still lack light"), std::string_view::npos) << error.what();
  }
}

// What found no place among the listed, and is not seen any more, shows nothing and waits for nothing.
TEST_F(IrradianceCacheGl, ThoseWithoutAnyPathThatAreNotSeenDoNotWait) {
  const test::FaultyShaders shaders;
  shaders.plant("irradiance_cache/list.comp", "place >= mostLit", "place >= 100u");
  shaders.plant("irradiance_cache/paths.comp", "uint(lit.length())", "100u");
  SceneBuilder builder = floorAlone();
  builder.scene().environment->radiance = glm::vec3(1.0f);
  gl::ProgramLibrary library(shaders.path());
  Renderer renderer(context(), library, builder.scene(), settings(1, 16));
  renderer.render(kAboveFloor);
  renderer.drain();
  EXPECT_GT(cacheOf(renderer.technique())->counts().records, 100u);
  EXPECT_GT(cacheOf(renderer.technique())->counts().waiting, 0u);
  renderer.renderToTheEnd(lookingAt({0, 8, 0.1}, {0, 20, 0}, 0.9));  // nothing but the sky
  EXPECT_EQ(cacheOf(renderer.technique())->counts().waiting, 0u);
}

TEST_F(IrradianceCacheGl, AFloorUnderAPictureOfTheSky) {
  // Rows of radiance 8, 2, 1, 1/2 above the horizon, of equal height each: E = sum of L pi (sin^2 of the angle to the
  // zenith, from border to border). And in one column of eight a lamp ten times as bright.
  SceneBuilder builder = floorAlone();
  Image sky(8, 8, glm::vec3(100.0f));  // below the horizon nothing counts
  const float rows[] = {8.0f, 2.0f, 1.0f, 0.5f};
  double expected = 0.0;
  for (int y = 0; y < 4; ++y) {
    const double share = std::pow(std::sin(kPi * (y + 1) / 8.0), 2.0) - std::pow(std::sin(kPi * y / 8.0), 2.0);
    for (int x = 0; x < 8; ++x) {
      const float value = x == 3 ? 10.0f * rows[y] : rows[y];
      sky.at(x, y) = glm::vec3(value, 1.0f, 0.0f);
      expected += static_cast<double>(value) / 8.0 * kPi * share;
    }
  }
  builder.scene().environment->radiance = glm::vec3(0.5f);
  builder.scene().environment->picture = sky;
  const Picture seen = picture(builder.scene(), kAboveFloor, settings(1, 1024));
  report("sky's picture: standard errors off", deviationsFrom(seen, {0.25 * expected / kPi, 0.25, 0.0}));
  EXPECT_LT(deviationsFrom(seen, {0.25 * expected / kPi, 0.25, 0.0}), kSignificant);
  EXPECT_NEAR(meanOf(seen.image).x / (0.25 * expected / kPi), 1.0, 0.005);
}

/// A lit plate in the plane y = 0 and a wall that rises from its edge, in the plane x = 0; albedos 0.8 and 0.5.
struct FloorAndWall {
  SceneBuilder builder;
  Camera camera = lookingAt({3.5, 1.2, 0.3}, {0.0, 0.9, 0.0}, 0.5);  // the wall alone fills the view
  FloorAndWall() {
    builder.scene().sun.reset();
    builder.plate({1.0, 0.0, 0.0}, {0, 0, 2}, {2, 0, 0}, builder.material(glm::vec3(0.8f)));
    builder.plate({0.0, 1.5, 0.0}, {0, 3, 0}, {0, 0, 4}, builder.material(glm::vec3(0.5f)));
  }
  /// Cells fine enough for what is interpolated between records to be well below what is allowed.
  static RenderSettings fine(RenderSettings s) {
    s.of<IrradianceCacheSettings>().cascades.cells = 40;
    return s;
  }
  /// Over the floor, by midpoints in double: of what a point there gives, at d from `from`, per area.
  static double integral(const glm::dvec3& from, const std::function<double(const glm::dvec3& d, double d2)>& given) {
    constexpr int kSteps = 120;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const glm::dvec3 d = glm::dvec3((i + 0.5) * 2.0 / kSteps, 0.0, (j + 0.5) * 2.0 / kSteps - 1.0) - from;
        sum += given(d, glm::dot(d, d));
      }
    return sum * 4.0 / (kSteps * kSteps);
  }
  /// Radiance of the floor under a spot at (1, height, 0) of intensity 9 that points downwards.
  static std::function<double(double, double)> underSpot(double height, double inner, double outer) {
    return [=](double x, double z) {
      const double d2 = (x - 1.0) * (x - 1.0) + height * height + z * z, cosine = height / std::sqrt(d2);
      const double t = std::clamp((cosine - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.0, 1.0);
      return 0.8 / kPi * 9.0 * t * t * (3.0 - 2.0 * t) * cosine / d2;
    };
  }
  /// Irradiance of a point of the wall from a floor of `radiance(x, z)`.
  static double irradiance(const glm::dvec3& p, const std::function<double(double, double)>& radiance) {
    return integral(
        p, [&](const glm::dvec3& d, double d2) { return radiance(p.x + d.x, p.z + d.z) * d.x * -d.y / (d2 * d2); });
  }
  /// The picture's pixels that show the wall at least 0.1 above the plate, beside what is expected there.
  void expect(const Image& seen, const std::function<double(const glm::dvec3&)>& irradianceAt, const char* what,
              double mostError = 0.06) const {
    Image expected(seen.width, seen.height), shown(seen.width, seen.height);
    double sum = 0.0, expectedSum = 0.0;
    int count = 0;
    for (int y = 0; y < seen.height; ++y)
      for (int x = 0; x < seen.width; ++x) {
        const glm::dvec3 ray = test::pixelRay(camera, x, y, {seen.width, seen.height});
        const glm::dvec3 p = camera.position - camera.position.x / ray.x * ray;
        if (p.y < 0.1 || p.y > 2.95 || std::abs(p.z) > 1.95) continue;
        shown.at(x, y) = glm::vec3(seen.at(x, y).x);
        expected.at(x, y) = glm::vec3(static_cast<float>(0.5 / kPi * irradianceAt(p)));
        sum += shown.at(x, y).x;
        expectedSum += expected.at(x, y).x;
        ++count;
      }
    ASSERT_GT(count, seen.width * seen.height / 2);
    std::cout << "[ measured ] wall beside " << what << ": mean over the exact one " << sum / expectedSum
              << ", relative error " << relativeError(shown, expected) << "\n";
    EXPECT_NEAR(sum / expectedSum, 1.0, 0.01) << what;
    EXPECT_LT(relativeError(shown, expected), mostError) << what;
  }
};

TEST_F(IrradianceCacheGl, AWallBesideASunlitFloor) {
  FloorAndWall room;
  room.builder.sun(
      {0, -1, 0},
      glm::vec3(std::numbers::pi_v<float>));  // along the wall: it has no light but the floor's, radiance 0.8
  const Picture seen =
      picture(room.builder.scene(), room.camera, FloorAndWall::fine(settings(1, 1024, Component::indirect)));
  const glm::dvec3 plate[] = {{0, 0, -1}, {2, 0, -1}, {2, 0, 1}, {0, 0, 1}};
  room.expect(
      seen.image,
      [&](const glm::dvec3& p) {
        return 0.8 * kPi * reference::pointToPolygon(p, {1, 0, 0}, plate);
      },
      "a sunlit floor");
}

// ---- finished pictures

/// The foot of a wall beside a narrow sunlit strip of floor: light that changes much within a cell.
struct Foot : FloorAndWall {
  static constexpr double kWidth = 0.3;
  Foot() {
    builder = SceneBuilder();
    builder.plate({kWidth / 2, 0.0, 0.0}, {0, 0, 2}, {kWidth, 0, 0}, builder.material(glm::vec3(0.8f)));
    builder.plate({0.0, 1.5, 0.0}, {0, 3, 0}, {0, 0, 4}, builder.material(glm::vec3(0.5f)));
    builder.sun({0, -1, 0}, glm::vec3(std::numbers::pi_v<float>));
    camera = lookingAt({1.6, 0.3, 0.1}, {0.0, 0.1, 0.0}, 0.2);
  }
  struct Error {
    double relative, mean;  ///< mean over the exact one
  };
  Error of(const Image& seen) const {
    const glm::dvec3 strip[] = {{0, 0, -1}, {kWidth, 0, -1}, {kWidth, 0, 1}, {0, 0, 1}};
    Image expected(seen.width, seen.height), shown(seen.width, seen.height);
    for (int y = 0; y < seen.height; ++y)
      for (int x = 0; x < seen.width; ++x) {
        const glm::dvec3 ray = test::pixelRay(camera, x, y, {seen.width, seen.height});
        const glm::dvec3 p = camera.position - camera.position.x / ray.x * ray;
        if (p.y < 0.01 || p.y > 0.15) continue;  // within a cell
        shown.at(x, y) = glm::vec3(seen.at(x, y).x);
        expected.at(x, y) =
            glm::vec3(static_cast<float>(0.5 / kPi * 0.8 * kPi * reference::pointToPolygon(p, {1, 0, 0}, strip)));
      }
    return {relativeError(shown, expected), meanOf(shown).x / meanOf(expected).x};
  }
};

TEST_F(IrradianceCacheGl, CellsAreSplitWhereSurfacesMeet) {
  Foot foot;
  RenderSettings s = settings(1, 1024, Component::indirect);
  s.of<IrradianceCacheSettings>().split = 4;
  s.of<IrradianceCacheSettings>().splitShare = 100.0f;
  const Picture whole = picture(foot.builder.scene(), foot.camera, s);
  s.wholePictures = true;
  const Picture split = picture(foot.builder.scene(), foot.camera, s);
  const Foot::Error before = foot.of(whole.image), now = foot.of(split.image);
  report("foot of a wall, relative error with whole cells", before.relative);
  report("with split cells", now.relative);
  report("mean over the exact one", now.mean);
  EXPECT_LT(now.relative, 0.4 * before.relative);
  EXPECT_LT(now.relative, 0.04);
  EXPECT_NEAR(now.mean, 1.0, 0.02);
  EXPECT_GT(split.counts.records, whole.counts.records);
}

TEST_F(IrradianceCacheGl, AWallFarFromOtherSurfacesIsNotSplit) {
  FloorAndWall room;
  Camera above = room.camera;
  above.position.y = 2.6, above.direction = glm::dvec3(-1.0, 0.0, 0.0);
  RenderSettings s = settings(1, 64);
  s.wholePictures = true;
  s.of<IrradianceCacheSettings>().split = 4;
  s.of<IrradianceCacheSettings>().cascades.cells = 40;
  Scene scene = room.builder.scene();
  scene.environment = Environment{};
  scene.environment->radiance = glm::vec3(1.0f);
  const std::uint64_t split = picture(scene, above, s).counts.records;
  s.of<IrradianceCacheSettings>().split = 1;
  EXPECT_EQ(split, picture(scene, above, s).counts.records);
}

TEST_F(IrradianceCacheGl, NoiseIsSmoothed) {
  FloorAndWall sunlit;
  sunlit.builder.sun({0, -1, 0}, glm::vec3(std::numbers::pi_v<float>));
  RenderSettings s = FloorAndWall::fine(settings(1, 256, Component::indirect));
  s.of<IrradianceCacheSettings>().split = 1;
  s.wholePictures = true;
  const auto drawn = [&](int samples, bool smooths) {
    s.of<IrradianceCacheSettings>().samples = samples;
    s.of<IrradianceCacheSettings>().smooths = smooths;
    return picture(sunlit.builder.scene(), sunlit.camera, s).image;
  };
  const Image expected = drawn(8192, false), noisy = drawn(256, false), smooth = drawn(256, true);
  report("noise of 256 paths", relativeError(noisy, expected));
  report("smoothed", relativeError(smooth, expected));
  EXPECT_LT(relativeError(smooth, expected), 0.7 * relativeError(noisy, expected));
  EXPECT_NEAR(meanOf(smooth).x / meanOf(expected).x, 1.0, 0.005);
  // Where there is no noise nothing changes.
  EXPECT_LT(relativeError(drawn(8192, true), expected), 0.005);
}

TEST_F(IrradianceCacheGl, AWallBesideAFloorUnderALamp) {
  {
    FloorAndWall room;
    room.builder.scene().points.push_back({{1.2, 1.0, 0.3}, glm::vec3(5.0f)});
    const auto radiance = [](double x, double z) {
      const double d2 = (x - 1.2) * (x - 1.2) + 1.0 + (z - 0.3) * (z - 0.3);
      return 0.8 / kPi * 5.0 / (d2 * std::sqrt(d2));
    };
    // The floor gives a millimetre of itself back by the wall: that is on the floor, which the wall does not see
    // again with one bounce.
    const Picture seen =
        picture(room.builder.scene(), room.camera, FloorAndWall::fine(settings(1, 1024, Component::indirect)));
    room.expect(
        seen.image, [&](const glm::dvec3& p) { return FloorAndWall::irradiance(p, radiance); },
        "a floor under an omnidirectional lamp");
  }
  FloorAndWall room;
  room.builder.scene().spots.push_back({{1.0, 2.0, 0.0}, {0.0, -1.0, 0.0}, glm::vec3(9.0f), 0.2, 0.4});
  const auto radiance = FloorAndWall::underSpot(2.0, 0.2, 0.4);
  const Picture seen =
      picture(room.builder.scene(), room.camera, FloorAndWall::fine(settings(1, 1024, Component::indirect)));
  room.expect(
      seen.image, [&](const glm::dvec3& p) { return FloorAndWall::irradiance(p, radiance); }, "a floor under a spot");
}

// Nearly all light comes from a spot on the floor that one path of a thousand meets, but with a thousand times the
// light: next-event estimation alone shows it as bright squares of single records.
TEST_F(IrradianceCacheGl, AWallBesideAFloorCloseToALamp) {
  for (const float radius : {0.0f, 0.04f}) {
    FloorAndWall room;
    room.builder.scene().points.push_back({{1.2, 0.05, 0.3}, glm::vec3(5.0f), radius});
    const auto radiance = [](double x, double z) {
      const double d2 = (x - 1.2) * (x - 1.2) + 0.05 * 0.05 + (z - 0.3) * (z - 0.3);
      return 0.8 / kPi * 5.0 * 0.05 / (d2 * std::sqrt(d2));
    };
    const Picture seen =
        picture(room.builder.scene(), room.camera, FloorAndWall::fine(settings(1, 1024, Component::indirect)));
    room.expect(
        seen.image, [&](const glm::dvec3& p) { return FloorAndWall::irradiance(p, radiance); },
        radius > 0.0f ? "a floor close to a lamp with a radius" : "a floor close to a lamp");
  }
  FloorAndWall room;
  room.builder.scene().spots.push_back({{1.0, 0.2, 0.0}, {0.0, -1.0, 0.0}, glm::vec3(9.0f), 0.3, 0.9});
  const auto radiance = FloorAndWall::underSpot(0.2, 0.3, 0.9);
  const Picture seen =
      picture(room.builder.scene(), room.camera, FloorAndWall::fine(settings(1, 1024, Component::indirect)));
  room.expect(
      seen.image, [&](const glm::dvec3& p) { return FloorAndWall::irradiance(p, radiance); },
      "a floor close to a spot");
}

TEST_F(IrradianceCacheGl, AWallBesideAPlateThatShines) {
  // The plate itself shines: its light is direct, and there is nothing that reflects it back but what the plate's own
  // albedo does.
  FloorAndWall room;
  room.builder.materialAt(0).emission = glm::vec3(1.5f);
  room.builder.materialAt(0).diffuse = glm::vec3(0.0f);
  const glm::dvec3 plate[] = {{0, 0, -1}, {2, 0, -1}, {2, 0, 1}, {0, 0, 1}};
  for (const Component component : {Component::all, Component::direct}) {
    const Picture seen = picture(room.builder.scene(), room.camera, FloorAndWall::fine(settings(1, 256, component)));
    room.expect(
        seen.image,
        [&](const glm::dvec3& p) {
          return 1.5 * kPi * reference::pointToPolygon(p, {1, 0, 0}, plate);
        },
        "a plate that shines");
  }
  EXPECT_EQ(largestValue(picture(room.builder.scene(), room.camera, settings(1, 64, Component::indirect)).image), 0.0);
}

// ---- gathered from the lights' maps
// ------------------------------------------------------------------------------------

RenderSettings gathered(RenderSettings s, GatherVisibility visibility = GatherVisibility::rays) {
  s.of<IrradianceCacheSettings>().transport = CacheTransport::gather;
  s.of<IrradianceCacheSettings>().visibility = visibility;
  s.of<IrradianceCacheSettings>().bounceCells = 8;
  return s;
}

class CacheGatherGl : public IrradianceCacheGl {};

TEST_F(CacheGatherGl, AWallBesideAFloorUnderTheSunALampAndASpot) {
  const glm::dvec3 plate[] = {{0, 0, -1}, {2, 0, -1}, {2, 0, 1}, {0, 0, 1}};
  for (const GatherVisibility visibility : {GatherVisibility::none, GatherVisibility::rays}) {
    const RenderSettings s = gathered(FloorAndWall::fine(settings(1, 1, Component::indirect)), visibility);
    {
      FloorAndWall room;
      room.builder.sun({0, -1, 0}, glm::vec3(std::numbers::pi_v<float>));
      for (const int size : {256, 32}) {
        RenderSettings ofMap = s;
        ofMap.of<ReflectiveShadowMap::Settings>().size = size;
        room.expect(
            picture(room.builder.scene(), room.camera, ofMap).image,
            [&](const glm::dvec3& p) {
              return 0.8 * kPi * reference::pointToPolygon(p, {1, 0, 0}, plate);
            },
            "a sunlit floor, gathered", 0.03);
      }
    }
    FloorAndWall room;
    room.builder.scene().points.push_back({{1.2, 1.0, 0.3}, glm::vec3(5.0f)});
    room.expect(
        picture(room.builder.scene(), room.camera, s).image,
        [&](const glm::dvec3& p) {
          return FloorAndWall::irradiance(p, [](double x, double z) {
            const double d2 = (x - 1.2) * (x - 1.2) + 1.0 + (z - 0.3) * (z - 0.3);
            return 0.8 / kPi * 5.0 / (d2 * std::sqrt(d2));
          });
        },
        "a floor under an omnidirectional lamp, gathered", 0.03);
  }
}

// ---- floors: the same without the cells, and from the exact radiance in them

/// As if the wall's albedo of 1/2 had been applied.
Image ofWall(Image irradiance) {
  for (glm::vec3& p : irradiance.pixels) p *= static_cast<float>(0.5 / kPi);
  return irradiance;
}

TEST_F(IrradianceCacheGl, ItsFloorsAtPixelsAndFromCells) {
  FloorAndWall room;
  room.builder.sun({0, -1, 0}, glm::vec3(std::numbers::pi_v<float>));  // the floor's radiance is 0.8
  const Scene& scene = room.builder.scene();
  RenderSettings s = settings(1, 16, Component::indirect);
  s.of<IrradianceCacheSettings>().cascades.cells = 16;
  s.of<IrradianceCacheSettings>().cascades.cascades = 1;
  {
    Renderer renderer(context(), library(), scene, gathered(s));
    renderer.renderToTheEnd(room.camera);
    const glm::dvec3 plate[] = {{0, 0, -1}, {2, 0, -1}, {2, 0, 1}, {0, 0, 1}};
    room.expect(
        ofWall(dynamic_cast<const IrradianceCacheFrame*>(renderer.technique())->gatheredAtPixels()),
        [&](const glm::dvec3& p) {
          return 0.8 * kPi * reference::pointToPolygon(p, {1, 0, 0}, plate);
        },
        "a sunlit floor, gathered at each pixel", 0.03);
  }
  // Two bands of the radiance in the eight cells around, half a cell before the wall: the weight 1/4 + <n, w> / 2.
  const Cascade grid = placeCascades(s.of<IrradianceCacheSettings>().cascades, scene.bounds, room.camera.position,
                                     room.camera.direction)[0];
  const auto fromCell = [&](const glm::dvec3& middle) {
    return middle.y <= 0.0 ? 0.0 : FloorAndWall::integral(middle, [&](const glm::dvec3& d, double d2) {
      return 0.8 * (0.25 + 0.5 * d.x / std::sqrt(d2)) * -d.y / (d2 * std::sqrt(d2));
    });
  };
  std::map<std::tuple<double, double, double>, double> known;
  const auto expected = [&](const glm::dvec3& p) {
    const glm::dvec3 place = (p - grid.minimum()) / grid.cellSize + glm::dvec3(0.5, 0.0, 0.0) - 0.5,
                     low = glm::floor(place + 1e-9), part = place - low;
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 up(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::dvec3 share = up * part + (1.0 - up) * (1.0 - part), cell = low + up;
      const double weight = share.x * share.y * share.z;
      if (weight < 1e-6) continue;
      const auto [found, isNew] = known.try_emplace({cell.x, cell.y, cell.z});
      if (isNew) found->second = fromCell(grid.minimum() + (cell + 0.5) * grid.cellSize);
      sum += weight * found->second;
    }
    return sum;
  };
  Renderer renderer(context(), library(), scene, s);
  renderer.renderToTheEnd(room.camera);
  room.expect(ofWall(dynamic_cast<const IrradianceCacheFrame*>(renderer.technique())
                         ->readFromCells(s.of<IrradianceCacheSettings>().cascades, 0.25f, 1024)),
              expected, "a sunlit floor, from cells", 0.08);
}

TEST_F(CacheGatherGl, AScreenBehindAWallIsDark) {
  // All that the plate sends to the screen passes the wall.
  const auto mean = [](GatherVisibility visibility) {
    FloorAndWall room;
    room.builder.sun({0, -1, 0}, glm::vec3(std::numbers::pi_v<float>));
    room.builder.plate({-0.6, 1.5, 0.0}, {0, 3, 0}, {0, 0, 4}, room.builder.material(glm::vec3(0.5f)));
    room.camera =
        lookingAt({-0.2, 1.2, 0.3}, {-0.6, 1.2, 0.3}, 1.0);  // at the screen's side that faces the wall's back
    return meanOf(picture(room.builder.scene(), room.camera,
                          gathered(FloorAndWall::fine(settings(1, 1, Component::indirect)), visibility))
                      .image)
        .x;
  };
  EXPECT_GT(mean(GatherVisibility::none), 0.01);
  EXPECT_LT(mean(GatherVisibility::rays), 0.05 * mean(GatherVisibility::none));
}

TEST_F(CacheGatherGl, TheSkyAboveAFloorAndInAPit) {
  SceneBuilder builder = floorAlone();
  builder.scene().environment->radiance = {2.0f, 0.5f, 1e-3f};
  const Picture seen = picture(builder.scene(), kAboveFloor, gathered(settings(1, 1)));
  for (const glm::vec3& p : seen.image.pixels)
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(p[c] / (0.5f * builder.scene().environment->radiance[c]), 1.0f, 1e-5f);
  // Under a lid that is as wide as the floor and 0.2 above it the middle is dark.
  builder.plate({0.0, 0.2, 0.0}, {0, 0, 8}, {8, 0, 0}, builder.material(glm::vec3(0.5f)));
  const Picture dark =
      picture(builder.scene(), lookingAt({0.3, 0.1, 0.0}, {0.0, 0.0, 0.0}, 0.5), gathered(settings(1, 1)));
  EXPECT_LT(meanOf(dark.image).x, 0.1);
}

// Each stage adds its light to what the stage before it has left: the lights' maps first, then the sky.
TEST_F(CacheGatherGl, SkyAndSunAddUp) {
  const auto lit = [&](bool sky, bool sun) {
    FloorAndWall room;
    if (sky) room.builder.scene().environment.emplace().radiance = {0.2f, 0.3f, 0.6f};
    if (sun) room.builder.sun({0, -1, 0}, glm::vec3(std::numbers::pi_v<float>));
    return picture(room.builder.scene(), room.camera,
                   gathered(FloorAndWall::fine(settings(1, 1)), GatherVisibility::none))
        .image;
  };
  const Image both = lit(true, true), sky = lit(true, false);
  Image sum = lit(false, true);
  EXPECT_GT(meanOf(sky).x, 0.05 * meanOf(both).x);
  EXPECT_GT(meanOf(sum).x, 0.05 * meanOf(both).x);
  for (std::size_t i = 0; i < sum.pixels.size(); ++i) sum.pixels[i] += sky.pixels[i];
  EXPECT_LT(largestDifference(both, sum), 1e-4 * largestValue(both));
}

// Light of the sky alone bounces too: what `rays` finds of it.
TEST_F(CacheGatherGl, TheSkyAloneHasIndirectLight) {
  FloorAndWall room;
  room.builder.scene().environment.emplace().radiance = glm::vec3(0.5f);
  for (const int bounces : {1, kAll}) {
    const auto of = [&](RenderSettings s) { return picture(room.builder.scene(), room.camera, s).image; };
    const RenderSettings s = FloorAndWall::fine(settings(bounces, 1024, Component::indirect));
    const Image seen = of(gathered(s)), traced = of(s);
    report("the sky's indirect light, gathered over traced", meanOf(seen).x / meanOf(traced).x);
    EXPECT_NEAR(meanOf(seen).x / meanOf(traced).x, 1.0, 0.01) << bounces;
    EXPECT_LT(relativeError(seen, traced), 0.05) << bounces;
  }
}

// A floor goes on below the walls that stand on it. Its points there lie in the dark, and must not stand for the
// floor beside them.
TEST_F(CacheGatherGl, WhatSolidsHideIsNotBounced) {
  SceneBuilder builder;
  builder.sun({0.3, -1.0, 0.2}, glm::vec3(4.0f));
  const int white = builder.material(glm::vec3(0.8f));
  builder.plate({0.0, 0.0, 0.0}, {0, 0, 8}, {8, 0, 0}, white);
  builder.plate({-4.0, 2.0, 0.0}, {0, 4, 0}, {0, 0, 8}, white);
  for (double x = -2.0; x <= 2.0; x += 2.0)  // along the middle of every other row of cells
    for (double z = -3.75; z < 4.0; z += 0.5) test::addBox(builder, 0.25, white, false, {x, 0.24, z});
  const Camera camera = lookingAt({4.0, 3.0, 0.5}, {-4.0, 1.0, 0.0}, 0.8);
  const auto of = [&](RenderSettings s) { return meanOf(picture(builder.scene(), camera, s).image).x; };
  RenderSettings s = FloorAndWall::fine(settings(kAll, 512, Component::indirect));
  const double seen = of(gathered(s, GatherVisibility::rays));
  s.of<IrradianceCacheSettings>().bounces = 24;  // paths of their own, none of which ends at records
  const double ratio = seen / of(s);
  report("walls on a floor, gathered over traced", ratio);
  EXPECT_NEAR(ratio, 1.0, 0.02);  // 8^3 cells of points miss 1.3 %; with the points below the walls it is 3.5 %
}

// A lit square far away, of which a piece of a wall sees a part: a screen hides its lower half, or it reaches behind
// the wall's plane. What a node's rays find must be that part, as the node's own contribution leaves the rest out
// already.
TEST_F(CacheGatherGl, PartsOfFarLightArrive) {
  constexpr double kFar = 6.0;
  const auto ratio = [&](double x, double side, bool screen) {
    SceneBuilder builder;
    builder.sun({0.0, -0.2, 1.0}, glm::vec3(100.0f));
    const int white = builder.material(glm::vec3(0.8f)), black = builder.material(glm::vec3(0.0f));
    builder.plate({0.0, 1.0, 0.0}, {0, 0.01, 0}, {0, 0, 0.01}, white);
    for (const double end : {-3.0, 3.3})  // widen the map, so that the square has few nodes, one across x = 0
      builder.plate({end, 1.0, 0.0}, {0, 0.01, 0}, {0, 0, 0.01}, black);
    builder.plate({x, 1.0, kFar}, {0, side, 0}, {side, 0, 0}, white);
    if (screen) builder.plate({0.5 * x, 0.75, 0.5 * kFar}, {0, 0.5, 0}, {2, 0, 0}, black);
    const Camera camera = lookingAt({1.0, 1.0, 0.0}, {0.0, 1.0, 0.0}, 0.005);
    const Picture seen =
        picture(builder.scene(), camera, gathered(settings(1, 1, Component::indirect), GatherVisibility::rays));
    double expected = 0.0;
    constexpr int kSteps = 200;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const double u = ((i + 0.5) / kSteps - 0.5) * side, v = ((j + 0.5) / kSteps - 0.5) * side;
        const glm::dvec3 to(x + u, v, kFar);
        if (to.x > 0.0 && !(screen && v < 0.0)) expected += to.x * to.z / std::pow(glm::dot(to, to), 2.0);
      }
    constexpr double kPi = std::numbers::pi;
    const double exitance = 0.8 * 100.0 / std::hypot(0.2, 1.0);
    expected *= side * side / (kSteps * kSteps) * exitance / kPi;
    return meanOf(seen.image).x / (0.8 / kPi * expected);
  };
  const auto expectMean = [&](const char* what, double x, double side, bool screen, double within) {
    constexpr int kPlaces = 12;  // each with other nodes
    double mean = 0.0;
    for (int i = 0; i < kPlaces; ++i) mean += ratio(x * (1.0 + 0.02 * i), side, screen) / kPlaces;
    report(what, mean);
    EXPECT_NEAR(mean, 1.0, within) << what;
  };
  expectMean("a far lit square", 1.3, 0.6, false, 0.02);
  expectMean("a far lit square, half hidden", 1.3, 0.6, true, 0.03);
  // Of a node across the horizon the mean height alone is known.
  expectMean("a far lit square, a part behind the horizon", 0.04, 0.15, false, 0.1);
}

// As AClosedRoomThatShines: nothing of its light may get lost, and none be made.
TEST_F(CacheGatherGl, AClosedRoomThatShines) {
  const glm::dvec3 albedo(0.8f, 0.5f, 0.0f), emission(1.0, 2.0, 3.0);
  const Scene scene = furnace(glm::vec3(albedo), glm::vec3(emission));
  for (const int bounces : {1, 2, 5, kAll}) {
    const Picture seen = picture(scene, kInside, gathered(settings(bounces, 1)));
    const glm::dvec3 mean = meanOf(seen.image);
    for (int c = 0; c < 3; ++c) {
      const double expected =
          emission[c] * (bounces == kAll ? 1.0 : 1.0 - std::pow(albedo[c], bounces + 2.0)) / (1.0 - albedo[c]);
      report(
          fmt::format("gathered furnace, bounces {}, channel {}", bounces == kAll ? "all" : std::to_string(bounces), c),
          mean[c] / expected);
      EXPECT_NEAR(mean[c] / expected, 1.0, 0.01) << bounces << ", channel " << c;
    }
    EXPECT_LT(relativeError(seen.image, Image(seen.image.width, seen.image.height, glm::vec3(mean))), 0.02);
  }
}

TEST_F(CacheGatherGl, ARoomThatReflectsNearlyEverythingIsBoundedAndBrightens) {
  constexpr double kAlbedo = 1.0 - 1e-6;
  const Scene scene = furnace(glm::vec3(static_cast<float>(kAlbedo)), glm::vec3(1.0f));
  double before = 0.0;
  for (const int bounces : {1, 16, kAll}) {
    const Image image = picture(scene, kInside, gathered(settings(bounces, 1))).image;
    for (const glm::vec3& p : image.pixels) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
    const double now = meanOf(image).x, most = bounces == kAll ? 66.0 : bounces + 2.0;
    report(fmt::format("albedo 1 - 1e-6, {} bounces, over the exact one", bounces), now / most);
    EXPECT_NEAR(now / most, 1.0, 0.02) << bounces;
    EXPECT_GT(now, before);
    before = now;
  }
}

TEST_F(CacheGatherGl, AWallBesideAPlateThatShines) {
  FloorAndWall room;
  room.builder.materialAt(0).emission = glm::vec3(1.5f);
  room.builder.materialAt(0).diffuse = glm::vec3(0.0f);
  const glm::dvec3 plate[] = {{0, 0, -1}, {2, 0, -1}, {2, 0, 1}, {0, 0, 1}};
  for (const GatherVisibility visibility : {GatherVisibility::none, GatherVisibility::rays})
    for (const Component component : {Component::all, Component::direct}) {
      const Picture seen = picture(room.builder.scene(), room.camera,
                                   gathered(FloorAndWall::fine(settings(1, 1, component)), visibility));
      room.expect(
          seen.image,
          [&](const glm::dvec3& p) {
            return 1.5 * kPi * reference::pointToPolygon(p, {1, 0, 0}, plate);
          },
          "a plate that shines, gathered");
    }
  EXPECT_EQ(largestValue(picture(room.builder.scene(), room.camera,
                                 gathered(FloorAndWall::fine(settings(1, 1, Component::indirect))))
                             .image),
            0.0);
}

// A plate of which a picture lets one half shine, beside a wall: the half that shines lights, with its own colour.
TEST_F(CacheGatherGl, APictureOfEmissionLights) {
  FloorAndWall room;
  Material& shining = room.builder.materialAt(0);
  shining.diffuse = glm::vec3(0.0f);
  std::vector<std::uint8_t> halfWhite(64, 255);
  for (std::size_t i = 32; i < 64; ++i) halfWhite[i] = i % 4 == 3 ? 255 : 0;
  shining.emissionTexture = room.builder.texture(16, 1, halfWhite);
  shining.emissionScale = glm::vec3(2.0f);
  shining.emission = glm::vec3(1.0f);  // the mean
  const auto of = [&](RenderSettings s) { return picture(room.builder.scene(), room.camera, s).image; };
  const RenderSettings s = FloorAndWall::fine(settings(1, 1024));
  const Image seen = of(gathered(s)), traced = of(s);
  report("a picture of emission, gathered over traced", meanOf(seen).x / meanOf(traced).x);
  EXPECT_GT(meanOf(traced).x, 0.01);
  EXPECT_NEAR(meanOf(seen).x / meanOf(traced).x, 1.0, 0.02);
  EXPECT_LT(relativeError(seen, traced), 0.06);
}

TEST_F(CacheGatherGl, ComponentsAddUp) {
  const Scene scene = test::openBox();
  SceneBuilder builder;
  builder.scene() = scene;
  const int lamp = builder.material(glm::vec3(0.3f));
  builder.materialAt(lamp).emission = {6.0f, 5.0f, 3.0f};
  builder.plate({1.5, 3.0, -2.0}, {2, 0, 0}, {0, 0, 2}, lamp);
  builder.scene().environment.emplace().radiance = {0.2f, 0.3f, 0.6f};
  for (const int bounces : {1, kAll}) {
    const auto of = [&](Component component) {
      return picture(builder.scene(), test::openBoxCamera(), gathered(settings(bounces, 1, component))).image;
    };
    const Image all = of(Component::all), direct = of(Component::direct), indirect = of(Component::indirect);
    Image sum = direct;
    for (std::size_t i = 0; i < sum.pixels.size(); ++i) sum.pixels[i] += indirect.pixels[i];
    report("gathered: direct and indirect over all, relative difference", relativeError(sum, all));
    EXPECT_LT(relativeError(sum, all), 1e-3) << bounces;
    EXPECT_GT(meanOf(indirect).x, 0.05 * meanOf(all).x);
  }
}

// Emissive surfaces become points of the same flux, on their surfaces, half of them on either side.
TEST(LpvPoints, EmitWhatTheTrianglesDo) {
  SceneBuilder builder;
  const int bright = builder.material(glm::vec3(0.0f)), faint = builder.material(glm::vec3(0.0f));
  builder.materialAt(bright).emission = {8.0f, 4.0f, 2.0f};
  builder.materialAt(faint).emission = {0.0f, 0.0f, 0.5f};
  builder.plate({1, 2, 3}, {0, 0, 2}, {2, 0, 0}, bright);
  builder.plate({1, 1, 9}, {0, 3, 0}, {4, 0, 0}, faint);
  const glm::dvec3 expected = 2.0 * kPi * (4.0 * glm::dvec3(8.0, 4.0, 2.0) + 12.0 * glm::dvec3(0.0, 0.0, 0.5)),
                   origin(0.5, 0.0, -1.0);
  const std::vector<float> density = lightTable(builder.scene(), glm::dvec3(0.0)).pickDensity;
  for (const int size : {8, 32, 64}) {
    const EmissionPoints points = emissionPoints(builder.scene(), density, origin, size);
    ASSERT_EQ(points.position.size(), static_cast<std::size_t>(size * size));
    glm::dvec3 sum(0.0), normals(0.0);
    int count = 0;
    for (std::size_t i = 0; i < points.position.size(); ++i) {
      if (points.position[i].w == 0.0f) continue;
      ++count;
      sum += glm::dvec3(points.flux[i]);
      normals += glm::dvec3(points.normal[i]);
      const glm::dvec3 p = glm::dvec3(points.position[i]) + origin;
      EXPECT_TRUE(std::abs(p.y - 2.0) < 1e-5 || std::abs(p.z - 9.0) < 1e-5);
      EXPECT_GT(points.flux[i].w, 0.0f);
    }
    EXPECT_GE(count, size * size - 4);
    EXPECT_LT(glm::length(normals), 1e-6);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / expected[c], 1.0, 1e-5) << size;
  }
}

// Each cell that a surface crosses has a point of it in the slot of each side, and the slots name just these points.
TEST(LpvPoints, KeepOnePerCellAndSide) {
  const Scene scene = test::openBox();
  const BounceCache bounce = bounceCache(scene, 8);
  EXPECT_EQ(bounce.slots.size(), static_cast<std::size_t>(6 * bounce.cells.x * bounce.cells.y * bounce.cells.z));
  std::size_t used = 0;
  for (std::size_t slot = 0; slot < bounce.slots.size(); ++slot)
    for (std::uint32_t next = bounce.slots[slot]; next != 0; next = bounce.points.at(next - 1).next) {
      ++used;
      const BounceCache::Point& point = bounce.points.at(next - 1);
      const glm::ivec4 place = point.place;
      EXPECT_EQ(slot,
                static_cast<std::size_t>(
                    ((place.w * bounce.cells.z + place.z) * bounce.cells.y + place.y) * bounce.cells.x + place.x));
      EXPECT_EQ(glm::ivec3(glm::floor((point.position - bounce.minimum) / bounce.cellSize)), glm::ivec3(place));
      EXPECT_GT(point.normal[place.w / 2] * (place.w % 2 == 0 ? 1.0f : -1.0f), 0.14f);
      const auto corner = [&](std::uint32_t k) {
        return glm::dvec3(scene.vertices[scene.indices[3 * point.triangle + k]].position);
      };
      const double b = point.barycentrics.x, c = point.barycentrics.y;
      EXPECT_LT(glm::length((1.0 - b - c) * corner(0) + b * corner(1) + c * corner(2) - point.position), 1e-5);
    }
  EXPECT_EQ(used, bounce.points.size());
  // The floor alone crosses 9 x 9 cells, counted on both sides.
  EXPECT_GT(used, 2u * 81u);
}

// ---- against the path tracer
// ---------------------------------------------------------------------------------------------

/// A closed room with all kinds of light: a sun through a window, a lamp, a shining square and a sky.
Scene richRoom() {
  SceneBuilder builder;
  builder.scene() = test::openBox();
  Scene& scene = builder.scene();
  scene.environment = Environment{};
  scene.environment->radiance = {0.2f, 0.3f, 0.6f};
  scene.points.push_back({{-1.0, 1.0, 2.0}, glm::vec3(5.0f, 9.0f, 12.0f)});
  scene.spots.push_back(
      {{2.0, 4.0, 3.0}, glm::normalize(glm::dvec3(-0.3, -1.0, -0.8)), glm::vec3(60.0f, 50.0f, 40.0f), 0.3, 0.6});
  const int lamp = builder.material(glm::vec3(0.3f));
  builder.materialAt(lamp).emission = {6.0f, 5.0f, 3.0f};
  builder.plate({1.5, 3.0, -2.0}, {2, 0, 0}, {0, 0, 2}, lamp);
  return builder.scene();
}

TEST_F(IrradianceCacheGl, ComponentsAddUp) {
  const Scene scene = richRoom();
  for (const int bounces : {1, kAll}) {
    const auto of = [&](Component component) {
      return picture(scene, test::openBoxCamera(), settings(bounces, 512, component)).image;
    };
    const Image all = of(Component::all), direct = of(Component::direct), indirect = of(Component::indirect);
    Image sum = direct;
    for (std::size_t i = 0; i < sum.pixels.size(); ++i) sum.pixels[i] += indirect.pixels[i];
    const glm::dvec3 ratio = meanOf(sum) / meanOf(all);
    report(fmt::format("direct and indirect over all, {} bounces", bounces == kAll ? "all" : "1"), ratio.x);
    report("relative difference", relativeError(sum, all));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ratio[c], 1.0, 0.005) << bounces;
    EXPECT_LT(relativeError(sum, all), 0.04) << bounces;
    EXPECT_GT(meanOf(indirect).x, 0.05 * meanOf(all).x);
  }
}

// A small lamp close to a ceiling lights a spot smaller than a cell. Records around it hold too little or too much.
TEST_F(IrradianceCacheGl, ASmallLampCloseToACeilingLightsTheRestAsItsPartsDo) {
  SceneBuilder builder;
  builder.scene().sun.reset();
  test::addBox(builder, 1.0, builder.material(glm::vec3(0.6f)), true);
  const int lamp = builder.material(glm::vec3(0.0f));
  builder.materialAt(lamp).emission = glm::vec3(400.0f);
  builder.plate({0, 0.98, 0}, {0.04, 0, 0}, {0, 0, 0.04}, lamp);
  const Camera camera = lookingAt({0.9, -0.2, 0.9}, {-0.5, 0.25, -0.5}, 1.3);
  const auto ofLowerRows = [&](Component component) {
    RenderSettings s = settings(kAll, 1024, component, 32);
    s.of<IrradianceCacheSettings>().cascades.cells = 32;
    const Image seen = picture(builder.scene(), camera, s).image;
    double sum = 0.0;
    for (int y = 20; y < 32; ++y)
      for (int x = 0; x < 32; ++x) sum += static_cast<double>(seen.at(x, y).x);
    return sum;
  };
  const double ratio =
      ofLowerRows(Component::all) / (ofLowerRows(Component::direct) + ofLowerRows(Component::indirect));
  report("a small lamp close to a ceiling: all light over its parts", ratio);
  EXPECT_NEAR(ratio, 1.0, 0.05);
}

class IrradianceCacheAgainstPaths : public IrradianceCacheGl {
 protected:
  struct Reference {
    Image mean;
    double noise;  ///< its standard error as relativeError() counts differences
  };
  /// What the path tracer makes of just these scatterings, of Lambert's surfaces, in the centres of pixels.
  static Reference traced(const Scene& scene, const Camera& camera, Transport transport, std::uint32_t scatterings,
                          std::uint32_t samples = 256) {
    PathTracer::Settings s;
    s.size = glm::ivec2(64);
    s.transport = transport;
    s.bounces = scatterings;
    s.diffuseOnly = true;
    s.filter = PixelFilter::centre;
    PathTracer result(context(), library(), scene, s);
    result.setCamera(camera);
    result.record(samples);
    Reference reference{result.mean(), 0.0};
    Image noisy = result.standardError();
    for (std::size_t i = 0; i < noisy.pixels.size(); ++i) noisy.pixels[i] += reference.mean.pixels[i];
    reference.noise = relativeError(noisy, reference.mean);
    return reference;
  }
  /// Of all bounces in the Cornell box, traced once for all tests.
  static const Reference& cornellIndirect(const Scene& scene) {
    static const Reference reference =
        traced(scene, scene.cameras.front(), Transport::indirect, PathTracer::kUnlimited);
    return reference;
  }
  /// The picture's mean within `ofMean`, and its error beyond the reference's noise within `beyondNoise`.
  static void expectNear(const Image& seen, const Reference& reference, double ofMean, double beyondNoise,
                         const std::string& what) {
    const glm::dvec3 ratio = meanOf(seen) / meanOf(reference.mean);
    const double error = relativeError(seen, reference.mean),
                 beyond = std::sqrt(std::max(error * error - reference.noise * reference.noise, 0.0));
    std::cout << fmt::format(
        "[ measured ] {}: mean over the path traced one {:.4f} {:.4f} {:.4f}; relative error {:.4f}, the reference's "
        "noise {:.4f}, beyond it {:.4f}\n",
        what, ratio.x, ratio.y, ratio.z, error, reference.noise, beyond);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ratio[c], 1.0, ofMean) << what;
    EXPECT_LT(beyond, beyondNoise) << what;
  }
  static std::string nameOfBounces(int bounces) { return bounces == kAll ? "all" : std::to_string(bounces); }
};

TEST_F(IrradianceCacheAgainstPaths, CornellBox) {
  const Scene scene = loadScene((dataFolder() / "assets/cornell/cornell.json").string());
  const Camera camera = scene.cameras.front();
  struct Row {
    int bounces;
    Component component;
    Transport transport;
    std::uint32_t scatterings;
  };
  for (const Row& row : {Row{1, Component::indirect, Transport::oneBounce, PathTracer::kUnlimited},
                         Row{2, Component::indirect, Transport::indirect, 3},
                         Row{kAll, Component::indirect, Transport::indirect, PathTracer::kUnlimited},
                         Row{kAll, Component::all, Transport::all, PathTracer::kUnlimited}}) {
    // The short form leaves two bounces to AClosedRoomThatShines, which has an exact answer for them.
    if (row.bounces == 2 && !test::longTests()) continue;
    RenderSettings s = settings(row.bounces, 512, row.component);
    s.of<IrradianceCacheSettings>().cascades.cells = 32;
    s.of<IrradianceCacheSettings>().cascades.cascades = 3;
    const bool all = row.transport == Transport::indirect && row.scatterings == PathTracer::kUnlimited;
    const Reference reference = all ? cornellIndirect(scene) : traced(scene, camera, row.transport, row.scatterings);
    for (const CacheTransport transport : {CacheTransport::rays, CacheTransport::gather}) {
      // Gathered, 1 % of a bounce is lost where nodes of the map are not opened, 2 % of all.
      if (transport == CacheTransport::gather && row.bounces == 2) continue;
      s.of<IrradianceCacheSettings>().transport = transport;
      expectNear(picture(scene, camera, s).image, reference, transport == CacheTransport::gather ? 0.03 : 0.02, 0.05,
                 fmt::format("Cornell box, {}, {}, {} bounces", nameOf(transport), nameOf(row.component),
                             nameOfBounces(row.bounces)));
    }
  }
}

// Bounces, cells and the map's texels: more of them are never worse, by more than the reference's noise.
TEST_F(IrradianceCacheAgainstPaths, MoreIsBetterWhereLightIsGathered) {
  const Scene scene = loadScene((dataFolder() / "assets/cornell/cornell.json").string());
  const Camera camera = scene.cameras.front();
  const Reference& reference = cornellIndirect(scene);
  const auto error = [&](int bounces, int cells, int map, int points) {
    RenderSettings s = settings(bounces, 1, Component::indirect);
    s.of<IrradianceCacheSettings>().transport = CacheTransport::gather;
    s.of<IrradianceCacheSettings>().cascades.cells = cells;
    s.of<IrradianceCacheSettings>().cascades.cascades = 3;
    s.of<IrradianceCacheSettings>().bounceCells = points;
    s.of<ReflectiveShadowMap::Settings>().size = map;
    const double e = relativeError(picture(scene, camera, s).image, reference.mean);
    std::cout << fmt::format("[ measured ] gathered, {} bounces, {} cells, map {}, {} bounce cells: {:.4f}\n", bounces,
                             cells, map, points, e);
    return e;
  };
  const double best = error(kAll, 32, 256, 8), noise = reference.noise;
  std::cout << "[ measured ] the reference's noise: " << noise << "\n";
  // Errors of 5 % and less beside a noise n show as sqrt(n^2 + e^2).
  const double slack = 0.05 * noise, one = error(1, 32, 256, 8), two = error(2, 32, 256, 8);
  EXPECT_GT(one, two - slack);
  EXPECT_GT(two, best - slack);
  EXPECT_GT(one, 1.5 * best);
  EXPECT_GT(error(kAll, 12, 256, 8), best - slack);
  EXPECT_GT(error(kAll, 32, 32, 8), best - slack);
  EXPECT_GT(error(kAll, 32, 256, 4), best - slack);
}

/// A room of two legs at right angles, 2 wide and high; an omnidirectional lamp at the end of one, seen from the end
/// of the other: only bounced light gets there.
Scene roomWithACorner() {
  SceneBuilder builder;
  Scene& scene = builder.scene();
  scene.sun.reset();
  const int white = builder.material({0.7f, 0.7f, 0.7f}), red = builder.material({0.6f, 0.2f, 0.1f});
  for (const double y : {0.0, 2.0}) {
    builder.plate({1, y, 3}, {0, 0, 6}, {2, 0, 0}, white);
    builder.plate({4, y, 1}, {0, 0, 2}, {4, 0, 0}, white);
  }
  builder.plate({0, 1, 3}, {0, 2, 0}, {0, 0, 6}, red);
  builder.plate({3, 1, 0}, {6, 0, 0}, {0, 2, 0}, white);
  builder.plate({1, 1, 6}, {2, 0, 0}, {0, 2, 0}, white);
  builder.plate({6, 1, 1}, {0, 2, 0}, {0, 0, 2}, white);
  builder.plate({2, 1, 4}, {0, 2, 0}, {0, 0, 4}, white);
  builder.plate({4, 1, 2}, {4, 0, 0}, {0, 2, 0}, white);
  scene.points.push_back({{1.0, 1.2, 4.6}, glm::vec3(10.0f)});
  return scene;
}

TEST_F(IrradianceCacheAgainstPaths, ALampAroundTheCorner) {
  const Scene scene = roomWithACorner();
  const Camera camera = lookingAt({5.5, 1.0, 1.0}, {1.0, 0.9, 1.2}, 1.1);
  const Reference reference = traced(scene, camera, Transport::indirect, PathTracer::kUnlimited);
  for (const CacheTransport transport : {CacheTransport::rays, CacheTransport::gather}) {
    RenderSettings s = settings(kAll, 512, Component::indirect);
    s.of<IrradianceCacheSettings>().transport = transport;
    s.of<IrradianceCacheSettings>().cascades.cells = 32;
    s.of<IrradianceCacheSettings>().cascades.cascades = 3;
    const Image seen = picture(scene, camera, s).image;
    // Root mean square over the mean, of all surfaces (all pixels), and in blocks.
    double square = 0.0;
    for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
      const glm::dvec3 d = glm::dvec3(seen.pixels[i]) - glm::dvec3(reference.mean.pixels[i]);
      square += glm::dot(d, d) / 3.0;
    }
    const glm::dvec3 mean = meanOf(reference.mean);
    const double nrmse = std::sqrt(square / static_cast<double>(seen.pixels.size())) / ((mean.x + mean.y + mean.z) / 3);
    std::cout << fmt::format("[ measured ] a lamp around the corner, {}: NRMSE {:.4f}\n",
                             transport == CacheTransport::rays ? "rays" : "gather", nrmse);
    EXPECT_LT(nrmse, 0.35);
    expectNear(seen, reference, 0.03, 0.15, "a lamp around the corner");
  }
}

// Its light arrives by way of surfaces without records, which the camera does not see.
TEST_F(IrradianceCacheAgainstPaths, ALampCloseToAWallAroundTheCorner) {
  Scene scene = roomWithACorner();
  scene.points.front().position = {1.0, 1.2, 5.9};
  const Camera camera = lookingAt({5.5, 1.0, 1.0}, {1.0, 0.9, 1.2}, 1.1);
  const auto shown = [&](int samples) {
    RenderSettings s = settings(kAll, samples, Component::indirect);
    s.of<IrradianceCacheSettings>().cascades.cells = 32;
    return picture(scene, camera, s).image;
  };
  const Image seen = shown(256);
  const double noise = relativeError(seen, shown(4096));
  report("a lamp close to a wall around the corner: noise of 256 paths", noise);
  EXPECT_LT(noise, 0.08);
  const std::uint32_t samples = test::longTests() ? 8192 : 1024;
  expectNear(seen, traced(scene, camera, Transport::indirect, PathTracer::kUnlimited, samples),
             test::longTests() ? 0.015 : 0.04, 0.15, "a lamp close to a wall around the corner");
}

TEST_F(IrradianceCacheAgainstPaths, ARoomWithEveryKindOfLight) {
  const Scene scene = richRoom();
  for (const auto& [bounces, scatterings] : {std::pair{1, 2u}, std::pair{kAll, PathTracer::kUnlimited}}) {
    Reference reference = traced(scene, test::openBoxCamera(), Transport::all, scatterings);
    for (const CacheTransport transport : {CacheTransport::rays, CacheTransport::gather}) {
      RenderSettings s = settings(bounces, 512);
      s.of<IrradianceCacheSettings>().transport = transport;
      Image shown = picture(scene, test::openBoxCamera(), s).image;
      // What the path tracer shows of the sky itself is the background's business in forward shading.
      for (std::size_t i = 0; i < shown.pixels.size(); ++i)
        if (shown.pixels[i] == scene.background) reference.mean.pixels[i] = shown.pixels[i] = glm::vec3(0.0f);
      expectNear(shown, reference, 0.01, 0.05,
                 fmt::format("room, {}, {} bounces", nameOf(transport), nameOfBounces(bounces)));
    }
  }
}

// ---- what must not change the picture
// -------------------------------------------------------------------------------------

TEST_F(IrradianceCacheGl, FarFromTheOriginThePictureIsTheSame) {
  const Scene near = richRoom();
  const Image reference = picture(near, test::openBoxCamera(), settings(2, 64)).image;
  for (const glm::dvec3& offset : {glm::dvec3(1024.0, 0.0, 0.0), glm::dvec3(-65536.0, 32768.0, 65536.0)}) {
    Scene far = near;
    // Powers of two and a room of side 10: the corners' coordinates are exact in 32 bits.
    for (Vertex& vertex : far.vertices) vertex.position += glm::vec3(offset);
    far.bounds = {};
    for (Mesh& mesh : far.meshes) {
      mesh.bounds.min += offset;
      mesh.bounds.max += offset;
      far.bounds.add(mesh.bounds);
    }
    for (PointLight& lamp : far.points) lamp.position += offset;
    for (SpotLight& lamp : far.spots) lamp.position += offset;
    Camera camera = test::openBoxCamera();
    camera.position += offset;
    const Image seen = picture(far, camera, settings(2, 64)).image;
    report(fmt::format("{:g} away: relative difference", offset.x), relativeError(seen, reference));
    EXPECT_LT(relativeError(seen, reference), 1e-6) << offset.x;
  }
}

TEST_F(IrradianceCacheGl, UnitsOfLengthDoNotMatter) {
  const Image reference = picture(test::openBox(), test::openBoxCamera(), settings(2, 128)).image;
  for (const double scale : {0.01, 100.0}) {
    const Image seen = picture(test::openBox(scale), test::openBoxCamera(scale), settings(2, 128)).image;
    report(fmt::format("scale {:g}: relative difference", scale), relativeError(seen, reference));
    EXPECT_NEAR(meanOf(seen).x / meanOf(reference).x, 1.0, 0.01) << scale;
    EXPECT_LT(relativeError(seen, reference), 0.05) << scale;
  }
}

TEST_F(IrradianceCacheGl, UnitsOfLightDoNotMatter) {
  RenderSettings s = settings(2, 64);
  s.of<IrradianceCacheSettings>().fullFloat = false;
  const Image reference = picture(richRoom(), test::openBoxCamera(), s).image;
  for (const float factor : {1e-3f, 1e5f}) {
    Scene scene = richRoom();
    scene.sun->irradiance *= factor;
    for (PointLight& lamp : scene.points) lamp.intensity *= factor;
    for (SpotLight& lamp : scene.spots) lamp.intensity *= factor;
    scene.environment->radiance *= factor;
    for (Material& material : scene.materials) material.emission *= factor;
    Image seen = picture(scene, test::openBoxCamera(), s).image;
    for (glm::vec3& p : seen.pixels) p /= factor;
    EXPECT_LT(largestDifference(seen, reference), 1e-3 * largestValue(reference)) << factor;
  }
}

// ---- what is kept
// ------------------------------------------------------------------------------------------------------

class IrradianceCacheKept : public IrradianceCacheGl {
 protected:
  static IrradianceCache::Counts frame(Renderer& renderer, const Camera& camera) {
    renderer.render(camera);
    renderer.drain();
    return cacheOf(renderer.technique())->counts();
  }
  static double brightnessOf(const Renderer& renderer) {
    const glm::dvec3 mean = meanOf(renderer.readRadiance());
    return (mean.x + mean.y + mean.z) / 3.0;
  }
};

TEST_F(IrradianceCacheKept, PathsGoOnWhereTheCameraHasBeen) {
  const Scene scene = test::openBox();
  RenderSettings s = settings(1, 256);
  s.of<IrradianceCacheSettings>().leastRays = 16;
  s.of<IrradianceCacheSettings>().mostChange = 0.0f;
  const Camera here = test::openBoxCamera(),
               there = lookingAt({2.0, 1.0, 11.0}, {0.5, -1.0, 0.0}, 0.9);  // the finer grid moves
  Renderer renderer(context(), library(), scene, s);
  const IrradianceCache::Counts first = frame(renderer, here);
  EXPECT_GT(first.records, 100u);
  EXPECT_EQ(first.left, 0u);
  EXPECT_GT(first.waiting, first.records / 2);
  EXPECT_FALSE(renderer.isSettled());
  // Sixteen frames of 16 paths: all have their 256.
  int frames = 1;
  for (IrradianceCache::Counts now = first; now.waiting > 0 && frames < 100; ++frames) now = frame(renderer, here);
  EXPECT_EQ(frames, 256 / s.of<IrradianceCacheSettings>().rays);
  renderer.render(here);
  EXPECT_TRUE(renderer.isSettled());
  const Image before = renderer.readRadiance();

  // A step aside: most of what is needed there is there already, with all its paths.
  const IrradianceCache::Counts moved = frame(renderer, there);
  EXPECT_FALSE(renderer.isSettled());
  Renderer fresh(context(), library(), scene, s);
  const IrradianceCache::Counts alone = frame(fresh, there);
  std::cout << "[ measured ] after a step aside " << moved.waiting << " records wait, " << alone.waiting
            << " without those kept\n";
  EXPECT_GT(moved.waiting, 0u);
  EXPECT_LT(moved.waiting, alone.waiting / 2);
  // And back: none waits.
  EXPECT_EQ(frame(renderer, here).waiting, 0u);
  // Those found on the way are neighbours of some, so the picture may change by noise, no more.
  EXPECT_LT(relativeError(renderer.readRadiance(), before), 0.05);

  renderer.forget();
  EXPECT_FALSE(renderer.isSettled());
  const IrradianceCache::Counts again = frame(renderer, here);
  EXPECT_EQ(again.records, first.records);
  EXPECT_EQ(again.waiting, first.waiting);
  Renderer other(context(), library(), scene, s);
  other.render(here);
  EXPECT_EQ(largestDifference(renderer.readRadiance(), other.readRadiance()), 0.0);
}

TEST_F(IrradianceCacheKept, WhatIsSeenAfterAMoveIsWhatIsSeenFromTheStart) {
  // Grids move by whole cells, records with them: none may turn up in another place, however far the way. Beside a
  // renderer that has seen nothing else.
  SceneBuilder builder = floorAlone();
  const int red = builder.material({0.5f, 0.1f, 0.1f});
  for (const double x : {-3.0, -1.0, 1.0, 3.0}) builder.plate({x, 0.5, 0.0}, {0, 1, 0}, {0, 0, 8}, red);
  RenderSettings s = settings(1, 256);
  s.of<IrradianceCacheSettings>().leastRays = 256;
  s.of<IrradianceCacheSettings>().mostChange = 0.0f;
  s.of<IrradianceCacheSettings>().cascades.cellSize = 0.5;
  s.of<IrradianceCacheSettings>().cascades.heldInScene = false;
  Renderer renderer(context(), library(), builder.scene(), s);
  double worst = 0.0;
  for (int i = 0; i < 12; ++i) {
    const Camera camera = lookingAt({-3.0 + 0.5 * i, 2.0, 3.0 - 0.4 * i}, {-3.0 + 0.5 * i, 0.0, 2.0 - 0.4 * i}, 0.7);
    renderer.render(camera);
    if (i % 3 != 2) continue;
    Renderer fresh(context(), library(), builder.scene(), s);
    fresh.render(camera);
    worst = std::max(worst, relativeError(renderer.readRadiance(), fresh.readRadiance()));
  }
  report("after a move, largest relative difference from what a new renderer shows", worst);
  EXPECT_LT(
      worst,
      0.03);  // other points of the same cells, where irradiance changes from a wall's foot to the middle between two
  EXPECT_GT(worst, 0.0);
  renderer.drain();
  EXPECT_EQ(cacheOf(renderer.technique())->counts().left, 0u);
}

/// Of a pixel, relative to what it was or, where it is dark, to the picture's mean.
double largestStep(const Image& a, const Image& b) {
  const glm::dvec3 mean = meanOf(a);
  double largest = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      largest =
          std::max(largest, std::abs(b.pixels[i][c] - a.pixels[i][c]) / std::max<double>(a.pixels[i][c], mean[c]));
  return largest;
}

// New records begin with what was seen in their place and move by at most cache.most-change of it a frame, until they
// show what a renderer without that bound shows.
TEST_F(IrradianceCacheKept, WhatIsSeenChangesByNoMoreThanTheBoundAndArrives) {
  const Scene scene = test::openBox();
  const Camera here = lookingAt({0.0, 0.5, 8.4}, {4.0, -4.0, -5.0}, 0.4);
  // The view stays and the volume moves, so that nothing but the volume changes the picture. What is seen stays in
  // view of the volume's wider camera.
  struct Walk {
    double largestStep = 0.0;
    Image last;
    int framesToArrive = 0;
  };
  const auto walk = [&](float mostChange) {
    RenderSettings s = settings(1, 16, Component::indirect);
    s.of<IrradianceCacheSettings>().leastRays = 16;  // noise of new records is what would be seen
    s.of<IrradianceCacheSettings>().mostChange = mostChange;
    s.of<IrradianceCacheSettings>().cascades.heldInScene = false;
    s.of<IrradianceCacheSettings>().cascades.cellSize =
        3.0;  // all of the box lies in the coarser grid, some of it in the finer one
    Renderer renderer(context(), library(), scene, s);
    Camera volume = lookingAt(here.position, {4.0, -4.0, -5.0}, 1.0);
    for (int i = 0; i < 3; ++i) renderer.render(here, volume), renderer.drain();
    Walk result;
    result.last = renderer.readRadiance();
    const auto look = [&] {
      renderer.render(here, volume);
      renderer.drain();
      const Image now = renderer.readRadiance();
      result.largestStep = std::max(result.largestStep, largestStep(result.last, now));
      result.last = now;
    };
    for (int i = 0; i < 60; ++i) {
      volume.position += glm::dvec3(0.01, 0.0, -0.04);
      look();
    }
    while (!renderer.isSettled() && result.framesToArrive < 800) {
      look();
      ++result.framesToArrive;
    }
    return result;
  };
  const Walk bounded = walk(0.0025f), free = walk(0.0f);
  report("largest relative change of a pixel in a frame", bounded.largestStep);
  report("without the bound", free.largestStep);
  report("frames until it has arrived", bounded.framesToArrive);
  EXPECT_GT(free.largestStep, 0.01);  // else there is nothing to bound
  // 0.0025, and the step by which the finer grid's blending moves over the coarser one.
  EXPECT_LT(bounded.largestStep, 0.0075);
  EXPECT_LT(bounded.framesToArrive, 650);  // 522 to fade in, and what is left of the changes
  EXPECT_LT(largestDifference(bounded.last, free.last), 1e-6);
}

// Cascades are blended by distance from the camera, so a turn of the camera moves grids and changes nothing.
TEST_F(IrradianceCacheKept, TurningChangesNothingThatIsSeen) {
  const Scene scene = test::openBox();
  const Camera narrow = lookingAt({0.0, 0.0, -0.2}, {0.0, 0.0, -5.0}, 0.4);
  RenderSettings s = settings(1, 64, Component::indirect);
  s.of<IrradianceCacheSettings>().cascades.cells = 32;
  s.of<IrradianceCacheSettings>().cascades.cellSize = 0.9;  // the finer grid fades out on the back wall
  s.of<IrradianceCacheSettings>().cascades.heldInScene = false;
  Renderer renderer(context(), library(), scene, s);
  const auto look = [&](double angle) {
    renderer.render(
        narrow, lookingAt(narrow.position, narrow.position + glm::dvec3(std::sin(angle), 0.0, -std::cos(angle)), 2.0));
    return renderer.readRadiance();
  };
  for (int i = 0; i < 400 && !(i > 2 && renderer.isSettled()); ++i) look(0.0), renderer.drain();
  Image before = look(0.0);
  double largest = 0.0;
  for (int i = 1; i <= 40; ++i) {
    const Image now = look(0.02 * i);
    largest = std::max(largest, largestStep(before, now));
    before = now;
  }
  report("largest relative change of a pixel in a turn by 0.02", largest);
  EXPECT_LT(largest, 1e-4);
}

// Surfaces around the camera have records before it turns to them, so a turn shows nothing that is just being found.
TEST_F(IrradianceCacheKept, ATurnShowsWhatWasKnownBefore) {
  // A ring of bays, lit by turns.
  SceneBuilder builder;
  const int grey = builder.material(glm::vec3(0.6f)), lamp = builder.material(glm::vec3(0.0f));
  builder.materialAt(lamp).emission = glm::vec3(8.0f);
  builder.plate({0, 0, 0}, {0, 0, 24}, {24, 0, 0}, grey);
  for (int i = 0; i < 18; ++i) {
    const double angle = glm::radians(20.0 * i);
    const glm::dvec3 out(std::sin(angle), 0.0, -std::cos(angle)), along(out.z, 0.0, -out.x);
    for (const double side : {1.0, -1.0})
      builder.plate(6.0 * out + glm::dvec3(0.0, 2.0, 0.0) + 0.02 * side * along, {0, 4, 0}, side * 6.0 * out, grey);
    if (i % 2 == 0) builder.plate(8.0 * out + 1.4 * along + glm::dvec3(0, 0.1, 0), 0.4 * out, 0.4 * along, lamp);
  }
  const Scene scene = builder.scene();
  struct Turn {
    double flicker = 0.0;
    std::uint64_t records = 0;
  };
  const auto turn = [&](int around) {
    RenderSettings s = settings(1, 64, Component::indirect);
    s.of<IrradianceCacheSettings>().prefetch = around;
    Renderer renderer(context(), library(), scene, s);
    const auto camera = [](int i) {
      const double yaw = glm::radians(2.0 * i);
      return lookingAt({0.0, 2.0, 0.5}, glm::dvec3(0.0, 2.0, 0.5) + glm::dvec3(std::sin(yaw), -0.2, -std::cos(yaw)),
                       0.6);
    };
    Turn result;
    for (int i = 0; i < 20; ++i) result.records = frame(renderer, camera(0)).records;
    for (int i = 1; i <= 45; ++i) {
      renderer.render(camera(i));
      const Image now = renderer.readRadiance();
      renderer.render(camera(i), camera(i - 1));
      result.flicker = std::max(result.flicker, measure::changeBetween(renderer.readRadiance(), now).block);
    }
    return result;
  };
  const Turn known = turn(1024), unknown = turn(0);
  report("largest relative change of a block in a turn", known.flicker);
  report("without points around the camera", unknown.flicker);
  EXPECT_LT(known.flicker, 0.01);
  EXPECT_GT(unknown.flicker, 0.01);
  EXPECT_GT(known.records, 2 * unknown.records);
}

// A record that is known to be much brighter than one beside it is given half the weight of others.
TEST_F(IrradianceCacheKept, WhatIsBrightBesideTheDarkIsAddedSlowly) {
  // Cells of 1 on a floor; a screen between x < 0, which is dark, and x > 0, which a lamp lights.
  SceneBuilder builder = test::inEnvironment(0.05f);
  const int grey = builder.material(glm::vec3(0.6f)), lamp = builder.material(glm::vec3(0.0f));
  builder.materialAt(lamp).emission = glm::vec3(40.0f);
  builder.plate({0, 0, 0}, {0, 0, 16}, {16, 0, 0}, grey);
  for (const double side : {1.0, -1.0}) builder.plate({0.02 * side, 3, 0}, {0, 6, 0}, {0, 0, side * 16}, grey);
  builder.plate({3, 4, 0}, {3, 0, 0}, {0, 0, 3}, lamp);
  RenderSettings s = settings(1, 256);
  s.of<IrradianceCacheSettings>().leastRays = 256;
  s.of<IrradianceCacheSettings>().cascades.cascades = 1;
  s.of<IrradianceCacheSettings>().cascades.cellSize = 1.0;
  s.of<IrradianceCacheSettings>().cascades.heldInScene = false;
  s.of<IrradianceCacheSettings>().prefetch = 0;
  Renderer renderer(context(), library(), builder.scene(), s);
  // A square of the floor, from above, below the lamp and beside the screen.
  const auto look = [&](double x, double side) {
    const glm::dvec3 floor(x, 0.0, 0.5);
    frame(renderer, lookingAt(floor + glm::dvec3(0.0, 3.0, 0.001), floor, 2.0 * std::atan(side / 6.0)));
  };
  look(-0.5, 0.2);
  for (int i = 0; i < 4; ++i) look(1.5, 0.2);
  look(1.5, 1.8);  // what comes into view now is new: x from 0.6 to 2.4
  std::map<int, IrradianceCache::Shown> floor;
  for (const IrradianceCache::Shown& record : cacheOf(renderer.technique())->shown())
    if (record.face == 2 && record.cell.z == 0) floor.emplace(record.cell.x, record);
  ASSERT_TRUE(floor.contains(-1) && floor.contains(0) && floor.contains(2));
  report("bright over dark", floor.at(0).irradiance.x / floor.at(-1).irradiance.x);
  EXPECT_GT(floor.at(0).irradiance.x, 4.0f * floor.at(-1).irradiance.x);
  EXPECT_GT(floor.at(-1).blendWeight, floor.at(2).blendWeight);
  EXPECT_GT(floor.at(2).blendWeight, 0.0f);
  EXPECT_FLOAT_EQ(floor.at(0).blendWeight, 0.5f * floor.at(2).blendWeight);
}

// In a closed cube every cell of every wall has a record in the coarsest cascades, in view or not, at a point of that
// wall; the finer ones have those of what is seen.
TEST_F(IrradianceCacheKept, SurfacesAllAroundHaveRecords) {
  const Scene scene = furnace(glm::vec3(0.5f), glm::vec3(1.0f));
  RenderSettings s = settings(1, 16);
  s.of<IrradianceCacheSettings>().cascades.cascades = 3;
  s.of<IrradianceCacheSettings>().cascades.cellSize =
      0.42;  // 0.21, 0.105: a wall of 2 by 2 is cut into 6 by 6 and 10 by 10 cells
  const auto count = [&](int around) {
    s.of<IrradianceCacheSettings>().prefetch = around;
    Renderer renderer(context(), library(), scene, s);
    renderer.render(lookingAt({0.05, 0.02, 0.03}, {1.0, 0.1, 0.1}, 0.2));
    renderer.drain();
    std::array<std::array<int, 6>, 3> counts{};
    for (const IrradianceCache::Shown& r : cacheOf(renderer.technique())->shown()) {
      const int axis = r.face / 2;
      const float sign = r.face % 2 == 0 ? 1.0f : -1.0f;
      EXPECT_NEAR(r.normal[axis], sign, 1e-5);
      EXPECT_NEAR(r.position[axis], -sign, 1e-5);
      ++counts[static_cast<std::size_t>(r.cascade)][static_cast<std::size_t>(r.face)];
    }
    return counts;
  };
  const auto all = count(4096), seen = count(0);
  for (std::size_t face = 0; face < 6; ++face) {
    EXPECT_EQ(all[2][face], 36) << face;
    EXPECT_EQ(all[1][face], 100) << face;
    EXPECT_EQ(all[0][face], seen[0][face]) << face;
    EXPECT_EQ(seen[1][face] > 0 || seen[0][face] > 0, face == 1) << face;  // the wall at x = 1 faces -x
  }
}

// A record that finds no light at all, where light was shown before, gets there and needs no more frames: a share of
// itself per frame alone would never be nothing.
TEST_F(IrradianceCacheKept, WhatTurnsOutBlackArrives) {
  SceneBuilder builder;
  const int white = builder.material(glm::vec3(0.8f));
  builder.plate({0, 0, 0}, {0, 0, 8}, {8, 0, 0}, white);
  builder.plate({0.01, 1, 0}, {0, 2, 0}, {0, 0, 8}, white);  // a wall: beyond it the floor sees nothing that is lit
  builder.plate({-0.01, 1, 0}, {0, 0, 8}, {0, 2, 0}, white);
  builder.sun({-1.0, -1.0, 0.0}, glm::vec3(3.0f));
  RenderSettings s = settings(1, 64, Component::indirect);
  s.of<IrradianceCacheSettings>().prefetch = 0;
  s.of<IrradianceCacheSettings>().mostChange = 0.01f;
  Renderer renderer(context(), library(), builder.scene(), s);
  const auto look = [&](double x) { frame(renderer, lookingAt({0, 6, 0}, {x, 0, 0}, 0.1)); };
  const auto settle = [&](double x) {
    int frames = 0;
    for (; !(frames > 2 && renderer.isSettled()) && frames < 1500; ++frames) look(x);
    return frames;
  };
  EXPECT_LT(settle(0.8), 1000);
  EXPECT_GT(brightnessOf(renderer), 0.01);
  for (const double x : {0.4, 0.0, -0.4, -0.8}) look(x);  // here cells have records of both sides
  const int frames = settle(-1.2);
  report("frames until black", frames);
  EXPECT_GT(frames, 100);  // light was shown there first
  EXPECT_LT(frames, 1500);
  EXPECT_EQ(brightnessOf(renderer), 0.0);
}

// Records with few paths still are enough of the finest cascade: coarser ones do not take their place.
TEST_F(IrradianceCacheKept, AFewPathsAreEnoughOfACascade) {
  const Scene scene = test::openBox();
  RenderSettings s = settings(1, 4);
  s.of<IrradianceCacheSettings>().rays = s.of<IrradianceCacheSettings>().leastRays = 4;
  Renderer renderer(context(), library(), scene, s);
  const Camera camera = lookingAt({0.5, 0.3, -3.0}, {0.3, 0.2, -5.0}, 0.9);
  renderer.renderToTheEnd(lookingAt({0.5, 0.3, 12.0}, {0.3, 0.2, -5.0}, 0.9));  // finds those of the coarser one
  renderer.renderToTheEnd(camera);
  int records = 0;
  for (const glm::ivec2& pixel : {glm::ivec2(20, 20), glm::ivec2(32, 32), glm::ivec2(41, 13)})
    for (const PixelShare& share : renderer.inspect(library(), camera, pixel).shares) {
      if (!share.name.starts_with("record")) continue;
      ++records;
      EXPECT_TRUE(share.name.ends_with("cascade 1")) << share.name << " " << share.weight.value_or(0.0);
    }
  EXPECT_GE(records, 6);
}

// Between cascades four times apart in brightness, what is shown changes by the same share of itself wherever the
// camera is. A share s of the finer one leaves at least 1 + 3 min(s, 1 - s) of the darker one's light, so ds/dt over
// that is constant.
TEST_F(IrradianceCacheKept, CascadesAreBlendedEvenly) {
  SceneBuilder builder = test::inEnvironment(1.0f);
  builder.plate({0, 0, 0}, {0, 0, 40}, {40, 0, 0}, builder.material(glm::vec3(0.5f)));
  const Scene scene = builder.scene();
  RenderSettings s = settings(1, 64);
  s.of<IrradianceCacheSettings>().cascades.cellSize = 2.0;
  s.of<IrradianceCacheSettings>().cascades.heldInScene = false;
  Renderer renderer(context(), library(), scene, s);
  const Camera camera = lookingAt({0.1, 1.5, 0.2}, {0.1, 0.0, -6.0}, 0.9);
  renderer.renderToTheEnd(camera);
  const double reach =
      placeCascadesAround(s.of<IrradianceCacheSettings>().cascades, scene.bounds, camera, 1.0)[0].reach;
  const auto wayTo = [](double share) {
    constexpr int kSteps = 10000;
    double way = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double x = share * (i + 0.5) / kSteps;
      way += share / kSteps / (1.0 + 3.0 * std::min(x, 1.0 - x));
    }
    return way;
  };
  int between = 0;
  double worst = 0.0;
  for (int y = 24; y < 64; ++y) {
    const PixelInspection answer = renderer.inspect(library(), camera, {32, y});
    double finer = 0.0, all = 0.0;
    for (const PixelShare& share : answer.shares)
      if (share.name.starts_with("record")) {
        all += share.weight.value();
        if (share.name.ends_with("cascade 1")) finer += share.weight.value();
      }
    if (finer < 0.02 || finer > 0.98) continue;
    ++between;
    EXPECT_NEAR(all, 1.0, 1e-5);
    const double way = (reach - glm::distance(answer.surface.value().position, camera.position)) / reach / 0.5;
    worst = std::max(worst, std::abs(wayTo(finer) / wayTo(1.0) - way));
  }
  report("way through the band, largest difference", worst);
  EXPECT_GE(between, 8);
  EXPECT_LT(worst, 1e-3);
}

TEST_F(IrradianceCacheKept, WithoutRoomRecordsAreLeftOutAndCounted) {
  // Triangles that face every way in every cell of a small grid, seen from all sides: more slots are asked for than
  // there is room (24 of a grid's 6 cells^3 by cells^2).
  SceneBuilder builder = test::inEnvironment(1.0f);
  const int grey = builder.material(glm::vec3(0.5f));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 p(uniform(random), uniform(random), uniform(random));
    const auto corner = [&] { return p + 0.035 * glm::dvec3(uniform(random), uniform(random), uniform(random)); };
    builder.triangle(corner(), corner(), corner(), grey);
  }
  RenderSettings s = settings(1, 16, Component::all, 128);
  s.of<IrradianceCacheSettings>().cascades.cells = 12;
  s.of<IrradianceCacheSettings>().cascades.cascades = 1;
  s.of<IrradianceCacheSettings>().cascades.cellSize = 2.1 / 12.0;
  Renderer renderer(context(), library(), builder.scene(), s);
  IrradianceCache::Counts counts;
  for (const glm::dvec3& from : {glm::dvec3(4, 0, 0), glm::dvec3(-4, 0.1, 0), glm::dvec3(0, 4, 0),
                                 glm::dvec3(0, -4, 0.1), glm::dvec3(0.1, 0, 4), glm::dvec3(0, 0.1, -4)}) {
    counts = frame(renderer, lookingAt(from, {0, 0, 0}, 0.55));
    for (const glm::vec3& p : renderer.readRadiance().pixels) {
      ASSERT_TRUE(std::isfinite(p.x));
      if (p.x != 1.0f) {  // the sky itself
        ASSERT_LE(p.x, 0.5f + 1e-4f);
      }
    }
  }
  report("records", static_cast<double>(counts.records));
  report("without room", static_cast<double>(counts.left));
  EXPECT_EQ(counts.records, 24u * 12u * 12u);
  EXPECT_GT(counts.left, 0u);
}

TEST_F(IrradianceCacheKept, TinyAndHugeGridsAreDrawn) {
  for (const auto& [cells, cascades] : {std::pair{2, 4}, std::pair{3, 3}, std::pair{64, 1}}) {
    SceneBuilder builder = floorAlone();
    RenderSettings s = settings(1, 16, Component::direct);
    s.of<IrradianceCacheSettings>().cascades.cells = cells;
    s.of<IrradianceCacheSettings>().cascades.cascades = cascades;
    for (const glm::vec3& p : picture(builder.scene(), kAboveFloor, s).image.pixels)
      ASSERT_NEAR(p.x, 0.5f, 1e-5f) << cells << " " << cascades;
  }
}

// The window's debug view draws a disk on each record: at its place in the picture, in the colour of its irradiance,
// and nowhere else. demo/shared/glyphs.cpp.
TEST_F(IrradianceCacheGl, AreDrawnAsDisksWhereTheyAre) {
  const glm::dvec3 albedo(0.5, 0.5, 0.5), emission(1.0, 0.5, 0.1);
  const Scene scene = furnace(glm::vec3(albedo), glm::vec3(emission));
  RenderSettings s = settings(kAll, 256);
  s.size = glm::ivec2(256);
  Renderer renderer(context(), library(), scene, s);
  renderer.renderToTheEnd(kInside);
  const std::vector<IrradianceCache::Shown> records = cacheOf(renderer.technique())->shown();
  ASSERT_GT(records.size(), 50u);
  const glm::dvec3 irradiance = kPi * emission / (1.0 - albedo);
  for (const IrradianceCache::Shown& record : records) {
    const glm::vec3 place = glm::abs(record.position + glm::vec3(renderer.origin()));
    EXPECT_NEAR(std::max({place.x, place.y, place.z}), 1.0f, 1e-4f);
    EXPECT_NEAR(glm::dot(record.normal, record.position + glm::vec3(renderer.origin())), -1.0f, 1e-3f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(record.irradiance[c] / irradiance[c], 1.0, 0.2);
  }

  // All of the coarsest cascade, over black.
  const auto lines = demo::glyphsOf(demo::Glyphs::records, renderer, scene, kInside, 1, 5000);
  const gl::Texture picture("glyphs", gl::Format::rgba8, s.size);
  const std::array<const gl::Texture*, 1> colors{&picture};
  const gl::Framebuffer target("glyphs", colors);
  { gl::RasterPass("black", target, {}).clearColor(0, glm::vec4(0.0f, 0.0f, 0.0f, 1.0f)); }
  gl::Lines::View view = renderer.linesView(kInside, scene.bounds);
  view.depth = nullptr;
  const glm::vec2 size(s.size);
  gl::Lines(library()).draw(target, {{0, 0}, s.size, 0.5f * size, glm::vec2(0.5f), size}, view, lines, 1.0f);
  const std::vector<glm::vec4> texels = picture.readRgba();
  std::vector<bool> near(texels.size());
  const double cell =
      placeCascades(s.of<IrradianceCacheSettings>().cascades, scene.bounds, kInside.position, kInside.direction)[1]
          .cellSize;
  int drawn = 0, dark = 0;
  for (const IrradianceCache::Shown& record : records) {
    const glm::vec4 clip = view.clipFromWorld * glm::vec4(record.position, 1.0f);
    const glm::vec2 at = (0.5f * glm::vec2(clip) / clip.w + 0.5f) * size;
    if (record.cascade != 1 || clip.w <= 0.0f || at.x < 0.0f || at.y < 0.0f || at.x >= size.x || at.y >= size.y)
      continue;
    ++drawn;
    const glm::vec4& seen = texels[static_cast<std::size_t>(at.y) * 256 + static_cast<std::size_t>(at.x)];
    dark += seen.x < 0.7f;
    if (seen.x >= 0.7f) { EXPECT_NEAR(seen.y, std::pow(0.5, 1.0 / 2.2) * static_cast<double>(seen.x), 0.12); }
    // Where its disk may be: as far as its rim, and a line's width.
    const glm::vec3 u = glm::normalize(
                        glm::cross(record.normal, glm::vec3(record.normal.y, record.normal.z, record.normal.x))),
                    v = glm::cross(record.normal, u);
    float farthest = 0.0f;
    for (double angle = 0.0; angle < 2.0 * kPi; angle += 0.2) {
      const glm::vec3 rim =
          record.position + 0.21f * static_cast<float>(cell) *
                                (static_cast<float>(std::cos(angle)) * u + static_cast<float>(std::sin(angle)) * v);
      const glm::vec4 there = view.clipFromWorld * glm::vec4(rim, 1.0f);
      farthest = there.w > view.near
                     ? std::max(farthest, glm::length((0.5f * glm::vec2(there) / there.w + 0.5f) * size - at))
                     : size.x;
    }
    const int reach = static_cast<int>(std::min(farthest, size.x)) + 3;
    for (int y = static_cast<int>(at.y) - reach; y <= static_cast<int>(at.y) + reach; ++y)
      for (int x = static_cast<int>(at.x) - reach; x <= static_cast<int>(at.x) + reach; ++x)
        if (x >= 0 && y >= 0 && x < 256 && y < 256)
          near[static_cast<std::size_t>(y) * 256 + static_cast<std::size_t>(x)] = true;
  }
  EXPECT_GT(drawn, 40);
  EXPECT_LE(dark, drawn / 20) << "of " << drawn << ": below another one's rim";
  int stray = 0, lit = 0;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    lit += texels[i].x > 0.3f;
    stray += texels[i].x > 0.3f && !near[i];
  }
  EXPECT_GT(lit, drawn);
  EXPECT_LT(lit, static_cast<int>(texels.size()) / 2);
  EXPECT_EQ(stray, 0);
}

}  // namespace
}  // namespace lucerna
