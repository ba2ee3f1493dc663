// Irradiance of patches from the sun, spot and omnidirectional lights, and the environment. Rays through the path
// tracer's hierarchy: one per light and part of a patch; towards the environment some hundreds per patch,
// cosine-distributed.
#pragma once

#include "gl/program.hpp"
#include "radiosity/patches.hpp"
#include "rays/ray_scene.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace lucerna {

/// Mean over the visible parts of each patch, scene units; zeros if the scene has no such light. A patch is sampled at
/// the centroids of parts x parts equal triangles, `parts` at most 4, so that there are about `most` rays at most.
/// `rays`: of sceneOf(mesh).
std::vector<glm::dvec3> directLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene,
                                    const RadiosityMesh& mesh, std::size_t most = 5'000'000);

/// Irradiance of patches from Scene::environment, which must exist: pi times the mean radiance of rays that hit
/// nothing, each ray from one of the patch's parts. 64 to 1024 rays per patch, about `most` in all; points of a regular
/// lattice, so that a constant, unoccluded sky is exact. Texels of a picture that are brighter than four times its mean
/// are left out by these rays; half of all rays go to them alone, in proportion to what each gives.
std::vector<glm::dvec3> skyLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene,
                                 const RadiosityMesh& mesh, std::size_t most = 5'000'000);

struct Segment {
  glm::dvec3 from, to;
};
constexpr std::uint32_t kNoPatch = ~0u;
/// What each segment meets first, its end included: a patch's back, or kNoPatch for a front and for nothing. Of two
/// sheets in one place, the one that shows its front is met.
std::vector<std::uint32_t> backsMet(gl::ProgramLibrary& programs, const RayScene& rays,
                                    std::span<const Segment> segments);

/// Patches whose backs the sun, a spot or an omnidirectional lamp lights, some more than once: a segment from each lamp
/// to each patch.
std::vector<std::uint32_t> litFromBehind(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene,
                                         const RadiosityMesh& mesh);

}  // namespace lucerna
