// Each fault that tests/mutants plants is still there to be planted: its text stands exactly once in its file. And the
// tests that notice it still have their names.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;

std::string textOf(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int countOf(const std::string& part, const std::string& text) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

/// All sources of a test program.
std::string sourcesOf(const fs::path& folder) {
  std::string text;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".cpp") text += textOf(entry.path());
  return text;
}

/// What the declaration of a test that a part of a filter chooses has in it: of "Instance/Suite.Name*" "(Suite, Name".
std::string declarationOf(std::string part) {
  part = part.substr(part.find('/') + 1);
  const std::size_t dot = part.find('.');
  const std::string suite = part.substr(0, std::min(dot, part.find('*')));
  if (dot == std::string::npos) return "(" + suite;
  const std::string name = part.substr(dot + 1);
  return "(" + suite + ", " + name.substr(0, name.find('*'));
}

TEST(MutantsList, EveryTextStandsOnceInItsFile) {
  const fs::path root = LUCERNA_SOURCE_DIR;
  int faults = 0;
  for (const auto& [list, folder] :
       {std::pair{"tests/mutants/shaders.txt", "shaders"}, std::pair{"tests/mutants/engine.txt", "."}}) {
    std::ifstream lines(root / list);
    ASSERT_TRUE(lines) << list;
    fs::path file;
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      if (line.starts_with("@ ")) file = root / folder / line.substr(2);
      if (!line.starts_with("- ")) continue;
      ++faults;
      EXPECT_EQ(countOf(line.substr(2), textOf(file)), 1) << fmt::format("{}:{}: {}", list, number, line.substr(2));
    }
  }
  EXPECT_GE(faults, 100);
}

TEST(MutantsList, EveryFilterChoosesATest) {
  const fs::path root = LUCERNA_SOURCE_DIR;
  std::map<std::string, std::string> sources;
  for (const char* list : {"tests/mutants/shaders.txt", "tests/mutants/engine.txt"}) {
    std::ifstream lines(root / list);
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("? ")) continue;
      std::istringstream words(line.substr(2));
      std::string label, filter;
      words >> label >> filter;
      std::string& text = sources[label];
      if (text.empty()) text = sourcesOf(root / "tests" / label);
      std::istringstream parts(filter);
      for (std::string part; std::getline(parts, part, ':');)
        EXPECT_NE(text.find(declarationOf(part)), std::string::npos) << list << ": " << line;
    }
  }
  EXPECT_EQ(sources.size(), 4u);
}

}  // namespace
