// Chooses the lamps that have shadow maps if a scene has more than are allowed: those that light it most.
//
// Input: the views of all lamps of one kind. A lamp's importance is its flux reflected by surfaces, from a small
// reflective shadow map: light that misses the scene or hits black does not count.
#pragma once

#include "rsm/reflective_shadow_map.hpp"

#include <string_view>
#include <vector>

namespace lucerna {

/// Keeps the `most` lamps of `views` (all of one kind) that light the scene most, in their order, and returns the
/// others, the most important first. Draws nothing if there are no more than that. `lack`: what the others lack, for a
/// warning that names their share of the light; empty: nothing.
std::vector<LightViews> keepMostImportant(gl::ProgramLibrary& programs, const GpuScene& scene,
                                          std::vector<LightViews>& views, std::size_t most, std::string_view lack);

}  // namespace lucerna
