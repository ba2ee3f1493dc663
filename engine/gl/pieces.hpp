// Work cut into pieces, so that no submission holds a GPU up: a driver resets a GPU that does not answer (Windows after 2 s, Linux' i915 after 2.5 s, amdgpu
// after 10 s), and until then nothing else is drawn.
//
// A piece is made of units: hemicubes, rows of pixels, turns of all lanes of a tile. Work is counted in turns, passes through a loop of about the cost of one
// step of a ray through its hierarchy, of all work items together. A GPU at the low end of OpenGL 4.3 takes 0.3 to 0.5 billion of them a second. So:
//   - before anything was measured a piece has kUnmeasuredTurns, some 0.2 s there;
//   - then pieces follow the clock, to at most twice the size of the one before;
//   - whatever was measured they end at four times kUnmeasuredTurns, under a second there: what is measured may be sky, and what comes next is not.
#pragma once

#include <chrono>
#include <cstdint>

namespace lucerna::gl {

constexpr double kUnmeasuredTurns = 0x1p26;
constexpr double kMostOverUnmeasured = 4.0;
constexpr double kTurnsOfRay = 64.0;  ///< of a ray through a hierarchy, about

/// How many units the next piece has. Never none: a unit is what cannot be cut.
class PieceSize {
 public:
  /// seconds: what a piece shall take; turnsOfUnit: about, of all its work items; most: units, whatever the clock says; unmeasured: turns of the first.
  PieceSize(double seconds, double turnsOfUnit, std::uint32_t most, double unmeasured = kUnmeasuredTurns);

  std::uint32_t units() const { return units_; }
  /// Turns, about, of the largest piece so far.
  double largestTurns() const { return largestTurns_; }
  /// What a piece took from its submission to its end.
  void took(std::uint32_t units, double seconds);
  /// Work begins of which nothing is known, another tile or view: as before anything was measured, or smaller where that was too slow.
  void restart();
  /// Units have other turns from now on, since some work items are done.
  void setTurnsOfUnit(double turnsOfUnit);

 private:
  double seconds_, turnsOfUnit_, mostTurns_, largestTurns_ = 0.0;
  std::uint32_t most_, first_, units_ = 1;
};

/// The time of a piece by the wall clock, from when the GPU has nothing else to do to when it is done.
class PieceClock {
 public:
  PieceClock();
  double seconds() const;  ///< waits for the GPU

 private:
  std::chrono::steady_clock::time_point start_;
};

}  // namespace lucerna::gl
