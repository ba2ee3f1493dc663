// How near to the camera surfaces are drawn (no GL, pure).
#pragma once

#include "scene/scene.hpp"

#include <vector>

namespace lucerna {

/// Distance along the view of the near plane: usually 1/2000 of the scene's diagonal. Where one of its cameras sees
/// something nearer, half as far as that, unless this is less than 1e-6 of the diagonal: the depth of what is far away
/// has the fewer steps the nearer the plane is. `aspect`: width over height of the picture.
double nearPlane(const Scene& scene, double aspect);

/// Of each mesh, the least distance along the view at which a triangle is inside the picture of a perspective camera,
/// if it is less than `within`; else infinite.
std::vector<double> nearestInView(const Scene& scene, const Camera& camera, double aspect, double within);

}  // namespace lucerna
