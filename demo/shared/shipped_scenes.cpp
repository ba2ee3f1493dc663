#include "shared/shipped_scenes.hpp"

#include "base/data.hpp"
#include "base/error.hpp"
#include "base/nearest_words.hpp"

namespace lucerna::demo {

namespace fs = std::filesystem;

std::map<std::string, fs::path> shippedScenes() {
  std::map<std::string, fs::path> scenes;
  const std::optional<fs::path> data = findDataFolder();
  if (!data) return scenes;
  std::error_code error;
  // reference.json of assets/check is no scene.
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(*data / "assets", error))
    if (entry.path().extension() == ".json" && entry.path().parent_path().filename() != "check")
      scenes.emplace(entry.path().stem().string(), entry.path());
  return scenes;
}

std::string sceneFileOf(const std::string& text) {
  std::error_code error;
  const bool isFile = fs::exists(text, error) && !fs::is_directory(text, error);
  if (text.empty() || isFile || fs::path(text).has_parent_path()) return text;
  const auto scenes = shippedScenes();
  const auto found = scenes.find(text);
  return found == scenes.end() ? text : found->second.string();
}

void checkSceneName(const std::string& text) {
  std::error_code error;
  const fs::path file(text);
  if (text.empty() || file.has_parent_path() || file.has_extension() || fs::exists(file, error)) return;
  const auto scenes = shippedScenes();
  if (scenes.empty() || scenes.contains(text)) return;
  std::vector<std::string_view> names;
  for (const auto& [name, path] : scenes) names.push_back(name);
  throwBadInput("{}: no such file, and no shipped scene; nearest: {}", text, nearestList(text, names));
}

}  // namespace lucerna::demo
