#include "radiosity/patches.hpp"

#include "base/error.hpp"
#include "radiosity/contacts.hpp"
#include "scene/motion.hpp"
#include "scene/texture_mean.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>

namespace lucerna {

namespace {

bool isFinite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::dvec3 cross3(const std::array<glm::dvec3, 3>& c) { return glm::cross(c[1] - c[0], c[2] - c[0]); }

/// Whether a triangle has an area: a ratio of the doubled area to the squared longest edge above that of float's
/// rounding or, of one that emits, of double's, since a lamp may be as narrow as a thread.
bool hasArea(const std::array<glm::dvec3, 3>& c, bool emits) {
  const double longest = std::max(
      {glm::dot(c[1] - c[0], c[1] - c[0]), glm::dot(c[2] - c[1], c[2] - c[1]), glm::dot(c[0] - c[2], c[0] - c[2])});
  return glm::length(cross3(c)) > (emits ? 1e-14 : 1e-7) * longest;
}

/// Merges positions closer than `tolerance` into one point.
class Welder {
 public:
  Welder(std::vector<glm::dvec3>& points, double tolerance)
      : points_(points), tolerance_(tolerance), cell_(std::max(4.0 * tolerance, 1e-300)) {}

  std::uint32_t add(const glm::dvec3& place) {
    const glm::dvec3 cell = glm::floor(place / cell_);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const auto [begin, end] = cells_.equal_range(key(cell + glm::dvec3(dx, dy, dz)));
          for (auto it = begin; it != end; ++it)
            if (glm::length(points_[it->second] - place) <= tolerance_) return it->second;
        }
    const auto index = static_cast<std::uint32_t>(points_.size());
    points_.push_back(place);
    cells_.emplace(key(cell), index);
    return index;
  }

 private:
  static std::uint64_t key(const glm::dvec3& cell) {
    std::uint64_t hash = 0x9e3779b97f4a7c15u;
    for (int axis = 0; axis < 3; ++axis) {
      hash ^= static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[axis])) * 0xbf58476d1ce4e5b9u;
      hash = (hash ^ (hash >> 29)) * 0x94d049bb133111ebu;
    }
    return hash;
  }
  std::vector<glm::dvec3>& points_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> cells_;
  double tolerance_, cell_;
};

/// Everything about a patch that follows from its corners and its material.
void complete(Patch& patch, const RadiosityMesh& mesh, const Scene& scene) {
  const auto c = mesh.corners(patch);
  const glm::dvec3 doubled = cross3(c);
  patch.area = 0.5 * glm::length(doubled);
  patch.faceNormal = doubled / (2.0 * patch.area);
  patch.centroid = (c[0] + c[1] + c[2]) / 3.0;
  patch.hidden = 0;
  const Material& material = scene.materials[static_cast<std::size_t>(patch.material)];
  patch.reflectance = meanAlbedo(scene, material, patch.texCoord);
  patch.emission = std::numbers::pi * glm::dvec3(material.emission);
  if (material.emissionTexture >= 0)
    patch.emission = std::numbers::pi * glm::dvec3(material.emissionScale) *
                     meanTexture(scene.textures[static_cast<std::size_t>(material.emissionTexture)], patch.texCoord);
}

struct EdgeHash {
  std::size_t operator()(const MeshEdge& e) const {
    return (static_cast<std::size_t>(e[0]) << 32 | e[1]) * 0x9e3779b97f4a7c15u;
  }
};

int longestEdge(const RadiosityMesh& mesh, const Patch& patch) {
  int longest = 0;
  double most = -1.0;
  MeshEdge mostEdge{};
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t a = patch.point[static_cast<std::size_t>(k)],
                        b = patch.point[static_cast<std::size_t>((k + 1) % 3)];
    const glm::dvec3 d = mesh.points[a] - mesh.points[b];
    const double length = glm::dot(d, d);
    const MeshEdge edge = edgeOf(a, b);
    // Equal edges: the same one must win in both of its patches, or marks would not terminate.
    if (length > most * (1.0 + 1e-12) || (length > most * (1.0 - 1e-12) && edge < mostEdge))
      most = length, longest = k, mostEdge = edge;
  }
  return longest;
}

/// Where light is interpolated at a point: between corners of patches that share an edge there, on which nothing stands
/// that separates them.
class LightFan {
 public:
  struct Corner {
    std::uint32_t patch;
    int corner;
  };

  LightFan(const RadiosityMesh& mesh, double crease, const std::vector<Corner>& corners)
      : mesh_(mesh), first_(corners.size()) {
    std::iota(first_.begin(), first_.end(), std::size_t{0});
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (isContinuous(corners[i], corners[j], crease)) {
          const std::size_t from = std::max(first_[i], first_[j]), to = std::min(first_[i], first_[j]);
          std::ranges::replace(first_, from, to);
        }
  }
  /// The first corner that shares its light with corner i.
  std::size_t firstOf(std::size_t i) const { return first_[i]; }

 private:
  bool isContinuous(const Corner& a, const Corner& b, double crease) const {
    const Patch &p = mesh_.patches[a.patch], &q = mesh_.patches[b.patch];
    const auto normal = [](const Patch& patch, const Corner& c) {
      return patch.normal[static_cast<std::size_t>(c.corner)];
    };
    if (p.material != q.material || static_cast<double>(glm::dot(normal(p, a), normal(q, b))) < crease) return false;
    const std::uint32_t point = p.point[static_cast<std::size_t>(a.corner)];
    return std::ranges::any_of(p.point, [&](std::uint32_t other) {
      if (other == point || std::ranges::find(q.point, other) == q.point.end()) return false;
      const auto standing = mesh_.standing.find(edgeOf(point, other));
      return standing == mesh_.standing.end() || !isBetween(standing->second, p, q);
    });
  }
  const RadiosityMesh& mesh_;
  std::vector<std::size_t> first_;
};

}  // namespace

std::array<Patch, 2> halvesOf(const Patch& patch, std::size_t k, double place, std::uint32_t at) {
  const std::size_t next = (k + 1) % 3;
  const auto share = static_cast<float>(place);
  std::array<Patch, 2> halves{patch, patch};
  const glm::vec2 uv = (1.0f - share) * patch.texCoord[k] + share * patch.texCoord[next];
  const glm::vec3 sum = (1.0f - share) * patch.normal[k] + share * patch.normal[next];
  const glm::vec3 normal = glm::dot(sum, sum) > 1e-12f ? glm::normalize(sum) : glm::vec3(patch.faceNormal);
  for (const auto& [half, corner] : {std::pair<std::size_t, std::size_t>{0, next}, {1, k}}) {
    halves[half].point[corner] = at;
    halves[half].texCoord[corner] = uv;
    halves[half].normal[corner] = normal;
  }
  return halves;
}

void numberLightVertices(RadiosityMesh& mesh, const PatchSettings& settings) {
  std::vector<bool> isContact(mesh.points.size(), false);
  for (const auto& [edge, directions] : mesh.standing) isContact[edge[0]] = isContact[edge[1]] = true;
  struct Group {
    int material;
    glm::vec3 normal;
    std::uint32_t index;
  };
  std::vector<std::vector<Group>> groups(mesh.points.size());
  std::map<std::uint32_t, std::vector<LightFan::Corner>> contacts;
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < mesh.patches.size(); ++p)
    for (int k = 0; k < 3; ++k) {
      Patch& patch = mesh.patches[p];
      const std::uint32_t point = patch.point[static_cast<std::size_t>(k)];
      if (isContact[point]) {
        contacts[point].push_back({p, k});
        continue;
      }
      auto& here = groups[point];
      const glm::vec3 normal = patch.normal[static_cast<std::size_t>(k)];
      const auto same = [&](const Group& g) {
        return g.material == patch.material && static_cast<double>(glm::dot(g.normal, normal)) >= settings.crease;
      };
      auto found = std::find_if(here.begin(), here.end(), same);
      if (found == here.end()) found = here.insert(here.end(), {patch.material, normal, count++});
      patch.light[static_cast<std::size_t>(k)] = found->index;
    }
  for (const auto& [point, corners] : contacts) {
    const LightFan fan(mesh, settings.crease, corners);
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      numbers.push_back(fan.firstOf(i) == i ? count++ : numbers[fan.firstOf(i)]);
      mesh.patches[corners[i].patch].light[static_cast<std::size_t>(corners[i].corner)] = numbers[i];
    }
  }
  mesh.lightVertices = count;
}

double RadiosityMesh::area() const {
  double sum = 0.0;
  for (const Patch& patch : patches) sum += patch.area;
  return sum;
}

RadiosityMesh refined(const Scene& scene, const RadiosityMesh& mesh, const PatchSettings& settings,
                      const std::function<bool(std::size_t, int)>& marked, std::vector<std::uint32_t>* parent) {
  // Marks grow until each patch with a marked edge has its longest one marked.
  std::unordered_map<MeshEdge, std::uint32_t, EdgeHash> middles;  // of marked edges
  RadiosityMesh result = mesh;
  const auto mark = [&](const Patch& patch, int k) {
    const std::uint32_t a = patch.point[static_cast<std::size_t>(k)],
                        b = patch.point[static_cast<std::size_t>((k + 1) % 3)];
    const auto [it, fresh] = middles.try_emplace(edgeOf(a, b), 0u);
    if (fresh) {
      it->second = static_cast<std::uint32_t>(result.points.size());
      result.points.push_back(0.5 * (mesh.points[it->first[0]] + mesh.points[it->first[1]]));
    }
    return fresh;
  };
  for (std::size_t i = 0; i < mesh.patches.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (marked(i, k)) mark(mesh.patches[i], k);
  const auto middleOf = [&](const Patch& patch, int k) -> std::optional<std::uint32_t> {
    const auto it = middles.find(
        edgeOf(patch.point[static_cast<std::size_t>(k)], patch.point[static_cast<std::size_t>((k + 1) % 3)]));
    return it == middles.end() ? std::nullopt : std::optional(it->second);
  };
  for (bool grown = true; grown;) {
    grown = false;
    for (const Patch& patch : mesh.patches)
      for (int k = 0; k < 3; ++k)
        if (middleOf(patch, k) && mark(patch, longestEdge(mesh, patch))) grown = true;
  }
  for (const auto& [edge, middle] : middles) {
    auto whole = result.standing.extract(edge);
    if (whole.empty()) continue;
    for (const std::uint32_t end : edge) result.standing[edgeOf(end, middle)] = whole.mapped();
  }
  result.patches.clear();
  if (parent) parent->clear();
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) {
    // The longest edge first; its halves keep at most one marked edge each.
    std::vector<Patch> open{mesh.patches[i]};
    while (!open.empty()) {
      Patch patch = open.back();
      open.pop_back();
      int cut = longestEdge(result, patch);
      auto middle = middleOf(patch, cut);
      for (int k = 0; k < 3 && !middle; ++k) {
        cut = k;
        middle = middleOf(patch, k);
      }
      if (middle) {
        const auto halves = halvesOf(patch, static_cast<std::size_t>(cut), 0.5, *middle);
        open.insert(open.end(), halves.rbegin(), halves.rend());
      } else {
        // A patch that was not cut is complete: texture means are expensive.
        if (patch.point != mesh.patches[i].point || patch.hidden) complete(patch, result, scene);
        result.patches.push_back(patch);
        if (parent) parent->push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
  numberLightVertices(result, settings);
  return result;
}

namespace {

/// Halves edges until none is too long.
void cutLongEdges(const Scene& scene, RadiosityMesh& mesh, const PatchSettings& settings) {
  numberLightVertices(mesh, settings);
  if (!(settings.longestEdge > 0.0)) return;
  const double most = settings.longestEdge * settings.longestEdge * (1.0 + 1e-9);
  for (bool longer = true; longer;) {
    longer = false;
    const auto tooLong = [&](std::size_t i, int k) {
      const auto c = mesh.corners(mesh.patches[i]);
      const glm::dvec3 d = c[static_cast<std::size_t>((k + 1) % 3)] - c[static_cast<std::size_t>(k)];
      return glm::dot(d, d) > most;
    };
    for (std::size_t i = 0; i < mesh.patches.size() && !longer; ++i)
      for (int k = 0; k < 3; ++k) longer = longer || tooLong(i, k);
    if (longer) mesh = refined(scene, mesh, settings, tooLong);
  }
}

std::vector<bool> trianglesThatMove(const Scene& scene) {
  std::vector<bool> moves(scene.triangleCount(), false);
  for (const std::size_t m : scene.motion->meshes)
    for (std::uint32_t t = 0; t < scene.meshes[m].indexCount / 3; ++t) moves[scene.meshes[m].firstIndex / 3 + t] = true;
  return moves;
}

}  // namespace

RadiosityMesh makePatches(const Scene& scene, const PatchSettings& settings) {
  // Reject materials for which the equation has no solution.
  for (const Material& m : scene.materials)
    for (int c = 0; c < 3; ++c) {
      if (!(m.diffuse[c] >= 0.0f && m.diffuse[c] <= 1.0f))
        throwBadInput(
            "material {}: reflectance {} is not from 0 to 1: such a surface would reflect more light than it receives",
            m.name, m.diffuse[c]);
      if (!(m.emission[c] >= 0.0f && std::isfinite(m.emission[c])))
        throwBadInput("material {}: emission {} is not a finite number >= 0", m.name, m.emission[c]);
    }
  // Triangles become patches: welded, turned to their normals, each once.
  RadiosityMesh mesh;
  Bounds bounds;
  for (const std::uint32_t index : scene.indices) {
    const glm::vec3& p = scene.vertices[index].position;
    if (isFinite(p) && scene.isMain(glm::dvec3(p))) bounds.add(glm::dvec3(p));
  }
  const glm::dvec3 extent = bounds.extent();
  mesh.extent = std::max({extent.x, extent.y, extent.z});
  Welder welder(mesh.points, settings.weld * mesh.extent);
  std::set<std::array<std::uint32_t, 3>> seen;
  for (const Mesh& part : scene.meshes)
    for (std::uint32_t i = part.firstIndex; i + 2 < part.firstIndex + part.indexCount; i += 3) {
      Patch patch;
      patch.material = part.material;
      patch.triangle = i / 3;
      bool finite = true;
      std::array<const Vertex*, 3> vertex{};
      for (std::size_t k = 0; k < 3; ++k) {
        vertex[k] = &scene.vertices[scene.indices[i + k]];
        finite = finite && isFinite(vertex[k]->position);
      }
      if (!finite) {
        ++mesh.notFinite;
        continue;
      }
      const bool emits = scene.materials[static_cast<std::size_t>(part.material)].emission != glm::vec3(0.0f);
      for (std::size_t k = 0; k < 3; ++k) patch.point[k] = welder.add(glm::dvec3(vertex[k]->position));
      if (emits && !hasArea(mesh.corners(patch), emits))  // a lamp narrower than what is welded keeps its corners
        for (std::size_t k = 0; k < 3; ++k) {
          patch.point[k] = static_cast<std::uint32_t>(mesh.points.size());
          mesh.points.emplace_back(vertex[k]->position);
        }
      if (!hasArea(mesh.corners(patch), emits)) {
        ++mesh.degenerate;
        continue;
      }
      glm::dvec3 shading(0.0);
      for (std::size_t k = 0; k < 3; ++k) {
        patch.texCoord[k] = vertex[k]->texCoord;
        patch.normal[k] = vertex[k]->normal;
        if (isFinite(vertex[k]->normal)) shading += glm::dvec3(vertex[k]->normal);
      }
      if (glm::dot(shading, cross3(mesh.corners(patch))) < 0.0) {
        std::swap(patch.point[1], patch.point[2]);
        std::swap(patch.texCoord[1], patch.texCoord[2]);
        std::swap(patch.normal[1], patch.normal[2]);
        ++mesh.flipped;
      }
      const glm::vec3 face(glm::normalize(cross3(mesh.corners(patch))));
      for (glm::vec3& n : patch.normal) n = isFinite(n) && glm::dot(n, face) > 0.0f ? glm::normalize(n) : face;
      // The same three points in the same winding, in any rotation.
      auto key = patch.point;
      std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
      if (!seen.insert(key).second) {
        ++mesh.duplicates;
        continue;
      }
      complete(patch, mesh, scene);
      mesh.patches.push_back(patch);
    }
  if (mesh.patches.empty())
    throwBadInput("{}: no triangle with an area ({} without, {} with corners that are not finite)", scene.name,
                  mesh.degenerate, mesh.notFinite);
  const auto cut = [&](const std::function<bool(const Patch&, const Patch&)>& between) {
    for (const std::uint32_t changed : cutAtContacts(mesh, settings.longestEdge, between))
      complete(mesh.patches[changed], mesh, scene);
  };
  if (!settings.contacts || !scene.motion) {
    if (settings.contacts) cut({});
    cutLongEdges(scene, mesh, settings);
    return mesh;
  }
  // What moves is cut out last, of small patches: the others stay the same.
  const std::vector<bool> moves = trianglesThatMove(scene);
  const auto isStill = [&](const Patch& a, const Patch& b) { return !moves[a.triangle] && !moves[b.triangle]; };
  cut(isStill);
  cutLongEdges(scene, mesh, settings);
  cut(std::not_fn(isStill));
  cutLongEdges(scene, mesh, settings);
  return mesh;
}

Scene sceneOf(const RadiosityMesh& mesh) {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].emission = glm::vec3(1.0f);
  for (const Patch& patch : mesh.patches) {
    const int material = patch.emission != glm::dvec3(0.0) ? 1 : 0;
    if (scene.meshes.empty() || scene.meshes.back().material != material) {
      Mesh& part = scene.meshes.emplace_back();
      part.material = material;
      part.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
    }
    for (const glm::dvec3& corner : mesh.corners(patch)) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
      scene.vertices.emplace_back().position = glm::vec3(corner);
      scene.bounds.add(glm::dvec3(scene.vertices.back().position));
    }
    scene.meshes.back().indexCount += 3;
  }
  return scene;
}

}  // namespace lucerna
