// Any scene as triangles of the radiosity original (no GL, pure): the real 3D format that its author wished for
// [RAD2008 chapter 5].
//
// Patches as radiosity has them (patches.hpp), so textures and emission are means over each. The original counts in one
// channel and whole numbers:
// - ro: the mean of the reflectance's three channels;
// - e: exitance, the mean of the three channels, in steps of which the brightest patch has `lightPower`.
// RadScene::exitanceOfStep says what one is;
// - c: the reflectance, or what a patch emits, over its largest channel. It takes no part in the computation;
// - b: 0.
// Lights without a surface and the environment have no place in the file.
#pragma once

#include "radiosity/original/rad_file.hpp"
#include "radiosity/patches.hpp"
#include "scene/scene.hpp"

namespace lucerna {

struct RadSceneSettings {
  double longestEdge = 0.0;  ///< scene units; 0: a 12th of the scene's largest side
  std::uint32_t lightPower = 100000;  ///< of the brightest patch, 1..kRadMost
};

struct RadScene {
  std::vector<RadTriangle> triangles;
  double exitanceOfStep = 0.0;  ///< W/m^2 that one step of e and b stands for
  double longestEdge = 0.0;  ///< as it was used
  std::size_t sources = 0;
};

/// Throws Error(badInput): no surface emits, no triangle has an area, a reflectance above 1.
RadScene radTrianglesOf(const Scene& scene, const RadSceneSettings& settings);

/// A mesh's patches in order, one colour channel (0 to 2) of reflectance and of what each sends out by itself.
std::vector<RadTriangle> radTrianglesOf(const RadiosityMesh& mesh, std::span<const glm::dvec3> exitance, int channel,
                                        double exitanceOfStep);

}  // namespace lucerna
