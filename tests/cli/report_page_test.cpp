// The page of a report, driven in headless Chromium: every number shown is the JSON's, every key does what its help says.
#include "base/files.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace {

namespace fs = std::filesystem;
using namespace lucerna;

TEST(ReportPage, ShowsTheNumbersOfItsJsonAndObeysItsKeys) {
  if (test::run("command -v node && command -v chromium").exitCode != 0) GTEST_SKIP() << "node or chromium is missing (Debian packages nodejs, chromium)";
  const test::TempFolder folder;
  const std::string out = (folder.path() / "out").string(), references = (folder.path() / "references").string();
  const std::string source = LUCERNA_SOURCE_DIR;
  const auto bench = RUN_LUCERNA("bench error '" + source + "/assets/cornell/cornell.json' --size 32x18 --reference-spp 64 --budget 2 --frames 2 --small --techniques direct,rsm,path --out '" + out +
                                 "' --references '" + references + "' --quiet");
  ASSERT_EQ(bench.exitCode, 0) << bench.err;
  const auto driven = test::run("timeout 300 node '" + source + "/tests/cli/report_page.js' \"$(command -v chromium)\" '" + out + "/report.html' '" + out + "/error.json'");
  EXPECT_EQ(driven.exitCode, 0) << driven.out << driven.err;
  EXPECT_NE(driven.out.find(" 0 faults"), std::string::npos) << driven.out;
}

}  // namespace
