#include "measure/image_errors.hpp"

#include "base/angles.hpp"
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
    throwBadInput("pictures of {}x{} and {}x{}: pictures must have the same size", a.width, a.height, b.width,
                  b.height);
  if (a.pixels.empty()) throwBadInput("pictures without pixels cannot be compared");
}

double relativeEpsilon(double mean) { return kRelativeEpsilon * mean * mean; }

// x / y, and 0 where both are: a black picture equals a black reference.
double ratio(double x, double y) { return x == 0.0 ? 0.0 : x / y; }

}  // namespace

ImageErrors errorsOf(const Image& image, const Image& reference) {
  checkSizes(image, reference);
  ImageErrors result;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    result.notFinite += !finite(image.pixels[i]) || !finite(reference.pixels[i]);
  if (result.notFinite > 0) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    result.rmse = result.nrmse = result.l2 = result.relmse = result.bias = result.relativeBias = result.p99 =
        result.max = result.referenceMean = result.referenceSquare = nan;
    result.channelBias = glm::dvec3(nan);
    return result;
  }
  const double pixels = static_cast<double>(image.pixels.size());
  result.referenceMean = sum(meanOf(reference)) / 3.0;
  const double epsilon = relativeEpsilon(result.referenceMean);
  double squares = 0.0, relative = 0.0, referenceSquares = 0.0;
  std::vector<double> largest;
  largest.reserve(image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const glm::dvec3 r(reference.pixels[i]), d = glm::dvec3(image.pixels[i]) - r;
    const glm::dvec3 square = d * d;
    squares += sum(square);
    referenceSquares += sum(r * r);
    for (int c = 0; c < 3; ++c) relative += ratio(square[c], r[c] * r[c] + epsilon);
    result.channelBias += d / pixels;
    largest.push_back(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}));
  }
  result.rmse = std::sqrt(squares / (3.0 * pixels));
  result.nrmse = ratio(result.rmse, result.referenceMean);
  result.referenceSquare = referenceSquares / (3.0 * pixels);
  result.l2 = std::sqrt(ratio(squares, referenceSquares));
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
  const double epsilon = relativeEpsilon(sum(meanOf(reference)) / 3.0),
               count = 3.0 * static_cast<double>(reference.pixels.size());
  for (std::size_t i = 0; i < reference.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double r = reference.pixels[i][c],
                   square = static_cast<double>(standardError.pixels[i][c]) * standardError.pixels[i][c];
      noise.variance += square / count;
      noise.relativeVariance += ratio(square, r * r + epsilon) / count;
    }
  return noise;
}

JudgedErrors lessNoise(const ImageErrors& measured, const ReferenceNoise& noise, double ownBiasError) {
  JudgedErrors judged;
  judged.measured = measured;
  judged.rmse = std::sqrt(std::max(0.0, measured.rmse * measured.rmse - noise.variance));
  judged.nrmse = ratio(judged.rmse, measured.referenceMean);
  judged.relmse = std::max(0.0, measured.relmse - noise.relativeVariance);
  // sum r^2 contains the reference's variance just as sum d^2 does: with it removed from both, a black picture has
  // exactly 1.
  judged.l2 = ratio(judged.rmse, std::sqrt(std::max(0.0, measured.referenceSquare - noise.variance)));
  judged.noiseL2 = ratio(std::sqrt(noise.variance), std::sqrt(measured.referenceSquare));
  judged.noiseNrmse = ratio(std::sqrt(noise.variance), measured.referenceMean);
  judged.noiseRelmse = noise.relativeVariance;
  judged.biasError = std::hypot(noise.meanError, ownBiasError);
  judged.atNoise = measured.rmse < 3.0 * std::sqrt(noise.variance);
  judged.biasAtNoise = std::abs(measured.bias) < 3.0 * judged.biasError;
  if (measured.notFinite > 0)
    judged.rmse = judged.nrmse = judged.l2 = judged.relmse = measured.rmse;  // max(0, NaN) would be 0
  return judged;
}

SquareErrors squareErrorsOf(const Image& image, const Image& reference, const Image& standardError) {
  checkSizes(image, reference);
  checkSizes(reference, standardError);
  const glm::dvec3 mean = meanOf(reference);
  const double epsilon = relativeEpsilon(sum(mean) / 3.0);
  double squares = 0.0, relative = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const glm::dvec3 r(reference.pixels[i]), d = glm::dvec3(image.pixels[i]) - r, s(standardError.pixels[i]);
    double error = 0.0, relativeError = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double s2 = s[c] * s[c], deviation = std::sqrt((4.0 * std::max(0.0, d[c] * d[c] - s2) + 2.0 * s2) * s2);
      error += deviation;
      relativeError += ratio(deviation, r[c] * r[c] + epsilon);
    }
    squares += error * error;
    relative += relativeError * relativeError;
  }
  const double n = 3.0 * static_cast<double>(image.pixels.size());
  return {std::sqrt(squares) / n, std::sqrt(relative) / n};
}

int blockSide(int width) { return std::max(1, static_cast<int>(std::lround(width / 16.0))); }

namespace {

/// Calls f(first, end) for each block: the corners of its pixels.
template <typename F>
void forBlocks(const Image& image, int side, F f) {
  CHECK(side >= 1, "blocks of {} pixels", side);
  for (int y = 0; y < image.height; y += side)
    for (int x = 0; x < image.width; x += side)
      f(glm::ivec2(x, y), glm::ivec2(std::min(x + side, image.width), std::min(y + side, image.height)));
}

/// Sets every pixel of a block to `of` applied to the sum of the block's pixels and their count.
template <typename Value, typename Of>
Image overBlocks(const Image& image, int side, Value value, Of of) {
  Image result(image.width, image.height);
  forBlocks(image, side, [&](glm::ivec2 first, glm::ivec2 end) {
    glm::dvec3 total(0.0);
    for (int y = first.y; y < end.y; ++y)
      for (int x = first.x; x < end.x; ++x) total += value(glm::dvec3(image.at(x, y)));
    const glm::vec3 filled(of(total, static_cast<double>((end.x - first.x) * (end.y - first.y))));
    for (int y = first.y; y < end.y; ++y)
      for (int x = first.x; x < end.x; ++x) result.at(x, y) = filled;
  });
  return result;
}

}  // namespace

Image blockMeans(const Image& image, int side) {
  return overBlocks(
      image, side, [](const glm::dvec3& v) { return v; }, [](const glm::dvec3& total, double n) { return total / n; });
}

Image blockStandardErrors(const Image& standardError, int side) {
  return overBlocks(
      standardError, side, [](const glm::dvec3& e) { return e * e; },
      [](const glm::dvec3& total, double n) { return glm::sqrt(total) / n; });
}

Change changeBetween(const Image& before, const Image& after, int blockSide) {
  checkSizes(before, after);
  const double mean = sum(meanOf(before)), pixels = static_cast<double>(blockSide) * blockSide;
  Change change;
  change.mean = std::abs(ratio(sum(meanOf(after)) - mean, mean));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!std::isfinite(change.mean)) return {kInfinity, kInfinity};
  for (int y = 0; y + blockSide <= before.height; y += blockSide)
    for (int x = 0; x + blockSide <= before.width; x += blockSide) {
      double own = 0.0, difference = 0.0;
      for (int j = y; j < y + blockSide; ++j)
        for (int i = x; i < x + blockSide; ++i) {
          own += sum(before.at(i, j));
          difference += sum(glm::dvec3(after.at(i, j)) - glm::dvec3(before.at(i, j)));
        }
      change.block = std::max(change.block, std::abs(ratio(difference, std::max(own, mean * pixels))));
    }
  return change;
}

PartErrors partErrorsOf(const Image& image, const Image& reference, const Image& standardError,
                        const std::vector<bool>& isPart, double ownBiasError) {
  checkSizes(image, reference);
  checkSizes(reference, standardError);
  CHECK(isPart.size() == image.pixels.size(), "{} marks for {} pixels", isPart.size(), image.pixels.size());
  double count = 0.0, difference = 0.0, light = 0.0, variance = 0.0, squares = 0.0, allSquares = 0.0;
  for (std::size_t i = 0; i < isPart.size(); ++i) {
    const glm::dvec3 r(reference.pixels[i]), d = glm::dvec3(image.pixels[i]) - r, e(standardError.pixels[i]);
    allSquares += sum(d * d);
    if (!isPart[i]) continue;
    count += 1.0;
    difference += sum(d) / 3.0;
    light += sum(r) / 3.0;
    squares += sum(d * d);
    const double error = sum(e) / 3.0;  // channels share their paths: their errors add as if fully correlated
    variance += error * error;
  }
  PartErrors part;
  const double pixels = static_cast<double>(isPart.size());
  part.pixels = count / pixels;
  part.squares = ratio(squares, allSquares);
  if (count == 0.0) {
    part.bias = part.relativeBias = part.biasError = std::numeric_limits<double>::quiet_NaN();
    return part;
  }
  part.bias = difference / count;
  part.relativeBias = ratio(difference, light);
  part.biasError = ratio(std::hypot(std::sqrt(variance), ownBiasError * std::sqrt(pixels * count)), light);
  return part;
}

glm::dvec3 constantIrradiance(const Image& albedo, const Image& picture) {
  checkSizes(albedo, picture);
  glm::dvec3 products(0.0), squares(0.0), irradiance(0.0);
  for (std::size_t i = 0; i < albedo.pixels.size(); ++i) {
    const glm::dvec3 a(albedo.pixels[i]);
    products += a * glm::dvec3(picture.pixels[i]);
    squares += a * a;
  }
  for (int c = 0; c < 3; ++c) irradiance[c] = std::max(0.0, kPi * ratio(products[c], squares[c]));
  return irradiance;
}

Image lit(const Image& albedo, const Image& irradiance) {
  CHECK(albedo.pixels.size() == irradiance.pixels.size(), "{} and {} pixels", albedo.pixels.size(),
        irradiance.pixels.size());
  Image result = albedo;
  for (std::size_t i = 0; i < result.pixels.size(); ++i)
    result.pixels[i] *= irradiance.pixels[i] / static_cast<float>(kPi);
  return result;
}

Image litByConstant(const Image& albedo, const glm::dvec3& irradiance) {
  Image result = albedo;
  for (glm::vec3& p : result.pixels) p = glm::vec3(glm::dvec3(p) * irradiance / kPi);
  return result;
}

}  // namespace lucerna::measure
