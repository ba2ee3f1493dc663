// Summaries of many measurements (no GL): the Pareto front and the slope of a log-log line.
#pragma once

#include <span>
#include <vector>

namespace lucerna::measure {

struct CostAndError {
  double cost = 0.0;  ///< for example ms
  double error = 0.0;  ///< for example NRMSE
  double costStandardError = 0.0, standardError = 0.0;  ///< standard errors; 0: exact
};
/// Minimum distance of two figures, in standard errors of their difference, to count as different: 95 % of a normal
/// distribution.
inline constexpr double kApart = 2.0;
/// Whether a (standard error ea) is below b by more than both spreads explain.
bool isBelow(double a, double ea, double b, double eb);
/// From the cheapest to the most expensive, a point joins the front if its error isBelow() that of all points on it:
/// points that cannot be distinguished count as equal, and the cheapest of them stays. Then points are removed that
/// cost the same as another of the front and have a larger error. Without spreads: no other point is as good in both
/// and better in one; of equal points the first stays. Points that are not finite are never on the front.
std::vector<bool> paretoFront(std::span<const CostAndError> points);

/// Least squares of log y over log x; NaN with fewer than two points of different x. All values above 0.
struct Slope {
  double slope = 0.0;
  double error = 0.0;  ///< standard error of the slope from the residuals; NaN with fewer than three points
};
Slope logLogSlope(std::span<const double> x, std::span<const double> y);

}  // namespace lucerna::measure
