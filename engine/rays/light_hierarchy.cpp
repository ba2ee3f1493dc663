#include "rays/light_hierarchy.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"
#include "base/packed_normal.hpp"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

namespace lucerna {

namespace {

constexpr int kBuckets = 12;

/// Of axes: half angle `angle` about `axis`; emission up to `emission` beyond them.
struct Cone {
  glm::dvec3 axis{0.0, 0.0, 1.0};
  double angle = 0.0, emission = 0.0;
};

/// The least cone that holds both.
Cone around(const Cone& a, Cone b, bool isTwoSided) {
  if (isTwoSided && glm::dot(a.axis, b.axis) < 0.0) b.axis = -b.axis;
  const Cone &wide = a.angle >= b.angle ? a : b, &narrow = a.angle >= b.angle ? b : a;
  Cone result{wide.axis, wide.angle, std::max(a.emission, b.emission)};
  const double between = std::acos(std::clamp(glm::dot(wide.axis, narrow.axis), -1.0, 1.0));
  if (std::min(between + narrow.angle, kPi) <= wide.angle) return result;
  result.angle = 0.5 * (wide.angle + between + narrow.angle);
  const glm::dvec3 turn = glm::cross(wide.axis, narrow.axis);
  if (result.angle >= kPi || glm::length(turn) < 1e-12) {
    result.angle = kPi;
    return result;
  }
  const double by = result.angle - wide.angle;
  result.axis = glm::normalize(wide.axis * std::cos(by) + glm::cross(glm::normalize(turn), wide.axis) * std::sin(by));
  return result;
}

/// Solid angle of emission, weighted by its cosine [ContyKulla2018].
double measureOf(const Cone& cone) {
  const double o = cone.angle, w = std::min(o + cone.emission, kPi);
  return 2.0 * kPi * (1.0 - std::cos(o)) +
         0.5 * kPi * (2.0 * w * std::sin(o) - std::cos(o - 2.0 * w) - 2.0 * o * std::sin(o) + std::cos(o));
}

struct Node {
  glm::dvec3 min{1e300}, max{-1e300};
  Cone cone;
  double intensity = 0.0;
  bool isTwoSided = false, isEmpty = true;

  void add(const Node& other) {
    if (other.isEmpty) return;
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
    isTwoSided = isTwoSided || other.isTwoSided;
    cone = isEmpty ? other.cone : around(cone, other.cone, isTwoSided);
    intensity += other.intensity;
    isEmpty = false;
  }
  double cost() const {
    if (isEmpty) return 0.0;
    const glm::dvec3 extent = max - min;
    return intensity * measureOf(cone) * glm::dot(extent, extent);
  }
};

Node nodeOf(const LocalLamp& lamp) {
  return {lamp.min, lamp.max, {lamp.axis, lamp.axisAngle, lamp.emissionAngle}, lamp.intensity, lamp.isTwoSided, false};
}

class Builder {
 public:
  explicit Builder(const std::vector<LocalLamp>& lamps) : lamps_(lamps), order_(lamps.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    result_.lights.resize(lamps.size());
    result_.texels.resize(hierarchyTexels(lamps.size()));
    if (lamps.size() > 1) split(order_, 0);
    for (std::size_t leaf = 0; leaf < lamps.size(); ++leaf) {
      const LocalLamp& lamp = lamps[order_[leaf]];
      result_.lights[leaf] = lamp.light;
      glm::uvec4& texel = result_.texels[leaf / 2];
      texel[leaf % 2 == 0 ? 0 : 2] = lamp.light;
      texel[leaf % 2 == 0 ? 1 : 3] = std::bit_cast<std::uint32_t>(lamp.density);
    }
  }
  LightHierarchy take() { return std::move(result_); }

 private:
  using Lamps = std::span<std::uint32_t>;

  Node boundsOf(Lamps part) const {
    Node node;
    for (const std::uint32_t lamp : part) node.add(nodeOf(lamps_[lamp]));
    return node;
  }

  /// Writes the pair of the two halves of `part`, and all pairs below it.
  void split(Lamps part, int depth) {
    const std::uint32_t pair = result_.pairs++;
    const std::size_t first = halve(part, depth);
    const Lamps halves[2] = {part.first(first), part.subspan(first)};
    const auto split = static_cast<std::uint32_t>(&halves[1].front() - order_.data());
    const auto below = [&](Lamps half) {
      if (half.size() > 1) this->split(half, depth + 1);
    };
    below(halves[0]);
    const std::uint32_t links[2] = {split, halves[1].size() > 1 ? result_.pairs : split};
    below(halves[1]);
    for (std::size_t k = 0; k < 2; ++k) {
      const Node node = boundsOf(halves[k]);
      const glm::vec3 centre(0.5 * (node.min + node.max));
      // the ball is about the rounded centre
      const glm::dvec3 reach = glm::max(node.max - glm::dvec3(centre), glm::dvec3(centre) - node.min);
      const float radius = static_cast<float>(glm::length(reach) * (1.0 + 1e-6));
      const std::uint32_t cosines = glm::packHalf2x16(
          glm::vec2(static_cast<float>(std::cos(node.cone.angle)), static_cast<float>(std::cos(node.cone.emission))));
      const std::uint32_t link = links[k] | (halves[k].size() == 1 ? LightHierarchy::kLeaf : 0u) |
                                 (node.isTwoSided ? LightHierarchy::kTwoSided : 0u);
      glm::uvec4* to = &result_.texels[result_.firstPair() + 4 * static_cast<std::size_t>(pair) + 2 * k];
      to[0] = {std::bit_cast<std::uint32_t>(centre.x), std::bit_cast<std::uint32_t>(centre.y),
               std::bit_cast<std::uint32_t>(centre.z), std::bit_cast<std::uint32_t>(radius)};
      to[1] = {std::bit_cast<std::uint32_t>(static_cast<float>(node.intensity)), packNormal(node.cone.axis), cosines,
               link};
    }
  }

  /// Sorts `part` into halves, and returns the number in the first: the least cost of the buckets' borders along the
  /// three axes. Equal numbers where no border divides the lamps, or where the tree would become too deep.
  std::size_t halve(Lamps part, int depth) {
    const auto placeOf = [&](std::uint32_t lamp) { return 0.5 * (lamps_[lamp].min + lamps_[lamp].max); };
    glm::dvec3 low(1e300), high(-1e300);
    for (const std::uint32_t lamp : part) {
      low = glm::min(low, placeOf(lamp));
      high = glm::max(high, placeOf(lamp));
    }
    const bool isDeep = depth + static_cast<int>(std::bit_width(part.size())) >= LightHierarchy::kMostDepth;
    const double longest = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    const auto bucketOf = [&](std::uint32_t lamp, int axis) {
      const double share = (placeOf(lamp)[axis] - low[axis]) / (high[axis] - low[axis]);
      return std::min(static_cast<int>(share * kBuckets), kBuckets - 1);
    };
    double least = 1e300;
    int bestAxis = -1, bestBorder = 0;
    for (int axis = 0; axis < 3 && !isDeep; ++axis) {
      const double extent = high[axis] - low[axis];
      if (!(extent > 0.0)) continue;
      std::array<Node, kBuckets> buckets;
      for (const std::uint32_t lamp : part)
        buckets[static_cast<std::size_t>(bucketOf(lamp, axis))].add(nodeOf(lamps_[lamp]));
      std::array<Node, kBuckets> above;  // all from a bucket on
      above[kBuckets - 1] = buckets[kBuckets - 1];
      for (std::size_t b = kBuckets - 1; b-- > 0;) {
        above[b] = above[b + 1];
        above[b].add(buckets[b]);
      }
      Node below;
      for (std::size_t b = 1; b < kBuckets; ++b) {
        below.add(buckets[b - 1]);
        if (below.isEmpty || above[b].isEmpty) continue;
        const double cost = (below.cost() + above[b].cost()) * longest / extent;
        if (cost < least) least = cost, bestAxis = axis, bestBorder = static_cast<int>(b);
      }
    }
    if (bestAxis < 0) return part.size() / 2;
    const auto middle = std::stable_partition(
        part.begin(), part.end(), [&](std::uint32_t lamp) { return bucketOf(lamp, bestAxis) < bestBorder; });
    return static_cast<std::size_t>(middle - part.begin());
  }

  const std::vector<LocalLamp>& lamps_;
  std::vector<std::uint32_t> order_;
  LightHierarchy result_;
};

}  // namespace

LightHierarchy lightHierarchy(const std::vector<LocalLamp>& lamps) {
  CHECK(!lamps.empty() && lamps.size() <= 1u << 29, "{} lamps", lamps.size());
  return Builder(lamps).take();
}

}  // namespace lucerna
