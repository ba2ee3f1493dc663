#include "forward/motion_samples.hpp"

#include "base/statistics.hpp"

#include <algorithm>

namespace lucerna {

void MotionSamples::add(double first, double others, int most) {
  constexpr double kShareOfFirst = 0.5, kFrame = 1000.0 / 60.0;
  constexpr double kTolerance = 1.15;  // a number stays while times vary
  constexpr std::size_t kFewest = 3, kMost = 9;  // frames whose median is taken
  constexpr int kFramesBetweenLooks = 64;  // with one sample, until it is seen again what another one costs
  first_.push_back(first);
  others_.push_back(others);
  if (first_.size() > kMost) {
    first_.erase(first_.begin());
    others_.erase(others_.begin());
  }
  if (first_.size() < kFewest) return;
  const double once = median(first_), budget = std::max(kShareOfFirst * once, kFrame - once);
  if (count_ > 1) further_ = median(others_) / (count_ - 1);
  int next = std::min(count_, most);
  if (count_ == 1 && ++frames_ % kFramesBetweenLooks == 0) next = std::min(2, most);
  else if (further_ * (count_ - 1) > kTolerance * budget) next = count_ / 2;
  else if (2 * count_ <= most && further_ * (2 * count_ - 1) <= budget) next = 2 * count_;
  if (next == count_) return;
  count_ = next;
  first_.clear();
  others_.clear();
}

}  // namespace lucerna
