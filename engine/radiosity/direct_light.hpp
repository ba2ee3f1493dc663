// Irradiance of patches by what is no patch: the sun, spot and omnidirectional lights. Rays on the GPU, one a light and part of a patch.
#pragma once

#include "gl/program.hpp"
#include "radiosity/patches.hpp"

#include <vector>

namespace lucerna {

/// Mean over each patch, scene units; zeros where the scene has no such light. A patch is sampled at the centroids of parts x parts equal
/// triangles, `parts` chosen so that the rays stay about `rays`.
std::vector<glm::dvec3> directLight(gl::ProgramLibrary& programs, const Scene& scene, const RadiosityMesh& mesh, std::size_t rays = 400000);

}  // namespace lucerna
