// Work beside frames, within a share of their time: what a chunk takes more than it may is paid back by later frames.
#pragma once

#include <algorithm>

namespace lucerna {

class TimeShare {
 public:
  /// A frame has ended. seconds: that it took, the work in it included. The work may take `share` times the rest: with
  /// 0.1, frames become 10 % longer. most: seconds that are saved up at most, such as for a chunk that takes longer; so
  /// that a frame that took long for a reason of its own is not followed by another.
  void frame(double seconds, double share, double most) {
    const double rest = std::max(seconds - inFrame_, 0.0);
    inFrame_ = 0.0;
    rest_ += rest;
    left_ = std::min(left_ + share * rest, most);
  }
  /// Seconds of work that may be done now; negative: too much was done.
  double left() const { return left_; }
  /// Work that was done in this frame.
  void spend(double seconds) {
    left_ -= seconds;
    spent_ += seconds;
    longest_ = std::max(longest_, seconds);
    inFrame_ += seconds;
  }
  /// Work that was done while the frame had nothing else to do: it counts as neither.
  void idle(double seconds) { inFrame_ += seconds; }

  double spent() const { return spent_; }  ///< seconds of work, in all frames
  double longest() const { return longest_; }  ///< seconds that were spent at once
  double rest() const { return rest_; }  ///< seconds of all frames without it

 private:
  double left_ = 0.0, inFrame_ = 0.0, spent_ = 0.0, longest_ = 0.0, rest_ = 0.0;
};

}  // namespace lucerna
