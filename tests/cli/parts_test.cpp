// render --samples, merge, cluster: parts of a path traced picture made apart are the picture of one run.
#include "base/files.hpp"
#include "base/image.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

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

TEST_F(Parts, AClusterOfOneMachineMakesTheSamePicture) {
  ASSERT_EQ(RUN_LUCERNA("render " + picture() + "--spp 48 --quiet -o '" + path("one.pfm") + "'").exitCode, 0);
  const std::string job = "'" + path("job") + "'";
  const RunResult planned = RUN_LUCERNA("cluster plan -o " + job + " --tasks 6 --quiet -- render " + picture() +
                                        "--spp 48 -o '" + path("joined.pfm") + "'");
  ASSERT_EQ(planned.exitCode, 0) << planned.err;
  expectRefused(
      "cluster plan -o " + job + " --tasks 6 -- render " + picture() + "--spp 48 -o '" + path("joined.pfm") + "'",
      "holds a job");
  expectRefused("cluster join " + job, "not done");
  expectRefused("cluster plan -o '" + path("more") + "' --tasks 9 -- render " + picture() + "--spp 8 -o x.pfm",
                "--tasks 9");
  expectRefused("cluster plan -o '" + path("more") + "' -- render x.json --technique lpv --spp 8 -o x.pfm",
                "only --technique path");
  expectRefused("cluster status '" + path("more") + "'", "no job");
  // One task alone, as of an array; a second claim finds it done.
  ASSERT_EQ(RUN_LUCERNA("cluster run " + job + " --task 2 --quiet").exitCode, 0);
  EXPECT_TRUE(fs::exists(path("job") + "/done/2.json"));
  const auto made = fs::last_write_time(path("job") + "/parts/2.film");
  // Another one's, who died: an old sign of life. And one who lives: its task is left alone until then.
  std::ofstream(path("job") + "/claims/4.0") << "a machine that is gone\n";
  fs::last_write_time(path("job") + "/claims/4.0", fs::file_time_type::clock::now() - std::chrono::hours(1));
  ASSERT_EQ(RUN_LUCERNA("cluster status " + job + " --quiet --json '" + path("status.json") + "'").exitCode, 0);
  EXPECT_EQ(json("status.json"),
            nlohmann::json({{"tasks", 6}, {"done", 1}, {"running", 0}, {"abandoned", 1}, {"waiting", 4}}));
  const RunResult ran = RUN_LUCERNA("cluster run " + job + " --jobs 2 --quiet --json '" + path("run.json") + "'");
  ASSERT_EQ(ran.exitCode, 0) << ran.err << ran.out;
  EXPECT_EQ(json("run.json").at("done_here"), 5);
  EXPECT_EQ(fs::last_write_time(path("job") + "/parts/2.film"), made);  // not done twice
  EXPECT_TRUE(fs::exists(path("job") + "/claims/4.1"));
  const RunResult joined = RUN_LUCERNA("cluster join " + job + " --quiet");
  ASSERT_EQ(joined.exitCode, 0) << joined.err;
  expectSame(readImage(path("one.pfm")), readImage(path("joined.pfm")), 1e-6);
}

// Two workers at once, in processes of their own: each task is claimed by one of them.
TEST_F(Parts, NoTaskIsDoneTwice) {
  const std::string job = path("job");
  ASSERT_EQ(RUN_LUCERNA("cluster plan -o '" + job + "' --tasks 8 --quiet -- render " + picture() + "--spp 16 -o '" +
                        path("joined.pfm") + "'")
                .exitCode,
            0);
  const std::string work = "'" LUCERNA_BINARY "' cluster run '" + job + "' --quiet --json ";
  const RunResult both =
      test::run(work + "'" + path("a.json") + "' & " + work + "'" + path("b.json") + "'; code=$?; wait; exit $code");
  ASSERT_EQ(both.exitCode, 0) << both.err;
  EXPECT_EQ(json("a.json").at("done_here").get<int>() + json("b.json").at("done_here").get<int>(), 8);
  int claims = 0;
  for (const auto& entry : fs::directory_iterator(job + "/claims"))
    claims += entry.path().filename().string()[0] != '.';
  EXPECT_EQ(claims, 8);
}

}  // namespace
