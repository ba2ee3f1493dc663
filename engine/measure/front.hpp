// Summaries of many measurements (no GL): the Pareto front and the slope of a log-log line.
#pragma once

#include <span>
#include <vector>

namespace lucerna::measure {

struct CostAndError {
  double cost = 0.0;   ///< such as ms
  double error = 0.0;  ///< such as NRMSE
};
/// For each point: no other is as good in both and better in one. Of equal points the first is on the front; points that are not finite never are.
std::vector<bool> paretoFront(std::span<const CostAndError> points);

/// Least squares of log y over log x; NaN with fewer than two points of different x. All values above 0.
struct Slope {
  double slope = 0.0;
  double error = 0.0;  ///< standard error of the slope from the residuals; NaN with fewer than three points
};
Slope logLogSlope(std::span<const double> x, std::span<const double> y);

}  // namespace lucerna::measure
