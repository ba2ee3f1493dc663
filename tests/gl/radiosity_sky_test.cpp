// The environment's light in radiosity: what is known of floors, walls and boxes under a sky.
#include "base/angles.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"
#include "support/gl_fixture.hpp"
#include "support/radiosity_scenes.hpp"

#include <cmath>

namespace lucerna {
namespace {

using test::lambertian;
using test::SceneBuilder;

class RadiositySky : public test::SharedProgramsTest {
 protected:
  static RadiositySolution solve(const Scene& scene) {
    RadiositySolutionSettings settings = test::wholeTriangles();
    settings.hemicubes.resolution = 128;  // with 32 pixels rows that see the sky sum to 0.5 % too much
    return solveScene(context(), library(), scene, settings);
  }
  /// A plate of side 1 with that normal, of reflectance 0.5.
  static Scene plate(const glm::dvec3& normal, const Environment& environment) {
    SceneBuilder builder;
    const glm::dvec3 u = std::abs(normal.y) > 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    builder.plate({0, 0, 0}, u, glm::cross(normal, u), lambertian(builder, 0.5));
    builder.scene().environment = environment;
    return test::dark(builder.scene());
  }
};

/// The inside of a cube of side 1 without its ceiling: a wall n x n squares, floor first.
Scene openTop(int n, double reflectance, double exitance, const Environment& environment) {
  SceneBuilder builder;
  const int material = lambertian(builder, reflectance, exitance);
  const glm::dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const glm::dvec3 walls[][2] = {
      {z, x}, {x, y}, {-x, y}, {-z, y}, {z, y}};  // u, v; the front along their cross product, inwards
  for (const auto& [u, v] : walls) {
    const glm::dvec3 normal = glm::cross(u, v);
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k)
        builder.plate(-0.5 * normal + ((i + 0.5) / n - 0.5) * u + ((k + 0.5) / n - 0.5) * v, u / static_cast<double>(n),
                      v / static_cast<double>(n), material);
  }
  builder.scene().environment = environment;
  return test::dark(builder.scene());
}

TEST_F(RadiositySky, AFloorUnderAConstantSkyReceivesPiTimesItsRadiance) {
  const glm::dvec3 radiance(0.25, 0.5, 2.0);
  const RadiositySolution s = solve(plate({0, 1, 0}, Environment{glm::vec3(radiance), {}, 0.0}));
  for (std::size_t i = 0; i < s.irradiance.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(s.irradiance[i][c], kPi * radiance[c], 1e-9);
      EXPECT_NEAR(s.exitance[i][c], 0.5 * kPi * radiance[c], 1e-6);
    }
}

TEST_F(RadiositySky, PicturesLightFromWhereTheyAre) {
  Environment above{glm::vec3(1.0f), Image(8, 4), 0.0}, right = above;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      above.picture->at(x, y) = glm::vec3(y < 2 ? 3.0f : 0.0f);
      right.picture->at(x, y) = glm::vec3(x >= 4 ? 3.0f : 0.0f);  // +x
    }
  const auto share = [&](const glm::dvec3& normal, const Environment& environment) {
    return solve(plate(normal, environment)).irradiance[0].x / (3.0 * kPi);
  };
  EXPECT_NEAR(share({0, 1, 0}, above), 1.0, 1e-9);
  EXPECT_NEAR(share({0, -1, 0}, above), 0.0, 1e-9);
  for (const glm::dvec3& wall : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1)})
    EXPECT_NEAR(share(wall, above), 0.5, 0.005);
  EXPECT_NEAR(share({1, 0, 0}, right), 1.0, 1e-9);
  EXPECT_NEAR(share({-1, 0, 0}, right), 0.0, 1e-9);
  right.rotation =
      0.5 * kPi;  // the shader's sense: azimuth plus rotation is the picture's, so that +x comes to lie at -z
  EXPECT_NEAR(share({0, 0, -1}, right), 1.0, 1e-9);
  EXPECT_NEAR(share({1, 0, 0}, right), 0.5, 0.005);
}

/// Irradiance across a normal from a texel of radiance 1, by many directions.
double fromTexel(const Image& picture, int x, int y, const glm::dvec3& normal) {
  constexpr int kSteps = 256;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double azimuth = 2.0 * kPi * ((x + (i + 0.5) / kSteps) / picture.width - 0.5),
                   polar = kPi * (y + (j + 0.5) / kSteps) / picture.height;
      const glm::dvec3 to(std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth));
      sum += std::max(glm::dot(to, normal), 0.0) * std::sin(polar);
    }
  return sum * 2.0 * kPi / picture.width * kPi / picture.height / (kSteps * kSteps);
}

// Few rays of 1024 that go everywhere find a texel of 0.4 % of the sky: 20 % off.
TEST_F(RadiositySky, ABrightTexelLightsAsItsSolidAngleSays) {
  Environment sky{glm::vec3(0.5f, 1.0f, 2.0f), Image(32, 16), 0.0};
  for (glm::vec3& texel : sky.picture->pixels) texel = glm::vec3(0.25f);
  sky.picture->at(11, 7) = glm::vec3(2000.0f, 1000.0f, 500.0f);
  for (const glm::dvec3& normal : {glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1), glm::dvec3(-1, 0, 0)}) {
    const RadiositySolution s = solve(plate(normal, sky));
    const double texel = fromTexel(*sky.picture, 11, 7, normal);
    EXPECT_GT(texel, 1e-3);
    for (const glm::dvec3& irradiance : s.irradiance)
      for (int c = 0; c < 3; ++c) {
        const double expected = static_cast<double>(sky.radiance[c]) *
                                (0.25 * kPi + texel * static_cast<double>(sky.picture->at(11, 7)[c] - 0.25f));
        EXPECT_NEAR(irradiance[c], expected, 0.005 * expected) << c;
      }
  }
  // Behind a screen only the rest of the sky arrives.
  SceneBuilder builder;
  const int material = lambertian(builder, 0.0);
  builder.plate({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, material);
  const double azimuth = 2.0 * kPi * (11.5 / 32.0 - 0.5), polar = kPi * 7.5 / 16.0;
  const glm::dvec3 to(std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth)),
      side = glm::normalize(glm::cross(to, glm::dvec3(0, 1, 0)));
  builder.plate(20.0 * to, 8.0 * side, 8.0 * glm::cross(side, to), material);
  builder.scene().environment = sky;
  const double behind = solve(test::dark(builder.scene())).irradiance[0].y;
  EXPECT_LT(behind, 0.26 * kPi);
  EXPECT_GT(behind, 0.23 * kPi);
}

// Form factors of a unit cube's faces: 0.199825 to the one opposite, 0.200044 to each beside it.
TEST_F(RadiositySky, ABoxWithAnOpenTopReceivesByItsFormFactors) {
  const int n = 4;
  const RadiositySolution s = solve(openTop(n, 0.0, 0.0, Environment{glm::vec3(1.0f), {}, 0.0}));
  const std::size_t ofWall = 2 * n * n;
  ASSERT_EQ(s.irradiance.size(), 5 * ofWall);
  for (std::size_t wall = 0; wall < 5; ++wall) {
    double mean = 0.0;
    for (std::size_t k = 0; k < ofWall; ++k) mean += s.irradiance[wall * ofWall + k].x / static_cast<double>(ofWall);
    EXPECT_NEAR(mean / kPi, wall == 0 ? 0.199825 : 0.200044, 0.002)
        << wall;  // 32 patches of 1024 rays each: measured 0.0012
  }
}

// Walls that send out the sky's radiance by emission and reflection together: everywhere is as bright as the sky.
TEST_F(RadiositySky, WallsThatShineAsTheSkyDoesReceiveItEverywhere) {
  const RadiositySolution s = solve(openTop(4, 0.6, 0.4 * kPi, Environment{glm::vec3(1.0f), {}, 0.0}));
  double mean = 0.0;
  for (const glm::dvec3& irradiance : s.irradiance) {
    EXPECT_NEAR(irradiance.x / kPi, 1.0, 0.015);  // 1024 rays: measured 0.011
    mean += irradiance.x / kPi / static_cast<double>(s.irradiance.size());
  }
  EXPECT_NEAR(mean, 1.0, 0.003);
}

TEST_F(RadiositySky, TheViewShowsItAsDirectLightByPixelsAndByPatches) {
  const Scene scene = plate({0, 1, 0}, Environment{{0.25f, 0.5f, 1.0f}, {}, 0.0});
  for (const auto direct : {RadiosityView::Direct::patches, RadiosityView::Direct::pixels})
    for (const auto component : {Component::all, Component::direct, Component::indirect}) {
      RenderSettings settings;
      settings.technique = "radiosity";
      settings.component = component;
      settings.size = {8, 8};
      settings.fullFloatTarget = true;
      settings.of<RadiosityView::Settings>().direct = direct;
      settings.of<RadiosityView::Settings>().solution = test::wholeTriangles();
      Renderer renderer(context(), library(), scene, settings);
      renderer.render(test::lookingAt({0.0, 0.5, 0.01}, {0, 0, 0}, 0.5));
      const glm::vec3 seen = renderer.readRadiance().at(4, 4),
                      expected = component == Component::indirect ? glm::vec3(0.0f) : glm::vec3(0.125f, 0.25f, 0.5f);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 1e-6) << nameOf(direct) << " " << nameOf(component);
    }
}

}  // namespace
}  // namespace lucerna
