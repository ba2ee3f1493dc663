#include "pathtracer/clearance.hpp"

#include "base/error.hpp"
#include "base/packed_normal.hpp"

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

/// Halves a cube down to the cells, and passes on only triangles that may matter to a point in it.
class Filler {
 public:
  Filler(const std::vector<Corners>& triangles, const std::vector<bool>& isBoundary, double freePath,
         ClearanceGrid& grid)
      : triangles_(triangles), isBoundary_(isBoundary), freePath_(freePath), grid_(grid) {}

  /// side: in cells, a power of two.
  void fill(const glm::ivec3& first, int side, const std::vector<int>& candidates, bool onManyThreads) {
    if (glm::any(glm::greaterThanEqual(first, grid_.size))) return;
    const glm::dvec3 centre = grid_.min + grid_.cell * (glm::dvec3(first) + 0.5 * side);
    const double diameter = std::sqrt(3.0) * side * grid_.cell;
    std::vector<Near> near;
    double nearest = std::numeric_limits<double>::infinity();
    for (const int i : candidates) {
      near.push_back({distanceTo(triangles_[static_cast<std::size_t>(i)], centre), i});
      nearest = std::min(nearest, near.back().distance);
    }
    if (side == 1) {
      const std::size_t row = static_cast<std::size_t>(first.y) +
                              static_cast<std::size_t>(grid_.size.y) * static_cast<std::size_t>(first.z);
      Clearance& clearance =
          grid_.clearances[static_cast<std::size_t>(first.x) + static_cast<std::size_t>(grid_.size.x) * row];
      clearance = beyondPlane(near, centre);
      clearance.radius = static_cast<float>(nearest * (1.0 - 1e-6));
      return;
    }
    const double reach = std::max(nearest + diameter, farthest() + 0.5 * diameter);
    std::vector<int> kept;
    for (const Near& one : near)
      if (one.distance <= reach) kept.push_back(one.triangle);
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
  struct Near {
    double distance;
    int triangle;
  };

  /// Beyond it no flight from the cell is expected.
  double farthest() const { return 0.5 * std::sqrt(3.0) * grid_.cell + 8.0 * freePath_; }

  /// A plane along the nearest triangle, moved towards the medium until all within its reach lie beyond it. Of all
  /// reaches, the one that keeps most flights free, by a rough estimate: of those that stay within the reach, and those
  /// that do not begin between plane and wall.
  Clearance beyondPlane(std::vector<Near>& near, const glm::dvec3& centre) const {
    std::erase_if(near, [&](const Near& one) { return !(one.distance < farthest()); });
    if (near.empty()) return {};
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
      return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
    });
    const auto first = static_cast<std::size_t>(near.front().triangle);
    const auto& [a, b, c] = triangles_[first];
    const glm::dvec3 across = glm::cross(b - a, c - a);
    if (!(glm::length(across) > 0.0)) return {};
    const bool faces = isBoundary_[first] || glm::dot(across, a - centre) > 0.0;
    Clearance best;
    best.normal = packNormal(glm::normalize(faces ? across : -across));
    const glm::dvec3 normal = unpackNormal(best.normal);
    double wall = 0.0, depth = std::numeric_limits<double>::infinity(), most = 0.0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      for (const glm::dvec3& corner : triangles_[static_cast<std::size_t>(near[i].triangle)])
        depth = std::min(depth, glm::dot(normal, corner - centre));
      if (i == 0) wall = depth;
      const double reach = i + 1 < near.size() ? near[i + 1].distance : farthest(),
                   beyond = std::max(reach - 0.5 * grid_.cell, 0.0),
                   value = (1.0 - std::exp(-beyond / freePath_)) * std::exp((depth - wall) / freePath_);
      if (value > most) {
        most = value;
        best.reach = static_cast<float>(reach * (1.0 - 1e-6));
        best.depth = static_cast<float>(depth - 1e-6 * std::abs(depth));
      }
    }
    return best;
  }

  const std::vector<Corners>& triangles_;
  const std::vector<bool>& isBoundary_;
  double freePath_;
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

ClearanceGrid clearanceGrid(const std::vector<Corners>& triangles, const std::vector<bool>& isBoundary,
                            const glm::dvec3& min, const glm::dvec3& max, int cells, double freePath) {
  CHECK(cells > 0 && std::has_single_bit(static_cast<unsigned>(cells)), "{} cells", cells);
  CHECK(isBoundary.size() == triangles.size() && freePath > 0.0, "{} sides", isBoundary.size());
  ClearanceGrid grid;
  const glm::dvec3 extent = max - min;
  grid.min = min;
  grid.cell = std::max({extent.x, extent.y, extent.z}) / cells;
  CHECK(grid.cell > 0.0, "an empty box");
  grid.size = glm::clamp(glm::ivec3(glm::ceil(extent / grid.cell)), glm::ivec3(1), glm::ivec3(cells));
  grid.clearances.resize(static_cast<std::size_t>(grid.size.x) * static_cast<std::size_t>(grid.size.y) *
                         static_cast<std::size_t>(grid.size.z));
  std::vector<int> all;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (std::isfinite(glm::dot(triangles[i][0] + triangles[i][1] + triangles[i][2], glm::dvec3(1.0))))
      all.push_back(static_cast<int>(i));
  Filler(triangles, isBoundary, freePath, grid).fill(glm::ivec3(0), cells, all, true);
  return grid;
}

}  // namespace lucerna
