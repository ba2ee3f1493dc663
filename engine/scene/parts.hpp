// Connected parts of a scene's meshes (no GL, pure).
#pragma once

#include "scene/scene.hpp"

#include <functional>
#include <vector>

namespace lucerna {

/// Bounds of each set of triangles that share corners, by the corners' places, across meshes. Only of meshes for which
/// `isWanted`. In no particular order, but the same one for the same scene.
std::vector<Bounds> connectedParts(const Scene& scene, const std::function<bool(const Mesh&)>& isWanted);

/// Of all meshes, the parts that are large in a picture: at least a twentieth of its height, for one of the scene's
/// cameras, wherever it looks.
std::vector<Bounds> partsLargeInView(const Scene& scene);

}  // namespace lucerna
