// Ear clipping [Meisters1975]. Corner b between a and c is an ear if it turns left and no
// edge of the remaining polygon enters the open triangle abc. Asking for edges, not for corners inside, is right for
// touching corners and bridges too: their boundary lies on the triangle's without entering it.
#include "scene/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lucerna {

namespace {

double cross2(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

class EarClipper {
 public:
  EarClipper(std::span<const glm::dvec3> corners, const glm::dvec3& normal, unsigned base,
             std::vector<std::array<unsigned, 3>>& triangles)
      : base_(base), triangles_(triangles), left_(static_cast<unsigned>(corners.size())) {
    // The plane's axes, right-handed about the normal.
    const glm::dvec3 n = glm::normalize(normal), size = glm::abs(n);
    const glm::dvec3 away = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                            : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                 : glm::dvec3(0, 0, 1);
    const glm::dvec3 u = glm::normalize(glm::cross(away, n)), v = glm::cross(n, u);
    double extent = 0.0, farthest = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 local = corners[i] - corners[0];
      at_.emplace_back(glm::dot(local, u), glm::dot(local, v));
      extent = std::max({extent, std::abs(at_.back().x), std::abs(at_.back().y)});
      for (int k = 0; k < 3; ++k) farthest = std::max(farthest, std::abs(corners[i][k]));
      next_.push_back(static_cast<unsigned>((i + 1) % corners.size()));
      prev_.push_back(static_cast<unsigned>((i + corners.size() - 1) % corners.size()));
    }
    // Distances that rounding makes: of doubles, and of files that hold floats.
    rounding_ = {1e-14 * extent + 1e-15 * farthest, 1e-6 * extent};
  }

  void run() {
    std::vector<unsigned> suspects(at_.size());
    std::iota(suspects.begin(), suspects.end(), 0u);
    removeSpikes(std::move(suspects));
    unsigned misses = 0;
    for (int level = 0; left_ > 3;) {
      const double rounding = rounding_[level < 2 ? 0 : 1];
      if (isEar(first_, level, rounding) || isSpike(first_, rounding)) {
        const unsigned a = prev_[first_], c = next_[first_];
        cut(first_);
        removeSpikes({a, c});
        misses = 0;
        level = 0;
        continue;
      }
      first_ = next_[first_];
      if (++misses <= left_) continue;
      misses = 0;
      if (++level > kForced) break;  // the rest has no area
    }
    while (left_ >= 3) cut(first_);
  }

 private:
  /// Levels of asking: no corner on the new edge; corners there; with the rounding of floats; any left turn.
  static constexpr int kStrict = 0, kForced = 3;
  static constexpr unsigned kGone = 0xffffffffu;

  void cut(unsigned b) {
    triangles_.push_back({base_ + prev_[b], base_ + b, base_ + next_[b]});
    next_[prev_[b]] = next_[b];
    prev_[next_[b]] = prev_[b];
    first_ = next_[next_[b]];  // not beside: fans of slivers have long edges
    prev_[b] = kGone;
    --left_;
  }

  /// At once where one arises: along an edge and its way back, a corner would seem an ear of what is outside.
  void removeSpikes(std::vector<unsigned> suspects) {
    while (left_ > 3 && !suspects.empty()) {
      const unsigned b = suspects.back();
      suspects.pop_back();
      if (prev_[b] == kGone || !isSpike(b, rounding_[0])) continue;
      suspects.insert(suspects.end(), {prev_[b], next_[b]});
      cut(b);
    }
  }

  /// Of corner b over the edge between its neighbours; above 0: it turns left.
  double height(unsigned b) const {
    const glm::dvec2 ab = at_[b] - at_[prev_[b]], bc = at_[next_[b]] - at_[b];
    const double longest = std::sqrt(std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ab + bc, ab + bc)}));
    return longest > 0.0 ? cross2(ab, bc) / longest : 0.0;
  }

  /// Whether the boundary turns back on itself at b, or stays where it is.
  bool isSpike(unsigned b, double rounding) const {
    const glm::dvec2 ba = at_[prev_[b]] - at_[b], bc = at_[next_[b]] - at_[b];
    const double shorter = std::min(glm::length(ba), glm::length(bc));
    return shorter <= rounding || (glm::dot(ba, bc) > 0.0 && std::abs(height(b)) <= rounding);
  }

  bool isEar(unsigned b, int level, double rounding) const {
    if (!(height(b) > rounding)) return false;
    if (level == kForced) return true;
    const unsigned ia = prev_[b], ic = next_[b];
    const std::array<glm::dvec2, 3> t = {at_[ia], at_[b], at_[ic]};
    const glm::dvec2 low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
    std::array<glm::dvec2, 3> inward;  // unit normals of its sides
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec2 side = t[(k + 1) % 3] - t[k];
      inward[k] = glm::dvec2(-side.y, side.x) / glm::length(side);
    }
    for (unsigned v = ic; v != ia; v = next_[v]) {
      const glm::dvec2 &p = at_[v], &q = at_[next_[v]];
      if (std::max(p.x, q.x) < low.x || std::min(p.x, q.x) > high.x || std::max(p.y, q.y) < low.y ||
          std::min(p.y, q.y) > high.y)
        continue;
      double from = 0.0, to = 1.0;  // the part of the edge inside of all sides
      for (std::size_t k = 0; k < 3; ++k) {
        const double dp = glm::dot(p - t[k], inward[k]) - rounding, dq = glm::dot(q - t[k], inward[k]) - rounding;
        if (dp <= 0.0 && dq <= 0.0) to = -1.0;
        else if (dp < 0.0) from = std::max(from, dp / (dp - dq));
        else if (dq < 0.0) to = std::min(to, dp / (dp - dq));
      }
      if (from < to) return false;
      if (level != kStrict || v == ic) continue;
      // Whether p lies on the new edge, between its ends.
      const glm::dvec2 ca = t[0] - t[2];
      const double along = glm::dot(p - t[2], ca) / glm::length(ca);
      if (std::abs(glm::dot(p - t[2], inward[2])) <= rounding && along > rounding && along < glm::length(ca) - rounding)
        return false;
    }
    return true;
  }

  unsigned base_;
  std::vector<std::array<unsigned, 3>>& triangles_;
  unsigned left_, first_ = 0;  ///< how many corners remain, and one of them
  std::vector<glm::dvec2> at_;
  std::vector<unsigned> next_, prev_;  ///< of the remaining corners
  std::array<double, 2> rounding_{};
};

/// Whether all corners turn left and the fan from the first one covers the polygon.
bool isConvex(std::span<const glm::dvec3> p, const glm::dvec3& normal) {
  constexpr double kLeast = 1e-6;  // sine of an angle; flatter ones are not for a fan
  const std::size_t n = p.size();
  const double unit = glm::length(normal);
  const auto turnsLeft = [&](std::size_t a, std::size_t b, std::size_t c) {
    const glm::dvec3 ab = p[b] - p[a], bc = p[c] - p[b];
    return glm::dot(glm::cross(ab, bc), normal) > kLeast * unit * glm::length(ab) * glm::length(bc);
  };
  for (std::size_t i = 0; i < n; ++i)
    if (!turnsLeft(i, (i + 1) % n, (i + 2) % n)) return false;
  for (std::size_t i = 2; i + 1 < n; ++i)
    if (!turnsLeft(0, i, i + 1)) return false;
  return true;
}

}  // namespace

glm::dvec3 areaVector(std::span<const glm::dvec3> corners) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += glm::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  return sum;
}

void appendTriangles(std::span<const glm::dvec3> corners, unsigned first,
                     std::vector<std::array<unsigned, 3>>& triangles) {
  const std::size_t before = triangles.size();
  if (corners.size() > 3) {
    const glm::dvec3 normal = areaVector(corners);
    double longest2 = 0.0;
    for (const glm::dvec3& p : corners) longest2 = std::max(longest2, glm::dot(p - corners[0], p - corners[0]));
    const bool hasArea = glm::length(normal) > 1e-14 * longest2 && std::isfinite(longest2);
    if (hasArea && !isConvex(corners, normal)) EarClipper(corners, normal, first, triangles).run();
  }
  if (triangles.size() > before) return;
  for (unsigned i = 1; i + 1 < corners.size(); ++i) triangles.push_back({first, first + i, first + i + 1});
}

}  // namespace lucerna
