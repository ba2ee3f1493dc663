// The panel's settings: every entry of engine/settings that the technique reads, with range, unit, default, reset and
// source.
#pragma once

#include "walk/state.hpp"
#include "walk/ui.hpp"

namespace lucerna::demo {

/// Between Ui::begin and Ui::end. What is changed is put into the side's options; the window makes it so.
void showSettings(Ui& ui, WalkState& state);

}  // namespace lucerna::demo
