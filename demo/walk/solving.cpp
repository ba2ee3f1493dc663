#include "walk/solving.hpp"

#include "walk/controls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

constexpr std::size_t kMostPoints = 1024;
constexpr double kSecondsBeforeAGuess = 1.0;  // of the time that is left

}  // namespace

void SolvingState::begin() {
  isOn_ = true;
  cancelled = false;
  curve_.clear();
  begin("beginning");
}

void SolvingState::begin(const std::string& what) {
  what_ = what;
  share_ = -1.0;
  firstShare_ = 0.0;
  start_ = Clock::now();
}

void SolvingState::note(const std::string& what) {
  if (what != what_) begin(what);
}

void SolvingState::note(const RadiosityStage& stage) {
  using Kind = RadiosityStage::Kind;
  if (stage.kind == Kind::solving) {
    note("solving");
    share_ = -1.0;
    if (!(stage.solve.residual > 0.0)) return;
    if (curve_.size() >= kMostPoints) {  // every other point
      for (std::size_t i = 0; 2 * i < curve_.size(); ++i) curve_[i] = curve_[2 * i];
      curve_.resize(curve_.size() / 2);
    }
    curve_.push_back({stage.solve.products, stage.solve.residual});
    return;
  }
  const bool counts = stage.kind == Kind::formFactors && stage.total > 0;
  const double share =
      counts ? static_cast<double>(stage.done) / static_cast<double>(stage.total) : stage.prepares.share;
  const std::string what = counts ? "form factors" : *stage.prepares.what ? stage.prepares.what : "direct light";
  if (what != what_) {
    begin(what);
    firstShare_ = std::max(share, 0.0);
  }
  share_ = share;
}

std::string SolvingState::text() const {
  std::string text = what_;
  if (!curve_.empty() && what_ == "solving")
    return text +
           fmt::format(", residual {:.1e} after {:.4g} products", curve_.back().residual, curve_.back().products);
  if (share_ >= 0.0) text += fmt::format(", {:.0f} %", 100.0 * share_);
  const double seconds = secondsSince(start_), done = share_ - firstShare_;
  if (seconds > kSecondsBeforeAGuess && done > 0.0 && share_ < 1.0)
    text += fmt::format(", {:.0f} s left", std::ceil(seconds / done * (1.0 - share_)));
  return text;
}

void plotResidual(const SolvingState& solving, float lines) {
  const auto& curve = solving.curve();
  if (curve.size() < 2) return;
  double least = 1e300, most = -1e300;
  for (const SolvingState::Point& point : curve) {
    least = std::min(least, std::log10(point.residual));
    most = std::max(most, std::log10(point.residual));
  }
  least = std::floor(least);
  most = std::max(std::ceil(most), least + 1.0);
  const float scale = ImGui::GetFontSize();
  const ImVec2 corner = ImGui::GetCursorScreenPos(), size(ImGui::GetContentRegionAvail().x, lines * scale);
  const double end = curve.back().products;
  const auto place = [&](double products, double decade) {
    return ImVec2(corner.x + static_cast<float>(products / end) * size.x,
                  corner.y + static_cast<float>((most - decade) / (most - least)) * size.y);
  };
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, ImGui::GetColorU32(ImGuiCol_FrameBg));
  for (double decade = least + 1.0; decade < most; decade += 1.0)
    draw.AddLine(place(0.0, decade), place(end, decade), IM_COL32(255, 255, 255, 40));
  std::vector<ImVec2> points;
  for (const SolvingState::Point& point : curve) points.push_back(place(point.products, std::log10(point.residual)));
  draw.AddPolyline(points.data(), static_cast<int>(points.size()), IM_COL32(255, 190, 80, 255), 0, 0.12f * scale);
  for (const bool isUpper : {true, false}) {
    const ImVec2 text(corner.x + 0.3f * scale, isUpper ? corner.y : corner.y + size.y - 1.1f * scale);
    draw.AddText(text, IM_COL32(200, 200, 200, 255), fmt::format("1e{:.0f}", isUpper ? most : least).c_str());
  }
  ImGui::Dummy(size);
}

void showSolving(Ui& ui, SolvingState& solving) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float scale = ImGui::GetFontSize(), width = std::min(34.0f * scale, screen.x - 16.0f);
  constexpr float kLines = 5.0f;  // of the plot
  const std::string text = "Radiosity: " + solving.text();
  const bool plots = solving.curve().size() > 1;
  // Of this content's size: a window that sizes itself has that of the last frame's.
  const ImGuiStyle& style = ImGui::GetStyle();
  const float height = ImGui::CalcTextSize(text.c_str(), nullptr, false, width - 2.0f * style.WindowPadding.x).y +
                       (plots ? kLines * scale : ImGui::GetFrameHeight()) + ImGui::GetFrameHeight() +
                       2.0f * (style.WindowPadding.y + style.ItemSpacing.y);
  ImGui::SetNextWindowPos({8.0f, screen.y - 8.0f - 2.5f * scale}, ImGuiCond_Always, {0.0f, 1.0f});
  ImGui::SetNextWindowSize({width, height});
  ImGui::SetNextWindowBgAlpha(1.0f);
  ImGui::Begin("##solving", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoScrollbar);
  ui.noteWindow();
  wrapped(text);
  if (plots) plotResidual(solving, kLines);
  else ImGui::ProgressBar(static_cast<float>(std::max(solving.share(), 0.0)), {-1.0f, 0.0f}, "");
  ui.section("Radiosity");
  if (button(ui, "cancel (Escape)")) solving.cancelled = true;
  ui.section("");
  ImGui::End();
}

}  // namespace lucerna::demo
