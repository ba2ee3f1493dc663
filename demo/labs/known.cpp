// Known answers: tails of the chi-square and Student's t distributions; irradiance from polygons.
#include "labs/lab.hpp"

#include <cmath>

namespace lucerna::demo::labs {

namespace {

/// Q(a, x), the upper regularised incomplete gamma function: series below a + 1, Lentz's continued fraction above.
double gammaTail(double a, double x) {
  if (x <= 0.0) return 1.0;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < 10000 && std::abs(term) > 1e-16 * std::abs(sum); ++n) sum += term *= x / (a + n);
    return 1.0 - front * sum;
  }
  double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
  for (int n = 1; n < 10000; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    const double step = d * c;
    h *= step;
    if (std::abs(step - 1.0) < 1e-15) break;
  }
  return front * h;
}

/// I_x(a, b), the regularised incomplete beta function, by its continued fraction; converges well for x < (a + 1) / (a
/// + b + 2).
double betaPart(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  double c = 1.0, d = 1.0 / (1.0 - (a + b) * x / (a + 1.0)), h = d;
  for (int m = 1; m < 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1.0 / (1.0 + even * d);
    c = 1.0 + even / c;
    h *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1.0 / (1.0 + odd * d);
    c = 1.0 + odd / c;
    h *= d * c;
    if (std::abs(d * c - 1.0) < 1e-15) break;
  }
  return front * h / a;
}

}  // namespace

double chiSquareTail(double chiSquare, double degrees) { return gammaTail(0.5 * degrees, 0.5 * chiSquare); }

double studentTail(double t, double degrees) {
  const double x = degrees / (degrees + t * t), a = 0.5 * degrees, b = 0.5;
  return x < (a + 1.0) / (a + b + 2.0) ? betaPart(a, b, x) : 1.0 - betaPart(b, a, 1.0 - x);
}

double polygonIrradiance(std::span<const glm::dvec3> corners, const glm::dvec3& x, const glm::dvec3& n) {
  double sum = 0.0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec3 a = glm::normalize(corners[k] - x), b = glm::normalize(corners[(k + 1) % corners.size()] - x),
                     c = glm::cross(a, b);
    if (const double sine = glm::length(c); sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(c, n) / sine;
  }
  return 0.5 * std::abs(sum);
}

double squareLampIrradiance(double side, double height, const glm::dvec3& x) {
  const double h = 0.5 * side;
  const glm::dvec3 corners[] = {{-h, height, -h}, {h, height, -h}, {h, height, h}, {-h, height, h}};
  return polygonIrradiance(corners, x, {0.0, 1.0, 0.0});
}

}  // namespace lucerna::demo::labs
