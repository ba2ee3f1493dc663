// The path tracer where several things meet: interpolated normals, pairs of lights of different kinds that share the
// picks, lamps behind a dense density grid, channels that differ. Statistical tests: seeds are fixed; 4 standard
// errors.
#include "base/angles.hpp"
#include "support/form_factor_reference.hpp"
#include "support/media_scenes.hpp"
#include "support/path_scenes.hpp"
#include "support/pixel_rays.hpp"

#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>

namespace lucerna::test {
namespace {

class PathShading : public PathTest {};

// ------------------------------------------------------------------------------------------------------ smooth normals

/// One triangle in the plane y = 0 whose corners have different normals, seen from above or below.
struct SmoothTriangle {
  std::array<glm::dvec3, 3> corner{{{-4, 0, 3}, {4, 0, 3}, {0, 0, -5}}};
  std::array<glm::dvec3, 3> normal{{glm::normalize(glm::dvec3(-0.5, 1.0, 0.2)),
                                    glm::normalize(glm::dvec3(0.6, 1.0, 0.0)),
                                    glm::normalize(glm::dvec3(0.1, 1.0, -0.7))}};
  Scene scene(const glm::dvec3& sun) const {
    SceneBuilder builder;
    builder.triangle(corner[0], corner[1], corner[2], builder.material({0.8f, 0.4f, 0.2f}));
    for (std::size_t i = 0; i < 3; ++i) builder.scene().vertices[i].normal = glm::vec3(normal[i]);
    builder.sun(sun, glm::vec3(2.0f));
    return builder.scene();
  }
  /// Unit; false outside of the triangle.
  bool normalAt(const glm::dvec3& p, glm::dvec3& n) const {
    const auto area = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
      return glm::cross(b - a, c - a).y;
    };
    const double all = area(corner[0], corner[1], corner[2]);
    const double wa = area(p, corner[1], corner[2]) / all, wb = area(corner[0], p, corner[2]) / all, wc = 1.0 - wa - wb;
    if (std::min({wa, wb, wc}) < 0.01) return false;
    n = glm::normalize(wa * normal[0] + wb * normal[1] + wc * normal[2]);
    return true;
  }
};

TEST_F(PathShading, SmoothNormalsAreInterpolatedAndTurnedToTheSideThatIsSeen) {
  const SmoothTriangle triangle;
  for (const double side : {1.0, -1.0}) {
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.4, -side, 0.3));
    const Scene scene = triangle.scene(sun);
    const Camera camera = lookingAt({0.3, 4.0 * side, 0.2}, {0.2, 0.0, 0.1}, 1.0);
    PathTracer::Settings settings = sized(32);
    settings.filter = PixelFilter::centre;
    settings.transport = Transport::direct;
    const Image traced = tracer(scene, camera, settings, 1).mean();
    RenderSettings forward;
    forward.technique = "direct";
    forward.size = glm::ivec2(32);
    forward.fullFloatTarget = true;
    Renderer renderer(context(), library(), scene, forward);
    renderer.render(camera);
    const Image rastered = renderer.readRadiance();
    int pixels = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        glm::dvec3 n;
        if (!triangle.normalAt(onPlane(camera, pixelRay(camera, x, y, glm::ivec2(32)), 0.0), n)) continue;
        ++pixels;
        // Seen from behind, the interpolated normal is the front's, turned.
        const double expected = 0.4 / kPi * 2.0 * std::max(0.0, glm::dot(side * n, -sun));
        ASSERT_NEAR(traced.at(x, y).y, expected, 1e-4) << side << " " << x << " " << y;
        ASSERT_NEAR(rastered.at(x, y).y, expected, 1e-3) << side << " " << x << " " << y;
      }
    EXPECT_GT(pixels, 300);
  }
}

/// A sphere whose corners have the true sphere's normals, in an environment of one radiance.
TEST_F(PathShading, ASmoothMirrorSphereShowsTheEnvironmentWhereItsNormalsSay) {
  Scene scene;
  addSphere(scene, glm::dvec3(0.0), 1.0, 4, addBoundary(scene, Bsdf::mirror, 1.0, -1));
  scene.materials.back().specular = glm::vec3(0.9f);
  for (Vertex& vertex : scene.vertices) vertex.normal = glm::normalize(vertex.position);
  scene.environment = halves();  // red from above, green from below
  const Camera camera = lookingAt({0, 0, 6}, {0, 0, 0}, 0.36);
  PathTracer::Settings settings = sized(32);
  settings.filter = PixelFilter::centre;
  const Image image = tracer(scene, camera, settings, 1).mean();
  int up = 0, down = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const glm::dvec3 d = glm::normalize(pixelRay(camera, x, y, glm::ivec2(32)));
      const double b = glm::dot(d, camera.position),
                   disc = b * b - glm::dot(camera.position, camera.position) + 0.97 * 0.97;
      if (disc < 0.0) continue;
      const glm::dvec3 n = glm::normalize(camera.position + (-b - std::sqrt(disc)) * d),
                       r = d - 2.0 * glm::dot(d, n) * n;
      if (std::abs(r.y) < 0.1) continue;  // facets are flat: the place on the sphere is known to a few per cent
      (r.y > 0.0 ? up : down)++;
      EXPECT_NEAR(image.at(x, y).x, r.y > 0.0 ? 0.9 : 0.0, 1e-5) << x << " " << y;
      EXPECT_NEAR(image.at(x, y).y, r.y > 0.0 ? 0.0 : 0.9, 1e-5) << x << " " << y;
    }
  EXPECT_GT(up, 150);
  EXPECT_GT(down, 150);
}

// A boundary whose interpolated normal turns away from the sun though its face does not: what would pass by it is not
// counted.
TEST_F(PathShading, ARoughBoundaryIsNotLitFromBehindItsNormal) {
  SmoothTriangle triangle;
  triangle.normal.fill(glm::normalize(glm::dvec3(2.0, 1.0, 0.0)));
  PathTracer::Settings settings = sized(8);
  settings.transport = Transport::direct;
  for (const double towards : {-1.0, 1.0}) {
    Scene scene = triangle.scene(glm::normalize(glm::dvec3(-towards, -0.27, 0.0)));
    Material& material = scene.materials[0];
    material.bsdf = Bsdf::dielectric;
    material.ior = 1.5f;
    material.roughness = 0.5f;
    const double light = meanOf(tracer(scene, lookingAt({6.0, 1.0, 0.1}, {0.1, 0.0, 0.1}, 0.1), settings, 4).mean()).y;
    EXPECT_EQ(light > 1e-3, towards > 0.0) << light;
    EXPECT_TRUE(towards > 0.0 || light == 0.0) << light;
  }
}

// -------------------------------------------------------------------------------------------------------------- metals

// Reflectance by Schlick [Schlick1994]: of a constant sky in a smooth one, of the sun in a rough one (GGX with
// height-correlated shadowing [Walter2007], [Heitz2014]).
TEST_F(PathShading, MetalsReflectByTheirAngle) {
  const glm::dvec3 f0{0.04f, 0.5, 0.9f};
  for (const float alpha : {0.0f, 0.4f})
    for (const glm::dvec3& eye : {glm::dvec3(0.0, 3.0, 0.1), glm::dvec3(3.0, 1.5, 0.0), glm::dvec3(-3.0, 0.4, 1.0)}) {
      SceneBuilder builder;
      const int metal = builder.material(glm::vec3(0.0f));
      builder.materialAt(metal).bsdf = Bsdf::conductor;
      builder.materialAt(metal).specular = glm::vec3(f0);
      builder.materialAt(metal).roughness = alpha;
      builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, metal);
      const glm::dvec3 toSun = glm::normalize(glm::dvec3(0.4, 1.0, 0.3));
      builder.sun(-toSun, glm::vec3(2.0f));
      if (alpha == 0.0f) {
        builder.scene().sun.reset();
        builder.scene().environment.emplace().radiance = glm::vec3(2.0f);
      }
      PathTracer::Settings settings = sized(8);
      settings.filter = PixelFilter::centre;
      const Camera camera = lookingAt(eye, {0, 0, 0}, 0.05);
      const Image image = tracer(builder.scene(), camera, settings, 1).mean();
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
          const glm::dvec3 o = -glm::normalize(pixelRay(camera, x, y, glm::ivec2(8)));
          const glm::dvec3 h = alpha > 0.0f ? glm::normalize(o + toSun) : glm::dvec3(0, 1, 0);
          const glm::dvec3 schlick = f0 + (1.0 - f0) * std::pow(1.0 - glm::dot(o, h), 5.0);
          double times = 2.0;
          if (alpha > 0.0f) {
            const double a2 = static_cast<double>(alpha) * static_cast<double>(alpha),
                         t = (1.0 - h.y * h.y) / a2 + h.y * h.y;
            const auto lambda = [&](const glm::dvec3& w) {
              return 0.5 * (std::sqrt(1.0 + a2 * (1.0 / (w.y * w.y) - 1.0)) - 1.0);
            };
            times *= 1.0 / (kPi * a2 * t * t) / (1.0 + lambda(o) + lambda(toSun)) / (4.0 * o.y);
          }
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(image.at(x, y)[c], times * schlick[c], 2e-4 * times * schlick[c])
                << alpha << " from " << eye.y << ", channel " << c;
        }
    }
}

// ------------------------------------------------------------------------------------------------------ pairs of
// lights

/// A floor of albedo 0.6, 0.5, 0.4, seen from above in a small part of it.
SceneBuilder floor() {
  SceneBuilder builder;
  builder.plate({0, 0, 0}, {0, 0, 40}, {40, 0, 0}, builder.material({0.6f, 0.5f, 0.4f}));
  builder.scene().sun.reset();
  return builder;
}
const Camera kDown = cameraAt({0.0, 3.0, 0.0}, {0.0, 0.0, 0.0});
const glm::dvec3 kAlbedo{0.6f, 0.5, 0.4f};

/// A picture whose upper half sends `radiance`, in 8 x 4 texels.
Environment sky(const glm::vec3& radiance) {
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  environment.picture = Image(8, 4, glm::vec3(0.0f));
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 8; ++x) environment.picture->at(x, y) = radiance;
  return environment;
}

TEST_F(PathShading, AnEnvironmentPictureAndLampsOfEveryKindShareThePicks) {
  // Each light's share of the picks is neither 0 nor 1, so that whoever forgets it in a weight is off by a factor.
  const glm::vec3 radiance(0.7f, 0.9f, 1.1f);
  for (const char* kind : {"point", "spot", "sun", "triangle", "all"}) {
    SceneBuilder builder = floor();
    Scene& scene = builder.scene();
    scene.environment = sky(radiance);
    glm::dvec3 irradiance = kPi * glm::dvec3(radiance);
    const bool all = std::string(kind) == "all";
    if (all || std::string(kind) == "point") {
      scene.points.push_back({{0, 2, 0}, glm::vec3(4.0f)});
      irradiance += glm::dvec3(4.0 / 4.0);
    }
    if (all || std::string(kind) == "spot") {
      scene.spots.push_back({{0, 2, 0}, {0, -1, 0}, glm::vec3(8.0f, 4.0f, 2.0f), 0.2, 0.4});
      irradiance += glm::dvec3(8.0, 4.0, 2.0) / 4.0;
    }
    if (all || std::string(kind) == "sun") {
      scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(1.0f, 2.0f, 3.0f)};
      irradiance += glm::dvec3(1.0, 2.0, 3.0);
    }
    if (all || std::string(kind) == "triangle") {
      const int lamp = builder.material(glm::vec3(0.0f));
      builder.materialAt(lamp).emission = {3.0f, 2.0f, 1.0f};
      const std::array<glm::dvec3, 3> corners{{{-1.0, 1.5, -1.5}, {1.2, 1.0, -1.0}, {0.1, 2.2, -2.0}}};
      builder.triangle(corners[0], corners[1], corners[2], lamp);
      const double share = reference::pointToPolygon({0, 0, 0}, {0, 1, 0}, corners);
      // It shines both ways, and hides its share of the sky.
      irradiance += kPi * share * (glm::dvec3(3.0, 2.0, 1.0) - glm::dvec3(radiance));
    }
    PathTracer::Settings settings = sized(16);
    settings.transport = Transport::direct;
    const PathTracer::Statistics result = tracer(scene, kDown, settings, 512).statistics();
    const glm::dvec3 expected = kAlbedo / kPi * irradiance;
    EXPECT_LT(deviations(result, expected), 4.0) << kind << " " << result.mean.x << " for " << expected.x;
    EXPECT_LT(result.meanError.x, 5e-3 * expected.x) << kind;
  }
}

TEST_F(PathShading, EmissiveTrianglesThatSharePicksWithALampAreWeighedOnce) {
  // Half of the light of a large near emitter is found by scattered rays: the weight of a hit must know the pick's
  // probability.
  SceneBuilder builder = floor();
  const int lamp = builder.material(glm::vec3(0.0f));
  builder.materialAt(lamp).emission = glm::vec3(1.0f);
  const std::array<glm::dvec3, 3> corners{{{-3.0, 1.0, 2.0}, {3.0, 1.0, 2.0}, {0.0, 1.0, -4.0}}};
  builder.triangle(corners[0], corners[1], corners[2], lamp);
  builder.scene().points.push_back({{0, 0.5, 0}, glm::vec3(2.0f)});
  const double expected = 0.6f / kPi * (kPi * reference::pointToPolygon({0, 0, 0}, {0, 1, 0}, corners) + 2.0 / 0.25);
  PathTracer::Settings settings = sized(16);
  settings.transport = Transport::direct;
  const PathTracer::Statistics result =
      tracer(builder.scene(), cameraAt({0.0, 0.4, 0.0}, {0, 0, 0}), settings, 1024).statistics();
  EXPECT_LT(deviations(result, expected * kAlbedo / kAlbedo.x), 4.0) << result.mean.x << " for " << expected;
  EXPECT_LT(result.meanError.x, 3e-3 * expected);
}

TEST_F(PathShading, ATexelOfTheSkyThatTheHorizonCutsIsSampledAllOver) {
  // One texel of 8 x 4 shines, and the floor is tilted so that it rises from the horizon within that texel.
  SceneBuilder builder;
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.8, 0.55, 0.1)),
                   u = glm::normalize(glm::cross(n, glm::dvec3(0, 0, 1))), v = glm::cross(n, u);
  builder.plate({0, 0, 0}, 40.0 * u, 40.0 * v, builder.material({0.6f, 0.5f, 0.4f}));
  builder.scene().sun.reset();
  builder.scene().environment = sky(glm::vec3(0.0f));
  builder.scene().environment->picture->at(3, 1) = {5.0f, 3.0f, 2.0f};
  // u grows with atan2(x, -z) from -pi, v from +y down.
  double cosines = 0.0;
  constexpr int kFine = 800;
  for (int i = 0; i < kFine; ++i)
    for (int j = 0; j < kFine; ++j) {
      const double azimuth = 2.0 * kPi * ((3.0 + (i + 0.5) / kFine) / 8.0 - 0.5),
                   polar = kPi * (1.0 + (j + 0.5) / kFine) / 4.0;
      const glm::dvec3 w(std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth));
      cosines += std::max(glm::dot(n, w), 0.0) * std::sin(polar) * (2.0 * kPi / 8.0 / kFine) * (kPi / 4.0 / kFine);
    }
  ASSERT_GT(cosines, 0.01);
  PathTracer::Settings settings = sized(16);
  settings.transport = Transport::direct;
  const PathTracer::Statistics result =
      tracer(builder.scene(), cameraAt(3.0 * n, {0, 0, 0}), settings, 1024).statistics();
  const glm::dvec3 expected = kAlbedo / kPi * glm::dvec3(5.0, 3.0, 2.0) * cosines;
  EXPECT_LT(deviations(result, expected), 4.0) << result.mean.x << " for " << expected.x;
  EXPECT_LT(result.meanError.x, 5e-3 * expected.x);
}

// -------------------------------------------------------------------------------------------------------------
// textures

/// Repeated bilinear lookup between texel centres, v = 0 at the bottom row.
double bilinear(int size, const std::function<double(int, int)>& texel, double u, double v) {
  const double x = u * size - 0.5, y = (1.0 - v) * size - 0.5, fx = x - std::floor(x), fy = y - std::floor(y);
  const auto at = [&](double i, double j) {
    return texel((static_cast<int>(i) % size + size) % size, (static_cast<int>(j) % size + size) % size);
  };
  const double i = std::floor(x), j = std::floor(y);
  return (1 - fy) * ((1 - fx) * at(i, j) + fx * at(i + 1, j)) + fy * ((1 - fx) * at(i, j + 1) + fx * at(i + 1, j + 1));
}

TEST_F(PathShading, TexturesAndMasksAreReadBetweenTexelCentres) {
  // Colours of 4 x 4 texels, and a mask that ramps in both directions: its edge lies where alpha passes a half.
  constexpr int kTexels = 4, kMaskTexels = 16, kPixels = 64;
  std::vector<std::uint8_t> colours, ramp;
  for (int i = 0; i < kTexels * kTexels; ++i)
    colours.insert(colours.end(), {static_cast<std::uint8_t>(20 + (i * 89) % 230),
                                   static_cast<std::uint8_t>(250 - (i * 53) % 200), 128, 255});
  for (int y = 0; y < kMaskTexels; ++y)
    for (int x = 0; x < kMaskTexels; ++x) {
      const auto alpha = static_cast<std::uint8_t>(12 * x + 4 * y);
      ramp.insert(ramp.end(), {alpha, alpha, alpha, 255});
    }
  SceneBuilder builder;
  const int picture = builder.texture(kTexels, kTexels, colours),
            mask = builder.texture(kMaskTexels, kMaskTexels, ramp), plain = builder.material(glm::vec3(1.0f)),
            masked = builder.material(glm::vec3(0.25f)), below = builder.material(glm::vec3(1.0f));
  builder.materialAt(plain).diffuseTexture = picture;
  builder.materialAt(masked).alphaTexture = mask;
  builder.materialAt(masked).alphaMasked = true;
  builder.plate({-1.5, 0, 0}, {2, 0, 0}, {0, 2, 0}, plain);
  builder.plate({1.5, 0, 0}, {2, 0, 0}, {0, 2, 0}, masked);
  builder.plate({1.5, 0, -1e-3}, {2, 0, 0}, {0, 2, 0}, below);
  builder.sun({0, 0, -1}, glm::vec3(static_cast<float>(kPi)));
  const Camera camera = lookingAt({0, 0, 4}, {0, 0, 0}, 1.2);
  PathTracer::Settings settings = sized(kPixels);
  settings.filter = PixelFilter::centre;
  settings.transport = Transport::direct;
  const Image traced = tracer(builder.scene(), camera, settings, 1).mean();
  RenderSettings forward;
  forward.technique = "direct";
  forward.size = glm::ivec2(kPixels);
  forward.fullFloatTarget = true;
  forward.textures.anisotropy = 1.0f;  // llvmpipe's anisotropic filter blurs what is magnified, too
  Renderer renderer(context(), library(), builder.scene(), forward);
  renderer.render(camera);
  const Image rastered = renderer.readRadiance();
  const auto linear = [&](int x, int y) {
    const double c = colours[static_cast<std::size_t>(4 * (y * kTexels + x))] / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const auto alpha = [&](int x, int y) { return ramp[static_cast<std::size_t>(4 * (y * kMaskTexels + x))] / 255.0; };
  int plainPixels = 0, holes = 0, kept = 0;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) {
      const glm::dvec3 ray = pixelRay(camera, x, y, glm::ivec2(kPixels)),
                       p = camera.position - camera.position.z / ray.z * ray;
      const double v = 0.5 * p.y + 0.5;
      if (v < 0.05 || v > 0.95) continue;
      if (const double u = 0.5 * (p.x + 1.5) + 0.5; u > 0.02 && u < 0.98) {
        ++plainPixels;
        const double expected = bilinear(kTexels, linear, u, v);
        ASSERT_NEAR(traced.at(x, y).x, expected, 2e-3) << x << " " << y;
        ASSERT_NEAR(rastered.at(x, y).x, expected, 8e-3) << x << " " << y;  // filters have 8 bits of weight
      }
      if (const double u = 0.5 * (p.x - 1.5) + 0.5; u > 0.05 && u < 0.93) {
        const double a = bilinear(kMaskTexels, alpha, u, v);
        if (std::abs(a - 0.5) < 0.02) continue;
        (a < 0.5 ? holes : kept)++;
        ASSERT_NEAR(traced.at(x, y).x, a < 0.5 ? 1.0 : 0.25, 1e-3) << x << " " << y << " alpha " << a;
        ASSERT_NEAR(rastered.at(x, y).x, a < 0.5 ? 1.0 : 0.25, 1e-3) << x << " " << y << " alpha " << a;
      }
    }
  EXPECT_GT(plainPixels, 150);
  EXPECT_GT(holes, 40);
  EXPECT_GT(kept, 40);
}

// ---------------------------------------------------------------------------------------------------- density grids

TEST_F(PathShading, ALampBehindAThickDensityGridIsDimmedByItsOpticalDepth) {
  // A slab of density 1 (in the grid's middle; cell centres at its faces) between lamp and floor: E = I / d^2
  // exp(-integral). Red passes, green hardly, blue not. Through the thickest slab red passes only by roulette.
  for (const double scale : {1.0, 4.0, 16.0}) {
    Scene scene;
    {
      SceneBuilder builder = floor();
      scene = builder.scene();
    }
    Medium medium = homogeneous(glm::dvec3(0.0), scale * glm::dvec3(0.5, 1.5, 2.5), 0.0);
    DensityGrid grid;
    grid.size = {4, 4, 4};
    grid.min = {-10.0, 0.5, -10.0};
    grid.max = {10.0, 1.5, 10.0};
    grid.density.resize(64);
    for (int z = 0; z < 4; ++z)
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
          grid.density[static_cast<std::size_t>(x + 4 * (y + 4 * z))] = y == 1 || y == 2 ? 1.0f : 0.25f;
    medium.grid = grid;
    scene.media.push_back(medium);
    addBox(scene, {-10.0, 0.5, -10.0}, {10.0, 1.5, 10.0}, addBoundary(scene, Bsdf::none, 1.0, 0));
    scene.points.push_back({{0, 2, 0}, glm::vec3(400.0f)});
    // Cell centres at 0.125, 0.375, 0.625, 0.875 of the height; held constant beyond the outermost centres.
    const double depth = scale * (0.25 * 0.25 + 0.5 * (0.25 + 1.0) * 0.5 + 0.25);
    PathTracer::Settings settings = sized(16);
    settings.transport = Transport::direct;
    const PathTracer::Statistics result =
        tracer(scene, cameraAt({0.0, 0.4, 0.0}, {0, 0, 0}), settings, 1024).statistics();
    for (int c = 0; c < 3; ++c) {
      const double expected = kAlbedo[c] / kPi * 100.0 * std::exp(-depth * (0.5 + c));
      if (expected < 1e-6) {  // too few paths arrive, or none, for their spread to be known
        EXPECT_LT(result.mean[c], 1e-6) << scale << " channel " << c;
        continue;
      }
      EXPECT_NEAR(result.mean[c], expected, 4.0 * result.meanError[c]) << scale << " channel " << c;
      if (expected > 1e-3) { EXPECT_LT(result.meanError[c], 0.06 * expected) << scale << " channel " << c; }
    }
  }
}

// ----------------------------------------------------------------------------------------------------------- interiors

TEST_F(PathShading, MediaOfManyBoundariesAreKnownByRank) {
  // Twenty-eight boxes side by side, each with its own medium, and so with its own rank, in every word of the counts.
  // Each absorbs by itself; every second is within another of lower priority that fills the row.
  Scene scene;
  constexpr int kBoxes = 28;
  scene.media.push_back(homogeneous(glm::dvec3(0.0), glm::dvec3(0.1, 0.2, 0.3), 0.0));
  addBox(scene, {-1.0, -0.6, -0.6}, {2.0 * kBoxes, 0.6, 0.6}, addBoundary(scene, Bsdf::none, 1.0, 0, -1));
  for (int i = 0; i < kBoxes; ++i) {
    scene.media.push_back(homogeneous(glm::dvec3(0.0), glm::dvec3(0.05 * (i + 1), 0.1, 0.02 * i), 0.0));
    addBox(scene, {2.0 * i + 0.25, -0.5, -0.5}, {2.0 * i + 1.25, 0.5, 0.5},
           addBoundary(scene, Bsdf::none, 1.0, i + 1, i));
  }
  scene.environment = constantEnvironment(1.0);
  for (int i = 0; i < kBoxes; ++i) {
    const double x = 2.0 * i + 0.75;
    const PathTracer::Statistics result =
        tracer(scene, cameraAt({x, 0.1, 5.0}, {x, 0.1, 0.0}), sized(8), 64).statistics();
    const glm::dvec3 depth = glm::dvec3(0.1, 0.2, 0.3) * 0.2 + glm::dvec3(0.05 * (i + 1), 0.1, 0.02 * i);
    EXPECT_LT(deviations(result, glm::exp(-depth)), 4.0) << "box " << i;
    EXPECT_LT(result.meanError.x, 0.015) << "box " << i;
  }
}

}  // namespace
}  // namespace lucerna::test
