// A scene's surfaces as patches of constant exitance (no GL, pure): the unknowns of radiosity.
//
// Every triangle with an area becomes one or more patches. Corners in the same place become one point, and edges are
// cut for both of their patches at once, so that no T-junctions arise. A patch faces the side of its shading normals
// (or of its winding without them); its back blocks light. Where a back matters it is a patch of its own (backs.hpp).
#pragma once

#include "scene/scene.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

namespace lucerna {

constexpr int kPatchParts = 4;  ///< per side; parts can be hidden separately

struct Patch {
  std::array<std::uint32_t, 3> point{};  ///< into RadiosityMesh::points, counterclockwise seen from the front
  std::array<std::uint32_t, 3> light{};  ///< light vertices, shared by corners between which light is interpolated
  std::array<glm::vec2, 3> texCoord{};
  std::array<glm::vec3, 3> normal{};  ///< shading normals, on the front side
  glm::dvec3 centroid{0.0}, faceNormal{0.0};
  double area = 0.0;  ///< scene units squared
  std::uint16_t hidden =
      0;  ///< a bit per part (kPatchParts x kPatchParts, scene/triangle_parts.hpp) that is hidden: hidden_parts.hpp
  glm::dvec3 reflectance{0.0};  ///< mean over the patch, 0..1
  glm::dvec3 emission{0.0};  ///< own exitance, pi times the material's radiance
  int material = 0;
  std::uint32_t triangle = 0;  ///< of the scene
  bool isBack = false;  ///< a triangle's second patch, on its other side: backs.hpp
};

using MeshEdge = std::array<std::uint32_t, 2>;  ///< two points, the smaller index first
constexpr MeshEdge edgeOf(std::uint32_t a, std::uint32_t b) { return a < b ? MeshEdge{a, b} : MeshEdge{b, a}; }

struct PatchSettings {
  bool contacts = false;  ///< patches are cut where other triangles touch or cross them: contacts.hpp
  double longestEdge = 0.0;  ///< scene units; longer edges are halved. 0: triangles stay whole
  double weld = 1e-6;  ///< corners closer than this fraction of the scene's largest extent are one point
  double crease = 0.94;  ///< minimum cosine between shading normals across which light is interpolated
};

struct RadiosityMesh {
  std::vector<glm::dvec3> points;
  std::vector<Patch> patches;
  /// Unit directions in which surfaces stand on an edge. Between two patches that both have such a surface in front,
  /// light is not interpolated: it comes from two sides of a wall.
  std::map<MeshEdge, std::vector<glm::dvec3>> standing;
  std::size_t lightVertices = 0;
  std::size_t degenerate = 0;  ///< triangles without area, omitted; narrow ones that emit have one
  std::size_t notFinite = 0;  ///< triangles with a corner that is not finite, omitted
  std::size_t duplicates = 0;  ///< triangles that coincide with another of the same front, omitted
  std::size_t flipped = 0;  ///< triangles wound against their shading normals, turned
  double extent = 0.0;  ///< largest side of the bounds

  double area() const;
  /// Corners in mesh order, as the visibility passes read them.
  std::array<glm::dvec3, 3> corners(const Patch& patch) const {
    return {points[patch.point[0]], points[patch.point[1]], points[patch.point[2]]};
  }
};

/// Throws Error(badInput) if nothing with an area is left, or if a reflectance or emission is not a finite number >= 0
/// (reflectances above 1 are refused too: they would create energy).
RadiosityMesh makePatches(const Scene& scene, const PatchSettings& settings);

/// Halves the marked edges of patches, and the longest edges of the patches that they belong to [Rivara1984], so that
/// patches stay well shaped and no T-junction arises. `marked` takes a patch's index and an edge 0..2 (from corner k to
/// corner k + 1). `parent`, if given, receives the index of each new patch's original patch.
RadiosityMesh refined(const Scene& scene, const RadiosityMesh& mesh, const PatchSettings& settings,
                      const std::function<bool(std::size_t, int)>& marked,
                      std::vector<std::uint32_t>* parent = nullptr);

/// Cuts a patch at a place along edge k (0 at corner k, 1 at the next), which is the point `at`. The first half keeps
/// corner k. Areas and means are those of the whole patch.
std::array<Patch, 2> halvesOf(const Patch& patch, std::size_t k, double place, std::uint32_t at);

/// Numbers the light vertices: corners share one if point and material are the same, their normals differ by less than
/// the crease, and nothing that stands on an edge is between them.
void numberLightVertices(RadiosityMesh& mesh, const PatchSettings& settings);

/// Patches as a separate scene, in order, for a hierarchy; its second material emits.
Scene sceneOf(const RadiosityMesh& mesh);

}  // namespace lucerna
