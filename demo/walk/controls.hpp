// Dear ImGui's controls, each registered by name (Ui::note); the building blocks of the panel's sections. Use between
// Ui::begin and Ui::end.
#pragma once

#include "walk/ui.hpp"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <string>

namespace lucerna::demo {

inline bool button(Ui& ui, const char* label) {
  const bool pressed = ImGui::Button(label);
  ui.note(label);
  return pressed;
}

inline bool checkbox(Ui& ui, const char* label, bool& value) {
  const bool changed = ImGui::Checkbox(label, &value);
  ui.note(label);
  return changed;
}

inline bool slider(Ui& ui, const char* label, float& value, float least, float most, const char* format,
                   bool logarithmic = false) {
  const bool changed =
      ImGui::SliderFloat(label, &value, least, most, format, logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
  ui.note(label);
  return changed;
}

/// A menu; its items are registered as "label: item". Returns the index of the chosen one.
template <class Names>
bool menu(Ui& ui, const char* label, int& chosen, const Names& names) {
  bool changed = false;
  const bool isOpen = ImGui::BeginCombo(label, std::string(names[static_cast<std::size_t>(chosen)]).c_str());
  if (!isOpen) {
    ui.note(label);
    return false;
  }
  if (ui.escapes()) ImGui::CloseCurrentPopup();
  for (int i = 0; i < static_cast<int>(std::size(names)); ++i) {
    const std::string name(names[static_cast<std::size_t>(i)]);
    if (ImGui::Selectable(name.c_str(), i == chosen)) {
      changed = i != chosen;
      chosen = i;
    }
    ui.note(std::string(label) + ": " + name);
  }
  ImGui::EndCombo();
  return changed;
}

template <class Names>
bool menu(Ui& ui, const char* label, std::string& chosen, const Names& names) {
  int index = 0;
  for (int i = 0; i < static_cast<int>(std::size(names)); ++i)
    if (chosen == names[static_cast<std::size_t>(i)]) index = i;
  const bool changed = menu(ui, label, index, names);
  if (changed) chosen = names[static_cast<std::size_t>(index)];
  return changed;
}

inline bool textField(Ui& ui, const char* label, std::string& text) {
  const bool entered = ImGui::InputText(label, &text, ImGuiInputTextFlags_EnterReturnsTrue);
  ui.note(label);
  return entered;
}

inline void explain(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(30.0f * ImGui::GetFontSize());
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

inline void line(const std::string& text) { ImGui::TextUnformatted(text.c_str()); }
inline void wrapped(const std::string& text) {
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
}

}  // namespace lucerna::demo
