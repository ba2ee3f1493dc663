// Chooses the lamps to draw if a scene has more than the shaders support: those that light it most.
//
// Input: the views of all lamps of one kind. A lamp's importance is its flux reflected by surfaces, from a small
// reflective shadow map: light that misses the scene or hits black does not count.
#pragma once

#include "rsm/reflective_shadow_map.hpp"

#include <vector>

namespace lucerna {

/// Keeps the `most` lamps of `views` (all of one kind) that light the scene most, in their order. One warning names the
/// others and their share of the light. Draws nothing if there are no more than that.
void keepMostImportant(gl::ProgramLibrary& programs, const GpuScene& scene, std::vector<LightViews>& views,
                       std::size_t most);

}  // namespace lucerna
