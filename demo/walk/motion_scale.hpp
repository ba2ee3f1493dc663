// How coarse the picture is computed while something moves, so that slow renderers still answer the mouse.
#pragma once

namespace lucerna::demo {

class MotionScale {
 public:
  /// coarse: the first frames too are drawn as if whole ones took long.
  explicit MotionScale(bool coarse) : inMotion_(coarse ? kCoarsest : 0), shown_(inMotion_) {}

  /// Side of the next frame's picture over that of the whole one: 1, 1/2 or 1/4. At rest it becomes whole in steps.
  float next(bool moves);
  /// The frame of next() took so many seconds. Those of motion set the scale: the finest that makes five a second.
  void took(double seconds);
  /// The next frame is whole, without next().
  void showWhole() { shown_ = 0; }

 private:
  static constexpr int kCoarsest = 2;
  int inMotion_, shown_;  ///< how often the side is halved
  bool moves_ = true;
};

}  // namespace lucerna::demo
