// The bounds for which resolutions are chosen: of grids of light, shadow maps, near planes and patches (no GL).
#pragma once

#include "scene/scene.hpp"

#include <optional>
#include <vector>

namespace lucerna {

/// Diagonals of what lies together, from which on something else is far off.
inline constexpr double kFarOff = 8.0;

/// A mesh: where it is, and where it is during the whole motion.
struct SweptBounds {
  Bounds own, swept;
};

/// The bounds without meshes that are far off and small: more than kFarOff diagonals of all others from their centre,
/// and less than 1/100 of that distance wide (0.6 degrees as seen from there). nullopt: there are none such.
/// What is near is decided from the median of the meshes on, weighted by their squared diagonals, as cameras see them
/// if there are any. A mesh that is always less than kFarOff of its own diagonals from a camera is not far off.
std::optional<Bounds> boundsWithoutFarMeshes(const std::vector<SweptBounds>& meshes,
                                             const std::vector<Camera>& cameras);

/// Finds the main bounds of a scene as it is now.
void findMainBounds(Scene& scene);

}  // namespace lucerna
