#include "base/data.hpp"

#include "base/error.hpp"

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

/// The first missing one of the three folders; empty if all exist.
std::string missingFolder(const fs::path& folder) {
  std::error_code error;
  for (const char* name : {"shaders", "assets", "keyFrames"})
    if (!fs::is_directory(folder / name, error)) return name;
  return {};
}

/// Places to search without LUCERNA_DATA, in the order of the header.
std::vector<fs::path> candidates() {
  std::vector<fs::path> folders;
  std::error_code error;
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    folders.push_back(executable.parent_path() / "share/lucerna");
    folders.push_back(executable.parent_path().parent_path() / "share/lucerna");
  }
  const char* environment = std::getenv("XDG_DATA_DIRS");
  std::istringstream list(environment && *environment ? environment : "/usr/local/share:/usr/share");
  for (std::string folder; std::getline(list, folder, ':');)
    if (fs::path(folder).is_absolute()) folders.push_back(fs::path(folder) / "lucerna");
  return folders;
}

}  // namespace

std::optional<fs::path> findDataFolder() {
  if (const char* environment = std::getenv("LUCERNA_DATA"); environment && *environment) {
    const std::string missing = missingFolder(environment);
    if (!missing.empty())
      throwBadInput("LUCERNA_DATA={}: expected a folder with shaders, assets and keyFrames; it has no folder {}",
                    environment, missing);
    return fs::canonical(environment);
  }
  for (const fs::path& folder : candidates())
    if (missingFolder(folder).empty()) return fs::canonical(folder);
  return std::nullopt;
}

fs::path dataFolder() {
  if (auto folder = findDataFolder()) return *folder;
  std::string places;
  for (const fs::path& folder : candidates()) places += (places.empty() ? "" : ", ") + folder.string();
  throwMissingCapability(
      "shaders and assets not found: none of {} has the folders shaders, assets and keyFrames; set LUCERNA_DATA",
      places);
}

}  // namespace lucerna
