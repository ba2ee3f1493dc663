#include "support/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lucerna::test {

RayCaster::RayCaster(const Scene& scene) : scene_(scene), order_(scene.triangleCount()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  nodes_.reserve(order_.size());
  if (!order_.empty()) build(0, order_.size());
}

glm::dvec3 RayCaster::corner(std::size_t triangle, int k) const {
  return glm::dvec3(scene_.vertices[scene_.indices[3 * triangle + static_cast<std::size_t>(k)]].position);
}

std::size_t RayCaster::build(std::size_t begin, std::size_t end) {
  constexpr std::size_t kLeafTriangles = 4;
  const std::size_t self = nodes_.size();
  nodes_.push_back({{}, begin, end, 0});
  Bounds centres;
  for (std::size_t i = begin; i < end; ++i) {
    for (int k = 0; k < 3; ++k) nodes_[self].bounds.add(corner(order_[i], k));
    centres.add(corner(order_[i], 0));
  }
  if (end - begin <= kLeafTriangles) return self;
  const glm::dvec3 extent = centres.extent();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t middle = (begin + end) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [&](std::size_t a, std::size_t b) { return corner(a, 0)[axis] < corner(b, 0)[axis]; });
  build(begin, middle);
  const std::size_t right = build(middle, end);
  nodes_[self].right = right;
  return self;
}

std::optional<RayHit> RayCaster::firstHit(const glm::dvec3& origin, const glm::dvec3& direction,
                                          double farthest) const {
  std::optional<RayHit> hit;
  if (nodes_.empty()) return hit;
  const glm::dvec3 inverse = 1.0 / direction;
  std::vector<std::size_t> stack = {0};
  while (!stack.empty()) {
    const std::size_t index = stack.back();
    const Node& node = nodes_[index];
    stack.pop_back();
    double enter = 0.0, leave = farthest;
    for (int k = 0; k < 3; ++k) {
      const double t0 = (node.bounds.min[k] - origin[k]) * inverse[k],
                   t1 = (node.bounds.max[k] - origin[k]) * inverse[k];
      if (std::isnan(t0) || std::isnan(t1)) continue;  // the ray runs within a face of the box
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    if (enter > leave * (1.0 + 1e-12)) continue;
    if (node.right != 0) {
      stack.push_back(node.right);
      stack.push_back(index + 1);
      continue;
    }
    for (std::size_t i = node.begin; i < node.end; ++i) {
      const glm::dvec3 a = corner(order_[i], 0), ab = corner(order_[i], 1) - a, ac = corner(order_[i], 2) - a;
      const glm::dvec3 p = glm::cross(direction, ac);
      const double determinant = glm::dot(ab, p);
      if (determinant == 0.0) continue;
      const glm::dvec3 s = origin - a, q = glm::cross(s, ab);
      const double u = glm::dot(s, p) / determinant, v = glm::dot(direction, q) / determinant;
      const double t = glm::dot(ac, q) / determinant;
      if (u < 0.0 || v < 0.0 || u + v > 1.0 || !(t > 0.0) || !(t < farthest)) continue;
      farthest = t;
      hit = RayHit{t, order_[i], glm::normalize(glm::cross(ab, ac))};
    }
  }
  return hit;
}

double RayCaster::clearance(const glm::dvec3& point, double farthest) const {
  double smallest = farthest;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        if (const auto hit = firstHit(point, glm::normalize(glm::dvec3(x, y, z)), smallest)) smallest = hit->distance;
      }
  return smallest;
}

}  // namespace lucerna::test
