// Scenes that move, by the commands: a moment, a recording, and the window that plays, holds and shows radiosity's new
// solutions.
#include "base/image.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

namespace {

using lucerna::Bitmap;
using lucerna::readBitmap;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

class Motion : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("m.obj",
                  "o floor\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nvn 0 1 0\nf 4//1 3//1 2//1 1//1\n"
                  "o card\nv -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0.5 1 0.5\nv -0.5 1 0.5\nf 8//1 7//1 6//1 5//1\n");
    folder_.write("s.json", R"({"model": "m.obj", "environment": null,
        "camera": {"position": [0, 3, 3], "target": [0, 0, 0], "fov": 50},
        "sun": {"direction": [-0.2, -1, -0.2], "irradiance": [3, 3, 3]},
        "objects": {"card": {"translation": {"times": [0, 2], "values": [[-1, 0, 0], [1, 0, 0]]}}}})");
  }
  RunResult lucerna(const std::string& arguments) const {
    return run("cd '" + folder_.path().string() + "' && '" LUCERNA_BINARY "' " + arguments);
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json dynamicJson() const { return nlohmann::json::parse(std::ifstream(path("page/dynamic.json"))); }
  TempFolder folder_;
};

TEST_F(Motion, ARecordingHasThePicturesOfItsMoments) {
  for (const std::string technique : {"direct", "irradiance-cache"}) {
    const std::string picture = " --size 48x32 --technique " + technique;
    RunResult result = lucerna("walk s.json --record frames --frames 3 --fps 2 --time 0.5" + picture);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    for (const auto& [frame, time] : {std::pair{"frames/frame_0000.png", "0.5"},
                                      {"frames/frame_0001.png", "1"},
                                      {"frames/frame_0002.png", "1.5"}}) {
      result = lucerna("render s.json -o m.png --time " + std::string(time) + picture);
      ASSERT_EQ(result.exitCode, 0) << result.err;
      EXPECT_EQ(readBitmap(path(frame)).rgba, readBitmap(path("m.png")).rgba) << technique << " " << frame;
    }
    EXPECT_NE(readBitmap(path("frames/frame_0000.png")).rgba, readBitmap(path("frames/frame_0002.png")).rgba);
    // Without --fps they are spread over the scene's two seconds.
    result = lucerna("walk s.json --record spread --frames 3" + picture);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(readBitmap(path("spread/frame_0001.png")).rgba, readBitmap(path("frames/frame_0001.png")).rgba);
    result = lucerna("render s.json -o m.png --time 2" + picture);
    EXPECT_EQ(readBitmap(path("spread/frame_0002.png")).rgba, readBitmap(path("m.png")).rgba);
  }
}

TEST_F(Motion, KeyFramesCarryInAWalkAsInTheScene) {
  folder_.write("keys.txt", "move card t 0 p 0 0 0\nmove card t 2 p 0 0.6 1\n");
  std::string scene;
  std::getline(std::ifstream(path("s.json")), scene, '\0');
  folder_.write("carried.json", scene.replace(0, 1, "{\"keyFrames\": \"keys.txt\", "));
  const std::string picture = " --technique direct --size 48x32 --pixel-samples 4";
  for (const char* walk : {"s.json --record keys --keys keys.txt", "carried.json --record scene"}) {
    const RunResult result = lucerna("walk " + std::string(walk) + " --frames 3" + picture);
    ASSERT_EQ(result.exitCode, 0) << result.err;
  }
  for (const char* command : {"render s.json -o still.png", "render carried.json -o moved.png"}) {
    const RunResult result = lucerna(command + std::string(" --time 2") + picture);
    ASSERT_EQ(result.exitCode, 0) << result.err;
  }
  const auto moved = readBitmap(path("moved.png")).rgba;
  EXPECT_NE(moved, readBitmap(path("still.png")).rgba);
  EXPECT_EQ(readBitmap(path("keys/frame_0002.png")).rgba, moved);
  EXPECT_EQ(readBitmap(path("scene/frame_0002.png")).rgba, moved);
}

TEST_F(Motion, TheWindowPlaysAndHolds) {
  for (const char* technique : {"direct", "radiosity"}) {
    folder_.write("input.txt", "1 key F2\n6 save a.png\n12 save b.png\n13 key P\n15 save c.png\n20 save d.png\n");
    const RunResult result = lucerna(
        "walk s.json --size 96x64 --play-input input.txt --set radiosity.edge=1 --set picture.reprojection=off "
        "--json walk.json --technique " +
        std::string(technique));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_NE(readBitmap(path("a.png")).rgba, readBitmap(path("b.png")).rgba) << technique;
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(path("walk.json")));
    EXPECT_NE(json.dump().find("held at 0."), std::string::npos) << json.at("window").dump();
  }
}

// A lone floor shows direct light alone, so that the rasteriser is right in every moment of a lamp that switches
// (bright at 1 s and 2 s, dim in between) and of one that passes by. A picture that is held is late by what has gone
// by.
TEST_F(Motion, BenchDynamicKnowsAFloorUnderALampThatSwitches) {
  folder_.write("floor.obj", "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nvn 0 1 0\nf 4//1 3//1 2//1 1//1\n");
  folder_.write("lamp.json", R"({"model": "floor.obj", "environment": null, "sun": null,
      "camera": {"position": [0, 3, 3], "target": [0, 0, 0], "fov": 50},
      "points": [{"position": [0, 1, 0], "intensity": {"times": [0, 1, 1.5, 2], "interpolation": "step",
                  "values": [[1, 1, 1], [4, 4, 4], [1, 1, 1], [4, 4, 4]]}},
                 {"position": {"times": [0, 2], "values": [[-1, 0.7, 0], [1, 0.7, 0]]}, "intensity": [1, 1, 1]}]})");
  const RunResult result = lucerna(
      "bench dynamic lamp.json --techniques direct irradiance-cache --frames 10 --fps 5 --size 32x24 "
      "--reference-samples 64 --references references --out page");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = dynamicJson();
  for (const nlohmann::json& row : json.at("techniques")) {
    EXPECT_EQ(row.at("l2").size(), 10u);
    EXPECT_LT(row.at("worst").get<double>(), 0.03) << row.dump();
    EXPECT_NEAR(row.at("lag").get<double>(), 0.0, 0.051) << row.dump();
    EXPECT_NEAR(row.at("ghosts").get<double>(), 0.0, 0.02) << row.dump();
    EXPECT_NEAR(row.at("flicker").get<double>(), 1.0, 0.02) << row.dump();
  }
  EXPECT_NE(result.out.find("irradiance-cache"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(path("page/frames/direct_0009.png")));
  // Nothing moves: said, not measured.
  folder_.write("still.json", R"({"model": "floor.obj"})");
  const RunResult still = lucerna("bench dynamic still.json --out still");
  EXPECT_EQ(still.exitCode, 2);
  EXPECT_NE(still.err.find("nothing moves"), std::string::npos) << still.err;
}

// A Lambert floor under a sun whose shadows move by 1 a second: radiance albedo E cos(theta) / pi, tan(theta) = t - 1.
// The floor fills the picture, and nothing else reflects.
TEST_F(Motion, BenchDynamicKnowsTheCosineOfASunThatTurns) {
  folder_.write("floor.obj",
                "mtllib m.mtl\nusemtl grey\nv -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nvn 0 1 0\nf 4//1 3//1 2//1 1//1\n");
  folder_.write("m.mtl", "newmtl grey\nKd 0.5 0.5 0.5\n");
  folder_.write("sun.json", R"({"model": "floor.obj", "environment": null,
      "camera": {"position": [0, 2, 0], "direction": [0, -1, 0], "up": [0, 0, -1], "fov": 50},
      "sun": {"direction": {"times": [0, 4], "values": [[-1, -1, 0], [3, -1, 0]]}, "irradiance": [3, 3, 3],
              "angularDiameter": 0}})");
  const RunResult result = lucerna(
      "bench dynamic sun.json --techniques direct irradiance-cache path --set path.samples=4 --frames 9 --fps 2 "
      "--size 16x12 --reference-samples 16 --references references --out page");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = dynamicJson();
  const auto isRight = [](const nlohmann::json& radiance, const std::string& what) {
    ASSERT_EQ(radiance.size(), 9u) << what;
    for (std::size_t k = 0; k < 9; ++k) {
      const double tangent = 0.5 * static_cast<double>(k) - 1.0;
      const double right = 0.5 * 3.0 / (std::numbers::pi * std::sqrt(1.0 + tangent * tangent));
      EXPECT_NEAR(radiance[k].get<double>(), right, 1e-4 * right) << what << ", moment " << k;
    }
  };
  isRight(json.at("radiance"), "references");
  EXPECT_EQ(json.at("techniques").size(), 3u);
  for (const nlohmann::json& row : json.at("techniques")) {
    isRight(row.at("radiance"), row.at("technique"));
    EXPECT_LT(row.at("worst").get<double>(), 1e-4) << row.dump();
    EXPECT_NEAR(row.at("lag").get<double>(), 0.0, 1e-9) << row.dump();
    EXPECT_NEAR(row.at("ghosts").get<double>(), 0.0, 1e-3) << row.dump();
    EXPECT_NEAR(row.at("flicker").get<double>(), 1.0, 1e-3) << row.dump();
  }
}

// Two black plates below a sun in the zenith; one slides aside at 0.25 units a second, and a strip of the white floor
// as wide as the slit is lit. The camera, below them, sees 1 unit of the floor across, 0.5 on each side of the middle.
TEST_F(Motion, BenchDynamicKnowsTheStripBehindAWallThatOpens) {
  folder_.write("wall.obj",
                "mtllib m.mtl\no floor\nusemtl white\nv -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nvn 0 1 0\n"
                "f 4//1 3//1 2//1 1//1\nusemtl black\no left\nv -9 2 -9\nv -0.25 2 -9\nv -0.25 2 9\nv -9 2 9\n"
                "f 8//1 7//1 6//1 5//1\no right\nv -0.25 2 -9\nv 9 2 -9\nv 9 2 9\nv -0.25 2 9\n"
                "f 12//1 11//1 10//1 9//1\n");
  folder_.write("m.mtl", "newmtl white\nKd 1 1 1\nnewmtl black\nKd 0 0 0\n");
  folder_.write("wall.json", R"({"model": "wall.obj", "environment": null,
      "camera": {"position": [0, 1, 0], "direction": [0, -1, 0], "up": [0, 0, -1], "fov": 53.13010235},
      "sun": {"direction": [0, -1, 0], "irradiance": [3, 3, 3], "angularDiameter": 0},
      "objects": {"right": {"translation": {"times": [0, 4], "values": [[0, 0, 0], [1, 0, 0]]}}}})");
  const RunResult result = lucerna(
      "bench dynamic wall.json --techniques direct irradiance-cache --set shadow.transport=rays --frames 9 --fps 4 "
      "--filter box --size 32x32 --reference-samples 256 --references references --out page");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = dynamicJson();
  // Edges lie on borders of pixels: 2 more of the 32 columns are lit in each moment.
  const auto isRight = [](const nlohmann::json& radiance, const std::string& what) {
    ASSERT_EQ(radiance.size(), 9u) << what;
    for (std::size_t k = 0; k < 9; ++k)
      EXPECT_NEAR(radiance[k].get<double>() * std::numbers::pi / 3.0, static_cast<double>(k) / 16.0, 1e-4)
          << what << ", moment " << k;
  };
  isRight(json.at("radiance"), "references");
  for (const nlohmann::json& row : json.at("techniques")) {
    isRight(row.at("radiance"), row.at("technique"));
    EXPECT_LT(row.at("worst").get<double>(), 1e-3) << row.dump();
    EXPECT_NEAR(row.at("lag").get<double>(), 0.0, 0.051) << row.dump();
    EXPECT_NEAR(row.at("ghosts").get<double>(), 0.0, 0.02) << row.dump();
  }
}

// A white floor and wall light each other: direct light alone is right against itself, and lacks a part of all.
TEST_F(Motion, BenchDynamicComparesAComponentWithItsReference) {
  folder_.write("corner.obj",
                "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 2 -2\nv 2 2 -2\nvn 0 1 0\nvn 0 0 1\n"
                "f 4//1 3//1 2//1 1//1\nf 1//2 2//2 6//2 5//2\n");
  folder_.write("corner.json", R"({"model": "corner.obj", "environment": null, "sun": null,
      "camera": {"position": [0, 1, 4], "target": [0, 0.7, 0], "fov": 45},
      "points": [{"position": {"times": [0, 2], "values": [[-1, 1.5, 0], [1, 1.5, 0]]}, "intensity": [2, 2, 2]}]})");
  for (const bool isDirect : {false, true}) {
    const RunResult result = lucerna(
        "bench dynamic corner.json --techniques direct --frames 3 --size 32x24 --reference-samples 256 "
        "--references references --out page --set shadow.transport=rays --component " +
        std::string(isDirect ? "direct" : "all"));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const double mean = dynamicJson().at("techniques")[0].at("mean");
    if (isDirect) EXPECT_LT(mean, 0.02);
    else EXPECT_GT(mean, 0.1);
  }
}

// The budgets of a technique are rows of their own: with more samples the irradiance cache is nearer to the reference.
TEST_F(Motion, BenchDynamicMeasuresBudgets) {
  const RunResult result =
      lucerna("bench dynamic '" LUCERNA_SOURCE_DIR
              "/assets/cornell/moving.json' --point 'irradiance-cache cache.samples=8' --point 'irradiance-cache "
              "cache.samples=256' --frames 2 --size 16x16 --reference-samples 256 --references references --out page");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json rows = dynamicJson().at("techniques");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("technique"), "irradiance-cache samples=8");
  EXPECT_LT(rows[1].at("mean").get<double>(), 0.8 * rows[0].at("mean").get<double>()) << rows.dump();
  EXPECT_TRUE(std::filesystem::exists(path("page/frames/irradiance-cache-samples-256_0001.png")));
}

// A moment's errors: the card has moved by then, and so have references and pictures.
TEST_F(Motion, BenchErrorMeasuresAMoment) {
  nlohmann::json reports[2];
  for (int k = 0; k < 2; ++k) {
    const RunResult result = lucerna(
        "bench error s.json --techniques direct --size 24x16 --reference-spp 64 --frames 1 "
        "--references references --out out" +
        std::to_string(k) + " --json error.json --time " + std::to_string(2 * k));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    reports[k] = nlohmann::json::parse(std::ifstream(path("error.json")));
  }
  EXPECT_NE(reports[1].at("bench").get<std::string>().find("at 2 s"), std::string::npos) << reports[1].at("bench");
  EXPECT_NE(reports[1].at("command").get<std::string>().find("--time 2"), std::string::npos);
  EXPECT_EQ(reports[0].at("command").get<std::string>().find("--time"), std::string::npos);
  EXPECT_NE(reports[0].at("rows")[0].at("l2"), reports[1].at("rows")[0].at("l2"));
}

// Pictures drawn K moments late have the lag K, and one moment late they are all ghosts.
TEST_F(Motion, BenchDynamicKnowsPicturesThatAreLate) {
  for (const int late : {1, 3}) {
    const RunResult result = lucerna(
        "bench dynamic s.json --techniques direct --frames 12 --fps 8 --size 32x24 --reference-samples 64 "
        "--references references --out page --late " +
        std::to_string(late));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const nlohmann::json row = dynamicJson().at("techniques")[0];
    EXPECT_NEAR(row.at("lag").get<double>(), late, 0.051) << row.dump();
    if (late == 1) { EXPECT_NEAR(row.at("ghosts").get<double>(), 1.0, 0.05) << row.dump(); }
  }
}

}  // namespace
