// The form of sources and documents: no line over 120 columns, as .editorconfig and .clang-format have it; headings in
// long functions.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Characters, not bytes of UTF-8.
std::size_t columnsOf(const std::string& line) {
  std::size_t columns = 0;
  for (const char c : line) columns += (static_cast<unsigned char>(c) & 0xc0u) != 0x80u;
  return columns;
}

/// C++ and GLSL, by their paths in the project.
std::vector<std::pair<std::string, std::vector<std::string>>> sources() {
  const std::set<std::string> kinds{".cpp", ".hpp", ".h", ".glsl", ".comp", ".vert", ".geom", ".frag"};
  const fs::path root = LUCERNA_SOURCE_DIR;
  std::vector<std::pair<std::string, std::vector<std::string>>> result;
  for (const char* folder : {"engine", "demo", "shaders", "tests"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file() || !kinds.contains(entry.path().extension().string())) continue;
      std::ifstream file(entry.path());
      std::vector<std::string>& lines =
          result.emplace_back(fs::relative(entry.path(), root).string(), std::vector<std::string>()).second;
      for (std::string line; std::getline(file, line);) lines.push_back(line);
    }
  EXPECT_GT(result.size(), 500u);
  return result;
}

TEST(Form, NoLineOfSourcesIsWiderThan120Columns) {
  for (const auto& [file, lines] : sources())
    for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_LE(columnsOf(lines[i]), 120u) << file << ":" << i + 1;
}

// NVIDIA's compiler refuses a structure that lies in a storage block as an argument (C1317), where OpenGL allows it: it
// is copied first, or a function returns it (mediumOf of pathtracer/crossing.glsl).
TEST(Form, NoStructureOfAStorageBlockIsAnArgument) {
  const std::regex blockOf(R"(\bbuffer\s+\w+\s*\{\s*(\w+)\s+(\w+)\[\];)"), structOf(R"(^struct (\w+))"),
      memberOf(R"(^\s+(\w+) (\w+);)"), argument(R"(\w\([^;]*?\b(\w+)\[[^\]]*\](?:\.(\w+))?\s*[,)])");
  std::set<std::string> structures, members;
  std::map<std::string, std::string> arrays;
  const auto shaders = sources();
  std::smatch match;
  for (const auto& [file, lines] : shaders)
    for (const std::string& line : lines)
      if (file.starts_with("shaders/") && std::regex_search(line, match, structOf)) structures.insert(match[1]);
  for (const auto& [file, lines] : shaders)
    for (const std::string& line : lines) {
      if (!file.starts_with("shaders/")) continue;
      if (std::regex_search(line, match, blockOf) && structures.contains(match[1])) arrays[match[2]] = match[1];
      if (std::regex_search(line, match, memberOf) && structures.contains(match[1])) members.insert(match[2]);
    }
  EXPECT_GE(arrays.size(), 10u);
  EXPECT_TRUE(members.contains("maskTexture"));
  const auto offends = [&](const std::string& line) {
    for (auto at = std::sregex_iterator(line.begin(), line.end(), argument); at != std::sregex_iterator(); ++at)
      if (arrays.contains((*at)[1]) && (!(*at)[2].matched || members.contains((*at)[2]))) return true;
    return false;
  };
  EXPECT_TRUE(offends("  flight = medium >= 0 ? beginFlight(path, media[medium], numbers) : 3e38;"));
  EXPECT_TRUE(offends("  return readTexture(materials[material].maskTexture, texCoord).a < 0.5;"));
  EXPECT_FALSE(offends("  bool fades = receivers[index].presence < fullBlendWeight(receivers[index].paths);"));
  for (const auto& [file, lines] : shaders)
    for (std::size_t i = 0; i < lines.size(); ++i)
      EXPECT_FALSE(file.starts_with("shaders/") && offends(lines[i])) << file << ":" << i + 1;
}

// A function of over 80 lines has a heading over each of its parts. Functions are what ends with a brace alone in the
// first column and begins where that column was used before: .clang-format's layout.
TEST(Form, LongFunctionsHaveHeadings) {
  constexpr std::size_t kLong = 80, kPart = 60;
  std::size_t longOnes = 0;
  for (const auto& [file, lines] : sources())
    for (std::size_t end = 0; end < lines.size(); ++end) {
      if (lines[end] != "}") continue;
      const auto beginsSomething = [](const std::string& line) {
        return !line.empty() && line[0] != ' ' && line[0] != '#' && !line.starts_with("//");
      };
      std::size_t begin = end;
      do --begin;
      while (begin > 0 && !beginsSomething(lines[begin]));
      if (end - begin < kLong) continue;
      ++longOnes;
      std::size_t heading = begin;
      for (std::size_t i = begin; i <= end; ++i) {
        const std::string text = lines[i].substr(std::min(lines[i].find_first_not_of(' '), lines[i].size()));
        if (!text.starts_with("//") && i < end) continue;
        EXPECT_LE(i - heading, kPart) << file << ":" << heading + 1 << ": no heading up to line " << i + 1;
        heading = i;
      }
    }
  EXPECT_GT(longOnes, 10u);
}

// Tables, listings and pictures are as wide as they must be.
TEST(Form, NoProseIsWiderThan120Columns) {
  const fs::path root = LUCERNA_SOURCE_DIR;
  std::vector<fs::path> documents{root / "README.md", root / "CHANGELOG.md", root / "CONTRIBUTING.md"};
  for (const char* folder : {"assets", "demo", "docs", "engine", "shaders", "tests"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.path().extension() == ".md") documents.push_back(entry.path());
  EXPECT_GT(documents.size(), 30u);
  for (const fs::path& document : documents) {
    std::ifstream lines(document);
    int number = 0;
    bool isListing = false;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      const std::string text = line.substr(std::min(line.find_first_not_of(' '), line.size()));
      if (text.starts_with("```")) isListing = !isListing;
      if (isListing || text.starts_with("|") || text.starts_with("![")) continue;
      EXPECT_LE(columnsOf(line), 120u) << fs::relative(document, root).string() << ":" << number;
    }
  }
}

/// By its name; without an extension, by the interpreter that its first line asks for.
bool isScript(const fs::path& file) {
  if (file.filename() == "CMakeLists.txt") return true;
  if (file.has_extension())
    return std::set<std::string>{".cmake", ".css", ".html", ".in", ".js", ".py", ".sh"}.contains(
        file.extension().string());
  std::ifstream stream(file);
  return stream.get() == '#' && stream.get() == '!';
}

// Lists of settings, hints and faults (.txt), JSON and models are data, and as wide as what they hold.
TEST(Form, NoLineOfScriptsIsWiderThan120Columns) {
  const fs::path root = LUCERNA_SOURCE_DIR;
  std::vector<fs::path> scripts{root / "CMakeLists.txt"};
  for (const char* folder : {".ci", "assets", "demo", "docs", "engine", "shaders", "tests"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.is_regular_file() && isScript(entry.path())) scripts.push_back(entry.path());
  EXPECT_GT(scripts.size(), 50u);
  for (const fs::path& script : scripts) {
    std::ifstream lines(script);
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      EXPECT_LE(columnsOf(line), 120u) << fs::relative(script, root).string() << ":" << number;
    }
  }
}

}  // namespace
