// The panel's settings: every entry of engine/settings that the technique reads, with range, unit, default, reset and
// source.
#pragma once

#include "walk/state.hpp"
#include "walk/ui.hpp"

namespace lucerna::demo {

/// Use between Ui::begin and Ui::end. Changes go into the side's options; the window applies them.
void showSettings(Ui& ui, WalkState& state);

}  // namespace lucerna::demo
