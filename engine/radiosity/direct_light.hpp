// Irradiance of patches by what is no patch: the sun, spot and omnidirectional lights. Rays through the path tracer's hierarchy, one a light and part of a patch.
#pragma once

#include "gl/program.hpp"
#include "pathtracer/ray_scene.hpp"
#include "radiosity/patches.hpp"

#include <vector>

namespace lucerna {

/// Mean over what is not hidden of each patch, scene units; zeros where the scene has no such light. A patch is sampled at the centroids of parts x parts equal
/// triangles, `parts` from 4 down so that the rays stay about `most`. `rays`: of sceneOf(mesh).
std::vector<glm::dvec3> directLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene, const RadiosityMesh& mesh, std::size_t most = 5'000'000);

}  // namespace lucerna
