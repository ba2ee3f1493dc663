// Many lamps (shaders/rays/light_hierarchy.glsl): draws against probabilities in double precision; pictures against
// closed forms, and against those of lamps drawn by power. Seeds are fixed; chi-square at significance 1e-4, means
// within 4 standard errors.
#include "gl/pass.hpp"
#include "shared/bindings.h"
#include "shared/path_tracer.h"
#include "support/light_hierarchies.hpp"
#include "support/path_scenes.hpp"
#include "support/rsm_reference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

namespace lucerna::test {
namespace {

class LightHierarchyGl : public PathTest {
 protected:
  /// For each position and normal: the light, its probability, its balance, its leaf's probability without the normal.
  std::vector<glm::uvec4> draw(const LightHierarchy& hierarchy, const std::vector<glm::vec4>& inputs) {
    const gl::Program& program =
        library().loadCompute("light hierarchy probe", "rays/light_hierarchy_probe.comp", {{"LINEAR_SEEDS", 0}});
    const gl::BufferTexture texels("hierarchy", gl::Format::rgba32ui, hierarchy.texels.size() * sizeof(glm::uvec4),
                                   hierarchy.texels.data());
    shared::PathConstants constants{};
    constants.lampPick = 1.0f;
    constants.lampPairs = hierarchy.pairs;
    const gl::Buffer block("constants", sizeof constants, &constants, gl::Usage::staticDraw);
    const gl::Buffer in("inputs", inputs.size() * sizeof(glm::vec4), inputs.data(), gl::Usage::staticDraw);
    const std::size_t count = inputs.size() / 2;
    const gl::Buffer out("outputs", count * sizeof(glm::uvec4), nullptr, gl::Usage::dynamicRead);
    block.bindUniform(0);
    texels.bind(UNIT_LIGHT_HIERARCHY);
    in.bindStorage(0);
    out.bindStorage(1);
    {
      const gl::ComputePass pass("probe");
      program.use();
      pass.dispatch({static_cast<int>(count), 1, 1}, {64, 1, 1});
    }
    return out.read<glm::uvec4>();
  }
  static double number(std::uint32_t word) { return double{std::bit_cast<float>(word)}; }
};

TEST_F(LightHierarchyGl, DrawsFollowTheReference) {
  constexpr std::size_t kDraws = 32768;
  for (const auto& [count, scale] : {std::pair(1u, 1.0), {2u, 1.0}, {3u, 1.0}, {50u, 1e-6}, {50u, 1e6}, {400u, 1.0}}) {
    std::vector<LocalLamp> lamps = mixedLamps(count);
    for (LocalLamp& lamp : lamps) lamp.min *= scale, lamp.max *= scale;
    const LightHierarchy hierarchy = lightHierarchy(lamps);
    std::map<std::uint32_t, std::size_t> leafOf;
    for (std::size_t leaf = 0; leaf < count; ++leaf) leafOf[hierarchy.lights[leaf]] = leaf;
    for (const auto& [place, normal] : {std::pair(glm::dvec3(3.0, 0.0, 4.0), glm::dvec3(0.0, 1.0, 0.0)),
                                        {{9.0, 1.5, 9.0}, {0.6, 0.0, -0.8}},
                                        {{9.0, 1.5, 9.0}, {0.0, 0.0, 0.0}},
                                        {{-50.0, 30.0, 0.0}, {0.0, -1.0, 0.0}}}) {
      const glm::dvec3 position = scale * place;
      std::vector<glm::vec4> inputs;
      for (std::size_t i = 0; i < kDraws; ++i) {
        inputs.emplace_back(position, 0.0);
        inputs.emplace_back(normal, 0.0);
      }
      const std::vector<double> expected = probabilities(hierarchy, position, normal),
                                alone = probabilities(hierarchy, position, glm::dvec3(0.0));
      std::vector<double> drawn(count);
      for (const glm::uvec4& pick : draw(hierarchy, inputs)) {
        ASSERT_TRUE(leafOf.contains(pick.x)) << pick.x;
        const std::size_t leaf = leafOf[pick.x];
        drawn[leaf] += 1.0;
        EXPECT_NEAR(number(pick.y) / expected[leaf], 1.0, 2e-3) << leaf;
        EXPECT_NEAR(number(pick.w) / alone[leaf], 1.0, 2e-3) << leaf;
        EXPECT_NEAR(number(pick.y) * number(pick.z) / number(pick.w), 1.0, 1e-4) << leaf;
        if (HasFailure()) return;
      }
      double square = 0.0, freedom = -1.0, few = 0.0, fewDrawn = 0.0;
      const auto add = [&](double wanted, double found) {
        square += (found - wanted) * (found - wanted) / wanted;
        freedom += 1.0;
      };
      for (std::size_t leaf = 0; leaf < count; ++leaf) {
        const double wanted = expected[leaf] * kDraws;
        if (wanted >= 10.0) add(wanted, drawn[leaf]);
        else few += wanted, fewDrawn += drawn[leaf];
      }
      if (few >= 10.0) add(few, fewDrawn);
      // Wilson and Hilferty's normal form of chi-square
      const double v = 2.0 / (9.0 * std::max(freedom, 1.0));
      EXPECT_LT((std::cbrt(square / std::max(freedom, 1.0)) - 1.0 + v) / std::sqrt(v), 3.72) << count;
    }
  }
}

/// A floor under a grid of panels, 16 by 16.
Scene underPanels() {
  SceneBuilder builder;
  builder.plate(glm::dvec3(0.0), {0.0, 0.0, 40.0}, {40.0, 0.0, 0.0}, builder.material(glm::vec3(0.5f)));
  const int light = builder.material(glm::vec3(0.0f));
  builder.materialAt(light).emission = glm::vec3(10.0f);
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j)
      builder.plate({2.0 * i - 15.0, 2.0, 2.0 * j - 15.0}, {0.2, 0.0, 0.0}, {0.0, 0.0, 0.2}, light);
  builder.scene().sun.reset();
  return builder.scene();
}

// Against the sum of the panels' form factors. By power alone the relative error is 8 times as large.
TEST_F(LightHierarchyGl, ManyPanelsLightAFloorAsTheirFormFactorsSay) {
  const Scene scene = underPanels();
  for (const glm::dvec2& at : {glm::dvec2(0.3, -0.7), glm::dvec2(14.0, 9.0), glm::dvec2(-19.0, 3.0)}) {
    Camera camera = lookingAt({at.x, 1.0, at.y}, {at.x, 0.0, at.y}, 0.01);
    camera.up = {0.0, 0.0, 1.0};
    double expected = 0.0;
    for (int i = 0; i < 16; ++i)
      for (int j = 0; j < 16; ++j) {
        std::vector<glm::dvec3> corners;
        for (const auto& [u, v] : {std::pair(-0.1, -0.1), {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}})
          corners.emplace_back(2.0 * i - 15.0 + u - at.x, 2.0, 2.0 * j - 15.0 + v - at.y);
        expected += 0.5 * 10.0 * std::abs(reference::polygonFormFactor(corners, {0, 1, 0}));
      }
    PathTracer::Settings settings = sized(16);
    settings.bounces = 1;
    const auto found = tracer(scene, camera, settings, 64).statistics();
    settings.fewestOfHierarchy = 0;
    const auto byPower = tracer(scene, camera, settings, 64).statistics();
    std::printf("[ measured ] %.5f of %.5f, relative error %.4f, by power %.4f\n", found.mean.x, expected,
                found.relativeError, byPower.relativeError);
    EXPECT_NEAR(found.mean.x, expected, 4.0 * found.meanError.x + 1e-4 * expected);
    EXPECT_LT(found.relativeError, 0.3 * byPower.relativeError);
  }
}

/// Lamps of every kind around a pillar on a floor, `places` of each, with the sun or a sky where wanted.
Scene ofAllKinds(bool sun, bool sky, int places = 6) {
  SceneBuilder builder;
  builder.plate(glm::dvec3(0.0), {0.0, 0.0, 12.0}, {12.0, 0.0, 0.0}, builder.material(glm::vec3(0.6f)));
  const int grey = builder.material(glm::vec3(0.5f)), light = builder.material(glm::vec3(0.0f));
  addBox(builder, 0.5, grey, false, {0.0, 0.5, 0.0});
  builder.materialAt(light).emission = glm::vec3(4.0f, 2.0f, 1.0f);
  Scene& scene = builder.scene();
  for (int i = 0; i < places; ++i) {
    const double turn = 2.0 * kPi * i / 6.0, c = std::cos(turn), s = std::sin(turn);
    builder.plate({2.0 * c, 1.0, 2.0 * s}, {0.3 * s, 0.0, -0.3 * c}, {0.0, 0.3, 0.0}, light);
    PointLight point;
    point.position = {3.0 * s, 0.8, 3.0 * c};
    point.intensity = glm::vec3(0.2f, 0.3f, 0.5f);
    point.radius = i % 2 == 0 ? 0.0 : 0.1;
    scene.points.push_back(point);
    SpotLight spot;
    spot.position = {1.5 * c, 2.0, 1.5 * s};
    spot.direction = glm::normalize(glm::dvec3(-c, -2.0, -s));
    spot.intensity = glm::vec3(1.0f);
    scene.spots.push_back(spot);
  }
  if (sun) builder.sun(glm::normalize(glm::dvec3(0.3, -1.0, 0.2)), glm::vec3(0.5f));
  else scene.sun.reset();
  if (sky) {
    scene.environment.emplace();
    scene.environment->radiance = glm::vec3(1.0f);
    scene.environment->picture.emplace(Image(8, 4));
    for (std::size_t i = 0; i < 32; ++i) scene.environment->picture->pixels[i] = glm::vec3(i == 5 ? 3.0f : 0.05f);
  }
  return scene;
}

TEST_F(LightHierarchyGl, TheMeanDoesNotDependOnHowLampsAreDrawn) {
  // A single place leaves the sky a fifth of the table.
  for (const auto& [sun, sky, places] :
       {std::tuple(false, false, 6), {true, false, 6}, {false, true, 1}, {true, true, 6}}) {
    const Scene scene = ofAllKinds(sun, sky, places);
    PathTracer::Settings settings = sized(24);
    const Camera camera = lookingAt({3.0, 2.5, 4.0}, {0.0, 0.3, 0.0});
    const auto found = tracer(scene, camera, settings, 512).statistics();
    settings.fewestOfHierarchy = 0;
    const auto byPower = tracer(scene, camera, settings, 512).statistics();
    std::printf("[ measured ] %.5f and %.5f, relative error %.4f, by power %.4f\n", found.mean.x, byPower.mean.x,
                found.relativeError, byPower.relativeError);
    EXPECT_LT(deviations(found, byPower), 4.0) << sun << sky;
    EXPECT_LT(found.relativeError, 1.05 * byPower.relativeError) << sun << sky;
  }
}

// Two lamps, as the triangles of a panel, are drawn by power; so are those of a published path tracer.
TEST_F(LightHierarchyGl, WhatASceneDoesNotNeedIsNotThere) {
  SceneBuilder builder;
  builder.plate(glm::dvec3(0.0), {0.0, 0.0, 2.0}, {2.0, 0.0, 0.0}, builder.material(glm::vec3(0.5f)));
  const int light = builder.material(glm::vec3(0.0f));
  builder.materialAt(light).emission = glm::vec3(1.0f);
  builder.plate({0.0, 1.0, 0.0}, {0.2, 0.0, 0.0}, {0.0, 0.0, 0.2}, light);
  const Camera camera = lookingAt({0.0, 0.5, 0.0}, {0.0, 0.0, 0.1});
  EXPECT_FALSE(tracer(builder.scene(), camera, 8, 1).scene().hasHierarchy());  // the sun is not of it
  builder.scene().points.emplace_back().position = {0.5, 0.5, 0.0};
  builder.scene().points.back().intensity = glm::vec3(1.0f);
  EXPECT_TRUE(tracer(builder.scene(), camera, 8, 1).scene().hasHierarchy());
  PathTracer::Settings published = sized(8);
  published.deviations.linearSeeds = true;
  EXPECT_FALSE(tracer(builder.scene(), camera, published, 1).scene().hasHierarchy());
}

// Programs stay as they were compiled when lamps go out and come back.
TEST_F(LightHierarchyGl, LampsOfASceneThatMovesGoOut) {
  Scene scene = ofAllKinds(true, false, 2);
  PathScene::Settings settings;
  settings.rays.moves = true;
  PathScene traced(scene, analyse(scene), context().capabilities(), settings);
  shared::PathConstants constants{};
  for (const unsigned lit : {8u, 1u, 0u, 8u}) {
    for (std::size_t i = 0; i < 2; ++i) {
      scene.materials.back().emission = glm::vec3(lit == 8u ? 1.0f : 0.0f);
      scene.spots[i].intensity = glm::vec3(lit == 8u ? 1.0f : 0.0f);
      scene.points[i].intensity = glm::vec3(i < lit ? 1.0f : 0.0f);
    }
    traced.update(scene, {});
    traced.fill(constants);
    EXPECT_TRUE(traced.hasHierarchy());
    EXPECT_EQ(traced.lightCount(), lit + 1);  // and the sun
    EXPECT_EQ(constants.lampPick > 0.0f, lit > 0u);
    EXPECT_TRUE(lit == 0u || constants.lampPairs == lit - 1) << lit;
  }
}

// Points are sampled along flights, triangles and spots from collisions.
TEST_F(LightHierarchyGl, LampsInAMediumBringTheSame) {
  Scene scene = ofAllKinds(false, false);
  scene.media.emplace_back();
  scene.media.back().scattering = glm::vec3(0.15f, 0.1f, 0.05f);
  scene.media.back().absorption = glm::vec3(0.02f);
  scene.media.back().anisotropy = glm::vec3(0.5f);
  scene.cameraMedium = 0;
  PathTracer::Settings settings = sized(16);
  const Camera camera = lookingAt({3.0, 2.5, 4.0}, {0.0, 0.3, 0.0});
  const auto found = tracer(scene, camera, settings, 256).statistics();
  settings.fewestOfHierarchy = 0;
  const auto byPower = tracer(scene, camera, settings, 256).statistics();
  std::printf("[ measured ] %.5f and %.5f, relative error %.4f, by power %.4f\n", found.mean.x, byPower.mean.x,
              found.relativeError, byPower.relativeError);
  EXPECT_LT(deviations(found, byPower), 4.0);
}

}  // namespace
}  // namespace lucerna::test
