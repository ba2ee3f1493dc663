// A floor for models without one (no GL): they stand on it, and their shadow shows where.
#pragma once

#include "scene/scene.hpp"

namespace lucerna::demo {

/// A horizontal grey square just below the scene's lowest point, three times as wide as the scene. Changes vertices,
/// meshes, materials and bounds.
void addGround(Scene& scene);
/// Whether a scene looks like a bare model: no file specifies its lighting.
bool wantsGround(const Scene& scene);

}  // namespace lucerna::demo
