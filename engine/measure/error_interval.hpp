// How far a picture is from the truth, when all that is known of the truth is a sampled reference (no GL): an estimate,
// and an interval that holds the true error with a stated confidence.
//
// d = image - reference at a pixel and channel, s its standard error in the reference. E[d^2 - s^2] is the true squared
// error, without bias; its variance is 4 d^2 s^2 - 2 s^4 in the mean, if the reference's noise is normal [of d ~
// N(delta, s^2): Var d^2 = 4 delta^2 s^2 + 2 s^4, E d^2 = delta^2 + s^2]. Channels of a pixel are sampled by the same
// paths, so their errors are taken to rise and fall together; pixels are independent.
#pragma once

#include "base/image.hpp"

namespace lucerna::measure {

/// Root mean square error over the mean of the reference, 0..
struct ErrorInterval {
  double value = 0.0;  ///< estimate, with the reference's own noise taken off; at least 0
  double low = 0.0, high = 0.0;
};

/// sigmas: half the interval's width in standard deviations; 2.576 hold 99 % of a normal distribution, and so 95 %
/// where standard errors are themselves estimated from some 16 samples. Throws Error(badInput) where sizes differ.
ErrorInterval nrmseInterval(const Image& image, const Image& reference, const Image& standardError,
                            double sigmas = 2.576);

}  // namespace lucerna::measure
