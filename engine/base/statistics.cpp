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

}  // namespace lucerna
