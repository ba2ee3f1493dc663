// lucerna check: pictures are right here and are seen to be wrong; a unit that hangs, crashes or fails is a row, and
// the rest goes on; an interrupted check resumes.
#include "base/files.hpp"
#include "support/faulty_shaders.hpp"
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <regex>
#include <set>
#include <string>

namespace lucerna::test {
namespace {

namespace fs = std::filesystem;

class Check : public ::testing::Test {
 protected:
  RunResult check(const std::string& options, const std::string& environment = "") {
    return run(
        fmt::format("{} '" LUCERNA_BINARY "' check --quiet --out '{}' {}", environment, out().string(), options));
  }
  fs::path out() const { return folder_ / "out"; }
  nlohmann::json report() const { return nlohmann::json::parse(readFileText(out() / "check.json")); }
  nlohmann::json row(const std::string& part, const std::string& name) const {
    const nlohmann::json whole = report();
    for (const auto& row : whole.at("rows"))
      if (row.at("part") == part && row.at("name") == name) return row;
    ADD_FAILURE() << part << "/" << name << " is missing";
    return {};
  }
  void expectRow(const std::string& part, const std::string& name, const char* status, const char* text) const {
    const nlohmann::json found = row(part, name);
    EXPECT_EQ(found.at("status"), status) << found;
    EXPECT_NE(found.at("text").get<std::string>().find(text), std::string::npos) << found.at("text");
  }

  TempFolder folder_;
};

// The stored values are current if the renderer and the processor that they were made with still make the same
// pictures. Another processor's have other bits: in the atrium blocks of pixels differ by 0.3 % of their mean.
TEST_F(Check, PicturesAreRightOnASoftwareRenderer) {
  const RunResult result = check("--only context,pictures --minutes 30");
  EXPECT_EQ(result.exitCode, 0) << result.err << readFileText(out() / "check.txt");
  const nlohmann::json whole = report(),
                       stored = nlohmann::json::parse(readFileText(LUCERNA_SOURCE_DIR "/assets/check/reference.json"));
  ASSERT_TRUE(whole.at("rows").at(0).at("figures").at("software").get<bool>());
  const bool isSame = whole.at("renderer") == stored.at("renderer") && whole.at("opengl") == stored.at("driver") &&
                      whole.at("cpu") == stored.at("cpu");
  int pictures = 0;
  for (const auto& row : whole.at("rows")) {
    if (row.at("part") != "pictures") continue;
    ++pictures;
    EXPECT_EQ(row.at("status"), "right") << row;
    EXPECT_LT(row.at("figures").at("blocks_rms"), isSame ? 1e-6 : 1.0)
        << row.at("name") << ": lucerna check --write-reference assets/check/reference.json";
  }
  EXPECT_EQ(pictures, 12);
  EXPECT_NE(readFileText(out() / "check.txt").find("verdict   all right; 13 of 13"), std::string::npos);
  EXPECT_FALSE(fs::exists(out() / "state.json"));
}

TEST_F(Check, ProbesHaveTheirKnownAnswers) {
  const RunResult result = check("--only probes --minutes 10");
  EXPECT_EQ(result.exitCode, 0) << result.err << readFileText(out() / "check.txt");
  const nlohmann::json whole = report();
  EXPECT_EQ(whole.at("rows").size(), 10u);
  for (const auto& row : whole.at("rows")) EXPECT_EQ(row.at("status"), "right") << row;
}

// The other parts run here; how long they take is not judged.
TEST_F(Check, MeasurementsEndInTheirTime) {
  const RunResult result =
      check("--only context,stages/direct-cornell-1280x720,rays/cornell,programs/direct-atrium --minutes 3");
  EXPECT_EQ(result.exitCode, 0) << result.err << readFileText(out() / "check.txt");
  const nlohmann::json whole = report();
  for (const auto& row : whole.at("rows")) EXPECT_EQ(row.at("status"), "right") << row;
  EXPECT_GT(row("stages", "direct-cornell-1280x720").at("figures").at("median_ms"), 0.0);
  EXPECT_GT(row("rays", "cornell").at("figures").at("mrays_per_s"), 0.0);
  EXPECT_GT(row("programs", "direct-atrium").at("figures").at("programs").size(), 3u);
}

// Of the techniques and of the inspection of a pixel: each name that engine/ loads a program by. Minutes on software.
TEST_F(Check, EveryProgramOfTheEngineIsCompiled) {
  if (!lucerna::test::longTests()) GTEST_SKIP() << "one of the long tests";
  EXPECT_EQ(check("--only programs --minutes 30").exitCode, 0);
  std::set<std::string> compiled;
  const nlohmann::json whole = report();
  for (const auto& row : whole.at("rows"))
    if (row.at("part") == "programs")
      for (const auto& program : row.at("figures").at("programs")) compiled.insert(program.at("name"));
  // Of the published radiosity program and of the bounds of bench error, which no frame draws.
  const std::set<std::string> others{"radiosity show", "radiosity show textured", "cache records of pixels",
                                     "cache paths from cells"};
  const std::regex load(R"re(load(?:Compute|Raster)\(\s*"([^"]+)")re");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(LUCERNA_SOURCE_DIR "/engine")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = readFileText(entry.path());
    for (std::sregex_iterator match(text.begin(), text.end(), load), end; match != end; ++match)
      if (const std::string name = (*match)[1]; !others.contains(name)) {
        EXPECT_TRUE(compiled.contains(name)) << entry.path() << ": " << name;
      }
  }
}

TEST_F(Check, AWrongReferenceIsAWrongPicture) {
  const auto expectWrong = [&](const char* name, const std::function<void(nlohmann::json&)>& change) {
    nlohmann::json reference = nlohmann::json::parse(readFileText(LUCERNA_SOURCE_DIR "/assets/check/reference.json"));
    change(reference.at("pictures").at(name).at("blocks"));
    writeFileAtomically(folder_ / "reference.json", reference.dump());
    const RunResult result =
        check(fmt::format("--only pictures/{} --reference '{}'", name, (folder_ / "reference.json").string()));
    EXPECT_EQ(result.exitCode, 1) << result.err;
    expectRow("pictures", name, "wrong", "worst at");
  };
  // One block of 144, by an eighth of its range.
  const auto inOneBlock = [](nlohmann::json& blocks) {
    blocks.at(60)[1] = blocks.at(60)[1].get<double>() + blocks.at(60)[3].get<double>() / 8.0 + 0.0005;
  };
  expectWrong("rsm-cornell", inOneBlock);
  expectWrong("path-cornell", inOneBlock);
  // One part in 100,000 of a channel of all.
  expectWrong("path-cornell", [](nlohmann::json& blocks) {
    for (nlohmann::json& block : blocks) block[1] = 1.00001 * block[1].get<double>();
  });
}

// Light that lacks 1 %: over the whole picture it shows.
TEST_F(Check, AWrongShaderIsAWrongPicture) {
  const FaultyShaders shaders;
  shaders.plant("lib/coat_reflection.glsl", "albedo / kPi", "albedo / 3.173");
  const RunResult result =
      check("--only pictures/direct-atrium", fmt::format("LUCERNA_SHADERS='{}'", shaders.path().string()));
  EXPECT_EQ(result.exitCode, 1) << result.err;
  expectRow("pictures", "direct-atrium", "wrong", "mean");
}

TEST_F(Check, FaultsAreRowsAndTheRestGoesOn) {
  const struct {
    const char *fault, *status, *text;
  } cases[] = {{"crash", "crashed", "signal 11, in: a fault for a test"},
               {"exit", "failed", "exit code 7, in: a fault"},
               {"reset", "reset", "the driver reset the GPU"}};
  for (const auto& c : cases) {
    const RunResult result =
        check("--only probes/timers,probes/arithmetic", fmt::format("LUCERNA_CHECK_FAULT=probes/timers={}", c.fault));
    EXPECT_EQ(result.exitCode, 1) << c.fault << result.err;
    expectRow("probes", "timers", c.status, c.text);
    expectRow("probes", "arithmetic", "right", "int(1e20)");
  }
}

TEST_F(Check, TooLittleTimeIsNoFault) {
  const RunResult result = check("--only sharing,error --minutes 0.1");
  EXPECT_EQ(result.exitCode, 0) << result.out << result.err;
  expectRow("context", "limits", "right", "OpenGL");
  expectRow("sharing", "four-processes", "not run", "no time left");
  expectRow("error", "cornell", "not run", "no time left");
}

// Passes that take ten seconds and more each (llvmpipe leaves loops after 65,535 iterations, so each has 256 reads):
// the row names the pass.
TEST_F(Check, AHangNamesItsPass) {
  const FaultyShaders shaders;
  std::string reads = "0u";
  for (int k = 0; k < 256; ++k) reads += fmt::format(" + before[(i + at + {}u) % count]", 17 * k);
  shaders.plant("check/step_words.comp", "if (at < count)",
                "for (uint i = 0u; i < 65000u; ++i)\n    if (" + reads + " == ~0u) return;\n  if (at < count)");
  const RunResult result = check("--only probes/feedback,probes/arithmetic --minutes 0.5",
                                 fmt::format("LUCERNA_SHADERS='{}'", shaders.path().string()));
  EXPECT_EQ(result.exitCode, 1) << result.err;
  expectRow("probes", "feedback", "hung", "in: steps of storage blocks, pass step");
  expectRow("probes", "arithmetic", "right", "int(1e20)");
}

TEST_F(Check, WithoutOpenGlItEndsWithThree) {
  const RunResult result = check("--only probes/timers", "LUCERNA_CHECK_FAULT=context/limits=exit");
  EXPECT_EQ(result.exitCode, 3) << result.err;
  expectRow("probes", "timers", "not run", "context/limits failed");
}

// Killed, even without a chance to say so, it goes on after the units that had ended; the one that ran is not run
// again, since it may have been the cause.
TEST_F(Check, ResumesAfterAnInterruption) {
  const std::string options = "--only probes/timers,probes/arithmetic,probes/texels";
  const std::string hang = "LUCERNA_CHECK_FAULT=probes/arithmetic=hang";
  // Signals the check once that unit runs.
  const auto stopped = [&](const char* signal) {
    return run(fmt::format("{0} '" LUCERNA_BINARY "' check --quiet --out '{1}' {2} & check=$!\n"
                           "until grep -qs '\"running\":\"probes/arithmetic\"' '{1}/state.json'; do sleep 0.1; done\n"
                           "kill -{3} $check; wait $check",
                           hang, out().string(), options, signal));
  };
  const RunResult interrupted = stopped("INT");
  EXPECT_EQ(interrupted.exitCode, 130) << interrupted.err;
  EXPECT_NE(interrupted.err.find("resumes"), std::string::npos);
  EXPECT_FALSE(fs::exists(out() / "check.json"));
  const auto state = nlohmann::json::parse(readFileText(out() / "state.json"));
  ASSERT_EQ(state.at("rows").size(), 3u) << "context, texels and timers";
  EXPECT_EQ(state.at("running"), "");
  EXPECT_EQ(stopped("KILL").exitCode, 137);
  EXPECT_EQ(nlohmann::json::parse(readFileText(out() / "state.json")).at("running"), "probes/arithmetic");
  const RunResult rest = check(options);
  EXPECT_EQ(rest.exitCode, 1) << rest.err;
  expectRow("probes", "timers", "right", "queries");
  expectRow("probes", "texels", "right", "texels");
  expectRow("probes", "arithmetic", "crashed", "ended while this ran");
  EXPECT_EQ(report().at("rows").size(), 4u);
  EXPECT_EQ(row("probes", "timers").at("seconds"), state.at("rows").at(2).at("seconds")) << "not run again";
  EXPECT_EQ(check(options).exitCode, 0) << "a finished check begins anew";
}

TEST_F(Check, WrongOptionsAreNamed) {
  EXPECT_EQ(check("--only nothing").exitCode, 2);
  const RunResult unknown = check("--part pictures/nothing");
  EXPECT_EQ(unknown.exitCode, 2);
  EXPECT_NE(unknown.err.find("no such unit"), std::string::npos) << unknown.err;
  writeFileAtomically(folder_ / "file", "");
  EXPECT_EQ(RUN_LUCERNA("check --out '" + (folder_ / "file").string() + "'").exitCode, 2);
}

}  // namespace
}  // namespace lucerna::test
