// What coats, mirrors and glass show in the technique irradiance-cache: known answers, and the path tracer's pictures.
#include "irradiance_cache/settings.hpp"
#include "support/coat_reference.hpp"
#include "support/media_reference.hpp"
#include "support/media_scenes.hpp"
#include "support/path_scenes.hpp"
#include "support/pixel_rays.hpp"
#include "support/small_scenes.hpp"

#include "base/angles.hpp"
#include "base/log.hpp"
#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace lucerna::test {
namespace {

class ReflectionsTest : public PathTest {
 protected:
  static RenderSettings settings(std::string_view technique = "irradiance-cache") {
    RenderSettings s;
    s.technique = technique;
    s.size = {32, 32};
    s.fullFloatTarget = true;
    return s;
  }
  static Image drawn(const Scene& scene, const Camera& camera, const RenderSettings& s = settings()) {
    Renderer renderer(context(), library(), scene, s);
    renderer.renderToTheEnd(camera);
    return renderer.readRadiance();
  }
  Image traced(const Scene& scene, const Camera& camera, std::uint32_t samples) {
    PathTracer::Settings s = sized(32);
    s.filter = PixelFilter::centre;
    return tracer(scene, camera, s, samples).mean();
  }
  /// A floor of one material under a sky of one radiance.
  static SceneBuilder floorUnderSky(const Material& material, float radiance) {
    SceneBuilder builder;
    const int floor = builder.material(material.diffuse);
    const std::string name = builder.materialAt(floor).name;
    builder.materialAt(floor) = material;
    builder.materialAt(floor).name = name;
    builder.plate({0, 0, 0}, {0, 0, 40}, {40, 0, 0}, floor);
    builder.scene().sun.reset();
    builder.scene().environment.emplace().radiance = glm::vec3(radiance);
    return builder;
  }
  static Material coated(const glm::vec3& base, const glm::vec3& specular, float alpha, Bsdf bsdf = Bsdf::diffuse) {
    Material material;
    material.bsdf = bsdf;
    material.diffuse = base;
    material.specular = specular;
    material.roughness = alpha;
    return material;
  }
};

TEST_F(ReflectionsTest, AMirrorShowsTheSky) {
  const Camera camera = lookingAt({0, 2, 4}, {0, 0, 0}, 0.3);
  const Image image =
      drawn(floorUnderSky(coated(glm::vec3(0.5f), {0.9f, 0.6f, 0.3f}, 0.0f, Bsdf::mirror), 2.0f).scene(), camera);
  for (const glm::vec3& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(pixel[c], 2.0f * glm::vec3(0.9f, 0.6f, 0.3f)[c], 1e-4f);
}

// Of every roughness: rays, rays and records, records alone. A pixel's samples share its rays.
TEST_F(ReflectionsTest, CoatsReflectAnEvenSkyByTheirAlbedo) {
  const double angle = 0.8;
  const Camera camera = lookingAt({4.0 * std::sin(angle), 4.0 * std::cos(angle), 0}, {0, 0, 0}, 0.05);
  for (const float alpha : {0.001f, 0.1f, 0.35f, 0.8f})
    for (const float base : {0.0f, 0.6f})
      for (const auto& [samples, rays] : {std::pair(1, 64), std::pair(16, 24), std::pair(16, 4)}) {
        RenderSettings s = settings();
        s.pixelSamples = samples;
        s.of<IrradianceCacheSettings>().reflections = rays;
        const glm::dvec3 seen =
            meanOf(drawn(floorUnderSky(coated(glm::vec3(base), {0.04f, 0.3f, 0.9f}, alpha), 1.0f).scene(), camera, s));
        const reference::CoatedSurface surface(glm::dvec3(base), {0.04, 0.3, 0.9}, static_cast<double>(alpha));
        const glm::dvec3 coat = surface.albedo(std::cos(angle));
        for (int c = 0; c < 3; ++c) {
          const double expected = coat[c] + static_cast<double>(base) * (1.0 - coat[c]);
          EXPECT_NEAR(seen[c], expected, 0.01 * expected + 1e-3) << alpha << " " << base << " " << c << " " << rays;
        }
      }
}

// Strips of a pixel's width, seen from a view in motion. The samples of a frame share what a coat's rays find: no less
// light comes from pixels whose first sample falls beside the coat, and no more.
TEST_F(ReflectionsTest, InMotionCoatsOfPartOfAPixelReflectTheirShare) {
  constexpr double kStrip = 0.1;
  SceneBuilder builder;
  const int coat = builder.material(glm::vec3(0.0f)), matt = builder.material(glm::vec3(0.0f));
  builder.materialAt(coat).specular = glm::vec3(0.5f);
  builder.materialAt(coat).roughness = 0.1f;
  for (int i = -40; i <= 40; ++i) builder.plate({2.0 * kStrip * i, 0, 0}, {0, 0, 4}, {0.5 * kStrip, 0, 0}, coat);
  builder.plate({0, -0.01, 0}, {0, 0, 4}, {4, 0, 0}, matt);
  builder.scene().sun.reset();
  builder.scene().environment.emplace().radiance = glm::vec3(1.0f);
  const auto viewAt = [](double x) { return lookingAt({x, 4, 0.01}, {x, 0, 0}, 0.6); };
  const auto meanInMotion = [&](int samples) {
    RenderSettings s = settings();
    s.pixelSamples = 16;
    s.motionSamples = samples;
    s.reprojection = false;
    Renderer renderer(context(), library(), builder.scene(), s);
    renderer.renderToTheEnd(viewAt(0.0));
    double sum = 0.0;
    const int frames = 128 / samples;
    for (int frame = 1; frame <= frames; ++frame) {
      renderer.render(viewAt(8.13 * kStrip * frame / frames));
      sum += meanOf(renderer.readRadiance()).y;
    }
    return sum / frames;
  };
  EXPECT_NEAR(meanInMotion(4) / meanInMotion(1), 1.0, 0.01);
}

// A ball of glass hides nothing of an even sky: what it does not reflect, it lets through.
TEST_F(ReflectionsTest, GlassIsClear) {
  Scene scene;
  addSphere(scene, glm::dvec3(0.0), 1.0, 4, addBoundary(scene, Bsdf::dielectric, 1.5, -1));
  scene.environment.emplace().radiance = glm::vec3(3.0f);
  const Image image = drawn(scene, lookingAt({0, 0, 6}, {0, 0, 0}, 0.25));
  EXPECT_NEAR(image.at(16, 16).y, 3.0f, 1e-3f);
  EXPECT_NEAR(meanOf(image).y, 3.0, 0.02);  // at the rim some rays are caught inside
}

// A small bright lamp beside a rough floor: a ray in twenty meets it. Neighbours share what they find, which moves no
// light from the picture and none to a floor of another coat.
TEST_F(ReflectionsTest, RoughCoatsHaveNoSpecks) {
  SceneBuilder builder = floorUnderSky(coated(glm::vec3(0.0f), glm::vec3(0.5f), 0.2f), 0.0f);
  builder.scene().environment.reset();
  const int lamp = builder.material(glm::vec3(0.0f)), matt = builder.material(glm::vec3(0.0f));
  builder.materialAt(lamp).emission = glm::vec3(100.0f);
  builder.plate({0.0, 1.5, -2.5}, {0.8, 0, 0}, {0, 0.8, 0}, lamp);
  builder.plate({0.4, 0.001, 0.0}, {0, 0, 8}, {0.6, 0, 0}, matt);
  const Camera camera = lookingAt({0, 2, 3}, {0, 0, 0}, 0.5);
  const auto shown = [&](int rays) {
    RenderSettings s = settings();
    s.size = {64, 64};
    s.of<IrradianceCacheSettings>().reflections = rays;
    return drawn(builder.scene(), camera, s);
  };
  const Image few = shown(16), many = shown(1024);
  double squares = 0.0, all = 0.0;
  for (std::size_t i = 0; i < few.pixels.size(); ++i) {
    squares += std::pow(static_cast<double>(few.pixels[i].y) - static_cast<double>(many.pixels[i].y), 2.0);
    all += std::pow(static_cast<double>(many.pixels[i].y), 2.0);
    if (many.pixels[i].y == 0.0f) { EXPECT_EQ(few.pixels[i].y, 0.0f); }
  }
  std::cout << "[ measured ] rough coat, 16 rays beside 1024: " << std::sqrt(squares / all) << ", mean "
            << meanOf(few).y / meanOf(many).y << "\n";
  EXPECT_LT(std::sqrt(squares / all), 0.25);
  EXPECT_NEAR(meanOf(few).y / meanOf(many).y, 1.0, 0.03);
}

// A wall that only a mirror shows, so that no record lies on it, beside a small lamp: paths that happen to meet the
// lamp alone would be a few bright specks.
TEST_F(ReflectionsTest, AWallWithoutRecordsBesideASmallLampHasNoSpecks) {
  constexpr double kRadiance = 200.0, kSide = 0.2, kReflectance = 0.5, kMirror = 0.8;
  const glm::dvec3 lampAt(1.5, 0.0, 6.0);  // 2 before the wall at z = 8, which faces the mirror at z = 0
  SceneBuilder builder;
  const int mirror = builder.material(glm::vec3(0.0f)),
            wall = builder.material(glm::vec3(static_cast<float>(kReflectance))),
            lamp = builder.material(glm::vec3(0.0f));
  builder.materialAt(mirror).bsdf = Bsdf::mirror;
  builder.materialAt(mirror).specular = glm::vec3(static_cast<float>(kMirror));
  builder.materialAt(lamp).emission = glm::vec3(kRadiance);
  builder.plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, mirror);
  builder.plate({0, 0, 8}, {0, 9, 0}, {9, 0, 0}, wall);
  builder.plate(lampAt, {kSide, 0, 0}, {0, kSide, 0}, lamp);
  builder.scene().sun.reset();
  const Camera camera = lookingAt({0, 0, 4}, {0, 0, 0}, 0.1);
  RenderSettings s = settings();
  s.of<IrradianceCacheSettings>().prefetch = 0;
  const Image image = drawn(builder.scene(), camera, s);
  const double rise = 2.0 * std::tan(0.05) / s.size.y;  // of a pixel's ray, per length
  double squares = 0.0, sum = 0.0;
  for (int y = 0; y < s.size.y; ++y)
    for (int x = 0; x < s.size.x; ++x) {
      // Where the pixel's ray meets the wall, 12 from the camera by way of the mirror.
      const glm::dvec3 at(12.0 * rise * (x + 0.5 - s.size.x / 2.0), 12.0 * rise * (s.size.y / 2.0 - y - 0.5), 8.0);
      const glm::dvec3 away = lampAt - at;
      const double r2 = glm::dot(away, away), cosine = -away.z / std::sqrt(r2);
      const double expected = kMirror * kReflectance / kPi * kRadiance * kSide * kSide * cosine * cosine / r2;
      const double off = static_cast<double>(image.at(x, y).y) / expected - 1.0;
      squares += off * off;
      sum += off;
    }
  const auto pixels = static_cast<double>(image.pixels.size());
  std::cout << "[ measured ] wall seen in a mirror: bias " << sum / pixels << ", relative error "
            << std::sqrt(squares / pixels) << "\n";
  EXPECT_NEAR(sum / pixels, 0.0, 0.02);  // the mirror throws 0.5 % back
  EXPECT_LT(std::sqrt(squares / pixels), 0.1);
}

// A level floor under level water, in the sun: light enters once, is reflected by the floor, and what the surface
// throws back from below lights the floor again. Rays are thrown back beyond the critical angle alone.
TEST_F(ReflectionsTest, AFloorUnderWaterIsLit) {
  constexpr double kIor = 1.333, kAlbedo = 0.3, kSun = 2.0, kAngle = 0.7;
  const auto enters = [](double cosine) { return 1.0 - reference::fresnel(cosine, 1.0 / kIor); };
  const double thrownBack = 1.0 - 1.0 / (kIor * kIor);
  const double expected =
      enters(1.0) * kAlbedo / kPi * kSun * std::cos(kAngle) * enters(std::cos(kAngle)) / (1.0 - kAlbedo * thrownBack);
  for (const bool hasSun : {true, false}) {
    SceneBuilder builder;
    const int floor = builder.material(glm::vec3(static_cast<float>(kAlbedo))),
              water = builder.material(glm::vec3(0.0f));
    builder.materialAt(water).bsdf = Bsdf::dielectric;
    builder.materialAt(water).ior = static_cast<float>(kIor);
    builder.plate({0, 0, 0}, {0, 0, 40}, {40, 0, 0}, floor);
    builder.plate({0, 1, 0}, {0, 0, 40}, {40, 0, 0}, water);
    Scene& scene = builder.scene();
    scene.sun.reset();
    const glm::dvec3 towards(std::sin(kAngle), std::cos(kAngle), 0.0);
    if (hasSun) {
      scene.sun.emplace();
      scene.sun->direction = glm::vec3(-towards);
      scene.sun->irradiance = glm::vec3(kSun);
    } else {  // as far as to give the same light
      const int lamp = builder.material(glm::vec3(0.0f));
      constexpr double kFar = 400.0, kSide = 4.0;
      builder.materialAt(lamp).emission = glm::vec3(static_cast<float>(kSun * kFar * kFar / (kSide * kSide)));
      builder.plate(kFar * towards, {kSide * std::cos(kAngle), -kSide * std::sin(kAngle), 0}, {0, 0, -kSide}, lamp);
    }
    RenderSettings s = settings();
    s.of<IrradianceCacheSettings>().prefetch = 0;
    s.of<IrradianceCacheSettings>().cascades.cellSize = 0.25;  // the water's records do not reach the floor
    const Image image = drawn(scene, lookingAt({0, 4, 0.01}, {0, 0, 0}, 0.1), s);
    std::cout << "[ measured ] floor under water: " << meanOf(image).y / expected << "\n";
    EXPECT_NEAR(meanOf(image).y / expected, 1.0, 0.03) << hasSun;
  }
}

/// The open box with a back wall that reflects.
Scene boxWithMirror(const Material& wall) {
  Scene scene = openBox();
  scene.materials.push_back(wall);
  scene.meshes[1].material = static_cast<int>(scene.materials.size()) - 1;
  return scene;
}

// The sunlit box in a mirror and in metal: direct light at the ends of rays, and the records' light. They are dim: what
// they throw on other walls is another light in the path tracer.
TEST_F(ReflectionsTest, AWallShowsTheBoxAsThePathTracerDoes) {
  for (const float alpha : {0.0f, 0.15f}) {
    const Scene scene = boxWithMirror(coated(glm::vec3(0.0f), glm::vec3(0.3f), alpha, Bsdf::conductor));
    RenderSettings s = settings();
    s.of<IrradianceCacheSettings>().reflections = 16;
    const Image image = drawn(scene, openBoxCamera(), s), expected = traced(scene, openBoxCamera(), 512);
    double squares = 0.0, all = 0.0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const glm::dvec3 off = glm::dvec3(image.pixels[i]) - glm::dvec3(expected.pixels[i]);
      squares += glm::dot(off, off);
      all += glm::dot(glm::dvec3(expected.pixels[i]), glm::dvec3(expected.pixels[i]));
    }
    EXPECT_LT(std::sqrt(squares / all), 0.15) << alpha;
    const double ratio = meanOf(image).y / meanOf(expected).y;
    EXPECT_NEAR(ratio, 1.0, 0.04) << alpha;
  }
}

// What the mirror shows of walls under a sky alone is the records' light, in the middle of the picture.
TEST_F(ReflectionsTest, AMirrorShowsTheRecords) {
  Scene scene = boxWithMirror(coated(glm::vec3(0.0f), glm::vec3(0.3f), 0.0f, Bsdf::conductor));
  scene.sun.reset();
  scene.environment.emplace().radiance = glm::vec3(0.4f);
  const RenderSettings s = settings();
  PathTracer::Settings path = sized(32);
  path.filter = PixelFilter::centre;
  const Image image = drawn(scene, openBoxCamera(), s), expected = tracer(scene, openBoxCamera(), path, 1024).mean();
  double sum = 0.0, all = 0.0;
  for (int y = 12; y < 20; ++y)
    for (int x = 12; x < 20; ++x) {
      sum += static_cast<double>(image.at(x, y).y);
      all += static_cast<double>(expected.at(x, y).y);
    }
  EXPECT_GT(all, 0.0);
  EXPECT_NEAR(sum / all, 1.0, 0.05);
}

// Rays to two lamps of nine, chosen by what they would give: unhidden ones exactly, those behind a plate on average.
TEST_F(ReflectionsTest, AMirrorShowsTheLightOfManyLamps) {
  for (const bool hides : {false, true}) {
    SceneBuilder builder;
    const int wall = builder.material(glm::vec3(0.02f)),  // hardly any light is reflected twice
        mirror = builder.material(glm::vec3(0.0f)), black = builder.material(glm::vec3(0.0f));
    builder.materialAt(mirror) = coated(glm::vec3(0.0f), glm::vec3(0.8f), 0.0f, Bsdf::mirror);
    builder.plate({0, 0, 0}, {8, 0, 0}, {0, 8, 0}, mirror);
    builder.plate({0, 0, 6}, {0, 8, 0}, {8, 0, 0}, wall);  // behind the camera
    if (hides) builder.plate({0, 1.2, 4}, {0, 1.0, 0}, {8, 0, 0}, black);
    Scene scene = builder.scene();
    scene.sun.reset();
    for (int i = 0; i < 9; ++i) {
      const double x = 0.4 * (i - 4);
      scene.points.push_back({{x, i % 2 == 0 ? 2.4 : -0.5, 3.0 - 0.1 * i}, glm::vec3(static_cast<float>(1 + i % 3))});
    }
    const Camera camera = lookingAt({0, 0, 2}, {0, 0, 0}, 0.5);
    RenderSettings s = settings();
    s.pixelSamples = 16;
    const Image image = drawn(scene, camera, s), expected = tracer(scene, camera, sized(32), 256).mean();
    double sum = 0.0, all = 0.0, worst = 0.0;
    for (std::size_t k = 0; k < image.pixels.size(); ++k) {
      const double is = static_cast<double>(image.pixels[k].y), should = static_cast<double>(expected.pixels[k].y);
      sum += is, all += should;
      worst = std::max(worst, std::abs(is - should));
    }
    EXPECT_NEAR(sum / all, 1.0, 4e-3) << hides;
    EXPECT_LT(worst, (hides ? 0.8 : 0.06) * all / static_cast<double>(image.pixels.size())) << hides;
  }
}

TEST_F(ReflectionsTest, AllIsDirectPlusIndirect) {
  Scene scene = boxWithMirror(coated(glm::vec3(0.0f), glm::vec3(0.9f), 0.0f, Bsdf::mirror));
  scene.environment.emplace().radiance = glm::vec3(0.4f);
  glm::dvec3 parts[3];
  for (const Component component : {Component::all, Component::direct, Component::indirect}) {
    RenderSettings s = settings();
    s.component = component;
    s.of<IrradianceCacheSettings>().samples = 2048;
    parts[static_cast<int>(component)] = meanOf(drawn(scene, openBoxCamera(), s));
  }
  const glm::dvec3 all = parts[static_cast<int>(Component::all)],
                   sum = parts[static_cast<int>(Component::direct)] + parts[static_cast<int>(Component::indirect)];
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], all[c], 0.02 * all[c]) << c;
}

TEST_F(ReflectionsTest, NothingOfThemIsThereUnlessNeeded) {
  const auto left = [](const Scene& scene, int rays) {
    RenderSettings s = settings();
    s.of<IrradianceCacheSettings>().reflections = rays;
    const std::vector<std::string> names = Renderer(context(), library(), scene, s).leftOut();
    return std::ranges::count(names, "reflections") == 1;
  };
  const Scene shiny = boxWithMirror(coated(glm::vec3(0.3f), glm::vec3(0.04f), 0.2f));
  EXPECT_TRUE(left(openBox(), 4));
  EXPECT_TRUE(left(shiny, 0));
  EXPECT_FALSE(left(shiny, 4));
}

// A technique that does not draw what metals and glass reflect says so, by name.
TEST_F(ReflectionsTest, ATechniqueWithoutThemNamesTheMaterials) {
  Scene scene = boxWithMirror(coated(glm::vec3(0.0f), glm::vec3(0.9f), 0.1f));
  scene.materials.back().name = "chrome";
  const auto warned = [&](std::string_view technique) {
    clearLoggedWarnings();
    const Renderer renderer(context(), library(), scene, settings(technique));
    const std::vector<std::string> warnings = loggedWarnings();
    return std::ranges::any_of(warnings, [](const std::string& w) { return w.find("'chrome'") != std::string::npos; });
  };
  EXPECT_TRUE(warned("direct"));
  EXPECT_TRUE(warned("rsm"));
  EXPECT_FALSE(warned("irradiance-cache"));
}

TEST_F(ReflectionsTest, CausticsThatAreLeftOutAreSaid) {
  SceneBuilder builder;
  builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, builder.material(glm::vec3(0.5f)));
  const int pane = builder.material(glm::vec3(0.0f));
  builder.materialAt(pane).name = "pane";
  builder.materialAt(pane).bsdf = Bsdf::dielectric;
  builder.plate({0, 1, 0}, {0, 0, 4}, {4, 0, 0}, pane);
  Scene& scene = builder.scene();
  scene.cameras = {test::lookingAt({0, 0.5, 2}, {0, 0, 0})};
  const auto said = [&] {
    clearLoggedWarnings();
    const Renderer renderer(context(), library(), scene, settings("irradiance-cache"));
    return std::ranges::any_of(loggedWarnings(), [](const std::string& w) {
      return w.find("caustics") != std::string::npos && w.find("'pane'") != std::string::npos;
    });
  };
  scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(1.0f)};
  EXPECT_TRUE(said());
  scene.sun.reset();
  scene.environment = Environment{glm::vec3(1.0f), {}, 0.0};
  EXPECT_FALSE(said());
  scene.materials[0].emission = glm::vec3(1.0f);
  EXPECT_TRUE(said());
}

// --------------------------------------------------------------------------------------------------------------- lamps

class ManyLamps : public ReflectionsTest {
 protected:
  /// Points 2 above a floor, in rows.
  static SceneBuilder floorUnderLamps(int lamps) {
    SceneBuilder builder;
    builder.plate({0, 0, 0}, {0, 0, 10}, {10, 0, 0}, builder.material(glm::vec3(0.5f)));
    builder.scene().sun.reset();
    for (int i = 0; i < lamps; ++i)
      builder.scene().points.push_back({{-4.0 + 0.8 * (i % 10), 2.0, -4.0 + 0.8 * (i / 10)}, glm::vec3(0.5f)});
    return builder;
  }
};

// However many have shadow maps.
TEST_F(ManyLamps, AllOfThemShine) {
  for (const int lamps : {5, 100})
    for (const int shadows : {0, 4, 16}) {
      Scene scene = floorUnderLamps(lamps).scene();
      if (lamps == 5) scene.spots.push_back({{0, 3, 0}, {0, -1, 0}, glm::vec3(2.0f), 0.3, 0.9});
      RenderSettings s = settings("direct");
      s.lights.shadows = shadows;
      const Camera camera = lookingAt({0, 3, 2}, {0, 0, 0}, 0.4);
      const Image image = drawn(scene, camera, s);
      for (int y = 0; y < 32; y += 5)
        for (int x = 0; x < 32; x += 5) {
          const glm::dvec3 p = onPlane(camera, pixelRay(camera, x, y, glm::ivec2(32)), 0.0);
          double irradiance = 0.0;
          for (const PointLight& lamp : scene.points) {
            const glm::dvec3 away = lamp.position - p;
            irradiance += 0.5 * away.y / std::pow(glm::length(away), 3.0);
          }
          for (const SpotLight& lamp : scene.spots) {
            const glm::dvec3 away = lamp.position - p;
            const double cosine = away.y / glm::length(away),
                         t = std::clamp((cosine - std::cos(0.9)) / (std::cos(0.3) - std::cos(0.9)), 0.0, 1.0);
            irradiance += 2.0 * t * t * (3.0 - 2.0 * t) * cosine / glm::dot(away, away);
          }
          const double expected = 0.5 / kPi * irradiance;
          ASSERT_NEAR(image.at(x, y).y, expected, 4e-3 * expected) << lamps << " " << shadows << " " << x << " " << y;
        }
    }
}

// The lamp's rays are nearly parallel; a cube map's face would have a texel for all of the card.
TEST_F(ManyLamps, FarOnesCastShadowsToo) {
  SceneBuilder builder;
  const int grey = builder.material(glm::vec3(0.5f));
  builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, grey);
  builder.plate({0, 0.3, 0}, {0, 0, 0.6}, {0.6, 0, 0}, grey);
  builder.scene().sun.reset();
  for (const double distance : {100.0, 1000.0}) {
    builder.scene().points = {{{0.0, distance, 0.0}, glm::vec3(static_cast<float>(distance * distance))}};
    // Below the card; beside it.
    const Image below = drawn(builder.scene(), lookingAt({1.0, 0.15, 0}, {0, 0, 0}, 0.02), settings("direct")),
                beside = drawn(builder.scene(), lookingAt({1.0, 0.5, 0}, {0.7, 0, 0}, 0.02), settings("direct"));
    EXPECT_EQ(below.at(16, 16).y, 0.0f) << distance;
    EXPECT_NEAR(beside.at(16, 16).y, 0.5 / kPi, 1e-3) << distance;
  }
}

// A box of 2 m on a plain of 5 km has its shadow: one map for all would have a texel for it.
TEST_F(ManyLamps, TheSunsShadowOfASmallThingOnAWidePlain) {
  SceneBuilder builder;
  builder.plate({0, 0, 0}, {0, 0, 5000}, {5000, 0, 0}, builder.material(glm::vec3(0.5f)));
  builder.plate({0, 2, 0}, {0, 0, 2}, {2, 0, 0}, builder.material(glm::vec3(0.5f)));
  builder.sun({0.0, -1.0, 0.0}, glm::vec3(2.0f));
  const Image below = drawn(builder.scene(), lookingAt({6.0, 3.0, 0}, {0, 0, 0}, 0.8), settings("direct")),
              beside = drawn(builder.scene(), lookingAt({6.0, 3.0, 3.0}, {0, 0, 3.0}, 0.8), settings("direct"));
  EXPECT_EQ(below.at(16, 16).y, 0.0f);
  EXPECT_NEAR(beside.at(16, 16).y, 1.0 / kPi, 1e-3);
}

}  // namespace
}  // namespace lucerna::test
