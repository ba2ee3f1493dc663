// One rule for every command that is stopped by Ctrl-C or SIGTERM: state is kept, no final file is written, the exit
// code is 130 or 143, and the same command ends with the file that an undisturbed run writes, bit by bit.
#include "base/clock.hpp"
#include "base/files.hpp"
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace lucerna::test {
namespace {

namespace fs = std::filesystem;

class Interrupt : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(path("room.obj")) << R"(mtllib room.mtl
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -1 2 -1
v 1 2 -1
v 1 2 1
v -1 2 1
v -0.3 1.99 -0.3
v 0.3 1.99 -0.3
v 0.3 1.99 0.3
v -0.3 1.99 0.3
usemtl grey
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 4 8 7 3
f 1 5 8 4
f 2 3 7 6
usemtl lamp
f 9 10 11 12
)";
    std::ofstream(path("room.mtl")) << "newmtl grey\nKd 0.9 0.9 0.9\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n";
  }
  std::string path(const char* name) const { return (folder_ / name).string(); }

  /// Runs `command` undisturbed for its file and its time; then stops it at half of that time and lets it go on. The
  /// long form does so at further shares. Where it had ended by then, or did not yet watch, since others keep the
  /// machine busy or do no longer, it is stopped earlier or later.
  void expectGoesOn(const std::string& command, const std::string& out, const char* signal, int code) {
    const auto begun = std::chrono::steady_clock::now();
    const RunResult whole = run(command);
    const double seconds = secondsSince(begun);
    ASSERT_EQ(whole.exitCode, 0) << whole.err;
    const auto expected = readFileBytes(out);
    for (const double share : longTests() ? std::vector{0.5, 0.3, 0.2, 0.8} : std::vector{0.5}) {
      bool underWay = false;
      double after = share * seconds;
      for (int attempt = 0; attempt < 12 && !underWay; ++attempt) {
        fs::remove(out);
        const RunResult stopped = run("timeout --preserve-status --signal=" + std::string(signal) + " " +
                                      std::to_string(after) + " " + command);
        underWay = stopped.err.find("resumes from") != std::string::npos;
        after *= stopped.exitCode == 0 ? 0.5 : 1.4;
        if (stopped.exitCode == 0) continue;
        EXPECT_EQ(stopped.exitCode, code) << stopped.err;
        EXPECT_FALSE(fs::exists(out)) << "a final file of unfinished work";
      }
      ASSERT_TRUE(underWay) << "it was never stopped under way: " << seconds << " s";
      const RunResult rest = run(command);
      ASSERT_EQ(rest.exitCode, 0) << rest.err;
      EXPECT_EQ(readFileBytes(out), expected) << signal << " at " << share;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(out).parent_path()))
      EXPECT_TRUE(entry.path() == out || entry.path().extension() == ".obj" || entry.path().extension() == ".mtl")
          << entry.path() << " is left over";
  }

 private:
  TempFolder folder_;
};

TEST_F(Interrupt, ASolutionIsNotWrittenBeforeItIsOne) {
  // Products one by one from the rows' file: most of the time goes into the solver.
  expectGoesOn("'" LUCERNA_BINARY "' radiosity solve '" + path("room.obj") + "' '" + path("o.sol") +
                   "' 16 --edge 0.25 --memory 0.01 --visibility rays --solver jacobi --error 1e-6 --quiet",
               path("o.sol"), "INT", 130);
}

TEST_F(Interrupt, ARefinedSolutionTakesUpItsOwnRows) {
  expectGoesOn(
      "'" LUCERNA_BINARY "' radiosity solve '" + path("room.obj") + "' '" + path("o.sol") +
          "' 16 --edge 0.36 --memory 0.01 --refinements 1 --visibility rays --solver jacobi --error 1e-5 --quiet",
      path("o.sol"), "TERM", 143);
}

// Also a picture of the technique, which names no file for its solution.
TEST_F(Interrupt, APictureOfRadiosityTakesUpItsOwnRows) {
  fs::create_directory(path("pictures"));
  expectGoesOn("env LUCERNA_REFERENCES='" + path("kept") + "' '" LUCERNA_BINARY "' render '" + path("room.obj") +
                   "' --technique radiosity --camera 0,1,0.9,0,1,0,70 --size 16x16 --pixel-samples 1"
                   " --set radiosity.edge=0.6 --set radiosity.visibility=rays --set radiosity.direct=patches"
                   " --quiet -o '" +
                   path("pictures/o.pfm") + "'",
               path("pictures/o.pfm"), "TERM", 143);
  EXPECT_TRUE(fs::is_empty(path("kept")));
}

TEST_F(Interrupt, APathTracedPictureGoesOnFromItsFilm) {
  expectGoesOn("'" LUCERNA_BINARY "' render '" + path("room.obj") +
                   "' --technique path --camera 0,1,0.9,0,1,0,70 --size 64x64 --spp 96 --quiet -o '" + path("o.pfm") +
                   "'",
               path("o.pfm"), "INT", 130);
}

TEST_F(Interrupt, AFullDiskDoesNotCostTheFinishedPicture) {
  const RunResult result =
      run("'" LUCERNA_BINARY "' render '" + path("room.obj") +
          "' --technique path --camera 0,1,0.9,0,1,0,70 --size 16x16 --spp 2 --quiet --checkpoint /dev/full/none -o '" +
          path("o.pfm") + "'");
  EXPECT_EQ(result.exitCode, 2) << result.err;
  EXPECT_TRUE(fs::exists(path("o.pfm")));
}

}  // namespace
}  // namespace lucerna::test
