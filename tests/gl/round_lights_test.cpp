// Lights with a size: the sun's disc and lamps' balls against closed forms, in the path tracer and by shadow rays; and
// shadow rays against maps where a light has no size.
#include "base/angles.hpp"
#include "pathtracer/path_tracer.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

namespace lucerna {
namespace {

constexpr int kFloorPixels = 32, kFloorRows = 2;
constexpr double kFloorLength = 4.0;  ///< of the picture along x, scene units

/// A white floor of y = 0, seen from below the blocker, which covers x < 0 at y = 2.
struct HalfCoveredFloor : Scene {
  explicit HalfCoveredFloor(bool blocked, double height = 2.0) {
    materials.resize(1);
    materials[0].diffuse = glm::vec3(1.0f);
    meshes.resize(1);
    add(0.0, -50.0, 50.0);
    if (blocked) add(height, -50.0, 0.0);
    meshes[0].indexCount = static_cast<std::uint32_t>(indices.size());
    meshes[0].bounds = bounds;
    Camera camera;
    camera.position = {0.0, 1.0, 0.0};
    camera.direction = {0.0, -1.0, 0.0};
    camera.up = {0.0, 0.0, -1.0};
    camera.orthographicHeight = kFloorLength * kFloorRows / kFloorPixels;
    cameras = {camera};
  }
  void add(double y, double from, double to) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const glm::dvec3& p :
         {glm::dvec3(from, y, 50), glm::dvec3(to, y, 50), glm::dvec3(to, y, -50), glm::dvec3(from, y, -50)}) {
      vertices.push_back({glm::vec3(p), {}, {0, 1, 0}});
      bounds.add(p);
    }
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + i);
  }
};

double placeOf(int x) { return kFloorLength * ((x + 0.5) / kFloorPixels - 0.5); }

class RoundLights : public test::GlTest {
 protected:
  Image traced(const Scene& scene, std::uint32_t samples = 4096) {
    PathTracer::Settings settings;
    settings.size = {kFloorPixels, kFloorRows};
    settings.transport = Transport::direct;
    settings.filter = PixelFilter::centre;
    PathTracer tracer(context(), programs(), scene, settings);
    tracer.setCamera(scene.cameras.front());
    tracer.record(samples);
    return tracer.mean();
  }
  Image drawn(const Scene& scene, ShadowTransport shadows, int samples, std::string_view technique = "direct",
              ShadowFilter filter = ShadowFilter::pcss) {
    RenderSettings settings;
    settings.shadow.filter = filter;
    settings.shadow.size = 4096;
    settings.technique = technique;
    settings.component = Component::direct;
    settings.of<RadiosityView::Settings>().direct = RadiosityView::Direct::pixels;
    settings.size = {kFloorPixels, kFloorRows};
    settings.fullFloatTarget = true;
    settings.pixelSamples = samples;
    settings.filter = PixelFilter::centre;
    settings.shadows = shadows;
    Renderer renderer(context(), programs(), scene, settings);
    renderer.renderToTheEnd(scene.cameras.front());
    return renderer.readRadiance();
  }
};

/// The share of a disc beyond a line at `place` radii from its centre.
double shareOfDisc(double place) {
  const double u = std::clamp(place, -1.0, 1.0);
  return 0.5 + (u * std::sqrt(1.0 - u * u) + std::asin(u)) / kPi;
}

TEST_F(RoundLights, ThePenumbraOfASunIsTheShareOfItsDisc) {
  HalfCoveredFloor scene(true);
  for (const double degrees : {0.53, 20.0}) {
    scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(static_cast<float>(kPi)), degrees * kDegree};
    const double radius = 2.0 * std::tan(0.5 * degrees * kDegree);
    for (const bool isTraced : {true, false}) {
      const Image image = isTraced ? traced(scene) : drawn(scene, ShadowTransport::rays, 256);
      double worst = 0.0;
      for (int x = 0; x < kFloorPixels; ++x)
        worst = std::max(worst, std::abs(image.at(x, 0).x - shareOfDisc(placeOf(x) / radius)));
      std::printf("penumbra of %g degrees, %s: at most %.4f off\n", degrees, isTraced ? "paths" : "shadow rays", worst);
      EXPECT_LT(worst, 0.03) << degrees << isTraced;
    }
  }
}

// Points on the disc are stratified over neighbouring pixels: the error of the mean of four is less than half of one's.
TEST_F(RoundLights, NeighboursShareTheNoiseOfAPenumbra) {
  HalfCoveredFloor scene(true);
  double ofPixels = 0.0, ofSquares = 0.0;
  for (const double degrees : {40.0, 45.0, 50.0, 55.0, 60.0, 65.0}) {
    scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(static_cast<float>(kPi)), degrees * kDegree};
    const Image right = drawn(scene, ShadowTransport::rays, 1024);
    for (const int samples : {2, 4, 8}) {
      const Image image = drawn(scene, ShadowTransport::rays, samples);
      for (int x = 0; x < kFloorPixels; x += 2) {
        double sum = 0.0;
        for (int k = 0; k < 4; ++k) {
          const double error = static_cast<double>(image.at(x + k % 2, k / 2).x - right.at(x + k % 2, k / 2).x);
          sum += error;
          ofPixels += 0.25 * error * error;
        }
        ofSquares += 0.0625 * sum * sum;
      }
    }
  }
  std::printf("mean of four pixels: %.3f of the error of one\n", std::sqrt(ofSquares / ofPixels));
  EXPECT_LT(ofSquares, 0.18 * ofPixels);  // 0.21 where each pixel has points of its own
}

// By maps: the share of taps within the disc that the blocker's depth gives, against the disc's.
TEST_F(RoundLights, PenumbraeOfMapsAreAsWideAsTheBlockerIsFar) {
  for (const double height : {2.0, 0.9, 0.02}) {
    HalfCoveredFloor scene(true, height);
    scene.cameras.front().position.y = std::min(1.0, 0.5 * height);
    scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(static_cast<float>(kPi)), 20.0 * kDegree};
    const double radius = height * std::tan(10.0 * kDegree), texel = 0.025;
    for (const int samples : {1, 64}) {
      const Image image = drawn(scene, ShadowTransport::map, samples);
      double worst = 0.0, mean = 0.0;
      for (int x = 0; x < kFloorPixels; ++x) {
        const double place = placeOf(x), value = static_cast<double>(image.at(x, 0).x);
        worst = std::max(worst, std::abs(value - shareOfDisc(place / radius)));
        mean += (value - shareOfDisc(place / radius)) / kFloorPixels;
        const bool isOutside = std::abs(place) > radius + 2.0 * texel;
        EXPECT_TRUE(!isOutside || value == (place > 0.0 ? 1.0 : 0.0)) << height << " " << x << " " << value;
      }
      std::printf("blocker %g above, %d samples: at most %.4f off, %+.4f on average\n", height, samples, worst, mean);
      EXPECT_LT(worst, samples == 1 ? 0.20 : 0.03) << height;
      EXPECT_LT(std::abs(mean), samples == 1 ? 0.02 : 0.005) << height;
    }
  }
}

// Under a slanting roof, from where the tent finds it to where it is distant, no place is lit. The map has ten times as
// many texels along x as across, so that the penumbra's taps reach far beyond the tent.
TEST_F(RoundLights, NoLightPassesBetweenWhatIsNearAndWhatIsDistant) {
  HalfCoveredFloor scene(false);
  for (Vertex& v : scene.vertices) v.position.x *= 0.1f;
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (const glm::vec2& p : {glm::vec2(-5, 50), glm::vec2(5, 50), glm::vec2(5, -50), glm::vec2(-5, -50)})
    scene.vertices.push_back({glm::vec3(p.x, 1.7f + 0.75f * p.x, p.y), {}, {0, 1, 0}});
  for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) scene.indices.push_back(first + i);
  scene.bounds = {};
  for (const Vertex& v : scene.vertices) scene.bounds.add(glm::dvec3(v.position));
  scene.meshes[0].indexCount = static_cast<std::uint32_t>(scene.indices.size());
  scene.meshes[0].bounds = scene.bounds;
  scene.cameras.front().position.y = 0.1;
  float brightest = 0.0f;
  for (double degrees = 1.8; degrees < 2.2; degrees += 0.02) {  // so that the limit meets the middle of a pixel
    scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(static_cast<float>(kPi)), degrees * kDegree};
    for (const glm::vec3& pixel : drawn(scene, ShadowTransport::map, 4).pixels)
      brightest = std::max(brightest, pixel.x);
  }
  EXPECT_EQ(brightest, 0.0f);
}

TEST_F(RoundLights, PenumbraeOfASlantingSunInAMapAreThoseOfPaths) {
  HalfCoveredFloor scene(true);
  scene.cameras.front().position.x = 1.6;
  scene.sun =
      DirectionalLight{glm::normalize(glm::dvec3(0.8, -1.0, 0.3)), glm::vec3(static_cast<float>(kPi)), 10.0 * kDegree};
  const Image map = drawn(scene, ShadowTransport::map, 64), paths = traced(scene);
  for (int x = 0; x < kFloorPixels; ++x) EXPECT_NEAR(map.at(x, 0).x, paths.at(x, 0).x, 0.04) << x;
}

// A second blocker near the floor: it does not narrow the first one's penumbra beside it, and below it, there is no
// light, though the first one's penumbra is partly lit.
TEST_F(RoundLights, PenumbraeOfMapsTellNearBlockersFromFarOnes) {
  HalfCoveredFloor scene(true);
  scene.add(0.3, 0.45, 1.0);
  scene.add(0.02, 0.1, 0.2);
  scene.meshes[0].indexCount = static_cast<std::uint32_t>(scene.indices.size());
  scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(static_cast<float>(kPi)), 20.0 * kDegree};
  scene.cameras.front().position.y = 0.01;
  const Image image = drawn(scene, ShadowTransport::map, 64);
  for (int x = 0; x < kFloorPixels; ++x) {
    const double place = placeOf(x), share = shareOfDisc(place / (2.0 * std::tan(10.0 * kDegree)));
    const bool isBelow = place > 0.13 && place < 0.17;
    if (place < 0.07 || isBelow || (place > 0.23 && place < 0.38)) {
      EXPECT_NEAR(image.at(x, 0).x, isBelow ? 0.0 : share, isBelow ? 0.0 : 0.06) << place;
    }
  }
}

TEST_F(RoundLights, PenumbraeOfLampsInMapsAreThoseOfTheirBalls) {
  HalfCoveredFloor scene(true);
  for (const bool isSpot : {false, true}) {
    // Below the lamp, half-way to the corner of its view, and at the edge of a cube map's face.
    for (const glm::dvec2& aside : {glm::dvec2(0.0, 0.0), glm::dvec2(1.9, 1.9), glm::dvec2(2.0, 0.0)}) {
      scene.points.clear();
      scene.spots.clear();
      const glm::dvec3 place(-aside.x, 4.0, aside.y);
      scene.cameras.front().position.x = aside.x;
      if (isSpot) scene.spots = {SpotLight{place, {0, -1, 0}, glm::vec3(16.0f), 1.2, 1.39, 0.5}};
      else scene.points = {PointLight{place, glm::vec3(16.0f), 0.5}};
      const Image maps = drawn(scene, ShadowTransport::map, 64), paths = traced(scene),
                  tent = drawn(scene, ShadowTransport::map, 64, "direct", ShadowFilter::tent);
      double worst = 0.0, ofTent = 0.0, largest = 0.0;
      for (int x = 0; x < kFloorPixels; ++x) {
        largest = std::max(largest, static_cast<double>(paths.at(x, 0).x));
        worst = std::max(worst, static_cast<double>(std::abs(maps.at(x, 0).x - paths.at(x, 0).x)));
        ofTent = std::max(ofTent, static_cast<double>(std::abs(tent.at(x, 0).x - paths.at(x, 0).x)));
      }
      std::printf("%s, %g aside: at most %.4f of the light off, without penumbrae %.4f\n", isSpot ? "spot" : "lamp",
                  aside.x, worst / largest, ofTent / largest);
      // On a slanting plane the blockers found are not all as far as the edge.
      EXPECT_LT(worst, (aside.x > 0.0 ? 0.085 : 0.01) * largest) << isSpot << aside.x;
      EXPECT_GT(ofTent, 0.2 * largest) << isSpot << aside.x;
    }
  }
}

// A floor that nothing covers is lit, however low the sun; a fifth of a texel below what covers it, it is dark.
TEST_F(RoundLights, PenumbraeOfMapsLeaveNoAcneAndNoLightAtAContact) {
  for (const double slope : {1.0, 0.1, 0.03}) {
    HalfCoveredFloor open(false), covered(true, 0.005);
    covered.cameras.front().position.y = 0.002;
    open.sun = covered.sun =
        DirectionalLight{glm::normalize(glm::dvec3(0.3, -slope, 1.0)), glm::vec3(1.0f), 0.53 * kDegree};
    const Image lit = drawn(open, ShadowTransport::map, 4), dark = drawn(covered, ShadowTransport::map, 4);
    const double right = -open.sun->direction.y / kPi;
    for (int x = 0; x < kFloorPixels; ++x) {
      EXPECT_NEAR(lit.at(x, 0).x, right, 1e-4 * right) << slope << " " << x;
      EXPECT_TRUE(placeOf(x) > -0.1 || dark.at(x, 0).x == 0.0f) << slope << " " << x << " " << dark.at(x, 0).x;
    }
  }
}

// What lights without a size leave out: the lookups of penumbrae.
TEST_F(RoundLights, LightsWithoutASizeAreFilteredByTheTentAlone) {
  HalfCoveredFloor scene(true);
  scene.sun = DirectionalLight{glm::normalize(glm::dvec3(0.1, -1.0, 0.0)), glm::vec3(1.0f)};
  scene.spots = {SpotLight{{0.5, 3.0, 0.2}, {0, -1, 0}, glm::vec3(3.0f, 1.0f, 1.0f), 0.9, 1.2}};
  scene.points = {PointLight{{-0.4, 1.2, 0.3}, glm::vec3(0.0f, 0.0f, 1.0f)}};
  const Image pcss = drawn(scene, ShadowTransport::map, 4),
              tent = drawn(scene, ShadowTransport::map, 4, "direct", ShadowFilter::tent);
  EXPECT_TRUE(pcss.pixels == tent.pixels);
}

TEST_F(RoundLights, RadiositysPicturesHavePenumbraeOfSunsAndLamps) {
  HalfCoveredFloor scene(true);
  scene.materials[0].diffuse = glm::vec3(0.5f);
  scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(static_cast<float>(kPi)), 20.0 * kDegree};
  const Image sun = drawn(scene, ShadowTransport::map, 256, "radiosity");
  for (int x = 0; x < kFloorPixels; ++x)
    EXPECT_NEAR(sun.at(x, 0).x, 0.5 * shareOfDisc(placeOf(x) / (2.0 * std::tan(10.0 * kDegree))), 0.02) << x;
  scene.sun.reset();
  scene.points = {PointLight{{0.0, 4.0, 0.0}, glm::vec3(16.0f), 0.5}};
  const Image lamp = drawn(scene, ShadowTransport::map, 256, "radiosity");
  EXPECT_NEAR((lamp.at(kFloorPixels / 2 - 1, 0).x + lamp.at(kFloorPixels / 2, 0).x) / 2.0, 0.25 / kPi, 0.006 / kPi);
}

TEST_F(RoundLights, AnUnblockedBallShinesAsItsCentre) {
  HalfCoveredFloor scene(false);
  for (const double radius : {0.0, 0.1, 0.9}) {
    for (const bool isSpot : {false, true}) {
      scene.points.clear();
      scene.spots.clear();
      const glm::dvec3 place(0.3, 1.5, 0.0);
      if (isSpot) scene.spots = {SpotLight{place, {0, -1, 0}, glm::vec3(2.0f), 1.39, 1.39, radius}};
      else scene.points = {PointLight{place, glm::vec3(2.0f), radius}};
      const Image paths = traced(scene), rays = drawn(scene, ShadowTransport::rays, 16);
      for (int x = 0; x < kFloorPixels; ++x) {
        const double away = placeOf(x) - 0.3, beside = 0.5 * kFloorLength / kFloorPixels,
                     distance2 = away * away + 1.5 * 1.5 + beside * beside,
                     right = 2.0 / kPi * 1.5 / std::pow(distance2, 1.5);
        EXPECT_NEAR(paths.at(x, 0).x / right, 1.0, 0.02) << radius << isSpot << " " << x;
        EXPECT_NEAR(rays.at(x, 0).x / right, 1.0, 2e-3) << radius << isSpot << " " << x;
      }
    }
  }
}

TEST_F(RoundLights, BesideAnEdgeBelowItsCentreHalfABallIsSeen) {
  HalfCoveredFloor scene(true);
  scene.points = {PointLight{{0.0, 4.0, 0.0}, glm::vec3(16.0f), 0.5}};
  const double half = 0.5 / kPi;  // of 16 / 4^2, over pi
  for (const bool isTraced : {true, false}) {
    const Image image = isTraced ? traced(scene) : drawn(scene, ShadowTransport::rays, 256);
    EXPECT_NEAR((image.at(kFloorPixels / 2 - 1, 0).x + image.at(kFloorPixels / 2, 0).x) / 2.0, half, 0.02 * half)
        << isTraced;
    // The ball's rims at x = -0.5 and 0.5, seen past the edge at half the height: shadow from -1/2 on, light from 1/2.
    EXPECT_EQ(image.at(0, 0).x, 0.0f);
    EXPECT_NEAR(image.at(kFloorPixels - 1, 0).x * kPi,
                std::pow(1.0 + std::pow(placeOf(kFloorPixels - 1) / 4.0, 2.0), -1.5), 0.02);
  }
}

TEST_F(RoundLights, LightsWithoutASizeHaveTheShadowsOfMaps) {
  HalfCoveredFloor scene(true);
  scene.sun = DirectionalLight{glm::normalize(glm::dvec3(0.1, -1.0, 0.0)), glm::vec3(1.0f)};
  scene.spots = {SpotLight{{0.5, 3.0, 0.2}, {0, -1, 0}, glm::vec3(3.0f, 1.0f, 1.0f), 0.9, 1.2}};
  scene.points = {PointLight{{-0.4, 1.2, 0.3}, glm::vec3(0.0f, 0.0f, 1.0f)}};
  for (int kind = 0; kind < 3; ++kind) {  // each alone, without the noise of choosing among them
    HalfCoveredFloor one = scene;
    if (kind != 0) one.sun.reset();
    if (kind != 1) one.spots.clear();
    if (kind != 2) one.points.clear();
    const Image maps = drawn(one, ShadowTransport::map, 1), rays = drawn(one, ShadowTransport::rays, 1),
                paths = traced(one, 4);
    int alike = 0;
    for (int x = 0; x < kFloorPixels; ++x) {
      EXPECT_LT(glm::length(rays.at(x, 0) - paths.at(x, 0)), 1e-4f * glm::length(paths.at(x, 0)) + 1e-7f)
          << kind << " " << x;
      alike += glm::length(rays.at(x, 0) - maps.at(x, 0)) < 0.01f * glm::length(maps.at(x, 0)) + 1e-6f;
    }
    EXPECT_GE(alike, kFloorPixels - 3) << kind;  // but for the maps' filter, at the edge
  }
}

// With maps, all but four by rays; of more than 128 lamps, bits in a second layer.
TEST_F(RoundLights, AllOfManyLampsHaveShadows) {
  HalfCoveredFloor scene(true);
  for (int i = 0; i < 140; ++i)  // the last twelve are below what covers the floor
    scene.points.push_back({{-0.3 - 0.001 * i, i < 128 ? 3.0 : 1.5, 0.0}, glm::vec3(1.0f)});
  for (int i = 0; i < 3; ++i)
    scene.spots.push_back({{-0.3 - 0.001 * i, 3.0, 0.0}, {0.0, -1.0, 0.0}, glm::vec3(1.0f), 1.1, 1.2});
  const Image paths = traced(scene, 2048);
  for (const ShadowTransport transport : {ShadowTransport::map, ShadowTransport::rays}) {
    const Image image = drawn(scene, transport, 1);
    for (const int x : {0, kFloorPixels - 1}) EXPECT_NEAR(image.at(x, 0).x / paths.at(x, 0).x, 1.0, 0.04) << x;
  }
}

// Of more lamps than have maps, one is carried from where it lights the floor to above what covers it.
TEST_F(RoundLights, ACarriedLampHasItsShadow) {
  HalfCoveredFloor scene(true);
  for (int i = 0; i < 6; ++i) scene.points.push_back({{-1.0, 3.0 + 0.1 * i, 0.0}, glm::vec3(1.0f)});
  for (std::size_t carried = 0; carried < scene.points.size(); ++carried) {
    HalfCoveredFloor moving = scene;
    moving.points[carried].position = {-1.0, 1.5, 0.3};
    RenderSettings settings;
    settings.technique = "direct";
    settings.size = {kFloorPixels, kFloorRows};
    settings.fullFloatTarget = true;
    Renderer renderer(context(), programs(), moving, settings);
    renderer.render(moving.cameras.front());
    EXPECT_GT(renderer.readRadiance().at(8, 0).x, 0.1f) << carried;
    moving.points[carried] = scene.points[carried];
    SceneChange change;
    change.lamps = true;
    ASSERT_TRUE(renderer.follow(context(), programs(), moving, change));
    renderer.render(moving.cameras.front());
    EXPECT_EQ(renderer.readRadiance().at(8, 0).x, 0.0f) << carried;
  }
}

}  // namespace
}  // namespace lucerna
