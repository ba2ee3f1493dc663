#include "walk/labels.hpp"

#include "pathtracer/path_frame.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

constexpr float kBarWidth = 15.0f, kBarHeight = 0.7f, kMargin = 0.6f, kPad = 0.4f;  // in heights of the font

std::vector<std::string> linesOf(const WalkState& state, int index, Show show) {
  const SideState& side = state.sides[static_cast<std::size_t>(index)];
  const bool hasReference = state.reference && state.reference->samples() > 0;
  std::string title = index == 0 ? "A: " : "B: ";
  if (side.shows == Shows::picture && side.picture)
    title += std::filesystem::path(side.pictureShown).filename().string();
  else if (side.shows == Shows::reference && hasReference)
    title +=
        fmt::format("reference, {} sample{} a pixel{}", state.reference->samples(),
                    state.reference->samples() == 1 ? "" : "s", state.reference->showsDenoised() ? ", denoised" : "");
  else title += side.built.technique;
  const PathFrame* path =
      side.shows == Shows::technique && side.renderer ? pathFrameOf(side.renderer->technique()) : nullptr;
  if (path && path->denoisedSamples() > 1) title += ", denoised";
  if (side.shows == Shows::technique && side.built.component != "all") title += ", " + side.built.component;
  if (side.shows == Shows::technique && !side.built.settings.empty())
    title += fmt::format(", {} setting{}", side.built.settings.size(), side.built.settings.size() == 1 ? "" : "s");
  if (show == Show::picture) return {title};
  std::string measure(kShowNames[static_cast<std::size_t>(show)]);
  if (side.judgement.known()) measure += fmt::format(", NRMSE {:.2f} %", 100.0 * side.judgement.nrmse().value);
  return {title, measure};
}

std::array<std::string, 3> scaleOf(Show show, float errorScale) {
  switch (show) {
    case Show::signedError: return {fmt::format("-{:.3g}", errorScale), "0", fmt::format("+{:.3g}", errorScale)};
    case Show::relativeError: return {"0", "50 %", "100 %"};
    case Show::zScore: return {"-20", "0 sigma", "+20"};
    case Show::flip: return {"0", "0.5", "1"};
    default: return {};
  }
}

}  // namespace

std::vector<Label> placeLabels(const WalkState& state, glm::ivec2 view, Compare::Inputs& inputs) {
  std::vector<Label> labels;
  const bool one = inputs.layout == Layout::one;
  if (state.hemicube && inputs.left.radiance == &state.hemicube->picture()) {
    const float font = ImGui::GetFontSize();
    Label label;
    label.lines = state.hemicube->lines();
    float width = 0.0f;
    for (const std::string& text : label.lines) width = std::max(width, ImGui::CalcTextSize(text.c_str()).x);
    label.corner = glm::vec2(kMargin * font);
    label.size = {width + 2.0f * kPad * font, (static_cast<float>(label.lines.size()) + 2.0f * kPad) * font};
    labels.push_back(label);
    return labels;
  }
  if (one && (inputs.left.show == Show::picture || inputs.left.show == Show::values)) return labels;
  const float font = ImGui::GetFontSize();
  const glm::vec2 pixels(view);
  const float edge = one ? pixels.x : (inputs.layout == Layout::sideBySide ? 0.5f : inputs.split) * pixels.x;
  for (int i = 0; i < (one ? 1 : 2); ++i) {
    Compare::Side& side = i == 0 ? inputs.left : inputs.right;
    Label label;
    label.lines = linesOf(state, one ? state.shown : i, side.show);
    label.scale = scaleOf(side.show, inputs.errorScale);
    const bool hasBar = !label.scale[0].empty();
    float width = hasBar ? kBarWidth * font : 0.0f;
    for (const std::string& text : label.lines) width = std::max(width, ImGui::CalcTextSize(text.c_str()).x);
    const float text = static_cast<float>(label.lines.size());
    label.size = {width + 2.0f * kPad * font, (text + 2.0f * kPad + (hasBar ? kBarHeight + 1.0f + kPad : 0.0f)) * font};
    if (label.size.x + 2.0f * kMargin * font > (i == 0 ? edge : pixels.x - edge)) continue;
    const bool atTheRight = i == 1 && inputs.layout == Layout::wipe;
    const float left = atTheRight ? pixels.x - kMargin * font - label.size.x : (i == 0 ? 0.0f : edge) + kMargin * font;
    label.corner = {left, kMargin * font};
    if (hasBar) {
      const glm::vec2 bar(kBarWidth * font, kBarHeight * font);
      const glm::vec2 corner = label.corner + font * glm::vec2(kPad, text + 2.0f * kPad);
      side.bar = {corner.x, pixels.y - corner.y - bar.y, bar.x, bar.y};
    }
    labels.push_back(label);
  }
  return labels;
}

void drawLabels(const std::vector<Label>& labels, ImDrawList& list) {
  const float font = ImGui::GetFontSize();
  const ImU32 box = IM_COL32(20, 20, 20, 200), white = IM_COL32(235, 235, 235, 255);
  for (const Label& label : labels) {
    const glm::vec2 end = label.corner + label.size, inner = label.corner + kPad * font;
    // The box leaves the colour scale free, which is below it already.
    const float bar = inner.y + (static_cast<float>(label.lines.size()) + kPad) * font, below = bar + kBarHeight * font;
    const bool hasBar = !label.scale[0].empty();
    list.AddRectFilled({label.corner.x, label.corner.y}, {end.x, hasBar ? bar : end.y}, box);
    if (hasBar) {
      list.AddRectFilled({label.corner.x, bar}, {inner.x, below}, box);
      list.AddRectFilled({inner.x + kBarWidth * font, bar}, {end.x, below}, box);
      list.AddRectFilled({label.corner.x, below}, {end.x, end.y}, box);
      for (std::size_t i = 0; i < label.scale.size(); ++i) {
        const float width = ImGui::CalcTextSize(label.scale[i].c_str()).x;
        const float x = inner.x + static_cast<float>(i) * 0.5f * (kBarWidth * font - width);
        list.AddText({x, below}, white, label.scale[i].c_str());
      }
    }
    for (std::size_t i = 0; i < label.lines.size(); ++i)
      list.AddText({inner.x, inner.y + static_cast<float>(i) * font}, white, label.lines[i].c_str());
  }
}

}  // namespace lucerna::demo
