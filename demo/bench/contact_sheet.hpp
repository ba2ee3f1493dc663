// Pictures side by side with a line of text over each (no GL), in a 5x7 bitmap font of our own.
#pragma once

#include "base/image.hpp"

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace lucerna::demo::bench {

struct Tile {
  std::string label;  ///< letters become capitals; wrapped where it is too long
  Bitmap picture;  ///< all of one size
};

/// `columns` tiles a row, under a title.
Bitmap contactSheet(const std::string& title, const std::vector<Tile>& tiles, int columns);

/// A line of a bar chart: parts that are drawn one after the other, in colours of their own.
struct Bar {
  std::string label;
  std::vector<double> parts;  ///< 0 or more each
};

/// Bars from the left, each with its sum behind it, all to one scale. `parts`: their names, above the bars.
Bitmap barChart(glm::ivec2 size, const std::vector<std::string>& parts, const std::vector<Bar>& bars,
                const std::string& unit);

}  // namespace lucerna::demo::bench
