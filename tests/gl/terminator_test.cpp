// Direct light on coarse meshes with smooth normals against the curved surface that they stand for, in double
// precision: no face at the terminator is dark as a whole, and no light passes through a mesh that is seen from inside.
#include "base/angles.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/renderer.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

namespace lucerna {
namespace {

constexpr int kPixels = 64;
constexpr double kViewHeight = 2.4;
const glm::dvec3 kFromTheSide = glm::normalize(glm::dvec3(-1.0, -0.2, -0.2));

enum class Side { outside, inside };

/// A white ball of radius 1 of 16 x 8 faces about the origin, seen along -z from outside, or from its middle.
Scene coarseBall(Side side) {
  constexpr int kAround = 16, kDown = 8;
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].diffuse = glm::vec3(1.0f);
  for (int j = 0; j <= kDown; ++j)
    for (int i = 0; i <= kAround; ++i) {
      const double theta = kPi * j / kDown, phi = 2.0 * kPi * i / kAround;
      const glm::vec3 p(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      scene.vertices.push_back({p, {}, p});
      scene.bounds.add(p);
    }
  for (std::uint32_t j = 0; j < kDown; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const std::uint32_t a = j * (kAround + 1) + i, b = a + kAround + 1;
      for (const std::uint32_t k : {a, a + 1, b, a + 1, b + 1, b}) scene.indices.push_back(k);
    }
  scene.meshes.resize(1);
  scene.meshes[0].indexCount = static_cast<std::uint32_t>(scene.indices.size());
  scene.meshes[0].bounds = scene.bounds;
  Camera camera;
  camera.position = {0.0, 0.0, side == Side::outside ? 3.0 : 0.0};
  camera.orthographicHeight = kViewHeight * (side == Side::outside ? 1.0 : 0.5);
  scene.cameras = {camera};
  return scene;
}

struct Seen {
  glm::dvec3 position, normal;
};

/// The nearest surface in front of a pixel's middle; row 0 is the top.
std::optional<Seen> seenAt(const Scene& scene, int x, int y) {
  const Camera& camera = scene.cameras.front();
  const glm::dvec2 place =
      (glm::dvec2(x, kPixels - 1 - y) + 0.5) * (camera.orthographicHeight / kPixels) - 0.5 * camera.orthographicHeight;
  std::optional<Seen> seen;
  for (std::size_t t = 0; t < scene.indices.size(); t += 3) {
    std::array<Vertex, 3> v;
    for (std::size_t k = 0; k < 3; ++k) v[k] = scene.vertices[scene.indices[t + k]];
    const auto area = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
    const glm::dvec2 a = glm::dvec2(v[0].position) - place, b = glm::dvec2(v[1].position) - place,
                     c = glm::dvec2(v[2].position) - place;
    const double whole = area(b - a, c - a);
    const glm::dvec3 w = glm::dvec3(area(b, c), area(c, a), area(a, b)) / whole;
    if (!(std::abs(whole) > 1e-9) || std::min({w.x, w.y, w.z}) < 0.0) continue;
    Seen here{};
    for (std::size_t k = 0; k < 3; ++k) {
      here.position += w[static_cast<int>(k)] * glm::dvec3(v[k].position);
      here.normal += w[static_cast<int>(k)] * glm::dvec3(v[k].normal);
    }
    if (here.position.z > camera.position.z || (seen && seen->position.z > here.position.z)) continue;
    seen = Seen{here.position, glm::normalize(here.normal)};
  }
  return seen;
}

struct Way {
  const char* name;
  std::string technique;
  ShadowTransport shadows = ShadowTransport::map;
};
const Way kMaps{"maps", "direct"}, kRays{"rays", "direct", ShadowTransport::rays}, kPaths{"paths", "path"};

class Terminator : public test::GlTest {
 protected:
  Image picture(const Scene& scene, const Way& way) {
    if (way.technique == "path") {
      PathTracer::Settings settings;
      settings.size = {kPixels, kPixels};
      settings.transport = Transport::direct;
      settings.filter = PixelFilter::centre;
      PathTracer tracer(context(), programs(), scene, settings);
      tracer.setCamera(scene.cameras.front());
      tracer.record(1);
      return tracer.mean();
    }
    RenderSettings settings;
    settings.technique = way.technique;
    settings.size = {kPixels, kPixels};
    settings.fullFloatTarget = true;
    settings.shadows = way.shadows;
    Renderer renderer(context(), programs(), scene, settings);
    renderer.renderToTheEnd(scene.cameras.front());
    return renderer.readRadiance();
  }
  /// E / pi of the light on the curved surface; toLight's length is the distance, or 1 for the sun.
  void expectSmooth(const Scene& scene, const Way& way, double intensity,
                    const std::function<glm::dvec3(glm::dvec3)>& toLight) {
    const Image image = picture(scene, way);
    double worst = 0.0;
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x) {
        const std::optional<Seen> seen = seenAt(scene, x, y);
        if (!seen || seen->normal.z < 0.3) continue;
        const glm::dvec3 away = toLight(seen->position);
        const double d2 = glm::dot(away, away),
                     right = intensity * std::max(0.0, glm::dot(seen->normal, away)) / (std::sqrt(d2) * d2 * kPi);
        worst = std::max(worst, std::abs(image.at(x, y).x - right));
      }
    std::printf("%s: at most %.4f from the curved surface's light\n", way.name, worst);
    EXPECT_LT(worst, 1e-3) << way.name;
  }
};

TEST_F(Terminator, OfACoarseBallIsThatOfTheCurvedSurface) {
  const glm::dvec3 lamp = -4.0 * kFromTheSide;
  const auto toLamp = [&](glm::dvec3 p) { return lamp - p; };
  for (const Way* way : {&kMaps, &kRays, &kPaths}) {
    Scene scene = coarseBall(Side::outside);
    scene.sun = DirectionalLight{kFromTheSide, glm::vec3(3.0f)};
    expectSmooth(scene, *way, 3.0, [](glm::dvec3) { return -kFromTheSide; });
    scene.sun.reset();
    scene.points = {PointLight{lamp, glm::vec3(48.0f)}};
    expectSmooth(scene, *way, 48.0, toLamp);
    scene.points.clear();
    scene.spots = {SpotLight{lamp, kFromTheSide, glm::vec3(48.0f), 0.6, 0.7}};
    expectSmooth(scene, *way, 48.0, toLamp);
  }
}

// Not by maps: they are looked up at an offset along the normal, which leads out of this coarse ball.
TEST_F(Terminator, NoLightComesThroughAMeshSeenFromInside) {
  Scene scene = coarseBall(Side::inside);
  scene.sun = DirectionalLight{kFromTheSide, glm::vec3(3.0f)};
  scene.points = {PointLight{-4.0 * kFromTheSide, glm::vec3(48.0f)}};
  scene.spots = {SpotLight{{0.0, 3.0, 0.0}, {0.0, -1.0, 0.0}, glm::vec3(48.0f), 0.6, 0.7}};
  for (const Way* way : {&kRays, &kPaths}) {
    const Image image = picture(scene, *way);
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x) EXPECT_LT(image.at(x, y).x, 1e-6) << way->name << ' ' << x << ' ' << y;
  }
}

}  // namespace
}  // namespace lucerna
