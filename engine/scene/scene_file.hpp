// The parts of loadScene (no GL): models through Assimp, our scene JSON, and the check of OBJ text that Assimp does not make.
#pragma once

#include "scene/scene.hpp"

#include <string>
#include <string_view>

namespace lucerna {

/// Whatever Assimp reads, with the defaults for what the file does not say. See scene_loader.cpp.
Scene loadModel(const std::filesystem::path& file);

/// Our scene JSON: a model and what is to be said about it. Its keys: scene_file.cpp.
Scene loadSceneFile(const std::filesystem::path& file);

/// Throws Error(badInput) naming file and line where Wavefront OBJ text is malformed or cut off: numbers missing, a face
/// that refers to vertices the file does not hold, binary data.
void checkObj(const std::filesystem::path& file, std::string_view text);

/// The text as Assimp 5.2.5 reads it rightly: with a 0 before every number that begins with a dot (it takes such a number for none and shifts those
/// behind it), and without blanks at a line's beginning (it passes over such a line).
std::string repairedObj(std::string_view obj);

/// Where the sun is ours and a view has been chosen after all: the sun no longer follows the view from outside.
void useChosenView(Scene& scene);

/// Where the sun is ours: the clear sky that goes with it, as it stands now.
void setDefaultSky(Scene& scene);

/// Makes `file` the scene's camera path and, where no camera is known yet, its first key the first camera.
void setKeyFrames(Scene& scene, const std::filesystem::path& file);

}  // namespace lucerna
