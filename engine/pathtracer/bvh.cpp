#include "pathtracer/bvh.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

using shared::BvhNode;
using shared::BvhTriangle;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kBins = 16;

struct Box {
  glm::vec3 min{kInfinity}, max{-kInfinity};
  void add(const glm::vec3& p) { min = glm::min(min, p), max = glm::max(max, p); }
  void add(const Box& b) { min = glm::min(min, b.min), max = glm::max(max, b.max); }
  float halfArea() const {
    const glm::vec3 e = max - min;
    return e.x < 0.0f ? 0.0f : e.x * e.y + e.y * e.z + e.z * e.x;
  }
  glm::vec3 centre() const { return 0.5f * min + 0.5f * max; }
};

// The scene's corners may be anything; what is kept is finite and has an area.
bool hasArea(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 n = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  return std::isfinite(sum) && sum > 0.0;
}

// Along an axis where the scene lies between m and 2 m from the origin, x - c is exact in float for every x in it [Sterbenz1974].
glm::dvec3 chooseOrigin(const Box& bounds) {
  glm::dvec3 origin(0.0);
  for (int k = 0; k < 3; ++k) {
    const float low = bounds.min[k], high = bounds.max[k];
    if (low <= high && (low > 0.0f || high < 0.0f) && std::max(std::abs(low), std::abs(high)) <= 2.0f * std::min(std::abs(low), std::abs(high)))
      origin[k] = 0.5f * low + 0.5f * high;
  }
  return origin;
}

class Builder {
 public:
  Builder(const Scene& scene, const BvhSettings& settings, Bvh& result) : settings_(settings), result_(result) { collect(scene); }

  void build() {
    result_.nodes.emplace_back();
    std::vector<Reference> all = std::move(references_);
    Box box;
    for (const Reference& r : all) box.add(r.box);
    rootArea_ = box.halfArea();
    if (all.size() <= static_cast<std::size_t>(settings_.leafTriangles)) {
      setChild(0, 0, all.empty() ? Box{} : box, all.empty() ? BVH_LEAF : makeLeaf(all, 0, all.size(), 1));
      setChild(0, 1, Box{}, BVH_LEAF);
      result_.statistics.sahCost = 1.0 + static_cast<double>(all.size());
    } else {
      split(0, all, 0, all.size(), 0, box);
    }
  }

 private:
  struct Reference {
    Box box;
    std::uint32_t triangle;  // into kept_
  };

  void collect(const Scene& scene) {
    Box bounds;
    std::vector<bool> masked(scene.triangleCount(), false);
    for (const Mesh& mesh : scene.meshes)
      if (scene.materials[static_cast<std::size_t>(mesh.material)].alphaMasked)
        std::fill_n(masked.begin() + mesh.firstIndex / 3, mesh.indexCount / 3, true);
    const auto corner = [&](std::size_t i) { return scene.vertices[scene.indices[i]].position; };
    std::vector<std::uint32_t> kept;
    for (std::size_t t = 0; t < scene.triangleCount(); ++t) {
      const glm::vec3 a = corner(3 * t), b = corner(3 * t + 1), c = corner(3 * t + 2);
      if (!hasArea(a, b, c)) continue;
      kept.push_back(static_cast<std::uint32_t>(t));
      bounds.add(a), bounds.add(b), bounds.add(c);
    }
    result_.statistics.triangles = kept.size();
    result_.statistics.degenerate = scene.triangleCount() - kept.size();
    result_.origin = chooseOrigin(bounds);
    const auto moved = [&](std::size_t i) { return glm::vec3(glm::dvec3(corner(i)) - result_.origin); };
    float magnitude = 0.0f;
    for (const std::uint32_t t : kept) {
      BvhTriangle triangle{};
      triangle.a = moved(3 * t), triangle.b = moved(3 * t + 1), triangle.c = moved(3 * t + 2);
      triangle.id = t | (masked[t] ? BVH_TRIANGLE_MASKED : 0u);
      Box box;
      box.add(triangle.a), box.add(triangle.b), box.add(triangle.c);
      for (int k = 0; k < 3; ++k) magnitude = std::max({magnitude, std::abs(box.min[k]), std::abs(box.max[k])});
      references_.push_back({box, static_cast<std::uint32_t>(kept_.size())});
      kept_.push_back(triangle);
    }
    result_.header.magnitude = magnitude;
    // A ray that runs in a face of a box must not miss it: all boxes are a little larger [Ize2013].
    padding_ = magnitude * 0x1p-21f;
  }

  void setChild(std::size_t node, int side, const Box& box, std::uint32_t child) {
    BvhNode& n = result_.nodes[node];
    (side ? n.minimum1 : n.minimum0) = box.min - padding_;
    (side ? n.maximum1 : n.maximum0) = box.max + padding_;
    (side ? n.child1 : n.child0) = child;
  }

  std::uint32_t makeLeaf(const std::vector<Reference>& references, std::size_t begin, std::size_t end, int depth) {
    const auto first = static_cast<std::uint32_t>(result_.triangles.size());
    for (std::size_t i = begin; i < end; ++i) result_.triangles.push_back(kept_[references[i].triangle]);
    ++result_.statistics.leaves;
    result_.statistics.depth = std::max(result_.statistics.depth, depth);
    return BVH_LEAF | static_cast<std::uint32_t>(end - begin - 1) << BVH_LEAF_COUNT_SHIFT | first;
  }

  // Where [begin, end) is best cut: references are reordered, the cut is returned. `end`: they are best left in a leaf.
  std::size_t partition(std::vector<Reference>& all, std::size_t begin, std::size_t end, int depth, const Box& box, bool mayBeLeaf) {
    const std::size_t count = end - begin;
    Box centres;
    for (std::size_t i = begin; i < end; ++i) centres.add(all[i].box.centre());
    double best = mayBeLeaf ? static_cast<double>(count) * static_cast<double>(box.halfArea()) : 1e300;
    int bestAxis = -1, bestBin = 0;
    const auto binOf = [&](const Reference& r, int axis) {
      const float low = centres.min[axis], width = centres.max[axis] - low;
      return std::clamp(static_cast<int>((r.box.centre()[axis] - low) / width * static_cast<float>(kBins)), 0, kBins - 1);
    };
    // Once halving is all that keeps the depth below its bound, halve.
    const bool deep = depth + 1 + static_cast<int>(std::bit_width(count)) >= BVH_MAX_DEPTH;
    for (int axis = 0; axis < 3 && !deep; ++axis) {
      if (!(centres.max[axis] > centres.min[axis])) continue;
      std::array<Box, kBins> boxes{};
      std::array<std::size_t, kBins> counts{};
      for (std::size_t i = begin; i < end; ++i) {
        const auto bin = static_cast<std::size_t>(binOf(all[i], axis));
        boxes[bin].add(all[i].box);
        ++counts[bin];
      }
      std::array<double, kBins> right{};
      Box sum;
      std::size_t n = 0;
      for (std::size_t b = kBins - 1; b > 0; --b) {
        sum.add(boxes[b]), n += counts[b];
        right[b] = static_cast<double>(sum.halfArea()) * static_cast<double>(n);
      }
      sum = {}, n = 0;
      for (std::size_t b = 0; b + 1 < kBins; ++b) {
        sum.add(boxes[b]), n += counts[b];
        if (n == 0 || n == count) continue;
        const double cost = static_cast<double>(box.halfArea()) + static_cast<double>(sum.halfArea()) * static_cast<double>(n) + right[b + 1];
        if (cost < best) best = cost, bestAxis = axis, bestBin = static_cast<int>(b);
      }
    }
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin), last = all.begin() + static_cast<std::ptrdiff_t>(end);
    if (bestAxis >= 0) {
      const auto cut = std::partition(first, last, [&](const Reference& r) { return binOf(r, bestAxis) <= bestBin; });
      return static_cast<std::size_t>(cut - all.begin());
    }
    if (mayBeLeaf) return end;
    const glm::vec3 e = centres.max - centres.min;
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    const std::size_t middle = begin + count / 2;
    std::nth_element(first, all.begin() + static_cast<std::ptrdiff_t>(middle), last,
                     [&](const Reference& a, const Reference& b) { return a.box.centre()[axis] < b.box.centre()[axis]; });
    return middle;
  }

  void split(std::size_t node, std::vector<Reference>& all, std::size_t begin, std::size_t end, int depth, const Box& box) {
    const std::size_t cut = partition(all, begin, end, depth, box, false);
    result_.statistics.sahCost += static_cast<double>(box.halfArea() / rootArea_);
    for (const int side : {0, 1}) {
      const std::size_t from = side ? cut : begin, to = side ? end : cut, count = to - from;
      Box childBox;
      for (std::size_t i = from; i < to; ++i) childBox.add(all[i].box);
      const bool small = count <= static_cast<std::size_t>(settings_.leafTriangles);
      if (small && (count == 1 || partition(all, from, to, depth + 1, childBox, true) == to)) {
        setChild(node, side, childBox, makeLeaf(all, from, to, depth + 1));
        result_.statistics.sahCost += static_cast<double>(childBox.halfArea() / rootArea_) * static_cast<double>(count);
      } else {
        const std::size_t child = result_.nodes.size();
        result_.nodes.emplace_back();
        setChild(node, side, childBox, static_cast<std::uint32_t>(child));
        split(child, all, from, to, depth + 1, childBox);
      }
    }
  }

  BvhSettings settings_;
  Bvh& result_;
  std::vector<BvhTriangle> kept_;
  std::vector<Reference> references_;
  float padding_ = 0.0f, rootArea_ = 0.0f;
};

}  // namespace

Bvh buildBvh(const Scene& scene, const BvhSettings& settings) {
  CHECK(settings.leafTriangles >= 1 && settings.leafTriangles <= 16, "{} triangles a leaf", settings.leafTriangles);
  const auto start = std::chrono::steady_clock::now();
  Bvh bvh;
  Builder(scene, settings, bvh).build();
  bvh.statistics.nodes = bvh.nodes.size();
  bvh.statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return bvh;
}

}  // namespace lucerna
