#include "walk/overlay.hpp"

#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "shared/paths.hpp"
#include "walk/pixel_section.hpp"

#include <fmt/format.h>

namespace lucerna::demo {

void Overlay::draw(const Frame& frame) {
  drawGlyphs(frame);
  drawGizmo(frame);
  drawLines(frame);
}

bool Overlay::drags(glm::vec2 cursor, bool isPressed) {
  return state_.movesLamps && screen_ && gizmo_.take(*state_.scene, *screen_, cursor, isPressed);
}

// Rebuilt when the camera or their source has changed.
void Overlay::drawGlyphs(const Frame& frame) {
  const SideState& side = state_.side();
  if (state_.glyphs == Glyphs::none || !side.renderer || side.shows == Shows::picture) return;
  const Camera& camera = state_.camera->camera();
  const IrradianceCache* cache = cacheOf(side.renderer->technique());  // their light changes from frame to frame
  const std::string are =
      fmt::format("{} {} {} {} {} {} {} {}", static_cast<int>(state_.glyphs), side.builtAs, state_.glyphCascade,
                  state_.glyphLevel, state_.glyphMost, cameraText(*state_.scene, camera), state_.shown,
                  state_.glyphs == Glyphs::records && cache ? cache->nextFrame() : 0);
  if (state_.glyphs != Glyphs::boxes) bvh_.reset();
  else if (!bvh_ || bvhOf_ != state_.sceneVersion) bvh_ = buildBvh(*state_.scene), bvhOf_ = state_.sceneVersion;
  if (bvh_ && are != glyphsAre_) glyphs_ = boxesOf(*bvh_, side.renderer->origin(), state_.glyphLevel, state_.glyphMost);
  else if (are != glyphsAre_)
    glyphs_ = glyphsOf(state_.glyphs, *side.renderer, *state_.scene, camera, state_.glyphCascade, state_.glyphMost);
  glyphsAre_ = are;
  if (!lines_) lines_.emplace(programs_);
  lines_->draw(frame.target,
               Compare::placementOf(frame.inputs, frame.view, frame.inputs.layout != Layout::one && state_.shown == 1),
               side.renderer->linesView(camera, state_.scene->bounds), glyphs_, frame.scale);
}

void Overlay::drawGizmo(const Frame& frame) {
  const SideState& side = state_.side();
  screen_.reset();
  if (!state_.movesLamps || !side.renderer) return;
  const Renderer& renderer = *side.renderer;
  screen_ = Gizmo::Screen{
      Compare::placementOf(frame.inputs, frame.view, frame.inputs.layout != Layout::one && state_.shown == 1),
      renderer.linesView(state_.camera->camera(), state_.scene->bounds), renderer.origin(), frame.windowHeight};
  if (!lines_) lines_.emplace(programs_);
  gl::Lines::View view = screen_->view;
  view.depth = nullptr;  // a lamp behind a wall can be grabbed too
  lines_->draw(frame.target, screen_->placement, view, gizmo_.lines(*state_.scene, renderer.origin()),
               3.0f * frame.scale);
}

void Overlay::drawLines(const Frame& frame) {
  if (!state_.answer || !state_.drawsAnswer) return;
  const bool right = frame.inputs.layout != Layout::one && state_.inspectedSide == 1;
  if (frame.inputs.layout == Layout::one && state_.inspectedSide != state_.shown) return;
  const SideState& side = state_.sides[static_cast<std::size_t>(state_.inspectedSide)];
  if (!side.renderer || side.shows == Shows::picture) return;
  const Renderer& renderer = *side.renderer;
  const gl::Lines::View view = renderer.linesView(state_.camera->camera(), state_.scene->bounds);
  if (!lines_) lines_.emplace(programs_);
  lines_->draw(frame.target, Compare::placementOf(frame.inputs, frame.view, right), view,
               linesOf(*state_.answer, state_.pointedShare, renderer.origin(), state_.scene->bounds),
               1.5f * frame.scale);
}

}  // namespace lucerna::demo
