// Irradiance of patches by what is no patch: the sun, spot and omnidirectional lights, and the environment. Rays through the path tracer's hierarchy: one a light
// and part of a patch; towards the environment some hundreds of a patch, distributed as the cosine.
#pragma once

#include "gl/program.hpp"
#include "pathtracer/ray_scene.hpp"
#include "radiosity/patches.hpp"

#include <vector>

namespace lucerna {

/// Mean over what is not hidden of each patch, scene units; zeros where the scene has no such light. A patch is sampled at the centroids of parts x parts equal
/// triangles, `parts` from 4 down so that the rays stay about `most`. `rays`: of sceneOf(mesh).
std::vector<glm::dvec3> directLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene, const RadiosityMesh& mesh, std::size_t most = 5'000'000);

/// Irradiance of patches by Scene::environment, which there must be: the mean over rays of the radiance where they meet nothing, times pi, each ray from one of the
/// patch's parts. Rays of a patch: 64 to 1024, so that all stay about `most`; points of a regular lattice, so that a constant sky that is nowhere hidden is exact.
/// Light from a few texels of a picture is noisy: rays do not look for it.
std::vector<glm::dvec3> skyLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene, const RadiosityMesh& mesh, std::size_t most = 5'000'000);

}  // namespace lucerna
