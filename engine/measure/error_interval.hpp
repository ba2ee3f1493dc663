// A picture's error against the reference when the reference is only known as a sampled reference (no GL): an estimate,
// and an interval that contains the true error with a stated confidence.
//
// d = image - reference at a pixel and channel, s its standard error in the reference. E[d^2 - s^2] is the true squared
// error, without bias; its variance is 4 d^2 s^2 - 2 s^4 in the mean, if the reference's noise is normal [for d ~
// N(delta, s^2): Var d^2 = 4 delta^2 s^2 + 2 s^4, E d^2 = delta^2 + s^2]. Channels of a pixel are sampled by the same
// paths, so their errors are taken to rise and fall together; pixels are independent.
#pragma once

#include "base/image.hpp"

namespace lucerna::measure {

/// Root mean square error over the mean of the reference, 0..
struct ErrorInterval {
  double value = 0.0;  ///< estimate, with the reference's own noise subtracted; at least 0
  double low = 0.0, high = 0.0;
};

/// sigmas: half the interval's width in standard deviations. 2.576 cover 99 % of a normal distribution, and thus 95 %
/// if standard errors are themselves estimated from about 16 samples. Throws Error(badInput) if sizes differ.
ErrorInterval nrmseInterval(const Image& image, const Image& reference, const Image& standardError,
                            double sigmas = 2.576);

}  // namespace lucerna::measure
