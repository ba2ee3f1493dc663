// Lines over the picture: records and cells, lamps to drag, what lit an inspected pixel.
#pragma once

#include "gl/lines.hpp"
#include "walk/compare.hpp"
#include "walk/gizmo.hpp"
#include "walk/state.hpp"

#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

class Overlay {
 public:
  struct Frame {
    const gl::Framebuffer& target;
    const Compare::Inputs& inputs;
    glm::ivec2 view;  ///< the window without the panel
    int windowHeight;
    float scale;  ///< pixels of a line of width 1
  };
  Overlay(gl::ProgramLibrary& programs, WalkState& state) : programs_(programs), state_(state) {}

  /// Drawn over the picture of its side and hidden by the surfaces in that picture.
  void draw(const Frame& frame);
  /// Whether the cursor, in pixels of the window, holds a lamp of the last frame. It moves with the cursor.
  bool drags(glm::vec2 cursor, bool isPressed);

 private:
  void drawGlyphs(const Frame& frame);
  void drawGizmo(const Frame& frame);
  void drawLines(const Frame& frame);

  gl::ProgramLibrary& programs_;
  WalkState& state_;
  std::optional<gl::Lines> lines_;
  Gizmo gizmo_;
  std::optional<Gizmo::Screen> screen_;  ///< in the last frame
  std::vector<gl::Lines::Line> glyphs_;
  std::string glyphsAre_;
  std::optional<Bvh> bvh_;  ///< for its boxes
  std::uint64_t bvhOf_ = 0;  ///< version of the scene  ///< what glyphs_ was made from
};

}  // namespace lucerna::demo
