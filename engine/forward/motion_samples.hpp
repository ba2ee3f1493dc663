// How many of a pixel's samples each frame draws while the view or the scene moves: as many as cost little beside what
// the frame has to do once (shadow maps, the light of new surfaces), or as a fast GPU has time for (no GL).
#pragma once

#include <vector>

namespace lucerna {

/// The number, from the times of the frames that had it: 1, 2, 4 and so on. All samples after the first take at most
/// half of its time, or what is left of a 60th of a second.
class MotionSamples {
 public:
  int now() const { return count_; }
  /// Milliseconds of a frame up to its first sample's end, and of all others. `most`: samples of a picture.
  void add(double first, double others, int most);

 private:
  int count_ = 2;  // one would not tell what another one costs
  std::vector<double> first_, others_;  ///< of the last frames of this number
  double further_ = 0.0;  ///< of one sample after the first, when there was one
  int frames_ = 0;  ///< with one sample
};

}  // namespace lucerna
