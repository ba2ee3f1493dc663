// Spot, omnidirectional and cascaded lights on GL: irradiance, shadows, flux and area of reflective shadow maps, what
// is left out.
#include "base/angles.hpp"
#include "base/log.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "lpv/settings.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/renderer.hpp"
#include "rsm/rsm_frame.hpp"
#include "rsm/rsm_gather.hpp"
#include "support/gl_fixture.hpp"
#include "support/sun_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>

namespace lucerna {
namespace {

constexpr float kAlbedo = 0.6f;

/// Quads of one grey material; a quad's front is where its corners run anticlockwise.
struct LitScene : Scene {
  LitScene() {
    materials.resize(1);
    materials[0].diffuse = glm::vec3(kAlbedo);
    meshes.resize(1);
    cameras.resize(1);
  }
  void quad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    const glm::vec3 normal(glm::normalize(glm::cross(b - a, c - a)));
    for (const glm::dvec3& p : {a, b, c, d}) {
      vertices.push_back({glm::vec3(p), {}, normal});
      bounds.add(p);
    }
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + i);
    meshes[0].indexCount = static_cast<std::uint32_t>(indices.size());
    meshes[0].bounds = bounds;
  }
  /// A rectangle across an axis at `at` along it, u and v the next two axes; its front looks towards the origin.
  void across(int axis, double at, glm::dvec2 low, glm::dvec2 high) {
    const auto p = [&](double u, double v) {
      glm::dvec3 result;
      result[axis] = at;
      result[(axis + 1) % 3] = u;
      result[(axis + 2) % 3] = v;
      return result;
    };
    if (at > 0.0) quad(p(low.x, low.y), p(low.x, high.y), p(high.x, high.y), p(high.x, low.y));
    else quad(p(low.x, low.y), p(high.x, low.y), p(high.x, high.y), p(low.x, high.y));
  }
  void room(double half) {
    for (int axis = 0; axis < 3; ++axis)
      for (const double at : {-half, half}) across(axis, at, glm::dvec2(-half), glm::dvec2(half));
  }
};

Camera viewFrom(const glm::dvec3& position, const glm::dvec3& direction, double fov) {
  Camera camera;
  camera.position = position;
  camera.direction = glm::normalize(direction);
  const glm::dvec3 up = std::abs(camera.direction.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, up));
  camera.up = glm::cross(right, camera.direction);
  camera.verticalFov = fov;
  return camera;
}

class LightsGl : public test::SharedProgramsTest {
 protected:
  static RenderSettings settings(std::string_view technique, glm::ivec2 size) {
    RenderSettings s;
    s.technique = technique;
    s.size = size;
    s.fullFloatTarget = true;
    return s;
  }
  /// Direct light of a plane seen whole: calls check(point, irradiance) for each pixel; the plane is dot(n, p) = h.
  void eachPixel(const LitScene& scene, const Camera& camera, const glm::dvec3& n, double h,
                 const std::function<void(const glm::dvec3&, double)>& check) {
    constexpr int kSize = 96;
    Renderer renderer(context(), programs(), scene, settings("direct", {kSize, kSize}));
    renderer.render(camera);
    const Image image = renderer.readRadiance();
    const glm::dvec3 right = glm::cross(camera.direction, camera.up);
    const double t = std::tan(0.5 * camera.verticalFov);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double u = t * (2.0 * (x + 0.5) / kSize - 1.0), v = t * (1.0 - 2.0 * (y + 0.5) / kSize);
        const glm::dvec3 ray = camera.direction + u * right + v * camera.up;
        const glm::dvec3 p = camera.position + ray * ((h - glm::dot(n, camera.position)) / glm::dot(n, ray));
        check(p, static_cast<double>(image.at(x, y).x) * kPi / static_cast<double>(kAlbedo));
      }
  }
};

TEST_F(LightsGl, APointLightOnAPlateFallsWithTheSquareOfTheDistance) {
  LitScene scene;
  scene.quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0});
  const PointLight light{{0.3, 0.2, 0.7}, glm::vec3(5.0f)};
  scene.points = {light};
  double largest = 0.0;
  eachPixel(scene, viewFrom({0, 0, 3}, {0, 0, -1}, 1.0), {0, 0, 1}, 0.0, [&](const glm::dvec3& p, double irradiance) {
    const glm::dvec3 away = light.position - p;
    const double expected = 5.0 * away.z / std::pow(glm::length(away), 3.0);
    largest = std::max(largest, std::abs(irradiance / expected - 1.0));
  });
  EXPECT_LT(largest, 1e-3);
  std::cout << "[ measured ] point on a plate, largest relative error: " << largest << "\n";
}

TEST_F(LightsGl, ASpotFallsOffBetweenItsAngles) {
  LitScene scene;
  scene.quad({-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0});
  SpotLight light;
  light.position = {0.5, -0.4, 1.5};
  light.direction = glm::normalize(glm::dvec3(-0.3, 0.2, -1.0));
  light.intensity = glm::vec3(5.0f);
  light.innerAngle = 0.3;
  light.outerAngle = 0.6;
  scene.spots = {light};
  double largest = 0.0;
  int full = 0, none = 0, between = 0;
  eachPixel(scene, viewFrom({0, 0, 3}, {0, 0, -1}, 1.2), {0, 0, 1}, 0.0, [&](const glm::dvec3& p, double irradiance) {
    const glm::dvec3 away = light.position - p;
    const double cosine = -glm::dot(away, light.direction) / glm::length(away);
    const double t = std::clamp((cosine - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6)), 0.0, 1.0);
    const double unit = 5.0 * away.z / std::pow(glm::length(away), 3.0);
    largest = std::max(largest, std::abs(irradiance / unit - t * t * (3.0 - 2.0 * t)));
    if (t == 1.0) ++full;
    else if (t > 0.0) ++between;
    else ++none;
    if (t == 0.0) { EXPECT_EQ(irradiance, 0.0); }
  });
  EXPECT_LT(largest, 1e-3);
  EXPECT_TRUE(full > 100 && none > 100 && between > 100) << full << " " << none << " " << between;
  std::cout << "[ measured ] spot on a plate, largest error of the falloff: " << largest << "\n";
}

// A box around the lamp with a hole in each side, each of another shape and off its middle, in a room: each wall is
// lit through its hole.
TEST_F(LightsGl, AllSixFacesOfAnOmnidirectionalLightCastShadows) {
  constexpr double kInner = 0.5, kOuter = 2.0;
  LitScene scene;
  scene.room(kOuter);
  struct Hole {
    glm::dvec2 low, high;
  };
  std::vector<Hole> holes;
  for (int face = 0; face < 6; ++face) {
    const double k = 0.02 * face;
    const Hole hole{{-0.25 + k, -0.12}, {0.1, 0.22 - k}};
    holes.push_back(hole);
    const double at = face % 2 ? -kInner : kInner;
    scene.across(face / 2, at, {-kInner, -kInner}, {hole.low.x, kInner});
    scene.across(face / 2, at, {hole.high.x, -kInner}, {kInner, kInner});
    scene.across(face / 2, at, {hole.low.x, -kInner}, {hole.high.x, hole.low.y});
    scene.across(face / 2, at, {hole.low.x, hole.high.y}, {hole.high.x, kInner});
  }
  scene.points = {PointLight{glm::dvec3(0.0), glm::vec3(5.0f)}};
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    glm::dvec3 n(0.0);
    n[axis] = face % 2 ? -1.0 : 1.0;
    const Hole& hole = holes[static_cast<std::size_t>(face)];
    int lit = 0, dark = 0, wrong = 0;
    eachPixel(scene, viewFrom(0.6 * n, n, 0.5 * kPi), n, kOuter, [&](const glm::dvec3& p, double irradiance) {
      const glm::dvec2 q = (kInner / kOuter) * glm::dvec2(p[(axis + 1) % 3], p[(axis + 2) % 3]);
      const double inside = std::min({q.x - hole.low.x, hole.high.x - q.x, q.y - hole.low.y, hole.high.y - q.y});
      const double expected = 5.0 * kOuter / std::pow(glm::length(p), 3.0);
      if (inside > 0.01) ++lit, wrong += std::abs(irradiance / expected - 1.0) > 1e-3;
      if (inside < -0.01) ++dark, wrong += irradiance != 0.0;
    });
    EXPECT_EQ(wrong, 0) << "face " << face;
    EXPECT_TRUE(lit > 500 && dark > 500) << "face " << face << ": " << lit << " lit, " << dark << " dark";
  }
}

struct Totals {
  double flux = 0.0, area = 0.0;
};

Totals totals(const ReflectiveShadowMap::Outputs& rsm) {
  const std::vector<glm::vec4> positions = rsm.position.readRgba(), fluxes = rsm.flux.readRgba();
  EXPECT_EQ(static_cast<int>(fluxes.size()), rsm.texelCount());
  Totals result;
  for (std::size_t i = 0; i < fluxes.size(); ++i) {
    if (positions[i].w < 0.5f) continue;
    result.flux += static_cast<double>(fluxes[i].x);
    result.area += static_cast<double>(fluxes[i].w);
  }
  return result;
}

TEST_F(LightsGl, TotalFluxOfASpotIsTheAlbedoTimesItsOwn) {
  LitScene scene;
  scene.quad({-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0});
  SpotLight light;
  light.position = {0.1, 0.2, 2.0};
  light.direction = glm::normalize(glm::dvec3(0.3, -0.2, -1.0));
  light.intensity = glm::vec3(3.0f);
  light.innerAngle = 0.4;
  light.outerAngle = 0.8;
  scene.spots = {light};
  const GpuScene gpuScene(scene, analyse(scene), capabilities());
  const double expected =
      static_cast<double>(kAlbedo) * 3.0 * 2.0 * kPi * (1.0 - 0.5 * (std::cos(0.4) + std::cos(0.8)));
  for (const int size : {64, 128, 256, 512}) {
    ReflectiveShadowMap rsm(programs(), gpuScene, {size, ReflectiveShadowMap::Light::spot});
    const ReflectiveShadowMap::Outputs outputs = rsm.record(gpuScene, lightViews(light, scene));
    const double ratio = totals(outputs).flux / expected;
    EXPECT_NEAR(ratio, 1.0, 0.01) << size;
    EXPECT_GE(outputs.largestFlux, expected / static_cast<double>(kAlbedo)) << size;
    EXPECT_LE(outputs.largestFlux, 3.0 * expected / static_cast<double>(kAlbedo)) << size;
    std::cout << "[ measured ] spot on a plate, RSM " << size << ": flux / expected " << ratio << "\n";
  }
}

TEST_F(LightsGl, TotalFluxAndAreaOfAnOmnidirectionalLightAreTheRooms) {
  LitScene scene;
  scene.room(1.5);
  const PointLight light{{0.4, -0.5, 0.3}, glm::vec3(3.0f)};
  scene.points = {light};
  const GpuScene gpuScene(scene, analyse(scene), capabilities());
  for (const int size : {32, 64, 256, 512}) {
    ReflectiveShadowMap rsm(programs(), gpuScene, {size, ReflectiveShadowMap::Light::point});
    const ReflectiveShadowMap::Outputs outputs = rsm.record(gpuScene, lightViews(light, scene));
    const Totals sum = totals(outputs);
    EXPECT_GE(outputs.largestFlux * (1.0 + 1e-6), sum.flux / static_cast<double>(kAlbedo)) << size;
    EXPECT_NEAR(outputs.largestFlux / (4.0 * kPi * 3.0), 1.0, 0.01) << size;
    const double flux = sum.flux / (static_cast<double>(kAlbedo) * 4.0 * kPi * 3.0), area = sum.area / (6.0 * 9.0);
    EXPECT_NEAR(flux, 1.0, 0.01) << size;
    EXPECT_NEAR(area, 1.0, 0.03) << size;
    std::cout << "[ measured ] omni in a room, RSM 6 x " << size << ": flux / expected " << flux << ", area / expected "
              << area << "\n";
  }
}

// A plate below an omnidirectional lamp, a quarter of its texture white: its flux is that of the solid angle, a
// quarter of it.
TEST_F(LightsGl, AnOmnidirectionalLightsFluxIsTexturedAllOverATriangle) {
  LitScene scene;
  scene.quad({-0.9, -0.9, 0}, {0.9, -0.9, 0}, {0.9, 0.9, 0}, {-0.9, 0.9, 0});
  // Short of the border, where filtering would mix in the opposite side.
  for (Vertex& vertex : scene.vertices)
    vertex.texCoord = {vertex.position.x > 0.0f ? 0.875f : 0.125f, vertex.position.y > 0.0f ? 0.875f : 0.125f};
  constexpr int kTexels = 8;
  scene.textures.push_back({"quarter.png", {}});
  Bitmap& bitmap = scene.textures[0].bitmap;
  bitmap.width = bitmap.height = kTexels;
  for (int y = 0; y < kTexels; ++y)
    for (int x = 0; x < kTexels; ++x) {
      const std::uint8_t shade = x >= kTexels / 2 && y >= kTexels / 2 ? 255 : 0;
      bitmap.rgba.insert(bitmap.rgba.end(), {shade, shade, shade, 255});
    }
  scene.materials[0].diffuseTexture = 0;
  const PointLight light{{0.0, 0.0, 1.0}, glm::vec3(3.0f)};
  scene.points = {light};
  const GpuScene gpuScene(scene, analyse(scene), capabilities());
  ReflectiveShadowMap rsm(programs(), gpuScene, {256, ReflectiveShadowMap::Light::point});
  const double solidAngle = 4.0 * std::asin(0.81 / 1.81);  // of a square pyramid
  const double expected = static_cast<double>(kAlbedo) * 3.0 * solidAngle / 4.0;
  EXPECT_NEAR(totals(rsm.record(gpuScene, lightViews(light, scene))).flux / expected, 1.0, 0.01);
}

TEST_F(LightsGl, TheSunsFluxCountsProjectedAreaAndItsSurfelsTrueArea) {
  LitScene scene;
  const glm::dvec3 u(2, 0, 0), v(0, 1.0, 1.0 * std::sqrt(3.0));  // tilted by 60 degrees; 4 x 4
  scene.quad(-u - v, u - v, u + v, -u + v);
  scene.sun = DirectionalLight{{0, -1, 0}, glm::vec3(2.0f)};
  const GpuScene gpuScene(scene, analyse(scene), capabilities());
  const SunFrustum frustum = fitSunFrustum(scene, scene.sun->direction);
  const gl::Buffer frame = test::bindSunFrame(scene, frustum);
  ReflectiveShadowMap rsm(programs(), gpuScene, {256, ReflectiveShadowMap::Light::sun});
  const ReflectiveShadowMap::Outputs outputs = rsm.record(gpuScene, frustum);
  const Totals sum = totals(outputs);
  EXPECT_NEAR(outputs.largestFlux / (2.0 * frustum.width * frustum.height), 1.0, 1e-6);
  const double projected = 16.0 * std::abs(glm::normalize(glm::cross(u, v)).y);
  EXPECT_NEAR(sum.flux / (static_cast<double>(kAlbedo) * 2.0 * projected), 1.0, 0.01);
  EXPECT_NEAR(sum.area / 16.0, 1.0, 0.01);
}

TEST_F(LightsGl, TheVolumeAddsLightsUp) {
  LitScene scene;
  scene.room(1.0);
  const PointLight point{{0.4, -0.5, 0.3}, glm::vec3(3.0f, 2.0f, 1.0f)};
  SpotLight spot;
  spot.position = {0.0, 0.8, 0.0};
  spot.intensity = glm::vec3(1.0f, 4.0f, 2.0f);
  scene.points = {point};
  scene.spots = {spot};
  const GpuScene gpuScene(scene, analyse(scene), capabilities());
  ReflectiveShadowMap spotMap(programs(), gpuScene, {64, ReflectiveShadowMap::Light::spot});
  ReflectiveShadowMap pointMap(programs(), gpuScene, {32, ReflectiveShadowMap::Light::point});
  const auto a = spotMap.record(gpuScene, lightViews(spot, scene));
  const auto b = pointMap.record(gpuScene, lightViews(point, scene));
  LpvSettings s;
  s.cascades.cells = 8;
  s.cascades.cascades = 2;
  s.cascades.cellSize = 0.4;  // five cells across the room: the rounding of a cell's sum grows with the texels in it
  s.iterations = 2;
  s.storage = LpvSettings::Storage::full;
  const auto grids = [&](std::vector<ReflectiveShadowMap::Outputs> rsms) {
    LightPropagationVolume lpv(programs(), capabilities(), s);
    const LpvInputs inputs{std::move(rsms), placeCascades(s.cascades, scene.bounds, glm::dvec3(0.0), {0, 0, -1}),
                           typicalIrradiance(scene)};
    lpv.place(inputs);
    lpv.inject(inputs);
    lpv.fillGeometryVolume(inputs);
    std::vector<std::vector<glm::vec4>> result{lpv.geometryVolume()->readRgba()};
    for (const gl::Texture& channel : lpv.injected()) result.push_back(channel.readRgba());
    return result;
  };
  const auto both = grids({a, b}), onlyA = grids({a}), onlyB = grids({b}), neither = grids({});
  // Integers hold the same, to half a step a texel and coefficient; the bound of the sum of all lights leaves steps
  // enough.
  s.fill = LpvFill::fixed;
  const auto counted = grids({a, b});
  for (std::size_t grid = 0; grid < both.size(); ++grid)
    for (std::size_t i = 0; i < both[grid].size(); ++i)
      for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(counted[grid][i][c], both[grid][i][c], 1e-4f * (1e-2f + std::abs(both[grid][i][c]))) << grid;
  // Perspective lights have true areas and no area across the rays: the deviations of the sun's leave theirs finite
  // and unchanged.
  s.deviations.surfelArea = s.deviations.fluxUnits = true;
  const auto deviating = grids({a, b});
  EXPECT_EQ(deviating[0], both[0]);
  for (std::size_t grid = 1; grid < both.size(); ++grid) {
    float largest = 0.0f;
    for (const glm::vec4& cell : deviating[grid]) {
      ASSERT_TRUE(std::isfinite(cell.x + cell.y + cell.z + cell.w));
      largest = std::max(largest, cell.x);
    }
    EXPECT_GT(largest, 0.0f);
  }
  for (std::size_t grid = 0; grid < both.size(); ++grid) {
    float largest = 0.0f, error = 0.0f;
    for (std::size_t i = 0; i < both[grid].size(); ++i) {
      const glm::vec4 sum = onlyA[grid][i] + onlyB[grid][i];
      for (int c = 0; c < 4; ++c) {
        largest = std::max(largest, std::abs(both[grid][i][c]));
        error = std::max(error, std::abs(both[grid][i][c] - sum[c]));
      }
      EXPECT_EQ(neither[grid][i], glm::vec4(0.0f));
    }
    EXPECT_GT(largest, 0.0f);
    EXPECT_LT(error, 2e-6f * largest) << "grid " << grid;
  }
}

/// Whether the segment from a to b meets a box.
bool meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& low, const glm::dvec3& high) {
  double enter = 0.0, leave = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = b[axis] - a[axis], t0 = (low[axis] - a[axis]) / d, t1 = (high[axis] - a[axis]) / d;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter < leave;
}

void block(LitScene& scene, const glm::dvec3& low, const glm::dvec3& high) {
  const auto p = [&](int x, int y, int z) {
    return glm::dvec3(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z);
  };
  scene.quad(p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1));
  scene.quad(p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1));
  scene.quad(p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1));
  scene.quad(p(1, 1, 0), p(0, 1, 0), p(0, 1, 1), p(1, 1, 1));
  scene.quad(p(0, 1, 0), p(0, 0, 0), p(0, 0, 1), p(0, 1, 1));
}

// A block on a floor: lit places are lit in full (no acne), the shadow begins at the block (no peter-panning), at
// slanting light too.
TEST_F(LightsGl, ShadowsOfABlockNeitherSpeckleNorComeLoose) {
  const glm::dvec3 low(-0.3, -0.3, 0.0), high(0.3, 0.3, 0.5);
  for (const bool spot : {false, true})
    for (const glm::dvec3& position :
         {glm::dvec3(0.9, 0.5, 1.2), glm::dvec3(1.6, -0.7, 0.7), glm::dvec3(-1.5, 1.4, 0.6)}) {
      LitScene scene;
      scene.quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0});
      block(scene, low, high);
      const glm::dvec3 axis = glm::normalize(glm::dvec3(0.0, 0.0, 0.2) - position);
      if (spot) scene.spots = {SpotLight{position, axis, glm::vec3(5.0f), 1.0, 1.2}};
      else scene.points = {PointLight{position, glm::vec3(5.0f)}};
      int lit = 0, dark = 0, wrong = 0;
      eachPixel(scene, viewFrom({0, 0, 4}, {0, 0, -1}, 0.8), {0, 0, 1}, 0.0,
                [&](const glm::dvec3& p, double irradiance) {
                  const double inBox = std::max(std::abs(p.x), std::abs(p.y));
                  const glm::dvec3 away = position - p;
                  const double cosine = -glm::dot(away, axis) / glm::length(away);
                  if (inBox < 0.37 || (spot && cosine < std::cos(0.98)))
                    return;  // the block's top hides what is behind it
                  const double expected = 5.0 * away.z / std::pow(glm::length(away), 3.0), margin = 0.02;
                  if (!meets(p, position, low - margin, high + margin))
                    ++lit, wrong += std::abs(irradiance / expected - 1.0) > 2e-3;
                  if (meets(p, position, low + margin * glm::dvec3(1, 1, 0), high - margin))
                    ++dark, wrong += irradiance > 1e-3 * expected;
                });
      EXPECT_EQ(wrong, 0) << (spot ? "spot " : "point ") << position.x;
      EXPECT_TRUE(lit > 1000 && dark > 100) << lit << " lit, " << dark << " dark";
    }
}

// Each light's shadow is its own: light of all kinds together is the sum of each alone.
TEST_F(LightsGl, DirectLightAddsUp) {
  LitScene scene;
  scene.quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0});
  block(scene, {-0.3, -0.3, 0.0}, {0.3, 0.3, 0.5});
  const auto spot = [](const glm::dvec3& p) { return SpotLight{p, glm::normalize(-p), glm::vec3(3.0f), 0.5, 0.7}; };
  const std::vector<std::function<void(Scene&)>> lights = {
      [](Scene& s) {
        s.sun = DirectionalLight{glm::normalize(glm::dvec3(0.3, 0.4, -1.0)), glm::vec3(1.0f)};
      },
      [](Scene& s) {
        s.points.push_back({{1.0, 0.2, 0.9}, glm::vec3(2.0f)});
      },
      [](Scene& s) {
        s.points.push_back({{-1.0, -0.5, 1.1}, glm::vec3(1.0f)});
      },
      [&](Scene& s) {
        s.spots.push_back(spot({0.3, 1.2, 1.0}));
      },
      [&](Scene& s) {
        s.spots.push_back(spot({-0.6, -1.3, 1.3}));
      },
  };
  const auto picture = [&](const LitScene& lit) {
    Renderer renderer(context(), programs(), lit, settings("direct", {96, 96}));
    renderer.render(viewFrom({0, 0, 4}, {0, 0, -1}, 0.8));
    return renderer.readRadiance();
  };
  LitScene all = scene;
  std::vector<Image> alone;
  for (const auto& light : lights) {
    LitScene one = scene;
    light(one);
    light(all);
    alone.push_back(picture(one));
  }
  const Image together = picture(all);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      float sum = 0.0f;
      for (const Image& image : alone) sum += image.at(x, y).x;
      ASSERT_NEAR(together.at(x, y).x, sum, 1e-5f * sum) << x << " " << y;
    }
}

// A sheet between lamp and floor whose left half a mask cuts out, in the shadow maps of every kind and the reflective
// shadow maps.
TEST_F(LightsGl, MasksCutShadowsOut) {
  const SpotLight spot{{0, 0, 2}, {0, 0, -1}, glm::vec3(2.0f), 0.7, 0.8};
  for (const int kind : {0, 1, 2})
    for (const double x : {-0.3, 0.3}) {
      LitScene scene;
      scene.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
      scene.quad({-1.2, -1.2, 1}, {1.2, -1.2, 1}, {1.2, 1.2, 1}, {-1.2, 1.2, 1});
      scene.textures.push_back({"mask.png", {}});
      scene.textures[0].bitmap.width = 2;
      scene.textures[0].bitmap.height = 1;
      scene.textures[0].bitmap.rgba = {0, 0, 0, 255, 255, 255, 255, 255};
      for (std::size_t i = 4; i < 8; ++i)
        scene.vertices[i].texCoord = {scene.vertices[i].position.x > 0.0f ? 1.0f : 0.0f, 0.5f};
      scene.materials.push_back(scene.materials[0]);
      scene.materials[1].alphaTexture = 0;
      scene.materials[1].alphaMasked = true;
      scene.meshes.push_back(scene.meshes[0]);
      scene.meshes[0].indexCount = scene.meshes[1].indexCount = scene.meshes[1].firstIndex = 6;
      scene.meshes[1].material = 1;
      if (kind == 0) scene.sun = DirectionalLight{{0, 0, -1}, glm::vec3(1.0f)};
      if (kind == 1) scene.spots = {spot};
      if (kind == 2) scene.points = {PointLight{{0, 0, 2}, glm::vec3(2.0f)}};
      RenderSettings s = settings("lpv", {16, 16});
      s.component = Component::all;
      s.shadow.cascades.cascades = 2;
      s.of<LpvSettings>().cascades.cells = 8;
      s.of<LpvSettings>().iterations = 0;
      Renderer renderer(context(), programs(), scene, s);
      renderer.render(viewFrom({x, 0, 0.9}, {0, 0, -1}, 0.1));
      const double radiance = static_cast<double>(renderer.readRadiance().at(8, 8).x);
      const double direct = static_cast<double>(kAlbedo) / kPi * (kind == 0 ? 1.0 : 0.5);
      if (x < 0.0) EXPECT_GT(radiance, 0.85 * direct) << kind;
      else EXPECT_LT(radiance, 0.5 * direct) << kind;
    }
}

TEST_F(LightsGl, WhatASceneHasNoneOfLeavesNoTrace) {
  LitScene scene;
  scene.room(1.0);
  scene.sun = DirectionalLight{{0, -1, 0}, glm::vec3(1.0f)};
  const auto resources = [](const gl::ProgramLibrary& library) {
    std::string text;
    for (const auto& program : library.programs()) {
      text += program->name() + "\n";
      for (const std::string& name : program->activeResources()) text += name + "\n";
    }
    return text;
  };
  const auto bytes = [&](const LitScene& s, const RenderSettings& r) {
    gl::ProgramLibrary library;
    return Renderer(context(), library, s, r).gpuBytes();
  };
  for (const std::string_view technique : {"direct", "lpv"}) {
    gl::ProgramLibrary library;
    Renderer renderer(context(), library, scene, settings(technique, {32, 32}));
    for (int i = 0; i < 3; ++i) renderer.render(viewFrom({0, 0, 0.5}, {0, 0, -1}, 1.0));
    renderer.timer().drain();
    const std::string text = resources(library);
    for (const char* word : {"spot", "point s", "rsm point", "LightBlock", "lights", "SunCascade", "clipFromPlace["})
      EXPECT_EQ(text.find(word), std::string::npos) << word << " in\n" << text;
    for (const auto& stage : renderer.timer().statistics()) {
      EXPECT_EQ(stage.name.find("spot"), std::string::npos);
      EXPECT_EQ(stage.name.find("point"), std::string::npos);
    }
    const auto leftOut = renderer.leftOut();
    for (const char* name : {"spotLights", "pointLights", "sun cascades", "spot shadow maps", "point shadow maps"})
      EXPECT_TRUE(std::count(leftOut.begin(), leftOut.end(), name) == 1) << name;
  }
  // What each kind costs, to the byte.
  const RenderSettings s = settings("direct", {32, 32});
  const std::size_t sunOnly = bytes(scene, s);
  LitScene withPoint = scene, withSpot = scene, withoutSun = scene;
  withPoint.points = {PointLight{glm::dvec3(0.1), glm::vec3(1.0f)}};
  withSpot.spots = {SpotLight{}};
  EXPECT_EQ(bytes(withSpot, s), sunOnly);  // intensity 0
  withSpot.spots[0].intensity = glm::vec3(1.0f);
  EXPECT_EQ(bytes(withPoint, s), sunOnly + sizeof(shared::LightConstants) + 6u * 512u * 512u * 4u);
  EXPECT_EQ(bytes(withSpot, s), sunOnly + sizeof(shared::LightConstants) + 1024u * 1024u * 4u);
  withoutSun.sun.reset();
  EXPECT_EQ(bytes(withoutSun, s), sunOnly - 2048u * 2048u * 4u);
  RenderSettings cascades = s;
  cascades.shadow.cascades.cascades = 3;
  EXPECT_EQ(bytes(scene, cascades), sunOnly + 2u * 2048u * 2048u * 4u + sizeof(shared::SunCascadeConstants));
  EXPECT_EQ(bytes(withoutSun, cascades), bytes(withoutSun, s));
}

// All the light of three lamps falls into one cell, from white walls: the fixed point's sum stays below 2^31, at any
// size of the maps.
TEST_F(LightsGl, FixedPointSumsOfAllLightsDoNotOverflow) {
  LitScene scene;
  scene.room(1.0);
  scene.materials[0].diffuse = glm::vec3(1.0f);
  // Into the middle of the one cell, 0 to 4, so that no light leaves it when it is moved half a cell.
  for (Vertex& vertex : scene.vertices) vertex.position += 2.0f;
  scene.bounds = {glm::dvec3(1.0), glm::dvec3(3.0)};
  for (const glm::dvec3& at : {glm::dvec3(2.0), glm::dvec3(2.3, 1.8, 2.1)})
    scene.points.push_back({at, glm::vec3(30.0f, 20.0f, 10.0f)});
  scene.spots = {SpotLight{glm::dvec3(2.0), {0, -1, 0}, glm::vec3(70.0f, 1.0f, 1.0f), 0.3, 1.3}};
  const GpuScene gpuScene(scene, analyse(scene), capabilities());
  LpvSettings s;
  s.cascades.cells = 1;
  s.cascades.cascades = 1;
  s.cascades.cellSize = 4.0;
  s.iterations = 0;
  for (const int size : {1, 2, 3, 64, 256}) {
    std::vector<ReflectiveShadowMap> maps;
    std::vector<ReflectiveShadowMap::Outputs> outputs;
    double flux = 0.0;
    for (std::size_t i = 0; i < 2; ++i)
      maps.emplace_back(programs(), gpuScene, ReflectiveShadowMap::Settings{size, ReflectiveShadowMap::Light::point});
    maps.emplace_back(programs(), gpuScene, ReflectiveShadowMap::Settings{size, ReflectiveShadowMap::Light::spot});
    for (std::size_t i = 0; i < maps.size(); ++i) {
      outputs.push_back(
          maps[i].record(gpuScene, i < 2 ? lightViews(scene.points[i], scene) : lightViews(scene.spots[0], scene)));
      flux += totals(outputs.back()).flux;
      EXPECT_GE(outputs.back().largestFlux * (1.0 + 1e-6), totals(outputs.back()).flux) << size;
    }
    s.fill = LpvFill::fixed;
    LightPropagationVolume lpv(programs(), capabilities(), s);
    const LpvInputs inputs{outputs, placeCascades(s.cascades, scene.bounds, glm::dvec3(2.0), glm::dvec3(0.0)),
                           typicalIrradiance(scene)};
    lpv.place(inputs);
    lpv.inject(inputs);
    const double stored = static_cast<double>(lpv.injected()[0].readRgba()[0].x) * std::sqrt(4.0 * kPi);
    EXPECT_NEAR(stored * static_cast<double>(inputs.referenceIrradiance) * 16.0 / flux, 1.0, 1e-4) << size;
  }
}

TEST_F(LightsGl, TheGatherOfEachLightIsThatOfPathsThroughWalls) {
  // A room with a spot and two lamps: what the gather finds is one bounce that nothing stands in the way of, and the
  // lights add up. Against paths of just that transport, each light alone and all together. The pattern has 1024
  // samples over all of each map.
  LitScene room;
  room.room(1.0);
  room.quad({-0.4, -0.5, -0.5}, {-0.4, -0.5, 0.1}, {0.2, -0.5, 0.1},
            {0.2, -0.5, -0.5});  // a shelf, which blocks direct light alone
  const Camera camera = viewFrom({0.2, 0.1, 0.9}, {-0.2, -0.2, -1.0}, 1.2);
  const auto gathered = [&](const LitScene& scene, bool interpolate) {
    RenderSettings s = settings("rsm", {24, 18});
    s.component = Component::indirect;
    s.fullFloatTarget = true;
    s.of<RsmGather::Settings>().radius = 1.5f;
    s.of<RsmGather::Settings>().samples = 1024;
    s.of<ReflectiveShadowMap::Settings>().size = 64;
    s.of<RsmGather::Settings>().interpolate = interpolate;
    Renderer renderer(context(), programs(), scene, s);
    renderer.render(camera);
    return renderer.readRadiance();
  };
  const auto traced = [&](const LitScene& scene) {
    PathTracer::Settings s;
    s.size = {24, 18};
    s.transport = Transport::oneBounceUnoccluded;
    s.diffuseOnly = true;
    s.filter = PixelFilter::centre;
    PathTracer tracer(context(), programs(), scene, s);
    tracer.setCamera(camera);
    tracer.record(128);
    return tracer.mean();
  };
  LitScene spot = room, lamps = room, all = room;
  spot.spots = {SpotLight{{0.3, 0.6, 0.2}, glm::normalize(glm::dvec3(-0.4, -1.0, -0.5)), {4.0f, 3.0f, 2.0f}, 0.3, 0.7}};
  lamps.points = {PointLight{{-0.4, 0.2, -0.3}, {0.8f, 0.5f, 0.3f}}, PointLight{{0.5, -0.3, 0.4}, {0.2f, 0.4f, 0.9f}}};
  all.spots = spot.spots;
  all.points = lamps.points;
  for (const auto& [name, scene] : {std::pair("spot", &spot), std::pair("lamps", &lamps), std::pair("all", &all)}) {
    const Image right = traced(*scene);
    for (const bool interpolate : {false, true}) {
      const Image image = gathered(*scene, interpolate);
      double square = 0.0, sum = 0.0, bias = 0.0;
      for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::dvec3 d = glm::dvec3(image.pixels[i]) - glm::dvec3(right.pixels[i]);
        square += glm::dot(d, d);
        sum += glm::dot(glm::dvec3(right.pixels[i]), glm::dvec3(right.pixels[i]));
        bias += (d.x + d.y + d.z) / (3.0 * static_cast<double>(right.pixels.size()));
      }
      const glm::dvec3 mean = meanOf(right);
      std::printf("gather of %s%s: relative L2 %.4f, bias %+.4f\n", name, interpolate ? ", interpolated" : "",
                  std::sqrt(square / sum), 3.0 * bias / (mean.x + mean.y + mean.z));
      EXPECT_LT(std::abs(3.0 * bias / (mean.x + mean.y + mean.z)), 0.03) << name;
      EXPECT_LT(std::sqrt(square / sum), interpolate ? 0.20 : 0.15) << name;
    }
  }
  // Lights add up.
  const Image both = gathered(all, false), one = gathered(spot, false), other = gathered(lamps, false);
  for (std::size_t i = 0; i < both.pixels.size(); ++i)
    EXPECT_LE(glm::length(both.pixels[i] - one.pixels[i] - other.pixels[i]),
              1e-4f * glm::length(both.pixels[i]) + 1e-6f)
        << i;
}

TEST_F(LightsGl, WithoutLightThereIsNoGather) {
  LitScene scene;
  scene.room(1.0);
  const auto gathers = [&] {
    Renderer renderer(context(), programs(), scene, settings("rsm", {16, 16}));
    const auto leftOut = renderer.leftOut();
    EXPECT_EQ(std::count(leftOut.begin(), leftOut.end(), "rsm gather") == 0, gatherOf(renderer.technique()) != nullptr);
    return gatherOf(renderer.technique()) != nullptr;
  };
  EXPECT_FALSE(gathers());
  scene.points = {PointLight{glm::dvec3(0.1), glm::vec3(1.0f)}};
  EXPECT_TRUE(gathers());
}

TEST_F(LightsGl, EveryStageOfEveryLightIsTimed) {
  LitScene scene;
  scene.room(1.0);
  scene.sun = DirectionalLight{{0, -1, 0}, glm::vec3(1.0f)};
  scene.points = {PointLight{glm::dvec3(0.1), glm::vec3(1.0f)}, PointLight{glm::dvec3(-0.1), glm::vec3(1.0f)}};
  scene.spots = {SpotLight{{}, {0, -1, 0}, glm::vec3(1.0f), 0.3, 0.5}};
  RenderSettings s = settings("lpv", {32, 32});
  s.shadow.cascades.cascades = 2;
  s.of<LpvSettings>().cascades.cells = 8;
  Renderer renderer(context(), programs(), scene, s);
  for (int i = 0; i < 3; ++i) renderer.render(viewFrom({0, 0, 0.5}, {0, 0, -1}, 1.0));
  renderer.timer().drain();
  std::vector<std::string> names;
  for (const auto& stage : renderer.timer().statistics()) {
    names.push_back(stage.name);
    EXPECT_GT(stage.medianMs, 0.0) << stage.name;
  }
  for (const char* name :
       {"shadow", "spot shadows", "point shadows", "rsm", "injection", "geometry volume", "propagation", "shading"})
    EXPECT_TRUE(std::count(names.begin(), names.end(), name) == 1) << name;
}

/// The sun's visibility in each pixel of a floor y = 0.
std::vector<double> sunVisibility(const gl::Context& context, gl::ProgramLibrary& programs, const LitScene& scene,
                                  RenderSettings s, int cascades, const Camera& camera) {
  s.shadow.cascades.cascades = cascades;
  Renderer renderer(context, programs, scene, s);
  renderer.render(camera);
  const Image image = renderer.readRadiance();
  const double full =
      static_cast<double>(kAlbedo) / kPi * static_cast<double>(scene.sun->irradiance.x) * -scene.sun->direction.y;
  std::vector<double> result;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) result.push_back(static_cast<double>(image.at(x, y).x) / full);
  return result;
}

LitScene columns(double half, double spacing) {
  LitScene scene;
  scene.quad({-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half});
  const double w = 0.1 * spacing;
  for (double x = -0.9 * half; x < 0.9 * half; x += spacing)
    for (double z = -0.9 * half; z < 0.9 * half; z += spacing) {
      // A sheet: its front and back.
      scene.quad({x - w, 0, z}, {x + w, 0, z}, {x + w, 4 * w, z}, {x - w, 4 * w, z});
      scene.quad({x + w, 0, z}, {x - w, 0, z}, {x - w, 4 * w, z}, {x + w, 4 * w, z});
    }
  // The sheets are black, so that what is neither dark nor full in a picture is the floor half in shadow.
  scene.materials.push_back(Material{});
  scene.materials[1].diffuse = glm::vec3(0.0f);
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes[0].indexCount = 6;
  scene.meshes[1].firstIndex = 6;
  scene.meshes[1].indexCount -= 6;
  scene.meshes[1].material = 1;
  scene.sun = DirectionalLight{glm::normalize(glm::dvec3(0.4, -1.0, 0.5)), glm::vec3(1.0f)};
  return scene;
}

int partial(const std::vector<double>& visibility) {
  return static_cast<int>(
      std::count_if(visibility.begin(), visibility.end(), [](double v) { return v > 0.02 && v < 0.98; }));
}

TEST_F(LightsGl, CascadesShowTheShadowOfOneMapOnASmallScene) {
  const LitScene scene = columns(1.0, 0.2);
  const RenderSettings s = settings("direct", {160, 160});
  const Camera camera = viewFrom({0.1, 0.5, 0.3}, {0, -1, -0.4}, 0.8);
  const auto one = sunVisibility(context(), programs(), scene, s, 1, camera);
  for (const int cascades : {2, 3, 4}) {
    const auto several = sunVisibility(context(), programs(), scene, s, cascades, camera);
    int differing = 0;
    double sum = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      differing += std::abs(one[i] - several[i]) > 1e-3;
      sum += several[i] - one[i];
    }
    std::cout << "[ measured ] " << cascades << " cascades: " << 100.0 * differing / static_cast<double>(one.size())
              << " % of pixels differ, at edges\n";
    EXPECT_GT(differing, 0);  // else no cascade is in the picture
    EXPECT_LT(differing, static_cast<int>(one.size()) / 25);
    EXPECT_LT(std::abs(sum), 2e-3 * static_cast<double>(one.size()));
  }
}

// Six of each kind: the first is faint, the second bright but lights nothing of the room. Nothing is in the light's
// way.
TEST_F(LightsGl, OfManyLampsThoseThatLightTheSceneMostHaveShadows) {
  LitScene few;
  few.room(2.0);
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 at(0.8 * (i & 1 ? 1.0 : -1.0), 0.5, 0.8 * (i & 2 ? 1.0 : -1.0));
    few.points.push_back({at, glm::vec3(1.0f + static_cast<float>(i))});
    few.spots.push_back({at, glm::normalize(glm::dvec3(0.2 * i, -1.0, 0.1)), glm::vec3(3.0f), 0.3, 0.6});
  }
  LitScene many = few;
  many.points.insert(many.points.begin(), {{{0.0, 0.0, 0.0}, glm::vec3(0.01f)}, {{0.0, 1e4, 0.0}, glm::vec3(1000.0f)}});
  many.spots.insert(many.spots.begin() + 1, {{{0.0, 1.0, 0.0}, {0.0, -1.0, 0.0}, glm::vec3(0.01f), 0.3, 0.6},
                                             {{0.0, 3.0, 0.0}, {0.0, 1.0, 0.0}, glm::vec3(1000.0f), 0.3, 0.6}});
  for (const std::string_view technique : {"direct", "lpv"}) {
    const auto picture = [&](int shadows) {
      RenderSettings s = settings(technique, {48, 48});
      s.lights.shadows = shadows;
      Renderer renderer(context(), programs(), many, s);
      renderer.render(viewFrom({0, 1.5, 1.8}, {0, -0.6, -1}, 1.2));
      return renderer.readRadiance();
    };
    clearLoggedWarnings();  // what was said before is not said again
    ::testing::internal::CaptureStderr();
    const Image ofFew = picture(4);
    const std::string said = ::testing::internal::GetCapturedStderr();
    const bool isSaid = technique == "lpv";  // of light that is reflected; shadows have all
    EXPECT_EQ(said.find("are in no map of light: points[0] (") != std::string::npos, isSaid) << said;
    EXPECT_EQ(said.find("are in no map of light: spots[1], points[1] (") != std::string::npos, isSaid) << said;
    const Image ofMany = picture(16);
    double largest = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < ofFew.pixels.size(); ++i) {
      largest = std::max(largest, static_cast<double>(std::abs(ofMany.pixels[i].x - ofFew.pixels[i].x)));
      mean += static_cast<double>(ofMany.pixels[i].x) / static_cast<double>(ofMany.pixels.size());
    }
    EXPECT_LE(largest, 2e-3 * mean) << technique;
  }
}

TEST_F(LightsGl, CascadesAreSharperNearTheCameraOfALargeScene) {
  const LitScene scene = columns(200.0, 4.0);
  const RenderSettings s = settings("direct", {160, 160});
  const Camera camera = viewFrom({0.3, 5.0, 2.0}, {0, -1, -0.3}, 0.9);
  const int one = partial(sunVisibility(context(), programs(), scene, s, 1, camera));
  const int three = partial(sunVisibility(context(), programs(), scene, s, 3, camera));
  std::cout << "[ measured ] pixels half in shadow: one map " << one << ", three cascades " << three << "\n";
  EXPECT_GT(one, 500);
  EXPECT_LT(4 * three, one);
}

// Every place on the floor in front of a camera that turns is lit or shadowed alike, cascade borders included.
TEST_F(LightsGl, CascadesLeaveNoGapHoweverTheCameraTurns) {
  LitScene scene;
  scene.quad({-200, 0, -200}, {-200, 0, 200}, {200, 0, 200}, {200, 0, -200});
  scene.quad({-250, 30, -250}, {250, 30, -250}, {250, 30, 250}, {-250, 30, 250});  // a roof: below it all is dark
  scene.sun = DirectionalLight{glm::normalize(glm::dvec3(0.1, -1.0, 0.05)), glm::vec3(1.0f)};
  const RenderSettings s = settings("direct", {64, 64});
  for (int turn = 0; turn < 12; ++turn) {
    const double a = 0.55 * turn;
    const Camera camera = viewFrom({3.0 * turn, 2.0, -2.0 * turn}, {std::sin(a), -0.2, std::cos(a)}, 0.5);
    const auto visibility = sunVisibility(context(), programs(), scene, s, 4, camera);
    EXPECT_EQ(*std::max_element(visibility.begin(), visibility.end()), 0.0) << "turn " << turn;
  }
}

}  // namespace
}  // namespace lucerna
