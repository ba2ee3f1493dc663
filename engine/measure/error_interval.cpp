#include "measure/error_interval.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::measure {

ErrorInterval nrmseInterval(const Image& image, const Image& reference, const Image& standardError, double sigmas) {
  if (image.width != reference.width || image.height != reference.height ||
      standardError.pixels.size() != reference.pixels.size() || image.pixels.empty())
    throwBadInput("an error between pictures of {}x{} and {}x{}", image.width, image.height, reference.width,
                  reference.height);
  double squares = 0.0, variance = 0.0, mean = 0.0, meanVariance = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    double deviation = 0.0, error = 0.0;  // of this pixel's sums, channels fully correlated
    for (int c = 0; c < 3; ++c) {
      const double d = static_cast<double>(image.pixels[i][c]) - reference.pixels[i][c], s = standardError.pixels[i][c];
      squares += d * d - s * s;
      deviation += std::sqrt(std::max(4.0 * d * d * s * s - 2.0 * s * s * s * s, 2.0 * s * s * s * s));
      mean += reference.pixels[i][c];
      error += s;
    }
    variance += deviation * deviation;
    meanVariance += error * error;
  }
  const double count = 3.0 * static_cast<double>(image.pixels.size());
  squares /= count;
  mean /= count;
  const double half = sigmas * std::sqrt(variance) / count, meanError = sigmas * std::sqrt(meanVariance) / count;
  const auto over = [](double square, double m) {
    return m > 0.0 ? std::sqrt(std::max(square, 0.0)) / m : square > 0.0 ? INFINITY : 0.0;
  };
  return {over(squares, mean), over(squares - half, mean + meanError), over(squares + half, mean - meanError)};
}

}  // namespace lucerna::measure
