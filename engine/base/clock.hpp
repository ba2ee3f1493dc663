// Wall-clock time measurement.
#pragma once

#include <chrono>

namespace lucerna {

using Clock = std::chrono::steady_clock;
inline double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace lucerna
