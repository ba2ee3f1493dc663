#include "gl/chunks.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "gl/wait.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::gl {

namespace {

std::uint32_t unitsOf(double iterations, double iterationsOfUnit, std::uint32_t most) {
  return static_cast<std::uint32_t>(
      std::clamp(std::floor(iterations / iterationsOfUnit), 1.0, static_cast<double>(most)));
}

thread_local double iterationsSinceFlush = 0.0, largestSubmission = 0.0;

}  // namespace

void Submission::add(double iterations, double most) {
  if (iterationsSinceFlush > 0.0 && iterationsSinceFlush + iterations > most) {
    glFlush();
    iterationsSinceFlush = 0.0;
  }
  iterationsSinceFlush += iterations;
  largestSubmission = std::max(largestSubmission, iterationsSinceFlush);
}

double Submission::largest() { return largestSubmission; }

void Submission::forget() { iterationsSinceFlush = largestSubmission = 0.0; }

ChunkSize::ChunkSize(double seconds, double iterationsOfUnit, std::uint32_t most, double unmeasured)
    : seconds_(seconds),
      iterationsOfUnit_(iterationsOfUnit),
      mostIterations_(kMostOverUnmeasured * unmeasured),
      most_(most) {
  CHECK(seconds > 0.0 && iterationsOfUnit > 0.0 && most > 0, "{} s, {} iterations, {} units", seconds, iterationsOfUnit,
        most);
  units_ = first_ = unitsOf(unmeasured, iterationsOfUnit, most);
}

void ChunkSize::took(std::uint32_t units, double seconds) {
  largestIterations_ = std::max(largestIterations_, units * iterationsOfUnit_);
  const double factor = std::clamp(seconds_ / std::max(seconds, 1e-9), 0.25, 2.0);
  const double most = unitsOf(mostIterations_, iterationsOfUnit_, most_);
  double next = std::floor(factor * units);
  if (factor >= 1.0) next = std::max(next, static_cast<double>(units_));  // after a last, smaller chunk
  units_ = static_cast<std::uint32_t>(std::clamp(next, 1.0, most));
}

void ChunkSize::restart() { units_ = std::min(units_, first_); }

void ChunkSize::setIterationsOfUnit(double iterationsOfUnit) { iterationsOfUnit_ = iterationsOfUnit; }

ChunkClock::ChunkClock() {
  finish();
  start_ = Clock::now();
}

double ChunkClock::seconds() const {
  finish();
  return secondsSince(start_);
}

}  // namespace lucerna::gl
