// bench diff; and the page of a report, driven in headless Chromium: every number shown is the JSON's, every key does
// what its help says.
#include "base/files.hpp"
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

namespace {

namespace fs = std::filesystem;
using namespace lucerna;

class ReportPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::run("command -v node && command -v chromium").exitCode != 0)
      GTEST_SKIP() << "node or chromium is missing (Debian packages nodejs, chromium)";
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  /// `page` in headless Chromium, against the JSON of the command that made it; a line a fault, and the number of
  /// checks.
  void expectNoFault(const std::string& page, const std::string& json, int checks) {
    const auto driven =
        test::run("timeout 300 node '" LUCERNA_SOURCE_DIR "/tests/cli/report_page.js' \"$(command -v chromium)\" '" +
                  path(page) + "' '" + path(json) + "'");
    EXPECT_EQ(driven.exitCode, 0) << driven.out << driven.err;
    const auto found = driven.out.find(" checks, 0 faults");
    ASSERT_NE(found, std::string::npos) << driven.out;
    EXPECT_GE(std::atoi(driven.out.c_str() + driven.out.rfind('\n', found) + 1), checks) << driven.out;
  }
  void bench(const std::string& command) {
    const auto result = RUN_LUCERNA("bench " + command + " --references '" + path("references") + "' --quiet");
    ASSERT_EQ(result.exitCode, 0) << result.err;
  }

 private:
  test::TempFolder folder_;
};

TEST_F(ReportPage, ShowsTheNumbersOfItsJsonAndObeysItsKeys) {
  ASSERT_NO_FATAL_FAILURE(bench("error '" LUCERNA_SOURCE_DIR
                                "/assets/cornell/cornell.json' --size 32x18 --reference-spp 64 --budget 2 --frames 2 "
                                "--small --techniques direct,rsm,path --out '" +
                                path("out") + "'"));
  expectNoFault("out/report.html", "out/error.json", 300);
}

// More pictures than there is room for: some are means over blocks, and every point has one still.
TEST_F(ReportPage, WithoutRoomForAllPicturesSomeAreCoarser) {
  if (!test::longTests()) GTEST_SKIP() << "minutes: LUCERNA_LONG_TESTS";
  ASSERT_NO_FATAL_FAILURE(bench("error '" LUCERNA_SOURCE_DIR
                                "/assets/cornell/cornell.json' --size 424x238 --reference-spp 16 --budget 2 --frames 1 "
                                "--small --techniques direct,rsm --out '" +
                                path("out") + "'"));
  const std::string page = readFileText(path("out/report.html"));
  EXPECT_NE(page.find("\"block\":2,\"first_choice\":false"), std::string::npos);
  EXPECT_NE(page.find("\"block\":1,\"first_choice\":true"), std::string::npos);
  expectNoFault("out/report.html", "out/error.json", 300);
}

// Glass and coloured media: the path tracer is judged by one more reference, with all materials as they are.
TEST_F(ReportPage, OpensAReportOfMedia) {
  ASSERT_NO_FATAL_FAILURE(bench("error '" LUCERNA_SOURCE_DIR
                                "/assets/media/gems/gems.json' --size 32x18 --reference-spp 32 --budget 1 --frames 1 "
                                "--small --techniques direct,path --out '" +
                                path("out") + "'"));
  expectNoFault("out/report.html", "out/error.json", 200);
}

TEST_F(ReportPage, OfAPairOfPictures) {
  const std::string render = "render '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --size 32x18 --quiet ";
  ASSERT_EQ(RUN_LUCERNA(render + "--technique direct -o '" + path("a.pfm") + "'").exitCode, 0);
  ASSERT_EQ(RUN_LUCERNA(render + "--technique path --spp 16 -o '" + path("b.pfm") + "'").exitCode, 0);
  const auto compared = RUN_LUCERNA("compare '" + path("a.pfm") + "' '" + path("b.pfm") + "' --page '" +
                                    path("pair.html") + "' --json '" + path("pair.json") + "' --quiet");
  ASSERT_EQ(compared.exitCode, 0) << compared.err;
  expectNoFault("pair.html", "pair.json", 15);
}

TEST_F(ReportPage, OfTheWholeReport) {
  if (!test::longTests()) GTEST_SKIP() << "minutes: LUCERNA_LONG_TESTS";
  const auto all =
      test::run("LUCERNA_REFERENCES='" + path("references") +
                "' '" LUCERNA_BINARY "' bench all '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --out '" +
                path("out") + "' --scale 0.02 --parts error,features --json '" + path("all.json") + "' --quiet");
  ASSERT_EQ(all.exitCode, 0) << all.err;
  expectNoFault("out/index.html", "all.json", 300);
}

// A report as `bench error` writes it, but for what is drawn: three rows of known spreads.
nlohmann::json reportOf(double l2Error, double factor = 1.0) {
  nlohmann::json report{{"bench", "room, 32x18"}, {"rows", nlohmann::json::array()}};
  for (int i = 0; i < 12; ++i) {
    const double l2 = 0.1 * (i + 1) * factor, ms = 10.0 * (i + 1);
    report["rows"].push_back({{"label", "rsm samples=" + std::to_string(i)},
                              {"ms", ms},
                              {"wall_ms_samples", {0.98 * ms, ms, 1.03 * ms}},
                              {"l2", l2},
                              {"l2_error", l2Error * l2},
                              {"noise_l2", 0.01},
                              {"at_noise", false},
                              {"bias", 0.02},
                              {"relative_bias", 0.02},
                              {"bias_error", 0.0005}});
  }
  return report;
}

class BenchDiff : public ::testing::Test {
 protected:
  void write(const std::string& name, const nlohmann::json& report) {
    std::ofstream(folder_.path() / name) << report.dump();
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  /// The verdicts, by label; the exit code first.
  int diff(const std::string& more = "") {
    const auto result = RUN_LUCERNA("bench diff '" + path("a.json") + "' '" + path("b.json") + "' --json '" +
                                    path("diff.json") + "' --quiet " + more);
    err_ = result.err;
    if (std::filesystem::exists(path("diff.json"))) verdicts_ = nlohmann::json::parse(std::ifstream(path("diff.json")));
    return result.exitCode;
  }
  std::string verdict(std::size_t row) const { return verdicts_.at("rows").at(row).at("verdict"); }

  std::string err_;
  nlohmann::json verdicts_;

 private:
  test::TempFolder folder_;
};

TEST_F(BenchDiff, FindsAPlantedLossOfOnePercentAndNothingElse) {
  const nlohmann::json a = reportOf(0.001);
  write("a.json", a);
  nlohmann::json b = a;
  b["rows"][4]["l2"] = 1.01 * a["rows"][4]["l2"].get<double>();  // seven standard errors of the difference
  b["rows"][7]["relative_bias"] = 0.02 - 0.01,
  b["rows"][7]["bias"] = 0.02 - 0.01;  // light is lost: nearer to none, so better here
  b["rows"][8]["relative_bias"] = 0.02 + 0.01, b["rows"][8]["bias"] = 0.02 + 0.01;
  write("b.json", b);
  EXPECT_EQ(diff(), 1) << err_;
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_EQ(verdict(i), i == 4 || i == 8 ? "worse" : i == 7 ? "better" : "undecided") << i;
  // The same loss within spreads ten times as large is nobody's.
  write("a.json", reportOf(0.01));
  b = reportOf(0.01);
  b["rows"][4]["l2"] = 1.01 * b["rows"][4]["l2"].get<double>();
  write("b.json", b);
  EXPECT_EQ(diff(), 0) << err_;
  EXPECT_EQ(verdict(4), "undecided");
}

// Errors drawn again and times of a machine that is slower by 30 % and scatters by 5 %: thirty runs, of which one in a
// hundred may find something: three of them have a chance of 0.3 %.
TEST_F(BenchDiff, DoesNotCryAtASecondRunOfTheSame) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const nlohmann::json a = reportOf(0.01);
  int cried = 0;
  for (int run = 0; run < 30; ++run) {
    nlohmann::json one = a, two = a;
    for (nlohmann::json* report : {&one, &two})
      for (auto& row : (*report)["rows"]) {
        const double machine = (report == &two ? 1.3 : 1.0) * std::exp(0.05 * normal(random));
        row["l2"] = row["l2"].get<double>() * (1.0 + 0.01 * normal(random));
        row["relative_bias"] = row["bias"] = 0.02 + 0.0005 * normal(random);
        row["ms"] = row["ms"].get<double>() * machine;
        for (auto& ms : row["wall_ms_samples"]) ms = ms.get<double>() * machine;
      }
    write("a.json", one);
    write("b.json", two);
    cried += diff() != 0;
  }
  EXPECT_LE(cried, 2);
}

TEST_F(BenchDiff, TimesAreJudgedAgainstTheOtherRows) {
  write("a.json", reportOf(0.01));
  nlohmann::json b = reportOf(0.01);
  for (auto& row : b["rows"]) row["ms"] = 1.2 * row["ms"].get<double>();  // a slower machine
  b["rows"][3]["ms"] = 3.0 * b["rows"][3]["ms"].get<double>();
  write("b.json", b);
  EXPECT_EQ(diff(), 1) << err_;
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(verdict(i), i == 3 ? "worse" : "undecided") << i;
  EXPECT_NEAR(verdicts_.at("time_ratio"), 1.2, 1e-9);
  EXPECT_EQ(diff("--only error"), 0) << err_;
}

// Another program's load made one row's pictures slow for as long as they were measured: its processor time did not
// change. A row that became slow itself has both. What a GPU draws takes no processor time.
TEST_F(BenchDiff, TheLoadOfOthersIsNoLossWhereTheProcessorDraws) {
  const auto written = [&](const char* renderer, double wall, double processor) {
    nlohmann::json a = reportOf(0.01), b = reportOf(0.01);
    for (nlohmann::json* report : {&a, &b}) {
      (*report)["renderer"] = renderer;
      for (auto& row : (*report)["rows"]) row["cpu_ms"] = 1.5 * row["ms"].get<double>();
    }
    b["rows"][3]["ms"] = wall * b["rows"][3]["ms"].get<double>();
    b["rows"][3]["cpu_ms"] = processor * b["rows"][3]["cpu_ms"].get<double>();
    write("a.json", a);
    write("b.json", b);
  };
  written("llvmpipe (LLVM 15.0.6, 256 bits)", 3.5, 1.0);
  EXPECT_EQ(diff(), 0) << err_;
  EXPECT_EQ(verdict(3), "undecided");
  written("llvmpipe (LLVM 15.0.6, 256 bits)", 3.5, 3.4);
  EXPECT_EQ(diff(), 1) << err_;
  EXPECT_EQ(verdict(3), "worse");
  written("NVIDIA A100", 3.5, 1.0);
  EXPECT_EQ(diff(), 1) << err_;
  EXPECT_EQ(verdict(3), "worse");
}

TEST_F(BenchDiff, WhatIsAtTheNoiseIsABound) {
  nlohmann::json a = reportOf(0.001), b = a;
  a["rows"][0]["at_noise"] = true;  // below 3 %
  a["rows"][0]["l2"] = 0.01;
  b["rows"][0]["l2"] = 0.1;
  a["rows"][1]["at_noise"] = b["rows"][1]["at_noise"] = true;
  a["rows"][1]["l2"] = 0.001, b["rows"][1]["l2"] = 0.02;
  b["rows"][2]["l2"] = nullptr;  // no longer finite
  b["rows"].erase(11);
  write("a.json", a);
  write("b.json", b);
  EXPECT_EQ(diff(), 1) << err_;
  EXPECT_EQ(verdict(0), "worse");
  EXPECT_EQ(verdict(1), "undecided");
  EXPECT_EQ(verdict(2), "worse");
  EXPECT_EQ(verdicts_.at("gone").size(), 1u);
}

// A sweep of path tracing goes as far as there is time: a slower second run has fewer points, and nothing is lost.
TEST_F(BenchDiff, ASweepThatHadLessTimeIsNoLoss) {
  const auto report = [](std::initializer_list<int> samples) {
    nlohmann::json r = reportOf(0.01);
    for (int spp : samples) {
      nlohmann::json row = r["rows"][0];
      row["label"] = "path spp=" + std::to_string(spp);
      row["series"] = "path";
      row["spp"] = spp;
      r["rows"].push_back(row);
    }
    return r;
  };
  write("a.json", report({1, 2, 4, 8, 16}));
  write("b.json", report({1, 2, 4}));
  EXPECT_EQ(diff(), 0) << err_;
  EXPECT_EQ(verdicts_.at("not_reached"), nlohmann::json({"path spp=8", "path spp=16"}));
  EXPECT_TRUE(verdicts_.at("gone").empty());
  write("b.json", report({1, 2, 8}));  // a point in the middle is missed
  EXPECT_EQ(diff(), 1) << err_;
  EXPECT_EQ(verdicts_.at("gone"), nlohmann::json({"path spp=4"}));
  write("b.json", report({}));  // as is a whole sweep
  EXPECT_EQ(diff(), 1) << err_;
  EXPECT_EQ(verdicts_.at("gone").size(), 5u);
}

TEST_F(BenchDiff, WhatIsNoPairOfReportsIsRefused) {
  write("a.json", reportOf(0.01));
  nlohmann::json b = reportOf(0.01);
  b["bench"] = "another room";
  write("b.json", b);
  EXPECT_EQ(diff(), 2);
  EXPECT_NE(err_.find("another room"), std::string::npos) << err_;
  write("b.json", {{"bench", "room, 32x18"}, {"rows", {{{"ms", 3}}}}});
  EXPECT_EQ(diff(), 2) << err_;
  write("b.json", {1, 2});
  EXPECT_EQ(diff(), 2) << err_;
}

}  // namespace
