// Forward shading pixel by pixel against double-precision reference implementations: highlights, the shape of shadow
// filters, the display curves.
#include "base/angles.hpp"
#include "radiosity/radiosity_view.hpp"
#include "support/coat_reference.hpp"
#include "support/path_scenes.hpp"
#include "support/pixel_rays.hpp"
#include "support/radiosity_scenes.hpp"
#include "support/small_scenes.hpp"

#include "forward/light_views.hpp"
#include "forward/sun_frustum.hpp"
#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace lucerna {
namespace {

using test::lookingAt;
using test::onPlane;
using test::pixelRay;
using test::SceneBuilder;

constexpr glm::ivec2 kPictureSize{48, 32};

class ShadingValues : public test::PathTest {
 protected:
  static RenderSettings settings(std::string_view technique = "direct") {
    RenderSettings s;
    s.technique = technique;
    s.size = kPictureSize;
    s.fullFloatTarget = true;
    return s;
  }
  static Image render(const Scene& scene, const Camera& camera, const RenderSettings& s = settings()) {
    Renderer renderer(context(), library(), scene, s);
    renderer.render(camera);
    return renderer.readRadiance();
  }
};

// ---------------------------------------------------------------------------------------------------------- highlights

constexpr glm::dvec3 kShinyBase{0.4, 0.2, 0.1}, kShinySpecular{0.1, 0.3, 0.2};

/// A coated floor, its front up or down; no light.
SceneBuilder shinyFloor(float alpha, bool frontUp = true) {
  SceneBuilder builder;
  const int shiny = builder.material(glm::vec3(kShinyBase));
  builder.materialAt(shiny).specular = glm::vec3(kShinySpecular);
  builder.materialAt(shiny).roughness = alpha;
  const glm::dvec3 u{0, 0, 40}, v{40, 0, 0};
  builder.plate({0, 0, 0}, frontUp ? u : v, frontUp ? v : u, shiny);
  builder.scene().sun.reset();
  return builder;
}

void expectHighlight(const Image& image, const Camera& camera, const reference::CoatedSurface& surface,
                     const char* name, const std::function<glm::dvec3(const glm::dvec3&, glm::dvec3&)>& irradiance) {
  double brightest = 0.0, darkest = 1e300;
  for (int y = 0; y < kPictureSize.y; ++y)
    for (int x = 0; x < kPictureSize.x; ++x) {
      glm::dvec3 e;
      const auto radiance = [&](const glm::dvec3& p) {
        glm::dvec3 toLight;
        e = irradiance(p, toLight);
        const glm::dvec3 o = glm::normalize(camera.position - p);  // the floor's normal is y
        return surface.bsdf({o.z, o.x, o.y}, {toLight.z, toLight.x, toLight.y}) * e;
      };
      // Where the driver moves corners to 1/256 of a pixel, the surface is seen as far beside.
      const auto seen = [&](int i, int j) { return onPlane(camera, pixelRay(camera, i, j, kPictureSize), 0.0); };
      const glm::dvec3 p = seen(x, y);
      const glm::dvec3 right = radiance(p + (seen(x + 1, y) - p) / 256.0),
                       up = radiance(p + (seen(x, y + 1) - p) / 256.0), expected = radiance(p),
                       off = glm::abs(right - expected) + glm::abs(up - expected);
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(image.at(x, y)[c], expected[c], 2e-3 * expected[c] + 1e-6 + off[c]) << name << " " << x << " " << y;
      if (!(e.y > 0.0)) continue;  // outside of a spot's cone
      brightest = std::max(brightest, expected.y / e.y);
      darkest = std::min(darkest, expected.y / e.y);
    }
  EXPECT_GT(brightest, 1.5 * darkest) << name << ": the highlight is in the picture";
}

// Forward shading and the path tracer.
TEST_F(ShadingValues, CoatsReflectEveryKindOfLight) {
  const Camera camera = lookingAt({0, 3, 5}, {0, 0, 0}, 0.6);
  const glm::dvec3 lamp{0.2, 3.0, -5.0}, axis = glm::normalize(glm::dvec3(0.0, 0.0, -0.5) - lamp);
  for (const float alpha : {0.55f, 0.18f}) {
    const reference::CoatedSurface surface(kShinyBase, kShinySpecular, static_cast<double>(alpha));
    for (const bool frontUp : {true, false}) {
      const auto expect = [&](const Scene& scene, const char* name, const auto& irradiance) {
        expectHighlight(render(scene, camera), camera, surface, name, irradiance);
        PathTracer::Settings path;
        path.size = kPictureSize;
        path.filter = PixelFilter::centre;
        path.transport = Transport::direct;
        expectHighlight(tracer(scene, camera, path, 1).mean(), camera, surface, name, irradiance);
      };
      const auto falling = [&](const glm::dvec3& p, glm::dvec3& to) {
        const double d = glm::length(lamp - p);
        to = (lamp - p) / d;
        return glm::dvec3(30.0, 20.0, 10.0) * (to.y / (d * d));
      };
      SceneBuilder sun = shinyFloor(alpha, frontUp), point = sun, spot = sun;
      sun.sun({0.02, -3.0, 5.0}, {3.0f, 5.0f, 7.0f});
      const glm::dvec3 toSun = -sun.scene().sun->direction;
      expect(sun.scene(), "sun", [&](const glm::dvec3&, glm::dvec3& to) {
        to = toSun;
        return glm::dvec3(3.0, 5.0, 7.0) * to.y;
      });
      point.scene().points.push_back({lamp, {30.0f, 20.0f, 10.0f}});
      expect(point.scene(), "omnidirectional", falling);
      spot.scene().spots.push_back({lamp, axis, {30.0f, 20.0f, 10.0f}, 0.2, 1.2});
      expect(spot.scene(), "spot", [&](const glm::dvec3& p, glm::dvec3& to) {
        const glm::dvec3 e = falling(p, to);
        const double t = std::clamp((glm::dot(-to, axis) - std::cos(1.2)) / (std::cos(0.2) - std::cos(1.2)), 0.0, 1.0);
        return e * (t * t * (3.0 - 2.0 * t));
      });
    }
  }
}

// ------------------------------------------------------------------------------------------------------ shadow filters

constexpr int kMap = 96;  // texels a side: penumbrae are wide
constexpr double kHeight = 2.0, kHalf = 0.8;  // of the plate that casts the shadow
const glm::dvec2 kTurn{std::cos(0.3), std::sin(0.3)};

bool onPlate(const glm::dvec3& p) {
  const glm::dvec2 q(p.x * kTurn.x + p.z * kTurn.y, -p.x * kTurn.y + p.z * kTurn.x);
  return std::max(std::abs(q.x), std::abs(q.y)) <= kHalf;
}

/// A floor of albedo 1/2 and a turned plate above it.
SceneBuilder plateOverFloor() {
  SceneBuilder builder;
  const int grey = builder.material(glm::vec3(0.5f));
  builder.plate({0, 0, 0}, {0, 0, 6}, {6, 0, 0}, grey);
  const glm::dvec3 u(kTurn.x, 0.0, kTurn.y), v(-kTurn.y, 0.0, kTurn.x);
  builder.plate({0, kHeight, 0}, 2.0 * kHalf * v, 2.0 * kHalf * u, grey);
  builder.scene().sun.reset();
  return builder;
}

/// Fraction seen by 2x2 bilinear comparisons half a texel apart, from a map whose texels the plate covers or not.
/// `clip`: of the receiver, moved along its normal; `w` positive. `tap`: of the comparisons, in texels from there.
double tent(const glm::dmat4& clipFromWorld, const glm::dvec3& receiver, double tap = 0.5) {
  const glm::dvec4 clip = clipFromWorld * glm::dvec4(receiver, 1.0);
  const glm::dvec2 place = (0.5 * glm::dvec2(clip) / clip.w + 0.5) * static_cast<double>(kMap);
  const glm::dmat4 worldFromClip = glm::inverse(clipFromWorld);
  const auto texel = [&](double i, double j) {
    const glm::dvec2 ndc = (glm::dvec2(i, j) + 0.5) / static_cast<double>(kMap) * 2.0 - 1.0;
    const auto at = [&](double depth) {
      const glm::dvec4 p = worldFromClip * glm::dvec4(ndc, depth, 1.0);
      return glm::dvec3(p) / p.w;
    };
    const glm::dvec3 a = at(-0.9), b = at(0.9);
    return onPlate(a + (kHeight - a.y) / (b.y - a.y) * (b - a)) ? 0.0 : 1.0;
  };
  double sum = 0.0;
  for (const double dx : {-tap, tap})
    for (const double dy : {-tap, tap}) {
      const glm::dvec2 q = place + glm::dvec2(dx, dy) - 0.5, low = glm::floor(q), f = q - low;
      sum += 0.25 * ((1 - f.x) * (1 - f.y) * texel(low.x, low.y) + f.x * (1 - f.y) * texel(low.x + 1, low.y) +
                     (1 - f.x) * f.y * texel(low.x, low.y + 1) + f.x * f.y * texel(low.x + 1, low.y + 1));
    }
  return sum;
}

/// Floor pixels against irradiance times the tent; edges of the plate that pass a texel's centre may round either way.
void expectFilter(const Image& image, const Camera& camera, const char* name,
                  const std::function<double(const glm::dvec3&)>& unshadowed,
                  const std::function<double(const glm::dvec3&)>& visible) {
  int between = 0, wrong = 0, pixels = 0;
  for (int y = 0; y < kPictureSize.y; ++y)
    for (int x = 0; x < kPictureSize.x; ++x) {
      const glm::dvec3 p = onPlane(camera, pixelRay(camera, x, y, kPictureSize), 0.0);
      if (std::max(std::abs(p.x), std::abs(p.z)) > 2.5) continue;
      const double fraction = visible(p), expected = 0.5 / kPi * unshadowed(p) * fraction;
      ++pixels;
      between += fraction > 0.02 && fraction < 0.98;
      wrong += std::abs(image.at(x, y).x - expected) > 0.01 * 0.5 / kPi * unshadowed(p);
    }
  EXPECT_GT(between, 60) << name;
  EXPECT_LT(wrong, pixels / 100) << name << ": " << between << " pixels in the penumbra of " << pixels;
}

TEST_F(ShadingValues, ShadowsAreFilteredByATentOfThreeTexels) {
  const Camera camera = lookingAt({0.01, 1.5, 0.02}, {0.01, 0, 0.01}, 1.9);  // below the plate
  RenderSettings s = settings();
  s.shadow.size = s.lights.spotSize = s.lights.pointSize = kMap;
  {
    SceneBuilder builder = plateOverFloor();
    builder.sun({0.1, -1.0, 0.2}, glm::vec3(2.0f));
    const SunFrustum frustum = fitSunFrustum(builder.scene(), builder.scene().sun->direction);
    const double offset = 0.1 * std::max(frustum.width, frustum.height) / kMap;
    expectFilter(
        render(builder.scene(), camera, s), camera, "sun",
        [&](const glm::dvec3&) { return 2.0 * -builder.scene().sun->direction.y; },
        [&](const glm::dvec3& p) { return tent(frustum.clipFromWorld, p + glm::dvec3(0, offset, 0)); });
  }
  {
    SceneBuilder builder = plateOverFloor();
    const glm::dvec3 lamp{0.3, 5.0, 0.2}, axis = glm::normalize(glm::dvec3(-0.05, -1.0, 0.03));
    builder.scene().spots.push_back({lamp, axis, glm::vec3(50.0f), 0.79, 0.8});
    const LightViews views = lightViews(builder.scene().spots[0], builder.scene());
    const auto falloff = [&](const glm::dvec3& p) {
      const glm::dvec3 to = lamp - p;
      const double d = glm::length(to),
                   t = std::clamp((glm::dot(-to / d, axis) - std::cos(0.8)) / (std::cos(0.79) - std::cos(0.8)), 0.0,
                                  1.0);
      return 50.0 * to.y / (d * d * d) * (t * t * (3.0 - 2.0 * t));
    };
    expectFilter(render(builder.scene(), camera, s), camera, "spot", falloff, [&](const glm::dvec3& p) {
      const double depth = glm::dot(p - lamp, axis);
      return tent(views.clipFromWorld[0], p + glm::dvec3(0, 1.5 * views.texelWidth(kMap) * depth, 0));
    });
  }
  {
    // The floor lies in one face of an omnidirectional lamp's cube. Its taps are half a texel apart where the receiver
    // is, and so a little more where it is moved to.
    SceneBuilder builder = plateOverFloor();
    const glm::dvec3 lamp{0.3, 5.0, 0.2};
    builder.scene().points.push_back({lamp, glm::vec3(50.0f)});
    const LightViews views = lightViews(builder.scene().points[0], builder.scene());
    constexpr int kDown = 3;  // of OpenGL's faces: -y
    const double offset = 1.5 * views.texelWidth(kMap) * lamp.y;
    expectFilter(
        render(builder.scene(), camera, s), camera, "omnidirectional",
        [&](const glm::dvec3& p) { return 50.0 * lamp.y / std::pow(glm::length(lamp - p), 3.0); },
        [&](const glm::dvec3& p) {
          return tent(views.clipFromWorld[kDown], p + glm::dvec3(0, offset, 0), 0.5 * lamp.y / (lamp.y - offset));
        });
  }
}

// -------------------------------------------------------------------------------------------------------- display
// curves

double srgb(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055; }  // IEC 61966-2-1

double filmic(double x) {  // [Narkowicz2015]
  x *= 0.6;
  return std::clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

/// 32 upright stripes that shine from 1e-6 to 1e2 and light nothing, each in its own mixture of colours.
constexpr int kStripes = 32;
glm::vec3 stripe(int i) {
  const float value = static_cast<float>(std::pow(10.0, -6.0 + 8.0 * i / (kStripes - 1)));
  return value * glm::vec3(1.0f, i % 2 ? 0.3f : 0.7f, i % 3 ? 0.1f : 0.9f);
}
Scene stripes() {
  SceneBuilder builder;
  for (int i = 0; i < kStripes; ++i) {
    const int shines = builder.material(glm::vec3(0.0f));
    builder.materialAt(shines).emission = stripe(i);
    builder.plate({i + 0.5 - 0.5 * kStripes, 0, 0}, {1, 0, 0}, {0, 20, 0}, shines);
  }
  builder.scene().sun.reset();
  return builder.scene();
}

void expectDisplay(Renderer& renderer, const Camera& camera,
                   const std::function<glm::dvec3(const glm::dvec3&)>& curve) {
  renderer.render(camera);
  const Bitmap bitmap = renderer.readDisplay();
  int differentValues = 0;
  glm::ivec3 last(-1);
  for (int i = 0; i < kStripes; ++i) {
    const glm::dvec3 p{i + 0.5 - 0.5 * kStripes, 0, 0};
    // The stripe's middle, projected by the camera that looks along -z from above the origin.
    const double t = std::tan(0.5 * camera.verticalFov) * camera.position.z * kPictureSize.x / kPictureSize.y;
    const int x = static_cast<int>((p.x / t * 0.5 + 0.5) * kPictureSize.x), y = kPictureSize.y / 2;
    const glm::dvec3 expected = 255.0 * curve(glm::dvec3(stripe(i)));
    const std::uint8_t* found = &bitmap.rgba[static_cast<std::size_t>(4 * (y * kPictureSize.x + x))];
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 0.6) << "stripe " << i << " channel " << c;
    const glm::ivec3 now(found[0], found[1], found[2]);
    differentValues += now != last;
    last = now;
  }
  EXPECT_GT(differentValues, kStripes / 3);
}

const Camera kBeforeStripes = [] {
  Camera camera = lookingAt({0, 0, 10}, {0, 0, 0});
  camera.verticalFov = 2.0 * std::atan(0.5 * kStripes / 10.0 * kPictureSize.y / kPictureSize.x);
  return camera;
}();

TEST_F(ShadingValues, TheDisplayCurveIsTheFilmicOneAndSrgb) {
  const Scene scene = stripes();
  Renderer renderer(context(), library(), scene, settings());
  for (const float exposure : {0.01f, 1.0f, 30.0f}) {
    renderer.setExposure(exposure);
    expectDisplay(renderer, kBeforeStripes, [&](const glm::dvec3& v) {
      glm::dvec3 shown;
      for (int c = 0; c < 3; ++c) shown[c] = srgb(filmic(exposure * v[c]));
      return shown;
    });
  }
}

TEST_F(ShadingValues, RadiositysMappingsAreLinearLogarithmicAndFalseColours) {
  using Mapping = RadiosityView::Mapping;
  Scene scene = stripes();
  for (const Mapping mapping : {Mapping::linear, Mapping::logarithmic, Mapping::falseColours})
    for (const float decades : {4.0f, 6.0f}) {
      RenderSettings s = settings("radiosity");
      s.of<RadiosityView::Settings>().mapping = mapping;
      s.of<RadiosityView::Settings>().decades = decades;
      s.of<RadiosityView::Settings>().solution.wholeTriangles = true;
      s.of<RadiosityView::Settings>().solution.hemicubes.resolution = 16;
      Renderer renderer(context(), library(), scene, s);
      const double exposure = 0.5;
      renderer.setExposure(static_cast<float>(exposure));
      const auto position = [&](double v) {
        return std::clamp(1.0 + std::log10(std::max(v, 1e-30)) / decades, 0.0, 1.0);
      };
      expectDisplay(renderer, kBeforeStripes, [&](glm::dvec3 v) {
        v *= exposure;
        if (mapping == Mapping::linear)
          return glm::dvec3(srgb(std::min(v.x, 1.0)), srgb(std::min(v.y, 1.0)), srgb(std::min(v.z, 1.0)));
        if (mapping == Mapping::logarithmic) return glm::dvec3(position(v.x), position(v.y), position(v.z));
        // Black, blue, cyan, green, yellow, red, white, a sixth of the range each.
        constexpr std::array<std::array<double, 3>, 8> kColours{
            {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {1, 1, 1}, {1, 1, 1}}};
        const double at = 6.0 * position(0.2126 * v.x + 0.7152 * v.y + 0.0722 * v.z);
        const auto i = static_cast<std::size_t>(at);
        glm::dvec3 colour;
        for (int c = 0; c < 3; ++c) {
          const auto k = static_cast<std::size_t>(c);
          colour[c] = kColours[i][k] + (at - static_cast<double>(i)) * (kColours[i + 1][k] - kColours[i][k]);
        }
        return colour;
      });
    }
}

}  // namespace
}  // namespace lucerna
