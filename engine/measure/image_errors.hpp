// How far one linear HDR picture is from another (no GL).
//
// d = image - reference, over all pixels and the three channels alike unless said otherwise; m = mean of the reference.
//   rmse    sqrt(mean d^2), radiance
//   nrmse   rmse / m
//   relmse  mean d^2 / (r^2 + kRelativeEpsilon m^2): the epsilon follows the scene's brightness, so that units do not matter
//   bias    mean d, signed, radiance; relativeBias = bias / m
//   p99     99th percentile, and max, of a pixel's largest |d| over its channels
// A pixel that is not finite makes every figure NaN and is counted: nothing is clamped away.
//
// A reference that was sampled has noise of its own: E[measured mse] = mse + mean variance of the reference. lessNoise() takes it off, and says
// where a figure cannot be told from it (below three standard errors).
#pragma once

#include "base/image.hpp"

#include <cstddef>

namespace lucerna::measure {

inline constexpr double kRelativeEpsilon = 0.01;

struct ImageErrors {
  double rmse = 0.0, nrmse = 0.0, relmse = 0.0, bias = 0.0, relativeBias = 0.0, p99 = 0.0, max = 0.0;
  glm::dvec3 channelBias{0.0};    ///< mean d of each channel
  double referenceMean = 0.0;     ///< m
  std::size_t notFinite = 0;      ///< pixels, in either picture
};

/// Throws Error(badInput) where the sizes differ or there are no pixels.
ImageErrors errorsOf(const Image& image, const Image& reference);

/// What a sampled reference contributes to those figures.
struct ReferenceNoise {
  double variance = 0.0;          ///< mean over pixels and channels of the squared standard error
  double relativeVariance = 0.0;  ///< the same of se^2 / (r^2 + epsilon m^2)
  double meanError = 0.0;         ///< standard error of m
};
/// standardError: of each pixel and channel.
ReferenceNoise noiseOf(const Image& reference, const Image& standardError, double meanError);

struct JudgedErrors {
  ImageErrors measured;
  double rmse = 0.0, nrmse = 0.0, relmse = 0.0;  ///< less the reference's share, at least 0
  double noiseNrmse = 0.0;                       ///< that share: sqrt(variance) / m
  double biasError = 0.0;                        ///< standard error of the bias
  bool atNoise = false;                          ///< measured rmse is below 3 standard errors of the reference
  bool biasAtNoise = false;                      ///< |bias| is below 3 biasError
};
/// ownBiasError: the image's own standard error of its mean, where it is sampled too.
JudgedErrors lessNoise(const ImageErrors& measured, const ReferenceNoise& noise, double ownBiasError = 0.0);

}  // namespace lucerna::measure
