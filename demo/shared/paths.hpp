// The camera path of a walk.
#pragma once

#include "scene/key_frames.hpp"

namespace lucerna::demo {

/// From the scene's key frames, else once around the scene.
Spline pathOf(const Scene& scene);

}  // namespace lucerna::demo
