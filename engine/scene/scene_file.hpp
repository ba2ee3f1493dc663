// The parts of loadScene (no GL): models, the scene JSON, defaults.
#pragma once

#include "scene/key_frames.hpp"
#include "scene/scene.hpp"

#include <filesystem>
#include <vector>

namespace lucerna {

/// A model of any format, with defaults for what the file leaves out (scene_defaults.cpp).
Scene loadModel(const std::filesystem::path& file);

/// Adds the surfaces of another model. Throws Error(badInput) if it has animations.
void addModel(Scene& scene, const std::filesystem::path& file);

/// The scene JSON: a model with cameras, lights and settings. Its keys: scene_file.cpp.
Scene loadSceneFile(const std::filesystem::path& file);

/// Without a light: the default sun.
void setDefaultSun(Scene& scene);

/// The camera path of the repository, and the view from outside if no camera sees anything.
void setDefaultView(Scene& scene);

/// With the default sun, after a view has been chosen: the sun no longer follows the view from outside.
void useChosenView(Scene& scene);

/// With the default sun and no exposure in a file: 0.4 for a camera outside the scene's bounds, so that a white surface
/// in the sun is just below white; 3 inside of them, so that surfaces lit by reflection alone are readable.
void setDefaultExposure(Scene& scene, const Camera& camera);

/// With the default sun: the studio's sky (studio.hpp), or the clear sky for its current direction.
void setDefaultSky(Scene& scene);

/// Model files specify lamps in arbitrary units. If their light in the middle of the scene is far from what an exposure
/// of 1 shows, choose another exposure.
void setExposureForLamps(Scene& scene);

/// The camera's keys of a file as places of the scene (Scene::origin).
std::vector<KeyFrame> keyFramesOf(const Scene& scene, const std::filesystem::path& file);

/// Carries what `file` has keys of. If it has some of the camera, it becomes the scene's camera path and, with
/// `andCamera`, its first key the only camera.
void setKeyFrames(Scene& scene, const std::filesystem::path& file, bool andCamera);

}  // namespace lucerna
