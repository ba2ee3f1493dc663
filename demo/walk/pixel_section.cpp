#include "walk/pixel_section.hpp"

#include "inspect.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "walk/controls.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

/// A name, its share, and a bar of that length.
void showShare(const std::string& name, double share, ImU32 color) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = ImGui::GetTextLineHeightWithSpacing();
  ImGui::Selectable(("##" + name).c_str(), false, 0, ImVec2(0.0f, ImGui::GetTextLineHeight()));
  const float length = width * static_cast<float>(std::clamp(std::abs(share), 0.0, 1.0));
  ImGui::GetWindowDrawList()->AddRectFilled(corner, {corner.x + length, corner.y + height - 2.0f}, color);
  const std::string figure = fmt::format("{:.1f} %", 100.0 * share);
  const float figureWidth = ImGui::CalcTextSize(figure.c_str()).x;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushClipRect(corner, {corner.x + width - figureWidth - 6.0f, corner.y + height}, true);
  list.AddText({corner.x + 2.0f, corner.y}, IM_COL32_WHITE, name.c_str());
  list.PopClipRect();
  list.AddText({corner.x + width - figureWidth, corner.y}, IM_COL32_WHITE, figure.c_str());
}

/// "3 times" from "scattered 3 times": the full names are long.
std::string timesOf(const std::string& group) {
  constexpr std::string_view kScattered = "scattered ";
  return group.starts_with(kScattered) ? group.substr(kScattered.size()) : group;
}

void saveAnswer(WalkState& s) {
  const PixelInspection& answer = *s.answer;
  try {
    std::error_code ignored;
    std::filesystem::create_directories(s.shotFolder, ignored);
    const std::filesystem::path file =
        s.shotFolder / fmt::format("{}_pixel_{}_{}.json", s.scene->name, answer.pixel.x, answer.pixel.y);
    const std::string text = toJson(answer).dump(2) + "\n";
    writeFileAtomically(file, std::vector<std::uint8_t>(text.begin(), text.end()));
    s.say(fmt::format("{} written", file.string()));
  } catch (const Error& error) { s.say(error.what()); }
}

constexpr ImU32 kGroupColor = IM_COL32(70, 110, 160, 190), kShareColor = IM_COL32(130, 100, 40, 190),
                kNegativeColor = IM_COL32(140, 50, 50, 190);

}  // namespace

void showPixel(Ui& ui, WalkState& s) {
  checkbox(ui, "inspect by clicking", s.inspectsByClick);
  explain(
      "Click on the picture to see what lit that pixel, instead of looking around. Key I shows it for the pixel under "
      "the cursor.");
  if (!s.answer) {
    wrapped("Press I over a pixel to see what lit it.");
    return;
  }
  const PixelInspection& answer = *s.answer;
  ImGui::SameLine();
  checkbox(ui, "draw its light", s.drawsAnswer);
  line(fmt::format("pixel {}, {} of {}: {}", answer.pixel.x, answer.pixel.y, s.inspectedSide == 0 ? "A" : "B",
                   answer.technique));
  line(fmt::format("radiance {:.4g} {:.4g} {:.4g}", answer.radiance.x, answer.radiance.y, answer.radiance.z));
  if (answer.samples > 0)
    line(fmt::format("{} paths, +- {:.2g} {:.2g} {:.2g}", answer.samples, answer.standardError.x,
                     answer.standardError.y, answer.standardError.z));
  const double all = answer.shareOf(answer.sum());
  line(fmt::format("shares add up to {:.2f} %", 100.0 * all));
  explain("The rest is the rounding of filters and, for patches, light moved by making form factors reciprocal.");
  for (const auto& [group, radiance] : answer.groups()) showShare(group, answer.shareOf(radiance), kGroupColor);
  ImGui::Separator();
  s.pointedShare = -1;
  ImGui::BeginChild("shares", ImVec2(0.0f, 14.0f * ImGui::GetTextLineHeightWithSpacing()));
  for (std::size_t i = 0; i < answer.shares.size(); ++i) {
    const PixelShare& share = answer.shares[i];
    const double part = answer.shareOf(share.radiance);
    ImGui::PushID(static_cast<int>(i));
    const std::string name = share.group == "direct" || share.places.size() < 2 || answer.samples == 0
                                 ? share.name
                                 : fmt::format("{}, {}", share.name, timesOf(share.group));
    showShare(name, part, part < 0.0 ? kNegativeColor : kShareColor);
    if (ImGui::IsItemHovered()) {
      s.pointedShare = static_cast<int>(i);
      std::string text = fmt::format("{}\n{}\nradiance {:.4g} {:.4g} {:.4g}", share.group, share.name, share.radiance.x,
                                     share.radiance.y, share.radiance.z);
      if (share.weight) text += fmt::format("\nweight {:.4g}", *share.weight);
      if (!share.places.empty())
        text += fmt::format("\nfrom {:.4g}, {:.4g}, {:.4g}", share.places.back().x, share.places.back().y,
                            share.places.back().z);
      explain(text);
    }
    ImGui::PopID();
  }
  ImGui::EndChild();
  if (button(ui, "export as JSON")) saveAnswer(s);
  ImGui::SameLine();
  if (button(ui, "forget")) s.answer.reset();
}

std::vector<gl::Lines::Line> linesOf(const PixelInspection& answer, int pointedAt, const glm::dvec3& origin,
                                     const Bounds& bounds) {
  std::vector<gl::Lines::Line> lines;
  double most = 1e-300;
  for (const PixelShare& share : answer.shares)
    if (share.places.size() > 1) most = std::max(most, std::abs(answer.shareOf(share.radiance)));
  const auto cross = [&](const glm::dvec3& place, double size, const glm::vec4& color) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 arm(0.0);
      arm[axis] = size;
      lines.push_back({glm::vec3(place - arm - origin), glm::vec3(place + arm - origin), color});
    }
  };
  const double size = 0.006 * glm::length(bounds.extent());
  for (std::size_t i = 0; i < answer.shares.size(); ++i) {
    const PixelShare& share = answer.shares[i];
    if (share.places.size() < 2) continue;
    const double part = answer.shareOf(share.radiance);
    const bool isPointedAt = static_cast<int>(i) == pointedAt;
    const glm::vec3 hue = isPointedAt  ? glm::vec3(1.0f)
                          : part < 0.0 ? glm::vec3(1.0f, 0.3f, 0.3f)
                                       : glm::vec3(1.0f, 0.8f, 0.2f);
    const glm::vec4 color(hue, isPointedAt ? 1.0f : static_cast<float>(0.15 + 0.75 * std::abs(part) / most));
    // A path begins at the camera, from where its line would appear as a point.
    const std::size_t first = answer.samples > 0 && share.places.size() > 2 ? 1 : 0;
    for (std::size_t k = first; k + 1 < share.places.size(); ++k)
      lines.push_back({glm::vec3(share.places[k] - origin), glm::vec3(share.places[k + 1] - origin), color});
    cross(share.places.back(), isPointedAt ? 2.0 * size : size, color);
  }
  if (answer.surface) cross(answer.surface->position, 1.5 * size, {0.2f, 1.0f, 0.4f, 1.0f});
  return lines;
}

}  // namespace lucerna::demo
