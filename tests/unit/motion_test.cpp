// Scenes that move: curves, the JSON's and glTF's, by known answers; and that a pose depends on its time alone.
#include "scene/motion.hpp"

#include "base/angles.hpp"
#include "base/log.hpp"
#include "scene/clear_sky.hpp"
#include "scene/curve.hpp"
#include "scene/scene_file.hpp"
#include "support/contains.hpp"
#include "support/gltf_file.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::expectCorners;
using test::Gltf;
using test::TempFolder;
using Numbers = std::vector<double>;

// ------------------------------------------------------------------------------------------------ curves

double at(const Curve& curve, double seconds) {
  double value = 0.0;
  curve.at(seconds, {&value, 1});
  return value;
}

TEST(Curve, HoldsItsEndsAndStepsOrRisesBetweenKeys) {
  Curve curve{.times = {1, 2, 4}, .values = {10, 20, 0}};
  for (const auto& [t, v] : {std::pair{-1e9, 10.0}, {1.0, 10.0}, {1.5, 15.0}, {2.0, 20.0}, {3.0, 10.0}, {1e9, 0.0}})
    EXPECT_DOUBLE_EQ(at(curve, t), v) << t;
  curve.interpolation = Curve::Interpolation::step;
  for (const auto& [t, v] : {std::pair{0.0, 10.0}, {1.999, 10.0}, {2.0, 20.0}, {3.9, 20.0}, {4.0, 0.0}})
    EXPECT_EQ(at(curve, t), v) << t;
  EXPECT_EQ(at(Curve{.times = {3}, .values = {7}}, 0.0), 7.0);
}

TEST(Curve, StartsAgainWhereItLoops) {
  const Curve curve{.loops = true, .times = {1, 3}, .values = {0, 8}};
  for (const auto& [t, v] : {std::pair{1.0, 0.0}, {2.5, 6.0}, {3.0, 0.0}, {4.5, 6.0}, {0.5, 6.0}, {-1.5, 6.0}})
    EXPECT_DOUBLE_EQ(at(curve, t), v) << t;
  EXPECT_NEAR(at(curve, 1e9 + 1.5), 2.0, 1e-6);  // 1e9 + 1.5 - 1 = 5e8 loops and 0.5 s
}

TEST(Curve, CubicsMeetTheirKeysAndStayBetweenThem) {
  const Curve curve{
      .interpolation = Curve::Interpolation::cubic, .times = {0, 1, 2, 5, 6}, .values = {0, 0, 9, 10, -3}};
  for (std::size_t i = 0; i < curve.times.size(); ++i) EXPECT_DOUBLE_EQ(at(curve, curve.times[i]), curve.values[i]);
  double before = at(curve, 0.0);
  for (double t = 0.01; t < 5.0; t += 0.01) {
    EXPECT_GE(at(curve, t), before - 1e-12) << t;
    before = at(curve, t);
  }
  for (double t = 5.0; t < 6.0; t += 0.01) EXPECT_LE(at(curve, t), 10.0);
  // a line stays one
  const Curve line{.interpolation = Curve::Interpolation::cubic, .times = {0, 1, 3, 7}, .values = {1, 3, 7, 15}};
  for (double t = 1.0; t <= 3.0; t += 0.1) EXPECT_NEAR(at(line, t), 1.0 + 2.0 * t, 1e-12);
}

// glTF 2.0, appendix C: p(t) = (2t^3 - 3t^2 + 1) v0 + (t^3 - 2t^2 + t) d b0 + (3t^2 - 2t^3) v1 + (t^3 - t^2) d a1.
TEST(Curve, TangentsAreThoseOfGltf) {
  const Curve curve{.interpolation = Curve::Interpolation::tangents, .times = {0, 2}, .values = {9, 1, 3, -1, 5, 9}};
  for (double u = 0.0; u < 1.0; u += 0.125) {
    const double u2 = u * u, u3 = u2 * u;
    EXPECT_NEAR(at(curve, 2.0 * u),
                (2 * u3 - 3 * u2 + 1) * 1 + (u3 - 2 * u2 + u) * 2 * 3 + (3 * u2 - 2 * u3) * 5 + (u3 - u2) * 2 * -1,
                1e-12);
  }
}

TEST(Curve, RotationsTakeTheShortWayAtOneSpeed) {
  const double half = std::sqrt(0.5);
  Curve curve{.isRotation = true, .width = 4, .times = {0, 1}, .values = {0, 0, 0, 1, 0, 0, -half, -half}};
  for (const double u : {0.25, 0.5, 0.9}) {
    Numbers q(4);
    curve.at(u, q);
    EXPECT_NEAR(q[2], std::sin(u * 0.25 * kPi), 1e-12);
    EXPECT_NEAR(q[3], std::cos(u * 0.25 * kPi), 1e-12);
  }
}

// ------------------------------------------------------------------------------------------------ scenes' JSON

const char* const kModel =
    "o left\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n"
    "o right\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 4//1 5//1 6//1\n";

class MovingScene : public testing::Test {
 protected:
  Scene load(const std::string& keys) {
    folder_.write("m.obj", kModel);
    clearLoggedWarnings();
    return loadScene(folder_.write("s.json", "{\"model\": \"m.obj\"," + keys + "}"));
  }
  std::string refusal(const std::string& keys) {
    return badInputMessage([&] { load(keys); });
  }
  TempFolder folder_;
};

TEST_F(MovingScene, ObjectsAreMovedTurnedAndScaled) {
  Scene scene = load(R"("objects": {"right": {
      "translation": {"times": [0, 10], "values": [[0, 0, 0], [0, 0, 20]]},
      "turn": {"axis": [0, 0, 1], "degrees": {"times": [0, 10], "values": [0, 180]}},
      "scale": {"times": [0, 10], "values": [1, 3]}, "pivot": [5, 0, 0]}})");
  const std::vector<glm::vec3> left = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto with = [&](std::vector<glm::vec3> right) {
    right.insert(right.begin(), left.begin(), left.end());
    return right;
  };
  expectCorners(scene, with({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}));
  const SceneChange change = poseAt(scene, 5.0);
  expectCorners(scene, with({{5, 0, 10}, {5, 2, 10}, {3, 0, 10}}), 1e-5f);
  EXPECT_EQ(change.meshes, std::vector<std::size_t>{1});
  EXPECT_FALSE(change.anyLight() || change.materials || change.media || change.views);
  EXPECT_EQ(scene.meshes[1].bounds.max.z, 10.0);
  EXPECT_NEAR(scene.bounds.max.z, 20.0, 1e-5);  // of the whole motion
  EXPECT_TRUE(poseAt(scene, 10.0).any());
  EXPECT_FALSE(poseAt(scene, 11.0).any());
  // Whatever the order of poses.
  Scene again =
      load(R"("objects": {"right": {"translation": {"times": [0, 1], "values": [[0, 0, 0], [0.1, 0.7, 0.3]]}}})");
  poseAt(again, 0.3);
  const std::vector<Vertex> first = again.vertices;
  for (const double t : {0.9, -4.0, 1e9, 0.0}) poseAt(again, t);
  poseAt(again, 0.3);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].position, again.vertices[i].position);
}

TEST_F(MovingScene, AScaleThroughZeroKeepsNumbersFiniteAndFrontsInFront) {
  Scene scene = load(R"("objects": {"right": {"scale": {"times": [0, 2], "values": [[1, 1, 1], [-1, 1, 1]]},
                                              "pivot": [5, 0, 0]}})");
  poseAt(scene, 1.0);
  expectCorners(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {5, 0, 0}, {5, 1, 0}});
  for (const Vertex& vertex : scene.vertices) EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
  poseAt(scene, 2.0);
  const std::vector<glm::vec3> p = test::corners(scene);
  EXPECT_GT(glm::cross(p[4] - p[3], p[5] - p[3]).z, 0.0f);
  for (const Vertex& vertex : scene.vertices) EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
}

TEST_F(MovingScene, ObjectsThatStandStillArePlacedAtOnce) {
  const Scene scene = load(R"("objects": {"left": {"translation": [0, 0, 4]}})");
  EXPECT_EQ(scene.meshes[0].bounds.max.z, 4.0);
  EXPECT_EQ(scene.motion, nullptr);
}

TEST_F(MovingScene, LampsEmissionAndViewsFollowTheirCurves) {
  Scene scene =
      load(R"("spots": [{"position": [0, 1, 0], "direction": {"times": [0, 1], "values": [[0, -1, 0], [1, 0, 0]]},
        "intensity": {"times": [0, 1], "values": [[1, 2, 3], [3, 2, 1]]}, "innerAngle": 10,
        "outerAngle": {"times": [0, 1], "values": [20, 40]}}],
      "points": [{"position": {"times": [0, 1], "values": [[0, 0, 0], [2, 4, 6]]}, "intensity": [1, 1, 1]}],
      "camera": {"position": {"times": [0, 1], "values": [[0, 0, 4], [0, 0, 8]]}, "target": [0, 0, 0], "fov": 40},
      "exposure": {"times": [0, 1], "values": [1, 2]}, "background": [0, 0, 0])");
  const SceneChange change = poseAt(scene, 0.5);
  EXPECT_TRUE(change.lamps && change.views);
  EXPECT_FALSE(change.sun || change.materials || change.environment || !change.meshes.empty());
  EXPECT_LT(glm::distance(scene.spots[0].direction, glm::normalize(glm::dvec3(1, -1, 0))), 1e-12);
  EXPECT_EQ(scene.spots[0].intensity, glm::vec3(2, 2, 2));
  EXPECT_NEAR(scene.spots[0].outerAngle, 30.0 * kDegree, 1e-12);
  EXPECT_EQ(scene.points[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(scene.cameras[0].position, glm::dvec3(0, 0, 6));
  EXPECT_EQ(scene.exposure, 1.5f);
  EXPECT_EQ(scene.motion->end, 1.0);
}

// The keys of one name carry its mesh and its lamps alike, from where curves have placed them.
TEST_F(MovingScene, KeyFramesCarryMeshesAndLampsByName) {
  folder_.write("keys.txt", "move right t 1 p 0 0 0\nmove right t 3 p 0 4 8\n");
  const std::string things =
      R"("keyFrames": "keys.txt", "points": [{"position": [1, 1, 1], "intensity": [1, 1, 1], "name": "left"},
      {"position": [5, 0, 1], "intensity": [1, 1, 1], "name": "right"}],
      "spots": [{"name": "right", "position": {"times": [0, 4], "values": [[0, 0, 0], [4, 0, 0]]},
      "direction": [0, -1, 0], "intensity": [1, 1, 1], "innerAngle": 10, "outerAngle": 20}])";
  Scene scene = load(things);
  EXPECT_TRUE(scene.keyFrames.empty());  // no path of the camera
  EXPECT_EQ(scene.motion->end, 4.0);
  EXPECT_NEAR(scene.bounds.max.z, 8.0, 1e-5);
  const std::vector<glm::vec3> atRest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
  expectCorners(scene, atRest);
  for (const double t : {3.5, 2.0}) {
    const SceneChange change = poseAt(scene, t);
    EXPECT_EQ(change.meshes, std::vector<std::size_t>{1});
    EXPECT_TRUE(change.lamps);
  }
  // A cubic through two keys is halfway between them halfway.
  expectCorners(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 2, 4}, {6, 2, 4}, {5, 3, 4}}, 1e-5f);
  EXPECT_EQ(scene.points[0].position, glm::dvec3(1, 1, 1));
  EXPECT_LT(glm::distance(scene.points[1].position, glm::dvec3(5, 2, 5)), 1e-12);
  EXPECT_LT(glm::distance(scene.spots[0].position, glm::dvec3(2, 2, 4)), 1e-12);
  // Other keys of that name, given later, are instead of these; keys of the camera alone leave them.
  setKeyFrames(scene, folder_.write("other.txt", "move right t 0 p 0 -1 0\n"), false);
  setKeyFrames(scene, folder_.write("path.txt", "p 0 0 9 d 0 0 -1 u 0 1 0\np 1 0 9 d 0 0 -1 u 0 1 0\n"), false);
  finishMotion(scene);
  expectCorners(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, -1, 0}, {6, -1, 0}, {5, 0, 0}}, 1e-5f);
  EXPECT_EQ(scene.points[1].position, glm::dvec3(5, -1, 1));
  poseAt(scene, 2.0);
  EXPECT_LT(glm::distance(scene.spots[0].position, glm::dvec3(2, -1, 0)), 1e-12);
  EXPECT_EQ(scene.keyFrames, folder_ / "path.txt");
  EXPECT_NE(scene.cameras.front().position, glm::dvec3(0, 0, 9));
  // A scene without a motion gets one. An object that stands still is carried from where it has been placed.
  Scene still = load(R"("objects": {"right": {"translation": [0, 0, 4]}})");
  setKeyFrames(still, folder_ / "other.txt", false);
  finishMotion(still);
  expectCorners(still, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, -1, 4}, {6, -1, 4}, {5, 0, 4}}, 1e-5f);
  Scene both = load(R"("objects": {"right": {"translation": [0, 0, 4]},
      "left": {"translation": {"times": [0, 1], "values": [[0, 0, 0], [0, 0, 1]]}}})");
  setKeyFrames(both, folder_ / "other.txt", false);
  finishMotion(both);
  poseAt(both, 1.0);
  expectCorners(both, {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {5, -1, 4}, {6, -1, 4}, {5, 0, 4}}, 1e-5f);
}

TEST_F(MovingScene, KeyFramesOfNothingAreNamedByFileAndLine) {
  folder_.write("keys.txt", "# lamps\nmove lantern t 0 p 0 0 0\n");
  const std::string message = refusal(R"("keyFrames": "keys.txt")");
  EXPECT_TRUE(contains(message, "keys.txt:2: ")) << message;
  EXPECT_TRUE(contains(message, "named 'lantern'; there are 'left', 'right'")) << message;
}

TEST_F(MovingScene, ASunByPlaceAndHourStandsWhereItShould) {
  // At an equinox (day 81) the sun's declination is 0: at noon it stands 90 degrees less the latitude high in the
  // south, at 6 and 18 o'clock on the horizon in the east and west.
  Scene scene = load(R"("sun": {"latitude": 50, "day": 81, "irradiance": [1000, 1000, 1000],
      "hour": {"times": [0, 24], "values": [0, 24]}}, "environment": {"sky": {}})");
  const auto toSun = [&](double hour) {
    poseAt(scene, hour);
    return -scene.sun->direction;
  };
  EXPECT_LT(glm::distance(toSun(12), glm::dvec3(0, std::cos(50 * kDegree), std::sin(50 * kDegree))), 1e-12);
  EXPECT_LT(glm::distance(toSun(6), glm::dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(toSun(18), glm::dvec3(-1, 0, 0)), 1e-12);
  // Low light is red, and there is none below the horizon; the sky is brighter by day than at dusk than by night.
  const auto sky = [&](double hour) {
    poseAt(scene, hour);
    return meanOf(*scene.environment->picture).y;
  };
  toSun(17.5);
  EXPECT_GT(scene.sun->irradiance.x, 2.0f * scene.sun->irradiance.z);
  EXPECT_GT(scene.sun->irradiance.z, 0.0f);
  toSun(19);
  EXPECT_EQ(scene.sun->irradiance, glm::vec3(0.0f));
  EXPECT_GT(sky(12), 3.0 * sky(17.9));
  EXPECT_NEAR(sky(18.0 + 1.3 / (15.0 * std::cos(50 * kDegree))) / sky(18.0), std::exp(-1.0),
              0.01);  // 1.3 degrees below
  EXPECT_LT(sky(24), 1e-6 * sky(12));
  // 23.45 degrees high at noon on the pole at midsummer
  EXPECT_NEAR(std::asin(directionToSun(90, 172, 3).y), 0.4093 * std::sin(2 * kPi * 91 / 368), 1e-12);
}

TEST_F(MovingScene, WrongCurvesAreNamedByFileAndKey) {
  for (const auto& [keys, message] : {
           std::pair{
               R"("points": [{"position": {"times": [0, 0], "values": [[0,0,0],[1,0,0]]}, "intensity": [1,1,1]}])",
               "points[0].position.times[1]\": found 0, expected a later time"},
           {R"("points": [{"position": {"times": [0, 1], "values": [[0,0,0]]}, "intensity": [1,1,1]}])",
            "points[0].position\" at 0 s: found"},
           {R"("points": [{"position": {"times": [0], "values": [3]}, "intensity": [1,1,1]}])",
            "points[0].position at 0 s\": found 3.0, expected an array of 3 numbers"},
           {R"("points": [{"position": {"times": [], "values": []}, "intensity": [1,1,1]}])",
            "points[0].position.times"},
           {R"("points": [{"position": {"times": [0], "values": [[0,0,0]], "speed": 2}, "intensity": [1,1,1]}])",
            "unknown key \"points[0].position.speed\""},
           {R"("points": [{"position": {"times": [0], "values": [[0,0,0]], "interpolation": "bounce"},
               "intensity": [1,1,1]}])",
            "step, linear or cubic"},
           {R"("points": [{"position": [0,0,0], "intensity": {"times": [0, 1], "values": [[1,1,1],[-1,1,1]]}}])",
            "points[0].intensity\" at 1 s"},
           {R"("scale": {"times": [0, 1], "values": [1, 2]})", "scale"},
           {R"("objects": {"right": {"scale": {"times": [0, 1]}}})", "a curve with as many"},
           {R"("objects": {"middle": {"translation": [0, 0, 0]}})",
            "a mesh of the model, of which it has 2 ('left', 'right')"},
           {R"("objects": {"left": {"turn": {"degrees": 4}}})", "axis"},
           {R"("sun": {"latitude": 3, "irradiance": [1,1,1]})", "hour"},
       })
    EXPECT_TRUE(contains(refusal(keys), message)) << keys << "\n" << refusal(keys);
  EXPECT_TRUE(contains(refusal(R"("sun": {"direction": {"times": [0, 9], "values": [[0,-1,0],[0,1,0.1]]},
      "irradiance": [1,1,1]}, "environment": {"sky": {}})"),
                       "above the horizon"));
}

// ------------------------------------------------------------------------------------------------ glTF

/// Adds a channel with times 0 and 2.
void animate(Gltf& gltf, int node, const char* path, int output, const char* interpolation = "LINEAR") {
  if (!gltf.root.contains("animations"))
    gltf.root["animations"] = {{{"samplers", nlohmann::json::array()}, {"channels", nlohmann::json::array()}}};
  nlohmann::json& animation = gltf.root["animations"][0];
  animation["samplers"].push_back(
      {{"input", gltf.floats({0, 2}, "SCALAR")}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

TEST(GltfMotion, NodesCarryWhatHangsOnThem) {
  Gltf gltf;
  gltf.root["nodes"] = {{{"children", {1, 2}}, {"scale", {2, 2, 2}}},
                        {{"mesh", 0}},
                        {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  gltf.root["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"intensity", 5}}};
  gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  animate(gltf, 0, "translation", gltf.floats({0, 0, 0, 0, 0, 10}, "VEC3"));
  const float half = std::sqrt(0.5f);
  animate(gltf, 0, "rotation", gltf.floats({0, 0, 0, 1, 0, half, 0, half}, "VEC4"));
  Scene scene = gltf.load();
  EXPECT_TRUE(std::ranges::none_of(loggedWarnings(), [](const std::string& w) { return contains(w, "animation"); }));
  expectCorners(scene, {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}});
  EXPECT_TRUE(poseAt(scene, 2.0).lamps);
  expectCorners(scene, {{0, 0, 10}, {0, 0, 8}, {0, 2, 10}}, 1e-5f);  // a quarter turn about y takes x to -z
  EXPECT_LT(glm::distance(scene.spots[0].position, glm::dvec3(0, 0, 10)), 1e-6);
  EXPECT_LT(glm::distance(scene.spots[0].direction, glm::dvec3(-1, 0, 0)), 1e-6);
  const auto camera = std::ranges::find_if(scene.cameras, [](const Camera& c) { return c.verticalFov == 1.0; });
  const TempFolder folder;
  const auto second = folder.write("second.gltf", gltf.text());
  EXPECT_TRUE(contains(badInputMessage([&] { addModel(scene, second); }), "second.gltf: it has animations"));
  ASSERT_NE(camera, scene.cameras.end());
  EXPECT_LT(glm::distance(camera->direction, glm::dvec3(-1, 0, 0)), 1e-6);
  EXPECT_LT(glm::distance(camera->up, glm::dvec3(0, 1, 0)), 1e-6);
  EXPECT_EQ(scene.motion->end, 2.0);
}

TEST(GltfMotion, WeightsMorph) {
  Gltf gltf;
  gltf.primitive()["targets"] = {{{"POSITION", gltf.floats({0, 0, 1, 0, 0, 2, 0, 0, 3}, "VEC3")}},
                                 {{"POSITION", gltf.floats({0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3")}}};
  animate(gltf, 0, "weights", gltf.floats({0, 0, 1, 4}, "SCALAR"));
  Scene scene = gltf.load();
  expectCorners(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  poseAt(scene, 1.0);
  expectCorners(scene, {{0, 2, 0.5f}, {1, 2, 1}, {0, 3, 1.5f}});
}

TEST(GltfMotion, JointsBendASkin) {
  Gltf gltf;
  gltf.root["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"translation", {1, 0, 0}}}, {{"translation", {0, 0, 0}}}};
  gltf.root["scenes"][0]["nodes"] = {0, 1, 2};
  gltf.root["skins"] = {{{"joints", {1, 2}},
                         {"inverseBindMatrices", gltf.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1,
                                                              1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1},
                                                             "MAT4")}}};
  gltf.attributes()["NORMAL"] = gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  gltf.attributes()["JOINTS_0"] =
      gltf.accessor(gltf.view(test::bytesOf(std::vector<std::uint8_t>{1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0})),
                    Gltf::kUnsignedByte, "VEC4", 3);
  gltf.attributes()["WEIGHTS_0"] = gltf.floats({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0}, "VEC4");
  animate(gltf, 1, "translation", gltf.floats({1, 0, 0, 1, 0, 6}, "VEC3"));
  Scene scene = gltf.load();
  expectCorners(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  poseAt(scene, 1.0);
  expectCorners(scene, {{0, 0, 0}, {1, 0, 1.5f}, {0, 1, 0}});  // half of the joint's 3
}

TEST(GltfMotion, BrokenAnimationsAreNamedAndWhatIsNotPlayedIsSaid) {
  Gltf gltf;
  animate(gltf, 0, "translation", gltf.floats({0, 0, 0}, "VEC3"));
  EXPECT_TRUE(contains(gltf.refusal(), "animations[0].samplers[0].output")) << gltf.refusal();
  Gltf falling;
  animate(falling, 0, "translation", falling.floats({0, 0, 0, 1, 0, 0}, "VEC3"));
  falling.root["animations"][0]["samplers"][0]["input"] = falling.floats({2, 1}, "SCALAR");
  EXPECT_TRUE(contains(falling.refusal(), "times that are finite and rise"));
  Gltf absent;
  animate(absent, 7, "translation", absent.floats({0, 0, 0, 1, 0, 0}, "VEC3"));
  EXPECT_TRUE(contains(absent.refusal(), "animations[0].channels[0].target.node"));
  Gltf without;
  animate(without, 0, "rotation", without.floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4"));
  EXPECT_TRUE(contains(without.refusal(), "rotations, not (0, 0, 0, 0) at 2 s")) << without.refusal();
  Gltf morph;
  morph.primitive()["targets"] = {{{"POSITION", morph.floats({0, 0, 1, 0, 0, 2, 0, 0, 3}, "VEC3")}}};
  animate(morph, 0, "weights", morph.floats({0, 0, 1, 1}, "SCALAR"));
  EXPECT_TRUE(contains(morph.refusal(), "each of 1 morph targets of node 0, not 2")) << morph.refusal();
  Gltf skin;
  skin.root["nodes"] = {{{"mesh", 0}, {"skin", 0}}};
  skin.root["skins"] = {{{"joints", {0}}}};
  skin.attributes()["JOINTS_0"] =
      skin.accessor(skin.view(test::bytesOf(std::vector<std::uint8_t>(12, 0))), Gltf::kUnsignedByte, "VEC4", 3);
  skin.attributes()["WEIGHTS_0"] = skin.floats({1, 0, 0, 0, std::nanf(""), 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  EXPECT_TRUE(contains(skin.refusal(), "vertex 1 has no finite weight in WEIGHTS_0")) << skin.refusal();
  Gltf twice;
  for (int i = 0; i < 2; ++i) animate(twice, 0, "translation", twice.floats({0, 0, 0, 1, 0, 0}, "VEC3"));
  twice.load();
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "a second animation of the translation of node 0"));
}

TEST(GltfMotion, PointersMoveNodesMaterialsAndLights) {
  Gltf gltf;
  const auto point = [&](const std::string& pointer, int output) {
    animate(gltf, 0, "pointer", output);
    nlohmann::json& target = gltf.root["animations"][0]["channels"].back()["target"];
    target.erase("node");
    target["extensions"]["KHR_animation_pointer"]["pointer"] = pointer;
  };
  gltf.root["nodes"] = {{{"mesh", 0}}, {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  gltf.root["scenes"][0]["nodes"] = {0, 1};
  gltf.root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_animation_pointer"};
  gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 0}}};
  gltf.root["materials"] = {{{"name", "m"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}}};
  gltf.primitive()["material"] = 0;
  point("/nodes/0/translation", gltf.floats({0, 0, 0, 2, 0, 0}, "VEC3"));
  point("/extensions/KHR_lights_punctual/lights/0/intensity", gltf.floats({0, 8}, "SCALAR"));
  point("/extensions/KHR_lights_punctual/lights/0/color", gltf.floats({1, 1, 1, 1, 0.5f, 0}, "VEC3"));
  point("/materials/0/pbrMetallicRoughness/baseColorFactor", gltf.floats({1, 1, 1, 1, 0, 0.5f, 1, 1}, "VEC4"));
  point("/materials/0/pbrMetallicRoughness/roughnessFactor", gltf.floats({1, 0}, "SCALAR"));
  point("/materials/0/emissiveFactor", gltf.floats({0, 0, 0, 1, 0, 0}, "VEC3"));
  point("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", gltf.floats({1, 3}, "SCALAR"));
  point("/materials/0/alphaCutoff", gltf.floats({0, 1}, "SCALAR"));
  point("/materials/4/emissiveFactor", gltf.floats({0, 0, 0, 1, 0, 0}, "VEC3"));
  Scene scene = gltf.load();
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "'/materials/0/alphaCutoff', '/materials/4/emissiveFactor' is not played"))
      << loggedWarnings()[0];
  ASSERT_EQ(scene.points.size(), 1u);
  EXPECT_EQ(scene.points[0].intensity, glm::vec3(0.0f));
  EXPECT_EQ(scene.materials[0].emission, glm::vec3(0.0f));
  const SceneChange change = poseAt(scene, 1.0);
  EXPECT_TRUE(change.lamps && change.materials && change.meshes.size() == 1);
  expectCorners(scene, {{1, 0, 0}, {2, 0, 0}, {1, 1, 0}});
  EXPECT_LT(glm::distance(scene.points[0].intensity, glm::vec3(4, 3, 2)), 1e-6f);
  EXPECT_LT(glm::distance(scene.materials[0].diffuse, glm::vec3(0.5f, 0.75f, 1.0f)), 1e-6f);
  EXPECT_FLOAT_EQ(scene.materials[0].roughness, 0.25f);  // GGX's alpha, the square
  EXPECT_LT(glm::distance(scene.materials[0].emission, glm::vec3(1, 0, 0)), 1e-6f);  // 0.5 of strength 2
}

}  // namespace
}  // namespace lucerna
