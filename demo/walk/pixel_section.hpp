// The panel's section on the inspected pixel, and its light paths as lines in the scene.
#pragma once

#include "gl/lines.hpp"
#include "walk/state.hpp"
#include "walk/ui.hpp"

#include <vector>

namespace lucerna::demo {

void showPixel(Ui& ui, WalkState& state);
/// Sources of the pixel's light, relative to `origin`: one line per share, more opaque for brighter ones, and a cross
/// at the light.
std::vector<gl::Lines::Line> linesOf(const PixelInspection& answer, int pointedAt, const glm::dvec3& origin,
                                     const Bounds& bounds);

}  // namespace lucerna::demo
