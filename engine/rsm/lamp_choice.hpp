// Which lamps are drawn where a scene has more than shaders hold: those that light it most, not the first.
//
// Input: the views of all lamps of one kind. A lamp's importance is the flux that surfaces reflect of it, from a small reflective shadow map: what goes past the scene or onto
// black counts for nothing, wherever the lamp stands in the list.
#pragma once

#include "rsm/reflective_shadow_map.hpp"

#include <vector>

namespace lucerna {

/// Leaves the `most` lamps of `views` that light the scene most, in their order. All of one kind. The others are named in one warning, with their share of what all of them light.
/// Draws nothing where there are no more than that.
void keepMostImportant(gl::ProgramLibrary& programs, const GpuScene& scene, std::vector<LightViews>& views, std::size_t most);

}  // namespace lucerna
