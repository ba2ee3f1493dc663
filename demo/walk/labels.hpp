// What a comparison shows, written into the picture: the name of each side and, for errors, a colour scale with its
// numbers. Screenshots and videos have them too.
#pragma once

#include "walk/compare.hpp"
#include "walk/state.hpp"

#include <array>
#include <string>
#include <vector>

struct ImDrawList;

namespace lucerna::demo {

struct Label {
  std::vector<std::string> lines;
  std::array<std::string, 3> scale;  ///< at the beginning, middle and end of the colour scale; empty: there is none
  glm::vec2 corner{0.0f}, size{0.0f};  ///< of its box, pixels from the top left
};

/// Labels of the sides in a target of `view` pixels, none if one picture is shown as it is; sets the places of colour
/// scales in `inputs`. A side that is too narrow for its label has none. Within a frame of ImGui, whose font it
/// measures.
std::vector<Label> placeLabels(const WalkState& state, glm::ivec2 view, Compare::Inputs& inputs);
void drawLabels(const std::vector<Label>& labels, ImDrawList& list);

}  // namespace lucerna::demo
