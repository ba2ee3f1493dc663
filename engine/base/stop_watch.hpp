// Lets long work that has no callback of its own end early: hierarchies, rays in batches.
#pragma once

#include <functional>

namespace lucerna {

/// During its lifetime, long work of this thread asks `wantsStop` every tenth of a second or so, and ends by the
/// exception Stopped if the answer is yes. Only the innermost watch is asked.
class StopWatch {
 public:
  explicit StopWatch(std::function<bool()> wantsStop);
  ~StopWatch();
  StopWatch(const StopWatch&) = delete;
  StopWatch& operator=(const StopWatch&) = delete;

  static bool wantsStop();  ///< false without a watch
  /// Throws Stopped("stopped while WHAT; nothing of it is kept") if a stop is wanted.
  static void check(const char* what);

 private:
  std::function<bool()> wantsStop_;
  StopWatch* outer_;
};

}  // namespace lucerna
