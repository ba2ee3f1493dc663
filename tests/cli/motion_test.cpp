// Scenes that move, by the commands: a moment, a recording, and the window that plays, holds and shows radiosity's new
// solutions.
#include "base/image.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
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
  TempFolder folder_;
};

TEST_F(Motion, ARecordingHasThePicturesOfItsMoments) {
  const std::string picture = " --technique direct --size 48x32 --pixel-samples 4";
  RunResult result = lucerna("walk s.json --record frames --frames 3 --fps 2 --time 0.5" + picture);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  for (const auto& [frame, time] :
       {std::pair{"frames/frame_0000.png", "0.5"}, {"frames/frame_0001.png", "1"}, {"frames/frame_0002.png", "1.5"}}) {
    result = lucerna("render s.json -o m.png --time " + std::string(time) + picture);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(readBitmap(path(frame)).rgba, readBitmap(path("m.png")).rgba) << frame;
  }
  EXPECT_NE(readBitmap(path("frames/frame_0000.png")).rgba, readBitmap(path("frames/frame_0002.png")).rgba);
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
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(path("page/dynamic.json")));
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

}  // namespace
