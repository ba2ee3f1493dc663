// The layers of engine/CMakeLists.txt and docs/architecture.md: which folders of engine/ include which, and that OpenGL
// is called in engine/gl and engine/host alone.
#include "base/files.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

/// The lines lucerna_layer(NAME LOWER...) and lucerna_technique(NAME LOWER...) of engine/CMakeLists.txt.
std::map<std::string, std::set<std::string>> layers() {
  std::map<std::string, std::set<std::string>> result;
  std::istringstream lines(readFileText(fs::path(LUCERNA_SOURCE_DIR) / "engine/CMakeLists.txt"));
  const std::regex layer("^lucerna_(layer|technique)\\(([a-z_ ]+)\\)$");
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, layer)) continue;
    std::istringstream words(match[2].str() + (match[1] == "technique" ? " base scene gl forward frame" : ""));
    std::string name, lower;
    words >> name;
    std::set<std::string>& below = result[name];
    while (words >> lower) {
      EXPECT_TRUE(result.contains(lower))
          << "engine/" << name << " stands above engine/" << lower << ", which comes after it";
      below.insert(lower);
    }
  }
  return result;
}

std::vector<fs::path> sourcesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp") files.push_back(entry.path());
  return files;
}

/// Without comments and texts.
std::string codeOf(const fs::path& file) {
  static const std::regex kText(R"re("(\\.|[^"\\\n])*")re"), kComment("//[^\n]*");
  return std::regex_replace(std::regex_replace(readFileText(file), kText, "\"\""), kComment, "");
}

TEST(Layers, FoldersIncludeThoseBelowThemAlone) {
  const fs::path engine = fs::path(LUCERNA_SOURCE_DIR) / "engine";
  const std::regex include("(?:^|\n)#include \"([a-z_]+)/");
  const std::map<std::string, std::set<std::string>> mayInclude = layers();
  std::size_t seen = 0;
  for (const fs::directory_entry& folder : fs::directory_iterator(engine)) {
    const std::string name = folder.path().filename().string();
    if (!folder.is_directory() || sourcesIn(folder.path()).empty()) continue;
    ASSERT_TRUE(mayInclude.contains(name)) << "engine/" << name << " has no place among the layers";
    for (const fs::path& file : sourcesIn(folder.path())) {
      const std::string text = readFileText(file);
      for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match) {
        const std::string other = (*match)[1];
        if (other == name || other == "shared") continue;  // shaders/shared: structs that both languages compile
        EXPECT_TRUE(mayInclude.at(name).contains(other))
            << fs::relative(file, engine.parent_path()) << " includes " << other << "/";
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 100u);
}

TEST(Layers, OpenGlIsCalledByItsFoldersAlone) {
  const fs::path root(LUCERNA_SOURCE_DIR);
  // Its calls and its names; of limits the names are what gl::requireWithin takes.
  const std::regex call(R"(\bgl[A-Z][A-Za-z0-9]*\s*\(|\bGL(enum|bitfield)\b|\bGL_(?!MAX_)[A-Z0-9_]+)");
  std::size_t inside = 0;
  for (const char* top : {"engine", "demo"})
    for (const fs::path& file : sourcesIn(root / top)) {
      const std::string place = fs::relative(file, root).string(), code = codeOf(file);
      const bool mayCall = place.starts_with("engine/gl/") || place.starts_with("engine/host/");
      for (std::sregex_iterator match(code.begin(), code.end(), call), end; match != end; ++match) {
        EXPECT_TRUE(mayCall) << place << " has " << match->str();
        inside += mayCall;
      }
    }
  EXPECT_GT(inside, 100u);
}

}  // namespace
}  // namespace lucerna
