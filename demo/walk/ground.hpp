// A floor for models that come without one (no GL): they stand on something, and their shadow tells where.
#pragma once

#include "scene/scene.hpp"

namespace lucerna::demo {

/// A horizontal grey square just below the scene's lowest point, three times as wide as the scene. Changes vertices,
/// meshes, materials and bounds.
void addGround(Scene& scene);
/// Whether a scene looks like a model alone: no file said how it is lit.
bool wantsGround(const Scene& scene);

}  // namespace lucerna::demo
