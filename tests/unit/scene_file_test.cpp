// Scene JSON: each key, and that whatever is wrong is named by file and key.
#include "base/angles.hpp"
#include "base/image.hpp"
#include "scene/clear_sky.hpp"
#include "scene/studio.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"
#include "scene/scene_file.hpp"
#include "support/contains.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::TempFolder;

/// A folder with a one-triangle model in a sub-folder.
struct SceneFolder : TempFolder {
  SceneFolder() { write("models/box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"); }
  Scene load(const std::string& keys) const {
    return loadScene(write("room.json", "{\"model\": \"models/box.obj\"" + keys + "}"));
  }
};

TEST(SceneFile, AModelAloneTakesTheDefaults) {
  const SceneFolder folder;
  const Scene scene = folder.load("");
  EXPECT_EQ(scene.name, "room");
  EXPECT_EQ(scene.file.filename(), "room.json");
  EXPECT_EQ(scene.triangleCount(), 1u);
  EXPECT_EQ(scene.metresPerUnit, 1.0);
  EXPECT_EQ(scene.exposure, 0.4f);  // goes with the default sun and the view from outside
  EXPECT_EQ(scene.cameras.size(), 1u);
  EXPECT_TRUE(scene.sun);
  EXPECT_EQ(folder.load(R"(, "sun": {"direction": [0, -1, 0], "irradiance": [1, 1, 1]})").exposure, 1.0f);
  EXPECT_EQ(folder.load(R"(, "exposure": 2)").exposure, 2.0f);
}

TEST(SceneFile, ABoxThatIsLitWithinIsSeenFromItsOpenSide) {
  const Scene box = loadScene(std::filesystem::path(LUCERNA_SOURCE_DIR) / "assets/cornell/cornell.obj");
  EXPECT_FALSE(box.sun);
  EXPECT_LT(box.cameras.front().position.z, box.bounds.min.z);  // it is open to -z
  EXPECT_GT(box.cameras.front().direction.z, 0.5);
}

// With the default sun surfaces in the sun decide from outside, those lit by reflection inside; a file's exposure
// stays.
TEST(SceneFile, TheDefaultExposureFollowsTheView) {
  Scene scene;
  scene.bounds.add({-1, -1, -1});
  scene.bounds.add({1, 2, 1});
  scene.defaultExposure = true;
  Camera camera;
  const std::pair<glm::dvec3, float> cases[] = {
      {{0.0, 1.9, 0.0}, 3.0f}, {{0.0, 2.1, 0.0}, 0.4f}, {{-5.0, 0.0, 0.0}, 0.4f}};
  for (const auto& [position, exposure] : cases) {
    camera.position = position;
    setDefaultExposure(scene, camera);
    EXPECT_EQ(scene.exposure, exposure);
  }
  scene.defaultExposure = false;
  scene.exposure = 2.0f;
  setDefaultExposure(scene, camera);
  EXPECT_EQ(scene.exposure, 2.0f);
}

TEST(SceneFile, EveryKeyIsRead) {
  const SceneFolder folder;
  folder.write("walk.txt", "p 0 0 0 d 1 0 0 u 0 1 0\np 1 0 0 d 1 0 0 u 0 1 0\n");
  const Scene scene = folder.load(
      R"(, "description": "a room", "scale": 10, "camera": {"position": [1, 2, 3], "target": [1, 2, 0],
      "up": [0, 2, 1], "fov": 40},
      "sun": {"direction": [0, -2, 0], "irradiance": [1, 2, 3]}, "background": [0.1, 0.2, 0.3], "exposure": 0.5,
      "keyFrames": "walk.txt")");
  EXPECT_EQ(scene.metresPerUnit, 0.01);
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(scene.cameras[0].direction, glm::dvec3(0, 0, -1));
  EXPECT_EQ(scene.cameras[0].up, glm::dvec3(0, 1, 0));
  EXPECT_NEAR(scene.cameras[0].verticalFov, 40 * kDegree, 1e-12);
  EXPECT_EQ(scene.sun->direction, glm::dvec3(0, -1, 0));
  EXPECT_EQ(scene.sun->irradiance, glm::vec3(1, 2, 3));
  EXPECT_EQ(scene.background, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(scene.exposure, 0.5f);
  EXPECT_EQ(scene.keyFrames, folder / "walk.txt");
}

// Surfaces of a second model join those of the first, with their materials, textures and places.
TEST(SceneFile, SeveralModelsAreOneScene) {
  const SceneFolder folder;
  writePng(folder / "models/red.png", Bitmap{1, 1, {255, 0, 0, 255}});
  writePng(folder / "models/blue.png", Bitmap{1, 1, {0, 0, 255, 255}});
  folder.write("models/red.mtl", "newmtl paint\nmap_Kd red.png\n");
  folder.write("models/blue.mtl", "newmtl paint\nmap_Kd blue.png\nKe 1 2 3\n");
  // So far away that an offset is taken off.
  const std::string far = "o first\nv 1000000.03 0 0\nv 1000002.03 0 0\nv 1000000.03 2 0\nusemtl paint\nf 1 2 3\n";
  folder.write("models/first.obj", "mtllib red.mtl\n" + far);
  folder.write("models/second.obj", "mtllib blue.mtl\no second\nv 1 0 0\nv 3 0 0\nv 1 2 0\nusemtl paint\nf 1 2 3\n");
  const Scene scene =
      loadScene(folder.write("two.json", R"({"model": ["models/first.obj", "models/second.obj"], "sun": null})"));
  EXPECT_EQ(scene.name, "two");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[1].name, "second");
  const Material &first = scene.materials[static_cast<std::size_t>(scene.meshes[0].material)],
                 &second = scene.materials[static_cast<std::size_t>(scene.meshes[1].material)];
  EXPECT_EQ(first.emission, glm::vec3(0.0f));
  EXPECT_EQ(second.emission, glm::vec3(1, 2, 3));
  const auto texel = [&](const Material& material) {
    return scene.textures[static_cast<std::size_t>(material.diffuseTexture)].bitmap.rgba;
  };
  EXPECT_EQ(texel(first), (std::vector<std::uint8_t>{255, 0, 0, 255}));
  EXPECT_EQ(texel(second), (std::vector<std::uint8_t>{0, 0, 255, 255}));
  EXPECT_NE(scene.origin, glm::dvec3(0.0));
  const auto place = [&](std::size_t corner) {
    return scene.origin + glm::dvec3(scene.vertices[scene.indices[corner]].position);
  };
  EXPECT_LT(glm::distance(place(0), glm::dvec3(1000000.03, 0, 0)), 1e-6);
  EXPECT_EQ(place(3), glm::dvec3(1, 0, 0));
  EXPECT_EQ(scene.meshes[1].bounds.min + scene.origin, glm::dvec3(1, 0, 0));
  EXPECT_LT(glm::distance(scene.bounds.extent(), glm::dvec3(1000001.03, 2, 0)), 1e-6);
}

TEST(SceneFile, SeveralCamerasKeepOrderAndNames) {
  const SceneFolder folder;
  const Scene scene = folder.load(
      R"(, "cameras": [{"name": "b", "position": [0,0,5], "direction": [0,0,-3]}, {"name": "a", "position": [0,0,5],
      "target": [1,0,5]}])");
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "b");
  EXPECT_EQ(scene.cameras[0].direction, glm::dvec3(0, 0, -1));
  EXPECT_EQ(scene.cameras[1].name, "a");
  EXPECT_EQ(scene.cameras[1].direction, glm::dvec3(1, 0, 0));
}

TEST(SceneFile, KeyFramesGiveTheCameraWhereNoneIsNamed) {
  const SceneFolder folder;
  folder.write("walk.txt", "p 7 8 9 d 1 0 0 u 0 1 0 f 33\np 1 0 0 d 1 0 0 u 0 1 0\n");
  const Scene scene = folder.load(R"(, "keyFrames": "walk.txt")");
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].position, glm::dvec3(7, 8, 9));
  EXPECT_NEAR(scene.cameras[0].verticalFov, 33 * kDegree, 1e-12);
}

TEST(SceneFile, TheSunCanBeSwitchedOff) {
  const SceneFolder folder;
  EXPECT_FALSE(folder.load(R"(, "sun": null)").sun);
}

TEST(SceneFile, WhatIsWrongIsNamedByFileAndKey) {
  const SceneFolder folder;
  const std::string camera = R"(, "camera": {"position": [0,0,5], )";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"(, "modell": 1)", "unknown key \"modell\"; nearest: model, "},
      {R"(, "sun": {"direction": [0,-1,0], "irradiance": [1,1,1], "colour": 1})", "\"sun.colour\""},
      {camera + R"("direction": [0,0,-1], "zoom": 2})", "\"camera.zoom\""},
      {R"(, "scale": "10")", "\"scale\""},
      {R"(, "scale": 0)", "above 0"},
      {R"(, "scale": -1)", "above 0"},
      {R"(, "exposure": null)", "\"exposure\""},
      {R"(, "exposure": 1e999)", "JSON"},
      {R"(, "exposure": NaN)", "JSON"},
      {R"(, "background": [1, 2])", "\"background\""},
      {R"(, "background": [1, 2, 3, 4])", "\"background\""},
      {R"(, "background": [1, 2, "3"])", "\"background[2]\""},
      {R"(, "background": [1, 2, -3])", "\"background\""},
      {R"(, "background": [1, 2, 1e300])", "\"background\""},
      {R"(, "sun": {"direction": [0,-1,0], "irradiance": [1,1,1e37]})", "from 0 to 1e+30"},
      {R"(, "sun": [1, 2, 3])", "\"sun\""},
      {R"(, "sun": {"direction": [0,-1,0]})", "irradiance"},
      {R"(, "sun": {"direction": [0,-1,0], "irradiance": [1,1,1], "angularDiameter": 120})", "\"sun.angularDiameter\""},
      {R"(, "points": [{"position": [0,1,0], "intensity": [1,1,1], "radius": -1}])", "\"points[0].radius\""},
      {R"(, "sun": {"direction": [0,0,0], "irradiance": [1,1,1]})", "\"sun.direction\""},
      {R"(, "sun": {"direction": [0,-1,0], "irradiance": [1,1,-1]})", "\"sun.irradiance\""},
      {R"(, "camera": {"target": [0,0,0]})", "\"position\""},
      {R"(, "camera": {"position": [0,0,5]})", "\"target\" or \"direction\""},
      {camera + R"("target": [0,0,0], "direction": [0,0,-1]})", "\"target\" or \"direction\""},
      {camera + R"("target": [0,0,5]})", "\"camera\""},
      {camera + R"("direction": [0,1,0]})", "parallel"},
      {camera + R"("direction": [0,0,-1], "fov": 180})", "\"camera.fov\""},
      {camera + R"("direction": [0,0,-1], "fov": 0})", "\"camera.fov\""},
      {R"(, "cameras": [])", "\"cameras\""},
      {R"(, "cameras": {"name": "a"})", "\"cameras\""},
      {R"(, "cameras": [{"position": [0,0,5], "direction": [0,0,-1]}])", "\"name\""},
      {R"(, "cameras": [{"name":"a","position":[0,0,5],"direction":[0,0,-1]},{"name":"a","position":[0,0,5],
      "direction":[0,0,-1]}])",
       "\"cameras[1].name\""},
      {R"(, "cameras": [{"name":"a","position":[0,0,"5"],"direction":[0,0,-1]}])", "\"cameras[0].position[2]\""},
      {R"(, "cameras": [{"name":"a","position":[0,0,5],"direction":[0,0,-1]}], "camera": {"position":[0,0,5],
      "direction":[0,0,-1]})",
       "one of them"},
      {R"(, "keyFrames": "")", "\"keyFrames\""},
      {R"(, "description": 3)", "\"description\""},
      {R"(, "scene": {})", "no \"camera\""},
      {R"(, "scale": 1,)", "JSON"},
      {R"(, "environment": {})", "\"sky\""},
      {R"(, "environment": {"sky": 3})", "\"environment.sky\""},
      {R"(, "environment": {"sky": {"turbidity": 1}})", "\"environment.sky.turbidity\""},
      {R"(, "environment": {"sky": {"turbidity": 11}})", "\"environment.sky.turbidity\""},
      {R"(, "environment": {"sky": {"ground": 1.5}})", "\"environment.sky.ground\""},
      {R"(, "environment": {"sky": {"clouds": 1}})", "\"environment.sky.clouds\""},
      {R"(, "environment": {"sky": {}, "rotation": 0})", "without \"picture\" and \"rotation\""},
      {R"(, "sun": null, "environment": {"sky": {}})", "a sun above the horizon"},
      {R"(, "sun": {"direction": [0,1,0], "irradiance": [1,1,1]}, "environment": {"sky": {}})",
       "a sun above the horizon"},
  };
  for (const auto& [keys, expected] : cases) {
    const std::string message = badInputMessage([&, &text = keys] { folder.load(text); });
    EXPECT_TRUE(contains(message, "room.json")) << keys << "\n" << message;
    EXPECT_TRUE(contains(message, expected)) << keys << "\n" << message;
  }
}

TEST(SceneFile, SunsAndLampsHaveASize) {
  const SceneFolder folder;
  const std::string sun = R"(, "sun": {"direction": [0,-1,0], "irradiance": [1,1,1])";
  EXPECT_EQ(folder.load("").sun->angularDiameter, kSunDiameter);
  EXPECT_EQ(folder.load(sun + "}").sun->angularDiameter, kSunDiameter);
  EXPECT_NEAR(folder.load(sun + R"(, "angularDiameter": 2})").sun->angularDiameter, 2.0 * kDegree, 1e-15);
  EXPECT_EQ(folder.load(sun + R"(, "angularDiameter": 0})").sun->angularDiameter, 0.0);
  const std::string lamp = R"(, "points": [{"position": [0,1,0], "intensity": [1,1,1])";
  EXPECT_EQ(folder.load(lamp + "}]").points[0].radius, 0.0);
  EXPECT_EQ(folder.load(lamp + R"(, "radius": 0.25}])").points[0].radius, 0.25);
  const std::string spot = R"(, "spots": [{"position": [0,1,0], "direction": [0,-1,0], "intensity": [1,1,1],
                              "innerAngle": 10, "outerAngle": 20)";
  EXPECT_EQ(folder.load(spot + R"(, "radius": 0.5}])").spots[0].radius, 0.5);
}

TEST(SceneFile, TheDefaultSunHasItsSkyUnlessAnotherWordIsSaid) {
  const SceneFolder folder;
  const Scene scene = folder.load("");
  ASSERT_TRUE(scene.environment && scene.environment->picture);
  EXPECT_TRUE(scene.studio);
  EXPECT_TRUE(scene.environment->picture->pixels == studioSky(*scene.sun).pixels);
  const Scene viewed = folder.load(
      R"(, "camera": {"position": [0,0,5], "direction": [0,0,-1]})");  // the default sun stands elsewhere then
  ASSERT_NE(viewed.sun->direction, scene.sun->direction);
  EXPECT_FALSE(viewed.studio);
  EXPECT_TRUE(viewed.environment->picture->pixels == clearSkyPicture({}, *viewed.sun).pixels);
  EXPECT_TRUE(loadScene(folder.path() / "models/box.obj").environment);
  EXPECT_FALSE(folder.load(R"(, "environment": null)").environment);
  EXPECT_FALSE(folder.load(R"(, "environment": null)").studio);
  EXPECT_FALSE(folder.load(R"(, "sun": {"direction": [0,-1,0], "irradiance": [1,1,1]})").environment);
  EXPECT_FALSE(folder.load(R"(, "sun": null)").environment);
  EXPECT_FALSE(folder.load(R"(, "points": [])").environment);
}

TEST(SceneFile, ASkyIsTheSunsByTurbidityAndGround) {
  const SceneFolder folder;
  const std::string sun = R"(, "sun": {"direction": [1,-1,0], "irradiance": [3,2,1]}, "environment": )";
  const Scene plain = folder.load(sun + R"({"sky": {}})"),
              hazy = folder.load(sun + R"({"sky": {"turbidity": 6, "ground": 0.5}, "radiance": [2,2,1]})");
  EXPECT_EQ(plain.environment->radiance, glm::vec3(1.0f));
  EXPECT_EQ(plain.environment->picture->pixels, clearSkyPicture({}, *plain.sun).pixels);
  EXPECT_EQ(hazy.environment->radiance, glm::vec3(2.0f, 2.0f, 1.0f));
  EXPECT_EQ(hazy.environment->picture->pixels, clearSkyPicture({6.0, 0.5}, *plain.sun).pixels);
  EXPECT_TRUE(analyse(plain).environmentPicture);
}

TEST(SceneFile, AnEnvironmentIsRadianceOrRefusedByItsTexel) {
  const SceneFolder folder;
  const auto load = [&](const glm::vec3& texel, const char* more = "") {
    Image picture(3, 2, glm::vec3(texel == glm::vec3(0.0f) ? 0.0f : 1.0f));
    picture.at(1, 0) = texel;
    writeImage(folder.path() / "sky.pfm", picture);
    return folder.load(R"(, "environment": {"picture": "sky.pfm")" + std::string(more) + "}");
  };
  EXPECT_EQ(load({0.5f, 0.0f, 3.0f}).environment->picture->at(1, 0), glm::vec3(0.5f, 0.0f, 3.0f));
  EXPECT_FALSE(analyse(load({0.0f, 0.0f, 0.0f})).environment);  // black: lights nothing, which is no error
  EXPECT_TRUE(analyse(load({0.0f, 0.0f, 3.0f})).environmentPicture);
  const float infinity = std::numeric_limits<float>::infinity();
  for (const glm::vec3& texel :
       {glm::vec3(1.0f, std::nanf(""), 1.0f), glm::vec3(infinity, 1.0f, 1.0f), glm::vec3(1.0f, 1.0f, -1e-6f)}) {
    const std::string message = badInputMessage([&] { load(texel); });
    EXPECT_TRUE(contains(message, "sky.pfm: texel 1, 0 ")) << message;
  }
  EXPECT_TRUE(contains(badInputMessage([&] {
                         load({1e20f, 1.0f, 1.0f}, R"(, "radiance": [1e20, 1, 1])");
                       }),
                       "sky.pfm: texel 1, 0 "));  // their product is infinite
}

TEST(SceneFile, FilesThatAreMissingOrNoSceneAreErrors) {
  const SceneFolder folder;
  const auto message = [&](std::string_view content) {
    const auto file = folder.write("s.json", content);
    return badInputMessage([&] { loadScene(file); });
  };
  EXPECT_TRUE(contains(message(""), "s.json"));
  EXPECT_TRUE(contains(message("{}"), "\"model\""));
  EXPECT_TRUE(contains(message("[1, 2]"), "object"));
  EXPECT_TRUE(contains(message("{\"model\": \"models"), "s.json"));
  EXPECT_TRUE(contains(message(std::string_view("\xff\xfe\0\1", 4)), "s.json"));
  EXPECT_TRUE(contains(message(R"({"model": 3})"), "\"model\""));
  EXPECT_TRUE(contains(message(R"({"model": "none.obj"})"), "none.obj: no such file"));
  EXPECT_TRUE(contains(message(R"({"model": "models"})"), "is a folder"));
  EXPECT_TRUE(contains(message(R"({"model": "s.json"})"), "\"model\""));
  EXPECT_TRUE(contains(message(R"({"model": "models/box.obj", "keyFrames": "none.txt"})"), "none.txt: no such file"));
  EXPECT_TRUE(contains(badInputMessage([&] { loadScene(folder / "gone.json"); }), "gone.json: no such file"));
}

}  // namespace
}  // namespace lucerna
