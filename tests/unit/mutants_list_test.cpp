// Each fault that tests/mutants plants is still there to be planted: its text stands exactly once in its file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
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

}  // namespace
