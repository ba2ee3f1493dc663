#include "support/rad_reference.hpp"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna::test {

namespace {

glm::dvec3 vec(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
std::array<float, 3> floats(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

RadTriangle makeTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, float ro, std::uint32_t e) {
  RadTriangle t;
  t.p1 = floats(a), t.p2 = floats(b), t.p3 = floats(c);
  t.n = floats(glm::normalize(glm::cross(b - a, c - a)));
  t.ro = ro, t.e = e;
  return t;
}

}  // namespace

double pointToTriangle(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& a, const glm::dvec3& b,
                       const glm::dvec3& c) {
  const std::array<glm::dvec3, 3> corners{glm::normalize(a - point), glm::normalize(b - point),
                                          glm::normalize(c - point)};
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 across = glm::cross(corners[i], corners[(i + 1) % 3]);
    const double length = glm::length(across);
    if (length < 1e-15) continue;
    sum += std::atan2(length, glm::dot(corners[i], corners[(i + 1) % 3])) * glm::dot(normal, across) / length;
  }
  return std::abs(sum) / (2.0 * glm::pi<double>());
}

std::vector<double> receivedInConvex(std::span<const RadTriangle> triangles) {
  const std::size_t count = triangles.size();
  std::vector<double> factors(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 middle = (vec(triangles[i].p1) + vec(triangles[i].p2) + vec(triangles[i].p3)) / 3.0,
                     normal = glm::normalize(vec(triangles[i].n));
    for (std::size_t j = 0; j < count; ++j)
      if (i != j)
        factors[i * count + j] =
            pointToTriangle(middle, normal, vec(triangles[j].p1), vec(triangles[j].p2), vec(triangles[j].p3));
  }
  std::vector<double> received(count, 0.0), next(count);
  for (double change = 1.0; change > 1e-12;) {
    double most = 0.0, size = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      next[i] = 0.0;
      for (std::size_t j = 0; j < count; ++j)
        next[i] += factors[i * count + j] * (triangles[j].e + static_cast<double>(triangles[j].ro) * received[j]);
      most = std::max(most, std::abs(next[i] - received[i]));
      size = std::max(size, next[i]);
    }
    received = next;
    change = most / size;
  }
  return received;
}

std::vector<RadTriangle> litUnitCube(int n, float ro, std::uint32_t e) {
  std::vector<RadTriangle> triangles;
  const auto face = [&](const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, bool ceiling) {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const auto at = [&](int x, int y) {
          return corner + u * (static_cast<double>(x) / n) + v * (static_cast<double>(y) / n);
        };
        const bool light = ceiling && std::abs(2 * i + 1 - n) <= 2 && std::abs(2 * j + 1 - n) <= 2;
        triangles.push_back(makeTriangle(at(i, j), at(i + 1, j), at(i, j + 1), ro, light ? e : 0));
        triangles.push_back(makeTriangle(at(i + 1, j + 1), at(i, j + 1), at(i + 1, j), ro, light ? e : 0));
      }
  };
  const glm::dvec3 o(0.0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  face(o, z, x, false), face(y, x, z, true), face(o, x, y, false), face(z, y, x, false), face(o, y, z, false),
      face(x, z, y, false);
  return triangles;
}

std::vector<RadTriangle> sphereInside(int levels, float ro, double y, std::uint32_t e) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  const std::array<glm::dvec3, 12> p{{{-1, g, 0},
                                      {1, g, 0},
                                      {-1, -g, 0},
                                      {1, -g, 0},
                                      {0, -1, g},
                                      {0, 1, g},
                                      {0, -1, -g},
                                      {0, 1, -g},
                                      {g, 0, -1},
                                      {g, 0, 1},
                                      {-g, 0, -1},
                                      {-g, 0, 1}}};
  constexpr std::array<std::array<std::size_t, 3>, 20> faces{
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  std::vector<std::array<glm::dvec3, 3>> now;
  for (const auto& f : faces)
    now.push_back({glm::normalize(p[f[0]]), glm::normalize(p[f[1]]), glm::normalize(p[f[2]])});
  for (int level = 0; level < levels; ++level) {
    std::vector<std::array<glm::dvec3, 3>> next;
    for (const auto& [a, b, c] : now) {
      const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
      next.push_back({a, ab, ca}), next.push_back({ab, b, bc}), next.push_back({ca, bc, c}),
          next.push_back({ab, bc, ca});
    }
    now = std::move(next);
  }
  std::vector<RadTriangle> triangles;
  for (const auto& [a, b, c] : now)
    triangles.push_back(makeTriangle(a, c, b, ro, (a.y + b.y + c.y) / 3.0 > y ? e : 0));  // turned inwards
  return triangles;
}

}  // namespace lucerna::test
