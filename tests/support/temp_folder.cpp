#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <set>

namespace lucerna::test {

namespace fs = std::filesystem;

TempFolder::TempFolder() {
  std::string pattern = (fs::temp_directory_path() / "lucerna-test-XXXXXX").string();
  if (!::mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

TempFolder::~TempFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

fs::path TempFolder::write(std::string_view name, std::string_view content) const {
  const fs::path file = path_ / name;
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

std::string TempFolder::listing() const {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_)) names.insert(entry.path().filename().string());
  std::string result;
  for (const std::string& name : names) result += (result.empty() ? "" : " ") + name;
  return result;
}

std::string badInputMessage(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::badInput) << e.what();
    return e.what();
  }
  return {};
}

fs::path sharedAssets(std::string_view folder) {
  const fs::path path = fs::path(LUCERNA_SOURCE_DIR) / ".." / "shared" / "assets" / folder;
  return fs::is_directory(path) ? path : fs::path();
}

}  // namespace lucerna::test
