// The reflective shadow map: what leaves a lit plate, whatever its tilt, the sun's direction and the map's size.
#include "base/angles.hpp"
#include "support/gl_fixture.hpp"
#include "support/small_scenes.hpp"
#include "support/sun_frame.hpp"

#include "forward/sun_frustum.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "shared/bindings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

namespace lucerna {
namespace {

using test::SceneBuilder;

class ReflectiveShadowMapGl : public test::SharedProgramsTest {
 protected:
  /// The map of a scene, read back.
  struct Drawn {
    std::vector<glm::vec4> position, normal, flux;
    glm::dvec3 totalFlux{0.0};
    glm::dvec3 injectedFlux{
        0.0};  ///< of a volume of one cascade that holds the scene: band 0 * sqrt(4 pi) * E_ref * s^2
    std::size_t covered = 0;
  };
  static Drawn draw(const Scene& scene, int size, const GpuSceneSettings& textures = {}) {
    const SceneFeatures features = analyse(scene);
    const GpuScene gpuScene(scene, features, capabilities(), textures);
    ReflectiveShadowMap rsm(library(), gpuScene, {size});
    EXPECT_EQ(rsm.size(), size);
    const SunFrustum frustum = fitSunFrustum(scene, scene.sun->direction);
    const gl::Buffer frame = test::bindSunFrame(scene, frustum);
    const ReflectiveShadowMap::Outputs outputs = rsm.record(gpuScene, frustum);
    EXPECT_NEAR(outputs.texelArea, frustum.width * frustum.height / (static_cast<double>(size) * size),
                1e-6 * outputs.texelArea);

    Drawn drawn{outputs.position.readRgba(), outputs.normal.readRgba(), outputs.flux.readRgba(), {}, {}, 0};
    for (std::size_t i = 0; i < drawn.flux.size(); ++i) {
      drawn.totalFlux += glm::dvec3(drawn.flux[i]);
      if (drawn.position[i].w > 0.5f) ++drawn.covered;
    }
    LpvSettings settings;
    settings.cascades.cells = 10;
    settings.cascades.cascades = 1;
    settings.iterations = 0;
    LightPropagationVolume lpv(library(), capabilities(), settings);
    const LpvInputs inputs{{outputs},
                           placeCascades(settings.cascades, scene.bounds, scene.bounds.centre(), glm::dvec3(0.0)),
                           scene.sun->irradiance.x};
    lpv.place(inputs);
    lpv.inject(inputs);
    const double s = inputs.cascades[0].cellSize;
    for (int channel = 0; channel < 3; ++channel)
      for (const glm::vec4& cell : lpv.result()[static_cast<std::size_t>(channel)].readRgba())
        drawn.injectedFlux[channel] +=
            std::sqrt(4.0 * std::numbers::pi) * inputs.referenceIrradiance * s * s * static_cast<double>(cell.x);
    return drawn;
  }

  /// A plate tilted against a sun that falls straight down, turned in its plane and about the sun, so that its edges
  /// cross the texels at all phases and coverage averages out.
  static Scene tiltedPlate(double degrees, const glm::dvec3& sun, float normalSign = 1.0f, double turn = 0.0) {
    SceneBuilder builder;
    const glm::dvec3 u = 2.0 * glm::dvec3(std::cos(0.5), 0.0, std::sin(0.5)),
                     across = glm::normalize(glm::dvec3(-u.z, 0.0, u.x));
    const glm::dvec3 v =
        1.4 * (std::cos(degrees * kDegree) * across + std::sin(degrees * kDegree) * glm::dvec3(0, 1, 0));
    const double c = std::cos(turn), s = std::sin(turn);
    builder.plate({0.3, -2.0, 1.0}, c * u + s * (2.0 / 1.4) * v, c * v - s * (1.4 / 2.0) * u,
                  builder.material({0.8f, 0.4f, 0.1f}), normalSign);
    builder.sun(sun, {5.0f, 6.0f, 7.0f});
    return builder.scene();
  }
  /// albedo * E * area across the rays.
  static glm::dvec3 expectedFlux(const Scene& scene) {
    const auto corner = [&](std::size_t i) { return glm::dvec3(scene.vertices[i].position); };
    const glm::dvec3 area = glm::cross(corner(1) - corner(0), corner(3) - corner(0));
    return glm::dvec3(scene.sun->irradiance) * glm::dvec3(scene.materials[0].diffuse) *
           std::abs(glm::dot(area, scene.sun->direction));
  }
  static void expectWithin(const glm::dvec3& actual, const glm::dvec3& expected, double relative,
                           const std::string& what) {
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(actual[channel] / expected[channel], 1.0, relative) << what << ", channel " << channel;
  }
};

TEST_F(ReflectiveShadowMapGl, FluxIsAlbedoTimesIrradianceTimesProjectedArea) {
  double worst = 0.0;
  int cases = 0;
  for (const double degrees : {0.0, 30.0, 60.0, 85.0})
    for (const glm::dvec3& sun : {glm::dvec3(0, -1, 0), glm::dvec3(0.4, -0.8, -0.3), glm::dvec3(-1.0, -0.2, 0.1)})
      for (const int size : {64, 128, 256, 512}) {
        const Scene scene = tiltedPlate(degrees, sun, 1.0f, 0.7);
        if (expectedFlux(scene).x < 0.1 * 0.8 * 5.0 * 2.8) continue;  // seen edge-on: thinner than a texel
        ++cases;
        const Drawn drawn = draw(scene, size);
        const glm::dvec3 expected = expectedFlux(scene);
        const std::string what =
            "tilt " + std::to_string(degrees) + ", map " + std::to_string(size) + ", sun x " + std::to_string(sun.x);
        expectWithin(drawn.totalFlux, expected, 0.01, what);
        // A cell sums some thousand equal terms in 32 bits: 8192 roundings of 2^-24 at worst.
        expectWithin(drawn.injectedFlux, drawn.totalFlux, 5e-4, what + ", injected");
        worst = std::max(worst, std::abs(drawn.totalFlux.x / expected.x - 1.0));
      }
  EXPECT_GE(cases, 36);
  std::cout << "[ measured ] " << cases << " cases, flux, largest error: " << worst << "\n";
}

// Triangles that cover no texel's centre are left out where a software renderer draws more of them than texels. The map
// is that of all triangles, bit by bit, also far from the origin, where positions in it are rounded most.
TEST_F(ReflectiveShadowMapGl, TrianglesThatCoverNoTexelAreLeftOut) {
  for (const double away : {0.0, 300.0}) {
    SceneBuilder builder;
    builder.sun({0.3, -1.0, 0.2}, {5.0f, 6.0f, 7.0f});
    const int materials[] = {builder.material({0.8f, 0.4f, 0.1f}), builder.material({0.2f, 0.5f, 0.9f})};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int i = 0; i < 12000; ++i) {
      const auto any = [&](double size) {
        return size * glm::dvec3(uniform(random), uniform(random), uniform(random));
      };
      const glm::dvec3 place = any(1.0) + glm::dvec3(away, 0.0, -away);
      // Most are smaller than a texel, some cross several.
      const double size = i % 10 == 0 ? 0.08 : 0.01;
      builder.triangle(place + any(size), place + any(size), place + any(size), materials[i % 2]);
    }
    const Scene scene = builder.scene();
    const SunFrustum frustum = fitSunFrustum(scene, scene.sun->direction);
    const gl::Buffer frame = test::bindSunFrame(scene, frustum);
    constexpr int kSize = 64;
    std::array<std::vector<glm::vec4>, 2> flux, position;
    for (const bool software : {false, true}) {
      gl::Capabilities treatedAs = capabilities();
      treatedAs.softwareRenderer = software;
      const GpuScene gpuScene(scene, analyse(scene), treatedAs);
      EXPECT_EQ(gpuScene.isSelectionWorthwhile(kSize), software);
      EXPECT_FALSE(gpuScene.isSelectionWorthwhile(256));
      ReflectiveShadowMap rsm(library(), gpuScene, {kSize});
      const ReflectiveShadowMap::Outputs outputs = rsm.record(gpuScene, frustum);
      flux[software] = outputs.flux.readRgba();
      position[software] = outputs.position.readRgba();
      if (!software) continue;
      const std::size_t drawn = gpuScene.covering(glm::mat4(frustum.clipFromWorld), kSize).triangleCount();
      std::cout << "[ measured ] triangles drawn of 12000: " << drawn << "\n";
      EXPECT_LT(drawn, 6000u);
      EXPECT_GT(drawn, 1200u);
    }
    EXPECT_GT(std::count_if(position[0].begin(), position[0].end(), [](const glm::vec4& p) { return p.w > 0.5f; }),
              900);
    EXPECT_EQ(flux[0], flux[1]) << away;
    EXPECT_EQ(position[0], position[1]) << away;
  }
}

// Texel centres lie at whole numbers, from 0 to 7. A triangle that covers the first or the last of them is kept; one
// between two centres or outside the map is not.
TEST_F(ReflectiveShadowMapGl, TrianglesOverTexelsAtTheBorderAreKept) {
  constexpr int kSize = 8;
  struct Case {
    double from, to;
    bool isKept;
  };
  for (const Case& c : {Case{-0.8, -0.2, false},
                        {-0.4, 0.4, true},
                        {0.2, 0.8, false},
                        {-0.4, 7.4, true},
                        {6.2, 6.8, false},
                        {6.6, 7.4, true},
                        {7.2, 7.8, false}})
    for (const bool along : {false, true}) {
      const auto place = [&](double across, double other) {
        const auto inClip = [](double texel) { return 2.0 * (texel + 0.5) / kSize - 1.0; };
        return glm::dvec3(inClip(along ? across : other), inClip(along ? other : across), 0.0);
      };
      SceneBuilder builder;
      builder.triangle(place(c.from, 2.5), place(c.to, 2.5), place(c.to, 4.5), builder.material(glm::vec3(0.5f)));
      const Scene scene = builder.scene();
      const GpuScene gpuScene(scene, analyse(scene), capabilities());
      EXPECT_EQ(gpuScene.covering(glm::mat4(1.0f), kSize).triangleCount(), c.isKept ? 1u : 0u)
          << c.from << " to " << c.to << (along ? " in x" : " in y");
    }
}

TEST_F(ReflectiveShadowMapGl, PositionsLieOnThePlateAndNormalsOnTheLightsSide) {
  for (const float normalSign : {1.0f, -1.0f})  // vertex normals with and against the winding
    for (const double degrees : {20.0, 160.0, 200.0, 340.0}) {  // either side towards the light
      const glm::dvec3 sun = glm::normalize(glm::dvec3(0.2, -1.0, 0.1));
      const Scene scene = tiltedPlate(degrees, sun, normalSign);
      const Drawn drawn = draw(scene, 64);
      ASSERT_GT(drawn.covered, 500u);
      ASSERT_LT(drawn.covered, drawn.position.size());
      const auto corner = [&](std::size_t i) { return glm::dvec3(scene.vertices[i].position); };
      glm::dvec3 plane = glm::normalize(glm::cross(corner(1) - corner(0), corner(3) - corner(0)));
      if (glm::dot(plane, sun) > 0.0) plane = -plane;
      for (std::size_t i = 0; i < drawn.position.size(); ++i) {
        if (drawn.position[i].w < 0.5f) {
          EXPECT_EQ(drawn.position[i], glm::vec4(0.0f));
          EXPECT_EQ(drawn.normal[i], glm::vec4(0.0f));
          EXPECT_EQ(drawn.flux[i], glm::vec4(0.0f));
          continue;
        }
        EXPECT_EQ(drawn.position[i].w, 1.0f);
        const glm::dvec3 normal(drawn.normal[i]);
        EXPECT_NEAR(glm::dot(glm::dvec3(drawn.position[i]) - corner(0), plane), 0.0, 1e-5);
        EXPECT_NEAR(glm::length(normal), 1.0, 2e-3);  // 16-bit floats
        EXPECT_GT(glm::dot(normal, plane), 0.998) << degrees;
        EXPECT_NEAR(drawn.normal[i].w, -glm::dot(plane, sun), 2e-3);
      }
    }
}

TEST_F(ReflectiveShadowMapGl, NearestSurfaceAlone) {
  // Two plates one over the other: the lower is in the shadow of the upper one and reflects nothing.
  SceneBuilder builder;
  const int bright = builder.material(glm::vec3(1.0f)), dark = builder.material(glm::vec3(0.25f));
  builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, bright);
  builder.plate({0, 1, 0}, {0, 0, 2}, {2, 0, 0}, dark);
  const Drawn drawn = draw(builder.scene(), 64);
  for (std::size_t i = 0; i < drawn.position.size(); ++i)
    EXPECT_NEAR(drawn.position[i].y, drawn.position[i].w, 1e-5);  // 1 on the upper plate, 0 beside it
  EXPECT_NEAR(drawn.totalFlux.x, 0.25 * 4.0, 0.25 * 4.0 * 0.03);
}

TEST_F(ReflectiveShadowMapGl, AMaskedPlateReflectsWhatItCovers) {
  // A mask with a solid stripe of two columns out of eight, and the same as the alpha of an albedo texture. The mask is
  // filtered and cut at a half, which for a stripe lies on the border of its texels.
  for (const bool ownFile : {true, false}) {
    SceneBuilder builder;
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) {
        const bool solid = x == 2 || x == 3;
        const std::uint8_t shade = ownFile && !solid ? 0 : 255;
        const std::uint8_t alpha = ownFile || solid ? 255 : 0;
        rgba.insert(rgba.end(), {shade, shade, shade, alpha});
      }
    const int picture = builder.texture(8, 8, rgba, !ownFile);
    const int material = builder.material(glm::vec3(0.5f));
    builder.materialAt(material).alphaMasked = true;
    (ownFile ? builder.materialAt(material).alphaTexture : builder.materialAt(material).diffuseTexture) = picture;
    builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, material);
    const Drawn drawn = draw(builder.scene(), 512);
    const double expected = 0.5 * 4.0 * 2.0 / 8.0;
    EXPECT_NEAR(drawn.totalFlux.x / expected, 1.0, 0.02) << ownFile;
  }
}

TEST_F(ReflectiveShadowMapGl, AlbedoTextureScalesTheFlux) {
  SceneBuilder builder;
  const int picture = builder.texture(1, 1, {188, 255, 0, 255});  // sRGB 188: linear 0.5029
  const int material = builder.material(glm::vec3(0.5f, 0.25f, 1.0f));
  builder.materialAt(material).diffuseTexture = picture;
  builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, material);
  const Drawn drawn = draw(builder.scene(), 128);
  const double area = drawn.totalFlux.y / 0.25;
  EXPECT_NEAR(area, 4.0, 0.1);
  EXPECT_NEAR(drawn.totalFlux.x / area, 0.5 * static_cast<double>(linearFromSrgb(188.0f / 255.0f)), 2e-3);
  EXPECT_EQ(drawn.totalFlux.z, 0.0);
}

TEST_F(ReflectiveShadowMapGl, AClampedPictureIsClampedInTheMapToo) {
  SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f)), repeated = builder.material(glm::vec3(0.5f)),
            picture = builder.texture(2, 1, {0, 0, 0, 255, 255, 255, 255, 255}),
            other = builder.texture(2, 1, {255, 0, 0, 255, 255, 0, 0, 255});
  builder.scene().textures[static_cast<std::size_t>(picture)].wraps.u = TextureWrap::edge;
  builder.materialAt(material).diffuseTexture = picture;
  builder.materialAt(repeated).diffuseTexture = other;
  builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, material);
  builder.plate({4, 0, 0}, {0, 0, 2}, {2, 0, 0}, repeated);
  for (std::size_t i = 0; i < 4; ++i) builder.scene().vertices[i].texCoord.x += 1.0f;  // beside the white texel
  const Drawn drawn = draw(builder.scene(), 128, {.anisotropy = 4.0f});
  EXPECT_NEAR(drawn.totalFlux.y, 0.5 * 4.0, 0.1);
  EXPECT_NEAR(drawn.totalFlux.x, 2.0 * 0.5 * 4.0, 0.2);
}

// A texel of the map is averaged with others, so anisotropic filters would be wasted on it. What is drawn later has
// them again.
TEST_F(ReflectiveShadowMapGl, ColoursAreReadIsotropically) {
  SceneBuilder builder;
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < 64 * 64; ++i) {
    const auto shade = static_cast<std::uint8_t>((i * 37 + i / 64 * 11) % 256);
    rgba.insert(rgba.end(), {shade, shade, shade, 255});
  }
  const int material = builder.material(glm::vec3(1.0f));
  builder.materialAt(material).diffuseTexture = builder.texture(64, 64, rgba);
  builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, material);
  Scene scene = builder.scene();
  scene.sun = DirectionalLight{glm::normalize(glm::dvec3(0.95, -0.3, 0.1)), glm::vec3(1.0f)};
  const Drawn four = draw(scene, 32, {.anisotropy = 4.0f}), one = draw(scene, 32, {.anisotropy = 1.0f});
  EXPECT_GT(four.covered, 100u);
  EXPECT_EQ(four.flux, one.flux);
  GLint sampler = -1;
  glActiveTexture(GL_TEXTURE0 + UNIT_DIFFUSE);
  glGetIntegerv(GL_SAMPLER_BINDING, &sampler);
  EXPECT_EQ(sampler, 0);
}

}  // namespace
}  // namespace lucerna
