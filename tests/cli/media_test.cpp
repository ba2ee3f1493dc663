// lucerna media and the original's scene JSON on the command line: what they print and write, and that whatever is
// wrong is one line and exit code 2.
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <vector>

namespace {

namespace fs = std::filesystem;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

class MediaCommand : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(path(name))); }
  void expectRefused(const std::string& arguments, const std::vector<std::string>& parts) const {
    const RunResult result = RUN_LUCERNA(arguments);
    EXPECT_EQ(result.exitCode, 2) << arguments << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << arguments << "\n" << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << "'" << part << "' is not in: " << result.err;
  }

 private:
  TempFolder folder_;
};

TEST_F(MediaCommand, ListPrintsTheCatalogue) {
  const RunResult result = RUN_LUCERNA("media list --json " + path("media.json"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 1 + 39);
  for (const char* text :
       {"grape juice", "measured merlot", "Narasimhan2006, 15 ml in 23 l of water", "18.205 20.383 22.37"})
    EXPECT_NE(result.out.find(text), std::string::npos) << text;
  const auto media = json("media.json").at("media");
  ASSERT_EQ(media.size(), 39u);
  EXPECT_EQ(media[0].at("name"), "milk");
  EXPECT_EQ(media[0].at("sigma_s"), (std::vector<double>{18.2052, 20.3826, 22.3698}));
  EXPECT_EQ(media[0].at("ior"), 1.33);
  EXPECT_NEAR(media[0].at("albedo")[0].get<double>(), 18.2052 / 18.20673, 1e-12);
  EXPECT_NEAR(media[0].at("mean_free_path")[0].get<double>(), 1.0 / 18.20673, 1e-12);
}

TEST_F(MediaCommand, DraftBecomesASceneThatLoads) {
  write("cup.mtl", "newmtl Milk.001\nnewmtl wall\nKd 0.5 0.5 0.5\n");
  write("cup.obj",
        "mtllib cup.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl wall\nf 1 2 3\nusemtl Milk.001\nf 1 3 2\nf 1 2 "
        "4\nf 2 3 4\nf 1 4 3\n");
  const RunResult draft = RUN_LUCERNA("media draft " + path("cup.mtl") + " -o " + path("cup.json"));
  ASSERT_EQ(draft.exitCode, 0) << draft.err;
  EXPECT_NE(draft.err.find("Milk.001: milk"), std::string::npos) << draft.err;
  EXPECT_NE(draft.err.find("wall: resembles no medium"), std::string::npos) << draft.err;
  EXPECT_EQ(json("cup.json").at("Milk.001").at("ior"), 1.33);
  EXPECT_TRUE(json("cup.json").contains("// wall"));
  const RunResult info = RUN_LUCERNA("info " + path("cup.json") + " --quiet --json " + path("info.json"));
  ASSERT_EQ(info.exitCode, 0) << info.err;
  EXPECT_EQ(json("info.json").at("triangles"), 5);
  const RunResult printed = RUN_LUCERNA("media draft " + path("cup.mtl") + " --quiet");
  EXPECT_EQ(nlohmann::json::parse(printed.out), json("cup.json"));
}

TEST_F(MediaCommand, TheOriginalsFilesHaveItsSize) {
  write("a.mtl", "newmtl wall\nKd 0.5 0.5 0.5\n");
  write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wall\nf 1 2 3\n");
  write("a.json",
        R"({"scene": {"camera": [0, 0, 900], "cameraLookAt": [0, 0, 0], "fov": 30, "lightPos": [1, 1, 3],
      "lightColor": [1, 1, 1], "lightIntensity": 9, "scale": 1}})");
  const std::string options =
      " --technique path --spp 1 --bounces 0 --quiet --json " + path("r.json") + " -o " + path("r.hdr");
  ASSERT_EQ(RUN_LUCERNA("render " + path("a.json") + options).exitCode, 0);
  EXPECT_EQ(json("r.json").at("size"), (std::vector<int>{1920, 1080}));
  ASSERT_EQ(RUN_LUCERNA("render " + path("a.json") + " --size 40x20" + options).exitCode, 0);
  EXPECT_EQ(json("r.json").at("size"), (std::vector<int>{40, 20}));
}

TEST_F(MediaCommand, WhatIsWrongIsOneLine) {
  write("bad.mtl", "newmtl a\nNi high\n");
  write("empty.mtl", "");
  write("a.mtl", "newmtl a\n");
  expectRefused("media draft " + path("gone.mtl"), {"gone.mtl"});
  expectRefused("media draft " + path("bad.mtl"), {"bad.mtl:2"});
  expectRefused("media draft " + path("empty.mtl"), {"empty.mtl", "no material"});
  expectRefused("media draft " + path("a.mtl") + " -o " + path("no/where.json") + " --quiet", {"where.json"});
  expectRefused("media draft", {"MTL"});
  expectRefused("media sort", {"sort"});
  expectRefused("media list --host vulkan", {"vulkan"});
  write("x.json", R"({"scene": {"camera": [0, 0, 5]}})");
  expectRefused("info " + path("x.json"), {"x.json", "scene"});
}

}  // namespace
