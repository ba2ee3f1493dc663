#include "walk/motion_scale.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

float MotionScale::next(bool moves) {
  moves_ = moves;
  shown_ = moves ? inMotion_ : std::max(shown_ - 1, 0);
  return std::exp2(-static_cast<float>(shown_));
}

// A picture of twice the side takes at most four times as long. It is tried where that would be well in time, so that
// the scale does not go back and forth.
void MotionScale::took(double seconds) {
  constexpr double kLong = 0.2, kReserve = 0.7;
  if (!moves_) return;
  if (seconds > kLong)
    for (; inMotion_ < kCoarsest && seconds > kLong; seconds /= 4.0) ++inMotion_;
  else if (inMotion_ > 0 && 4.0 * seconds < kReserve * kLong) --inMotion_;
}

}  // namespace lucerna::demo
