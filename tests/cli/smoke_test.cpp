// One test for each command (tests/smoke.txt): the list names every command. Here are those of commands whose other
// tests take long.
#include "base/files.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <map>
#include <regex>
#include <set>

namespace {

namespace fs = std::filesystem;
using namespace lucerna;

class Smoke : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(path(name))); }
  static void expectRuns(const std::string& command) {
    const test::RunResult result = RUN_LUCERNA(command);
    ASSERT_EQ(result.exitCode, 0) << result.err;
  }
  /// A floor and a wall under the default sun.
  std::string scene() const {
    std::ofstream(path("scene.obj")) << "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 3 -2\nv 2 3 -2\n"
                                        "f 1 4 3 2\nf 1 2 6 5\n";
    return "'" + path("scene.obj") + "' ";
  }

 private:
  test::TempFolder folder_;
};

TEST_F(Smoke, EveryCommandHasATest) {
  // The completion lists the commands of each command; those that have none are run.
  const std::string completion = RUN_LUCERNA("completion bash").out;
  std::map<std::string, std::set<std::string>> commands;
  const std::regex kCase(R"re( '([a-z]*)'\) echo '([a-z ]+)' ;;)re"), kWord("[a-z]+");
  for (std::sregex_iterator match(completion.begin(), completion.end(), kCase), end; match != end; ++match) {
    const std::string names = (*match)[2];
    for (std::sregex_iterator name(names.begin(), names.end(), kWord); name != end; ++name)
      commands[(*match)[1]].insert(name->str());
  }
  std::set<std::string> expected{"lucerna-bench", "lucerna-labs", "lucerna-originals"};
  for (const auto& [group, names] : commands)
    for (const std::string& name : names)
      if (!commands.contains(name)) expected.insert("lucerna " + group + (group.empty() ? "" : " ") + name);
  EXPECT_GT(expected.size(), 30u);
  std::set<std::string> listed;
  const std::string list = readFileText(LUCERNA_SOURCE_DIR "/tests/smoke.txt");
  const std::regex kLine(R"(\n(lucerna[a-z -]*[a-z]) +[A-Za-z0-9]+\.[A-Za-z0-9]+)");
  for (std::sregex_iterator match(list.begin(), list.end(), kLine), end; match != end; ++match)
    EXPECT_TRUE(listed.insert((*match)[1]).second) << (*match)[1] << " is listed twice";
  EXPECT_EQ(listed, expected);
}

TEST_F(Smoke, BenchErrorTakesTheReferencesOfBenchReferences) {
  const std::string common = scene() + "--size 16x8 --small --techniques direct --reference-spp 16 --references '" +
                             path("references") + "' --quiet ";
  ASSERT_NO_FATAL_FAILURE(expectRuns("bench references " + common));
  std::map<fs::path, fs::file_time_type> made;
  for (const auto& entry : fs::directory_iterator(path("references"))) made[entry.path()] = entry.last_write_time();
  EXPECT_GE(made.size(), 2u);
  ASSERT_NO_FATAL_FAILURE(expectRuns("bench error " + common + "--budget 1 --frames 1 --out '" + path("out") + "'"));
  EXPECT_GE(json("out/error.json").at("rows").size(), 1u);
  EXPECT_TRUE(fs::exists(path("out/report.html")));
  for (const auto& entry : fs::directory_iterator(path("references"))) {
    ASSERT_TRUE(made.contains(entry.path())) << entry.path();
    EXPECT_EQ(entry.last_write_time(), made.at(entry.path())) << entry.path();
  }
}

TEST_F(Smoke, BenchAllMakesOnePageOfTheChosenParts) {
  ASSERT_NO_FATAL_FAILURE(expectRuns("bench all " + scene() + "--parts features --scale 0.01 --quiet --out '" +
                                     path("out") + "' --json '" + path("all.json") + "'"));
  const std::string page = readFileText(path("out/index.html"));
  EXPECT_NE(page.find("left out"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos) << "the page stands by itself";
  EXPECT_FALSE(json("all.json").empty());
}

}  // namespace
