// Order statistics of small samples (no GL).
#pragma once

#include <span>
#include <vector>

namespace lucerna {

/// Linear-interpolated percentile, p in [0,1], of an unsorted sample (Hyndman and Fan 1996, type 7). NaN for an empty
/// sample.
double percentile(std::span<const double> sample, double p);

inline double median(std::span<const double> sample) { return percentile(sample, 0.5); }

}  // namespace lucerna
