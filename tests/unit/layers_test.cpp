// The layers of docs/architecture.md: which folders of engine/ include which, and that OpenGL is called in engine/gl and engine/host alone.
#include "base/files.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, std::set<std::string>> kMayInclude{
    {"base", {}},
    {"scene", {"base"}},
    {"gl", {"base", "host"}},  // a host judges the driver's name, a context the host's functions: one layer
    {"host", {"base", "gl"}},
    {"forward", {"base", "scene", "gl"}},
    {"rsm", {"base", "scene", "gl", "forward"}},
    {"pathtracer", {"base", "scene", "gl"}},
    {"lpv", {"base", "scene", "gl", "forward", "rsm", "pathtracer"}},
    {"radiosity", {"base", "scene", "gl", "forward", "pathtracer"}},
    {"measure", {"base", "scene"}},
    {"settings", {"base", "scene", "gl", "forward", "rsm", "pathtracer", "lpv", "radiosity"}},
    {"render", {"base", "scene", "gl", "forward", "rsm", "pathtracer", "lpv", "radiosity", "settings"}},
};

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
  const std::regex include("(?:^|\n)#include \"([a-z]+)/");
  std::size_t seen = 0;
  for (const fs::directory_entry& folder : fs::directory_iterator(engine)) {
    const std::string name = folder.path().filename().string();
    if (!folder.is_directory() || sourcesIn(folder.path()).empty()) continue;
    ASSERT_TRUE(kMayInclude.contains(name)) << "engine/" << name << " has no place among the layers";
    for (const fs::path& file : sourcesIn(folder.path())) {
      const std::string text = readFileText(file);
      for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match) {
        const std::string other = (*match)[1];
        if (other == name || other == "shared") continue;  // shaders/shared: structs that both languages compile
        EXPECT_TRUE(kMayInclude.at(name).contains(other)) << fs::relative(file, engine.parent_path()) << " includes " << other << "/";
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 100u);
}

TEST(Layers, OpenGlIsCalledByItsFoldersAlone) {
  const fs::path root(LUCERNA_SOURCE_DIR);
  const std::regex call(R"(\bgl[A-Z][A-Za-z0-9]*\s*\()");
  std::size_t inside = 0;
  for (const char* top : {"engine", "demo"})
    for (const fs::path& file : sourcesIn(root / top)) {
      const std::string place = fs::relative(file, root).string(), code = codeOf(file);
      const bool mayCall = place.starts_with("engine/gl/") || place.starts_with("engine/host/");
      for (std::sregex_iterator match(code.begin(), code.end(), call), end; match != end; ++match) {
        EXPECT_TRUE(mayCall) << place << " calls " << match->str();
        inside += mayCall;
      }
    }
  EXPECT_GT(inside, 100u);
}

}  // namespace
}  // namespace lucerna
