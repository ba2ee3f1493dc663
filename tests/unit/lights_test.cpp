// Spot and omnidirectional lights in scene files and as views; the sun's cascades: splits and snapping. No GL.
#include "base/angles.hpp"
#include "base/log.hpp"
#include "forward/light_views.hpp"
#include "forward/sun_cascades.hpp"
#include "forward/sun_frustum.hpp"
#include "rays/light_table.hpp"
#include "scene/features.hpp"
#include "support/temp_folder.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::TempFolder;

Scene unitScene() {
  Scene scene;
  scene.bounds.add(glm::dvec3(-1.0));
  scene.bounds.add(glm::dvec3(1.0));
  return scene;
}

struct LightFolder : TempFolder {
  LightFolder() { write("box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"); }
  Scene load(const std::string& keys) const {
    return loadScene(write("room.json", "{\"model\": \"box.obj\"" + keys + "}"));
  }
};

TEST(SceneLights, TheDefaultExposureGoesWithTheDefaultSun) {
  const LightFolder folder;
  const std::string point = R"("points": [{"position": [0,1,0], "intensity": [1,1,1]}])";
  EXPECT_EQ(folder.load("").exposure, 0.4f);
  EXPECT_EQ(folder.load(", " + point).exposure, 1.0f);
  EXPECT_FALSE(folder.load(", " + point).sun.has_value());
  EXPECT_EQ(folder.load(", \"exposure\": 2, " + point).exposure, 2.0f);
  EXPECT_EQ(folder.load(", \"sun\": null, " + point).exposure, 1.0f);
}

TEST(LightViews, LargestSolidAngleBoundsTheTexelsSum) {
  const Scene scene = unitScene();
  std::vector<LightViews> all{lightViews(PointLight{}, scene)};
  for (const double degrees : {1.0, 20.0, 45.0, 70.0, 80.0}) {
    SpotLight spot;
    spot.outerAngle = degrees * kDegree;
    all.push_back(lightViews(spot, scene));
  }
  for (const LightViews& light : all)
    for (const int size : {1, 2, 3, 7, 64, 512}) {
      const double width = light.texelWidth(size);
      double sum = 0.0;
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          const glm::dvec2 p = (glm::dvec2(x, y) + 0.5) * width - light.tangent;
          sum += width * width * std::pow(1.0 + glm::dot(p, p), -1.5) * static_cast<double>(light.clipFromWorld.size());
        }
      const double bound = light.largestSolidAngle(size);
      EXPECT_GE(bound * (1.0 + 1e-12), sum) << light.tangent << ", " << size;
      if (size == 512) { EXPECT_LT(bound / sum, 1.01) << light.tangent; }
    }
  EXPECT_NEAR(all[0].largestSolidAngle(1024) / (4.0 * std::numbers::pi), 1.0, 1e-4);
}

TEST(SceneLights, EveryKeyIsRead) {
  const Scene scene = LightFolder().load(
      R"(, "spots": [{"position": [1,2,3], "direction": [0,-2,0], "intensity": [4,5,6], "innerAngle": 10,
      "outerAngle": 80},
                     {"position": [1,2,3], "target": [1,2,0], "intensity": [1,1,1], "innerAngle": 30,
                     "outerAngle": 30}],
          "points": [{"position": [7,8,9], "intensity": [1,0.5,0]}])");
  ASSERT_EQ(scene.spots.size(), 2u);
  EXPECT_EQ(scene.spots[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(scene.spots[0].direction, glm::dvec3(0, -1, 0));
  EXPECT_EQ(scene.spots[0].intensity, glm::vec3(4, 5, 6));
  EXPECT_NEAR(scene.spots[0].innerAngle, 10 * kDegree, 1e-12);
  EXPECT_NEAR(scene.spots[0].outerAngle, 80 * kDegree, 1e-12);
  EXPECT_EQ(scene.spots[1].direction, glm::dvec3(0, 0, -1));
  EXPECT_EQ(scene.spots[1].innerAngle, scene.spots[1].outerAngle);
  ASSERT_EQ(scene.points.size(), 1u);
  EXPECT_EQ(scene.points[0].position, glm::dvec3(7, 8, 9));
  EXPECT_EQ(scene.points[0].intensity, glm::vec3(1.0f, 0.5f, 0.0f));
}

TEST(SceneLights, LampsReplaceTheDefaultSunButNoOther) {
  const LightFolder folder;
  const std::string points = R"(, "points": [{"position": [7,8,9], "intensity": [1,1,1]}])";
  EXPECT_TRUE(folder.load("").sun && folder.load("").defaultSun);
  EXPECT_FALSE(folder.load(points).sun);
  EXPECT_FALSE(folder.load(R"(, "spots": [])").sun);
  const Scene both = folder.load(points + R"(, "sun": {"direction": [0,-1,0], "irradiance": [1,1,1]})");
  EXPECT_TRUE(both.sun);
  EXPECT_FALSE(both.defaultSun);
}

TEST(SceneLights, AFileThatItsEmissionLightsHasNoDefaultSun) {
  const TempFolder folder;
  folder.write("m.mtl",
               "newmtl white\nKd 0.7 0.7 0.7\nnewmtl paper\nKd 0.7 0.7 0.7\nKe 1 1 1\nnewmtl lamp\nKe 600 600 600\n");
  const auto hasSun = [&](const std::string& faces) {
    std::string obj = "mtllib m.mtl\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 4 -2\nv 2 4 -2\nv 2 4 2\nv -2 4 2\n";
    for (const double y : {3.9, 4.1})  // 4 cm wide, below the lid of the room and above it
      for (const auto& [x, z] : {std::pair(-0.02, -0.02), std::pair(0.02, -0.02), std::pair(0.02, 0.02)})
        obj += fmt::format("v {} {} {}\n", x, y, z);
    return loadScene(folder.write("m.obj", obj + faces)).sun.has_value();
  };
  const std::string room = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  EXPECT_TRUE(hasSun("usemtl white\n" + room));
  EXPECT_FALSE(hasSun("usemtl white\n" + room + "usemtl lamp\nf 9 10 11\n"));  // a small lamp in a room
  EXPECT_TRUE(hasSun("usemtl white\n" + room + "usemtl paper\nf 9 10 11\n"));  // as dim as a pilot lamp
  EXPECT_TRUE(hasSun("usemtl white\nf 5 8 7 6\nusemtl lamp\nf 14 13 12\n"));  // on top of a lid: meets nothing
  EXPECT_FALSE(hasSun("usemtl paper\nf 5 8 7 6\n"));  // nothing but emission
}

TEST(SceneLights, TheBrightestLightThatIsAllowedIsRead) {
  const Scene scene = LightFolder().load(R"(, "sun": {"direction": [0,-1,0], "irradiance": [1e30, 0, 0]})");
  EXPECT_EQ(scene.sun->irradiance.x, 1e30f);
}

TEST(SceneLights, ASceneMayHaveAnyNumberOfLamps) {
  const LightFolder folder;
  std::string spots, points;
  for (int i = 0; i < 70; ++i) {
    spots +=
        std::string(i > 0 ? "," : "") +
        R"({"position": [0,0,0], "direction": [0,-1,0], "intensity": [1,1,1], "innerAngle": 10, "outerAngle": 20})";
    points += std::string(i > 0 ? "," : "") + R"({"position": [0,0,0], "intensity": [1,1,1]})";
  }
  const Scene scene = folder.load(R"(, "spots": [)" + spots + R"(], "points": [)" + points + "]");
  EXPECT_EQ(scene.spots.size(), 70u);
  EXPECT_EQ(scene.points.size(), 70u);
}

TEST(SceneLights, WhatIsWrongIsNamedByKey) {
  const LightFolder folder;
  const std::string spot = R"(, "spots": [{"position": [0,0,0], "direction": [0,-1,0], "intensity": [1,1,1], )";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"(, "points": {})", "\"points\""},
      {R"(, "points": [{"position": [0,0,0]}])", "\"points[0]\""},
      {R"(, "points": [{"position": [0,0], "intensity": [1,1,1]}])", "\"points[0].position\""},
      {R"(, "points": [{"position": [0,0,0], "intensity": [1,-1,1]}])", "\"points[0].intensity\""},
      {R"(, "points": [{"position": [0,0,0], "intensity": [1,1,1], "range": 3}])", "\"points[0].range\""},
      {spot + R"("innerAngle": 10}])", "\"outerAngle\""},
      {spot + R"("innerAngle": 10, "outerAngle": 81}])", "\"spots[0].outerAngle\""},
      {spot + R"("innerAngle": 0, "outerAngle": 0}])", "\"spots[0].outerAngle\""},
      {spot + R"("innerAngle": 41, "outerAngle": 40}])", "\"spots[0].innerAngle\""},
      {spot + R"("innerAngle": -1, "outerAngle": 40}])", "\"spots[0].innerAngle\""},
      {spot + R"("innerAngle": 1, "outerAngle": 40, "target": [1,1,1]}])", "\"target\" or \"direction\""},
      {R"(, "spots": [{"position": [0,0,0], "target": [0,0,0], "intensity": [1,1,1], "innerAngle": 1,
      "outerAngle": 40}])",
       "\"target\" is not"},
  };
  for (const auto& [keys, expected] : cases) {
    const std::string message = badInputMessage([&, &text = keys] { folder.load(text); });
    EXPECT_NE(message.find(expected), std::string::npos) << keys << "\n" << message;
    EXPECT_NE(message.find("room.json"), std::string::npos) << message;
  }
}

TEST(SceneLights, GltfLampsAreRead) {
  const TempFolder folder;
  const auto file = folder.write("lamps.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],
    "nodes":[{"mesh":0},{"name":"a","translation":[1,2,3],"extensions":{"KHR_lights_punctual":{"light":0}}},
             {"name":"b","translation":[4,5,6],"rotation":[-0.70710678,0,0,0.70710678],
             "extensions":{"KHR_lights_punctual":{"light":1}}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,
    "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "extensionsUsed":["KHR_lights_punctual"],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","color":[1,0.5,0.25],"intensity":4},
      {"type":"spot","color":[1,1,1],"intensity":2,"spot":{"innerConeAngle":0.2,"outerConeAngle":0.5}}]}}})");
  const Scene scene = loadScene(file);
  EXPECT_FALSE(scene.sun);
  ASSERT_EQ(scene.points.size(), 1u);
  EXPECT_LT(glm::distance(scene.points[0].position, glm::dvec3(1, 2, 3)), 1e-6);
  EXPECT_LT(glm::distance(scene.points[0].intensity, glm::vec3(4, 2, 1)), 1e-6f);
  ASSERT_EQ(scene.spots.size(), 1u);
  EXPECT_LT(glm::distance(scene.spots[0].position, glm::dvec3(4, 5, 6)), 1e-6);
  EXPECT_LT(glm::distance(scene.spots[0].direction, glm::dvec3(0, -1, 0)), 1e-6);
  EXPECT_LT(glm::distance(scene.spots[0].intensity, glm::vec3(2)), 1e-6f);
  EXPECT_NEAR(scene.spots[0].innerAngle, 0.2, 1e-6);
  EXPECT_NEAR(scene.spots[0].outerAngle, 0.5, 1e-6);
}

// A lamp 4 units from a triangle about the origin, in W/sr: what it gives there is intensity / 16.
TEST(SceneLights, LampsOfModelsThatAreFarTooWeakOrStrongChooseTheExposure) {
  const TempFolder folder;
  const auto exposure = [&](double intensity) {
    clearLoggedWarnings();
    return loadScene(folder.write("a.gltf",
                                  fmt::format(R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,1]}}],
    "nodes":[{{"mesh":0,"translation":[-0.5,-0.5,0]}},{{"name":"a","translation":[0,0,4],
    "extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
    "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
    "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
    "bufferViews":[{{"buffer":0,"byteLength":36}}],
    "buffers":[{{"byteLength":36,
    "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],
    "extensionsUsed":["KHR_lights_punctual"],
    "extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"point","intensity":{}}}]}}}}}})",
                                              intensity)))
        .exposure;
  };
  EXPECT_EQ(exposure(16.0), 1.0f);
  EXPECT_TRUE(loggedWarnings().empty());
  EXPECT_NEAR(exposure(0.16), 300.0f, 1.0f);
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_NE(loggedWarnings()[0].find("black at exposure 1"), std::string::npos);
  EXPECT_NEAR(exposure(16000.0), 0.003f, 1e-5f);
  EXPECT_NE(loggedWarnings().at(0).find("white"), std::string::npos);
  EXPECT_EQ(exposure(0.0), 0.4f);  // no lamp: the default sun's
}

TEST(SceneLights, NeedsAreRaisedByLampsThatShine) {
  Scene scene;
  scene.materials.resize(1);
  Mesh mesh;
  mesh.indexCount = 3;
  scene.meshes.push_back(mesh);
  scene.spots = {SpotLight{}};
  scene.points = {PointLight{}};
  EXPECT_EQ(analyse(scene), SceneFeatures{});  // intensity 0
  scene.spots[0].intensity.y = 1.0f;
  EXPECT_TRUE(analyse(scene).spotLights && !analyse(scene).pointLights && analyse(scene).indirect);
  scene.points[0].intensity.z = 1.0f;
  scene.spots.clear();
  EXPECT_TRUE(!analyse(scene).spotLights && analyse(scene).pointLights && analyse(scene).indirect);
}

TEST(LightViewsTest, SixFacesSeeTheSphereOnceInCubeMapOrder) {
  const LightViews views = lightViews(PointLight{glm::dvec3(0.3, -0.2, 0.1), glm::vec3(1.0f)}, unitScene());
  ASSERT_EQ(views.clipFromWorld.size(), 6u);
  for (int i = 0; i < 500; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / 500.0, angle = 2.399963 * i;
    const glm::dvec3 d(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(d[k]) > std::abs(d[axis])) axis = k;
    const int expected = 2 * axis + (d[axis] < 0.0 ? 1 : 0);
    for (int face = 0; face < 6; ++face) {
      const glm::dvec4 clip = views.clipFromWorld[static_cast<std::size_t>(face)] * glm::dvec4(views.position + d, 1.0);
      const bool inside = clip.w > 0.0 && std::abs(clip.x) < clip.w && std::abs(clip.y) < clip.w;
      EXPECT_EQ(inside, face == expected) << i << " face " << face;
    }
  }
}

TEST(LightViewsTest, TypicalIrradianceIsTheLargestAndNeverZero) {
  Scene scene;
  EXPECT_EQ(typicalIrradiance(scene), 1.0f);
  scene.bounds = unitScene().bounds;
  const double r2 = 12.0 / 16.0;  // (diagonal / 4)^2
  scene.points = {PointLight{{}, glm::vec3(0.0f, 3.0f, 1.0f)}};
  EXPECT_NEAR(typicalIrradiance(scene), 3.0 / r2, 1e-6);
  scene.sun = DirectionalLight{{0, -1, 0}, glm::vec3(1.0f, 2.0f, 40.0f)};
  EXPECT_EQ(typicalIrradiance(scene), 40.0f);
  scene.sun.reset();
  scene.points[0].intensity = glm::vec3(0.0f);
  EXPECT_EQ(typicalIrradiance(scene), 1.0f);
}

TEST(SunCascades, SplitsFollowThePracticalScheme) {
  const auto uniform = splitDistances(1.0, 101.0, 4, 0.0), logarithmic = splitDistances(1.0, 10000.0, 4, 1.0);
  for (int i = 0; i <= 4; ++i) {
    EXPECT_NEAR(uniform[static_cast<std::size_t>(i)], 1.0 + 25.0 * i, 1e-12);
    EXPECT_NEAR(logarithmic[static_cast<std::size_t>(i)], std::pow(10.0, i), 1e-9);
  }
  const auto half = splitDistances(1.0, 100.0, 2, 0.5);
  EXPECT_NEAR(half[1], 0.5 * (10.0 + 50.5), 1e-12);
  EXPECT_EQ(half.size(), 3u);
}

Scene largeScene() {
  Scene scene;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 p(i & 1 ? 100.0f : -100.0f, i & 2 ? 20.0f : 0.0f, i & 4 ? 100.0f : -100.0f);
    scene.vertices.push_back({p, {}, {}});
    scene.bounds.add(glm::dvec3(p));
  }
  scene.sun = DirectionalLight{glm::normalize(glm::dvec3(0.3, -1.0, 0.2)), glm::vec3(1.0f)};
  return scene;
}

Camera cameraAt(const glm::dvec3& position, double turn) {
  Camera camera;
  camera.position = position;
  camera.direction = {std::sin(turn), 0.0, -std::cos(turn)};
  return camera;
}

TEST(SunCascades, EachHoldsItsSliceAndTheWholeScenesDepth) {
  const Scene scene = largeScene();
  const SunFrustum whole = fitSunFrustum(scene, scene.sun->direction);
  const double near = 0.1, aspect = 1.6;
  for (const double turn : {0.0, 0.4, 2.0, 4.5}) {
    const Camera camera = cameraAt({5.0, 2.0, -7.0}, turn);
    const auto cascades = placeSunCascades({3, 0.75}, scene, scene.sun->direction, whole, camera, aspect, near, 1024);
    ASSERT_EQ(cascades.size(), 3u);
    const double far = glm::length(scene.bounds.extent());
    const auto splits = splitDistances(near, far, 3, 0.75);
    for (std::size_t i = 0; i < 3; ++i) {
      if (cascades[i].clipFromWorld == whole.clipFromWorld) continue;
      const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up));
      const double t = std::tan(0.5 * camera.verticalFov);
      for (int corner = 0; corner < 8; ++corner) {
        const double d = splits[i + (corner & 1 ? 1u : 0u)];
        const glm::dvec3 p = camera.position + d * (camera.direction + (corner & 2 ? t : -t) * camera.up +
                                                    (corner & 4 ? t : -t) * aspect * right);
        const glm::dvec4 clip = cascades[i].clipFromWorld * glm::dvec4(p, 1.0);
        EXPECT_LE(std::max(std::abs(clip.x), std::abs(clip.y)), 1.0) << "cascade " << i;
      }
      for (const Vertex& v : scene.vertices)
        EXPECT_LE(std::abs((cascades[i].clipFromWorld * glm::dvec4(glm::dvec3(v.position), 1.0)).z), 1.0);
    }
    EXPECT_LT(cascades[0].texel, 0.3 * cascades[2].texel);
  }
}

// A world point's place within its texel must not depend on the camera, and the texel's size neither.
TEST(SunCascades, TexelsStayWhileTheCameraMovesAndTurns) {
  const Scene scene = largeScene();
  const SunFrustum whole = fitSunFrustum(scene, scene.sun->direction);
  const auto place = [&](const glm::dvec3& p, double turn) {
    return placeSunCascades({3, 0.75}, scene, scene.sun->direction, whole, cameraAt(p, turn), 1.6, 0.1, 1024);
  };
  const auto first = place({5.0, 2.0, -7.0}, 0.3);
  const glm::dvec4 probe(4.321, 0.0, -9.87, 1.0);
  for (int step = 0; step < 200; ++step) {
    const auto now = place({5.0 + 0.0137 * step, 2.0, -7.0 + 0.0071 * step}, 0.3 + 0.01 * step);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(now[i].texel, first[i].texel);
      const glm::dvec4 a = first[i].clipFromWorld * probe, b = now[i].clipFromWorld * probe;
      for (int axis = 0; axis < 2; ++axis) {
        const double moved = 512.0 * (b[axis] - a[axis]);  // texels
        EXPECT_NEAR(moved, std::round(moved), 1e-6) << "cascade " << i << " step " << step;
      }
      EXPECT_EQ(a.z, b.z);
    }
  }
}

// What each entry comes up with by threshold and alias is the probability that was asked for [Vose1991].
TEST(AliasTables, DrawWhatWasAskedFor) {
  for (const std::vector<double>& weights : {std::vector<double>{1, 2, 3, 4, 0, 7.5, 1e-6}, std::vector<double>{5},
                                             std::vector<double>{0, 0, 3}, std::vector<double>{1e-3, 1e3, 1, 1, 1}}) {
    const AliasTable table = aliasTable(weights);
    const double n = static_cast<double>(weights.size());
    double sum = 0.0;
    for (const double w : weights) sum += w;
    std::vector<double> drawn(weights.size(), 0.0);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double kept = std::clamp(static_cast<double>(table.threshold[i]), 0.0, 1.0);
      drawn[i] += kept / n;
      drawn[table.alias[i]] += (1.0 - kept) / n;
    }
    for (std::size_t i = 0; i < weights.size(); ++i) {
      EXPECT_NEAR(drawn[i], weights[i] / sum, 1e-7) << i << " of " << weights.size();
      EXPECT_NEAR(table.probability[i], weights[i] / sum, 1e-12) << i;
    }
  }
}

// Width and height are the sides of what the matrix maps to -1..1, and every vertex lies inside.
TEST(SunFrustum, HoldsTheSceneAndSaysItsSides) {
  Scene scene;
  for (const glm::vec3& p : {glm::vec3(-5, 0, -1), glm::vec3(5, 0, -1), glm::vec3(5, 2, 1), glm::vec3(-5, 1, 1)}) {
    scene.vertices.push_back({p, {}, {}});
    scene.bounds.add(glm::dvec3(p));
  }
  for (const glm::dvec3& direction :
       {glm::dvec3(0, -1, 0), glm::normalize(glm::dvec3(0.3, -1, 0.2)), glm::normalize(glm::dvec3(0.1, -0.2, -1))}) {
    const SunFrustum frustum = fitSunFrustum(scene, direction);
    const glm::dmat4 rows = glm::transpose(glm::dmat4(frustum.clipFromWorld));
    EXPECT_NEAR(2.0 / glm::length(glm::dvec3(rows[0])), frustum.width, 1e-5 * frustum.width);
    EXPECT_NEAR(2.0 / glm::length(glm::dvec3(rows[1])), frustum.height, 1e-5 * frustum.height);
    EXPECT_GT(std::abs(frustum.width - frustum.height), 1.0);
    for (const Vertex& vertex : scene.vertices) {
      const glm::dvec4 clip = glm::dmat4(frustum.clipFromWorld) * glm::dvec4(glm::dvec3(vertex.position), 1.0);
      for (int axis = 0; axis < 3; ++axis) EXPECT_LT(std::abs(clip[axis]), 1.0);
    }
  }
}

}  // namespace
}  // namespace lucerna
