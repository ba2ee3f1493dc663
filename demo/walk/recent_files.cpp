#include "walk/recent_files.hpp"

#include "base/error.hpp"
#include "base/files.hpp"

#include <cstdlib>
#include <sstream>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;

/// Empty if there is no such folder.
fs::path listFile() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state)
    return fs::path(state) / "lucerna" / "recent-scenes";
  if (const char* home = std::getenv("HOME"); home && *home)
    return fs::path(home) / ".local" / "state" / "lucerna" / "recent-scenes";
  return {};
}

}  // namespace

std::vector<fs::path> recentFiles() {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::exists(listFile(), error)) return files;
  try {
    std::istringstream text(readFileText(listFile()));
    for (std::string line; std::getline(text, line) && files.size() < kMostRecentFiles;)
      if (!line.empty() && fs::exists(line, error)) files.emplace_back(line);
  } catch (const Error&) {}  // unreadable: as if there were none
  return files;
}

void rememberFile(const fs::path& file) {
  if (listFile().empty()) return;
  std::error_code error;
  const fs::path added = fs::weakly_canonical(file, error);
  if (error || added.empty()) return;
  std::string text = added.string() + "\n";
  for (const fs::path& other : recentFiles())
    if (other != added) text += other.string() + "\n";
  fs::create_directories(listFile().parent_path(), error);
  try {
    writeFileAtomically(listFile(), text);
  } catch (const Error&) {}  // a read-only home: nothing is remembered
}

}  // namespace lucerna::demo
