#include "rays/bvh.hpp"

#include "base/clock.hpp"
#include "scene/place.hpp"

#include "base/error.hpp"
#include "base/stop_watch.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <future>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <thread>
#include <utility>

namespace lucerna {

namespace detail {
struct BvhBox {
  glm::vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};
  void add(const glm::vec3& p) { min = glm::min(min, p), max = glm::max(max, p); }
  void add(const BvhBox& b) { min = glm::min(min, b.min), max = glm::max(max, b.max); }
  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  double halfArea() const {
    const glm::dvec3 e = glm::dvec3(max) - glm::dvec3(min);
    return empty() ? 0.0 : e.x * e.y + e.y * e.z + e.z * e.x;
  }
  glm::vec3 centre() const { return 0.5f * min + 0.5f * max; }
};
}  // namespace detail

namespace {

using shared::BvhNode;
using shared::BvhTriangle;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// std::nextafter towards infinity, inline: a tenth of building went into its calls.
float nextAbove(float v) {
  if (v == 0.0f) return std::numeric_limits<float>::denorm_min();
  if (v == kInfinity) return v;
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(v) + (v > 0.0f ? 1 : -1));
}
constexpr int kBins = 16;
constexpr std::size_t kParallelFrom = 4096;  // fewer references are not worth another thread

using Box = detail::BvhBox;

Box intersection(const Box& a, const Box& b) { return {glm::max(a.min, b.min), glm::min(a.max, b.max)}; }

Box boxOf(const BvhTriangle& t) {
  Box box;
  box.add(t.a), box.add(t.b), box.add(t.c);
  return box;
}

// The box of the part of a triangle that lies in the reference's node.
struct Reference {
  Box box;
  std::uint32_t triangle;
};

// Corners may be arbitrary; kept triangles are finite and have an area.
bool hasArea(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 n = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  return std::isfinite(sum) && sum > 0.0;
}

// The plane of the corners as they are kept, from doubles: in a sliver floats would turn it.
void addPlane(BvhTriangle& t) {
  const glm::dvec3 n = glm::cross(glm::dvec3(t.b) - glm::dvec3(t.a), glm::dvec3(t.c) - glm::dvec3(t.a)), size = abs(n);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  t.id |= static_cast<std::uint32_t>(axis) << BVH_TRIANGLE_AXIS_SHIFT;
  t.normal1 = static_cast<float>(n[(axis + 1) % 3] / n[axis]);
  t.normal2 = static_cast<float>(n[(axis + 2) % 3] / n[axis]);
}

/// Moves a triangle of the scene into the hierarchy's space, about that origin.
void moveInto(BvhTriangle& triangle, const glm::dvec3& origin) {
  for (glm::vec3* corner : {&triangle.a, &triangle.b, &triangle.c}) *corner = glm::vec3(glm::dvec3(*corner) - origin);
  addPlane(triangle);
}

std::uint32_t flagsOf(const Material& material) {
  return (material.alphaMasked ? BVH_TRIANGLE_MASKED : 0u) |
         (material.emission != decltype(material.emission)(0.0f) ? BVH_TRIANGLE_EMISSIVE : 0u);
}

std::array<glm::vec3, 3> cornersOf(const Scene& scene, std::size_t triangle) {
  const auto corner = [&](std::size_t k) { return scene.vertices[scene.indices[3 * triangle + k]].position; };
  return {corner(0), corner(1), corner(2)};
}

// The triangles that rays can hit, in the space of the hierarchy, in the order of the scene.
struct Triangles {
  std::vector<BvhTriangle> kept;
  std::vector<std::uint32_t> parts;  // of each, if any mesh moves: 0 at rest, else 1 + the number of its moving mesh
  glm::dvec3 origin;
  float magnitude = 0.0f;
};

Triangles collect(const Scene& scene, std::span<const std::size_t> moving) {
  Triangles result;
  std::vector<std::uint32_t> flags(scene.triangleCount(), 0u);
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    std::fill_n(flags.begin() + mesh.firstIndex / 3, mesh.indexCount / 3, flagsOf(material));
  }
  Box bounds;
  for (std::size_t t = 0; t < scene.triangleCount(); ++t) {
    BvhTriangle triangle{};
    const std::array<glm::vec3, 3> corners = cornersOf(scene, t);
    triangle.a = corners[0], triangle.b = corners[1], triangle.c = corners[2];
    if (!hasArea(triangle.a, triangle.b, triangle.c)) continue;
    triangle.id = static_cast<std::uint32_t>(t) | flags[t];
    bounds.add(boxOf(triangle));
    result.kept.push_back(triangle);
  }
  if (!moving.empty()) {
    std::vector<std::uint32_t> part(scene.triangleCount(), 0u);
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Mesh& mesh = scene.meshes[moving[k]];
      std::fill_n(part.begin() + mesh.firstIndex / 3, mesh.indexCount / 3, static_cast<std::uint32_t>(k + 1));
    }
    for (const BvhTriangle& triangle : result.kept) result.parts.push_back(part[triangle.id & BVH_TRIANGLE_ID_MASK]);
  }
  result.origin = floatingOrigin({glm::dvec3(bounds.min), glm::dvec3(bounds.max)});
  for (BvhTriangle& triangle : result.kept) {
    moveInto(triangle, result.origin);
    for (const glm::vec3& corner : {triangle.a, triangle.b, triangle.c})
      for (int k = 0; k < 3; ++k) result.magnitude = std::max(result.magnitude, std::abs(corner[k]));
  }
  return result;
}

// ---------------------------------------------------------------------------------------------------- binary hierarchy

struct BinaryNode {
  Box box;
  std::uint32_t left = 0, right = 0;  // 0, 0: a leaf of one reference
  std::uint32_t triangle = 0;
  std::uint32_t references = 1;  // of the subtree
  bool leaf() const { return right == 0; }
};

class BinaryBuilder {
 public:
  BinaryBuilder(const Triangles& scene, const BvhSettings& settings) : triangles_(scene.kept), parts_(scene.parts) {
    spareThreads_ = (settings.threads > 0 ? settings.threads
                                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))) -
                    1;
    std::vector<Reference> all;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      all.push_back({boxOf(triangles_[i]), static_cast<std::uint32_t>(i)});
      rootBox_.add(all.back().box);
    }
    const auto spare = static_cast<std::size_t>(settings.splitBudget * static_cast<double>(all.size()));
    nodes_.resize(std::max<std::size_t>(1, 2 * (all.size() + spare)));
    if (!all.empty()) build(std::move(all), spare, 1, !parts_.empty());
  }
  /// 0 is the root.
  const std::vector<BinaryNode>& nodes() const { return nodes_; }

 private:
  struct Cut {
    double cost = std::numeric_limits<double>::infinity();
    int axis = -1, bin = 0;
    Box left, right;
  };

  static Box boxOfAll(const std::vector<Reference>& references) {
    Box box;
    for (const Reference& r : references) box.add(r.box);
    return box;
  }

  // mixed: the references may be of several parts of the scene.
  std::uint32_t build(std::vector<Reference> references, std::size_t spare, int depth, bool mixed) {
    // Threads beside this one have no watch of their own: they see its answer.
    constexpr std::size_t kLong = 1024;  // references
    if (references.size() > kLong) {
      constexpr const char* kWhat = "building the ray hierarchy";
      if (isStopped_ ||
          StopWatch::wantsStop({kWhat, static_cast<double>(used_) / static_cast<double>(nodes_.size())})) {
        isStopped_ = true;
        throw Stopped(std::string("stopped while ") + kWhat + "; nothing of it is kept");
      }
    }
    const std::uint32_t index = used_++;
    BinaryNode& node = nodes_[index];
    node.box = boxOfAll(references);
    if (references.size() == 1) {
      node.triangle = references[0].triangle;
      return index;
    }
    std::vector<Reference> left, right;
    const bool apart = mixed && divideParts(references, left, right);
    if (mixed && !apart && parts_[references[0].triangle] != 0) spare = 0;  // boxes of clipped triangles do not move
    if (!apart) divide(references, node.box, spare, depth, left, right);
    const std::size_t added = left.size() + right.size() - references.size();
    CHECK(!left.empty() && !right.empty() && added <= spare, "{} + {} references of {}, {} to spare", left.size(),
          right.size(), references.size(), spare);
    references = {};
    const std::size_t leftSpare = apart ? spare : (spare - added) * left.size() / (left.size() + right.size()),
                      rightSpare = spare - added - leftSpare;
    std::future<std::uint32_t> other;
    if (left.size() >= kParallelFrom && right.size() >= kParallelFrom && spareThreads_.fetch_sub(1) > 0) {
      other = std::async(std::launch::async, [&] { return build(std::move(left), leftSpare, depth + 1, apart); });
      node.right = build(std::move(right), rightSpare, depth + 1, apart);
      node.left = other.get();
      ++spareThreads_;
    } else {
      if (left.size() >= kParallelFrom && right.size() >= kParallelFrom) ++spareThreads_;
      node.left = build(std::move(left), leftSpare, depth + 1, apart);
      node.right = build(std::move(right), rightSpare, depth + 1, apart);
    }
    node.references = nodes_[node.left].references + nodes_[node.right].references;
    return index;
  }

  // [Wald2007]
  static int binOf(float centre, float low, float width) {
    return std::clamp(static_cast<int>((centre - low) / width * static_cast<float>(kBins)), 0, kBins - 1);
  }

  static Cut bestObjectCut(const std::vector<Reference>& references, const Box& centres) {
    Cut best;
    for (int axis = 0; axis < 3; ++axis) {
      const float low = centres.min[axis], width = centres.max[axis] - low;
      if (!(width > 0.0f)) continue;
      std::array<Box, kBins> boxes{};
      std::array<std::size_t, kBins> counts{};
      for (const Reference& r : references) {
        const auto bin = static_cast<std::size_t>(binOf(r.box.centre()[axis], low, width));
        boxes[bin].add(r.box);
        ++counts[bin];
      }
      improve(best, axis, boxes, counts, counts);
    }
    return best;
  }

  // `enter`: number of references that begin in a bin, `leave`: number that end there.
  static void improve(Cut& best, int axis, const std::array<Box, kBins>& boxes,
                      const std::array<std::size_t, kBins>& enter, const std::array<std::size_t, kBins>& leave) {
    std::array<Box, kBins> rightBoxes{};
    std::array<std::size_t, kBins> rightCounts{};
    Box sum;
    std::size_t n = 0;
    for (std::size_t b = kBins - 1; b > 0; --b) {
      sum.add(boxes[b]), n += leave[b];
      rightBoxes[b] = sum, rightCounts[b] = n;
    }
    sum = {}, n = 0;
    for (std::size_t b = 0; b + 1 < kBins; ++b) {
      sum.add(boxes[b]), n += enter[b];
      if (n == 0 || rightCounts[b + 1] == 0) continue;
      const double cost = sum.halfArea() * static_cast<double>(n) +
                          rightBoxes[b + 1].halfArea() * static_cast<double>(rightCounts[b + 1]);
      if (cost < best.cost) best = {cost, axis, static_cast<int>(b), sum, rightBoxes[b + 1]};
    }
  }

  // The boxes of a reference's parts between ascending planes across an axis, rounded outwards. A part is empty if only
  // rounding put it there.
  void clip(const Reference& r, int axis, std::span<const float> planes, std::span<Box> parts) const {
    const BvhTriangle& t = triangles_[r.triangle];
    const std::array<glm::dvec3, 3> corners{t.a, t.b, t.c};
    double min[kBins][3], max[kBins][3];
    for (std::size_t k = 0; k < parts.size(); ++k)
      for (int c = 0; c < 3; ++c) min[k][c] = 1e300, max[k][c] = -1e300;
    const auto add = [&](std::size_t k, const glm::dvec3& p) {
      if (k >= parts.size()) return;  // above the last plane, or below the first, where k - 1 wraps around
      for (int c = 0; c < 3; ++c) min[k][c] = std::min(min[k][c], p[c]), max[k][c] = std::max(max[k][c], p[c]);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 &p = corners[i], &q = corners[(i + 1) % 3];
      const double low = std::min(p[axis], q[axis]), high = std::max(p[axis], q[axis]);
      for (std::size_t k = 0; k < planes.size(); ++k) {
        const double plane = planes[k];
        if (p[axis] >= plane && k < parts.size() && p[axis] <= planes[k + 1]) add(k, p);
        if (low < plane && plane < high) {
          glm::dvec3 x = p + (plane - p[axis]) / (q[axis] - p[axis]) * (q - p);
          x[axis] = plane;
          add(k - 1, x), add(k, x);
        }
      }
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
      Box box;
      for (int c = 0; c < 3; ++c) {
        box.min[c] = -nextAbove(static_cast<float>(-min[k][c]));
        box.max[c] = nextAbove(static_cast<float>(max[k][c]));
      }
      Box slab = r.box;
      slab.min[axis] = std::max(slab.min[axis], planes[k]), slab.max[axis] = std::min(slab.max[axis], planes[k + 1]);
      parts[k] = intersection(box, slab);
    }
  }

  static float plane(const Box& box, int axis, int k) {
    if (k <= 0) return box.min[axis];
    if (k >= kBins) return box.max[axis];
    return static_cast<float>(box.min[axis] + (static_cast<double>(box.max[axis]) - box.min[axis]) * k / kBins);
  }

  // [Stich2009 section 4.1]
  Cut bestSpatialCut(const std::vector<Reference>& references, const Box& box) const {
    Cut best;
    for (int axis = 0; axis < 3; ++axis) {
      const float low = box.min[axis], width = box.max[axis] - low;
      if (!(width > 0.0f)) continue;
      std::array<Box, kBins> boxes{};
      std::array<std::size_t, kBins> enter{}, leave{};
      std::array<Box, kBins> parts;
      std::array<float, kBins + 1> planes;
      for (int k = 0; k <= kBins; ++k) planes[static_cast<std::size_t>(k)] = plane(box, axis, k);
      for (const Reference& r : references) {
        const auto first = static_cast<std::size_t>(binOf(r.box.min[axis], low, width)),
                   last = std::max(first, static_cast<std::size_t>(binOf(r.box.max[axis], low, width)));
        ++enter[first], ++leave[last];
        if (first == last) {
          boxes[first].add(r.box);
          continue;
        }
        const std::size_t count = last - first + 1;
        clip(r, axis, std::span(planes).subspan(first, count + 1), std::span(parts).first(count));
        for (std::size_t k = 0; k < count; ++k)
          if (!parts[k].empty()) boxes[first + k].add(parts[k]);
      }
      improve(best, axis, boxes, enter, leave);
    }
    return best;
  }

  // Splits references crossed by the plane if that costs less than keeping them on one side [Stich2009 section 4.4].
  bool divideInSpace(const std::vector<Reference>& references, const Box& box, const Cut& cut, std::size_t spare,
                     std::vector<Reference>& left, std::vector<Reference>& right) const {
    const float at = plane(box, cut.axis, cut.bin + 1);
    Box leftBox = cut.left, rightBox = cut.right;
    std::vector<const Reference*> crossing;
    for (const Reference& r : references) {
      if (r.box.max[cut.axis] <= at) left.push_back(r), leftBox.add(r.box);
      else if (r.box.min[cut.axis] >= at) right.push_back(r), rightBox.add(r.box);
      else crossing.push_back(&r);
    }
    std::size_t nLeft = left.size() + crossing.size(), nRight = right.size() + crossing.size();
    for (const Reference* r : crossing) {
      Box leftWhole = leftBox, rightWhole = rightBox;
      leftWhole.add(r->box), rightWhole.add(r->box);
      const auto cost = [](const Box& a, std::size_t n, const Box& b, std::size_t m) {
        return a.halfArea() * static_cast<double>(n) + b.halfArea() * static_cast<double>(m);
      };
      const double both = cost(leftBox, nLeft, rightBox, nRight),
                   onlyLeft = cost(leftWhole, nLeft, rightBox, nRight - 1),
                   onlyRight = cost(leftBox, nLeft - 1, rightWhole, nRight);
      std::array<Box, 2> parts;
      if (both < std::min(onlyLeft, onlyRight) && spare > 0)
        clip(*r, cut.axis, std::array{r->box.min[cut.axis], at, r->box.max[cut.axis]}, parts);
      if (!parts[0].empty() && !parts[1].empty()) {
        left.push_back({parts[0], r->triangle}), right.push_back({parts[1], r->triangle});
        --spare;
      } else if (onlyLeft < onlyRight) {
        left.push_back(*r), leftBox = leftWhole, --nRight;
      } else {
        right.push_back(*r), rightBox = rightWhole, --nLeft;
      }
    }
    const bool good =
        !left.empty() && !right.empty() && left.size() < references.size() && right.size() < references.size();
    if (!good) left.clear(), right.clear();
    return good;
  }

  // The top level, over the parts of a scene that moves: what is at rest, then half of the moving meshes, in their
  // order along the longest axis. False if all references are of one part.
  bool divideParts(const std::vector<Reference>& references, std::vector<Reference>& left,
                   std::vector<Reference>& right) const {
    std::map<std::uint32_t, Box> boxes;
    Box centres;
    for (const Reference& r : references) boxes[parts_[r.triangle]].add(r.box);
    if (boxes.size() == 1) return false;
    for (const auto& [part, box] : boxes) centres.add(box.centre());
    const glm::vec3 e = centres.max - centres.min;
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    std::vector<std::pair<float, std::uint32_t>> order;
    for (const auto& [part, box] : boxes)
      if (part != 0) order.emplace_back(box.centre()[axis], part);
    std::sort(order.begin(), order.end());
    std::set<std::uint32_t> first{0u};
    for (std::size_t k = 0; !boxes.contains(0u) && k < order.size() / 2; ++k) first.insert(order[k].second);
    for (const Reference& r : references) (first.contains(parts_[r.triangle]) ? left : right).push_back(r);
    return true;
  }

  void divide(std::vector<Reference>& references, const Box& box, std::size_t spare, int depth,
              std::vector<Reference>& left, std::vector<Reference>& right) const {
    Box centres;
    for (const Reference& r : references) centres.add(r.box.centre());
    // Halve once only halving keeps the depth below its bound.
    const bool deep = depth + 1 + static_cast<int>(std::bit_width(references.size() + spare)) >= BVH_MAX_DEPTH;
    if (!deep) {
      const Cut object = bestObjectCut(references, centres);
      const Box both = object.axis >= 0 ? intersection(object.left, object.right) : box;
      if (spare > 0 && !both.empty() && both.halfArea() > 1e-5 * rootBox_.halfArea()) {
        const Cut space = bestSpatialCut(references, box);
        if (space.cost < object.cost && divideInSpace(references, box, space, spare, left, right)) return;
      }
      if (object.axis >= 0) {
        const float low = centres.min[object.axis], width = centres.max[object.axis] - low;
        for (const Reference& r : references)
          (binOf(r.box.centre()[object.axis], low, width) <= object.bin ? left : right).push_back(r);
        return;
      }
    }
    const glm::vec3 e = centres.max - centres.min;
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    const auto middle = references.begin() + static_cast<std::ptrdiff_t>(references.size() / 2);
    std::nth_element(references.begin(), middle, references.end(), [&](const Reference& a, const Reference& b) {
      const float ca = a.box.centre()[axis], cb = b.box.centre()[axis];
      return ca != cb ? ca < cb : a.triangle < b.triangle;
    });
    left.assign(references.begin(), middle), right.assign(middle, references.end());
  }

  const std::vector<BvhTriangle>& triangles_;
  const std::vector<std::uint32_t>& parts_;
  Box rootBox_;
  std::vector<BinaryNode> nodes_;
  std::atomic<std::uint32_t> used_{0};
  std::atomic<int> spareThreads_{0};
  std::atomic<bool> isStopped_{false};
};

// ---------------------------------------------------------------------------------------------------- eight children

// Writes the boxes of a node's children; a missing child has an empty box.
void encodeBoxes(BvhNode& node, const std::array<Box, BVH_WIDTH>& children) {
  Box all;
  for (const Box& child : children) all.add(child);
  if (all.empty()) all.add(glm::vec3(0.0f));
  node.origin = all.min;
  node.exponents &= 0xff000000u;
  std::fill(std::begin(node.low), std::end(node.low), 0u), std::fill(std::begin(node.high), std::end(node.high), 0u);
  for (int axis = 0; axis < 3; ++axis) {
    // Boxes of one grid are exact in double: a float plus 0..255 times a power of two.
    const double extent = static_cast<double>(all.max[axis]) - all.min[axis];
    int exponent = -126;
    if (extent > 0.0) {
      const double mantissa = std::frexp(extent / 255.0, &exponent);  // of 0.5 to 1: the logarithm, rounded up
      exponent = std::clamp(mantissa > 0.5 ? exponent : exponent - 1, -126, 126);
    }
    while (std::ldexp(255.0, exponent) < extent) ++exponent;
    node.exponents |= static_cast<std::uint32_t>(exponent + 127) << 8 * axis;
    const double perStep = std::ldexp(1.0, -exponent);
    for (std::size_t k = 0; k < BVH_WIDTH; ++k) {
      if (children[k].empty()) continue;
      const auto steps = [&](float x) { return (static_cast<double>(x) - all.min[axis]) * perStep; };
      const auto low = static_cast<std::uint32_t>(std::clamp(std::floor(steps(children[k].min[axis])), 0.0, 255.0));
      const auto high = static_cast<std::uint32_t>(std::clamp(std::ceil(steps(children[k].max[axis])), 0.0, 255.0));
      const std::size_t word = 2 * static_cast<std::size_t>(axis) + k / 4, shift = 8 * (k % 4);
      node.low[word] |= low << shift;
      node.high[word] |= high << shift;
    }
  }
}

// Chooses which nodes of the binary hierarchy become wide nodes and leaves, for the least expected cost [Ylitie2017
// section 3.1].
class Collapse {
 public:
  Collapse(const std::vector<BinaryNode>& binary, const std::vector<BvhTriangle>& triangles, Bvh& result)
      : binary_(binary), triangles_(triangles), result_(result) {
    result_.nodes.emplace_back();
    result_.statistics.depth = 1;
    if (triangles.empty()) {
      encodeBoxes(result_.nodes[0], {});
      return;
    }
    choices_.resize(binary.size());
    choose(0);
    emit(0, 0, 1);
  }

 private:
  static constexpr std::size_t kMaxRoots = BVH_WIDTH - 1;
  // cost[i - 1]: of a subtree as a forest of at most i trees; left[i - 1]: how many of those are in its left child, 0:
  // one tree fewer is as good.
  struct Choice {
    std::array<float, kMaxRoots> cost;
    std::array<std::uint8_t, kMaxRoots> left;
    std::uint8_t childrenOfLeft;  // of the eight that it has as a wide node
    bool leaf;
  };

  void choose(std::uint32_t n) {
    const BinaryNode& node = binary_[n];
    Choice& c = choices_[n];
    const auto area = static_cast<float>(node.box.halfArea());
    const float leafCost =
        node.references <= BVH_MAX_LEAF ? area * static_cast<float>(node.references) * kBvhTriangleCost : kInfinity;
    if (node.leaf()) {
      c.cost.fill(leafCost), c.left.fill(0), c.leaf = true;
      return;
    }
    choose(node.left), choose(node.right);
    const Choice &l = choices_[node.left], &r = choices_[node.right];
    const auto distribute = [&](std::size_t roots) {
      std::pair<float, std::size_t> best{kInfinity, 0};
      for (std::size_t k = 1; k < roots; ++k)
        if (k <= kMaxRoots && roots - k <= kMaxRoots)
          best = std::min(best, std::pair{l.cost[k - 1] + r.cost[roots - k - 1], k});
      return best;
    };
    const auto [childrenCost, childrenOfLeft] = distribute(BVH_WIDTH);
    c.childrenOfLeft = static_cast<std::uint8_t>(childrenOfLeft);
    c.leaf = leafCost <= childrenCost + area;
    c.cost[0] = c.leaf ? leafCost : childrenCost + area;
    c.left[0] = 0;
    for (std::size_t i = 2; i <= kMaxRoots; ++i) {
      const auto [cost, left] = distribute(i);
      const bool better = cost < c.cost[i - 2];
      c.cost[i - 1] = better ? cost : c.cost[i - 2];
      c.left[i - 1] = better ? static_cast<std::uint8_t>(left) : 0;
    }
  }

  // The roots of a subtree's forest of at most `roots` trees.
  void gather(std::uint32_t n, std::size_t roots, std::vector<std::uint32_t>& out) const {
    const Choice& c = choices_[n];
    while (roots > 1 && c.left[roots - 1] == 0) --roots;
    if (roots == 1) return out.push_back(n);
    gather(binary_[n].left, c.left[roots - 1], out);
    gather(binary_[n].right, roots - c.left[roots - 1], out);
  }

  void gatherTriangles(std::uint32_t n, std::vector<std::uint32_t>& out) const {
    if (binary_[n].leaf()) return out.push_back(binary_[n].triangle);
    gatherTriangles(binary_[n].left, out), gatherTriangles(binary_[n].right, out);
  }

  // A child's slot determines when rays visit it. Rays whose direction has the signs s = slot bits (4: x, 2: y, 1: z;
  // set: negative) visit it first, so it should lie far back against such directions. Assigned greedily by the gain of
  // each slot.
  std::array<int, BVH_WIDTH> arrange(const std::vector<std::uint32_t>& children, const Box& box) const {
    std::array<int, BVH_WIDTH> childAt;
    childAt.fill(-1);
    std::vector<bool> placed(children.size(), false);
    for (std::size_t round = 0; round < children.size(); ++round) {
      float best = kInfinity;
      std::size_t bestChild = 0, bestPlace = 0;
      for (std::size_t i = 0; i < children.size(); ++i) {
        if (placed[i]) continue;
        const glm::vec3 d = binary_[children[i]].box.centre() - box.centre();
        for (std::size_t place = 0; place < BVH_WIDTH; ++place) {
          if (childAt[place] >= 0) continue;
          const float cost = (place & 4 ? -d.x : d.x) + (place & 2 ? -d.y : d.y) + (place & 1 ? -d.z : d.z);
          if (cost < best || best == kInfinity) best = cost, bestChild = i, bestPlace = place;
        }
      }
      placed[bestChild] = true;
      childAt[bestPlace] = static_cast<int>(bestChild);
    }
    return childAt;
  }

  void emit(std::uint32_t n, std::size_t index, int depth) {
    const Choice& c = choices_[n];
    std::vector<std::uint32_t> children;
    if (c.leaf) {
      children.push_back(n);  // the root alone: everything fits in one leaf
    } else {
      gather(binary_[n].left, c.childrenOfLeft, children);
      gather(binary_[n].right, BVH_WIDTH - std::size_t{c.childrenOfLeft}, children);
    }
    CHECK(depth <= BVH_MAX_DEPTH && children.size() <= BVH_WIDTH, "depth {}, {} children", depth, children.size());
    BvhStatistics& statistics = result_.statistics;
    statistics.depth = std::max(statistics.depth, depth);
    const double rootArea = binary_[0].box.halfArea(),
                 area = rootArea > 0.0 ? binary_[n].box.halfArea() / rootArea : 1.0;
    statistics.sahCost += area;

    const std::array<int, BVH_WIDTH> childAt = arrange(children, binary_[n].box);
    BvhNode node{};
    node.firstChild = static_cast<std::uint32_t>(result_.nodes.size());
    node.firstTriangle = static_cast<std::uint32_t>(result_.triangles.size());
    std::array<Box, BVH_WIDTH> boxes;
    std::vector<std::uint32_t> inner;
    for (std::size_t k = 0; k < BVH_WIDTH; ++k) {
      if (childAt[k] < 0) continue;
      const std::uint32_t child = children[static_cast<std::size_t>(childAt[k])];
      boxes[k] = binary_[child].box;
      std::uint32_t meta = 0;
      if (choices_[child].leaf) {
        std::vector<std::uint32_t> leaf;
        gatherTriangles(child, leaf);
        // Two parts of one triangle in a leaf count as that triangle once.
        std::sort(leaf.begin(), leaf.end());
        leaf.erase(std::unique(leaf.begin(), leaf.end()), leaf.end());
        meta = ((1u << leaf.size()) - 1u) << 5 |
               (static_cast<std::uint32_t>(result_.triangles.size()) - node.firstTriangle);
        for (const std::uint32_t t : leaf) result_.triangles.push_back(triangles_[t]);
        ++statistics.leaves;
        statistics.sahCost += kBvhTriangleCost * static_cast<double>(leaf.size()) *
                              (rootArea > 0.0 ? boxes[k].halfArea() / rootArea : 1.0);
      } else {
        meta = 1u << 5 | static_cast<std::uint32_t>(24 + k);
        node.exponents |= 1u << (24 + k);
        inner.push_back(child);
      }
      node.meta[k / 4] |= meta << 8 * (k % 4);
    }
    encodeBoxes(node, boxes);
    result_.nodes[index] = node;
    result_.nodes.resize(result_.nodes.size() + inner.size());
    for (std::size_t i = 0; i < inner.size(); ++i) emit(inner[i], node.firstChild + i, depth + 1);
  }

  const std::vector<BinaryNode>& binary_;
  const std::vector<BvhTriangle>& triangles_;
  Bvh& result_;
  std::vector<Choice> choices_;
};

}  // namespace

Bvh buildBvh(const Scene& scene, const BvhSettings& settings) {
  const auto start = Clock::now();
  const Triangles triangles = collect(scene, settings.moving);
  Bvh bvh;
  bvh.origin = triangles.origin;
  bvh.magnitude = triangles.magnitude;
  const BinaryBuilder binary(triangles, settings);
  Collapse(binary.nodes(), triangles.kept, bvh);
  BvhStatistics& s = bvh.statistics;
  s.triangles = triangles.kept.size();
  s.degenerate = scene.triangleCount() - s.triangles;
  s.references = bvh.triangles.size();
  s.nodes = bvh.nodes.size();
  s.seconds = secondsSince(start);
  return bvh;
}

// What a hierarchy does not say: the way back from triangles to its leaves and from nodes to the root, and boxes of
// children before they were put on a grid, which would grow with each iteration.
struct BvhRefit::Index {
  std::vector<std::uint32_t> firstPlace;  ///< of the scene's triangle; those of the next one follow
  std::vector<std::uint32_t> places;  ///< in Bvh::triangles
  std::vector<std::uint32_t> leafOf;  ///< of a place: BVH_WIDTH * node + child
  std::vector<std::uint32_t> parentOf;  ///< of a node: likewise
  std::vector<std::array<Box, BVH_WIDTH>> children;  ///< of a node
  std::vector<Box> meshes;  ///< in the scene's coordinates, of the triangles that rays can hit
  double cost = 0.0, costAsBuilt = 0.0;  ///< half areas of all nodes
};

namespace {

constexpr std::uint32_t kNoNode = ~0u;

Box boxOf(const std::array<Box, BVH_WIDTH>& children) {
  Box box;
  for (const Box& child : children) box.add(child);
  return box;
}

/// A child's box on its node's grid, outwards to floats.
Box decoded(const BvhNode& node, std::size_t k) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const double step = std::ldexp(1.0, static_cast<int>(node.exponents >> 8 * axis & 0xffu) - 127);
    const std::size_t word = 2 * static_cast<std::size_t>(axis) + k / 4, shift = 8 * (k % 4);
    const double low = static_cast<double>(node.origin[axis]) + step * (node.low[word] >> shift & 0xffu),
                 high = static_cast<double>(node.origin[axis]) + step * (node.high[word] >> shift & 0xffu);
    box.min[axis] = static_cast<float>(low), box.max[axis] = static_cast<float>(high);
    if (static_cast<double>(box.min[axis]) > low) box.min[axis] = -nextAbove(-box.min[axis]);
    if (static_cast<double>(box.max[axis]) < high) box.max[axis] = nextAbove(box.max[axis]);
  }
  return box;
}

}  // namespace

Bounds boundsOfChild(const BvhNode& node, std::size_t child) {
  const Box box = decoded(node, child);
  Bounds bounds;
  bounds.add(glm::dvec3(box.min[0], box.min[1], box.min[2]));
  bounds.add(glm::dvec3(box.max[0], box.max[1], box.max[2]));
  return bounds;
}

BvhRefit::BvhRefit(const Bvh& bvh, const Scene& scene) : index_(std::make_unique<Index>()) {
  Index& index = *index_;
  index.firstPlace.assign(scene.triangleCount() + 1, 0u);
  for (const BvhTriangle& triangle : bvh.triangles) ++index.firstPlace[(triangle.id & BVH_TRIANGLE_ID_MASK) + 1];
  for (std::size_t t = 0; t < scene.triangleCount(); ++t) index.firstPlace[t + 1] += index.firstPlace[t];
  index.places.resize(bvh.triangles.size());
  std::vector<std::uint32_t> next = index.firstPlace;
  for (std::size_t i = 0; i < bvh.triangles.size(); ++i)
    index.places[next[bvh.triangles[i].id & BVH_TRIANGLE_ID_MASK]++] = static_cast<std::uint32_t>(i);

  index.leafOf.resize(bvh.triangles.size());
  index.parentOf.assign(bvh.nodes.size(), kNoNode);
  index.children.resize(bvh.nodes.size());
  for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
    const BvhNode& node = bvh.nodes[n];
    std::size_t child = node.firstChild;
    for (std::size_t k = 0; k < BVH_WIDTH; ++k) {
      const std::uint32_t meta = node.meta[k / 4] >> 8 * (k % 4) & 0xffu,
                          own = static_cast<std::uint32_t>(BVH_WIDTH * n + k);
      if (meta == 0) continue;
      index.children[n][k] = decoded(node, k);
      if (node.exponents >> (24 + k) & 1u) {
        index.parentOf[child++] = own;
      } else {
        for (std::uint32_t bits = meta >> 5, t = node.firstTriangle + (meta & 31u); bits; bits >>= 1, ++t)
          index.leafOf[t] = own;
      }
    }
    index.costAsBuilt += boxOf(index.children[n]).halfArea();
  }
  index.cost = index.costAsBuilt;
  index.meshes.resize(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (std::size_t t = scene.meshes[m].firstIndex / 3;
         t < (scene.meshes[m].firstIndex + scene.meshes[m].indexCount) / 3; ++t)
      if (index.firstPlace[t] != index.firstPlace[t + 1])
        for (const glm::vec3& corner : cornersOf(scene, t)) index.meshes[m].add(corner);
}

BvhRefit::~BvhRefit() = default;
BvhRefit::BvhRefit(BvhRefit&&) noexcept = default;
BvhRefit& BvhRefit::operator=(BvhRefit&&) noexcept = default;

bool BvhRefit::refit(Bvh& bvh, const Scene& scene, std::span<const std::size_t> meshes, Changed& changed) {
  Index& index = *index_;
  if (index.firstPlace.size() != scene.triangleCount() + 1 || index.meshes.size() != scene.meshes.size()) return false;

  // The triangles.
  std::vector<std::uint8_t> moves(bvh.triangles.size(), 0);
  for (const std::size_t m : meshes) {
    const Mesh& mesh = scene.meshes[m];
    const std::uint32_t flags = flagsOf(scene.materials[static_cast<std::size_t>(mesh.material)]);
    Box box;
    for (std::size_t t = mesh.firstIndex / 3; t < (mesh.firstIndex + mesh.indexCount) / 3; ++t) {
      const std::array<glm::vec3, 3> corners = cornersOf(scene, t);
      const std::uint32_t first = index.firstPlace[t], end = index.firstPlace[t + 1];
      if (hasArea(corners[0], corners[1], corners[2]) != (first != end)) return false;
      if (first == end) continue;
      BvhTriangle triangle{};
      triangle.a = corners[0], triangle.b = corners[1], triangle.c = corners[2];
      box.add(boxOf(triangle));
      triangle.id = static_cast<std::uint32_t>(t) | flags;
      moveInto(triangle, bvh.origin);
      for (std::uint32_t i = first; i < end; ++i) {
        bvh.triangles[index.places[i]] = triangle;
        moves[index.places[i]] = 1;
      }
    }
    index.meshes[m] = box;
  }
  Box all;
  for (const Box& mesh : index.meshes) all.add(mesh);
  if (floatingOrigin({glm::dvec3(all.min), glm::dvec3(all.max)}) != bvh.origin) return false;
  bvh.magnitude = 0.0f;
  if (!all.empty())
    for (const glm::vec3& corner : {all.min, all.max})
      for (int k = 0; k < 3; ++k)
        bvh.magnitude =
            std::max(bvh.magnitude, std::abs(static_cast<float>(static_cast<double>(corner[k]) - bvh.origin[k])));

  // Their leaves, and the nodes above, children before their parents, whose numbers are less.
  std::vector<bool> isOther(bvh.nodes.size(), false);
  std::uint32_t last = kNoNode;
  for (std::size_t place = 0; place < moves.size(); ++place) {
    const std::uint32_t leaf = index.leafOf[place];
    if (!moves[place] || leaf == last) continue;
    last = leaf;
    const std::size_t n = leaf / BVH_WIDTH, k = leaf % BVH_WIDTH;
    const BvhNode& node = bvh.nodes[n];
    const std::uint32_t meta = node.meta[k / 4] >> 8 * (k % 4) & 0xffu;
    if (!isOther[n]) index.cost -= boxOf(index.children[n]).halfArea();
    isOther[n] = true;
    Box& box = index.children[n][k];
    box = {};
    for (std::uint32_t bits = meta >> 5, t = node.firstTriangle + (meta & 31u); bits; bits >>= 1, ++t)
      box.add(boxOf(bvh.triangles[t]));
  }
  for (std::size_t n = bvh.nodes.size(); n-- > 0;) {
    if (!isOther[n]) continue;
    encodeBoxes(bvh.nodes[n], index.children[n]);
    changed.nodes.push_back(static_cast<std::uint32_t>(n));
    const Box box = boxOf(index.children[n]);
    index.cost += box.halfArea();
    if (index.parentOf[n] == kNoNode) continue;
    const std::size_t parent = index.parentOf[n] / BVH_WIDTH;
    Box& there = index.children[parent][index.parentOf[n] % BVH_WIDTH];
    if (there.min == box.min && there.max == box.max) continue;
    if (!isOther[parent]) index.cost -= boxOf(index.children[parent]).halfArea();
    isOther[parent] = true;
    there = box;
  }
  std::ranges::reverse(changed.nodes);
  for (std::size_t place = 0; place < moves.size(); ++place)
    if (moves[place]) changed.triangles.push_back(static_cast<std::uint32_t>(place));
  return index.cost <= kMostGrowth * index.costAsBuilt;
}

}  // namespace lucerna
