// The parts of loadScene (no GL): models through Assimp, the scene JSON, and a check of OBJ text that Assimp lacks.
#pragma once

#include "scene/scene.hpp"

#include <string>
#include <string_view>

namespace lucerna {

/// Any model that Assimp reads, with defaults for what the file leaves out (scene_defaults.cpp).
Scene loadModel(const std::filesystem::path& file);

/// The scene JSON: a model with cameras, lights and settings. Its keys: scene_file.cpp.
Scene loadSceneFile(const std::filesystem::path& file);

/// Throws Error(badInput) naming file and line if Wavefront OBJ text is malformed or truncated: numbers missing, a face
/// with vertices that the file does not have, binary data.
void checkObj(const std::filesystem::path& file, std::string_view text);

/// The text in a form that Assimp 5.2.5 reads correctly: with a 0 before every number that begins with a dot (it
/// ignores such a number and shifts those behind it), and without leading blanks (it skips such a line).
std::string repairedObj(std::string_view obj);

/// Without a light: the default sun.
void setDefaultSun(Scene& scene);

/// The camera path of the repository, and the view from outside if no camera sees anything.
void setDefaultView(Scene& scene);

/// With the default sun, after a view has been chosen: the sun no longer follows the view from outside.
void useChosenView(Scene& scene);

/// With the default sun and no exposure in a file: 0.4 for a camera outside the scene's bounds, so that a white surface
/// in the sun is just below white; 3 inside of them, so that surfaces lit by reflection alone are readable.
void setDefaultExposure(Scene& scene, const Camera& camera);

/// With the default sun: the clear sky for its current direction.
void setDefaultSky(Scene& scene);

/// Model files specify lamps in arbitrary units. If their light in the middle of the scene is far from what an exposure
/// of 1 shows, choose another exposure.
void setExposureForLamps(Scene& scene);

/// Sets `file` as the scene's camera path and, if there is no camera yet, its first key as the first camera.
void setKeyFrames(Scene& scene, const std::filesystem::path& file);

}  // namespace lucerna
