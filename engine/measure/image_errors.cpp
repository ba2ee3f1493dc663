#include "measure/image_errors.hpp"

#include "base/error.hpp"
#include "base/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lucerna::measure {

namespace {

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
double sum(const glm::dvec3& v) { return v.x + v.y + v.z; }

void checkSizes(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throwBadInput("pictures of {}x{} and {}x{}: only pictures of one size can be compared", a.width, a.height, b.width, b.height);
  if (a.pixels.empty()) throwBadInput("pictures without pixels cannot be compared");
}

double relativeFloor(double mean) { return kRelativeEpsilon * mean * mean; }

// x / y, and 0 where both are: a black picture equals a black reference.
double ratio(double x, double y) { return x == 0.0 ? 0.0 : x / y; }

}  // namespace

ImageErrors errorsOf(const Image& image, const Image& reference) {
  checkSizes(image, reference);
  ImageErrors result;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) result.notFinite += !finite(image.pixels[i]) || !finite(reference.pixels[i]);
  if (result.notFinite > 0) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    result.rmse = result.nrmse = result.relmse = result.bias = result.relativeBias = result.p99 = result.max = result.referenceMean = nan;
    result.channelBias = glm::dvec3(nan);
    return result;
  }
  const double pixels = static_cast<double>(image.pixels.size());
  result.referenceMean = sum(meanOf(reference)) / 3.0;
  const double floor = relativeFloor(result.referenceMean);
  double squares = 0.0, relative = 0.0;
  std::vector<double> largest;
  largest.reserve(image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const glm::dvec3 r(reference.pixels[i]), d = glm::dvec3(image.pixels[i]) - r;
    const glm::dvec3 square = d * d;
    squares += sum(square);
    for (int c = 0; c < 3; ++c) relative += ratio(square[c], r[c] * r[c] + floor);
    result.channelBias += d / pixels;
    largest.push_back(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}));
  }
  result.rmse = std::sqrt(squares / (3.0 * pixels));
  result.nrmse = ratio(result.rmse, result.referenceMean);
  result.relmse = relative / (3.0 * pixels);
  result.bias = sum(result.channelBias) / 3.0;
  result.relativeBias = ratio(result.bias, result.referenceMean);
  result.p99 = percentile(largest, 0.99);
  result.max = *std::max_element(largest.begin(), largest.end());
  return result;
}

ReferenceNoise noiseOf(const Image& reference, const Image& standardError, double meanError) {
  checkSizes(reference, standardError);
  ReferenceNoise noise;
  noise.meanError = meanError;
  const double floor = relativeFloor(sum(meanOf(reference)) / 3.0), count = 3.0 * static_cast<double>(reference.pixels.size());
  for (std::size_t i = 0; i < reference.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double r = reference.pixels[i][c], square = static_cast<double>(standardError.pixels[i][c]) * standardError.pixels[i][c];
      noise.variance += square / count;
      noise.relativeVariance += ratio(square, r * r + floor) / count;
    }
  return noise;
}

JudgedErrors lessNoise(const ImageErrors& measured, const ReferenceNoise& noise, double ownBiasError) {
  JudgedErrors judged;
  judged.measured = measured;
  judged.rmse = std::sqrt(std::max(0.0, measured.rmse * measured.rmse - noise.variance));
  judged.nrmse = ratio(judged.rmse, measured.referenceMean);
  judged.relmse = std::max(0.0, measured.relmse - noise.relativeVariance);
  judged.noiseNrmse = ratio(std::sqrt(noise.variance), measured.referenceMean);
  judged.biasError = std::hypot(noise.meanError, ownBiasError);
  judged.atNoise = measured.rmse < 3.0 * std::sqrt(noise.variance);
  judged.biasAtNoise = std::abs(measured.bias) < 3.0 * judged.biasError;
  if (measured.notFinite > 0) judged.rmse = judged.nrmse = judged.relmse = measured.rmse;  // max(0, NaN) would be 0
  return judged;
}

}  // namespace lucerna::measure
