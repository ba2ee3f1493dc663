// What people hand to the program and what the machine refuses it: settings, settings files, numbers, standard output,
// descriptors, leftovers. For each wrong input one clear line and the right exit code. Runs the built executable
// off-screen.
#include "base/clock.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

namespace {

namespace fs = std::filesystem;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

class Inputs : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("m.obj",
                  "mtllib m.mtl\nusemtl w\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 4 3 2\nf 1 2 5\n");
    folder_.write("m.mtl", "newmtl w\nKd 0.5 0.5 0.5\n");
  }
  std::string path(const std::string& name) const { return "'" + (folder_.path() / name).string() + "'"; }
  std::string render(const std::string& more) const {
    return "render " + path("m.obj") + " --size 8x6 -o " + path("x.pfm") + " " + more;
  }
  const TempFolder& folder() const { return folder_; }

  void expectRefused(const std::string& arguments, int exitCode, const std::vector<std::string>& parts) const {
    const RunResult result = run("timeout 60 '" LUCERNA_BINARY "' " + arguments);
    EXPECT_EQ(result.exitCode, exitCode) << arguments << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << arguments << "\n" << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << "'" << part << "' is not in: " << result.err;
    EXPECT_FALSE(fs::exists(folder_.path() / "x.pfm")) << arguments;
  }

 private:
  TempFolder folder_;
};

TEST_F(Inputs, SettingsFilesAreReadStrictly) {
  const auto refused = [&](const std::string& content, const std::vector<std::string>& parts) {
    folder().write("s.json", content);
    std::vector<std::string> all = parts;
    all.push_back("s.json");
    expectRefused(render("--settings " + path("s.json")), 2, all);
  };
  refused(R"({"technique":"path","spp":0})", {"\"spp\"", "1 to 4000000000"});
  refused(R"({"technique":"path","spp":-1})", {"\"spp\""});
  refused(R"({"technique":"path","spp":1e300})", {"\"spp\""});
  refused(R"({"technique":"path","spp":1.5})", {"\"spp\""});
  refused(R"({"technique":"path","spp":"4"})", {"\"spp\""});
  refused(R"({"technique":"lpv","spp":4})", {"\"spp\"", "path"});
  refused(R"({"technqiue":"path"})", {"technqiue", "technique"});
  refused(R"({"technique":3})", {"\"technique\"", "text"});
  refused(R"({"settings":"lpv.cells=8"})", {"\"settings\"", "array"});
  refused(R"({"deviations":[1]})", {"\"deviations\"", "texts"});
  refused("[1, 2]", {"an object"});
  refused("{\"settings\":" + std::string(100000, '[') + std::string(100000, ']') + "}", {"nested"});
}

TEST_F(Inputs, NumbersThatAreNoneAreRefused) {
  for (const char* value : {"nan", "NAN", "inf", "-inf", "1e300", "-1e300"}) {
    expectRefused(render(std::string("--technique path --seconds ") + value), 2, {"--seconds"});
    expectRefused(render(std::string("--technique path --error ") + value), 2, {"--error"});
    expectRefused(std::string("radiosity solve ") + path("m.obj") + " " + path("x.pfm") + " --edge " + value, 2,
                  {"--edge"});
    expectRefused(std::string("radiosity solve ") + path("m.obj") + " " + path("x.pfm") + " --memory " + value, 2,
                  {"--memory"});
    expectRefused(std::string("tune ") + path("m.obj") + " -o " + path("x.pfm") + " --frame-time " + value, 2,
                  {"--frame-time"});
    expectRefused(render(std::string("--set radiosity.edge=") + value + " --technique radiosity"), 2,
                  {"radiosity.edge"});
  }
}

TEST_F(Inputs, NumbersBeyondTheirRangeAreRefused) {
  const std::string solve = "radiosity solve " + path("m.obj") + " " + path("x.pfm") + " ";
  for (const char* option : {"--error 0", "--error -1", "--memory -5", "--near-plane -1", "--edge -1",
                             "--save-every -1", "--max-sweeps -1", "--refinements 99"})
    expectRefused(solve + option, 2, {std::string(option).substr(0, std::string(option).find(' '))});
  expectRefused("bench rays " + path("m.obj") + " --split-budget -1", 2, {"--split-budget"});
  expectRefused("tune " + path("m.obj") + " -o " + path("x.pfm") + " --frame-time 0", 2, {"--frame-time"});
}

TEST_F(Inputs, SettingsThatATechniqueDoesNotReadAreOneWarning) {
  const RunResult path_ = RUN_LUCERNA(render("--technique path --spp 1 --set lpv.cells=8 --set radiosity.edge=1"));
  EXPECT_EQ(path_.exitCode, 0) << path_.err;
  EXPECT_EQ(std::count(path_.err.begin(), path_.err.end(), '\n'), 1) << path_.err;
  for (const char* part : {"lpv.cells, radiosity.edge", "path does not use"})
    EXPECT_NE(path_.err.find(part), std::string::npos) << path_.err;
  EXPECT_NE(RUN_LUCERNA(render("--technique direct --set rsm.size=8")).err.find("rsm.size: technique direct"),
            std::string::npos);
  for (const char* read :
       {"irradiance-cache --set cache.transport=gather --set cache.cells=8 --set rsm.size=8",
        "direct --set shadow.size=64 --set exposure=2", "rsm --set rsm.samples=9 --set texture.anisotropy=1"})
    EXPECT_EQ(RUN_LUCERNA(render(std::string("--technique ") + read)).err.find("does not use"), std::string::npos)
        << read;
}

TEST_F(Inputs, ASolutionOfOtherSettingsIsSaidSo) {
  const std::string file = "--technique radiosity --set radiosity.file=" + path("s.lit") + " ";
  ASSERT_EQ(RUN_LUCERNA(render(file + "--set radiosity.edge=1 --set radiosity.resolution=16")).exitCode, 0);
  fs::remove(folder().path() / "x.pfm");
  expectRefused(render(file + "--set radiosity.edge=0.25"), 2,
                {"s.lit", "radiosity.edge=1 (asked for: radiosity.edge=0.25)", "another file"});
  expectRefused(render(file + "--set radiosity.refinements=1"), 2,
                {"s.lit", "radiosity.refinements=0 (asked for: radiosity.refinements=1)"});
  const RunResult shown = RUN_LUCERNA(render(file));
  EXPECT_EQ(shown.exitCode, 0) << shown.err;
  for (const char* part : {"shown as solved", "radiosity.edge=1", "radiosity.resolution=16"})
    EXPECT_NE(shown.err.find(part), std::string::npos) << shown.err;
  EXPECT_EQ(
      RUN_LUCERNA(render(file + "--set radiosity.edge=1 --set radiosity.resolution=16")).err.find("shown as solved"),
      std::string::npos);
}

TEST_F(Inputs, PicturesOfOtherFormatsAreOneLine) {
  folder().write(
      "a.xpm",
      "/* XPM */\nstatic char *a[] = {\n\"2 2 2 1\",\n\"a c #000000\",\n\"b c #ffffff\",\n\"ab\",\n\"ba\"};\n");
  expectRefused("compare " + path("a.xpm") + " " + path("a.xpm"), 2, {"a.xpm", "png, jpg, tga and bmp"});
}

// Assimp calls itself once a level.
TEST_F(Inputs, ModelsNestedWithoutEndAreOneLine) {
  const auto repeated = [](const std::string& part) {
    std::string text;
    for (int i = 0; i < 100000; ++i) text += part;
    return text;
  };
  folder().write(
      "a.dae",
      "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
      "version=\"1.4.1\"><asset/><library_visual_scenes><visual_scene id=\"s\">" +
          repeated("<node>") + repeated("</node>") +
          "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>");
  folder().write("a.x", "xof 0303txt 0032\n" + repeated("Frame a {\n") + repeated("}\n"));
  folder().write("a.ogex", repeated("Node {") + repeated("}"));
  folder().write("a.ac", "AC3Db\nMATERIAL \"\" rgb 1 1 1  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0\n" +
                             repeated("OBJECT group\nkids 1\n") + "OBJECT poly\nkids 0\n");
  folder().write("a.gltf", "{\"extras\":" + repeated("[") + repeated("]") + "}");
  folder().write("a.json", "{\"model\":" + repeated("[") + repeated("]") + "}");
  for (const char* name : {"a.dae", "a.x", "a.ogex", "a.ac", "a.gltf", "a.json"})
    expectRefused("info " + path(name), 2, {name});
}

TEST_F(Inputs, AFullStandardOutputIsNoSuccess) {
  for (const std::string command : {"info", "media list", "--help", "render --help"}) {
    const RunResult result = run("'" LUCERNA_BINARY "' " + command + " > /dev/full");
    EXPECT_EQ(result.exitCode, 3) << command << result.err;
    EXPECT_NE(result.err.find("No space left"), std::string::npos) << command << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

TEST_F(Inputs, TooFewDescriptorsAreToldAsSuch) {
  bool met = false;
  for (int most = 4; most < 24; ++most) {
    const RunResult result = run("ulimit -n " + std::to_string(most) + "; '" LUCERNA_BINARY "' " + render(""));
    EXPECT_EQ(result.err.find("is missing"), std::string::npos) << most << result.err;
    met |= result.exitCode == 3 && result.err.find("Too many open files") != std::string::npos;
    if (result.exitCode == 0) break;
  }
  EXPECT_TRUE(met);
}

TEST_F(Inputs, LinesOfErrorsAreNotBrokenByWhatFilesHold) {
  folder().write("a.json", "{\"mo\\ndel\": 1}");
  expectRefused("info " + path("a.json"), 2, {"unknown key"});
}

// Found out before the work, not after it.
TEST_F(Inputs, WhatCannotBeWrittenIsToldAtOnce) {
  fs::create_directory(folder().path() / "folder");
  for (const std::string& command :
       {"radiosity solve " + path("m.obj") + " " + path("folder"),
        "radiosity solve --fidelity original " + path("m.obj") + " " + path("folder"),
        "radiosity solve " + path("m.obj") + " " + path("none/x.sol"),
        "render " + path("m.obj") + " --technique path --seconds 50 -o " + path("none/x.pfm"),
        "render " + path("m.obj") + " --technique path --seconds 50 -o " + path("x.pfm") + " --json " + path("folder"),
        "tune " + path("m.obj") + " --frame-time 16 -o " + path("folder")}) {
    const auto begun = lucerna::Clock::now();
    const RunResult result = run("timeout 60 '" LUCERNA_BINARY "' " + command);
    EXPECT_EQ(result.exitCode, 2) << command << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find("cannot be written"), std::string::npos) << result.err;
    EXPECT_EQ(result.out.find("hemicube"), std::string::npos) << "it had begun: " << result.out;
    EXPECT_LT(lucerna::secondsSince(begun), 40.0) << command;
    EXPECT_FALSE(fs::exists(folder().path() / "x.pfm"));
    EXPECT_FALSE(fs::exists(folder().path() / "folder.rows"));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder().path() / "folder"), fs::directory_iterator()), 0);
}

TEST_F(Inputs, ABlackPictureIsSaidSo) {
  folder().write("wall.obj",
                 "mtllib wall.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 -9\nv 1 0 -9\nv 0 1 -9\n"
                 "usemtl grey\nf 1 2 3\nusemtl lamp\nf 6 5 4\n");
  folder().write("wall.mtl", "newmtl grey\nKd 0.5 0.5 0.5\nnewmtl lamp\nKe 9 9 9\n");
  const std::string away =
      path("wall.obj") + " --size 16x16 --camera 0.3,0.3,2,0.3,0.3,0,20 ";  // the lamp is behind it
  for (const char* technique : {"path --spp 4", "irradiance-cache"}) {
    const RunResult result =
        run("'" LUCERNA_BINARY "' render " + away + "-o " + path("a.png") + " --technique " + technique);
    EXPECT_EQ(result.exitCode, 0) << technique;
    EXPECT_NE(result.err.find("the picture is black"), std::string::npos) << technique << ": " << result.err;
  }
  expectRefused("bench error " + away + "--quiet --reference-spp 4 --small --frames 1 --techniques direct --out " +
                    path("b") + " --references " + path("r"),
                2, {"reference", "black", "--camera"});
}

TEST_F(Inputs, ARefusedReportMakesNoFolder) {
  expectRefused("bench all --out " + path("report") + " --parts nonsense", 2, {"nonsense", "stability"});
  expectRefused("bench all --out " + path("report") + " --scale 9", 2, {"--scale"});
  EXPECT_FALSE(fs::exists(folder().path() / "report"));
}

}  // namespace
