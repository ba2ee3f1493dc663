#include "base/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

double percentile(std::span<const double> sample, double p) {
  if (sample.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sorted(sample.begin(), sample.end());
  std::sort(sorted.begin(), sorted.end());
  const double position = std::clamp(p, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto lower = static_cast<std::size_t>(std::floor(position));
  const std::size_t upper = std::min(lower + 1, sorted.size() - 1);
  const double t = position - static_cast<double>(lower);
  return sorted[lower] * (1.0 - t) + sorted[upper] * t;
}

MedianInterval medianInterval(std::span<const double> sample) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kTail = 0.025;
  std::vector<double> sorted(sample.begin(), sample.end());
  std::sort(sorted.begin(), sorted.end());
  // The median is below the k-th smallest value where fewer than k of n are below the median.
  const std::size_t n = sorted.size();
  double term = std::pow(0.5, static_cast<double>(n)), tail = 0.0;  // of a binomial distribution
  std::size_t k = 0;
  while (k < n / 2 && tail + term <= kTail) {
    tail += term;
    term *= static_cast<double>(n - k) / static_cast<double>(k + 1);
    ++k;
  }
  return k == 0 ? MedianInterval{kNone, kNone} : MedianInterval{sorted[k - 1], sorted[n - k]};
}

}  // namespace lucerna
