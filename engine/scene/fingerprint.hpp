// Hash of everything that light in a scene depends on (no GL): geometry, materials, textures, lights and media, and the
// view. It covers what was loaded: a changed texture or MTL changes it, a moved folder or a renamed file does not.
#pragma once

#include "base/hash.hpp"
#include "scene/scene.hpp"

namespace lucerna {

/// Geometry, materials and textures alone.
void addSurfaces(Hash& hash, const Scene& scene);
/// Everything that affects light: not names, cameras, exposure or camera paths.
void addScene(Hash& hash, const Scene& scene);
void addCamera(Hash& hash, const Camera& camera);

}  // namespace lucerna
