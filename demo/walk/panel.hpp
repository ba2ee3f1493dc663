// The panel: sections of controls for WalkState, rebuilt each frame.
#pragma once

#include "walk/state.hpp"
#include "walk/ui.hpp"

namespace lucerna::demo {

class Panel {
 public:
  /// Between Ui::begin and Ui::end.
  static void show(Ui& ui, WalkState& state, Host& host);
  /// Its width in pixels, at the right edge.
  static int widthOf(float scale);
  /// F1.
  static void showHelp(Ui& ui, WalkState& state);
  /// Whether to quit.
  static void showQuestion(Ui& ui, WalkState& state);
  /// One line at the bottom: the current work, or the last message.
  static void showMessage(const WalkState& state, const std::string& work, double share);
  /// Values under the magnifier, next to the cursor.
  static void showValues(const WalkState& state);
};

}  // namespace lucerna::demo
