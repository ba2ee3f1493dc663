// Lets long work that has no callback of its own end early: hierarchies, rays in batches.
#pragma once

#include <cstddef>
#include <functional>

namespace lucerna {

/// What long work is at, in words that follow "stopped while", and the share that is done; negative: unknown.
struct LongWork {
  const char* what = "";
  double share = -1.0;
};

/// During its lifetime, long work of this thread asks `wantsStop` every tenth of a second or so, and ends by the
/// exception Stopped if the answer is yes. Only the innermost watch is asked.
class StopWatch {
 public:
  explicit StopWatch(std::function<bool(const LongWork&)> wantsStop);
  ~StopWatch();
  StopWatch(const StopWatch&) = delete;
  StopWatch& operator=(const StopWatch&) = delete;

  static bool wantsStop(const LongWork& work);  ///< false without a watch
  /// Throws Stopped("stopped while WHAT; nothing of it is kept") if a stop is wanted.
  static void check(const char* what, std::size_t done, std::size_t total);

 private:
  std::function<bool(const LongWork&)> wantsStop_;
  StopWatch* outer_;
};

}  // namespace lucerna
