// docs/originals.md: every command of its tables runs as it is printed, in their order and in one folder, and its
// pictures are not black. What makes it small is in the environment (LUCERNA_OPTIONS). The short form leaves out the
// benches but one, which take minutes even so, and draws the LPV original's rows with the Cornell box's model in place
// of the atrium's: reading and uploading that takes more than half of such a command's time.
#include "base/files.hpp"
#include "base/image.hpp"
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
/// published work. None of `radiosity generate`, whose options would hide what its row says.
std::string smallOptions(const std::string& command) {
  const auto is = [&](const char* beginning) { return command.starts_with(std::string("lucerna ") + beginning); };
  const auto has = [&](const char* part) { return command.find(part) != std::string::npos; };
  if (is("render")) {
    std::string options = "--size 32x18";
    if (has("--technique path")) options += " --spp 1";
    if (has("--technique radiosity"))
      options += " --set radiosity.resolution=16 --set radiosity.error=0.1 --set radiosity.edge=0.2";
    else if (has("lpv.")) options += " --set lpv.cells=8";
    return options;
  }
  if (is("walk")) return "--record walk --frames 2 --size 32x18 --set cache.cells=8";
  if (is("bench all")) return "--parts tables,pictures --scale 0.02";
  if (is("bench tables")) return has("lpv") ? "--scale 0.04" : has("vpt") ? "--scale 0.001" : "--scale 0.0005";
  if (is("bench error")) return "--small --size 32x18 --reference-spp 8 --budget 1 --frames 1";
  if (is("bench dynamic")) return "--size 32x18 --frames 2";
  if (is("bench pictures"))
    return has("lpv") ? "--size 32x18" : has("vpt") ? "--scale 0.0005 --size 24x14" : "--scale 0.01 --size 48x36";
  if (is("radiosity show")) return "--size 48x36";
  if (is("radiosity solve"))  // the last word is RESOLUTION
    return has("--max-sweeps")          ? "8"
           : has("--fidelity original") ? "--max-sweeps 1 8"
           : has(".json")               ? "--error 0.5 --edge 0.2 16"
                                        : "--error 0.5 16";
  return "";
}

/// The word after an option, or "".
std::string wordAfter(const std::string& command, const std::string& option) {
  const auto at = command.find(" " + option + " ");
  std::istringstream rest(at == std::string::npos ? "" : command.substr(at + option.size() + 2));
  std::string word;
  rest >> word;
  return word;
}

/// Files that a command writes, by its own words.
std::vector<std::string> outputsOf(const std::string& command) {
  std::vector<std::string> files;
  for (const char* option : {"-o", "--json", "--chart"})
    if (const std::string file = wordAfter(command, option); !file.empty()) files.push_back(file);
  if (const std::string file = wordAfter(command, "generate"); !file.empty()) files.push_back(file);
  if (const std::string in = wordAfter(command, "solve"); !in.empty()) files.push_back(wordAfter(command, in));
  if (command.starts_with("lucerna bench dynamic")) files.push_back(wordAfter(command, "--out") + "/dynamic.html");
  if (command.starts_with("lucerna walk")) files.insert(files.end(), {"walk/frame_0000.png", "walk/frame_0001.png"});
  return files;
}

double meanOf(const fs::path& picture) {
  const lucerna::Image image = lucerna::readImage(picture);
  double sum = 0.0;
  for (const glm::vec3& pixel : image.pixels) sum += pixel.x + pixel.y + pixel.z;
  return sum / (3.0 * static_cast<double>(image.pixels.size()));
}

/// A folder with the scenes' folders; with the atrium's files as they are, or with the Cornell box's model.
void makeScenes(const fs::path& folder, bool atrium) {
  const fs::path source = LUCERNA_SOURCE_DIR;
  fs::create_directory_symlink(source / "keyFrames", folder / "keyFrames");
  if (atrium) {
    fs::create_directory_symlink(source / "assets", folder / "assets");
    return;
  }
  fs::create_directories(folder / "assets/atrium");
  for (const char* name : {"haze.obj", "haze.mtl"})
    fs::create_symlink(source / "assets/atrium" / name, folder / "assets/atrium" / name);
  for (const auto& entry : fs::directory_iterator(source / "assets"))
    if (entry.path().filename() != "atrium")
      fs::create_symlink(entry.path(), folder / "assets" / entry.path().filename());
  for (const char* name : {"assets/atrium/atrium.json", "assets/atrium/haze.json"}) {
    nlohmann::json scene = nlohmann::json::parse(std::ifstream(source / name));
    const nlohmann::json cornell = nlohmann::json::parse(std::ifstream(source / "assets/cornell/cornell.json"));
    nlohmann::json& model = scene["model"];
    (model.is_array() ? model.at(0) : model) = "../cornell/cornell.obj";
    scene["sun"]["direction"] = cornell.at("sun").at("direction");
    for (nlohmann::json& camera : scene["cameras"]) {  // by the names that rows have
      const std::string view = camera.at("name");
      camera = cornell.at("cameras").at(0);
      camera["name"] = view;
    }
    std::ofstream(folder / name) << scene;
  }
}

TEST(Originals, EveryCommandOfThePageRunsAsPrinted) {
  const fs::path page = fs::path(LUCERNA_SOURCE_DIR) / "docs/originals.md";
  const std::vector<Row> rows = rowsOf(page);
  std::set<std::string> headings, ran;
  const TempFolder folder;
  fs::create_directory(folder.path() / "lpv");
  makeScenes(folder.path(), true);
  makeScenes(folder.path() / "lpv", lucerna::test::longTests());
  int without = 0, pictures = 0;
  for (const Row& row : rows) {
    headings.insert(row.heading);
    if (row.command == "-") {
      ++without;
      continue;
    }
    if (!ran.insert(row.command).second) continue;
    const bool isLong = row.command.starts_with("lucerna bench") &&
                        row.command.find("--progressive") == std::string::npos &&
                        !row.command.starts_with("lucerna bench dynamic");
    if (isLong && !lucerna::test::longTests()) continue;
    const fs::path at = row.heading == "LPV" ? folder.path() / "lpv" : folder.path();
    const RunResult result = lucerna::test::run(fmt::format("cd '{}' && LUCERNA_OPTIONS='{}' '{}' {}", at.string(),
                                                            smallOptions(row.command), LUCERNA_BINARY,
                                                            row.command.substr(std::string("lucerna ").size())));
    EXPECT_EQ(result.exitCode, 0) << row.heading << ", " << row.item << "\n" << row.command << "\n" << result.err;
    if (result.err.find("no light is computed yet") != std::string::npos &&
        row.command.find("--mesh") == std::string::npos)
      ADD_FAILURE() << row.command << "\n" << result.err;
    // What it was to write is there, and pictures show something.
    for (const std::string& name : outputsOf(row.command)) {
      const fs::path file = at / name;
      ASSERT_TRUE(fs::exists(file) && fs::file_size(file) > 0) << row.command << ": " << name;
      if (const std::string type = lucerna::lowerExtension(file); type != ".png" && type != ".hdr") continue;
      ++pictures;
      EXPECT_GT(meanOf(file), 0.001) << row.command << ": " << name;
    }
  }
  EXPECT_EQ(headings, (std::set<std::string>{"All three", "LPV", "RAD", "VPT"}));
  EXPECT_GT(ran.size(), 50u);
  EXPECT_GT(pictures, 40);
  EXPECT_LT(without, 5);
  if (!lucerna::test::longTests()) return;
  for (const char* name :
       {"index.html", "pictures-lpv.png", "pictures-rad.png", "pictures-rad-progressive.png", "pictures-vpt.png"})
    EXPECT_TRUE(fs::exists(folder.path() / "report" / name)) << name;
  std::ifstream report(folder.path() / "report/index.html");
  const std::string html((std::istreambuf_iterator<char>(report)), std::istreambuf_iterator<char>());
  for (const char* part : {"Light propagation volumes, on", "Participating media", "5.16 a: espresso",
                           "500x500, 26360 triangles", "GeForce 7600GT with 256 MB"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

}  // namespace
