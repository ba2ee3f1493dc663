// docs/originals.md: every command of its tables runs, in their order and in one folder, each made small by arguments
// added to it. The short form leaves out the benches but one, which take minutes even so, and has the Cornell box's
// model in place of the atrium's: reading and uploading that takes more than half of such a command's time.
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

struct Row {
  std::string heading, item, command;
};

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream row(line.substr(1));
  for (std::string cell; std::getline(row, cell, '|');) {
    cell.erase(0, std::min(cell.find_first_not_of(' '), cell.size()));
    cell.erase(cell.find_last_not_of(' ') + 1);
    cells.push_back(cell);
  }
  return cells;
}

std::vector<Row> rowsOf(const fs::path& file) {
  std::vector<Row> rows;
  std::ifstream in(file);
  std::string heading;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("## ")) heading = line.substr(3);
    if (!line.starts_with("| ") || line.starts_with("| item") || line.starts_with("| --")) continue;
    const std::vector<std::string> cells = cellsOf(line);
    EXPECT_EQ(cells.size(), 3u) << line;
    if (cells.size() < 2) continue;
    EXPECT_FALSE(cells[0].empty() || cells.back().empty()) << line;
    std::string command = cells[1];
    if (command != "-") {
      EXPECT_TRUE(command.starts_with("`lucerna ") && command.ends_with("`")) << line;
      command = command.substr(1, command.size() - 2);
    }
    rows.push_back({heading, cells[0], command});
  }
  return rows;
}

/// What makes a command small: pictures of 32x18, one sample, a sweep, a view of 8 pixels, a thousandth of the
/// published work.
std::string small(const std::string& command) {
  const auto is = [&](const char* beginning) { return command.starts_with(std::string("lucerna ") + beginning); };
  const auto has = [&](const char* part) { return command.find(part) != std::string::npos; };
  std::string more;
  if (is("render")) {
    more = " --size 32x18 --quiet";
    if (has("--technique path")) more += " --spp 1";
    if (has("--technique radiosity"))
      more += " --set radiosity.resolution=16 --set radiosity.error=0.1 --set radiosity.edge=0.2";
    else if (has("lpv.")) more += " --set lpv.cells=8";
  }
  if (is("walk")) more = " --record walk --frames 2 --size 32x18 --set cache.cells=8 --quiet";
  if (is("bench all")) more = " --parts tables,pictures --scale 0.02 --quiet";
  if (is("bench tables"))
    more = has("lpv") ? " --scale 0.04 --quiet" : has("vpt") ? " --scale 0.001 --quiet" : " --scale 0.0005 --quiet";
  if (is("bench error")) more = " --small --size 32x18 --reference-spp 8 --budget 1 --frames 1 --quiet";
  if (is("bench pictures"))
    more = has("lpv")   ? " --size 32x18 --quiet"
           : has("vpt") ? " --scale 0.0005 --size 24x14 --quiet"
                        : " --scale 0.01 --size 48x36 --quiet";
  if (is("radiosity generate")) more = has("assets") ? " --edge 1e9 --quiet" : " --quiet";
  if (is("radiosity show")) more = has("--scene") ? " --edge 1e9 --size 48x36 --quiet" : " --size 48x36 --quiet";
  std::string arguments = command.substr(std::string("lucerna ").size());
  if (is("radiosity solve")) {
    // IN OUT VIEW: the third of its words.
    std::istringstream words(command);
    std::string word, program, verb, noun, in, out;
    words >> program >> verb >> noun >> in >> out;
    const bool original = has("--fidelity original");
    arguments = fmt::format("{} {} {} {} {}", verb, noun, in, out, original ? 8 : 16);
    while (words >> word) arguments += " " + word;
    more = original        ? " --max-sweeps 1 --quiet"
           : has("model1") ? " --error 0.5 --quiet"
                           : " --error 0.5 --edge 1e9 --quiet";
  }
  return arguments + more;
}

/// The scenes' folder, and in the short form the atrium's files with the Cornell box's model.
void makeScenes(const fs::path& folder) {
  const fs::path source = LUCERNA_SOURCE_DIR;
  if (lucerna::test::longTests()) {
    fs::create_directory_symlink(source / "assets", folder / "assets");
    return;
  }
  fs::create_directory_symlink(source / "keyFrames", folder / "keyFrames");
  fs::create_directories(folder / "assets/atrium");
  for (const auto& entry : fs::directory_iterator(source / "assets"))
    if (entry.path().filename() != "atrium")
      fs::create_symlink(entry.path(), folder / "assets" / entry.path().filename());
  for (const char* name : {"assets/atrium/atrium.json", "assets/atrium/haze.json"}) {
    nlohmann::json scene = nlohmann::json::parse(std::ifstream(source / name));
    scene["model"] = "../cornell/cornell.obj";
    std::ofstream(folder / name) << scene;
  }
}

TEST(Originals, EveryCommandOfThePageRuns) {
  const fs::path page = fs::path(LUCERNA_SOURCE_DIR) / "docs/originals.md";
  const std::vector<Row> rows = rowsOf(page);
  std::set<std::string> headings, ran;
  const TempFolder folder;
  makeScenes(folder.path());
  int without = 0;
  for (const Row& row : rows) {
    headings.insert(row.heading);
    if (row.command == "-") {
      ++without;
      continue;
    }
    if (!ran.insert(row.command).second) continue;
    const bool isLong =
        row.command.starts_with("lucerna bench") && row.command.find("--progressive") == std::string::npos;
    if (isLong && !lucerna::test::longTests()) continue;
    std::string arguments = small(row.command);
    // Models of a few triangles: the published thresholds take minutes to solve.
    if (arguments.starts_with("radiosity generate model1"))
      arguments = "radiosity generate model1.out 1 2000 0.15 100000 --quiet";
    if (arguments.starts_with("radiosity generate model2"))
      arguments = "radiosity generate model2.out 2 20000 0.3 1000000 --quiet";
    if (arguments.starts_with("radiosity generate model3"))
      arguments = "radiosity generate model3.out 3 5000 0.3 10000000 --quiet";
    const RunResult result =
        lucerna::test::run("cd '" + folder.path().string() + "' && '" LUCERNA_BINARY "' " + arguments);
    EXPECT_EQ(result.exitCode, 0) << row.heading << ", " << row.item << "\n" << arguments << "\n" << result.err;
    // What it was to write is there.
    for (const char* option : {" -o ", " --json "})
      if (const auto at = arguments.find(option); at != std::string::npos) {
        std::istringstream rest(arguments.substr(at + std::string(option).size()));
        std::string name;
        rest >> name;
        EXPECT_TRUE(fs::exists(folder.path() / name) && fs::file_size(folder.path() / name) > 0) << arguments;
      }
  }
  EXPECT_EQ(headings, (std::set<std::string>{"All three", "LPV", "RAD", "VPT"}));
  EXPECT_GT(ran.size(), 50u);
  EXPECT_LT(without, 5);
  if (!lucerna::test::longTests()) return;
  for (const char* name :
       {"index.html", "pictures-lpv.png", "pictures-rad.png", "pictures-rad-progressive.png", "pictures-vpt.png"})
    EXPECT_TRUE(fs::exists(folder.path() / "report" / name)) << name;
  std::ifstream report(folder.path() / "report/index.html");
  const std::string html((std::istreambuf_iterator<char>(report)), std::istreambuf_iterator<char>());
  for (const char* part :
       {"Light propagation volumes, on", "Participating media", "5.16 a: espresso", "500x500, 26360 triangles"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

}  // namespace
