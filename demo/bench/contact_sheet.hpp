// Pictures side by side with a line of text over each (no GL), in a 5x7 bitmap font of our own.
#pragma once

#include "base/image.hpp"

#include <string>
#include <vector>

namespace lucerna::demo::bench {

struct Tile {
  std::string label;  ///< letters become capitals; wrapped where it is too long
  Bitmap picture;  ///< all of one size
};

/// `columns` tiles a row, under a title.
Bitmap contactSheet(const std::string& title, const std::vector<Tile>& tiles, int columns);

}  // namespace lucerna::demo::bench
