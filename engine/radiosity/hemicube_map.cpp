#include "radiosity/hemicube_map.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"

#include <cmath>

namespace lucerna {

namespace {

// Antiderivatives over the rectangle from the origin to (x, y) of a face at distance 1: of 1/(pi r^4) and of y/(pi
// r^4).
double fullFace(double x, double y) {
  const double rx = std::sqrt(1.0 + x * x), ry = std::sqrt(1.0 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2.0 * kPi);
}
double halfFace(double x, double y) {
  const double ry = std::sqrt(1.0 + y * y);
  return -std::atan(x / ry) / (2.0 * kPi * ry);
}

}  // namespace

std::vector<double> deltaFormFactors(int n, DeltaMap map) {
  CHECK(n >= 2 && n % 2 == 0, "a hemicube of {} pixels a side", n);
  std::vector<double> factors;
  factors.reserve(static_cast<std::size_t>(3 * n * n / 2));
  const double side = 2.0 / n;
  for (int face = 0; face < 2; ++face)
    for (int row = 0; row < (face == 0 ? n : n / 2); ++row)
      for (int column = 0; column < n; ++column) {
        const double x = column * side - 1.0, y = row * side - (face == 0 ? 1.0 : 0.0);
        const double a = x + 0.5 * side, b = y + 0.5 * side, r2 = 1.0 + a * a + b * b;
        const auto antiderivative = face == 0 ? fullFace : halfFace;
        factors.push_back(map == DeltaMap::exact ? antiderivative(x + side, y + side) - antiderivative(x, y + side) -
                                                       antiderivative(x + side, y) + antiderivative(x, y)
                                                 : (face == 0 ? 1.0 : b) / r2);
      }
  if (map == DeltaMap::published) {
    const double sum = sumOverHemicube(factors, n);
    for (double& f : factors) f /= sum;
  }
  return factors;
}

double sumOverHemicube(const std::vector<double>& factors, int n) {
  const auto full = static_cast<std::size_t>(n * n);
  double sum = 0.0;
  for (std::size_t i = 0; i < factors.size(); ++i) sum += (i < full ? 1.0 : 4.0) * factors[i];
  return sum;
}

}  // namespace lucerna
