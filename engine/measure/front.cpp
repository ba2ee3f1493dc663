#include "measure/front.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna::measure {

bool isBelow(double a, double ea, double b, double eb) { return a < b && b - a > kApart * std::hypot(ea, eb); }

std::vector<bool> paretoFront(std::span<const CostAndError> points) {
  std::vector<bool> front(points.size(), false);
  const auto valid = [](const CostAndError& p) { return std::isfinite(p.cost) && std::isfinite(p.error); };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (valid(points[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return points[i].cost != points[j].cost ? points[i].cost < points[j].cost : points[i].error < points[j].error;
  });
  const auto errsLess = [&](std::size_t i, std::size_t j) {
    return isBelow(points[i].error, points[i].standardError, points[j].error, points[j].standardError);
  };
  const auto costsLess = [&](std::size_t i, std::size_t j) {
    return isBelow(points[i].cost, points[i].costStandardError, points[j].cost, points[j].costStandardError);
  };
  std::vector<std::size_t> kept;
  for (const std::size_t i : order)
    if (std::all_of(kept.begin(), kept.end(), [&](std::size_t j) { return errsLess(i, j); })) kept.push_back(i);
  for (const std::size_t i : kept)
    front[i] =
        std::none_of(kept.begin(), kept.end(), [&](std::size_t j) { return errsLess(j, i) && !costsLess(i, j); });
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
