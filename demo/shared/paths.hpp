// The camera path of a walk.
#pragma once

#include "scene/key_frames.hpp"

#include <filesystem>

namespace lucerna::demo {

/// From `keys`, else from the file named by the scene, else once around the scene.
Spline pathOf(const Scene& scene, const std::filesystem::path& keys);

}  // namespace lucerna::demo
