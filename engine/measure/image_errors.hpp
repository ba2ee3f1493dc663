// Errors of one linear HDR picture against another (no GL).
//
// d = image - reference, over all pixels and the three channels alike unless said otherwise; m = mean of the reference.
//   rmse    sqrt(mean d^2), radiance
//   nrmse   rmse / m
//   l2      sqrt(sum d^2 / sum r^2): a black picture has 1, whatever share of the picture is background
//   relmse  mean d^2 / (r^2 + kRelativeEpsilon m^2): the epsilon follows the scene's brightness, so units do not matter
//   bias    mean d, signed, radiance; relativeBias = bias / m
//   p99     99th percentile, and max, of a pixel's largest |d| over its channels
// A pixel that is not finite makes every measure NaN and is counted: nothing is clamped away.
//
// Averaged over blocks (blockMeans) the same measures show errors larger than single pixels; PartErrors shows which
// pixels are too bright and which too dark; constantIrradiance() is the baseline: one irradiance everywhere,
// chosen by least squares.
//
// A sampled reference has noise of its own: E[measured mse] = mse + mean variance of the reference.
// lessNoise() subtracts it, and marks measures that are within it (below three standard errors).
#pragma once

#include "base/image.hpp"

#include <cstddef>
#include <vector>

namespace lucerna::measure {

inline constexpr double kRelativeEpsilon = 0.01;

struct ImageErrors {
  double rmse = 0.0, nrmse = 0.0, l2 = 0.0, relmse = 0.0, bias = 0.0, relativeBias = 0.0, p99 = 0.0, max = 0.0;
  glm::dvec3 channelBias{0.0};  ///< mean d of each channel
  double referenceMean = 0.0;  ///< m
  double referenceSquare = 0.0;  ///< mean r^2 over pixels and channels
  std::size_t notFinite = 0;  ///< pixels, in either picture
};

/// Throws Error(badInput) if the sizes differ or there are no pixels.
ImageErrors errorsOf(const Image& image, const Image& reference);

/// The contribution of a sampled reference's noise to those measures.
struct ReferenceNoise {
  double variance = 0.0;  ///< mean over pixels and channels of the squared standard error
  double relativeVariance = 0.0;  ///< the same of se^2 / (r^2 + epsilon m^2)
  double meanError = 0.0;  ///< standard error of m
};
/// standardError: of each pixel and channel.
ReferenceNoise noiseOf(const Image& reference, const Image& standardError, double meanError);

/// Standard errors that the reference's noise causes in mean d^2 and in relmse. A pixel's channels share their paths
/// and count as fully correlated; true differences are taken as d^2 less the noise. Var(d + e)^2 = 4 d^2 s^2 + 2 s^4
/// for normal noise e of standard error s.
struct SquareErrors {
  double squares = 0.0, relative = 0.0;
};
SquareErrors squareErrorsOf(const Image& image, const Image& reference, const Image& standardError);

struct JudgedErrors {
  ImageErrors measured;
  double rmse = 0.0, nrmse = 0.0, l2 = 0.0,
         relmse = 0.0;  ///< less the reference's noise, at least 0; l2 divides by sum r^2 less its noise too
  double noiseNrmse = 0.0;  ///< that share: sqrt(variance) / m
  double noiseL2 = 0.0;  ///< the same over sqrt(mean r^2)
  double noiseRelmse = 0.0;  ///< subtracted from relmse
  double biasError = 0.0;  ///< standard error of the bias
  bool atNoise = false;  ///< measured rmse is below 3 standard errors of the reference
  bool biasAtNoise = false;  ///< |bias| is below 3 biasError
};
/// ownBiasError: the image's own standard error of its mean, if it is sampled too.
JudgedErrors lessNoise(const ImageErrors& measured, const ReferenceNoise& noise, double ownBiasError = 0.0);

/// Side of a block in pixels: a sixteenth of the width, rounded, at least 1.
int blockSide(int width);
/// Replaces every pixel by the mean of its block of side x side pixels, cut off at the picture's edge: errorsOf() of
/// two such pictures weighs blocks by their number of pixels.
Image blockMeans(const Image& image, int side);
/// Standard errors of those means, assuming independent pixels.
Image blockStandardErrors(const Image& standardError, int side);

/// How much the sum of the channels differs between two pictures of one view: flicker, if nothing has changed but the
/// estimate of the light. Both are infinite if only the first picture is black or if a pixel is not finite, so that a
/// maximum over many pictures does not hide it.
struct Change {
  double mean = 0.0;  ///< of the mean, relative to the first picture's
  double block = 0.0;  ///< largest of a whole block, relative to its own mean or, where it is dark, to the picture's
};
/// blockSide: in pixels; blocks that the picture's edge cuts off are left out.
Change changeBetween(const Image& before, const Image& after, int blockSide = 16);

/// Errors of a subset of the pixels, such as those lit by the sun.
struct PartErrors {
  double pixels = 0.0;  ///< their share of the picture's pixels, 0..1
  double bias = 0.0;  ///< mean d over them, radiance
  double relativeBias = 0.0;  ///< bias over their mean r; NaN without pixels
  double biasError = 0.0;  ///< standard error of the relative bias
  double squares = 0.0;  ///< their share of sum d^2, 0..1; 0 where that is 0
};
/// isPart: one value per pixel. ownBiasError: as in lessNoise(), of the whole picture; the part's pixels are assumed to
/// be as noisy as all of them.
PartErrors partErrorsOf(const Image& image, const Image& reference, const Image& standardError,
                        const std::vector<bool>& isPart, double ownBiasError = 0.0);

/// The irradiance E, channel by channel, at least 0, for which albedo E / pi is closest to the picture by least
/// squares: E = pi sum(a r) / sum(a^2).
glm::dvec3 constantIrradiance(const Image& albedo, const Image& picture);
/// albedo E / pi: Lambertian surfaces under that irradiance.
Image lit(const Image& albedo, const Image& irradiance);
/// albedo E / pi: Lambertian surfaces under the same irradiance everywhere.
Image litByConstant(const Image& albedo, const glm::dvec3& irradiance);

}  // namespace lucerna::measure
