#include "walk/settings_section.hpp"

#include "render/deviations.hpp"
#include "render/settings.hpp"
#include "walk/controls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

/// A setting's tooltip: its meaning, its source, and what a change costs.
std::string explanation(const Setting& setting) {
  std::string text = std::string(setting.meaning);
  text += fmt::format("\n{}: {}{}", nameOf(setting.value.type), allowedValues(setting),
                      setting.unit.empty() ? "" : fmt::format(", {}", setting.unit));
  text += "\nusually " + defaultValue(setting);
  if (!setting.source.empty()) text += fmt::format("\nsource: {} (shaders/REFERENCES.md)", setting.source);
  switch (setting.cost) {
    case SettingCost::uniform: text += "\na change is seen in the next frame"; break;
    case SettingCost::rebuild: text += "\na change makes the technique anew"; break;
    case SettingCost::solution: text += "\na change solves radiosity anew"; break;
  }
  return text;
}

/// Formats a number as --set takes it, rounded and checked by the table.
std::string textOfNumber(const Setting& setting, const RenderSettings& settings, double number) {
  RenderSettings copy = settings;
  setSettingNumber(setting, copy, std::clamp(number, setting.value.least, setting.value.most));
  return printSetting(setting, copy);
}

/// A slider that passes its value on when it is released, because a change may rebuild the technique. `dragged` keeps
/// the value meanwhile. The slider ends at 16 times the default. Larger values can be typed after Ctrl+click: 100,000
/// propagation steps are allowed, but at the end of a slider they would freeze the window by accident.
std::optional<double> numberControl(Ui& ui, const std::string& key, const Setting& setting, double current) {
  static const RenderSettings usual;
  constexpr double kMostOfUsual = 16.0;
  static std::string dragged;
  static double draggedValue = 0.0;
  const SettingValue& v = setting.value;
  double shown = dragged == key ? draggedValue : std::isfinite(current) ? current : v.least;
  const double often = settingNumber(setting, usual);
  const double most =
      std::isfinite(often) && often > 0.0 ? std::min(v.most, std::max(kMostOfUsual * often, shown)) : v.most;
  const bool wide = most > 100.0 * std::max(1.0, std::abs(v.least));
  const ImGuiSliderFlags flags = wide && v.least >= 0.0 ? ImGuiSliderFlags_Logarithmic : 0;
  const bool whole = v.type == SettingType::integer;
  const std::string unit = setting.unit.empty() ? "" : " " + std::string(setting.unit);
  std::string format = whole ? "%.0f" + unit : "%.4g" + unit;
  std::replace(format.begin() + (whole ? 4 : 4), format.end(), '%', 'p');
  ImGui::SliderScalar(key.c_str(), ImGuiDataType_Double, &shown, &v.least, &most, format.c_str(), flags);
  ui.note(key);
  if (ImGui::IsItemActive()) {
    dragged = key;
    draggedValue = whole ? std::round(shown) : shown;
  }
  if (!ImGui::IsItemDeactivatedAfterEdit() || dragged != key) return {};
  dragged.clear();
  return draggedValue;
}

void showSetting(Ui& ui, SideState& side, const RenderSettings& settings, const Setting& setting) {
  const std::string key(setting.key);
  const auto set = [&](const std::string& value) { assign(side.options.settings, key, value); };
  ImGui::PushID(key.c_str());
  const bool given = std::any_of(side.options.settings.begin(), side.options.settings.end(),
                                 [&](const std::string& a) { return a.starts_with(key + "="); });
  if (given) ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(255, 210, 120, 255));
  bool reset = false;
  switch (setting.value.type) {
    case SettingType::boolean: {
      bool on = settingNumber(setting, settings) != 0.0;
      if (checkbox(ui, key.c_str(), on)) set(on ? "on" : "off");
      break;
    }
    case SettingType::choice: {
      int chosen = static_cast<int>(settingNumber(setting, settings));
      if (menu(ui, key.c_str(), chosen, setting.value.choices))
        set(std::string(setting.value.choices[static_cast<std::size_t>(chosen)]));
      break;
    }
    case SettingType::file: {
      std::string file = printSetting(setting, settings);
      if (textField(ui, key.c_str(), file)) set(file);
      break;
    }
    case SettingType::integer:
    case SettingType::real:
      if (const auto number = numberControl(ui, key, setting, settingNumber(setting, settings)))
        set(textOfNumber(setting, settings, *number));
      break;
  }
  explain(explanation(setting));
  if (given) {
    ImGui::PopStyleColor();
    // Beside the name, or below it where it would not fit the panel.
    const ImGuiStyle& style = ImGui::GetStyle();
    const float end =
        ImGui::GetItemRectMax().x + style.ItemSpacing.x + ImGui::CalcTextSize("reset").x + 2.0f * style.FramePadding.x;
    if (end < ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x) ImGui::SameLine();
    reset = ImGui::SmallButton("reset");
    ui.note(key + " reset");
  }
  if (reset) set("");
  ImGui::PopID();
}

}  // namespace

void showSettings(Ui& ui, WalkState& s) {
  static constexpr std::array<std::string_view, 2> kSides{"A", "B"};
  menu(ui, "of", s.edited, kSides);
  SideState& side = s.sides[static_cast<std::size_t>(s.edited)];
  if (button(ui, "copy as command line"))
    ImGui::SetClipboardText((commandLine("render", s.scene->file.string(), side.options) + " --camera " +
                             cameraText(*s.scene, s.camera->camera()) + " -o picture.exr")
                                .c_str());
  ImGui::SameLine();
  if (button(ui, "all defaults")) side.options.settings.clear(), side.options.deviations.clear();
  if (!side.renderer) {
    line("B is made when it is shown");
    return;
  }
  const RenderSettings& settings = side.renderer->settings();
  ImGui::InputTextWithHint("find", "part of a name", &s.settingsFilter);
  ui.note("find");
  const auto matches = [&](std::string_view key) { return key.find(s.settingsFilter) != std::string_view::npos; };
  for (const Setting& setting : allSettings())
    if (setting.key != "exposure" && isRead(setting, settings) && matches(setting.key))
      showSetting(ui, side, settings, setting);

  ImGui::Separator();
  const std::vector<std::string> active = activeDeviations(settings);
  for (const Deviation& deviation : allDeviations()) {
    const std::string name(deviation.name);
    const std::string& technique = side.built.technique;
    const bool belongs = name.starts_with(technique + ".") || (technique == "lpv" && name.starts_with("rsm."));
    if (!belongs || !matches(name)) continue;
    bool on = std::find(active.begin(), active.end(), name) != active.end();
    if (checkbox(ui, name.c_str(), on)) assign(side.options.deviations, name, on ? "on" : "off");
    explain(std::string(deviation.meaning) + (deviation.inOriginal() ? "\nOn with fidelity original." : ""));
  }
}

}  // namespace lucerna::demo
