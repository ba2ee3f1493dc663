#include "radiosity/original/coarse_scene.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

namespace lucerna {

namespace {

constexpr double kFinerCells = 0.9;  // of the side of cells from one attempt to the next
constexpr double kLongerEdges = 1.1;  // of the longest edge from one attempt to the next
constexpr double kEdgeOfCells = 6.0;  // longest edge of a coarser model's patches, in cells, where it is free

using Cell = std::tuple<std::int64_t, std::int64_t, std::int64_t>;

/// A triangle of the scene as it was.
struct Face {
  std::array<std::uint32_t, 3> vertex{};
  int material = 0;
  double area = 0.0;
  bool emits = false;
};

std::vector<Face> facesOf(const Scene& scene) {
  std::vector<Face> faces;
  faces.reserve(scene.triangleCount());
  for (const Mesh& mesh : scene.meshes)
    for (std::uint32_t i = mesh.firstIndex; i + 2 < mesh.firstIndex + mesh.indexCount; i += 3) {
      Face face{{scene.indices[i], scene.indices[i + 1], scene.indices[i + 2]}, mesh.material, 0.0, false};
      const auto corner = [&](std::size_t k) { return glm::dvec3(scene.vertices[face.vertex[k]].position); };
      face.area = 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
      if (!(face.area > 0.0 && std::isfinite(face.area))) continue;
      face.emits = scene.materials[static_cast<std::size_t>(mesh.material)].emission != glm::vec3(0.0f);
      faces.push_back(face);
    }
  return faces;
}

double areaOf(const std::vector<Face>& faces) {
  double sum = 0.0;
  for (const Face& face : faces) sum += face.area;
  return sum;
}

/// The points of all cells that hold corners of triangles which do not emit.
class Clusters {
 public:
  Clusters(const Scene& scene, const std::vector<Face>& faces, double cell) : scene_(scene), cell_(cell) {
    for (const Face& face : faces) {
      if (face.emits) continue;
      for (const std::uint32_t v : face.vertex) {
        Point& point = points_[cellOf(v)];
        point.sum += face.area * glm::dvec3(scene.vertices[v].position);
        point.area += face.area;
      }
    }
  }
  /// Cells are centred on the bounds' corners, so that a box's walls keep their planes.
  Cell cellOf(std::uint32_t vertex) const {
    const glm::dvec3 at = glm::floor((glm::dvec3(scene_.vertices[vertex].position) - scene_.bounds.min) / cell_ + 0.5);
    return {static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y), static_cast<std::int64_t>(at.z)};
  }
  glm::vec3 pointOf(std::uint32_t vertex) const {
    const Point& point = points_.at(cellOf(vertex));
    return glm::vec3(point.sum / point.area);
  }

 private:
  struct Point {
    glm::dvec3 sum{0.0};
    double area = 0.0;
  };
  const Scene& scene_;
  double cell_;
  std::map<Cell, Point> points_;
};

/// Of all triangles with the same three cells and the same winding, the largest.
std::vector<Face> keptFaces(const std::vector<Face>& faces, const Clusters& clusters) {
  std::vector<Face> kept;
  std::map<std::array<Cell, 3>, std::size_t> known;
  for (const Face& face : faces) {
    if (face.emits) {
      kept.push_back(face);
      continue;
    }
    std::array<Cell, 3> key{clusters.cellOf(face.vertex[0]), clusters.cellOf(face.vertex[1]),
                            clusters.cellOf(face.vertex[2])};
    if (key[0] == key[1] || key[1] == key[2] || key[2] == key[0]) continue;
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    const auto [found, fresh] = known.try_emplace(key, kept.size());
    if (fresh) kept.push_back(face);
    else if (face.area > kept[found->second].area) kept[found->second] = face;
  }
  return kept;
}

/// Replaces the triangles of `model`, a copy of `scene`; its area in scene units squared.
double rebuild(Scene& model, const Scene& scene, const std::vector<Face>& faces, double cell) {
  const Clusters clusters(scene, faces, cell);
  std::vector<Face> kept = keptFaces(faces, clusters);
  std::stable_sort(kept.begin(), kept.end(), [](const Face& a, const Face& b) { return a.material < b.material; });
  model.vertices.clear();
  model.indices.clear();
  model.meshes.clear();
  model.bounds = {};
  double area = 0.0;
  for (const Face& face : kept) {
    std::array<Vertex, 3> corners;
    glm::vec3 shading(0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = scene.vertices[face.vertex[k]];
      shading += corners[k].normal;
      if (!face.emits) corners[k].position = clusters.pointOf(face.vertex[k]);
    }
    const glm::dvec3 doubled = glm::cross(glm::dvec3(corners[1].position - corners[0].position),
                                          glm::dvec3(corners[2].position - corners[0].position));
    if (!(glm::length(doubled) > 0.0)) continue;  // three cells in a row
    area += 0.5 * glm::length(doubled);
    if (model.meshes.empty() || model.meshes.back().material != face.material)
      model.meshes.push_back({scene.materials[static_cast<std::size_t>(face.material)].name,
                              static_cast<std::uint32_t>(model.indices.size()),
                              0,
                              face.material,
                              {}});
    // It faces the side that it faced before.
    const glm::vec3 normal(glm::normalize(doubled));
    for (Vertex& corner : corners) {
      corner.normal = glm::dot(normal, shading) < 0.0f ? -normal : normal;
      model.indices.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.push_back(corner);
      model.meshes.back().bounds.add(glm::dvec3(corner.position));
      model.bounds.add(glm::dvec3(corner.position));
    }
    model.meshes.back().indexCount += 3;
  }
  model.degenerateTriangles = 0;
  return area;
}

}  // namespace

CoarseScene coarserScene(const Scene& scene, double cell) {
  CHECK(cell > 0.0, "cells of {}", cell);
  const std::vector<Face> faces = facesOf(scene);
  CoarseScene result{scene, cell, scene.triangleCount(), 0.0, 0.0};
  result.area = rebuild(result.scene, scene, faces, cell) / areaOf(faces);
  if (result.scene.indices.empty())
    throwBadInput("{}: nothing is left of it in cells of {:.4g} units", scene.file.string(), cell);
  return result;
}

namespace {

double largestSide(const Scene& scene) {
  const glm::dvec3 extent = scene.bounds.extent();
  return std::max({extent.x, extent.y, extent.z});
}

bool fits(const Scene& model, const PatchSettings& patches, std::size_t most) {
  return model.triangleCount() <= 8 * most && makePatches(model, patches).patches.size() <= most;
}

/// The model of the finest cells with at most `most` patches. `patchesOf` takes the side of a cell.
CoarseScene finestModel(const Scene& scene, std::size_t most, const std::function<PatchSettings(double)>& patchesOf) {
  CoarseScene result{scene, 0.0, scene.triangleCount(), 1.0, 0.0};
  const std::vector<Face> faces = facesOf(scene);
  const double side = largestSide(scene), before = areaOf(faces);
  PatchSettings patches;
  Scene model = scene;
  for (double cell = 0.5 * side; cell > 1e-4 * side; cell *= kFinerCells) {
    const double area = rebuild(model, scene, faces, cell);
    if (model.triangleCount() > most) break;
    patches = patchesOf(cell);
    // Fewer corners may leave longer edges, and so more patches: finer cells may fit.
    if (model.indices.empty() || !fits(model, patches, most)) continue;
    std::swap(result.scene, model);
    result.cell = cell, result.area = area / before, result.longestEdge = patches.longestEdge;
  }
  if (result.cell == 0.0)
    throwBadInput(
        "{}: a model of at most {} patches is not possible: emissive triangles are kept as they are, and edges are at "
        "most {:.4g} units",
        scene.file.string(), most, patches.longestEdge);
  return result;
}

}  // namespace

CoarseScene coarserScene(const Scene& scene, const PatchSettings& patches, std::size_t most) {
  if (fits(scene, patches, most)) return {scene, 0.0, scene.triangleCount(), 1.0, patches.longestEdge};
  return finestModel(scene, most, [&](double) { return patches; });
}

CoarseScene coarserSceneAndEdge(const Scene& scene, const PatchSettings& given, std::size_t most) {
  CHECK(given.longestEdge > 0.0, "edges of {}", given.longestEdge);
  PatchSettings patches = given;
  if (scene.triangleCount() <= most / 2)
    for (const double diagonal = glm::length(scene.bounds.extent());; patches.longestEdge *= kLongerEdges) {
      if (fits(scene, patches, most)) return {scene, 0.0, scene.triangleCount(), 1.0, patches.longestEdge};
      if (patches.longestEdge > diagonal) break;  // texels of lamps are patches, too
    }
  return finestModel(scene, most, [&](double cell) {
    patches.longestEdge = std::max(given.longestEdge, kEdgeOfCells * cell);
    return patches;
  });
}

}  // namespace lucerna
