// Pictures side by side with a line of text above each (no GL), in our own 5x7 bitmap font.
#pragma once

#include "base/image.hpp"

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace lucerna::demo::bench {

struct Tile {
  std::string label;  ///< shown in capitals; wrapped if too long
  Bitmap picture;  ///< all of the same size
};

/// `columns` tiles per row, under a title.
Bitmap contactSheet(const std::string& title, const std::vector<Tile>& tiles, int columns);

/// A line of a bar chart: parts drawn one after the other in different colours.
struct Bar {
  std::string label;
  std::vector<double> parts;  ///< each at least 0
};

/// Bars from the left, each followed by its sum, all to the same scale. `parts`: their names, shown above the bars.
Bitmap barChart(glm::ivec2 size, const std::vector<std::string>& parts, const std::vector<Bar>& bars,
                const std::string& unit);

}  // namespace lucerna::demo::bench
