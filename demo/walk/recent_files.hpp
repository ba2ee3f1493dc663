// Scenes that the window has shown, newest first, remembered in XDG_STATE_HOME/lucerna/recent-scenes, else in
// ~/.local/state (XDG Base Directory Specification 0.8). A folder that cannot be written is no error.
#pragma once

#include <filesystem>
#include <vector>

namespace lucerna::demo {

constexpr std::size_t kMostRecentFiles = 12;

/// Those that still exist.
std::vector<std::filesystem::path> recentFiles();
void rememberFile(const std::filesystem::path& file);

}  // namespace lucerna::demo
