// The environment behind surfaces in rasterised pictures: the path tracer's, in every technique, and none of it where
// it is not needed.
#include "base/log.hpp"
#include "lpv/settings.hpp"
#include "render/renderer.hpp"
#include "scene/clear_sky.hpp"
#include "support/path_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace lucerna::test {
namespace {

/// A plate of side 2 about the origin, facing the camera on +z; all else is environment.
Scene plateBefore(const Environment& environment) {
  SceneBuilder builder;
  builder.plate({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, builder.material(glm::vec3(0.5f)));
  builder.sun(glm::normalize(glm::dvec3(0.2, -1.0, -0.5)), glm::vec3(3.0f));
  builder.scene().environment = environment;
  return builder.scene();
}

Environment noise(int width, int height, double rotation) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0.1f, 1.0f);
  Environment environment{glm::vec3(2.0f, 1.0f, 0.5f), Image(width, height), rotation};
  for (glm::vec3& p : environment.picture->pixels) p = {unit(random), unit(random), unit(random)};
  return environment;
}

class EnvironmentViewTest : public PathTest {
 protected:
  static RenderSettings settings(std::string_view technique, Component component = Component::all) {
    RenderSettings s;
    s.technique = technique;
    s.component = component;
    s.size = {40, 24};
    s.fullFloatTarget = true;
    s.shadow.size = 64;
    s.of<ReflectiveShadowMap::Settings>().size = 32;
    s.of<LpvSettings>().cascades.cells = 8;
    return s;
  }
  static Image draw(const Scene& scene, const Camera& camera, const RenderSettings& s) {
    Renderer renderer(context(), library(), scene, s);
    renderer.render(camera);
    return renderer.readRadiance();
  }
  static glm::dvec3 rayOf(const Camera& camera, glm::dvec2 pixel, glm::ivec2 size) {
    const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                     up = glm::cross(right, camera.direction);
    const double high = std::tan(0.5 * camera.verticalFov), wide = high * size.x / size.y;
    return glm::normalize(camera.direction + wide * (2.0 * pixel.x / size.x - 1.0) * right +
                          high * (1.0 - 2.0 * pixel.y / size.y) * up);
  }
  /// Bilinear, in double; left and right edge are neighbours.
  static glm::dvec3 bilinear(const Environment& environment, const glm::dvec3& d) {
    const Image& picture = *environment.picture;
    const double azimuth = std::atan2(d.x, -d.z) + environment.rotation;
    const double x = (0.5 + azimuth / (2.0 * M_PI)) * picture.width - 0.5,
                 y = std::clamp(std::acos(d.y) / M_PI * picture.height - 0.5, 0.0, picture.height - 1.0);
    const auto texel = [&](double column, double row) {
      const int wrapped = ((static_cast<int>(column) % picture.width) + picture.width) % picture.width;
      return glm::dvec3(picture.at(wrapped, std::min(static_cast<int>(row), picture.height - 1)));
    };
    const double left = std::floor(x), top = std::floor(y);
    return glm::dvec3(environment.radiance) *
           glm::mix(glm::mix(texel(left, top), texel(left + 1, top), x - left),
                    glm::mix(texel(left, top + 1), texel(left + 1, top + 1), x - left), y - top);
  }
};

TEST_F(EnvironmentViewTest, APictureIsSeenBilinearlyAllAround) {
  const Environment environment = noise(8, 5, 0.4);
  const Scene scene = plateBefore(environment);
  const RenderSettings s = settings("direct");
  // Away from the plate: ahead, to the sides, and to the poles and the picture's seam.
  for (const glm::dvec3& target :
       {glm::dvec3(0, 0, 9), glm::dvec3(9, 1, 4), glm::dvec3(-9, -2, 4), glm::dvec3(1, 9, 5), glm::dvec3(-1, -9, 5)}) {
    const Camera camera = lookingAt({0, 0, 3}, target, 1.2);
    const Image picture = draw(scene, camera, s);
    for (int y = 0; y < s.size.y; ++y)
      for (int x = 0; x < s.size.x; ++x) {
        const glm::dvec3 expected = bilinear(environment, rayOf(camera, {x + 0.5, y + 0.5}, s.size));
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(picture.at(x, y)[c], expected[c], 2e-4) << x << " " << y << " " << target.x;
      }
  }
}

// Paths take the texel that a direction falls into, anywhere in a pixel: both are within what texels and their
// neighbours hold.
TEST_F(EnvironmentViewTest, ThePathTracersEnvironmentIsTheSameToATexel) {
  Environment environment{
      glm::vec3(1.0f), clearSkyPicture({3.0, 0.2}, {glm::normalize(glm::dvec3(0.3, -1.0, 0.8)), glm::vec3(3.0f)}, 64),
      0.7};
  const Image& texels = *environment.picture;
  float range = 0.0f;  // largest, of a texel and its neighbours, relative to it
  for (int y = 1; y < texels.height / 2 - 1; ++y)
    for (int x = 0; x < texels.width; ++x)
      for (int k = 0; k < 9; ++k)
        for (int c = 0; c < 3; ++c)
          range = std::max(range, std::abs(texels.at((x + k % 3 + texels.width - 1) % texels.width, y + k / 3 - 1)[c] /
                                               texels.at(x, y)[c] -
                                           1.0f));
  ASSERT_LT(range, 0.25f);
  const Scene scene = plateBefore(environment);
  for (const glm::dvec3& target :
       {glm::dvec3(0, 6, -9), glm::dvec3(9, 6, 4), glm::dvec3(-9, 7, 4)}) {  // above the horizon
    const Camera camera = lookingAt({0, 3, 3}, target, 0.6);
    RenderSettings s = settings("direct");
    s.size = {24, 24};
    const Image drawn = draw(scene, camera, s), traced = tracer(scene, camera, sized(24), 16).mean();
    for (std::size_t i = 0; i < drawn.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(drawn.pixels[i][c] / traced.pixels[i][c], 1.0f, range) << i;
  }
}

TEST_F(EnvironmentViewTest, EveryTechniqueShowsItBehindSurfacesAndComponentIndirectNowhere) {
  const glm::vec3 radiance(0.25f, 0.5f, 0.75f);
  const Scene scene = plateBefore(Environment{radiance, {}, 0.0});
  const Camera camera = lookingAt({0, 0, 3}, {0, 0, 0}, 1.2);
  const Image byRays = draw(scene, camera, settings("irradiance-cache"));
  EXPECT_EQ(byRays.at(0, 0), radiance);
  EXPECT_NE(byRays.at(20, 12), radiance);
  for (const std::string_view technique : {"direct", "rsm", "lpv", "radiosity"}) {
    const Image picture = draw(scene, camera, settings(technique));
    EXPECT_EQ(picture.at(0, 0), radiance) << technique;
    EXPECT_EQ(picture.at(39, 23), radiance) << technique;
    EXPECT_NE(picture.at(20, 12), radiance) << technique;
    if (technique != "direct") {
      EXPECT_EQ(draw(scene, camera, settings(technique, Component::indirect)).at(0, 0), glm::vec3(0.0f))
          << technique;
    }
  }
}

// What it does not light is said once, by name.
TEST_F(EnvironmentViewTest, WhoeverLetsItLightNothingSaysSo) {
  const auto said = [&](const Scene& scene, RenderSettings s) {
    clearLoggedWarnings();
    const Renderer renderer(context(), library(), scene, s);
    std::string lines;
    for (const std::string& line : loggedWarnings())
      if (line.find("the environment lights nothing") != std::string::npos)
        lines += line.substr(0, line.find(':')) + ";";
    clearLoggedWarnings();
    return lines;
  };
  const Scene scene = plateBefore(Environment{glm::vec3(1.0f), {}, 0.0}),
              dark = plateBefore(Environment{glm::vec3(0.0f), {}, 0.0});
  EXPECT_EQ(said(scene, settings("direct")), "technique direct;");
  EXPECT_EQ(said(scene, settings("rsm")), "technique rsm;");
  EXPECT_EQ(said(scene, settings("lpv")), "technique lpv;");
  EXPECT_EQ(said(scene, settings("radiosity")), "");
  EXPECT_EQ(said(scene, settings("irradiance-cache")), "");
  EXPECT_EQ(said(dark, settings("direct")), "");
}

}  // namespace
}  // namespace lucerna::test
