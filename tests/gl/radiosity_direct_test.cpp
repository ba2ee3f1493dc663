// Direct light of a radiosity picture by shadow rays in each pixel: against closed forms where nothing is between,
// against many rays in double where something is; and the parts of the picture add up.
#include "base/log.hpp"
#include "radiosity/direct_rays.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"
#include "support/form_factor_reference.hpp"
#include "support/gl_fixture.hpp"
#include "support/radiosity_scenes.hpp"
#include "support/ray_caster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lucerna {
namespace {

using test::lambertian;
using test::SceneBuilder;

class RadiosityDirect : public test::SharedProgramsTest {
 protected:
  static Image picture(const Scene& scene, const Camera& camera, Component component, RadiosityView::Direct direct,
                       int size = 48, double unmeasuredIterations = gl::kUnmeasuredIterations,
                       double* largestIterations = nullptr) {
    RenderSettings settings;
    settings.technique = "radiosity";
    settings.component = component;
    settings.size = {size, size};
    settings.fullFloatTarget = true;
    settings.of<RadiosityView::Settings>().direct = direct;
    settings.of<RadiosityView::Settings>().shadowRays = 64;
    settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 32;
    settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 0.8;
    settings.unmeasuredIterations = unmeasuredIterations;
    Renderer renderer(context(), library(), scene, settings);
    renderer.render(camera);
    if (largestIterations) *largestIterations = renderer.largestIterations();
    return renderer.readRadiance();
  }
  static glm::dvec3 rayOf(const Camera& camera, int x, int y, int size) {
    const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                     up = glm::cross(right, camera.direction);
    const double t = std::tan(0.5 * camera.verticalFov);
    return camera.direction + ((2.0 * x + 1.0) / size - 1.0) * t * right + (1.0 - (2.0 * y + 1.0) / size) * t * up;
  }
};

/// A floor of reflectance 0.5, a lamp of exitance 3 that looks down from 2, and a screen between them.
Scene tableScene() {
  SceneBuilder builder;
  const int grey = lambertian(builder, 0.5), lamp = lambertian(builder, 0.0, 3.0);
  builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, grey);
  builder.plate({0.2, 2, 0.1}, {0.7, 0, 0}, {0, 0, 0.5}, lamp);
  builder.plate({0.1, 1, 0}, {0, 0, 0.6}, {0.6, 0, 0.1}, grey);
  builder.scene().sun.reset();
  return builder.scene();
}
const Camera kAbove = test::lookingAt({0.3, 1.6, 3.0}, {0, 0, 0}, 0.9);

TEST_F(RadiosityDirect, ALampsShadowIsThatOfManyRays) {
  const Scene scene = tableScene();
  const int size = 48;
  const Image image = picture(scene, kAbove, Component::direct, RadiosityView::Direct::pixels, size);
  const test::RayCaster caster(scene);
  const glm::dvec3 c{0.2, 2, 0.1}, u{0.7, 0, 0}, v{0, 0, 0.5};
  const std::vector<glm::dvec3> lamp{c - 0.5 * u - 0.5 * v, c + 0.5 * u - 0.5 * v, c + 0.5 * u + 0.5 * v,
                                     c - 0.5 * u + 0.5 * v};
  int lit = 0, dark = 0, between = 0;
  double bias = 0.0, squares = 0.0;
  for (int y = 1; y < size; y += 2)
    for (int x = 0; x < size; x += 2) {
      const glm::dvec3 d = rayOf(kAbove, x, y, size);
      const auto hit = caster.firstHit(kAbove.position, d);
      if (!hit || hit->triangle > 1) continue;  // the floor
      const glm::dvec3 p = kAbove.position + hit->distance * d;
      if (std::max(std::abs(p.x), std::abs(p.z)) > 1.98) continue;
      const double open = 3.0 * reference::pointToPolygon(p, {0, 1, 0}, lamp);
      double seen = 0.0, all = 0.0;
      constexpr int kGrid = 24;
      for (int i = 0; i < kGrid; ++i)
        for (int j = 0; j < kGrid; ++j) {
          const glm::dvec3 to = c + ((i + 0.5) / kGrid - 0.5) * u + ((j + 0.5) / kGrid - 0.5) * v - p;
          const double r2 = glm::dot(to, to), w = to.y * to.y / (r2 * r2);
          all += w;
          const auto blocker = caster.firstHit(p + 1e-6 * to, to);
          if (!blocker || blocker->distance > 0.999) seen += w;
        }
      const double expected = 0.5 / std::numbers::pi * open * seen / all, found = static_cast<double>(image.at(x, y).y);
      if (seen == all) {
        ++lit;
        EXPECT_NEAR(found / expected, 1.0, 1e-4) << x << " " << y;
      } else if (seen == 0.0) {
        ++dark;
        EXPECT_EQ(found, 0.0) << x << " " << y;
      } else {
        ++between;
        const double off = found / (0.5 / std::numbers::pi * open) - seen / all;
        bias += off;
        squares += off * off;
        EXPECT_LT(std::abs(off), 0.15) << x << " " << y;
      }
    }
  EXPECT_GT(lit, 100);
  EXPECT_GT(dark, 3);
  ASSERT_GT(between, 20);
  // 64 points in two triangles, of low discrepancy: below the noise of 64 random rays, 0.0625 at most; and no bias
  // beyond three of its standard errors.
  EXPECT_LT(std::sqrt(squares / between), 0.04);
  EXPECT_LT(std::abs(bias / between), 3.0 * 0.04 / std::sqrt(between) + 0.5 / (24 * 24));
}

TEST_F(RadiosityDirect, ThePictureDoesNotDependOnHowRowsAreCut) {
  const Scene scene = tableScene();
  double all = 0.0, cut = 0.0;
  const Image whole =
      picture(scene, kAbove, Component::all, RadiosityView::Direct::pixels, 48, gl::kUnmeasuredIterations, &all);
  EXPECT_EQ(all, 48 * 48 * 64 * gl::kIterationsOfRay);  // one piece
  EXPECT_EQ(picture(scene, kAbove, Component::all, RadiosityView::Direct::pixels, 48, 1e6, &cut).pixels, whole.pixels);
  EXPECT_LE(cut, gl::kMostOverUnmeasured * 1e6);
  EXPECT_GT(cut, 0.0);
}

TEST_F(RadiosityDirect, TheSunsShadowIsSharpAndPartsAddUp) {
  SceneBuilder builder;
  const int grey = lambertian(builder, 0.5), lamp = lambertian(builder, 0.0, 1.0);
  builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, grey);
  builder.plate({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, grey);
  builder.plate({-1.2, 0.8, 0}, {0, 0.3, 0}, {0, 0, 0.3}, lamp);
  builder.sun(glm::normalize(glm::dvec3(0.3, -1, 0.2)), glm::vec3(3.0f));
  builder.scene().points.push_back({{0.5, 3.0, 1.0}, glm::vec3(2.0f)});
  Scene sunAlone = builder.scene();
  sunAlone.points.clear();
  for (Material& m : sunAlone.materials) m.emission = glm::vec3(0.0f);
  const int size = 48;
  const Image sun = picture(sunAlone, kAbove, Component::direct, RadiosityView::Direct::pixels, size);
  const glm::dvec3 toSun = -sunAlone.sun->direction;
  const test::RayCaster caster(sunAlone);
  int lit = 0, dark = 0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const glm::dvec3 d = rayOf(kAbove, x, y, size);
      const auto hit = caster.firstHit(kAbove.position, d);
      if (!hit || hit->triangle > 1) continue;
      const glm::dvec3 p = kAbove.position + hit->distance * d,
                       above = p + toSun / toSun.y;  // where the ray to the sun passes the screen
      const double edge = std::max(std::abs(above.x), std::abs(above.z)) - 0.5;
      if (std::abs(edge) < 1e-3 || std::max(std::abs(p.x), std::abs(p.z)) > 1.98) continue;
      const auto lampBetween = caster.firstHit(p + 1e-6 * toSun, toSun);
      if (lampBetween && lampBetween->triangle > 3) continue;
      (edge < 0.0 ? dark : lit) += 1;
      ASSERT_NEAR(static_cast<double>(sun.at(x, y).x), edge < 0.0 ? 0.0 : 0.5 / std::numbers::pi * 3.0 * toSun.y, 1e-5)
          << x << " " << y;
    }
  EXPECT_GT(lit, 400);
  EXPECT_GT(dark, 20);
  // All = direct + indirect by pixels as by patches; both have the same indirect light, and about the same in all.
  using Direct = RadiosityView::Direct;
  builder.plate({0, 1, -2}, {4, 0, 0}, {0, 2, 0}, grey);  // something that floor and screen reflect light to
  const Image all = picture(builder.scene(), kAbove, Component::all, Direct::pixels, size),
              indirect = picture(builder.scene(), kAbove, Component::indirect, Direct::pixels, size);
  const Image direct = picture(builder.scene(), kAbove, Component::direct, Direct::pixels, size),
              patches = picture(builder.scene(), kAbove, Component::all, Direct::patches, size);
  const Image patchIndirect = picture(builder.scene(), kAbove, Component::indirect, Direct::patches, size),
              patchDirect = picture(builder.scene(), kAbove, Component::direct, Direct::patches, size);
  double mean = 0.0, patchMean = 0.0, bounced = 0.0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      ASSERT_NEAR(all.at(x, y).x, direct.at(x, y).x + indirect.at(x, y).x, 1e-5f);
      ASSERT_NEAR(patches.at(x, y).x, patchDirect.at(x, y).x + patchIndirect.at(x, y).x, 1e-5f);
      ASSERT_EQ(indirect.at(x, y), patchIndirect.at(x, y));
      mean += static_cast<double>(all.at(x, y).x);
      patchMean += static_cast<double>(patches.at(x, y).x);
      bounced += static_cast<double>(indirect.at(x, y).x);
    }
  EXPECT_NEAR(patchMean / mean, 1.0, 0.1);
  EXPECT_GT(bounced, 0.005 * mean);
}

TEST_F(RadiosityDirect, APictureThatShinesLightsByItsTexels) {
  // A lamp of 5 x 3 texels over a floor, against the closed form of each texel.
  const int width = 5, height = 3, size = 24;
  SceneBuilder builder;
  const int grey = lambertian(builder, 0.5), lamp = lambertian(builder, 0.0, 1.0);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < width * height; ++i)
    for (const int byte : {i % 4 == 0 ? 255 : 0, i == 7 ? 255 : 40, 10 * i, 255})
      bytes.push_back(static_cast<std::uint8_t>(byte));
  builder.materialAt(lamp).emissionTexture = builder.texture(width, height, bytes);
  builder.materialAt(lamp).emissionScale = glm::vec3(2.0f);
  builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, grey);
  const glm::dvec3 centre(0.1, 0.8, 0.2), u(2.0, 0, 0), v(0, 0, 1.5);
  builder.plate(centre, u, v, lamp);
  builder.scene().sun.reset();
  const Camera camera = test::lookingAt({0.3, 0.5, 3.0}, {0, 0, 0}, 0.7);
  const Image image = picture(builder.scene(), camera, Component::direct, RadiosityView::Direct::pixels, size);
  int compared = 0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const glm::dvec3 d = rayOf(camera, x, y, size), p = camera.position - camera.position.y / d.y * d;
      if (d.y >= 0.0 || std::max(std::abs(p.x), std::abs(p.z)) > 1.95) continue;
      glm::dvec3 expected(0.0);
      for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
          const auto corner = [&](int i, int k) {
            return centre + (static_cast<double>(column + i) / width - 0.5) * u +
                   (0.5 - static_cast<double>(row + k) / height) * v;
          };
          const std::vector<glm::dvec3> texel{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          for (int c = 0; c < 3; ++c)
            expected[c] +=
                2.0 * 0.5 * reference::pointToPolygon(p, {0, 1, 0}, texel) *
                static_cast<double>(linearFromSrgb(
                    static_cast<float>(bytes[static_cast<std::size_t>(4 * (row * width + column) + c)]) / 255.0f));
        }
      ++compared;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(image.at(x, y)[c], expected[c], 1e-5 + 1e-3 * expected[c]) << x << " " << y;
    }
  EXPECT_GT(compared, 200);
  // More texels than pieces are allowed: squares of them.
  std::vector<std::uint8_t> stripes;
  for (int i = 0; i < 64 * 64; ++i)
    for (const int byte : {(i & 1) != 0 ? 255 : 0, (i & 32) != 0 ? 255 : 0, 128, 255})
      stripes.push_back(static_cast<std::uint8_t>(byte));
  builder.materialAt(lamp).emissionTexture = builder.texture(64, 64, stripes);
  const std::size_t pieces = DirectRays::emitterCount(builder.scene());
  EXPECT_GT(pieces, 16u);
  EXPECT_LE(pieces, DirectRays::kMostEmitters);
}

TEST_F(RadiosityDirect, MasksThatBlockLightAreNamed) {
  SceneBuilder builder;
  const int grey = lambertian(builder, 0.5), leaf = lambertian(builder, 0.5), unused = lambertian(builder, 0.5);
  for (const auto& [index, name] : {std::pair{leaf, "leaf"}, std::pair{unused, "unused"}}) {
    builder.materialAt(index).name = name;
    builder.materialAt(index).alphaMasked = true;
    builder.materialAt(index).diffuseTexture = builder.texture(1, 1, {255, 255, 255, 0}, true);
  }
  builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, grey);
  builder.plate({0, 1, 0}, {0, 0, 4}, {4, 0, 0}, leaf);
  const std::size_t before = loggedWarnings().size();
  picture(builder.scene(), kAbove, Component::all, RadiosityView::Direct::pixels, 8);
  const std::vector<std::string> warnings = loggedWarnings();
  ASSERT_EQ(warnings.size(), before + 1);
  EXPECT_NE(warnings.back().find("'leaf'"), std::string::npos) << warnings.back();
  EXPECT_EQ(warnings.back().find("unused"), std::string::npos) << warnings.back();
}

TEST_F(RadiosityDirect, NoBackShowsAtASilhouette) {
  // All that can be seen shines with radiance 1. A back is black; a face on edge, just hidden, must not come through by
  // the rounding of its depth.
  SceneBuilder builder;
  const int m = lambertian(builder, 0.0, std::numbers::pi);
  test::addBox(builder, {{-2, -1, -2}, {2, 1, 2}}, m, true);
  for (const double x : {-0.9, 0.1, 0.8})
    test::addBox(builder, {{x - 0.2, -1, x * x - 0.5}, {x + 0.21, 0.3 * x, x * x - 0.1}}, m);
  builder.scene().sun.reset();
  RenderSettings settings;
  settings.technique = "radiosity";
  settings.size = {512, 512};
  settings.fullFloatTarget = true;
  settings.of<RadiosityView::Settings>().direct = RadiosityView::Direct::patches;
  settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 16;
  settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 0.3;
  Renderer renderer(context(), library(), builder.scene(), settings);
  int black = 0;
  for (int k = 0; k < 12; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 12;
    renderer.render(test::lookingAt({1.8 * std::sin(angle), 0.4, 1.8 * std::cos(angle)}, {0, -0.4, 0}));
    for (const glm::vec3& p : renderer.readRadiance().pixels) black += std::abs(p.x - 1.0f) > 1e-5f;
  }
  EXPECT_EQ(black, 0);
  // From inside of a box backs are all there is to see.
  renderer.render(test::lookingAt({0.1, -0.5, -0.3}, {0, -0.5, 5}));
  for (const glm::vec3& p : renderer.readRadiance().pixels) ASSERT_EQ(p, glm::vec3(0.0f));
}

}  // namespace
}  // namespace lucerna
