// What cmake --install and cpack make: works in a prefix that was moved, with the source and build trees away.
#include "support/sanitizers.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <memory>
#include <sstream>
#include <vector>

namespace {

namespace fs = std::filesystem;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

const fs::path kBuild = fs::path(LUCERNA_BINARY).parent_path();

bool installed(const std::string& program) { return run("command -v " + program).exitCode == 0; }

std::string inQuotes(const fs::path& path) { return fmt::format("'{}'", path.string()); }

/// Installed once for all tests, then moved: what still knows the first place fails.
class Installed : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TempFolder>();
    const RunResult result =
        run(std::string("cmake --install ") + inQuotes(kBuild) + " --prefix " + inQuotes(*folder_ / "first"));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    fs::rename(*folder_ / "first", prefix());
    canHide_ = run("unshare -rm true").exitCode == 0;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static fs::path prefix() { return *folder_ / "moved"; }
  static fs::path path(const std::string& name) { return *folder_ / name; }

  /// `command` in this test's folder where the source and build trees are empty folders (a mount namespace of its own).
  static RunResult runWithoutSources(const std::string& command) {
    std::string hide;
    for (const fs::path& tree : {fs::path(LUCERNA_SOURCE_DIR), kBuild})
      hide += std::string("[ ! -d ") + inQuotes(tree) + " ] || mount -t tmpfs none " + inQuotes(tree) + " || exit 99; ";
    std::ofstream(path("hidden.sh")) << hide << "test ! -e " << inQuotes(fs::path(LUCERNA_SOURCE_DIR) / "shaders")
                                     << " || exit 98\n"
                                     << "unset LUCERNA_DATA LUCERNA_SHADERS; export XDG_DATA_DIRS=/nowhere; cd "
                                     << inQuotes(folder_->path()) << "\n"
                                     << command << "\n";
    return run(std::string("cd / && unshare -rm sh ") + inQuotes(path("hidden.sh")));
  }

  static std::unique_ptr<TempFolder> folder_;
  static bool canHide_;
};
std::unique_ptr<TempFolder> Installed::folder_;
bool Installed::canHide_ = false;

#define NEEDS_NAMESPACES() \
  if (!canHide_) GTEST_SKIP() << "no mount namespaces here (unshare -rm): the source tree cannot be hidden"

TEST_F(Installed, HasWhatTheProgramNeedsAndNothingElse) {
  for (const char* name :
       {"bin/lucerna", "share/lucerna/shaders/forward/surface.frag", "share/lucerna/assets/atrium/atrium.json",
        "share/lucerna/keyFrames/atrium.txt", "include/lucerna/base/error.hpp", "include/lucerna/shared/lights.h",
        "share/man/man1/lucerna.1.gz", "share/man/man1/lucerna-bench.1.gz", "share/bash-completion/completions/lucerna",
        "share/fish/vendor_completions.d/lucerna.fish", "share/applications/alt.lucerna.Lucerna.desktop"})
    EXPECT_TRUE(fs::exists(prefix() / name)) << name;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(prefix())) {
    EXPECT_NE(entry.path().extension(), ".py") << entry.path();
    EXPECT_NE(entry.path().extension(), ".cpp") << entry.path();
    EXPECT_NE(entry.path().filename(), "generator") << entry.path();
  }
}

TEST_F(Installed, HoldsNoPathOfTheSourceTreeNorOfThePrefix) {
  if (run(std::string("grep -qF .debug_info ") + inQuotes(prefix() / "bin/lucerna")).exitCode == 0)
    GTEST_SKIP() << "debug information names the sources";
  for (const fs::path& tree : {fs::path(LUCERNA_SOURCE_DIR), *folder_ / "first"}) {
    const RunResult found = run(std::string("grep -rlF ") + inQuotes(tree) + " " + inQuotes(prefix()));
    EXPECT_EQ(found.exitCode, 1) << tree << " is named in\n" << found.out << "with ccache, set base_dir";
  }
}

TEST_F(Installed, ProgramRunsWithTheSourceTreeAway) {
  NEEDS_NAMESPACES();
  const RunResult result = runWithoutSources(
      "moved/bin/lucerna render moved/share/lucerna/assets/cornell/cornell.json --technique direct --size 32x32 -o "
      "direct.png");
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_TRUE(fs::exists(path("direct.png")));
}

// Configured, built and run against the moved prefix with the sources away; draws what the program draws.
TEST_F(Installed, ConsumerDrawsWhatTheProgramDraws) {
  NEEDS_NAMESPACES();
  if (lucerna::test::kSanitized) GTEST_SKIP() << "the library of a sanitizer build is not for others";
  fs::copy(fs::path(LUCERNA_SOURCE_DIR) / "tests/consumer", path("consumer"), fs::copy_options::recursive);
  const RunResult built = runWithoutSources(
      "cmake -S consumer -B consumer/build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER=" LUCERNA_COMPILER
      " -DCMAKE_PREFIX_PATH=\"$PWD/moved\" && cmake --build consumer/build");
  ASSERT_EQ(built.exitCode, 0) << built.out << built.err;
  const std::string scene = "moved/share/lucerna/assets/cornell/cornell.json";
  const RunResult consumer = runWithoutSources("consumer/build/consumer " + scene + " consumer.pfm $LUCERNA_HOST");
  ASSERT_EQ(consumer.exitCode, 0) << consumer.err;
  EXPECT_TRUE(fs::exists(path("consumer.pfm")));

  const RunResult program = runWithoutSources("moved/bin/lucerna render " + scene +
                                              " --technique lpv --set lpv.cells=16 "
                                              "--size 96x64 --quiet -o program.pfm --json program.json");
  ASSERT_EQ(program.exitCode, 0) << program.err;
  const auto mean = nlohmann::json::parse(std::ifstream(path("program.json"))).at("mean").get<std::vector<double>>();
  std::istringstream numbers(consumer.out);
  for (const double expected : mean) {
    double value = 0.0;
    ASSERT_TRUE(numbers >> value) << consumer.out;
    EXPECT_GT(expected, 1e-3);
    EXPECT_NEAR(value, expected, 1e-5 * expected);
  }
  const RunResult refused = runWithoutSources("consumer/build/consumer nowhere.obj out.pfm $LUCERNA_HOST");
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_EQ(refused.err, "consumer: nowhere.obj: no such file\n");
}

TEST_F(Installed, DesktopEntryIsValid) {
  if (!installed("desktop-file-validate")) GTEST_SKIP() << "desktop-file-validate is not installed";
  const RunResult result = run(std::string("desktop-file-validate ") +
                               inQuotes(prefix() / "share/applications/alt.lucerna.Lucerna.desktop"));
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.out, "");
}

TEST_F(Installed, MetainfoIsValid) {
  if (!installed("appstreamcli")) GTEST_SKIP() << "appstreamcli is not installed";
  const RunResult tree = run(std::string("appstreamcli validate-tree --no-net ") + inQuotes(prefix()));
  EXPECT_EQ(tree.exitCode, 0) << tree.out << tree.err;
  const RunResult file = run(std::string("appstreamcli validate --no-net ") +
                             inQuotes(prefix() / "share/metainfo/alt.lucerna.Lucerna.metainfo.xml"));
  EXPECT_EQ(file.exitCode, 0) << file.out << file.err;
}

// Both packages, as Debian's own checker sees them: no error, no warning.
TEST(DebianPackages, PassLintian) {
  if (!installed("dpkg-shlibdeps") || !installed("lintian")) GTEST_SKIP() << "dpkg-dev or lintian is not installed";
  if (lucerna::test::kSanitized) GTEST_SKIP() << "a sanitizer build is not packaged";
  const TempFolder folder;
  const RunResult made = run(std::string("cpack --config ") + inQuotes(kBuild / "CPackConfig.cmake") + " -G DEB -B " +
                             inQuotes(folder.path()));
  ASSERT_EQ(made.exitCode, 0) << made.out << made.err;
  const std::string program = run(std::string("ls ") + inQuotes(folder.path()) + "/lucerna_*.deb").out;
  const RunResult fields = run("dpkg-deb --field " + program.substr(0, program.find('\n')));
  for (const char* part :
       {"Package: lucerna\n", "Section: graphics\n", "libglew", "libassimp", "libosmesa6", "gnuplot-nox"})
    EXPECT_NE(fields.out.find(part), std::string::npos) << part << " is not in\n" << fields.out;
  const RunResult lint =
      run(std::string("lintian --allow-root --no-cfg --fail-on error,warning --tag-display-limit 0 ") +
          inQuotes(folder.path()) + "/*.deb");
  EXPECT_EQ(lint.exitCode, 0) << lint.out << lint.err;
  EXPECT_EQ(lint.out, "");
}

}  // namespace
