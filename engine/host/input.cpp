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

void InputState::key(int key, bool down, bool repeat) {
  if (key < 0 || key >= key::kCount) return;
  keys_[static_cast<std::size_t>(key)] = down;
  KeyEvent event{key, down, repeat, false, false, false};
  event.control = held(key::kLeftControl) || held(key::kRightControl);
  event.shift = held(key::kLeftShift) || held(key::kRightShift);
  event.alt = held(key::kLeftAlt) || held(key::kRightAlt);
  next_.keys.push_back(event);
  if (!down || repeat) return;
  if (key == key::kEscape) next_.pressed += '\x1b';
  else if (key >= ' ' && key < 127) next_.pressed += static_cast<char>(key);
}

void InputState::button(MouseButton button, bool down) {
  buttons_[static_cast<std::size_t>(button)] = down;
  if (down) next_.buttons[static_cast<std::size_t>(button)] = true;
}

void InputState::focus(bool focused) {
  next_.focused = focused;
  if (focused) return;
  for (int key = 0; key < key::kCount; ++key)
    if (held(key)) this->key(key, false);
  buttons_ = {};
}

HostInput InputState::take() {
  HostInput input = std::exchange(next_, {});
  next_.focused = input.focused;
  for (std::size_t i = 0; i < buttons_.size(); ++i) input.buttons[i] = input.buttons[i] || buttons_[i];
  input.cursor = cursor_;
  const bool dragging = input.buttons[static_cast<std::size_t>(MouseButton::left)];
  if (dragging && dragged_) input.mouseDelta = cursor_ - lastCursor_;
  dragged_ = dragging;
  lastCursor_ = cursor_;
  const auto one = [&](int key) { return held(key) ? 1.0 : 0.0; };
  input.move = {one('D') - one('A'), one('E') - one('Q'), one('W') - one('S')};
  input.fast = held(key::kLeftShift) || held(key::kRightShift);
  return input;
}

}  // namespace lucerna
