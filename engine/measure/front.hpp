// Summaries of many measurements (no GL): the Pareto front and the slope of a log-log line.
#pragma once

#include <span>
#include <vector>

namespace lucerna::measure {

struct CostAndError {
  double cost = 0.0;  ///< such as ms
  double error = 0.0;  ///< such as NRMSE
  double costSpread = 0.0, errorSpread = 0.0;  ///< standard errors; 0: exact
};
/// How many standard errors of a difference two figures must be apart to count as different: 95 % of a normal one.
inline constexpr double kApart = 2.0;
/// Whether a (standard error ea) is below b by more than both spreads explain.
bool isBelow(double a, double ea, double b, double eb);
/// From the cheapest to the dearest, a point joins the front where its error isBelow() that of all on it: what cannot
/// be told apart counts as equal, and of equal ones the cheapest stays. Then those leave that cost the same as one of
/// the front and err more. Without spreads: no other is as good in both and better in one, of equal ones the first.
/// Points that are not finite are never on it.
std::vector<bool> paretoFront(std::span<const CostAndError> points);

/// Least squares of log y over log x; NaN with fewer than two points of different x. All values above 0.
struct Slope {
  double slope = 0.0;
  double error = 0.0;  ///< standard error of the slope from the residuals; NaN with fewer than three points
};
Slope logLogSlope(std::span<const double> x, std::span<const double> y);

}  // namespace lucerna::measure
