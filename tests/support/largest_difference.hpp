#pragma once

#include "base/image.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::test {

/// Of a channel of a pixel; pictures of one size.
inline double largestDifference(const Image& a, const Image& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      largest = std::max(largest, static_cast<double>(std::abs(a.pixels[i][c] - b.pixels[i][c])));
  return largest;
}

}  // namespace lucerna::test
