// Converts any scene to triangles of the radiosity original (no GL, pure): the real 3D format that its author wished
// for [RAD2008 chapter 5].
//
// Uses the patches of radiosity (patches.hpp), so textures and emission are averaged per patch. The original counts in
// one channel and whole numbers:
// - ro: the mean of the reflectance's three channels;
// - e: exitance, the mean of the three channels, in steps such that the brightest patch has `lightPower`.
//   RadScene::exitanceOfStep is the size of a step;
// - c: the reflectance, or a patch's emission, over its largest channel. It takes no part in the computation;
// - b: 0.
// The file cannot represent lights without a surface, nor the environment.
#pragma once

#include "radiosity/original/rad_file.hpp"
#include "radiosity/patches.hpp"
#include "scene/scene.hpp"

#include <functional>

namespace lucerna {

struct RadSceneSettings {
  double longestEdge = 0.0;  ///< scene units; 0: a 12th of the scene's largest side
  std::uint32_t lightPower = 100000;  ///< of the brightest patch, 1..kRadMost
};

struct RadScene {
  std::vector<RadTriangle> triangles;
  double exitanceOfStep = 0.0;  ///< W/m^2 per step of e and b
  double longestEdge = 0.0;  ///< the value used
  std::size_t sources = 0;
};

/// Irradiance of each patch by lights that the file cannot hold: it is reflected as the patch's own emission.
using RadReceived = std::function<std::vector<glm::dvec3>(const RadiosityMesh&)>;

/// Throws Error(badInput) if no surface emits, no triangle has an area, or a reflectance is above 1.
RadScene radTrianglesOf(const Scene& scene, const RadSceneSettings& settings, const RadReceived& received = {});

/// A mesh's patches in order, with one colour channel (0 to 2) of reflectance and of each patch's own exitance.
std::vector<RadTriangle> radTrianglesOf(const RadiosityMesh& mesh, std::span<const glm::dvec3> exitance, int channel,
                                        double exitanceOfStep);

/// The way back: a scene of the file's triangles, one material for each pair of reflectance and emission. Exitances are
/// the file's own whole numbers.
Scene sceneOfTriangles(std::span<const RadTriangle> triangles, const std::string& name);

/// The triangles with the irradiance of their patches, rounded, as received radiosity. `mesh` is made of
/// sceneOfTriangles() with whole triangles; triangles without a patch receive 0.
std::vector<RadTriangle> withReceived(std::vector<RadTriangle> triangles, const Scene& scene, const RadiosityMesh& mesh,
                                      std::span<const glm::dvec3> irradiance);

}  // namespace lucerna
