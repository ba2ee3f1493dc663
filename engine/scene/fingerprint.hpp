// What light in a scene depends on, as one number (no GL): the scene's geometry, materials, textures, lights and media, and the view.
// It is taken of what was loaded, so a changed texture or MTL changes it, and a moved folder or a renamed file does not.
#pragma once

#include "base/hash.hpp"
#include "scene/scene.hpp"

namespace lucerna {

/// Everything that light sees: not names, cameras, exposure or camera paths.
void addScene(Hash& hash, const Scene& scene);
void addCamera(Hash& hash, const Camera& camera);

}  // namespace lucerna
