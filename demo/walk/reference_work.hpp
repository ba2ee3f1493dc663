// The live reference beside the frames: within a share of their time while pictures change, in all idle time once they
// rest. It is made for the shown view, refined, and pictures are judged against it.
#pragma once

#include "base/time_share.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "walk/state.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace lucerna::demo {

class ReferenceWork {
 public:
  struct Frame {
    bool isStill;  ///< nothing has moved for some frames
    bool isSettled;  ///< all pictures are finished
    double now;  ///< seconds, for the time between judgements
    std::function<void(const std::string&)> note;  ///< called during long work; may throw Stopped
  };
  ReferenceWork(const gl::Context& context, gl::ProgramLibrary& programs, WalkState& state)
      : context_(context), programs_(programs), state_(state) {}

  /// frameSeconds: that the last frame took, this work included.
  void doShare(double frameSeconds, const Frame& frame);
  const TimeShare& time() const { return time_; }

 private:
  bool seek(const Frame& frame);
  void judge(const Frame& frame);

  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  WalkState& state_;
  std::optional<Camera> camera_;  ///< of the reference
  std::uint64_t version_ = 0;  ///< of the reference's scene
  TimeShare time_;
  double judged_ = 0.0;
};

}  // namespace lucerna::demo
