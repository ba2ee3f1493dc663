// The panel: sections of controls over WalkState, made anew each frame.
#pragma once

#include "walk/state.hpp"
#include "walk/ui.hpp"

namespace lucerna::demo {

class Panel {
 public:
  /// Between Ui::begin and Ui::end.
  static void show(Ui& ui, WalkState& state, Host& host);
  /// Pixels that it takes at the right edge.
  static int widthOf(float scale);
  /// F1.
  static void showHelp(Ui& ui, WalkState& state);
  /// One line at the bottom: what is going on, or the last message.
  static void showMessage(const WalkState& state, const std::string& work, double share);
  /// Beside the cursor: values under the magnifier.
  static void showValues(const WalkState& state);
};

}  // namespace lucerna::demo
