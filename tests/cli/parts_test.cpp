// --part, merge, cluster: what parts made apart become is what one run makes: samples, frames, batches of references,
// rows, rows of hemicubes.
#include "base/files.hpp"
#include "base/image.hpp"
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;
using namespace lucerna;
using test::RunResult;

class Parts : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(path(name))); }
  /// The Cornell box, whose light is all over the range; small.
  std::string picture() const {
    return std::string("'" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --technique path --size 24x14 --seed 3 ");
  }
  std::string part(const std::string& range, const std::string& name) const {
    return fmt::format("render {}--samples {} --checkpoint '{}' --quiet ", picture(), range, path(name));
  }
  void expectRefused(const std::string& command, const std::string& word) {
    const RunResult result = RUN_LUCERNA(command);
    EXPECT_EQ(result.exitCode, 2) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  }
  static void expectSame(const Image& a, const Image& b, double relative) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    const glm::dvec3 mean = meanOf(a);
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(a.pixels[i][c], b.pixels[i][c],
                    relative * std::max(std::abs(double{a.pixels[i][c]}), 1e-3 * mean[c]))
            << i;
  }

 private:
  test::TempFolder folder_;
};

TEST_F(Parts, ADenoisedPictureHasNone) {
  const std::string denoised = "render " + picture() + "--denoise --quiet -o '" + path("d.pfm") + "' ";
  expectRefused(denoised + "--samples 0:4 --checkpoint '" + path("d.film") + "'", "--denoise");
  ASSERT_EQ(
      RUN_LUCERNA(denoised + "--spp 16 --json '" + path("d.json") + "' --checkpoint '" + path("d.film") + "'").exitCode,
      0);
  const nlohmann::json told = json("d.json").at("denoised");
  EXPECT_TRUE(told.at("known").get<bool>());
  EXPECT_LE(told.at("low").get<double>(), told.at("error").get<double>());
  EXPECT_LE(told.at("error").get<double>(), told.at("high").get<double>());
  EXPECT_LT(told.at("error").get<double>(), told.at("raw").get<double>());
  expectRefused("merge '" + path("d.film") + "' --quiet -o '" + path("m.pfm") + "'", "denoised");
  expectRefused(
      "render " + picture() + "--spp 16 --quiet -o '" + path("r.pfm") + "' --checkpoint '" + path("d.film") + "'",
      "--denoise");
  expectRefused("render '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --technique lpv --denoise -o '" +
                    path("l.pfm") + "'",
                "--technique path");
}

TEST_F(Parts, AnotherPicturesFilmBesideTheOutputIsLeftAlone) {
  const std::string film = path("x.pfm.film"), output = "-o '" + path("x.pfm") + "'";
  ASSERT_EQ(RUN_LUCERNA("render " + picture() + "--spp 4 --quiet " + output + " --checkpoint '" + film + "'").exitCode,
            0);
  const auto before = readFileBytes(film);
  const std::string other = "render " + picture() + "--spp 4 --camera 0.278,0.3,-0.7,0.2,0.2,0.2,40 ";
  const RunResult result = RUN_LUCERNA(other + output);
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.err.find("x.pfm.film: a checkpoint of another scene, view or setting; not resumed"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(readFileBytes(film), before);
  ASSERT_EQ(RUN_LUCERNA(other + "--quiet -o '" + path("alone.pfm") + "'").exitCode, 0);
  EXPECT_EQ(readImage(path("x.pfm")).pixels, readImage(path("alone.pfm")).pixels);
  expectRefused(other + output + " --checkpoint '" + film + "'", "another scene");
}

TEST_F(Parts, TogetherAreOneRun) {
  ASSERT_EQ(RUN_LUCERNA("render " + picture() + "--spp 48 --quiet -o '" + path("one.pfm") + "' --checkpoint '" +
                        path("one.film") + "' --json '" + path("one.json") + "'")
                .exitCode,
            0);
  ASSERT_EQ(RUN_LUCERNA("merge '" + path("one.film") + "' --quiet -o '" + path("same.pfm") + "' --error '" +
                        path("one.error.pfm") + "'")
                .exitCode,
            0);
  EXPECT_EQ(readImage(path("same.pfm")).pixels, readImage(path("one.pfm")).pixels);  // one part is itself
  for (const auto& [range, name] : {std::pair{"30:48", "c.film"}, {"0:7", "a.film"}, {"7:30", "b.film"}}) {
    const RunResult made = RUN_LUCERNA(part(range, name));
    ASSERT_EQ(made.exitCode, 0) << made.err;
  }
  const RunResult merged = RUN_LUCERNA("merge '" + path("c.film") + "' '" + path("a.film") + "' '" + path("b.film") +
                                       "' --quiet -o '" + path("all.pfm") + "' --error '" + path("all.error.pfm") +
                                       "' --checkpoint '" + path("all.film") + "' --json '" + path("all.json") + "'");
  ASSERT_EQ(merged.exitCode, 0) << merged.err;
  expectSame(readImage(path("one.pfm")), readImage(path("all.pfm")), 1e-6);
  expectSame(readImage(path("one.error.pfm")), readImage(path("all.error.pfm")), 1e-3);
  EXPECT_EQ(json("all.json").at("samples"), nlohmann::json({0, 48}));
  EXPECT_NEAR(json("all.json").at("standard_error").get<double>() / json("one.json").at("standard_error").get<double>(),
              1.0, 1e-5);
  // Its film goes on as the one run's does.
  ASSERT_EQ(RUN_LUCERNA("render " + picture() + "--spp 60 --quiet -o '" + path("on.pfm") + "' --checkpoint '" +
                        path("all.film") + "'")
                .exitCode,
            0);
  ASSERT_EQ(RUN_LUCERNA("render " + picture() + "--spp 60 --quiet -o '" + path("long.pfm") + "' --checkpoint '" +
                        path("one.film") + "'")
                .exitCode,
            0);
  expectSame(readImage(path("long.pfm")), readImage(path("on.pfm")), 1e-6);

  // What does not belong together.
  ASSERT_EQ(RUN_LUCERNA(part("5:9", "overlap.film")).exitCode, 0);
  expectRefused("merge '" + path("a.film") + "' '" + path("overlap.film") + "' -o '" + path("no.pfm") + "'",
                "the same samples (5 to 6)");
  expectRefused("merge '" + path("a.film") + "' '" + path("c.film") + "' -o '" + path("no.pfm") + "'",
                "samples 7 to 29 are in no part");
  ASSERT_EQ(
      RUN_LUCERNA("render " + picture() + "--bounces 1 --samples 7:9 --checkpoint '" + path("other.film") + "' --quiet")
          .exitCode,
      0);
  expectRefused("merge '" + path("a.film") + "' '" + path("other.film") + "' -o '" + path("no.pfm") + "'",
                "another scene, view or setting");
  expectRefused("merge '" + path("one.pfm") + "' -o '" + path("no.pfm") + "'", "not a checkpoint");
  EXPECT_FALSE(fs::exists(path("no.pfm")));
  expectRefused(part("9:12", "a.film"), "begin with number 0");
  expectRefused("render " + picture() + "--spp 9 -o '" + path("no.pfm") + "' --checkpoint '" + path("b.film") + "'",
                "merge");
  for (const char* range : {"5:5", "7:3", "3", ":4", "a:b", "-1:4", "0:99999999999"})
    expectRefused(part(range, "no.film"), "--samples");
  expectRefused("render " + picture() + "--samples 0:4 -o '" + path("no.pfm") + "'", "--checkpoint");
  expectRefused("render " + picture() + "--spp 4", "-o");
}

/// Parts of commands that keep units in folders: K of N into parts/K, all merged into `whole`; then what does not
/// belong together.
class FolderParts : public Parts {
 protected:
  void make(const std::string& command, int parts) {
    for (int k = 0; k < parts; ++k) {
      const RunResult made = RUN_LUCERNA(command + partOf(k, parts, "parts/" + std::to_string(k)) + " --quiet");
      ASSERT_EQ(made.exitCode, 0) << made.err;
    }
    const RunResult merged =
        RUN_LUCERNA("merge --parts '" + path("parts") + "' --quiet --checkpoint '" + path("whole") + "'");
    ASSERT_EQ(merged.exitCode, 0) << merged.err;
  }
  std::string partOf(int k, int parts, const std::string& folder) const {
    return fmt::format(" --part {}/{} --checkpoint '{}'", k, parts, path(folder));
  }
  std::string whole() const { return " --checkpoint '" + path("whole") + "'"; }
  /// one.rad by one run, which is told more, and all.rad from the parts; each with its JSON.
  void solveOneAndWhole(const std::string& solve, const std::string& settings, const std::string& more) {
    for (const auto& [name, words] : {std::pair{"one", settings + more}, {"all", settings + whole()}})
      ASSERT_EQ(RUN_LUCERNA(solve + "'" + path(std::string(name) + ".rad") + "'" + words + " --quiet --json '" +
                            path(std::string(name) + ".json") + "'")
                    .exitCode,
                0)
          << name;
  }
  /// `command` made parts/0 and parts/1 of two; `another` is the same with another setting.
  void expectWrongJoinsRefused(const std::string& command, const std::string& another) {
    const std::string merge = "merge --checkpoint '" + path("no") + "' '" + path("parts/0") + "' ";
    expectRefused(merge, "are in no part");
    expectRefused(merge + "'" + path("parts/0") + "' '" + path("parts/1") + "'", "the same units");
    expectRefused("merge --checkpoint '" + path("no") + "' '" + path("parts/1") + "'", "are in no part");
    const RunResult other = RUN_LUCERNA(another + partOf(1, 2, "other") + " --quiet");
    ASSERT_EQ(other.exitCode, 0) << other.err;
    expectRefused(merge + "'" + path("other") + "'", "other settings");
    // One that was not finished.
    fs::copy(path("parts/1"), path("half"));
    nlohmann::json description = json("half/part.json");
    description["done"] = false;
    std::ofstream(path("half/part.json")) << description;
    expectRefused(merge + "'" + path("half") + "'", "not finished");
    EXPECT_FALSE(fs::exists(path("no")));
    // A folder of another part, a part that cannot be, and no folder.
    expectRefused(command + partOf(1, 2, "parts/0"), "another scene, setting or part");
    for (const char* part : {"2/2", "-1/2", "1", "a/b", "0/0"})
      expectRefused(command + " --part " + part + " --checkpoint '" + path("no") + "'", "--part");
    expectRefused(command + " --part 0/2", "--checkpoint");
  }
};

TEST_F(FolderParts, RowsOfStability) {
  const std::string command = "bench stability --technique direct";
  make(command, 2);
  ASSERT_EQ(RUN_LUCERNA(command + " --quiet --json '" + path("one.json") + "'").exitCode, 0);
  ASSERT_EQ(RUN_LUCERNA(command + whole() + " --quiet --json '" + path("all.json") + "'").exitCode, 0);
  nlohmann::json one = json("one.json"), all = json("all.json");
  for (nlohmann::json* report : {&one, &all}) {
    report->erase("seconds");
    for (auto& row : report->at("rows")) row.erase("seconds");
  }
  EXPECT_GT(one.at("rows").size(), 3u);
  EXPECT_EQ(one, all);
  expectWrongJoinsRefused(command, "bench stability --technique rsm");
  expectRefused(command + partOf(0, 2, "no") + " --compare x.json", "--compare");
}

TEST_F(FolderParts, MomentsOfBenchDynamic) {
  const std::string shared =
      "bench dynamic '" LUCERNA_SOURCE_DIR
      "/assets/cornell/moving.json' --frames 4 --size 24x24 --reference-samples 16 --techniques direct";
  const std::string command = shared + " --fps 2";
  const auto references = [&](const char* name) { return " --references '" + path(name) + "'"; };
  make(command + references("others"), 2);
  ASSERT_EQ(RUN_LUCERNA(command + references("one") + " --quiet --out '" + path("one page") + "'").exitCode, 0);
  ASSERT_EQ(RUN_LUCERNA(command + references("none") + whole() + " --quiet --out '" + path("all page") + "'").exitCode,
            0);
  EXPECT_TRUE(fs::is_empty(path("none")));  // all were made by the parts
  nlohmann::json one = json("one page/dynamic.json"), all = json("all page/dynamic.json");
  for (nlohmann::json* report : {&one, &all})
    for (auto& row : report->at("techniques")) row.erase("ms");
  EXPECT_EQ(one.at("radiance").size(), 4u);
  EXPECT_EQ(one, all);
  expectWrongJoinsRefused(command + references("others"), shared + " --fps 3" + references("others"));
}

TEST_F(FolderParts, FramesOfAWalk) {
  for (const char* technique : {"path --set path.samples=3", "rsm"}) {
    for (const char* name : {"parts", "whole", "one", "all", "other", "half"}) fs::remove_all(path(name));
    const std::string command = "walk '" LUCERNA_SOURCE_DIR
                                "/assets/cornell/cornell.json' --size 32x18 --frames 5 --technique " +
                                std::string(technique);
    make(command, 2);
    ASSERT_EQ(RUN_LUCERNA(command + " --quiet --record '" + path("one") + "'").exitCode, 0);
    const RunResult all =
        RUN_LUCERNA(command + whole() + " --quiet --record '" + path("all") + "' --json '" + path("all.json") + "'");
    ASSERT_EQ(all.exitCode, 0) << all.err;
    EXPECT_EQ(json("all.json").at("frames"), 5);
    for (int i = 0; i < 5; ++i) {
      const std::string frame = fmt::format("/frame_{:04}.png", i);
      EXPECT_EQ(readFileBytes(path("one") + frame), readFileBytes(path("all") + frame)) << technique << " " << i;
      if (i == 0) continue;
      EXPECT_NE(readFileBytes(path("one") + frame), readFileBytes(path("one") + "/frame_0000.png"))
          << i;  // not all of one view
    }
    expectWrongJoinsRefused(command, command + " --views 0:30");
  }
  const std::string box = "walk '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --size 32x18 --frames 4 ";
  expectRefused(box + "--technique irradiance-cache" + partOf(0, 2, "no"), "irradiance-cache");
  expectRefused(box + "--flicker" + partOf(0, 2, "no"), "--flicker");
}

TEST_F(FolderParts, BatchesOfReferencesAndRowsOfErrors) {
  const std::string box = "'" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --size 32x18 ",
                    scene = box + "--techniques direct,rsm,path --small --reference-spp 32 ";
  const std::string references = "bench references " + scene;
  ASSERT_NO_FATAL_FAILURE(make(references, 2));
  ASSERT_EQ(RUN_LUCERNA(references + "--quiet --references '" + path("one") + "'").exitCode, 0);
  ASSERT_EQ(RUN_LUCERNA(references + "--quiet --references '" + path("all") + "'" + whole()).exitCode, 0);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(path("one"))) {
    auto one = readFileBytes(entry.path()), all = readFileBytes(path("all") / entry.path().filename());
    ASSERT_EQ(one.size(), all.size());
    // But for the seconds that it took, and the checksum at the end.
    for (auto* bytes : {&one, &all})
      std::fill_n(bytes->begin() + 24, 8, std::uint8_t{0}), bytes->resize(bytes->size() - 8);
    EXPECT_EQ(one, all) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 5);
  expectWrongJoinsRefused(references, "bench references " + scene + "--camera 0,1,3,0,1,0,60");

  // Rows, judged by those: a bench of one machine with the same references is the same but for times.
  for (const char* name : {"parts", "whole", "other", "half"}) fs::remove_all(path(name));
  // The short form has no rows of paths, whose sweep takes its second in each run.
  const std::string bench = "bench error " + box + "--techniques direct,rsm" + (test::longTests() ? ",path" : "") +
                            " --small --reference-spp 32 --budget 1 --frames 1 ",
                    with = bench + "--references '" + path("one") + "' ";
  expectRefused(bench + "--references '" + path("none") + "'" + partOf(0, 2, "no"), "references are missing");
  ASSERT_NO_FATAL_FAILURE(make(with, 2));
  const RunResult one = RUN_LUCERNA(with + "--quiet --out '" + path("report1") + "'"),
                  all = RUN_LUCERNA(with + "--quiet --out '" + path("report2") + "'" + whole());
  ASSERT_EQ(one.exitCode, 0) << one.err;
  ASSERT_EQ(all.exitCode, 0) << all.err;
  const nlohmann::json a = json("report1/error.json"), b = json("report2/error.json");
  int same = 0;
  for (const auto& row : a.at("rows")) {
    // A sweep of the path tracer goes as far as there is time.
    const auto found = std::find_if(b.at("rows").begin(), b.at("rows").end(),
                                    [&](const auto& other) { return other.at("label") == row.at("label"); });
    if (found == b.at("rows").end()) {
      EXPECT_EQ(row.at("technique"), "path") << row.at("label");
      continue;
    }
    ++same;
    for (const char* key : {"bias", "flip", "l2", "nrmse", "relmse", "p99", "lit", "other", "settings", "command"})
      EXPECT_EQ(row.at(key), found->at(key)) << row.at("label") << " " << key;
    EXPECT_EQ(row.value("inside_model", nlohmann::json()), found->value("inside_model", nlohmann::json()))
        << row.at("label");
    EXPECT_EQ(fs::exists(path("report2") + "/" + row.at("picture").get<std::string>() + ".pfm"), true);
  }
  EXPECT_GE(same, 8);
  EXPECT_TRUE(fs::exists(path("report2/report.html")));
  // The rows were not measured again: theirs are the parts' dates and times.
  for (const auto& entry : fs::directory_iterator(path("whole/rows")))
    EXPECT_EQ(readFileBytes(entry.path()), readFileBytes(path("report2/rows") / entry.path().filename()));
  expectWrongJoinsRefused(with, bench + "--deviations --references '" + path("one") + "' ");
  expectRefused("bench error '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --size 32x18" + partOf(0, 2, "no"),
                "--reference-spp");
}

TEST_F(FolderParts, RowsOfHemicubes) {
  const std::string command = "radiosity solve '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' ",
                    settings = " 32 --visibility raster --edge 0.3";
  ASSERT_NO_FATAL_FAILURE(make(command + "'" + path("not_written") + "'" + settings, 3));
  EXPECT_FALSE(fs::exists(path("not_written")));
  ASSERT_NO_FATAL_FAILURE(solveOneAndWhole(command, settings, ""));
  EXPECT_EQ(json("all.json").at("hemicubes"), 0);  // all were the parts'
  EXPECT_GT(json("one.json").at("hemicubes"), 100);
  EXPECT_EQ(readFileBytes(path("one.rad")), readFileBytes(path("all.rad")));
  fs::remove_all(path("parts"));
  fs::remove_all(path("whole"));
  const std::string any = command + "'" + path("not_written") + "'";
  ASSERT_NO_FATAL_FAILURE(make(any + settings, 2));
  expectWrongJoinsRefused(any + settings, any + " 64 --visibility raster --edge 0.3");
  expectRefused(any + " --fidelity original" + partOf(0, 2, "no"), "--fidelity corrected");
}

// Without a word about visibility all parts take the same one, by a count of patches and pixels: raster for few patches
// and many pixels, rays for many patches and few pixels. The whole goes on with it, refinements too, whatever it would
// have measured.
TEST_F(FolderParts, RowsOfHemicubesAgreeOnAVisibility) {
  const std::string command = "radiosity solve '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' ";
  for (const auto& [visibility, pixels] : {std::pair{"raster", " 32"}, {"rays", " 2"}}) {
    for (const char* name : {"parts", "whole"}) fs::remove_all(path(name));
    const std::string settings = pixels + std::string(" --edge 0.3 --refinements 1");
    ASSERT_NO_FATAL_FAILURE(
        make(command + "'" + path("not_written") + "'" + settings + " --json '" + path("part.json") + "'", 2));
    EXPECT_EQ(json("part.json").at("visibility"), visibility);
    ASSERT_NO_FATAL_FAILURE(solveOneAndWhole(command, settings, std::string(" --visibility ") + visibility));
    // Those of the first mesh were the parts'.
    EXPECT_EQ(json("all.json").at("hemicubes").get<int>() + json("part.json").at("of").get<int>(),
              json("one.json").at("hemicubes"));
    EXPECT_EQ(json("all.json").at("visibility"), visibility);
    EXPECT_EQ(readFileBytes(path("one.rad")), readFileBytes(path("all.rad")));
  }
}

// Each original's tables: the rows of parts are those of one run, but for what the clock says.
TEST_F(FolderParts, RowsOfTables) {
  if (!test::longTests()) GTEST_SKIP() << "minutes: LUCERNA_LONG_TESTS";
  struct Of {
    const char *original, *another;
  };
  for (const Of& of : {Of{"vpt --scale 0.001", "vpt --scale 0.0012"},
                       Of{"lpv --scale 0.04 --fill fixed", "lpv --scale 0.04 --fill layered"},
                       Of{"rad --scale 0.0005", "rad --scale 0.0006"}}) {
    for (const char* name : {"parts", "whole", "other", "half"}) fs::remove_all(path(name));
    const std::string command = std::string("bench tables --original ") + of.original;
    ASSERT_NO_FATAL_FAILURE(make(command, 2));
    ASSERT_EQ(RUN_LUCERNA(command + " --quiet --json '" + path("one.json") + "'").exitCode, 0);
    const RunResult joined = RUN_LUCERNA(command + whole() + " --quiet --json '" + path("all.json") + "'");
    ASSERT_EQ(joined.exitCode, 0) << joined.err;
    const nlohmann::json one = json("one.json"), all = json("all.json");
    ASSERT_EQ(one.at("rows").size(), all.at("rows").size()) << of.original;
    for (std::size_t i = 0; i < one.at("rows").size(); ++i) {
      for (const char* key : {"table", "row", "published", "unit"})
        EXPECT_EQ(one.at("rows").at(i).at(key), all.at("rows").at(i).at(key)) << of.original << " " << i;
      EXPECT_EQ(one.at("rows").at(i).at("measured").is_number(), all.at("rows").at(i).at("measured").is_number())
          << of.original << " " << i;
    }
    // What is no time is the same to the last bit.
    for (const char* key : {"deviations", "notes"})
      EXPECT_EQ(one.value(key, nlohmann::json()), all.value(key, nlohmann::json())) << of.original << " " << key;
    const nlohmann::json none = nlohmann::json::array(), pictures = one.value("pictures", none),
                         joinedPictures = all.value("pictures", none);
    ASSERT_EQ(pictures.size(), joinedPictures.size()) << of.original;
    for (std::size_t i = 0; i < pictures.size(); ++i)
      EXPECT_EQ(pictures.at(i).at("mean"), joinedPictures.at(i).at("mean")) << i;
    expectWrongJoinsRefused(command, std::string("bench tables --original ") + of.another);
  }
  expectRefused("bench tables --original lpv" + partOf(0, 2, "no"), "--fill");
}

/// A job in a folder whose name the shell and Slurm would both take apart.
class Cluster : public Parts {
 protected:
  std::string job(const std::string& file = "") const { return path("a job of 10%j" + file); }
  void plan(const std::string& options, const std::string& command) const {
    const RunResult planned = test::run("cd '" + path("") + "' && '" LUCERNA_BINARY "' cluster plan -o '" + job() +
                                        "' --quiet " + options + " -- " + command);
    ASSERT_EQ(planned.exitCode, 0) << planned.err;
  }
  RunResult cluster(const std::string& command, const std::string& options = "--quiet") const {
    return RUN_LUCERNA("cluster " + command + " '" + job() + "' " + options);
  }
  /// As Slurm runs a task of the array, in a shell.
  std::string task(int number) const {
    return fmt::format("SLURM_ARRAY_TASK_ID={} bash '{}'", number, job("/array.sbatch"));
  }
  nlohmann::json status() const {
    EXPECT_EQ(cluster("status", "--quiet --json '" + path("status.json") + "'").exitCode, 0);
    return json("status.json");
  }
  void expectTheFramesOfOneRun(const std::string& walk, int frames) const {
    ASSERT_EQ(RUN_LUCERNA(walk + "--quiet --record '" + path("one") + "'").exitCode, 0);
    for (int i = 0; i < frames; ++i) {
      const std::string frame = fmt::format("/frame_{:04}.png", i);
      EXPECT_EQ(readFileBytes(path("one") + frame), readFileBytes(path("all") + frame)) << i;
    }
  }
};

TEST_F(Cluster, MakesThePictureOfOneRun) {
  const std::string command = "render " + picture() + "--spp 48 -o '" + path("joined.pfm") + "'";
  ASSERT_EQ(RUN_LUCERNA("render " + picture() + "--spp 48 --quiet -o '" + path("one.pfm") + "'").exitCode, 0);
  ASSERT_NO_FATAL_FAILURE(plan("--tasks 6", command));
  expectRefused("cluster plan -o '" + job() + "' --tasks 6 -- " + command, "holds a job");
  const std::string more = "cluster plan -o '" + path("more") + "' ";
  expectRefused(more + "--tasks 9 -- render " + picture() + "--spp 8 -o x.pfm", "--tasks 9");
  expectRefused(more + "-- render x.json --technique lpv --spp 8 -o x.pfm", "only pictures with --technique path");
  expectRefused(more + "-- render " + picture() + "-o x.pfm", "--spp");
  expectRefused(more + "-- render " + picture() + "--spp 80", "-o");
  expectRefused(more + "-- render " + picture() + "--spp 80 --error=1 -o x.pfm", "tasks share the samples");
  expectRefused(more + "-- bench stability --part 0/2", "each task has its own");
  expectRefused(more + "-- info", "one that can be divided");
  expectRefused("cluster status '" + path("more") + "'", "no job");

  // One task as of an array; then the join names the others, and a run makes them alone.
  const RunResult one = test::run(task(2));
  ASSERT_EQ(one.exitCode, 0) << one.err;
  EXPECT_EQ(status(), nlohmann::json({{"tasks", 6}, {"done", 1}, {"begun", 0}, {"missing", 5}}));
  const RunResult early = cluster("join");
  EXPECT_EQ(early.exitCode, 1);
  EXPECT_NE(early.err.find("5 of 6 tasks are not done: 0-1,3-5."), std::string::npos) << early.err;
  EXPECT_FALSE(fs::exists(path("joined.pfm")));
  const auto made = fs::last_write_time(job("/parts/2.film"));
  const RunResult ran = cluster("run", "--jobs 2 --quiet --json '" + path("run.json") + "'");
  ASSERT_EQ(ran.exitCode, 0) << ran.err << ran.out;
  EXPECT_EQ(json("run.json"), nlohmann::json({{"done_here", 5}, {"left", 0}}));
  EXPECT_EQ(fs::last_write_time(job("/parts/2.film")), made);
  const RunResult joined = cluster("join");
  ASSERT_EQ(joined.exitCode, 0) << joined.err;
  expectSame(readImage(path("one.pfm")), readImage(path("joined.pfm")), 1e-6);
}

// What the checkpoint of a killed task holds is not made again.
TEST_F(Cluster, AKilledTaskGoesOnFromItsCheckpoint) {
  ASSERT_NO_FATAL_FAILURE(
      plan("--tasks 2", "render " + picture() + "--spp 12000 --save-every 0 -o '" + path("joined.pfm") + "'"));
  // As soon as the checkpoint is there: 6000 samples of 24x14 pixels take many submissions.
  const RunResult killed =
      test::run(task(1) + " & task=$!; for i in $(seq 6000); do [ -s '" + job("/parts/1.film") +
                "' ] && break; sleep 0.01; done; kill -9 $task; wait $task; ls '" + job("/parts/1.film") + "'");
  ASSERT_EQ(killed.exitCode, 0) << killed.err;
  ASSERT_EQ(status().at("begun"), 1) << "the task ended before it was killed";
  ASSERT_EQ(test::run(task(1)).exitCode, 0);
  const nlohmann::json result = nlohmann::json::parse(std::ifstream(job("/parts/1.json")));
  EXPECT_EQ(result.at("samples"), nlohmann::json({6000, 12000}));
  EXPECT_GT(result.at("resumed_samples"), 0);
}

// A run is the only one; a signal ends its tasks, which keep their frames, and no part of them counts as done.
TEST_F(Cluster, AStoppedRunKeepsWhatItHas) {
  const std::string walk = "walk '" LUCERNA_SOURCE_DIR
                           "/assets/cornell/cornell.json' --size 32x18 --frames 60 --technique path "
                           "--set path.samples=60 ",
                    run = "'" LUCERNA_BINARY "' cluster run '" + job() + "' --jobs 2 --quiet";
  ASSERT_NO_FATAL_FAILURE(plan("--tasks 3", walk + "--record '" + path("all") + "'"));
  const auto frames = [&] {
    const fs::recursive_directory_iterator files(job("/parts"));
    return std::count_if(begin(files), end(files), [](const auto& file) { return file.path().extension() == ".png"; });
  };
  // Stopped when two tasks have a frame each, or one more than before.
  for (const auto& [signal, code] : {std::pair{"TERM", 143}, {"INT", 130}}) {
    const RunResult stopped =
        test::run(run + " & run=$!; for i in $(seq 6000); do [ $(find '" + job("/parts") +
                  "' -name '*.png' | wc -l) -gt " + std::to_string(frames() + 1) + " ] && break; sleep 0.01; done; " +
                  run + " 2>'" + path("second") + "'; echo $?; kill -" + signal + " $run; wait $run");
    EXPECT_EQ(stopped.exitCode, code) << stopped.err;
    EXPECT_NE(stopped.err.find("cluster run"), std::string::npos) << stopped.err;
    EXPECT_EQ(stopped.out, "2\n");
    EXPECT_NE(readFileText(path("second")).find("another cluster run works on it"), std::string::npos);
    EXPECT_LE(20 * status().at("done").get<int>(), frames());
    EXPECT_GT(status().at("begun"), 0);
  }
  // Killed, it takes its tasks along; they hold the lock until they have ended.
  const std::string freeLock = "flock -n '" + job("/lock") + "' true";
  const RunResult killed =
      test::run(run + " & run=$!; sleep 0.3; tasks=$(cat /proc/$run/task/$run/children); " +
                "kill -STOP $tasks; kill -9 $run; wait $run; " + freeLock + " && exit 1; " +
                "kill -CONT $tasks; for i in $(seq 600); do " + freeLock + " && exit 0; sleep 0.1; done; exit 2");
  ASSERT_EQ(killed.exitCode, 0) << killed.err;
  EXPECT_GT(status().at("begun"), 0) << "tasks of a killed run went on without it";
  ASSERT_EQ(cluster("run", "--jobs 2 --quiet").exitCode, 0);
  const RunResult joined = cluster("join");
  ASSERT_EQ(joined.exitCode, 0) << joined.err;
  expectTheFramesOfOneRun(walk, 60);
}

// `submit` hands over the array and a join that waits for its end. A stand-in for Slurm runs them at once where sbatch
// was called, as Slurm does. Where tasks fail, the join names them, and the second `submit` goes on with them.
TEST_F(Cluster, SubmitHandsAnArrayAndItsJoinToSlurm) {
  fs::create_directory_symlink(LUCERNA_SOURCE_DIR "/assets", path("assets"));
  const std::string scene = "assets/cornell/cornell.json", settings = " --size 32x18 --frames 5 --technique rsm ";
  ASSERT_NO_FATAL_FAILURE(
      plan("--tasks 3 --time 7:00 --account physics", "walk " + scene + settings + "--record all --json all.json"));
  for (const char* script : {"array.sbatch", "join.sbatch"})
    for (const char* line : {"--requeue\n", "--time=7:00\n", "--account=physics\n"})
      EXPECT_NE(readFileText(job("/") + script).find(std::string("#SBATCH ") + line), std::string::npos) << script;
  fs::create_directory(path("bin"));
  std::ofstream(path("bin/sbatch")) << R"sh(#!/bin/bash
echo "$*" >> "$CALLS"
script="${@: -1}"
last="$(sed -n 's/^#SBATCH --array=0-//p' "$script")"
for task in ${last:+$(seq 0 "$last")}; do
  env SLURM_ARRAY_TASK_ID="$task" $IN_TASKS bash "$script" >&2
done
[ -z "$last" ] || exec echo 7
bash "$script" >&2 || echo "join: $?" >&2
echo 8
)sh";
  fs::permissions(path("bin/sbatch"), fs::perms::owner_all);
  const std::string submit = "CALLS='" + path("calls") + "' PATH='" + path("bin") + "':$PATH '" + job("/submit") + "'";
  const RunResult failed = test::run("IN_TASKS=LUCERNA_HOST=none " + submit);
  EXPECT_EQ(failed.out, "7 8\n") << failed.err;
  EXPECT_NE(failed.err.find("3 of 3 tasks are not done: 0-2."), std::string::npos) << failed.err;
  EXPECT_NE(failed.err.find("join: 1\n"), std::string::npos) << failed.err;
  EXPECT_FALSE(fs::exists(path("all")));
  const RunResult joined = test::run(submit);
  EXPECT_EQ(joined.out, "7 8\n") << joined.err;
  const std::string calls = "--parsable array.sbatch\n--parsable --dependency=afterany:7 join.sbatch\n";
  EXPECT_EQ(readFileText(path("calls")), calls + calls);
  EXPECT_EQ(json("all.json").at("frames"), 5);
  expectTheFramesOfOneRun("walk '" + path(scene) + "'" + settings, 5);
}

// The scripts for Slurm, up to where the program begins, and the device that they take from Slurm's variables.
TEST_F(Cluster, AScriptHandsOnTheDeviceThatSlurmGave) {
  ASSERT_NO_FATAL_FAILURE(plan("--tasks 2 --gpus 1", "render " + picture() + "--spp 4 -o joined.pfm"));
  for (const char* script : {"array.sbatch", "join.sbatch"}) {
    const std::string text = readFileText(job("/") + script);
    EXPECT_NE(text.find("--gpus-per-task=1"), std::string::npos);
    const std::size_t program = text.find("\n", text.find("esac"));
    ASSERT_NE(program, std::string::npos) << text;
    std::ofstream(path("head.sh")) << text.substr(0, program) << "\necho \"${LUCERNA_EGL_DEVICE-none}\"\n";
    struct Case {
      const char *given, *device;
    };
    for (const Case& c : {Case{"", "none"},
                          {"CUDA_VISIBLE_DEVICES=", "none"},
                          {"CUDA_VISIBLE_DEVICES=NoDevFiles", "none"},
                          {"CUDA_VISIBLE_DEVICES=1", "cuda:1"},
                          {"CUDA_VISIBLE_DEVICES=2,3", "cuda:2"},
                          {"CUDA_VISIBLE_DEVICES=GPU-1a2b3c4d-0000-1111-2222-333344445555",
                           "cuda:GPU-1a2b3c4d-0000-1111-2222-333344445555"},
                          {"CUDA_VISIBLE_DEVICES=MIG-8b1c,MIG-9d2e", "cuda:MIG-8b1c"},
                          {"ROCR_VISIBLE_DEVICES=1,0", "rocm:1"},
                          {"LUCERNA_EGL_DEVICE=5", "5"}}) {
      const RunResult ran = test::run("env -u LUCERNA_EGL_DEVICE -u CUDA_VISIBLE_DEVICES -u ROCR_VISIBLE_DEVICES " +
                                      std::string(c.given) + " bash -eu '" + path("head.sh") + "'");
      EXPECT_EQ(ran.exitCode, 0) << ran.err;
      EXPECT_EQ(ran.out, std::string(c.device) + "\n") << script << ": " << c.given;
    }
  }
}

// Each of several workers draws with the device that it was given: these are none, and each task's log names them.
TEST_F(Cluster, WorkersHaveDevicesOfTheirOwn) {
  ASSERT_NO_FATAL_FAILURE(plan("--tasks 8", "render " + picture() + "--host egl --spp 8 -o joined.pfm"));
  const RunResult failed = cluster("run", "--jobs 2 --devices 97,98 --quiet");
  EXPECT_EQ(failed.exitCode, 1);
  EXPECT_NE(failed.err.find("8 of 8 tasks are not done: 0-7."), std::string::npos) << failed.err;
  std::string logs;
  for (const auto& entry : fs::directory_iterator(job("/logs"))) logs += readFileText(entry.path());
  for (const char* device : {"LUCERNA_EGL_DEVICE=97: no such device", "LUCERNA_EGL_DEVICE=98: no such device"})
    EXPECT_NE(logs.find(device), std::string::npos) << logs;
  if (test::run("LUCERNA_EGL_DEVICE=0 '" LUCERNA_BINARY "' info --quiet --host egl").exitCode != 0)
    GTEST_SKIP() << "no EGL device here";
  EXPECT_EQ(cluster("run", "--jobs 2 --devices 0,0 --quiet").exitCode, 0);
}

}  // namespace
