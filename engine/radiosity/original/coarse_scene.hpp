// A coarser model of a scene (no GL, pure), for the published program: it draws every triangle five times for each one,
// so a scene of 100,000 triangles would take it weeks.
//
// Vertex clustering [RossignacBorrel1993]: corners in the same cell of a regular grid become one point, the mean of
// them by the area of their triangles. Triangles with two corners in one cell vanish; of those with the same three
// points and the same front the largest is kept. One grid serves all materials, so surfaces that meet still meet.
// Emissive triangles stay as they are, so emitted power is kept. Reflectance and texture coordinates are those of the
// kept triangle.
#pragma once

#include "radiosity/patches.hpp"
#include "scene/scene.hpp"

namespace lucerna {

struct CoarseScene {
  Scene scene;  ///< its triangles have three vertices each; lights, materials, textures and cameras of the original
  double cell = 0.0;  ///< side of a cell, scene units; 0: the scene as it was
  std::size_t triangles = 0;  ///< of the scene as it was
  double area = 1.0;  ///< of all triangles, over that of the scene as it was
  double longestEdge = 0.0;  ///< of its patches, for at most as many as asked; 0: triangles stay whole
};

/// A model with cells of this side, above 0. Throws Error(badInput) if nothing with an area is left.
CoarseScene coarserScene(const Scene& scene, double cell);

/// The scene itself if `patches` makes at most `most` patches of it; otherwise the model of the finest cells that
/// does. Throws Error(badInput) if even cells of half the scene leave more: too many emissive triangles, or too short
/// an edge.
CoarseScene coarserScene(const Scene& scene, const PatchSettings& patches, std::size_t most);

/// The same where the longest edge is free, from `patches.longestEdge` (above 0) up. Up to half of `most` triangles are
/// the scene itself, cut into as many patches as fit. Of a scene with more, edges are at most six cells long: longer
/// triangles would keep large surfaces whole, and shorter ones leave no patches for the shape.
CoarseScene coarserSceneAndEdge(const Scene& scene, const PatchSettings& patches, std::size_t most);

}  // namespace lucerna
