// lucerna render --inspect: the shares of a pixel's light add up to the picture's pixel, whatever the technique, and
// where one lamp shines on a plane they are what can be computed by hand.
#include "base/image.hpp"
#include "support/faulty_shaders.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <numbers>

namespace {

using lucerna::test::FaultyShaders;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;
using nlohmann::json;

class Inspect : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  static json inspect(const std::string& scene, const std::string& options, int x, int y) {
    const RunResult result =
        RUN_LUCERNA("render '" + scene + "' " + options + " --inspect " + std::to_string(x) + "," + std::to_string(y));
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.exitCode == 0 ? json::parse(result.out) : json();
  }
  /// The pixel's centre in the picture that the same options draw.
  glm::dvec3 drawn(const std::string& scene, const std::string& options, int x, int y) const {
    const RunResult result = RUN_LUCERNA("render '" + scene + "' " + options +
                                         (options.find("path") == std::string::npos ? " --pixel-samples 1" : "") +
                                         " --quiet -o " + path("picture.pfm"));
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return glm::dvec3(lucerna::readImage(path("picture.pfm")).at(x, y));
  }
  static glm::dvec3 vectorOf(const json& v) { return {v.at(0), v.at(1), v.at(2)}; }
  static glm::dvec3 sumOf(const json& answer) {
    glm::dvec3 sum(0.0);
    for (const json& share : answer.at("shares")) sum += vectorOf(share.at("radiance"));
    return sum;
  }
  /// Shares add up to the picture's pixel within `error`, relative to its brightest channel.
  void expectWhole(const std::string& scene, const std::string& options, int x, int y, double error = 0.01) const {
    const json answer = inspect(scene, options, x, y);
    ASSERT_FALSE(answer.is_null());
    const glm::dvec3 radiance = drawn(scene, options, x, y), sum = sumOf(answer),
                     told = vectorOf(answer.at("radiance"));
    const double most = std::max({radiance.x, radiance.y, radiance.z});
    ASSERT_GT(most, 0.0);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(told[c], radiance[c], 1e-5 * most) << options << ", channel " << c;
      EXPECT_NEAR(sum[c], radiance[c], error * most) << options << ", channel " << c;
    }
    EXPECT_FALSE(answer.at("shares").empty()) << options;
  }

 private:
  TempFolder folder_;
};

const std::string kCornell = LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json";
const std::string kSmall = "--size 64x64 ";

TEST_F(Inspect, SharesAddUpToThePixelOfDirectLight) {
  expectWhole(kCornell, kSmall + "--technique direct", 12, 40, 1e-5);  // the sun on a wall
  expectWhole(kCornell, kSmall + "--technique direct", 32, 9, 1e-5);
  const json lamp = inspect(kCornell, kSmall + "--technique direct", 32, 9);
  EXPECT_EQ(lamp.at("shares").at(0).at("group"), "emission");
}

TEST_F(Inspect, SharesAddUpToThePixelOfGatheredTexels) {
  expectWhole(kCornell, kSmall + "--technique rsm --set rsm.samples=100", 12, 40);
  // In shadow: all of it is gathered.
  expectWhole(kCornell, kSmall + "--technique rsm --set rsm.samples=100", 32, 20);
  expectWhole(kCornell, kSmall + "--technique rsm --set rsm.samples=100 --set rsm.interpolate=off", 12, 40);
}

TEST_F(Inspect, SharesAddUpToThePixelOfPropagatedLight) { expectWhole(kCornell, kSmall + "--technique lpv", 32, 20); }

TEST_F(Inspect, SharesAddUpToThePixelOfCacheRecords) {
  expectWhole(kCornell, kSmall + "--technique irradiance-cache --set cache.samples=64", 32, 20);
  // Where surfaces meet, in cells that are split.
  for (const glm::ivec2& pixel : {glm::ivec2(46, 14), glm::ivec2(13, 50)})
    expectWhole(kCornell, kSmall + "--technique irradiance-cache --component indirect --set cache.split=4", pixel.x,
                pixel.y);
}

TEST_F(Inspect, SharesAddUpToThePixelOfPatches) {
  expectWhole(kCornell, kSmall + "--technique radiosity --set radiosity.edge=0.1", 32, 20);
  // Of coarse patches, whose form factors are repaired by a third.
  for (const char* more : {"", " --set radiosity.flat=on", " --set radiosity.direct=patches",
                           " --set radiosity.repair=off", " --component indirect"})
    expectWhole(kCornell, kSmall + "--technique radiosity --set radiosity.edge=1" + more, 50, 50, 1e-3);
}

// The paths of the answer are those of the picture.
TEST_F(Inspect, SharesAddUpToThePixelOfPaths) {
  expectWhole(kCornell, kSmall + "--technique path --spp 96 --seed 7", 20, 50, 1e-4);
}

// Parts that do not add up to the pixel are not an answer.
TEST_F(Inspect, PartsThatDoNotAddUpAreAnError) {
  const FaultyShaders shaders;
  shaders.plant("forward/surface.glsl", "record(term, vec4(radiance, 0.0));",
                "record(term, vec4(1.1 * radiance, 0.0));");
  const RunResult result =
      lucerna::test::run("LUCERNA_SHADERS='" + shaders.path().string() + "' '" LUCERNA_BINARY "' render '" + kCornell +
                         "' " + kSmall + "--technique direct --inspect 12,40");
  EXPECT_EQ(result.exitCode, 1) << result.out;
  EXPECT_NE(result.err.find("its parts add up to"), std::string::npos) << result.err;
}

class AskPlane : public Inspect {
 protected:
  void SetUp() override {
    write("plane.mtl", "newmtl grey\nKd 0.5 0.4 0.3\n");
    write("plane.obj", "mtllib plane.mtl\nusemtl grey\nv -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\nf 1 4 3 2\n");
    write("plane.json", R"({"model": "plane.obj", "points": [{"position": [0, 2, 0], "intensity": [8, 8, 8]}],
      "cameras": [{"name": "above", "position": [0, 3, 3], "target": [0, 0, 0], "fov": 40}]})");
  }
};

// Under the lamp: L = albedo / pi * I / h^2, all of it by the one lamp.
TEST_F(AskPlane, OneLampGivesAllAsComputedByHand) {
  for (const std::string technique : {"direct", "rsm", "irradiance-cache"}) {
    const json answer = inspect(path("plane.json"), "--size 33x33 --technique " + technique, 16, 16);
    ASSERT_FALSE(answer.is_null());
    const glm::dvec3 expected = glm::dvec3(0.5, 0.4, 0.3) / std::numbers::pi * 8.0 / 4.0;
    const json& brightest = answer.at("shares").at(0);
    EXPECT_EQ(brightest.at("name"), "point 1");
    EXPECT_EQ(brightest.at("group"), "direct");
    const glm::dvec3 radiance = vectorOf(brightest.at("radiance"));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(radiance[c], expected[c], 2e-3 * expected[c]) << technique;
    EXPECT_NEAR(brightest.at("share").get<double>(), 1.0, 1e-5) << technique;  // a plane lights nothing of itself
    EXPECT_NEAR(glm::length(vectorOf(brightest.at("places").back()) - glm::dvec3(0, 2, 0)), 0.0, 1e-6);
    EXPECT_NEAR(glm::length(vectorOf(answer.at("surface").at("normal")) - glm::dvec3(0, 1, 0)), 0.0, 1e-6);
  }
}

TEST_F(AskPlane, APathGoesFromTheCameraOverThePlaneToTheLamp) {
  const json answer = inspect(path("plane.json"), "--size 33x33 --technique path --spp 4", 16, 16);
  ASSERT_FALSE(answer.is_null());
  EXPECT_EQ(answer.at("samples"), 4);
  ASSERT_EQ(answer.at("groups").size(), 1u);
  EXPECT_EQ(answer.at("groups").at(0).at("group"), "direct");
  ASSERT_EQ(answer.at("shares").size(), 4u);  // one a sample
  for (const json& share : answer.at("shares")) {
    EXPECT_EQ(share.at("name"), "point 1");
    ASSERT_EQ(share.at("places").size(), 3u);
    EXPECT_NEAR(glm::length(vectorOf(share.at("places").at(0)) - glm::dvec3(0, 3, 3)), 0.0, 1e-5);
    EXPECT_NEAR(share.at("places").at(1).at(1).get<double>(), 0.0, 1e-3);
    EXPECT_NEAR(glm::length(vectorOf(share.at("places").at(2)) - glm::dvec3(0, 2, 0)), 0.0, 1e-3);
  }
}

TEST_F(AskPlane, WhatIsBehindTheSceneIsSaid) {
  const json answer = inspect(path("plane.json"), "--size 33x33 --technique direct --camera 0,3,3,0,9,-9,40", 16, 16);
  ASSERT_FALSE(answer.is_null());
  EXPECT_FALSE(answer.contains("surface"));
}

TEST_F(AskPlane, WrongPixelsAreRefused) {
  for (const char* text : {"33,0", "0,33", "-1,0", "3", "a,b", "1,2,3"}) {
    const RunResult result =
        RUN_LUCERNA("render " + path("plane.json") + " --technique direct --size 33x33 --inspect=" + text);
    EXPECT_EQ(result.exitCode, 2) << text;
    EXPECT_NE(result.err.find("--inspect"), std::string::npos) << result.err;
  }
  const RunResult both =
      RUN_LUCERNA("render " + path("plane.json") + " --size 33x33 --inspect 1,1 -o " + path("a.png"));
  EXPECT_EQ(both.exitCode, 2);
}

}  // namespace
