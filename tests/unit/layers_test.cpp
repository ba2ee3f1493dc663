// The layers of engine/CMakeLists.txt and docs/architecture.md: which folders of engine/ include which, that OpenGL is
// called in engine/gl and engine/host alone, and that it is no newer than 4.3.
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

/// Each function of glcorearb.h, and the version or extension that it came with.
std::map<std::string, std::string> originsOfOpenGl(const fs::path& header) {
  const std::regex section("^#ifndef (GL_\\w+)"), declaration("^GLAPI .*APIENTRY (gl\\w+)");
  std::istringstream lines(readFileText(header));
  std::map<std::string, std::string> result;
  std::string line, current;
  for (std::smatch match; std::getline(lines, line);) {
    if (std::regex_search(line, match, section)) current = match[1];
    else if (std::regex_search(line, match, declaration)) result.try_emplace(match[1], current);
  }
  return result;
}

// A context of 4.5 would hide it. Exceptions are probed, and have a fall-back.
TEST(Layers, OpenGlIsNoNewerThan43) {
  const fs::path root(LUCERNA_SOURCE_DIR), header("/usr/include/GL/glcorearb.h");
  if (!fs::exists(header)) GTEST_SKIP() << header << " is missing";
  const std::map<std::string, std::string> origins = originsOfOpenGl(header);
  EXPECT_EQ(origins.at("glDispatchCompute"), "GL_VERSION_4_3");
  EXPECT_EQ(origins.at("glBufferStorage"), "GL_VERSION_4_4");
  const std::regex name(R"(\bgl[A-Z]\w*)"), old("GL_VERSION_([1-3]_.|4_[0-3])");
  const std::set<std::string> probed{"glClearTexImage", "glGetGraphicsResetStatusARB"};
  std::size_t seen = 0;
  for (const char* top : {"engine", "demo", "tests"})
    for (const fs::path& file : sourcesIn(root / top)) {
      const std::string code = codeOf(file);
      for (std::sregex_iterator match(code.begin(), code.end(), name), end; match != end; ++match) {
        const auto origin = origins.find(match->str());
        if (origin == origins.end() || probed.contains(origin->first)) continue;
        EXPECT_TRUE(std::regex_match(origin->second, old))
            << fs::relative(file, root) << " has " << origin->first << " of " << origin->second;
        ++seen;
      }
    }
  EXPECT_GT(seen, 400u);
}

}  // namespace
}  // namespace lucerna
