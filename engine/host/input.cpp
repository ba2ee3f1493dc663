#include "host/input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace lucerna {

namespace {

constexpr std::pair<int, const char*> kNames[] = {{' ', "space"},
                                                  {key::kEscape, "escape"},
                                                  {key::kEnter, "enter"},
                                                  {key::kTab, "tab"},
                                                  {key::kBackspace, "backspace"},
                                                  {key::kInsert, "insert"},
                                                  {key::kDelete, "delete"},
                                                  {key::kRight, "right"},
                                                  {key::kLeft, "left"},
                                                  {key::kDown, "down"},
                                                  {key::kUp, "up"},
                                                  {key::kPageUp, "page up"},
                                                  {key::kPageDown, "page down"},
                                                  {key::kHome, "home"},
                                                  {key::kEnd, "end"},
                                                  {key::kLeftShift, "shift"},
                                                  {key::kLeftControl, "control"},
                                                  {key::kLeftAlt, "alt"}};

}  // namespace

std::string key::nameOf(int key) {
  for (const auto& [code, name] : kNames)
    if (code == key) return name;
  if (key >= kF1 && key <= kF12) return fmt::format("F{}", key - kF1 + 1);
  if (key > ' ' && key < 127) return std::string(1, static_cast<char>(key));
  return {};
}

int key::named(std::string_view name) {
  const auto same = [&](const std::string& other) {
    return std::equal(name.begin(), name.end(), other.begin(), other.end(), [](char a, char b) {
      return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    });
  };
  for (int key = 0; key < kCount; ++key)
    if (const std::string known = nameOf(key); !known.empty() && same(known) && !(key >= 'a' && key <= 'z')) return key;
  return -1;
}

HostInput& InputState::open(bool anew) {
  if (steps_.empty() || anew) {
    steps_.emplace_back();
    noteHeld(steps_.back().input);
  }
  return steps_.back().input;
}

void InputState::noteHeld(HostInput& input) const {
  const auto one = [&](int key) { return held(key) ? 1.0 : 0.0; };
  input.cursor = cursor_;
  input.buttons = buttons_;
  input.focused = focused_;
  input.move = {one('D') - one('A'), one('E') - one('Q'), one('W') - one('S')};
  input.fast = held(key::kLeftShift) || held(key::kRightShift);
}

void InputState::key(int key, bool down) {
  if (key < 0 || key >= key::kCount || held(key) == down) return;
  const bool isModifier = key >= key::kLeftShift;
  const bool changedBefore =
      !steps_.empty() && std::ranges::any_of(steps_.back().input.keys, [&](const KeyEvent& e) { return e.key == key; });
  HostInput& input =
      open(changedBefore || (!steps_.empty() && (steps_.back().clicked || !steps_.back().input.text.empty())));
  keys_[static_cast<std::size_t>(key)] = down;
  noteHeld(input);
  KeyEvent event{key, down, false, false, false};
  event.control = held(key::kLeftControl) || held(key::kRightControl);
  event.shift = held(key::kLeftShift) || held(key::kRightShift);
  event.alt = held(key::kLeftAlt) || held(key::kRightAlt);
  input.keys.push_back(event);
  if (!down) return;
  const bool hasCharacter = key >= ' ' && key < 127;
  if (!hasCharacter && !isModifier) steps_.back().edited = true;
  if (key == key::kEscape) input.pressed += '\x1b';
  else if (hasCharacter) input.pressed += static_cast<char>(key);
}

void InputState::text(std::string_view utf8) {
  open(!steps_.empty() && (steps_.back().clicked || steps_.back().edited)).text += utf8;
}

void InputState::cursor(const glm::dvec2& position) {
  HostInput& input = open(!steps_.empty() && (steps_.back().clicked || steps_.back().input.wheel != glm::dvec2(0.0)));
  cursor_ = position;
  input.cursor = position;
}

void InputState::button(MouseButton button, bool down) {
  bool& held = buttons_[static_cast<std::size_t>(button)];
  if (held == down) return;
  const bool dragging = buttons_ != std::array<bool, 3>{};
  open(!steps_.empty() && (dragging || steps_.back().clicked || !steps_.back().input.keys.empty()));
  held = down;
  noteHeld(steps_.back().input);
  steps_.back().clicked = true;
}

void InputState::focus(bool focused) {
  focused_ = focused;
  open().focused = focused;
  if (focused) return;
  for (int key = 0; key < key::kCount; ++key)
    if (held(key)) this->key(key, false);
  for (const MouseButton each : {MouseButton::left, MouseButton::right, MouseButton::middle}) button(each, false);
}

HostInput InputState::take() {
  HostInput input;
  if (steps_.empty()) {
    noteHeld(input);
  } else {
    input = std::move(steps_.front().input);
    steps_.pop_front();
  }
  const bool dragging = input.holdsAnyButton();
  if (dragging && dragged_) input.mouseDelta = input.cursor - lastCursor_;
  dragged_ = dragging;
  lastCursor_ = input.cursor;
  return input;
}

bool InputState::takeEscape() {
  for (Step& step : steps_) {
    if (step.input.pressed.find('\x1b') == std::string::npos) continue;
    std::erase(step.input.pressed, '\x1b');
    std::erase_if(step.input.keys, [](const KeyEvent& event) { return event.key == key::kEscape && event.down; });
    return true;
  }
  return false;
}

bool InputState::closes() const {
  return std::ranges::any_of(steps_, [](const Step& step) { return step.input.closeRequested; });
}

}  // namespace lucerna
