#include "support/form_factor_reference.hpp"

#include "base/angles.hpp"

#include <cmath>

namespace lucerna::reference {

double pointToPolygon(const glm::dvec3& point, const glm::dvec3& normal, std::span<const glm::dvec3> polygon) {
  // Sutherland-Hodgman against the horizon.
  std::vector<glm::dvec3> clipped;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = polygon[i] - point, b = polygon[(i + 1) % polygon.size()] - point;
    const double ha = glm::dot(a, normal), hb = glm::dot(b, normal);
    if (ha > 0.0) clipped.push_back(a);
    if ((ha > 0.0) != (hb > 0.0)) clipped.push_back(a + ha / (ha - hb) * (b - a));
  }
  if (clipped.size() < 3) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < clipped.size(); ++i) {
    const glm::dvec3 a = glm::normalize(clipped[i]), b = glm::normalize(clipped[(i + 1) % clipped.size()]);
    const glm::dvec3 across = glm::cross(a, b);
    const double sine = glm::length(across);
    if (sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) / sine * glm::dot(across, normal);
  }
  return std::abs(sum) / (2.0 * kPi);
}

double opposedSquares(double d) {
  const double x = 1.0 / d, r = std::sqrt(1.0 + x * x);
  return 2.0 / (kPi * x * x) *
         (std::log(r * r / std::sqrt(1.0 + 2.0 * x * x)) + 2.0 * x * r * std::atan(x / r) - 2.0 * x * std::atan(x));
}

double areaToArea(const Rectangle& from, const Rectangle& to, int order) {
  // Nodes and weights on 0..1 by Newton's method on Legendre polynomials.
  std::vector<double> node(static_cast<std::size_t>(order)), weight(node.size());
  for (int i = 0; i < order; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (order + 0.5)), slope = 0.0;
    for (int step = 0; step < 50; ++step) {
      double p = 1.0, before = 0.0;
      for (int k = 0; k < order; ++k) {
        const double next = ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0);
        before = p;
        p = next;
      }
      slope = order * (x * p - before) / (x * x - 1.0);
      x -= p / slope;
    }
    node[static_cast<std::size_t>(i)] = 0.5 * (1.0 + x);
    weight[static_cast<std::size_t>(i)] = 1.0 / ((1.0 - x * x) * slope * slope);
  }
  const glm::dvec3 normal = glm::normalize(glm::cross(from.u, from.v));
  const glm::dvec3 polygon[4] = {to.corner, to.corner + to.u, to.corner + to.u + to.v, to.corner + to.v};
  double sum = 0.0;
  for (std::size_t i = 0; i < node.size(); ++i)
    for (std::size_t j = 0; j < node.size(); ++j)
      sum += weight[i] * weight[j] * pointToPolygon(from.corner + node[i] * from.u + node[j] * from.v, normal, polygon);
  return sum;
}

std::vector<Rectangle> cubeSquares(int n) {
  const Rectangle walls[6] = {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                              {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
                              {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
  std::vector<Rectangle> squares;
  for (const Rectangle& w : walls)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        squares.push_back({w.corner + static_cast<double>(i) / n * w.u + static_cast<double>(j) / n * w.v,
                           w.u / static_cast<double>(n), w.v / static_cast<double>(n)});
  return squares;
}

}  // namespace lucerna::reference
