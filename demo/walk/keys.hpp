// The window's keys: one table, which the window obeys and from which F1 and `walk --help` are made.
#pragma once

#include "host/input.hpp"

#include <optional>
#include <span>
#include <string>

namespace lucerna::demo {

enum class Action {
  help,
  panel,
  reload,
  fullScreen,
  shot,
  capture,
  video,
  end,
  pause,
  follow,
  slower,
  faster,
  loop,
  addKeyFrame,
  darker,
  brighter,
  autoExposure,
  direct,
  rsm,
  lpv,
  radiosity,
  path,
  undo,
  flicker,
  wipe,
  sideBySide,
  magnifier,
  nextView,
  truth,
  ask,
  fit,
};

struct KeyBinding {
  int key;
  bool control;
  Action action;
  const char* meaning;
};

std::span<const KeyBinding> allKeys();
/// What a key that went down means; nothing where none is bound.
std::optional<Action> actionOf(const KeyEvent& event);
/// A line a key, and what the mouse does.
std::string keysHelp();
/// "F1", "control Z".
std::string nameOf(const KeyBinding& binding);

}  // namespace lucerna::demo
