#include "pathtracer/clearance.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <future>
#include <limits>

namespace lucerna {

namespace {

double squaredDistanceToSegment(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& point) {
  const glm::dvec3 side = b - a, from = point - a;
  const double length = glm::dot(side, side);
  const glm::dvec3 rest = from - (length > 0.0 ? std::clamp(glm::dot(from, side) / length, 0.0, 1.0) : 0.0) * side;
  return glm::dot(rest, rest);
}

/// Halves a cube down to the cells, and passes on only triangles that may be nearest to a point in it.
class Filler {
 public:
  Filler(const std::vector<Corners>& triangles, ClearanceGrid& grid) : triangles_(triangles), grid_(grid) {}

  /// side: in cells, a power of two.
  void fill(const glm::ivec3& first, int side, const std::vector<int>& candidates, bool onManyThreads) {
    if (glm::any(glm::greaterThanEqual(first, grid_.size))) return;
    const glm::dvec3 centre = grid_.min + grid_.cell * (glm::dvec3(first) + 0.5 * side);
    std::vector<double> distances(candidates.size());
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      distances[i] = distanceTo(triangles_[static_cast<std::size_t>(candidates[i])], centre);
      nearest = std::min(nearest, distances[i]);
    }
    if (side == 1) {
      const std::size_t row = static_cast<std::size_t>(first.y) +
                              static_cast<std::size_t>(grid_.size.y) * static_cast<std::size_t>(first.z);
      grid_.radius[static_cast<std::size_t>(first.x) + static_cast<std::size_t>(grid_.size.x) * row] =
          static_cast<float>(nearest * (1.0 - 1e-6));
      return;
    }
    const double reach = nearest + std::sqrt(3.0) * side * grid_.cell;  // the cube's diameter
    std::vector<int> kept;
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (distances[i] <= reach) kept.push_back(candidates[i]);
    std::vector<std::future<void>> parts;
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 child = first + side / 2 * glm::ivec3(k & 1, k >> 1 & 1, k >> 2);
      if (onManyThreads)
        parts.push_back(
            std::async(std::launch::async, [this, child, side, &kept] { fill(child, side / 2, kept, false); }));
      else fill(child, side / 2, kept, false);
    }
    for (std::future<void>& part : parts) part.get();
  }

 private:
  const std::vector<Corners>& triangles_;
  ClearanceGrid& grid_;
};

}  // namespace

double distanceTo(const Corners& triangle, const glm::dvec3& point) {
  const auto& [a, b, c] = triangle;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double area = glm::dot(normal, normal);
  const auto within = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(to - from, point - from), normal) >= 0.0;
  };
  if (area > 0.0 && within(a, b) && within(b, c) && within(c, a))
    return std::abs(glm::dot(point - a, normal)) / std::sqrt(area);
  return std::sqrt(std::min({squaredDistanceToSegment(a, b, point), squaredDistanceToSegment(b, c, point),
                             squaredDistanceToSegment(c, a, point)}));
}

ClearanceGrid clearanceGrid(const std::vector<Corners>& triangles, const glm::dvec3& min, const glm::dvec3& max,
                            int cells) {
  CHECK(cells > 0 && std::has_single_bit(static_cast<unsigned>(cells)), "{} cells", cells);
  ClearanceGrid grid;
  const glm::dvec3 extent = max - min;
  grid.min = min;
  grid.cell = std::max({extent.x, extent.y, extent.z}) / cells;
  CHECK(grid.cell > 0.0, "an empty box");
  grid.size = glm::clamp(glm::ivec3(glm::ceil(extent / grid.cell)), glm::ivec3(1), glm::ivec3(cells));
  grid.radius.resize(static_cast<std::size_t>(grid.size.x) * static_cast<std::size_t>(grid.size.y) *
                     static_cast<std::size_t>(grid.size.z));
  std::vector<int> all;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (std::isfinite(glm::dot(triangles[i][0] + triangles[i][1] + triangles[i][2], glm::dvec3(1.0))))
      all.push_back(static_cast<int>(i));
  Filler(triangles, grid).fill(glm::ivec3(0), cells, all, true);
  return grid;
}

}  // namespace lucerna
