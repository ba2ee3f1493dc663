// The command line as a contract: fields of --json, files written, and for every wrong input one clear line,
// the right exit code and nothing half-written. Runs the built executable off-screen.
#include "base/image.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"
#include "support/test_host.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace {

namespace fs = std::filesystem;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

// A floor and a wall that meet, lit by the default sun.
const char* kRoomScene =
    "mtllib scene.mtl\n"
    "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 3 -2\nv 2 3 -2\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl white\nf 1/1 4/4 3/3 2/2\nusemtl red\nf 1/1 2/2 6/3 5/4\n";
const char* kMaterials = "newmtl white\nKd 0.8 0.8 0.8\nnewmtl red\nKd 0.7 0.1 0.1\n";

class CommandLine : public ::testing::Test {
 protected:
  void SetUp() override {
    write("scene.obj", kRoomScene);
    write("scene.mtl", kMaterials);
    write("path.txt", "p 4 2 4 d -1 -0.3 -1 u 0 1 0\np 3 2 5 d -0.8 -0.3 -1 u 0 1 0\n");
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(path(name))); }
  std::string scene() const { return path("scene.obj"); }

  /// Exit code, one line on standard error that holds every given part, and no file of that name.
  void expectRefused(const std::string& arguments, int exitCode, const std::vector<std::string>& parts,
                     const std::string& notWritten = {}) const {
    const RunResult result = RUN_LUCERNA(arguments);
    EXPECT_EQ(result.exitCode, exitCode) << arguments << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << arguments << "\n" << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << "'" << part << "' is not in: " << result.err;
    if (notWritten.empty()) return;
    EXPECT_FALSE(fs::exists(path(notWritten))) << notWritten;
  }

 private:
  TempFolder folder_;
};

TEST_F(CommandLine, HelpListsEverySubcommandAndTheirOptions) {
  const RunResult top = RUN_LUCERNA("--help");
  EXPECT_EQ(top.exitCode, 0);
  for (const char* name : {"walk", "render", "info", "bench tables", "bench pictures"}) {
    EXPECT_NE(top.out.find(std::string(name).substr(0, std::string(name).find(' '))), std::string::npos) << name;
    const RunResult help = RUN_LUCERNA(std::string(name) + " --help");
    EXPECT_EQ(help.exitCode, 0);
    for (const char* option : {"--host", "--json", "--quiet"})
      EXPECT_NE(help.out.find(option), std::string::npos) << name << option;
  }
}

TEST_F(CommandLine, HelpOfACommandIsItsOptions) {
  for (const std::string command : {"", "render", "radiosity solve", "bench error", "lab start"}) {
    const RunResult help = RUN_LUCERNA("help " + command);
    EXPECT_EQ(help.exitCode, 0) << help.err;
    EXPECT_EQ(help.out, RUN_LUCERNA(command + " --help").out) << command;
  }
  const RunResult unknown = RUN_LUCERNA("help rendr");
  EXPECT_EQ(unknown.exitCode, 2);
  EXPECT_NE(unknown.err.find("rendr: no such command; nearest: render, "), std::string::npos) << unknown.err;
}

TEST_F(CommandLine, WrongWordsNameTheNearest) {
  for (const auto& [words, nearest] :
       {std::pair<std::string, std::string>{"rendr", "rendr: no such subcommand; nearest: render, "},
        {"radiosity slove", "slove: no such subcommand; nearest: solve, "},
        {"bench eror", "eror: no such subcommand; nearest: error, "},
        {"bench tabels", "tabels: no such subcommand; nearest: tables, "},
        {"lab chek", "chek: no such subcommand; nearest: check, "},
        {"info --jsno a", "--jsno: no such option; nearest: --json, "},
        {"--hepl", "--hepl: no such option; nearest: --help, "},
        {"render " + scene() + " -o " + path("y.pfm") + " --deviation lpv.truncat=on",
         "lpv.truncat=on: unknown; nearest: lpv.truncate, "},
        {"radiosity solve " + scene() + " " + path("y.sol") + " --deviation centroid=on",
         "centroid=on: unknown; nearest: radiosity.centroid, "},
        {"walk corn", "no shipped scene; nearest: cornell, "}}) {
    const RunResult result = RUN_LUCERNA(words);
    EXPECT_EQ(result.exitCode, 2) << words;
    EXPECT_NE(result.err.find(nearest), std::string::npos) << words << ": " << result.err;
    EXPECT_LT(result.err.size(), nearest.size() + 160) << result.err;
  }
}

TEST_F(CommandLine, AFolderOfAShippedScenesNameIsNotMeant) {
  std::filesystem::create_directory(path("cornell"));
  const RunResult shown = run("cd '" + path(".") + "' && '" LUCERNA_BINARY "' info cornell");
  EXPECT_EQ(shown.exitCode, 0) << shown.err;
}

TEST_F(CommandLine, OptionsOfTheEnvironmentFollowThoseOfTheCommand) {
  const RunResult first = run("LUCERNA_OPTIONS='--size 24x12 --quiet' '" LUCERNA_BINARY "' render '" + scene() +
                              "' --technique direct -o '" + path("small.png") + "'");
  ASSERT_EQ(first.exitCode, 0) << first.err;
  EXPECT_EQ(first.out, "");
  const lucerna::Bitmap picture = lucerna::readBitmap(path("small.png"));
  EXPECT_EQ(picture.width, 24);
  EXPECT_EQ(picture.height, 12);
}

TEST_F(CommandLine, InfoReportsHostAndScene) {
  const RunResult result = RUN_LUCERNA("info " + scene() + " --json " + path("info.json"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto info = json("info.json");
  EXPECT_EQ(info.at("host"), lucerna::nameOf(lucerna::test::testHost()));
  EXPECT_EQ(info.at("triangles"), 4);
  EXPECT_GE(info.at("vertices"), 6);
  EXPECT_EQ(info.at("materials"), 2);
  EXPECT_EQ(info.at("features").at("alphaMasks"), false);
  EXPECT_EQ(info.at("features").at("indirect"), true);
  EXPECT_NE(info.at("renderer").get<std::string>(), "");
}

TEST_F(CommandLine, RenderWritesEveryFormatWithTheSameMean) {
  for (const char* extension : {"png", "hdr", "exr", "pfm"}) {
    const std::string out = path(std::string("picture.") + extension);
    const RunResult result = RUN_LUCERNA("render " + scene() + " --size 48x32 --set cache.cells=8 -o " + out +
                                         " --json " + path("render.json"));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto render = json("render.json");
    EXPECT_EQ(render.at("technique"), "irradiance-cache");
    EXPECT_EQ(render.at("fidelity"), "corrected");
    EXPECT_TRUE(render.at("deviations").is_array());
    EXPECT_GT(render.at("seconds"), 0.0);
    const lucerna::Image image = lucerna::readImage(out);
    ASSERT_EQ(image.width, 48);
    ASSERT_EQ(image.height, 32);
    if (std::string(extension) == "png") continue;  // tone mapped
    const glm::dvec3 mean = lucerna::meanOf(image);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(render.at("mean").at(static_cast<std::size_t>(c)).get<double>(), mean[c], 0.01 * mean[c] + 1e-6)
          << extension;
  }
}

TEST_F(CommandLine, ComponentsAddUp) {
  glm::dvec3 means[3];
  const char* names[] = {"all", "direct", "indirect"};
  for (int i = 0; i < 3; ++i) {
    const RunResult result =
        RUN_LUCERNA("render " + scene() + " --size 48x32 --technique lpv --set lpv.cells=8 --component " + names[i] +
                    " -o " + path("x.pfm"));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    means[i] = lucerna::meanOf(lucerna::readImage(path("x.pfm")));
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(means[0][c], means[1][c] + means[2][c], 1e-5 * means[0][c]);
  EXPECT_GT(means[2].x, 0.0);
}

TEST_F(CommandLine, DeviationsAreReported) {
  const auto deviations = [&](const std::string& arguments) {
    const RunResult result = RUN_LUCERNA("render " + scene() + " --size 32x24 --set lpv.cells=8 -o " + path("x.pfm") +
                                         " --json " + path("render.json") + arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    const auto render = json("render.json");
    return std::pair(render.at("fidelity").get<std::string>(), render.at("deviations").get<std::vector<std::string>>());
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(deviations(""), std::pair(std::string("corrected"), Names{}));
  EXPECT_EQ(deviations(" --deviation lpv.side-directions=on"),
            std::pair(std::string("corrected"), Names{"lpv.side-directions"}));
  const auto [fidelity, original] = deviations(" --fidelity original");
  EXPECT_EQ(fidelity, "original");
  // What --help marks with a star.
  const std::string help = RUN_LUCERNA("render --help").out;
  std::istringstream lines(help.substr(help.find("\nDeviations (")));
  Names marked;
  int known = 0;
  for (std::string line, star, name; std::getline(lines, line);) {
    std::istringstream words(line);
    if (!(words >> star)) continue;
    const bool isMarked = star.starts_with("*");
    if (isMarked || star == "+") words >> name;
    else name = star;
    if (!name.starts_with("lpv.") && !name.starts_with("rsm.") && !name.starts_with("path.") &&
        !name.starts_with("radiosity."))
      continue;
    ++known;
    if (isMarked) marked.push_back(name);
  }
  EXPECT_EQ(original, marked);
  EXPECT_GT(marked.size(), 5u);
  EXPECT_GT(known, static_cast<int>(marked.size()));
  Names without = marked;
  std::erase(without, "lpv.unjoined");
  EXPECT_EQ(deviations(" --fidelity original --deviation lpv.unjoined=off").second, without);
  // The text and the program published with it are two.
  const auto [thesis, ofThesis] = deviations(" --fidelity thesis");
  EXPECT_EQ(ofThesis, original);
  const Names demo = deviations(" --fidelity demo").second;
  EXPECT_EQ(std::count(demo.begin(), demo.end(), "lpv.sum-cascades"), 1);
  EXPECT_EQ(std::count(original.begin(), original.end(), "lpv.sum-cascades"), 0);
  expectRefused("render " + scene() + " --fidelity faithful -o " + path("y.pfm"), 2, {"faithful", "thesis", "demo"},
                "y.pfm");
  expectRefused("render " + scene() + " --deviation lpv.nothing=on -o " + path("y.pfm"), 2,
                {"lpv.nothing", "nearest: lpv."}, "y.pfm");
  expectRefused("render " + scene() + " --deviation lpv.truncate=maybe -o " + path("y.pfm"), 2,
                {"lpv.truncate=maybe", "=on or"}, "y.pfm");
}

// Beside a box the floor goes over into the sky without a step, whether the sky lights the floor or not.
TEST_F(CommandLine, TheStudiosFloorFadesIntoItsSky) {
  std::ofstream(path("box.obj")) << "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n"
                                    "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 4 3 7 8\nf 1 4 8 5\nf 2 6 7 3\n";
  for (const std::string technique : {"direct", "lpv", "irradiance-cache"}) {
    const RunResult result = RUN_LUCERNA("render " + path("box.obj") + " --technique " + technique +
                                         " --size 96x54 --pixel-samples 1 -o " + path("box.pfm"));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const lucerna::Image picture = lucerna::readImage(path("box.pfm"));
    for (const int column : {1, 94})
      for (int row = 0; row + 1 < picture.height; ++row) {
        const auto at = static_cast<std::size_t>(row * picture.width + column);
        const float upper = picture.pixels[at].y,
                    lower = picture.pixels[at + static_cast<std::size_t>(picture.width)].y;
        EXPECT_NEAR(upper / lower, 1.0f, technique == "lpv" ? 0.06f : 0.02f) << technique << " row " << row;
      }
  }
}

TEST_F(CommandLine, WalkWritesPicturesAndStageTimes) {
  const RunResult result = RUN_LUCERNA("walk " + scene() + " --keys " + path("path.txt") +
                                       " --technique lpv --set frame.reuse=off --record " + path("out") +
                                       " --frames 3 --size 64x36 --json " + path("walk.json"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(std::distance(fs::directory_iterator(path("out")), fs::directory_iterator()), 3);
  const auto walk = json("walk.json");
  EXPECT_EQ(walk.at("frames"), 3);
  EXPECT_GT(walk.at("gpu_bytes"), 0);
  for (const char* stage : {"shadow", "rsm", "injection", "geometry volume", "propagation", "shading"}) {
    ASSERT_TRUE(walk.at("stages").contains(stage)) << stage;
    EXPECT_EQ(walk.at("stages").at(stage).at("count"), 3) << stage;
    EXPECT_GT(walk.at("stages").at(stage).at("median_ms"), 0.0) << stage;
    EXPECT_GE(walk.at("stages").at(stage).at("p95_ms"), walk.at("stages").at(stage).at("median_ms")) << stage;
  }
}

TEST_F(CommandLine, WalkPathTracesEachPictureToItsEnd) {
  const RunResult result = RUN_LUCERNA("walk " + scene() + " --keys " + path("path.txt") +
                                       " --technique path --set path.samples=2 --record " + path("out") +
                                       " --frames 2 --size 32x18 --json " + path("walk.json"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(std::distance(fs::directory_iterator(path("out")), fs::directory_iterator()), 2);
  const auto walk = json("walk.json");
  EXPECT_EQ(walk.at("technique"), "path");
  for (const char* stage : {"path tracing", "film", "tone mapping"})
    EXPECT_EQ(walk.at("stages").at(stage).at("count"), 2) << stage;
  for (const char* stage : {"shadow", "shading", "irradiance cache"})
    EXPECT_FALSE(walk.at("stages").contains(stage)) << stage;
}

TEST_F(CommandLine, DirectLightLeavesTheIndirectStagesOut) {
  const RunResult result =
      RUN_LUCERNA("walk " + scene() + " --keys " + path("path.txt") + " --technique direct --record " + path("out") +
                  " --frames 1 --size 64x36 --json " + path("walk.json"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto walk = json("walk.json");
  for (const char* stage : {"rsm", "injection", "geometry volume", "propagation"})
    EXPECT_FALSE(walk.at("stages").contains(stage)) << stage;
  const auto& left = walk.at("left_out");
  EXPECT_NE(std::find(left.begin(), left.end(), "light propagation volume"), left.end());
}

TEST_F(CommandLine, RsmReportsWhatInterpolationSaved) {
  for (const char* command : {"render ", "walk "}) {
    const bool walks = std::string(command) == "walk ";
    const RunResult result = RUN_LUCERNA(
        command + scene() + " --technique rsm --size 64x36 --json " + path("rsm.json") +
        (walks ? " --frames 2 --keys " + path("path.txt") + " --record " + path("out") : " -o " + path("x.pfm")));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_NE(result.out.find("refused by interpolation"), std::string::npos) << result.out;
    const auto report = json("rsm.json");
    const auto& rsm = report.at("rsm");
    EXPECT_GT(rsm.at("pixels"), 0);
    EXPECT_LE(rsm.at("pixels"), 64 * 36);
    EXPECT_LE(rsm.at("refused"), rsm.at("gathered"));
    EXPECT_LE(rsm.at("gathered"), rsm.at("pixels").get<int>() + 16 * 9);
    if (!walks) continue;
    for (const char* stage : {"rsm", "geometry", "gather low", "interpolation", "gather full", "shading"})
      EXPECT_TRUE(report.at("stages").contains(stage)) << stage;
  }
  // Other techniques have nothing of it.
  ASSERT_EQ(RUN_LUCERNA("render " + scene() + " --technique direct --size 32x32 --json " + path("direct.json") +
                        " -o " + path("x.pfm"))
                .exitCode,
            0);
  const auto direct = json("direct.json");
  EXPECT_FALSE(direct.contains("rsm"));
  const auto& left = direct.at("left_out");
  EXPECT_NE(std::find(left.begin(), left.end(), "rsm gather"), left.end());
}

TEST_F(CommandLine, ASettingOfOneTechniqueChoosesIt) {
  const std::string common =
      "render " + scene() + " --size 32x24 --component indirect --json " + path("x.json") + " -o " + path("x.pfm");
  const auto mean = [&](const std::string& arguments) {
    const RunResult result = RUN_LUCERNA(common + arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return lucerna::meanOf(lucerna::readImage(path("x.pfm"))).x;
  };
  const double usual = mean(" --technique lpv --set lpv.cells=8"),
               flux = mean(" --technique lpv --set lpv.cells=8 --set lpv.lookup=flux --set lpv.lookup-offset=0");
  EXPECT_EQ(usual, flux);
  EXPECT_EQ(mean(" --set lpv.cells=8"), flux);
  EXPECT_EQ(json("x.json").at("technique"), "lpv");
  EXPECT_FALSE(json("x.json").contains("cache"));
  EXPECT_EQ(mean(" --set cache.cells=8"),
            mean(" --technique irradiance-cache --set cache.cells=8 --set cache.bounces=all"));
  EXPECT_TRUE(json("x.json").contains("cache"));
  mean(" --set texture.mipmaps=on");  // read by several techniques
  EXPECT_EQ(json("x.json").at("technique"), "irradiance-cache");
  EXPECT_EQ(mean(" --set cache.cells=8 --set cache.bounce-cells=16"),
            mean(" --set cache.cells=8 --set cache.transport=gather"));
  const std::string published = " --set lpv.cells=8 --set lpv.lookup=published";
  EXPECT_GT(mean(published), 1.2 * flux);
  EXPECT_EQ(mean(published), mean(published + " --set lpv.lookup-offset=0.5"));
  EXPECT_EQ(mean(" --deviation path.schlick=on --spp 1") > 0.0, true);
  EXPECT_EQ(json("x.json").at("technique"), "path");
  for (const char* bounces : {"1", "all"}) {
    const RunResult result = RUN_LUCERNA(
        common + " --set cache.cells=8 --set cache.samples=32 --set cache.rays=8 --set cache.bounces=" + bounces);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_NE(result.out.find("records, 32 paths each"), std::string::npos) << result.out;
    const auto report = json("x.json");
    EXPECT_GT(report.at("cache").at("records"), 10);
    EXPECT_EQ(report.at("cache").at("waiting"), 0);
    EXPECT_EQ(report.at("cache").at("without_room"), 0);
    EXPECT_EQ(report.at("cache").at("paths_of_each"), 32);
    const auto& left = report.at("left_out");
    EXPECT_NE(std::find(left.begin(), left.end(), "reflective shadow map"), left.end());
  }
  const std::string end = " -o " + path("y.pfm"), begin = "render " + scene() + " --size 32x24 ";
  expectRefused(begin + "--set cache.transport=rain" + end, 2, {"cache.transport", "rain", "gather", "rays"}, "y.pfm");
  expectRefused(begin + "--set lpv.lookup=none" + end, 2, {"lpv.lookup", "none", "flux", "published"}, "y.pfm");
  for (const char* rays : {"3", "0", "128", "-1", "many"})
    expectRefused(begin + "--set cache.rays=" + rays + end, 2, {"cache.rays", rays}, "y.pfm");
  for (const char* samples : {"0", "nan"})
    expectRefused(begin + "--set cache.samples=" + samples + end, 2, {"cache.samples", samples}, "y.pfm");
  expectRefused(begin + "--set lpv.bounces=all" + end, 2, {"lpv.bounces", "all", "1 to 64"}, "y.pfm");
  expectRefused(begin + "--set cache.bounces=0" + end, 2, {"cache.bounces", "0"}, "y.pfm");
  expectRefused(begin + "--set frame.reuse=maybe" + end, 2, {"frame.reuse", "maybe"}, "y.pfm");
}

TEST_F(CommandLine, ACommandOfAMissingProgramNamesItsTarget) {
  fs::copy_file(LUCERNA_BINARY, path("lucerna"));
  const auto alone = [&](const std::string& arguments) {
    return lucerna::test::run(path("lucerna") + " " + arguments);
  };
  EXPECT_EQ(alone("--version").exitCode, 0);
  for (const auto& [command, program] :
       {std::pair{"bench error x.json", "lucerna-bench"}, std::pair{"bench tables --original lpv", "lucerna-originals"},
        std::pair{"lab list", "lucerna-labs"}}) {
    const RunResult result = alone(command);
    EXPECT_EQ(result.exitCode, 3) << command;
    EXPECT_NE(result.err.find(std::string("--target ") + program), std::string::npos) << result.err;
  }
  // Help, completions and manual name the commands all the same.
  EXPECT_NE(alone("--help").out.find("bench"), std::string::npos);
  EXPECT_NE(alone("completion bash").out.find("bench"), std::string::npos);
  EXPECT_EQ(alone("completion bash").out.find("bench error"), std::string::npos);
  EXPECT_NE(RUN_LUCERNA("completion bash").out.find("bench error"), std::string::npos);
}

TEST_F(CommandLine, AWalkSaysWhatIsMadeOnce) {
  for (const char* reuse : {"on", "off"}) {
    const RunResult result =
        RUN_LUCERNA("walk " + scene() + " --keys " + path("path.txt") + " --set frame.reuse=" + reuse + " --record " +
                    path("out") + " --frames 3 --size 64x36 --json " + path("walk.json"));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto stages = json("walk.json").at("stages");
    EXPECT_EQ(stages.at("shading").at("ran"), stages.at("shading").at("frames"));
    EXPECT_EQ(stages.at("shading").at("saved_ms"), 0.0);
    const int frames = stages.at("shadow").at("frames");
    EXPECT_GE(frames, 3);
    if (reuse == std::string("off")) {
      EXPECT_EQ(stages.at("shadow").at("ran"), frames);
      EXPECT_EQ(stages.at("shadow").at("saved_ms"), 0.0);
    } else {
      EXPECT_LE(stages.at("shadow").at("ran"), 1);
      EXPECT_GT(stages.at("shadow").at("saved_ms"), 0.0);
    }
    EXPECT_NE(result.out.find("ran in frames"), std::string::npos) << result.out;
  }
}

// ---------------------------------------------------------------------------------------------------- wrong input

TEST_F(CommandLine, WrongOptionsAreRefused) {
  expectRefused("", 2, {"--help"});
  expectRefused("paint", 2, {"paint"});
  expectRefused("render " + scene() + " --colour red -o " + path("x.png"), 2, {"--colour"}, "x.png");
  expectRefused("render " + scene(), 2, {"--output"});
  expectRefused("render " + scene() + " --size 0x0 -o " + path("x.png"), 2, {"--size", "0"}, "x.png");
  expectRefused("render " + scene() + " --size 64 -o " + path("x.png"), 2, {"--size", "WIDTHxHEIGHT"}, "x.png");
  expectRefused("render " + scene() + " --size 64x-2 -o " + path("x.png"), 2, {"--size", "-2"}, "x.png");
  expectRefused("render " + scene() + " --technique magic -o " + path("x.png"), 2, {"magic", "direct", "lpv"}, "x.png");
  expectRefused("render " + scene() + " --component half -o " + path("x.png"), 2, {"half", "indirect"}, "x.png");
  expectRefused("render " + scene() + " --set lpv.cels=3 -o " + path("x.png"), 2, {"lpv.cels", "lpv.cells"}, "x.png");
  expectRefused("render " + scene() + " --set lpv.cells=many -o " + path("x.png"), 2, {"lpv.cells", "many"}, "x.png");
  expectRefused("render " + scene() + " --set lpv.cells=nan -o " + path("x.png"), 2, {"lpv.cells"}, "x.png");
  expectRefused("render " + scene() + " --set exposure=nan -o " + path("x.png"), 2, {"exposure"}, "x.png");
  expectRefused("render " + scene() + " --technique rsm --set rsm.weight=heavy -o " + path("x.png"), 2,
                {"rsm.weight", "heavy", "published"}, "x.png");
  expectRefused("render " + scene() + " --technique rsm --set rsm.radius=0 -o " + path("x.png"), 2, {"rsm.radius"},
                "x.png");
  expectRefused("render " + scene() + " --host vulkan -o " + path("x.png"), 2, {"vulkan", "osmesa"}, "x.png");
  expectRefused("render " + scene() + " --camera 1,2,3 -o " + path("x.png"), 2, {"--camera", "px,py,pz"}, "x.png");
  expectRefused("render " + scene() + " -o " + path("x.bmp"), 2, {"x.bmp", "png"}, "x.bmp");
  expectRefused("walk " + scene() + " --frames 0", 2, {"--frames"});
  expectRefused("walk " + scene() + " --keys " + path("path.txt") + " --views 5:9999 --record " + path("w"), 2,
                {"--views", "0:200"}, "w");
}

TEST_F(CommandLine, WrongFilesAreRefused) {
  const std::string tail = " --size 32x32 -o " + path("x.png");
  expectRefused("render " + path("nothing.obj") + tail, 2, {"nothing.obj"}, "x.png");
  fs::create_directory(path("folder"));
  expectRefused("render " + path("folder") + tail, 2, {"folder"}, "x.png");
  write("cut.obj",
        std::string(kRoomScene).substr(0, std::string(kRoomScene).rfind("f ") + 5));  // the last face is cut short
  expectRefused("render " + path("cut.obj") + tail, 2, {"cut.obj"}, "x.png");
  write("noise.obj", std::string("\0\1\2\xff\xfe garbage", 14));
  expectRefused("render " + path("noise.obj") + tail, 2, {"noise.obj"}, "x.png");
  write("bad.txt", "p 4 2 4 d -1 -0.3 -1 u 0 1 0\np 3 2 5 d -0.8 -0.3 u 0 1 0\n");
  expectRefused("walk " + scene() + " --keys " + path("bad.txt") + " --record " + path("w"), 2, {"bad.txt", "2"}, "w");
  write("file", "in the way");
  expectRefused("walk " + scene() + " --record " + path("file"), 2, {"file", "folder"});
  expectRefused("render " + scene() + " --size 32x32 -o " + path("no/such/folder/x.png"), 2, {"x.png"});
  expectRefused("render " + scene() + " --size 32x32 -o " + path("y.png") + " --json " + path("no/such/x.json"), 2,
                {"x.json"});
}

TEST_F(CommandLine, ATextureThatIsNoImageIsOneWarning) {
  write(
      "scene.mtl",
      "newmtl white\nKd 0.8 0.8 0.8\nmap_Kd broken.png\nnewmtl red\nKd 0.7 0.1 0.1\nmap_Kd textures\\\\missing.png\n");
  write("broken.png", "this is no picture");
  const RunResult result = RUN_LUCERNA("render " + scene() + " --size 32x32 --set cache.cells=8 -o " + path("x.png"));
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_TRUE(fs::exists(path("x.png")));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;
  EXPECT_NE(result.err.find("broken.png"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("missing.png"), std::string::npos) << result.err;
  EXPECT_EQ(RUN_LUCERNA("render " + scene() + " --quiet --size 32x32 --set cache.cells=8 -o " + path("x.png")).err, "");
}

TEST_F(CommandLine, AnOldDriverIsAMissingCapability) {
  const RunResult result =
      run("MESA_GL_VERSION_OVERRIDE=3.3 '" LUCERNA_BINARY "' render " + scene() + " --size 32x32 -o " + path("x.png"));
  EXPECT_EQ(result.exitCode, 3) << result.err;
  EXPECT_NE(result.err.find("4.3"), std::string::npos) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_FALSE(fs::exists(path("x.png")));
}

TEST_F(CommandLine, AWindowWithoutADisplayIsAMissingCapability) {
  const RunResult result =
      run("env -u DISPLAY -u WAYLAND_DISPLAY '" LUCERNA_BINARY "' walk " + scene() + " --host window");
  EXPECT_EQ(result.exitCode, 3) << result.err;
  EXPECT_NE(result.err.find("display"), std::string::npos) << result.err;
}

TEST_F(CommandLine, InterruptedWalkKeepsWholePicturesAndItsTable) {
  // As soon as there are pictures: how long that takes depends on what the driver has compiled before.
  const RunResult result =
      run("'" LUCERNA_BINARY "' walk " + scene() + " --keys " + path("path.txt") + " --record " + path("out") +
          " --frames 100000 --size 320x180 --json " + path("walk.json") + " & pid=$!; for i in $(seq 6000); do [ -e " +
          path("out") + "/frame_0003.png ] && break; sleep 0.01; done; kill -INT $pid; wait $pid");
  EXPECT_EQ(result.exitCode, 130) << result.err;
  ASSERT_TRUE(fs::exists(path("walk.json"))) << result.err;
  const int frames = json("walk.json").at("frames");
  EXPECT_GE(frames, 3);
  EXPECT_EQ(std::distance(fs::directory_iterator(path("out")), fs::directory_iterator()), frames);
  for (const auto& entry : fs::directory_iterator(path("out"))) EXPECT_EQ(lucerna::readBitmap(entry.path()).width, 320);
}

TEST_F(CommandLine, PathTracingSaysHowGoodThePictureIs) {
  const std::string common = "render " + scene() + " --technique path --size 8x8 ";
  ASSERT_EQ(RUN_LUCERNA(common + "--spp 6 -o " + path("whole.pfm") + " --json " + path("whole.json")).exitCode, 0);
  const auto whole = json("whole.json");
  EXPECT_EQ(whole.at("spp"), 6.0);
  EXPECT_GT(whole.at("standard_error"), 0.0);
  EXPECT_GT(whole.at("mean").at(0), 0.0);
  EXPECT_GE(whole.at("seconds"), 0.0);
  // With a break, by a checkpoint: the same picture.
  const std::string checkpoint = " --checkpoint " + path("film");
  ASSERT_EQ(RUN_LUCERNA(common + "--spp 2 -o " + path("a.pfm") + checkpoint).exitCode, 0);
  ASSERT_EQ(RUN_LUCERNA(common + "--spp 6 -o " + path("b.pfm") + checkpoint).exitCode, 0);
  EXPECT_EQ(lucerna::readImage(path("b.pfm")).pixels, lucerna::readImage(path("whole.pfm")).pixels);
  expectRefused(common + "--spp 6 --seed 5 -o " + path("no.pfm") + checkpoint, 2, {"film", "another"}, "no.pfm");
  // Other rules that stop it.
  ASSERT_EQ(RUN_LUCERNA(common + "--error 0.2 -o " + path("c.png") + " --json " + path("error.json")).exitCode, 0);
  EXPECT_LE(json("error.json").at("relative_error"), 0.2);
  ASSERT_EQ(RUN_LUCERNA(common + "--seconds 0.01 -o " + path("d.png") + " --json " + path("seconds.json")).exitCode, 0);
  EXPECT_GE(json("seconds.json").at("spp"), 1.0);
  EXPECT_LT(json("seconds.json").at("seconds"), 20.0);
  // Of whole passes, whenever it is stopped: this picture is one tile, so all pixels have the same samples.
  for (const char* seconds : {"0.05", "0.11", "0.17", "0.23", "0.31"}) {
    ASSERT_EQ(RUN_LUCERNA(common + "--seconds " + std::string(seconds) + " -o " + path("d.png") + " --json " +
                          path("seconds.json"))
                  .exitCode,
              0);
    const double samples = json("seconds.json").at("spp");
    EXPECT_EQ(samples, std::round(samples)) << seconds;
  }
}

// By --error it is a film of two halves, which know how evenly their points are spread: two pictures of other seeds
// differ by what each says, and not by the half of it.
TEST_F(CommandLine, PathTracingStopsAtTheErrorThatThePictureHas) {
  const std::string common =
      "render '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --technique path --size 96x96 --error 0.08 ";
  struct Stopped {
    double error = 0.0, samples = 0.0;  ///< from two pictures: root mean square over the mean; samples a pixel
    double said = 0.0, most = 0.0;  ///< as said: mean and largest of the two
  };
  const auto stopped = [&](const std::string& denoise) {
    Stopped result;
    std::array<lucerna::Image, 2> pictures;
    double mean = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < pictures.size(); ++k) {
      EXPECT_EQ(RUN_LUCERNA(common + denoise + "--seed " + std::to_string(k) + " -o " + path("x.pfm") + " --json " +
                            path("x.json"))
                    .exitCode,
                0);
      const nlohmann::json said = json("x.json");
      const double error = denoise.empty() ? said.at("relative_error") : said.at("denoised").at("error");
      result.said += error / 2.0;
      result.most = std::max(result.most, error);
      result.samples += said.at("spp").get<double>() / 2.0;
      pictures[k] = lucerna::readImage(path("x.pfm"));
    }
    for (std::size_t i = 0; i < pictures[0].pixels.size(); ++i) {
      const glm::dvec3 a(pictures[0].pixels[i]), b(pictures[1].pixels[i]);
      squares += glm::dot(a - b, a - b);
      mean += glm::dot(a + b, glm::dvec3(0.5));
    }
    const double values = 3.0 * static_cast<double>(pictures[0].pixels.size());
    result.error = std::sqrt(squares / (2.0 * values)) / (mean / values);
    return result;
  };
  const Stopped raw = stopped(""), denoised = stopped("--denoise ");
  EXPECT_LE(raw.most, 0.08);
  EXPECT_NEAR(raw.error / raw.said, 1.0, 0.2);
  // Of the picture shown, which needs fewer samples.
  EXPECT_LE(denoised.most, 0.08);
  EXPECT_NEAR(denoised.error / denoised.said, 1.0, 0.25);
  EXPECT_LT(denoised.samples, 0.6 * raw.samples);
}

TEST_F(CommandLine, PathTracingAsPublishedNamesItsDeviations) {
  const std::string common = "render " + scene() + " --technique path --size 16x12 --spp 4 ";
  ASSERT_EQ(
      RUN_LUCERNA(common + "--fidelity original -o " + path("o.pfm") + " --json " + path("original.json")).exitCode, 0);
  EXPECT_EQ(json("original.json").at("fidelity"), "original");
  EXPECT_EQ(json("original.json").at("deviations").size(),
            10u);  // all but path.schlick, which is a switch of the original's
  ASSERT_EQ(
      RUN_LUCERNA(common + "--deviation path.fixed-epsilon=on -o " + path("one.pfm") + " --json " + path("one.json"))
          .exitCode,
      0);
  EXPECT_EQ(json("one.json").at("deviations"), nlohmann::json::array({"path.fixed-epsilon"}));
  EXPECT_NE(lucerna::readImage(path("o.pfm")).pixels, lucerna::readImage(path("one.pfm")).pixels);
}

TEST_F(CommandLine, PathTracingRefusesWhatItDoesNotHave) {
  expectRefused("render " + scene() + " --technique path --deviation lpv.truncate=on -o " + path("no.png"), 2,
                {"lpv.truncate", "path."}, "no.png");
  expectRefused("render " + scene() + " --technique lpv --spp 4 -o " + path("no.png"), 2, {"--spp", "path"}, "no.png");
}

}  // namespace
