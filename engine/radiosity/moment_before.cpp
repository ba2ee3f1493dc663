#include "radiosity/moment_before.hpp"

#include "base/hash.hpp"
#include "base/parallel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <unordered_map>
#include <utility>

namespace lucerna {

namespace {

constexpr std::uint32_t kNone = ~0u;
constexpr double kSlack = 1e-5;  // of the scene's extent
constexpr double kOpen = 1e-5;  // of a hemisphere: less is the rounding of its sum
constexpr std::size_t kMostBoxes = 16;

using Corners = std::array<glm::dvec3, 3>;

bool emits(const Patch& patch) { return patch.emission != glm::dvec3(0.0); }

std::uint64_t hashOf(const Corners& corners) {
  Hash hash;
  for (const glm::dvec3& corner : corners) hash.add(corner);
  return hash.value();
}

bool areSame(const RadiosityMesh& meshA, const Patch& a, const RadiosityMesh& meshB, const Patch& b) {
  return meshA.corners(a) == meshB.corners(b) && a.material == b.material && a.hidden == b.hidden &&
         emits(a) == emits(b);
}

/// Boxes around the patches that are not the same, one for each mesh of the scene; one for all of too many.
std::vector<Bounds> boxesAround(const Scene& scene, const RadiosityMesh& mesh, const std::vector<std::uint32_t>& same,
                                double slack) {
  std::vector<std::size_t> meshOfTriangle(scene.indices.size() / 3, 0);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (std::uint32_t t = 0; t < scene.meshes[m].indexCount / 3; ++t)
      meshOfTriangle[scene.meshes[m].firstIndex / 3 + t] = m;
  std::map<std::size_t, Bounds> ofMesh;
  for (std::size_t i = 0; i < same.size(); ++i)
    if (same[i] == kNone)
      for (const glm::dvec3& corner : mesh.corners(mesh.patches[i])) {
        ofMesh[meshOfTriangle[mesh.patches[i].triangle]].add(corner - slack);
        ofMesh[meshOfTriangle[mesh.patches[i].triangle]].add(corner + slack);
      }
  std::vector<Bounds> boxes;
  for (const auto& [m, box] : ofMesh) {
    if (ofMesh.size() <= kMostBoxes || boxes.empty()) boxes.push_back(box);
    else boxes.front().add(box);
  }
  return boxes;
}

/// The range of a box along a direction, from a point.
std::pair<double, double> rangeOf(const Bounds& box, const glm::dvec3& direction, const glm::dvec3& from) {
  const double middle = glm::dot(direction, box.centre() - from),
               half = glm::dot(glm::abs(direction), 0.5 * box.extent());
  return {middle - half, middle + half};
}

/// Whether a plane through a face of the tetrahedron, or a side of the box, separates them: what it says is true, but
/// not all that are apart are found.
bool areApart(const Bounds& box, const std::array<glm::dvec3, 4>& tetrahedron) {
  Bounds around;
  for (const glm::dvec3& corner : tetrahedron) around.add(corner);
  if (glm::any(glm::lessThan(around.max, box.min)) || glm::any(glm::lessThan(box.max, around.min))) return true;
  for (std::size_t k = 0; k < 4; ++k) {
    const glm::dvec3 &a = tetrahedron[k], &b = tetrahedron[(k + 1) % 4], &c = tetrahedron[(k + 2) % 4],
                     &fourth = tetrahedron[(k + 3) % 4];
    glm::dvec3 outwards = glm::cross(b - a, c - a);
    if (glm::dot(outwards, fourth - a) > 0.0) outwards = -outwards;
    if (rangeOf(box, outwards, a).first > 0.0) return true;
  }
  return false;
}

bool meets(const Bounds& box, const glm::dvec3& from, const glm::dvec3& to) {
  double enters = 0.0, leaves = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double a = (box.min[k] - from[k]) / (to[k] - from[k]), b = (box.max[k] - from[k]) / (to[k] - from[k]);
    if (from[k] == to[k] && (from[k] < box.min[k] || from[k] > box.max[k])) return false;
    if (from[k] == to[k]) continue;
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters <= leaves;
}

/// Whether a segment passes through a triangle, away from the triangle's edges and its own end.
bool passes(const Corners& c, const glm::dvec3& from, const glm::dvec3& to) {
  constexpr double kInside = 1e-6;
  const glm::dvec3 d = to - from, u = c[1] - c[0], v = c[2] - c[0], across = glm::cross(d, v);
  const double det = glm::dot(u, across);
  if (det == 0.0) return false;
  const glm::dvec3 start = from - c[0], side = glm::cross(start, u);
  const double a = glm::dot(start, across) / det, b = glm::dot(d, side) / det, t = glm::dot(v, side) / det;
  return a > kInside && b > kInside && a + b < 1.0 - kInside && t > 0.0 && t < 1.0 - kInside;
}

/// Patches that light reaches, over others or not: what is closed off from it is black, not dark within the error. All
/// if the rows are not at hand.
std::vector<bool> reachedByLight(const RadiositySystem& system) {
  const std::size_t count = system.areas.size();
  if (!system.matrix || !system.reciprocal) return std::vector<bool>(count, true);
  std::vector<bool> isReached(count, false);
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < count; ++i)
    if (system.emission[i] != glm::dvec3(0.0)) open.push_back(i), isReached[i] = true;
  while (!open.empty()) {
    const std::uint32_t from = open.back();
    open.pop_back();
    if (system.emission[from] == glm::dvec3(0.0) && system.reflectance[from] == glm::dvec3(0.0)) continue;
    for (const std::uint32_t to : system.matrix->row(from).patches)
      if (!isReached[to]) open.push_back(to), isReached[to] = true;
  }
  return isReached;
}

}  // namespace

glm::dvec3 emittedBy(const RadiositySystem& system) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < system.areas.size(); ++i) sum += system.areas[i] * system.emission[i];
  return sum;
}

MomentBefore::MomentBefore(const RadiosityMoment& before, const Scene& scene, const RadiosityMesh& mesh,
                           std::span<const std::uint32_t> sources)
    : before_(before), mesh_(mesh), slack_(kSlack * mesh.extent), rowHolds_(mesh.patches.size(), false) {
  findSamePatches();
  // Rows depend on the whole scene's extent and on which sources are small.
  if (!before.rows || before.mesh.extent != mesh.extent) return;
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (sources[i]) sources_.push_back(i);
    if (same_[i] != kNone && before.sources[same_[i]] != sources[i]) return;
  }
  gone_ = boxesAround(scene, before.mesh, now_, slack_);
  new_ = boxesAround(scene, mesh, same_, slack_);
  std::vector<std::uint8_t> hold(mesh.patches.size());  // threads cannot share the bytes of a vector of bools
  onAllCores(hold.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) hold[i] = holds(i);
  });
  rowHolds_.assign(hold.begin(), hold.end());
  isWhole_ = same_.size() == now_.size() && std::ranges::all_of(rowHolds_, std::identity());
  for (std::uint32_t i = 0; i < same_.size(); ++i) isWhole_ = isWhole_ && same_[i] == i;
}

void MomentBefore::findSamePatches() {
  same_.assign(mesh_.patches.size(), kNone);
  now_.assign(before_.mesh.patches.size(), kNone);
  std::unordered_multimap<std::uint64_t, std::uint32_t> known;
  for (std::uint32_t i = 0; i < now_.size(); ++i)
    known.emplace(hashOf(before_.mesh.corners(before_.mesh.patches[i])), i);
  for (std::uint32_t i = 0; i < same_.size(); ++i) {
    const Patch& patch = mesh_.patches[i];
    const auto [begin, end] = known.equal_range(hashOf(mesh_.corners(patch)));
    for (auto it = begin; it != end && same_[i] == kNone; ++it)
      if (now_[it->second] == kNone && areSame(mesh_, patch, before_.mesh, before_.mesh.patches[it->second])) {
        same_[i] = it->second;
        now_[it->second] = i;
      }
  }
}

bool MomentBefore::holds(std::size_t i) const {
  if (same_[i] == kNone) return false;
  const std::uint32_t old = same_[i];
  const std::span<const std::uint32_t> seen = before_.rows->row(old).patches;
  if (std::ranges::any_of(seen, [&](std::uint32_t j) { return now_[j] == kNone; })) return false;
  const Patch& patch = mesh_.patches[i];
  const auto isAbove = [&](const Bounds& box) { return rangeOf(box, patch.faceNormal, patch.centroid).second > 0.0; };
  // Backs are in no row: they may be of what is gone.
  const bool sawBacks = static_cast<double>(before_.backs[old]) > kOpen,
             wasOpen = static_cast<double>(before_.fronts[old]) < 1.0 - kOpen;
  if (sawBacks && std::ranges::any_of(gone_, isAbove)) return false;
  for (const Bounds& box : new_)
    if (isAbove(box) && (wasOpen || maySee(patch, box, seen))) return false;
  return !lacksASource(i, seen);
}

/// Whether a line from a closed hemicube to what it saw passes a box.
bool MomentBefore::maySee(const Patch& patch, const Bounds& box, std::span<const std::uint32_t> seen) const {
  return std::ranges::any_of(seen, [&](std::uint32_t j) {
    const Corners c = before_.mesh.corners(before_.mesh.patches[j]);
    return !areApart(box, {patch.centroid, c[0], c[1], c[2]});
  });
}

/// Rays find small sources between the pixels: whether one is not in the row that may be seen now, as it is new or
/// something that stood before it is gone.
bool MomentBefore::lacksASource(std::size_t i, std::span<const std::uint32_t> seen) const {
  const Patch& patch = mesh_.patches[i];
  return std::ranges::any_of(sources_, [&](std::uint32_t s) {
    if (same_[s] != kNone && std::ranges::binary_search(seen, same_[s])) return false;
    const Corners c = mesh_.corners(mesh_.patches[s]);
    const glm::dvec3 middle = (c[0] + c[1] + c[2]) / 3.0, away = middle - patch.centroid;
    if (glm::dot(away, patch.faceNormal) <= 0.0 || glm::dot(away, mesh_.patches[s].faceNormal) >= 0.0) return false;
    const auto isPassed = [&](const Bounds& box) { return meets(box, patch.centroid, middle); };
    if (same_[s] != kNone && std::ranges::none_of(gone_, isPassed)) return false;
    return !isBlocked(patch.centroid, middle, seen);
  });
}

bool MomentBefore::isBlocked(const glm::dvec3& from, const glm::dvec3& to, std::span<const std::uint32_t> seen) const {
  return std::ranges::any_of(
      seen, [&](std::uint32_t j) { return passes(before_.mesh.corners(before_.mesh.patches[j]), from, to); });
}

FormFactorRows MomentBefore::rows(std::size_t first, std::size_t end) const {
  FormFactorRows rows;
  rows.first = static_cast<int>(first);
  std::vector<std::pair<std::uint32_t, float>> entries;
  for (std::size_t i = first; i < end; ++i) {
    const std::uint32_t old = same_[i];
    const FormFactorMatrix::Row row = before_.rows->row(old);
    entries.clear();
    for (std::size_t k = 0; k < row.patches.size(); ++k) entries.emplace_back(now_[row.patches[k]], row.factors[k]);
    if (!std::ranges::is_sorted(entries)) std::ranges::sort(entries);
    for (const auto& [patch, factor] : entries) {
      rows.patches.push_back(patch);
      rows.factors.push_back(factor);
    }
    rows.counts.push_back(static_cast<std::uint32_t>(entries.size()));
    rows.fronts.push_back(before_.fronts[old]);
    rows.backs.push_back(before_.backs[old]);
  }
  return rows;
}

std::vector<glm::dvec3> MomentBefore::start(const RadiositySystem& system) const {
  glm::dvec3 change(0.0);
  const glm::dvec3 emitted = emittedBy(system);
  for (int c = 0; c < 3; ++c)
    if (before_.emitted[c] > 0.0) change[c] = emitted[c] / before_.emitted[c];
  struct Mean {
    glm::dvec3 flux{0.0};
    double area = 0.0;
  };
  std::map<std::pair<std::uint32_t, bool>, Mean> ofTriangle;  // and its side
  for (std::size_t j = 0; j < now_.size(); ++j) {
    const Patch& patch = before_.mesh.patches[j];
    Mean& mean = ofTriangle[{patch.triangle, patch.isBack}];
    mean.flux += patch.area * before_.irradiance[j];
    mean.area += patch.area;
  }
  std::vector<glm::dvec3> start;
  for (std::size_t i = 0; i < same_.size(); ++i) {
    const Mean mean = ofTriangle[{mesh_.patches[i].triangle, mesh_.patches[i].isBack}];
    const glm::dvec3 irradiance = same_[i] != kNone ? before_.irradiance[same_[i]]
                                  : mean.area > 0.0 ? mean.flux / mean.area
                                                    : glm::dvec3(0.0);
    start.push_back(change * irradiance);
  }
  const std::vector<bool> isReached = reachedByLight(system);
  for (std::size_t i = 0; i < start.size(); ++i)
    if (!isReached[i]) start[i] = glm::dvec3(0.0);
  return start;
}

}  // namespace lucerna
