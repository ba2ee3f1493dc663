// The panel's section on the pixel that was asked for, and its light as lines in the scene.
#pragma once

#include "gl/lines.hpp"
#include "walk/state.hpp"
#include "walk/ui.hpp"

#include <vector>

namespace lucerna::demo {

void showPixel(Ui& ui, WalkState& state);
/// Where the pixel's light comes from, about `origin`: a line a share, the brighter the more opaque, and a cross where
/// the light is.
std::vector<gl::Lines::Line> linesOf(const PixelAnswer& answer, int pointedAt, const glm::dvec3& origin,
                                     const Bounds& bounds);

}  // namespace lucerna::demo
