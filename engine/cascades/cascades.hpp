// Placement of nested grids around the camera (no GL, pure): the original's `Grid` and `translateGrid`. The light
// propagation volume and the irradiance cache store light in them.
//
// A grid's minimum is always an exact multiple of its cell size, found with floor in double precision from a 64-bit
// cell index, so moving the camera by less than a cell leaves the grid where it is, at any distance from the origin.
// Source: [LPV2015, 6.4]; [Kaplanyan2010, section 5].
#pragma once

#include "scene/scene.hpp"
#include "shared/cascades.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace lucerna {

struct CascadeSettings {
  int cells = 32;  ///< per side of every cascade; at least 1
  int cascades = 3;  ///< 1..4
  double cellSize = 0.0;  ///< of the coarsest, scene units; 0: so that half its cells span the scene
  double ratio = 2.0;  ///< cell size of a cascade over that of the next finer one
  double push = 0.8;  ///< how far the centre is pushed along the view, in half extents of the grid
  double spanOfScene = 2.0;  ///< edge of the coarsest over the scene's longest side, if cellSize is 0
  bool heldInScene = true;  ///< clamp centres so that grids do not stick out of the scene more than necessary
  int steps = 2;  ///< cells by which all but the coarsest move: joining then always averages the same pairs of cells
};

struct Cascade {
  glm::i64vec3 firstCell{0};  ///< minimum = firstCell * cellSize
  double cellSize = 1.0;  ///< scene units
  glm::dvec3 centre{0.0};  ///< before snapping: blending follows it, so that it does not jump
  double reach = 0.0;  ///< of placeCascadesAround: distance from `centre` at which it has faded out, scene units

  glm::dvec3 minimum() const { return glm::dvec3(firstCell) * cellSize; }
};

/// The cascades for a view, finest first.
/// Each follows the camera: its centre is the camera, pushed along the view, then clamped so that the grid does not
/// stick out of the scene more than necessary, then snapped.
std::vector<Cascade> placeCascades(const CascadeSettings& settings, const Bounds& scene,
                                   const glm::dvec3& cameraPosition, const glm::dvec3& cameraDirection);

/// The same, blended by the distance from the camera: turning it does not change what a surface shows. `centre` is the
/// camera, or with heldInScene the point of the scene nearest to it. `reach` is the largest distance from a camera in
/// the scene at which all that is in view (aspect: width over height) is within the cascade, whichever way the camera
/// looks.
std::vector<Cascade> placeCascadesAround(const CascadeSettings& settings, const Bounds& scene, const Camera& camera,
                                         double aspect);

/// Cascades as shaders read them. blendBand: fraction of a cascade's half extent over which it fades into the next.
/// referenceIrradiance > 0: of the order of the irradiance, only scales stored values. lookupOffset: cells along the
/// normal.
shared::CascadeConstants cascadeConstants(const CascadeSettings& settings, const std::vector<Cascade>& cascades,
                                          float blendBand, float referenceIrradiance, float lookupOffset = 0.0f);

}  // namespace lucerna
