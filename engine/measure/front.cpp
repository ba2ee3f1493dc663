#include "measure/front.hpp"

#include "base/error.hpp"

#include <cmath>
#include <limits>

namespace lucerna::measure {

std::vector<bool> paretoFront(std::span<const CostAndError> points) {
  std::vector<bool> front(points.size(), false);
  const auto valid = [](const CostAndError& p) { return std::isfinite(p.cost) && std::isfinite(p.error); };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CostAndError& p = points[i];
    if (!valid(p)) continue;
    bool beaten = false;
    for (std::size_t j = 0; j < points.size() && !beaten; ++j) {
      const CostAndError& q = points[j];
      if (j == i || !valid(q) || q.cost > p.cost || q.error > p.error) continue;
      beaten = q.cost < p.cost || q.error < p.error || j < i;
    }
    front[i] = !beaten;
  }
  return front;
}

Slope logLogSlope(std::span<const double> x, std::span<const double> y) {
  CHECK(x.size() == y.size(), "{} and {} values", x.size(), y.size());
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const double n = static_cast<double>(x.size());
  double meanX = 0.0, meanY = 0.0, xx = 0.0, xy = 0.0, residuals = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) meanX += std::log(x[i]) / n, meanY += std::log(y[i]) / n;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - meanX;
    xx += dx * dx;
    xy += dx * (std::log(y[i]) - meanY);
  }
  if (x.size() < 2 || !(xx > 0.0)) return {kNan, kNan};
  const double slope = xy / xx;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = std::log(y[i]) - meanY - slope * (std::log(x[i]) - meanX);
    residuals += r * r;
  }
  return {slope, x.size() < 3 ? kNan : std::sqrt(residuals / (n - 2.0) / xx)};
}

}  // namespace lucerna::measure
