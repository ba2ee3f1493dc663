// The program finds its data wherever it lies: in a build tree, in a prefix that was moved, by a link, through PATH, by
// LUCERNA_DATA.
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace {

namespace fs = std::filesystem;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

// Shaders, a scene and no more: draws a picture of the Cornell box that comes with the program.
const char* kRender = " render cornell.obj --technique direct --size 16x16 --quiet -o ";

class DataFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const fs::path cornell = fs::path(LUCERNA_SOURCE_DIR) / "assets/cornell";
    for (const char* name : {"cornell.obj", "cornell.mtl"}) fs::copy(cornell / name, folder_ / name);
    fs::create_directories(folder_ / "prefix/bin");
    fs::copy(LUCERNA_BINARY, folder_ / "prefix/bin/lucerna");
  }
  /// A prefix's share/lucerna, with the source tree's folders.
  void addData(const fs::path& data) const {
    fs::create_directories(data);
    for (const char* name : {"shaders", "assets", "keyFrames"})
      fs::create_directory_symlink(fs::path(LUCERNA_SOURCE_DIR) / name, data / name);
  }
  /// `program` draws in this test's folder, with nothing in the environment that says where data lies.
  RunResult render(const std::string& program, const std::string& environment = "XDG_DATA_DIRS=/nowhere") const {
    fs::remove(folder_ / "out.pfm");
    return run("cd '" + folder_.path().string() + "' && unset LUCERNA_DATA LUCERNA_SHADERS && " + environment + " " +
               program + kRender + "out.pfm");
  }
  void expectDraws(const std::string& program, const std::string& environment = "XDG_DATA_DIRS=/nowhere") const {
    const RunResult result = render(program, environment);
    EXPECT_EQ(result.exitCode, 0) << program << ": " << result.err;
    EXPECT_TRUE(fs::exists(folder_ / "out.pfm")) << program;
  }
  TempFolder folder_;
};

TEST_F(DataFolder, IsFoundInAPrefixThatIsMovedLinkedOrInPath) {
  addData(folder_ / "prefix/share/lucerna");
  expectDraws("prefix/bin/lucerna");
  fs::create_directories(folder_ / "usr/bin");
  fs::create_symlink("../../moved/bin/lucerna", folder_ / "usr/bin/lucerna");
  fs::rename(folder_ / "prefix", folder_ / "moved");
  expectDraws("moved/bin/lucerna");
  expectDraws("usr/bin/lucerna");
  expectDraws("lucerna", "XDG_DATA_DIRS=/nowhere PATH=\"$PWD/moved/bin:$PATH\"");
  expectDraws("lucerna", "XDG_DATA_DIRS=/nowhere PATH=\"usr/bin:$PATH\"");
}

TEST_F(DataFolder, IsFoundBesideTheExecutableOfABuildTree) {
  addData(folder_ / "prefix/bin/share/lucerna");
  expectDraws("prefix/bin/lucerna");
}

TEST_F(DataFolder, IsFoundInXdgDataDirs) {
  addData(folder_ / "elsewhere/lucerna");
  expectDraws("prefix/bin/lucerna", "XDG_DATA_DIRS=\"/nowhere:$PWD/elsewhere\"");
}

TEST_F(DataFolder, LucernaDataComesFirstAndIsRefusedWithoutTheThreeFolders) {
  addData(folder_ / "data");
  expectDraws("prefix/bin/lucerna", "XDG_DATA_DIRS=/nowhere LUCERNA_DATA=data");
  addData(folder_ / "prefix/share/lucerna");
  fs::create_directories(folder_ / "wrong/shaders");
  const RunResult refused = render("prefix/bin/lucerna", "LUCERNA_DATA=wrong");
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_EQ(
      refused.err,
      "lucerna: LUCERNA_DATA=wrong: expected a folder with shaders, assets and keyFrames; it has no folder assets\n");
  EXPECT_FALSE(fs::exists(folder_ / "out.pfm"));
}

TEST_F(DataFolder, NoneIsALackWithThePlacesNamed) {
  const RunResult result = render("prefix/bin/lucerna");
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_NE(result.err.find("prefix/share/lucerna, /nowhere/lucerna has"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("LUCERNA_DATA"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(folder_ / "out.pfm"));
}

// With data of its own the walk's default scene comes from there too.
TEST_F(DataFolder, TheWalksSceneIsTheDataFolders) {
  fs::create_directories(folder_ / "data/assets");
  for (const char* name : {"shaders", "keyFrames"})
    fs::create_directory_symlink(fs::path(LUCERNA_SOURCE_DIR) / name, folder_ / "data" / name);
  const RunResult result = run("LUCERNA_DATA='" + (folder_ / "data").string() +
                               "' '" LUCERNA_BINARY "' walk --record '" + (folder_ / "out").string() + "'");
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("data/assets/atrium/day.json: no such file"), std::string::npos) << result.err;
}

TEST(Executable, HoldsNoPathOfTheSourceTree) {
  std::ifstream stream(LUCERNA_BINARY, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  ASSERT_GT(content.str().size(), 100000u);
  if (content.str().find(".debug_info") != std::string::npos) GTEST_SKIP() << "debug information names the sources";
  EXPECT_EQ(content.str().find(LUCERNA_SOURCE_DIR), std::string::npos) << "with ccache, set base_dir";
}

}  // namespace
