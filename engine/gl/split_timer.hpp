// Milliseconds of two parts of a frame, one after the other, without waiting for a GPU: its timestamps are fetched when
// they have arrived, some frames later. On a software renderer, whose timestamps are those of the last tile that it
// draws, by glFinish and the wall clock.
#pragma once

#include "host/api.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <vector>

namespace lucerna::gl {

class SplitTimer {
 public:
  struct Times {
    double first, second;
    int label;  ///< as given to end()
  };

  explicit SplitTimer(bool finishes) : finishes_(finishes) {}
  ~SplitTimer();
  SplitTimer(const SplitTimer&) = delete;
  SplitTimer& operator=(const SplitTimer&) = delete;

  // In this order, in each frame.
  void begin() { mark(0); }
  void split() { mark(1); }
  /// The times that have arrived since the last end(). A frame is not timed while those before it fill the ring.
  std::vector<Times> end(int label);

 private:
  static constexpr std::size_t kRing = 4;
  struct Frame {
    std::array<GLuint, 3> queries{};
    bool isPending = false;
    int label = 0;
  };
  void mark(std::size_t moment);

  bool finishes_;
  std::array<Frame, kRing> ring_{};
  std::size_t next_ = 0;
  std::array<std::chrono::steady_clock::time_point, 3> clock_{};
};

}  // namespace lucerna::gl
