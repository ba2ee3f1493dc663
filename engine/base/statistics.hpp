// Order statistics of small samples (no GL).
#pragma once

#include <span>
#include <vector>

namespace lucerna {

/// Linear-interpolated percentile, p in [0,1], of an unsorted sample (Hyndman and Fan 1996, type 7). NaN for an empty
/// sample.
double percentile(std::span<const double> sample, double p);

/// Bounds of the population's median: order statistics between which it lies with a probability of at least 95 %, for
/// any distribution (the sign test). NaN for fewer than six values. Source: [DavidNagaraja2003, 7.1].
struct MedianInterval {
  double low, high;
};
MedianInterval medianInterval(std::span<const double> sample);

inline double median(std::span<const double> sample) { return percentile(sample, 0.5); }

}  // namespace lucerna
