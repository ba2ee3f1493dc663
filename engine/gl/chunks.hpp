// Divides work into chunks, so that no submission blocks a GPU. A driver resets a GPU that does not respond (Windows
// after 2 s, Linux' i915 after 2.5 s, amdgpu after 10 s), and until then nothing else is drawn.
//
// A chunk consists of units: hemicubes, rows of pixels, iterations of all lanes of a tile. Work is counted in
// iterations: loop iterations of about the cost of one step of a ray through its hierarchy, summed over work items. A
// GPU at the low end of OpenGL 4.3 does 0.3 to 0.5 billion per second. So:
//   - before any measurement a chunk has kUnmeasuredIterations, about 0.2 s there;
//   - then the size follows the measured time, growing to at most twice that of the chunk before;
//   - chunks never exceed four times kUnmeasuredIterations, under a second there: the measured chunk may be sky and the
//   next one not.
#pragma once

#include <chrono>
#include <cstdint>

namespace lucerna::gl {

constexpr double kUnmeasuredIterations = 0x1p26;
constexpr double kMostOverUnmeasured = 4.0;
constexpr double kIterationsOfRay = 64.0;  ///< approximate, for a ray through a hierarchy

/// What lies between two flushes is one submission to a driver, whose watchdog times all of it. Work that is not
/// measured is announced here, and what came before is handed over where both were too much. Of this thread, as
/// contexts are.
class Submission {
 public:
  /// iterations: an upper estimate of the work that follows; most: of a submission.
  static void add(double iterations, double most = kMostOverUnmeasured * kUnmeasuredIterations);
  static double largest();  ///< iterations, since the last forget()
  static void forget();
};

/// Units of the next chunk, at least one: a unit cannot be cut.
class ChunkSize {
 public:
  /// seconds: target time of a chunk; iterationsOfUnit: estimate, over all its work items; most: limit of units;
  /// unmeasured: iterations of the first chunk.
  ChunkSize(double seconds, double iterationsOfUnit, std::uint32_t most, double unmeasured = kUnmeasuredIterations);

  std::uint32_t units() const { return units_; }
  /// Estimated iterations of the largest chunk so far.
  double largestIterations() const { return largestIterations_; }
  /// Reports how long a chunk took from submission to end.
  void took(std::uint32_t units, double seconds);
  /// Starts unknown work, such as another tile or view: as before any measurement, or smaller if that was too slow.
  void restart();
  /// Changes the iterations per unit, when some work items are finished.
  void setIterationsOfUnit(double iterationsOfUnit);

 private:
  double seconds_, iterationsOfUnit_, mostIterations_, largestIterations_ = 0.0;
  std::uint32_t most_, first_, units_ = 1;
};

/// Wall-clock time of a chunk, from when the GPU is idle to when it is done.
class ChunkClock {
 public:
  ChunkClock();
  double seconds() const;  ///< waits for the GPU

 private:
  std::chrono::steady_clock::time_point start_;
};

}  // namespace lucerna::gl
