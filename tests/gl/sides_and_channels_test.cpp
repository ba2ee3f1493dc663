// What must not matter: which side of a face is its front, and which of the three channels light is in. And form
// factors that a horizon cuts.
#include "lpv/settings.hpp"
#include "radiosity/radiosity_view.hpp"
#include "support/form_factor_reference.hpp"
#include "support/gl_fixture.hpp"
#include "support/largest_difference.hpp"
#include "support/pixel_rays.hpp"
#include "support/radiosity_scenes.hpp"
#include "support/small_scenes.hpp"

#include "gl/pass.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace lucerna {
namespace {

using test::largestDifference;
using test::openBox;
using test::openBoxCamera;
using test::SceneBuilder;

class SidesAndChannels : public test::SharedProgramsTest {
 protected:
  static RenderSettings settings(std::string_view technique) {
    RenderSettings s;
    s.technique = technique;
    s.size = {32, 24};
    s.fullFloatTarget = true;
    s.shadow.size = 512;
    s.of<ReflectiveShadowMap::Settings>().size = 64;
    s.of<LpvSettings>().cascades.cells = 16;
    s.of<LpvSettings>().storage = LpvSettings::Storage::full;
    return s;
  }
  static Image render(const Scene& scene, const Camera& camera, const RenderSettings& s) {
    Renderer renderer(context(), library(), scene, s);
    renderer.render(camera);
    return renderer.readRadiance();
  }
};

Scene turnedAround(Scene scene) {
  for (std::size_t i = 0; i + 2 < scene.indices.size(); i += 3) std::swap(scene.indices[i], scene.indices[i + 1]);
  for (Vertex& vertex : scene.vertices) vertex.normal = -vertex.normal;
  return scene;
}

/// A box with the lamps of every kind that rasterisers know.
Scene litBox() {
  Scene scene = openBox();
  scene.spots.push_back(
      {{2.0, 4.0, 3.0}, glm::normalize(glm::dvec3(-0.3, -1.0, -0.8)), glm::vec3(60.0f, 50.0f, 40.0f), 0.3, 0.6});
  scene.points.push_back({{-1.0, 1.0, 2.0}, glm::vec3(5.0f, 9.0f, 12.0f)});
  return scene;
}

TEST_F(SidesAndChannels, TurningEveryFaceAroundChangesNoPicture) {
  for (const std::string_view technique : {"direct", "rsm", "lpv"}) {
    const Scene scene = technique == "rsm" ? openBox() : litBox(), turned = turnedAround(scene);
    const Image front = render(scene, openBoxCamera(), settings(technique));
    const Image back = render(turned, openBoxCamera(), settings(technique));
    EXPECT_GT(meanOf(front).y, 0.1);
    // The two windings may round differently: places and depths of texels move by a rounding.
    EXPECT_LT(largestDifference(front, back), (technique == "rsm" ? 1e-2 : 2e-3) * meanOf(front).y) << technique;
  }
  PathTracer::Settings path;
  path.size = {32, 24};
  const auto traced = [&](const Scene& scene) {
    PathTracer tracer(context(), library(), scene, path);
    tracer.setCamera(openBoxCamera());
    tracer.record(4);
    return tracer.mean();
  };
  // Kinds of lights apart: what chooses between them is found at points of triangles, which turn too.
  Scene lamps = litBox();
  lamps.sun.reset();
  for (const Scene& scene : std::vector<Scene>{openBox(), lamps}) {
    const Image front = traced(scene), back = traced(turnedAround(scene));
    int different = 0;
    for (std::size_t i = 0; i < front.pixels.size(); ++i)
      different += glm::length(front.pixels[i] - back.pixels[i]) > 1e-3f * glm::length(front.pixels[i]);
    EXPECT_LT(different, 8);  // where a ray meets an edge
  }
}

TEST_F(SidesAndChannels, LightOfEachChannelIsCarriedAlike) {
  struct Way {
    const char* name;
    RenderSettings settings;
  };
  std::vector<Way> ways{{"direct", settings("direct")}, {"rsm", settings("rsm")}, {"lpv", settings("lpv")}};
  ways.push_back(ways.back());
  ways.back().name = "lpv, 3 bounces";
  ways.back().settings.of<LpvSettings>().bounces = 3;
  for (const auto fill : {LpvFill::layered, LpvFill::fixed, LpvFill::atomic})
    for (const auto propagation : {LpvPropagate::layered, LpvPropagate::compute}) {
      ways.push_back({"lpv, fills and propagations", settings("lpv")});
      ways.back().settings.of<LpvSettings>().fill = fill;
      ways.back().settings.of<LpvSettings>().propagate = propagation;
    }
  const auto lit = [&](const glm::vec3& colour) {
    Scene scene = litBox();
    for (Material& material : scene.materials) material.diffuse = glm::vec3(material.diffuse.y);
    scene.sun->irradiance = 3.0f * colour;
    scene.spots[0].intensity = 50.0f * colour;
    scene.points[0].intensity = 9.0f * colour;
    return scene;
  };
  // The walls lie well within the second of the cascades, which so takes over light of the coarsest.
  for (Way& way : ways) way.settings.of<LpvSettings>().cascades.spanOfScene = 3.2;
  for (const Way& way : ways) {
    if (way.settings.of<LpvSettings>().fill == LpvFill::atomic && !capabilities().shaderAtomicFloat &&
        !capabilities().shaderAtomicFp16Vector)
      continue;
    const Image white = render(lit(glm::vec3(1.0f)), openBoxCamera(), way.settings);
    double coloured = 0.0;
    for (const glm::vec3& pixel : white.pixels)
      coloured = std::max({coloured, static_cast<double>(std::abs(pixel.y - pixel.x)),
                           static_cast<double>(std::abs(pixel.z - pixel.x))});
    EXPECT_LT(coloured, 2e-4 * meanOf(white).y) << way.name << ": white light on grey walls";
    for (int c = 0; c < 3; ++c) {
      glm::vec3 colour(0.0f);
      colour[c] = 1.0f;
      const Image one = render(lit(colour), openBoxCamera(), way.settings);
      double worst = 0.0;
      for (std::size_t i = 0; i < one.pixels.size(); ++i) {
        worst = std::max(worst, static_cast<double>(std::abs(one.pixels[i][c] - white.pixels[i][c])));
        EXPECT_EQ(one.pixels[i][(c + 1) % 3], 0.0f);
        EXPECT_EQ(one.pixels[i][(c + 2) % 3], 0.0f);
      }
      EXPECT_LT(worst, 2e-4 * meanOf(white).y) << way.name << ", channel " << c;
    }
  }
}

/// Form factors from the origin with normal +z, of three corners a triangle.
std::vector<float> formFactorsOf(gl::ProgramLibrary& library, const std::vector<glm::vec4>& corners) {
  const std::size_t count = corners.size() / 3;
  const gl::Program& program = library.loadCompute("polygon probe", "radiosity/polygon_probe.comp", {});
  const gl::Buffer in("corners", corners.size() * sizeof(glm::vec4), corners.data(), gl::Usage::staticDraw);
  const gl::Buffer out("form factors", count * sizeof(float), nullptr, gl::Usage::dynamicRead);
  in.bindStorage(0);
  out.bindStorage(1);
  {
    const gl::ComputePass pass("probe");
    program.use();
    pass.dispatch({static_cast<int>(count), 1, 1}, {64, 1, 1});
  }
  return out.read<float>();
}

TEST_F(SidesAndChannels, FormFactorsOfTrianglesThatTheHorizonCuts) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<glm::vec4> corners;
  std::vector<double> expected;
  std::array<int, 4> below{};
  for (int i = 0; i < 4096; ++i) {
    std::array<glm::dvec3, 3> triangle;
    const glm::dvec3 centre(normal(random), normal(random), 0.5 * normal(random));
    const double size = std::pow(10.0, -1.0 + 1.5 * (i % 64) / 64.0);
    int under = 0;
    for (glm::dvec3& p : triangle) {
      p = glm::dvec3(glm::vec3(centre + size * glm::dvec3(normal(random), normal(random), normal(random))));
      under += p.z <= 0.0;
      corners.emplace_back(glm::vec3(p), 0.0f);
    }
    ++below[static_cast<std::size_t>(under)];
    expected.push_back(reference::pointToPolygon({0, 0, 0}, {0, 0, 1}, triangle));
  }
  for (const int count : below) EXPECT_GT(count, 300);
  const std::vector<float> found = formFactorsOf(library(), corners);
  for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(found[i], expected[i], 2e-5 + 1e-4 * expected[i]) << i;
}

TEST_F(SidesAndChannels, FormFactorsOfNeedles) {
  // Widths of 1e-1 to 1e-6 of the length, each corner first, wound either way, above, below and across the horizon.
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<glm::vec4> corners;
  std::vector<double> expected, allowed;
  std::array<int, 4> below{};
  for (int i = 0; i < 12288; ++i) {
    const double width = std::pow(10.0, -1.0 - 5.0 * (i % 64) / 63.0);
    const glm::dvec3 along = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))),
                     across = glm::normalize(glm::cross(along, glm::dvec3(normal(random), normal(random), 1.0)));
    const glm::dvec3 at(2.0 * uniform(random) - 1.0, 2.0 * uniform(random) - 1.0, uniform(random) - 0.3);
    std::array<glm::dvec3, 3> triangle{at - along, at + along, at + (2.0 * uniform(random) - 1.0) * along};
    triangle[2] += 2.0 * width * across;
    std::rotate(triangle.begin(), triangle.begin() + i % 3, triangle.end());
    if ((i / 3) % 2 == 1) std::swap(triangle[0], triangle[1]);
    int under = 0;
    for (glm::dvec3& p : triangle) {
      p = glm::dvec3(glm::vec3(p));
      under += p.z <= 0.0;
      corners.emplace_back(glm::vec3(p), 0.0f);
    }
    ++below[static_cast<std::size_t>(under)];
    expected.push_back(reference::pointToPolygon({0, 0, 0}, {0, 0, 1}, triangle));
    // The long edge's ends are rounded, so the width is off by 1e-7 of it; and what is seen on edge cancels.
    allowed.push_back((1e-4 + 4e-7 / width) * expected.back() + 2e-4 * width + 1e-8);
  }
  for (const int count : below) EXPECT_GT(count, 300);
  const std::vector<float> found = formFactorsOf(library(), corners);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], allowed[i]) << i;
}

// ------------------------------------------------------------------------------------------- lamps in radiosity's
// pictures

/// A black floor's reflectance 1/2 seen from above, lit by one lamp; direct light in each pixel or by patches.
Image radiosityPicture(const gl::Context& context, gl::ProgramLibrary& library, const Scene& scene,
                       const Camera& camera, RadiosityView::Direct direct) {
  RenderSettings settings;
  settings.technique = "radiosity";
  settings.component = Component::direct;
  settings.size = {16, 16};
  settings.fullFloatTarget = true;
  settings.of<RadiosityView::Settings>().direct = direct;
  settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 16;
  settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 0.25;
  Renderer renderer(context, library, scene, settings);
  renderer.render(camera);
  return renderer.readRadiance();
}

TEST_F(SidesAndChannels, LampsOfEveryKindLightRadiositysPicturesAndAreBlockedByWhatLiesBeforeThemAlone) {
  const Camera camera = test::lookingAt({0.0, 1.0, 0.01}, {0, 0, 0}, 0.5);
  const double height = 2.0;
  for (const char* kind : {"spot", "point", "sun"})
    for (const double screen :
         {0.0, 0.02, 0.98, 1.02}) {  // place of a screen between floor and lamp, in parts of the distance; 0: none
      if (screen > 1.0 && std::string(kind) == "sun") continue;
      SceneBuilder builder;
      const int grey = test::lambertian(builder, 0.5), black = test::lambertian(builder, 0.0);
      builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, grey);
      if (screen > 0.5) builder.plate({0, screen * height, 0}, {0, 0, 2}, {2, 0, 0}, black);
      Scene scene = builder.scene();
      scene.sun.reset();
      if (std::string(kind) == "sun") scene.sun = DirectionalLight{{0, -1, 0}, glm::vec3(2.0f)};
      if (std::string(kind) == "point") scene.points.push_back({{0, height, 0}, glm::vec3(8.0f)});
      if (std::string(kind) == "spot") scene.spots.push_back({{0, height, 0}, {0, -1, 0}, glm::vec3(8.0f), 0.3, 1.0});
      for (const auto direct : {RadiosityView::Direct::pixels, RadiosityView::Direct::patches}) {
        const Image image = radiosityPicture(context(), library(), scene, camera, direct);
        double worst = 0.0;
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x) {
            const glm::dvec3 p = test::onPlane(camera, test::pixelRay(camera, x, y, {16, 16}), 0.0);
            const double d2 = p.x * p.x + p.z * p.z + height * height, cosine = height / std::sqrt(d2);
            double e = std::string(kind) == "sun" ? 2.0 : 8.0 * cosine / d2;
            if (std::string(kind) == "spot") {
              const double t = std::clamp((cosine - std::cos(1.0)) / (std::cos(0.3) - std::cos(1.0)), 0.0, 1.0);
              e *= t * t * (3.0 - 2.0 * t);
            }
            if (screen > 0.5 && screen < 1.0) e = 0.0;
            worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y).y) - 0.5 / std::numbers::pi * e));
          }
        // Patches of a quarter: their means, interpolated.
        EXPECT_LT(worst, direct == RadiosityView::Direct::pixels ? 1e-4 : 6e-3)
            << kind << ", screen at " << screen << ", " << nameOf(direct);
      }
    }
}

}  // namespace
}  // namespace lucerna
