// Divides work into pieces, so that no submission blocks a GPU. A driver resets a GPU that does not respond (Windows
// after 2 s, Linux' i915 after 2.5 s, amdgpu after 10 s), and until then nothing else is drawn.
//
// A piece consists of units: hemicubes, rows of pixels, turns of all lanes of a tile. Work is counted in turns: loop
// iterations of about the cost of one step of a ray through its hierarchy, summed over work items. A GPU at the low end
// of OpenGL 4.3 does 0.3 to 0.5 billion per second. So:
//   - before any measurement a piece has kUnmeasuredTurns, about 0.2 s there;
//   - then the size follows the measured time, growing to at most twice that of the piece before;
//   - pieces never exceed four times kUnmeasuredTurns, under a second there: the measured piece may be sky and the
//   next one not.
#pragma once

#include <chrono>
#include <cstdint>

namespace lucerna::gl {

constexpr double kUnmeasuredTurns = 0x1p26;
constexpr double kMostOverUnmeasured = 4.0;
constexpr double kTurnsOfRay = 64.0;  ///< approximate, for a ray through a hierarchy

/// What lies between two flushes is one submission to a driver, whose watchdog times all of it. Work that is not
/// measured is announced here, and what came before is handed over where both were too much. Of this thread, as
/// contexts are.
class Submission {
 public:
  /// turns: an upper estimate of the work that follows; most: of a submission.
  static void add(double turns, double most = kMostOverUnmeasured * kUnmeasuredTurns);
  static double largest();  ///< turns, since the last forget()
  static void forget();
};

/// Units of the next piece, at least one: a unit cannot be cut.
class PieceSize {
 public:
  /// seconds: target time of a piece; turnsOfUnit: estimate, over all its work items; most: limit of units; unmeasured:
  /// turns of the first piece.
  PieceSize(double seconds, double turnsOfUnit, std::uint32_t most, double unmeasured = kUnmeasuredTurns);

  std::uint32_t units() const { return units_; }
  /// Estimated turns of the largest piece so far.
  double largestTurns() const { return largestTurns_; }
  /// Reports how long a piece took from submission to end.
  void took(std::uint32_t units, double seconds);
  /// Starts unknown work, such as another tile or view: as before any measurement, or smaller if that was too slow.
  void restart();
  /// Changes the turns per unit, when some work items are finished.
  void setTurnsOfUnit(double turnsOfUnit);

 private:
  double seconds_, turnsOfUnit_, mostTurns_, largestTurns_ = 0.0;
  std::uint32_t most_, first_, units_ = 1;
};

/// Wall-clock time of a piece, from when the GPU is idle to when it is done.
class PieceClock {
 public:
  PieceClock();
  double seconds() const;  ///< waits for the GPU

 private:
  std::chrono::steady_clock::time_point start_;
};

}  // namespace lucerna::gl
