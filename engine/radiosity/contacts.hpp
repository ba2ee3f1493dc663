// Where a scene's triangles stand on each other or pass through each other, light has a step: a floor is lit on one
// side of a wall and dark on the other. Patches are cut there, and light is not interpolated across [Baum1991].
#pragma once

#include "radiosity/patches.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lucerna {

/// Cuts the patches, of which no two overlap, at their contacts with others, and fills RadiosityMesh::standing. Edges
/// are cut for all of their patches at once, so that no T-junctions arise. Returns the patches that are new or smaller
/// now; their areas and means are still those before. `longestEdge`: of patches; details far smaller are left alone.
/// `between`: only contacts of such pairs of patches, in the order of their numbers; else all, in the order of a tree,
/// which every triangle changes.
std::vector<std::uint32_t> cutAtContacts(RadiosityMesh& mesh, double longestEdge,
                                         const std::function<bool(const Patch&, const Patch&)>& between = {});

/// Whether something that stands on an edge in these directions stands in front of both patches.
bool isBetween(std::span<const glm::dvec3> standing, const Patch& a, const Patch& b);

}  // namespace lucerna
