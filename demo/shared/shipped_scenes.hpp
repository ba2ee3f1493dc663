// The scenes of assets/ by name: `lucerna walk cornell`.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace lucerna::demo {

/// By name, the file's stem: the JSON scenes of the folders of assets/. Empty where there is no data folder.
std::map<std::string, std::filesystem::path> shippedScenes();

/// The file that an argument SCENE means: the file of that name if there is one, and it is no folder; else the shipped
/// scene, if the text is the name of one; else the text.
std::string sceneFileOf(const std::string& text);

/// Throws Error(badInput) listing the names if the text is a bare word that names neither.
void checkSceneName(const std::string& text);

}  // namespace lucerna::demo
