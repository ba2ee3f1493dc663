// The deviations' switches: by name, by fidelity, reported, and each with its line in the README.md of its technique.
#include "base/error.hpp"
#include "lpv/settings.hpp"
#include "render/deviations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> namesInOriginal() {
  std::vector<std::string> names;
  for (const Deviation& deviation : allDeviations())
    if (deviation.inOriginal()) names.emplace_back(deviation.name);
  return names;
}

/// Names begin with the technique's name on the command line; one folder is named otherwise.
fs::path folderOf(const std::string& name) {
  const std::string technique = name.substr(0, name.find('.'));
  return fs::path(LUCERNA_SOURCE_DIR) / "engine" / (technique == "path" ? "pathtracer" : technique);
}

/// The cells of a row of a Markdown table, without the spaces that align them; none for any other line.
std::vector<std::string> tableCells(const std::string& line) {
  std::vector<std::string> cells;
  if (!line.starts_with("|")) return cells;
  std::istringstream row(line.substr(1));
  for (std::string cell; std::getline(row, cell, '|');) {
    cell.erase(0, cell.find_first_not_of(' '));
    cell.erase(cell.find_last_not_of(' ') + 1);
    cells.push_back(cell);
  }
  return cells;
}

TEST(Deviations, NamesAreDistinctAndBeginWithTheirTechniquesFolder) {
  std::set<std::string> names;
  for (const Deviation& deviation : allDeviations()) {
    const std::string name = deviation.name;
    EXPECT_TRUE(names.insert(name).second) << name;
    const auto dot = name.find('.');
    ASSERT_NE(dot, std::string::npos) << name;
    EXPECT_TRUE(fs::is_directory(folderOf(name))) << name;
    EXPECT_FALSE(std::string(deviation.meaning).empty()) << name;
  }
  EXPECT_FALSE(names.empty());
}

TEST(Deviations, EachHasItsLineInTheReadmeOfItsTechnique) {
  for (const Deviation& deviation : allDeviations()) {
    const std::string name = deviation.name;
    std::ifstream file(folderOf(name) / "README.md");
    std::string line;
    bool inSection = false, found = false;
    while (std::getline(file, line)) {
      if (line.starts_with("#")) inSection = line == "## Deviations";
      const std::vector<std::string> cells = inSection ? tableCells(line) : std::vector<std::string>();
      if (cells.empty() || cells.front() != "`" + name + "`") continue;
      found = true;
      // Name, formula as published, ours, source, effect: none left empty.
      EXPECT_EQ(cells.size(), 5u) << line;
      EXPECT_EQ(std::count(cells.begin(), cells.end(), ""), 0) << line;
      // A star: in the text and the program published with it; T: in the text alone, D: in the program alone.
      const std::string mark = deviation.inOriginal() ? deviation.inDemo() ? "* " : "T "
                               : deviation.inDemo()   ? "D "
                                                      : "";
      for (const char* any : {"* ", "T ", "D "})
        EXPECT_EQ(cells.size() > 1 && cells[1].starts_with(any), mark == any) << line;
    }
    EXPECT_TRUE(found) << name << " has no line in the README.md of its technique, section Deviations";
  }
}

TEST(Deviations, NoneIsOnByDefaultNorCorrected) {
  RenderSettings settings;
  EXPECT_TRUE(activeDeviations(settings).empty());
  applyFidelity(settings, Fidelity::corrected);
  EXPECT_TRUE(activeDeviations(settings).empty());
}

TEST(Deviations, OriginalTurnsOnJustThoseMarkedAndWhatGoesWithThem) {
  RenderSettings settings;
  applyFidelity(settings, Fidelity::original);
  EXPECT_EQ(activeDeviations(settings), namesInOriginal());
  EXPECT_FALSE(namesInOriginal().empty());
  EXPECT_LT(namesInOriginal().size(), allDeviations().size());
  EXPECT_EQ(settings.of<LpvSettings>().propagate, LpvPropagate::layered);
  EXPECT_EQ(settings.of<LpvSettings>().lookupOffset, 0.0f);
  EXPECT_EQ(settings.of<LpvSettings>().cascades.ratio, 1.58);
  EXPECT_EQ(settings.of<LpvSettings>().cascades.spanOfScene, 80.0 / 112.0);
  EXPECT_FALSE(settings.of<LpvSettings>().cascades.heldInScene);
  // The other way: a deviation that was on before is off.
  RenderSettings turned;
  for (const Deviation& deviation : allDeviations()) deviation.turn(turned, true);
  applyFidelity(turned, Fidelity::original);
  EXPECT_EQ(activeDeviations(turned), namesInOriginal());
  for (const Deviation& deviation : allDeviations()) deviation.turn(turned, true);
  applyFidelity(turned, Fidelity::corrected);
  EXPECT_TRUE(activeDeviations(turned).empty());
}

TEST(Deviations, ThesisAndDemoAreTwoAndOriginalIsTheThesis) {
  const auto active = [](std::string_view fidelity) {
    RenderSettings settings;
    applyFidelity(settings, parseName<Fidelity>(fidelity, "--fidelity"));
    return activeDeviations(settings);
  };
  const auto has = [](const std::vector<std::string>& names, const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  EXPECT_EQ(active("original"), active("thesis"));
  EXPECT_TRUE(active("corrected").empty());
  const std::vector<std::string> thesis = active("thesis"), demo = active("demo");
  // What the text says otherwise than its program: the sum from G_0 (5.10), cascades blended (5.5), faces' directions
  // (5.3), floor (6.1), no digit slip.
  for (const char* name : {"lpv.fewer-steps", "lpv.sum-cascades", "lpv.side-directions", "lpv.side-solid-angle",
                           "lpv.truncate", "lpv.flux-units", "lpv.surfel-area"}) {
    EXPECT_FALSE(has(thesis, name)) << name;
    EXPECT_TRUE(has(demo, name)) << name;
  }
  EXPECT_TRUE(has(thesis, "lpv.unjoined"));
  EXPECT_FALSE(has(demo, "lpv.unjoined"));
  for (const char* name :
       {"lpv.half-grids", "lpv.unwindowed", "lpv.blocking-direction", "rsm.flux-cosine", "path.distance-without-pdf"}) {
    EXPECT_TRUE(has(thesis, name)) << name;
    EXPECT_TRUE(has(demo, name)) << name;
  }
  EXPECT_THROW(parseName<Fidelity>("published", "--fidelity"), Error);
}

TEST(Deviations, EachIsTurnedByItsNameAlone) {
  for (const Deviation& deviation : allDeviations()) {
    const std::string name = deviation.name;
    RenderSettings settings;
    applyDeviation(settings, name + "=on");
    EXPECT_EQ(activeDeviations(settings), std::vector{name});
    applyDeviation(settings, name + "=on");
    EXPECT_EQ(activeDeviations(settings), std::vector{name});
    applyDeviation(settings, name + "=off");
    EXPECT_TRUE(activeDeviations(settings).empty()) << name;
  }
}

TEST(Deviations, UnknownNamesAndValuesAreRefused) {
  const std::string name = allDeviations().front().name;
  for (const std::string& wrong :
       {std::string(), std::string("="), std::string("=on"), name, name + "=", name + "=yes", name + "=On",
        name + "=on ", " " + name + "=on", name + "x=on", std::string("lpv.side=on")}) {
    RenderSettings settings;
    try {
      applyDeviation(settings, wrong);
      ADD_FAILURE() << "'" << wrong << "' was not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::badInput) << wrong;
      EXPECT_NE(std::string(error.what()).find("--deviation " + wrong), std::string::npos) << error.what();
    }
    EXPECT_TRUE(activeDeviations(settings).empty()) << wrong;
  }
  // An unknown name is answered with the nearest.
  RenderSettings settings;
  try {
    applyDeviation(settings, "lpv.side-direction=on");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nearest: lpv.side-directions, "), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find("rsm."), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lucerna
