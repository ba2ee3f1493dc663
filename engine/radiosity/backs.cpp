#include "radiosity/backs.hpp"

#include "radiosity/direct_light.hpp"
#include "radiosity/hidden_parts.hpp"
#include "scene/triangle_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace lucerna {

namespace {

constexpr int kMostRounds = 16;  // light that needs more turns of a corridor of turned walls is left out
constexpr std::size_t kParts = kPatchParts * kPatchParts;
/// A gap behind a lamp, in parts of its longest edge, from which nothing to speak of comes out.
constexpr double kLeastGap = 0.01;

using Winding = std::array<std::uint32_t, 3>;

/// The corners in their order, from the first of them.
Winding windingOf(const Patch& patch) {
  Winding w = patch.point;
  std::rotate(w.begin(), std::min_element(w.begin(), w.end()), w.end());
  return w;
}

Patch opposite(Patch patch) {
  std::swap(patch.point[1], patch.point[2]);
  std::swap(patch.texCoord[1], patch.texCoord[2]);
  std::swap(patch.normal[1], patch.normal[2]);
  for (glm::vec3& normal : patch.normal) normal = -normal;
  patch.faceNormal = -patch.faceNormal;
  patch.isBack = true;
  return patch;
}

class Backs {
 public:
  Backs(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, RadiosityMesh& mesh)
      : context_(context),
        programs_(programs),
        scene_(scene),
        mesh_(mesh),
        fronts_(mesh.patches.size()),
        isWanted_(scene.triangleCount(), false) {
    for (const Patch& patch : mesh.patches) there_.insert(windingOf(patch));
  }

  void add() {
    std::vector<std::uint32_t> emitters;
    for (std::uint32_t p = 0; p < fronts_; ++p)
      if (mesh_.patches[p].emission != glm::dvec3(0.0)) emitters.push_back(p);
    const bool lamps = scene_.sun || !scene_.spots.empty() || !scene_.points.empty();
    if (emitters.empty() && !lamps) return;
    std::vector<std::uint32_t> light = emitters;
    for (int round = 0; round < kMostRounds; ++round) {
      const RayScene rays(sceneOf(mesh_), context_.capabilities());
      if (round == 0) {
        isHidden_ = hiddenInTriangles(rays);
        for (const std::uint32_t p : litFromBehind(programs_, rays, scene_, mesh_)) want(p);
      }
      wantBacksSeenFrom(light, rays);
      wantLampsThatLightBehind(emitters, rays);
      const std::size_t before = mesh_.patches.size();
      addWanted();
      if (mesh_.patches.size() == before) break;
      light.clear();
      for (std::size_t p = before; p < mesh_.patches.size(); ++p) light.push_back(static_cast<std::uint32_t>(p));
    }
  }

 private:
  /// A bit per part of those that are hidden, compared with the most open part of their whole triangle: a patch may lie
  /// inside of a solid as a whole.
  std::vector<std::uint16_t> hiddenInTriangles(const RayScene& rays) const {
    const std::vector<float> open = opennessOfParts(programs_, rays, mesh_);
    std::vector<float> most(isWanted_.size(), 0.0f);
    for (std::size_t k = 0; k < open.size(); ++k) {
      float& ofTriangle = most[mesh_.patches[k / kParts].triangle];
      ofTriangle = std::max(ofTriangle, open[k]);
    }
    std::vector<std::uint16_t> hidden;
    for (std::size_t p = 0; p < fronts_; ++p)
      hidden.push_back(hiddenOf(std::span(open).subspan(p * kParts, kParts), most[mesh_.patches[p].triangle]));
    return hidden;
  }
  bool isHidden(std::uint32_t patch, std::size_t part) const {
    return patch < isHidden_.size() && (isHidden_[patch] >> part & 1) != 0;
  }
  /// Of a triangle of the scene, in scene units.
  double longestEdge(std::uint32_t triangle) const {
    const auto corner = [&](std::size_t k) {
      return glm::dvec3(scene_.vertices[scene_.indices[3 * triangle + k % 3]].position);
    };
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(corner(k), corner(k + 1)));
    return longest;
  }
  void want(std::uint32_t patch) { wanted_.insert(mesh_.patches[patch].triangle); }

  void wantBacksSeenFrom(const std::vector<std::uint32_t>& patches, const RayScene& rays) {
    const std::vector<PartMet> met = metFromParts(programs_, rays, mesh_, patches, 1, PatchSide::front);
    for (std::size_t k = 0; k < met.size(); ++k)
      if (met[k].isBack() && !isHidden(patches[k / kParts], k % kParts)) want(met[k].patch());
  }

  void wantLampsThatLightBehind(const std::vector<std::uint32_t>& emitters, const RayScene& rays) {
    // A part at the border of a solid is seen from inside too, so its centroid has to see the lamp's back.
    const std::vector<PartMet> met = metFromParts(programs_, rays, mesh_, emitters, 1, PatchSide::back);
    const std::vector<glm::dvec2> centroids = partCentroids(kPatchParts);
    const auto place = [&](const Patch& patch, std::size_t part) {
      const auto c = mesh_.corners(patch);
      return c[0] + centroids[part].x * (c[1] - c[0]) + centroids[part].y * (c[2] - c[0]);
    };
    std::vector<Segment> segments;
    for (std::size_t k = 0; k < met.size(); ++k) {
      if (!met[k].isFront() || isHidden(met[k].patch(), met[k].part())) continue;
      const Patch &lamp = mesh_.patches[emitters[k / kParts]], &lit = mesh_.patches[met[k].patch()];
      if (std::abs(glm::dot(lamp.centroid - lit.centroid, lit.faceNormal)) <= kLeastGap * longestEdge(lamp.triangle))
        continue;
      const glm::dvec3 to = place(lamp, k % kParts), from = place(lit, met[k].part());
      segments.push_back({glm::mix(from, to, 1e-4), to});
    }
    for (const std::uint32_t patch : backsMet(programs_, rays, segments))
      if (patch != kNoPatch && mesh_.patches[patch].emission != glm::dvec3(0.0)) want(patch);
  }

  void addWanted() {
    std::vector<Patch> added;
    for (std::size_t p = 0; p < fronts_; ++p) {
      const std::uint32_t triangle = mesh_.patches[p].triangle;
      if (!wanted_.contains(triangle) || isWanted_[triangle]) continue;
      const Patch back = opposite(mesh_.patches[p]);
      if (there_.insert(windingOf(back)).second) added.push_back(back);
    }
    for (const std::uint32_t triangle : wanted_) isWanted_[triangle] = true;
    wanted_.clear();
    mesh_.patches.insert(mesh_.patches.end(), added.begin(), added.end());
  }

  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  const Scene& scene_;
  RadiosityMesh& mesh_;
  std::size_t fronts_;
  std::vector<std::uint16_t> isHidden_;  ///< of the patches that were there
  std::vector<bool> isWanted_;  ///< triangles with both sides
  std::set<std::uint32_t> wanted_;  ///< triangles whose backs are still to be added
  std::set<Winding> there_;
};

double distanceTo(const std::array<glm::dvec3, 2>& edge, const glm::dvec3& point) {
  const glm::dvec3 along = edge[1] - edge[0], to = point - edge[0];
  return glm::length(to - std::clamp(glm::dot(to, along) / glm::dot(along, along), 0.0, 1.0) * along);
}

/// The edges around the lamps among the patches from `first` on.
std::vector<std::array<glm::dvec3, 2>> bordersOfLamps(const RadiosityMesh& mesh, std::size_t first) {
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (std::size_t p = first; p < mesh.patches.size(); ++p) {
    const Patch& patch = mesh.patches[p];
    if (patch.emission == glm::dvec3(0.0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = patch.point[k], b = patch.point[(k + 1) % 3];
      ++edges[{std::min(a, b), std::max(a, b)}];
    }
  }
  std::vector<std::array<glm::dvec3, 2>> borders;
  for (const auto& [edge, count] : edges)
    if (count == 1) borders.push_back({mesh.points[edge[0]], mesh.points[edge[1]]});
  return borders;
}

/// Cuts patches that are larger than their distance from the border of a lamp with two sides, down to an eighth of the
/// longest edge: of a large patch that a lamp covers in part, the part behind it is bright and the other sees the room.
void cutBehindLamps(const Scene& scene, RadiosityMesh& mesh, const PatchSettings& settings,
                    const std::vector<std::array<glm::dvec3, 2>>& borders) {
  if (borders.empty() || !(settings.longestEdge > 0.0)) return;
  for (double least = 0.5 * settings.longestEdge; least > 0.1 * settings.longestEdge; least *= 0.5) {
    std::vector<double> most;  // of a patch's edges
    for (const Patch& patch : mesh.patches) {
      double distance = 1e300;
      if (patch.emission == glm::dvec3(0.0))
        for (const auto& edge : borders) distance = std::min(distance, distanceTo(edge, patch.centroid));
      most.push_back(std::max(distance, least));
    }
    mesh = refined(scene, mesh, settings, [&](std::size_t i, int k) {
      const auto c = mesh.corners(mesh.patches[i]);
      const auto a = static_cast<std::size_t>(k);
      return glm::distance(c[(a + 1) % 3], c[a]) > most[i];
    });
  }
}

}  // namespace

void addBacks(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, RadiosityMesh& mesh,
              const PatchSettings& settings) {
  const std::size_t fronts = mesh.patches.size();
  Backs(context, programs, scene, mesh).add();
  if (mesh.patches.size() == fronts) return;
  numberLightVertices(mesh, settings);
  cutBehindLamps(scene, mesh, settings, bordersOfLamps(mesh, fronts));
}

void cutHiddenPartsOfFronts(const gl::Context& context, gl::ProgramLibrary& programs, const RayScene& rays,
                            RadiosityMesh& mesh) {
  const auto isLit = [](const Patch& patch) { return patch.isBack && patch.emission == glm::dvec3(0.0); };
  if (std::ranges::none_of(mesh.patches, isLit)) {
    cutHiddenParts(programs, rays, mesh);
    return;
  }
  RadiosityMesh fronts = mesh;
  std::erase_if(fronts.patches, isLit);
  cutHiddenParts(programs, RayScene(sceneOf(fronts), context.capabilities()), fronts);
  auto front = fronts.patches.begin();
  for (Patch& patch : mesh.patches)
    if (!isLit(patch)) patch = *front++;
}

}  // namespace lucerna
