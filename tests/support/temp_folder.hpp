// A folder of its own for one test, removed at the end.
#pragma once

#include "base/error.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace lucerna::test {

class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

  /// Writes a file into it and returns its path.
  std::filesystem::path write(std::string_view name, std::string_view content) const;
  /// Names of what lies in it, hidden files too, sorted.
  std::string listing() const;

 private:
  std::filesystem::path path_;
};

/// The message of the Error(badInput) that `action` throws; empty where it throws nothing.
/// Errors of another kind fail the test.
std::string badInputMessage(const std::function<void()>& action);

/// A folder of the shared test data, which lies beside the source tree; empty where it is missing.
std::filesystem::path sharedAssets(std::string_view folder);

}  // namespace lucerna::test
