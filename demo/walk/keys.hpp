// The window's keys: one table for the window itself, F1 and `walk --help`.
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
  hold,
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
  cache,
  radiosity,
  path,
  undo,
  redo,
  flicker,
  wipe,
  sideBySide,
  reprojection,
  magnifier,
  nextView,
  liveReference,
  inspect,
  fit,
  orbit,
};

struct KeyBinding {
  int key;
  bool control;
  Action action;
  const char* meaning;
};

std::span<const KeyBinding> allKeys();
/// The action of a pressed key; none if it is not bound.
std::optional<Action> actionOf(const KeyEvent& event);
/// One line per key, and the mouse.
std::string keysHelp();
/// "F1", "control Z".
std::string nameOf(const KeyBinding& binding);

}  // namespace lucerna::demo
