// Glossy reflection of the light propagation volume on GL: its lobes against another quadrature, the shader against a
// double-precision reference implementation and closed forms, and pictures against the path tracer.
#include "cascades/cascades.hpp"
#include "lpv/glossy_lobes.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "lpv/settings.hpp"
#include "shared/lpv.h"
#include "pathtracer/path_tracer.hpp"
#include "render/renderer.hpp"
#include "shared/bindings.h"
#include "support/gl_fixture.hpp"
#include "support/lpv_reference.hpp"
#include "support/small_scenes.hpp"

#include "gl/pass.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

namespace lucerna {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;
const double kBasis0 = 0.5 / std::sqrt(std::numbers::pi), kBasis1 = std::sqrt(0.75 / std::numbers::pi);

/// The reference implementation of the lobe: midpoint rule over the facets visible from o, by the spherical caps of
/// [DupuyBenyoub2023], each weighted by G2 / G1, where the engine has all facets. GGX with height-correlated shadowing
/// [Heitz2014, eq 99]. To 4e-4. x: towards the mirror direction's side.
GlossyLobe lobeOverVisibleFacets(double cosine, double alpha) {
  constexpr int kPoints = 400;
  const glm::dvec3 o(-std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
  const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * o.x, 0.0, o.z));
  const auto lambda = [&](const glm::dvec3& w) {
    return 0.5 * std::sqrt(1.0 + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z)) - 0.5;
  };
  GlossyLobe lobe{glm::dvec3(0.0), glm::dvec3(0.0)};
  for (int j = 0; j < kPoints; ++j)
    for (int k = 0; k < kPoints; ++k) {
      const double z = (1.0 - (j + 0.5) / kPoints) * (1.0 + stretched.z) - stretched.z;
      const double r = std::sqrt(1.0 - z * z), angle = kTau * (k + 0.5) / kPoints;
      const glm::dvec3 cap = glm::dvec3(r * std::cos(angle), r * std::sin(angle), z) + stretched;
      const glm::dvec3 h = glm::normalize(glm::dvec3(alpha * cap.x, alpha * cap.y, std::max(cap.z, 1e-12)));
      const glm::dvec3 i = 2.0 * glm::dot(o, h) * h - o;
      if (!(i.z > 0.0)) continue;
      const double weight = (1.0 + lambda(o)) / (1.0 + lambda(o) + lambda(i)) / (kPoints * kPoints);
      lobe.facets += weight * glm::dvec3(1.0, i.x, i.z);
      lobe.grazing += std::pow(1.0 - glm::dot(o, h), 5.0) * weight * glm::dvec3(1.0, i.x, i.z);
    }
  return lobe;
}

struct GlossyProbe {
  glm::vec4 position, normal, toCamera, specular;  ///< w of specular: alpha
};

/// A volume of one cascade with its minimum in the origin, its coefficients per channel as stored.
struct SmallVolume {
  int cells = 4;
  double cellSize = 0.5, irradiance = 3.0;
  int steps = 1;
  std::vector<glm::vec4> texels[3];
  std::optional<reference::Volume> geometry;  ///< its samples lie on the cells' corners; none: empty
  glm::dvec4 at(int channel, const glm::ivec3& cell) const {
    if (glm::any(glm::lessThan(cell, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(cell, glm::ivec3(cells))))
      return glm::dvec4(0.0);
    return glm::dvec4(texels[channel][static_cast<std::size_t>((cell.z * cells + cell.y) * cells + cell.x)]);
  }
  glm::dvec4 trilinear(int channel, const glm::dvec3& position) const {
    const glm::dvec3 texel = position / cellSize - 0.5, low = glm::floor(texel), part = texel - low;
    glm::dvec4 sum(0.0);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::dvec3 w = glm::mix(1.0 - part, part, glm::dvec3(step));
      sum += w.x * w.y * w.z * at(channel, glm::ivec3(low) + step);
    }
    return sum;
  }
};

/// Light along a direction by the reference implementation: the march to surfels of the geometry.
glm::dvec4 lightAlong(const SmallVolume& volume, int channel, const glm::dvec3& position, const glm::dvec3& towards) {
  double left = 1.0;
  int k = 1;
  for (; k < volume.steps; ++k) {
    if (!volume.geometry) continue;
    const reference::Sh potential =
        reference::sampleTrilinear(*volume.geometry, position + (k + 1) * volume.cellSize * towards);
    left -= std::clamp(-2.0 * reference::kY1 * glm::dot(potential.c1, towards), 0.0, 1.0);
    if (left < 0.5) break;
  }
  return volume.trilinear(channel, position + k * volume.cellSize * towards);
}

/// The reference implementation of shaders/lpv/glossy.glsl: the reflected radiance, from the lobe's own integrals.
glm::dvec3 reflectedByReference(const SmallVolume& volume, const GlossyProbe& probe) {
  const glm::dvec3 n(probe.normal), o(probe.toCamera), position(probe.position);
  const double cosine = glm::dot(n, o), alpha = static_cast<double>(probe.specular.w);
  const glm::dvec3 across = glm::normalize(cosine * n - o);
  const GlossyLobe lobe = lobeOverVisibleFacets(cosine, alpha);
  // A spiral over the cap about the mean whose mean is as long as the lobe's.
  const double length = std::hypot(lobe.facets.y, lobe.facets.z) / lobe.facets.x;
  const glm::dvec3 mean = glm::normalize(lobe.facets.y * across + lobe.facets.z * n);
  const glm::dvec3 u = glm::normalize(glm::cross(n, across)), v = glm::cross(mean, u);
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0)), border = 2.0 * std::max(length, 0.5) - 1.0;
  std::vector<glm::dvec3> cone;
  for (int i = 0; i < 8; ++i) {
    const double z = 1.0 - (1.0 - border) * (i + 0.5) / 8.0, r = std::sqrt(1.0 - z * z);
    cone.push_back(z * mean + r * std::cos(golden * i) * u + r * std::sin(golden * i) * v);
  }
  std::erase_if(cone, [&](const glm::dvec3& one) { return glm::dot(one, n) <= 0.0; });
  // Radiance l0 = 2/3 c0, l1 = 3 / (2 pi) (front + 8 side / sqrt 5) c1: the solid angles of a cell's faces.
  const double band1 = 3.0 / kTau * (reference::frontSolidAngle() + 8.0 * reference::sideSolidAngle() / std::sqrt(5.0));
  glm::dvec3 result;
  for (int c = 0; c < 3; ++c) {
    glm::dvec4 light(0.0);
    for (const glm::dvec3& one : cone) light += lightAlong(volume, c, position, one) / static_cast<double>(cone.size());
    const double f0 = probe.specular[c];
    glm::dvec3 moments = f0 * lobe.facets + (1.0 - f0) * lobe.grazing;
    const glm::dvec3 m = moments.y * across + moments.z * n, l1 = band1 * glm::dvec3(light.y, light.z, light.w);
    result[c] = std::max(0.0, kBasis0 * moments.x * 2.0 / 3.0 * light.x - kBasis1 * glm::dot(l1, m));
  }
  return result * volume.irradiance;
}

class GlossyTest : public test::SharedProgramsTest {
 protected:
  static std::vector<glm::dvec3> reflected(const SmallVolume& volume, const std::vector<GlossyProbe>& probes) {
    shared::CascadeConstants constants{};
    constants.cascades[0].cellSize = static_cast<float>(volume.cellSize);
    constants.cascades[0].blendHalf = 1e30f;
    constants.shape = {volume.cells, 1, volume.steps, 0};
    constants.referenceIrradiance = static_cast<float>(volume.irradiance);
    constants.blendBand = 0.25f;
    const gl::Buffer block("constants", sizeof constants, &constants, gl::Usage::staticDraw);
    gl::Sampling sampling{gl::Filter::linear, gl::Filter::linear, gl::Wrap::border};
    std::vector<gl::Texture> textures;
    for (int c = 0; c < 3; ++c)
      textures.emplace_back("light", gl::Format::rgba32f, glm::ivec3(volume.cells), sampling)
          .upload(gl::Texels::rgbaFloat, volume.texels[c].data());
    const gl::Buffer in("probes", probes.size() * sizeof(GlossyProbe), probes.data(), gl::Usage::staticDraw);
    const gl::Buffer out("radiances", probes.size() * sizeof(glm::vec4), nullptr, gl::Usage::dynamicCopy);
    const gl::ShaderFlags flags = LightPropagationVolume::lookupFlags(LpvSettings{});
    gl::Texture geometry("geometry", gl::Format::rgba32f, glm::ivec3(volume.cells + 1), sampling);
    std::vector<glm::vec4> corners;
    if (volume.geometry)
      for (const reference::Sh& sh : volume.geometry->cells) corners.emplace_back(glm::dvec4(sh.c0, sh.c1));
    else corners.assign(static_cast<std::size_t>(std::pow(volume.cells + 1, 3)), glm::vec4(0.0f));
    geometry.upload(gl::Texels::rgbaFloat, corners.data());
    const gl::Program& program = library().loadCompute("glossy probe", "lpv/glossy_probe.comp", flags);
    const GlossyLobes lobes;
    {
      const gl::ComputePass pass("glossy probe");
      program.use();
      block.bindUniform(BLOCK_CASCADES);
      for (GLuint c = 0; c < 3; ++c) textures[c].bind(UNIT_LPV_RED + c);
      lobes.bind();
      geometry.bind(UNIT_LPV_GEOMETRY);
      in.bindStorage(0);
      out.bindStorage(1);
      pass.dispatch(glm::ivec3(static_cast<int>(probes.size()), 1, 1), glm::ivec3(64, 1, 1));
    }
    std::vector<glm::dvec3> result;
    for (const glm::vec4& radiance : out.read<glm::vec4>()) result.emplace_back(glm::vec3(radiance));
    return result;
  }
  /// Probes in the middle of the volume: every alpha at several angles.
  static std::vector<GlossyProbe> probes(const SmallVolume& volume, const glm::vec3& specular) {
    std::vector<GlossyProbe> result;
    const glm::vec3 n = glm::normalize(glm::vec3(0.3f, 1.0f, -0.2f));
    const glm::vec3 t = glm::normalize(glm::cross(n, glm::vec3(0, 0, 1)));
    const auto middle = static_cast<float>(0.5 * volume.cells * volume.cellSize);
    for (const float alpha : {0.8f, 0.5f, 0.25f, 0.06f})
      for (const float cosine : {0.1f, 0.35f, 0.7f, 0.98f})
        result.push_back({glm::vec4(glm::vec3(middle - 0.1f, middle, middle + 0.2f), 1), glm::vec4(n, 0),
                          glm::vec4(cosine * n + std::sqrt(1.0f - cosine * cosine) * t, 0),
                          glm::vec4(specular, alpha)});
    return result;
  }
};

// Two quadratures over different domains agree; what facets reflect never exceeds 1; a smooth one is a mirror.
TEST_F(GlossyTest, LobesAgreeWithAnotherQuadrature) {
  for (const double alpha : {0.1, 0.15, 0.3, 0.6, 1.0})
    for (const double cosine : {0.05, 0.2, 0.5, 0.8, 0.99}) {
      const GlossyLobe here = glossyLobe(cosine, alpha), there = lobeOverVisibleFacets(cosine, alpha);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(here.facets[k], there.facets[k], 2.4e-3) << alpha << " " << cosine << " " << k;
        EXPECT_NEAR(here.grazing[k], there.grazing[k], 2.4e-3) << alpha << " " << cosine << " " << k;
      }
      EXPECT_LE(here.facets.x, 1.0 + 1e-12);
      EXPECT_LE(std::hypot(here.facets.y, here.facets.z), here.facets.x) << "a mean of unit vectors";
    }
  const GlossyLobe mirror = glossyLobe(0.6, 1e-3);
  EXPECT_NEAR(mirror.facets.x, 1.0, 1e-3);
  EXPECT_NEAR(mirror.facets.y, 0.8, 1e-3);
  EXPECT_NEAR(mirror.facets.z, 0.6, 1e-3);
  EXPECT_NEAR(mirror.grazing.x, std::pow(0.4, 5.0), 1e-3);
}

// A constant radiance L is reflected as rho L, whatever the march. The volume is large enough for all steps.
TEST_F(GlossyTest, AConstantRadianceIsReflectedByTheReflectance) {
  SmallVolume volume;
  volume.cells = 12;
  volume.irradiance = 2.0;
  const glm::dvec3 radiance(0.5, 1.0, 3.0);
  for (int c = 0; c < 3; ++c)  // L = Y00 2/3 c0 E_ref
    volume.texels[c].assign(12 * 12 * 12,
                            glm::vec4(static_cast<float>(radiance[c] / (kBasis0 * 2.0 / 3.0 * 2.0)), 0, 0, 0));
  for (const int steps : {1, 4}) {
    volume.steps = steps;
    const std::vector<GlossyProbe> places = probes(volume, {0.9f, 0.5f, 0.04f});
    const std::vector<glm::dvec3> found = reflected(volume, places);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double cosine = static_cast<double>(glm::dot(glm::vec3(places[i].normal), glm::vec3(places[i].toCamera)));
      const double alpha = static_cast<double>(places[i].specular.w);
      const GlossyLobe lobe = lobeOverVisibleFacets(cosine, alpha);
      for (int c = 0; c < 3; ++c) {
        const double f0 = places[i].specular[c], rho = f0 * lobe.facets.x + (1.0 - f0) * lobe.grazing.x;
        EXPECT_NEAR(found[i][c], rho * radiance[c], 5e-3 * radiance[c]) << i << " " << c;
      }
    }
  }
}

// Any light: coefficients drawn at random, in cells and places between them; with surfels in half of the corners too.
TEST_F(GlossyTest, TheShaderAgreesWithItsReference) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f), sign(-0.5f, 0.5f);
  for (const bool hasSurfels : {false, true}) {
    SmallVolume volume;
    volume.cells = 8;
    volume.steps = 4;
    for (auto& channel : volume.texels)
      for (int i = 0; i < 8 * 8 * 8; ++i)
        channel.push_back({1.0f + unit(random), sign(random), sign(random), sign(random)});
    if (hasSurfels) {
      volume.geometry.emplace(
          reference::geometryGrid(reference::GridSpec{glm::ivec3(volume.cells), glm::dvec3(0.0), volume.cellSize}));
      for (reference::Sh& sh : volume.geometry->cells)
        if (unit(random) < 0.5f)
          sh = 0.4 * reference::lobe(glm::normalize(glm::dvec3(sign(random), sign(random), sign(random))));
    }
    const std::vector<GlossyProbe> places = probes(volume, {0.9f, 0.3f, 0.04f});
    const std::vector<glm::dvec3> found = reflected(volume, places);
    double largest = 0.0, brightest = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const glm::dvec3 expected = reflectedByReference(volume, places[i]);
      for (int c = 0; c < 3; ++c) {
        largest = std::max(largest, std::abs(found[i][c] - expected[c]));
        brightest = std::max(brightest, expected[c]);
      }
    }
    std::cout << "[ measured ] " << (hasSurfels ? "surfels" : "no surfels")
              << ": largest difference to the reference implementation " << largest / brightest << "\n";
    EXPECT_LT(largest, 8e-3 * brightest) << hasSurfels;  // of the lobes' own quadrature and of their table
  }
}

// Marched light is that before the first wall: a wall of surfels across the ray, all light before it, none behind.
TEST_F(GlossyTest, AMarchEndsAtTheFirstWall) {
  SmallVolume volume;
  volume.cells = 16;
  volume.cellSize = 1.0;
  volume.irradiance = 1.0;
  volume.steps = 40;
  for (auto& channel : volume.texels)
    for (int z = 0; z < 16; ++z)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) channel.push_back({y < 10 ? static_cast<float>(1.5 / kBasis0) : 0.0f, 0, 0, 0});
  const GlossyProbe up{{8.0f, 4.2f, 8.0f, 1}, {0, 1, 0, 0}, {0.1f, 0.995f, 0.0f, 0}, {1.0f, 1.0f, 1.0f, 0.0045f}};
  const auto seen = [&](bool wall) {
    volume.geometry.emplace(reference::geometryGrid(reference::GridSpec{glm::ivec3(16), glm::dvec3(0.0), 1.0}));
    for (int z = 0; z <= 16 && wall; ++z)
      for (int x = 0; x <= 16; ++x) volume.geometry->at({x, 10, z}) = reference::lobe({0, -1, 0});
    return reflected(volume, {up})[0].x;
  };
  EXPECT_NEAR(seen(true), 1.0, 0.02) << "radiance 1 before the wall";
  EXPECT_NEAR(seen(false), 0.0, 1e-6) << "and none far above";
}

// One lobe of light that travels down: a mirror that looks up reflects it, one that looks down reflects none of it.
TEST_F(GlossyTest, OneLobeIsReflectedFromTheSideItComesFrom) {
  SmallVolume volume;
  volume.steps = 1;
  // c = (1, 0, -b, 0): radiance Y00 2/3 - Y1 0.9146 b w.y of light that travels along w.
  const double b = 0.4;
  for (auto& channel : volume.texels) channel.assign(64, glm::vec4(1.0f, 0.0f, static_cast<float>(-b), 0.0f));
  const glm::vec4 middle(1.0f, 1.0f, 1.0f, 1.0f), white(1.0f, 1.0f, 1.0f, 0.0014f);
  const glm::vec3 up(0.6f, 0.8f, 0.0f);
  const std::vector<GlossyProbe> places{{middle, {0, 1, 0, 0}, glm::vec4(up, 0), white},
                                        {middle, {0, -1, 0, 0}, glm::vec4(-up, 0), white}};
  const std::vector<glm::dvec3> found = reflected(volume, places);
  const double band0 = kBasis0 * 2.0 / 3.0, band1 = kBasis1 * 0.91461886 * b;
  EXPECT_NEAR(found[0].x, 3.0 * (band0 + 0.8 * band1), 5e-3);
  EXPECT_NEAR(found[1].x, 3.0 * std::max(0.0, band0 - 0.8 * band1), 5e-3);
}

// Looked at along the normal there is no tangent to go by; the reflection is that of nearly the normal.
TEST_F(GlossyTest, AlongTheNormalItIsContinuous) {
  SmallVolume volume;
  volume.cells = 12;
  for (auto& channel : volume.texels)
    for (int i = 0; i < 12 * 12 * 12; ++i) channel.push_back({1.0f + 0.05f * static_cast<float>(i % 12), 0.1f, 0, 0});
  std::vector<GlossyProbe> places;
  for (const float tilt : {0.0f, 0.01f})
    places.push_back({glm::vec4(3, 3, 3, 1),
                      {0, 1, 0, 0},
                      glm::vec4(glm::normalize(glm::vec3(tilt, 1, 0)), 0),
                      {0.9f, 0.9f, 0.9f, 0.25f}});
  const std::vector<glm::dvec3> found = reflected(volume, places);
  EXPECT_GT(found[0].x, 0.0);
  EXPECT_NEAR(found[0].x / found[1].x, 1.0, 0.05);
}

// Never more than what arrives.
TEST_F(GlossyTest, NoMoreIsReflectedThanArrives) {
  SmallVolume volume;
  volume.irradiance = 1.0;
  for (auto& channel : volume.texels) channel.assign(64, glm::vec4(static_cast<float>(1.5 / kBasis0), 0, 0, 0));
  volume.steps = 1;
  for (const float specular : {0.04f, 0.5f, 1.0f})
    for (const glm::dvec3& radiance : reflected(volume, probes(volume, glm::vec3(specular))))
      for (int c = 0; c < 3; ++c) EXPECT_LE(radiance[c], 1.0 + 1e-5);
}

// ------------------------------------------------------------------------------------------------------------ pictures

/// The open box, its back wall a conductor or black: the camera sees the sunlit floor and wall in it.
Scene boxWithWall(double alpha, bool glossy = true) {
  Scene scene = test::openBox();
  Material& wall = scene.materials.emplace_back();
  wall.diffuse = glm::vec3(0.0f);
  if (glossy) {
    wall.bsdf = Bsdf::conductor;
    wall.specular = glm::vec3(0.9f);
    wall.roughness = static_cast<float>(alpha);
  }
  scene.meshes[1].material = static_cast<int>(scene.materials.size()) - 1;
  return scene;
}

constexpr glm::ivec2 kGlossySize{48, 32};

RenderSettings glossySettings() {
  RenderSettings settings;
  settings.technique = "lpv";
  settings.component = Component::indirect;
  settings.size = kGlossySize;
  settings.fullFloatTarget = true;
  settings.of<LpvSettings>().glossy = true;
  settings.shadow.size = 512;
  return settings;
}

Image glossyPicture(gl::ProgramLibrary& programs, const gl::Context& context, const Scene& scene,
                    const RenderSettings& settings) {
  Renderer renderer(context, programs, scene, settings);
  renderer.renderToTheEnd(test::openBoxCamera());
  return renderer.readRadiance();
}

// The wall alone, in blocks of 4x4 pixels, against paths that meet floor or side and then the wall. It is black without
// glossy reflection, error 1. What remains is the volume's: two bands, and cells that are in part behind the surface.
TEST_F(GlossyTest, AWallReflectsAboutWhatPathsDo) {
  for (const double alpha : {0.1, 0.5}) {
    const Scene scene = boxWithWall(alpha);
    RenderSettings settings = glossySettings();
    const auto with = [&](bool glossy) {
      settings.of<LpvSettings>().glossy = glossy;
      return glossyPicture(library(), context(), scene, settings);
    };
    const Image without = with(false), on = with(true);
    PathTracer::Settings paths;
    paths.size = kGlossySize;
    paths.transport = Transport::indirect;
    paths.bounces = 2;
    paths.filter = PixelFilter::centre;
    PathTracer tracer(context(), library(), scene, paths);
    tracer.setCamera(test::openBoxCamera());
    tracer.record(128);
    const Image there = tracer.mean();
    double squares = 0.0, sumThere = 0.0, differences = 0.0, sum = 0.0;
    int blocks = 0;
    for (int by = 0; by < kGlossySize.y; by += 4)
      for (int bx = 0; bx < kGlossySize.x; bx += 4) {
        double a = 0.0, b = 0.0;
        bool onWall = true;
        for (int y = by; y < by + 4; ++y)
          for (int x = bx; x < bx + 4; ++x) {
            onWall = onWall && without.at(x, y) == glm::vec3(0.0f) && there.at(x, y) != glm::vec3(0.0f);
            a += static_cast<double>(on.at(x, y).y) / 16.0;
            b += static_cast<double>(there.at(x, y).y) / 16.0;
          }
        if (!onWall) continue;
        ++blocks;
        squares += b * b, sumThere += b;
        differences += (a - b) * (a - b), sum += a;
      }
    ASSERT_GT(blocks, 8);
    const double error = std::sqrt(differences / squares),
                 constant = std::sqrt(1.0 - sumThere * sumThere / (blocks * squares));
    std::cout << "[ measured ] alpha " << alpha << ", " << blocks << " blocks: relative L2 " << error
              << "; brightness over paths' " << sum / sumThere << "; best constant " << constant << "\n";
    EXPECT_LT(error, constant) << alpha;  // it knows where the light is
  }
}

TEST_F(GlossyTest, NothingOfItIsThereUnlessAskedForAndNeeded) {
  struct Made {
    bool leftOut;
    std::size_t gpuBytes;
    std::vector<std::string> resources;
    Image picture;
    bool has(const char* name) const { return std::ranges::find(resources, name) != resources.end(); }
  };
  const auto made = [](const Scene& scene, bool glossy) {
    RenderSettings settings = glossySettings();
    settings.of<LpvSettings>().glossy = glossy;
    gl::ProgramLibrary own;
    Renderer renderer(context(), own, scene, settings);
    renderer.render(test::openBoxCamera());
    const std::vector<std::string> left = renderer.leftOut();
    Made result{std::ranges::count(left, "glossy reflection") == 1, renderer.gpuBytes(), {}, renderer.readRadiance()};
    for (const auto& program : own.programs())
      for (const std::string& resource : program->activeResources()) result.resources.push_back(resource);
    return result;
  };
  const Made on = made(boxWithWall(0.3), true), off = made(boxWithWall(0.3), false),
             unneeded = made(boxWithWall(0.3, false), true), plain = made(boxWithWall(0.3, false), false);
  EXPECT_FALSE(on.leftOut);
  EXPECT_TRUE(on.has("lpvLobes"));
  EXPECT_TRUE(on.has("materialAlpha"));
  EXPECT_EQ(on.gpuBytes, off.gpuBytes + 2 * LPV_LOBES_ANGLES * LPV_LOBES_ALPHAS * sizeof(glm::vec4));
  for (const Made* without : {&off, &unneeded}) {
    EXPECT_TRUE(without->leftOut);
    EXPECT_FALSE(without->has("lpvLobes"));
  }
  EXPECT_FALSE(unneeded.has("materialAlpha"));
  EXPECT_EQ(unneeded.gpuBytes, plain.gpuBytes);
  EXPECT_EQ(unneeded.picture.pixels, plain.picture.pixels);
  EXPECT_NE(on.picture.pixels, off.picture.pixels);
}

// Its share of a pixel is listed, and all shares add up to the pixel.
TEST_F(GlossyTest, AnAskedPixelListsIt) {
  const Scene scene = boxWithWall(0.3);
  RenderSettings settings = glossySettings();
  Renderer renderer(context(), library(), scene, settings);
  renderer.renderToTheEnd(test::openBoxCamera());
  const Image image = renderer.readRadiance();
  const glm::ivec2 pixel(kGlossySize.x * 9 / 20, kGlossySize.y / 2);
  const PixelInspection answer = renderer.inspect(library(), test::openBoxCamera(), pixel);
  ASSERT_TRUE(std::ranges::any_of(answer.shares, [](const PixelShare& s) { return s.name == "glossy reflection"; }));
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(answer.sum()[c], static_cast<double>(image.at(pixel.x, pixel.y)[c]), 1e-5) << c;
}

}  // namespace
}  // namespace lucerna
