// Cuts work on a picture's pixels that nobody measures into submissions, within the bounds of gl/chunks.hpp: all of it
// at once where that is safe, else chunks of unmeasured work. They do not wait for each other, but submissions end
// where they would take too long.
#pragma once

#include "gl/chunks.hpp"

#include <glm/glm.hpp>

#include <algorithm>

namespace lucerna::gl {

class PictureChunks {
 public:
  /// unmeasured: iterations of a chunk where the whole is cut.
  explicit PictureChunks(double unmeasured = kUnmeasuredIterations) : unmeasured_(unmeasured) {}

  /// draw(corner, size) for rectangles that make up the picture; their corners are multiples of `unit` pixels, the side
  /// of a work group. iterationsOfPixel: an upper estimate.
  template <class Draw>
  void forEach(const glm::ivec2& picture, double iterationsOfPixel, int unit, const Draw& draw) {
    const glm::ivec2 most = sizeOfChunk(picture, iterationsOfPixel, unit);
    for (int y = 0; y < picture.y; y += most.y)
      for (int x = 0; x < picture.x; x += most.x) {
        const glm::ivec2 corner(x, y), size = glm::min(most, picture - corner);
        Submission::add(iterationsOfPixel * size.x * size.y, kMostOverUnmeasured * unmeasured_);
        draw(corner, size);
        largestIterations_ = std::max(largestIterations_, iterationsOfPixel * size.x * size.y);
      }
  }
  /// Whole rows, or a part of `unit` rows where those are too much.
  glm::ivec2 sizeOfChunk(const glm::ivec2& picture, double iterationsOfPixel, int unit) const {
    const double pixels = unmeasured_ / iterationsOfPixel, width = picture.x;
    if (width * picture.y <= kMostOverUnmeasured * pixels) return picture;
    const auto units = [&](double length) { return unit * std::max(1, static_cast<int>(length / unit)); };
    return unit * width <= pixels ? glm::ivec2(picture.x, units(pixels / width))
                                  : glm::ivec2(units(pixels / unit), unit);
  }
  double largestIterations() const { return largestIterations_; }  ///< estimated, of the largest chunk so far

 private:
  double unmeasured_, largestIterations_ = 0.0;
};

}  // namespace lucerna::gl
