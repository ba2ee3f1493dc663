#include "gl/pieces.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "gl/wait.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::gl {

namespace {

std::uint32_t unitsOf(double turns, double turnsOfUnit, std::uint32_t most) {
  return static_cast<std::uint32_t>(std::clamp(std::floor(turns / turnsOfUnit), 1.0, static_cast<double>(most)));
}

thread_local double turnsSinceFlush = 0.0, largestSubmission = 0.0;

}  // namespace

void Submission::add(double turns, double most) {
  if (turnsSinceFlush > 0.0 && turnsSinceFlush + turns > most) {
    glFlush();
    turnsSinceFlush = 0.0;
  }
  turnsSinceFlush += turns;
  largestSubmission = std::max(largestSubmission, turnsSinceFlush);
}

double Submission::largest() { return largestSubmission; }

void Submission::forget() { turnsSinceFlush = largestSubmission = 0.0; }

PieceSize::PieceSize(double seconds, double turnsOfUnit, std::uint32_t most, double unmeasured)
    : seconds_(seconds), turnsOfUnit_(turnsOfUnit), mostTurns_(kMostOverUnmeasured * unmeasured), most_(most) {
  CHECK(seconds > 0.0 && turnsOfUnit > 0.0 && most > 0, "{} s, {} turns, {} units", seconds, turnsOfUnit, most);
  units_ = first_ = unitsOf(unmeasured, turnsOfUnit, most);
}

void PieceSize::took(std::uint32_t units, double seconds) {
  largestTurns_ = std::max(largestTurns_, units * turnsOfUnit_);
  const double factor = std::clamp(seconds_ / std::max(seconds, 1e-9), 0.25, 2.0);
  const double most = unitsOf(mostTurns_, turnsOfUnit_, most_);
  double next = std::floor(factor * units);
  if (factor >= 1.0) next = std::max(next, static_cast<double>(units_));  // after a last, smaller piece
  units_ = static_cast<std::uint32_t>(std::clamp(next, 1.0, most));
}

void PieceSize::restart() { units_ = std::min(units_, first_); }

void PieceSize::setTurnsOfUnit(double turnsOfUnit) { turnsOfUnit_ = turnsOfUnit; }

PieceClock::PieceClock() {
  finish();
  start_ = Clock::now();
}

double PieceClock::seconds() const {
  finish();
  return secondsSince(start_);
}

}  // namespace lucerna::gl
