// Meshes of models: triangles in one vertex and one index buffer.
// - Triangles with positions that are not finite are dropped and counted (Scene::droppedTriangles). Triangles of zero
//   area are counted (Scene::degenerateTriangles) and kept: published counts should be met, Crytek Sponza's of 262,267.
// - Vertices of a mesh are merged if all their floats are equal, bit by bit: no tolerance, so that scenes of any scale
//   keep their shape.
#include "scene/model_parts.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_map>

namespace lucerna {

namespace {

struct VertexHash {
  std::size_t operator()(const std::array<std::uint32_t, 8>& words) const {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const std::uint32_t w : words) {
      h = (h ^ w) * 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }
};
static_assert(sizeof(Vertex) == 8 * sizeof(float), "compared bit by bit, so without padding");

/// A mesh in the scene's space.
struct PlacedMesh {
  std::vector<Vertex> vertices;  ///< as the source has them
  std::vector<std::array<unsigned, 3>> triangles;
  std::size_t dropped = 0, degenerate = 0;
};

PlacedMesh placed(const MeshData& source, const glm::dmat4& worldFromNode) {
  PlacedMesh result;
  const glm::dmat3 linear(worldFromNode);
  const bool mirrored = glm::determinant(linear) < 0.0;
  // Normals transform by the inverse transpose. The cofactor matrix is that times the determinant, and also exists for
  // flattening scalings.
  const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                            glm::cross(linear[0], linear[1]));

  // Vertices in world space.
  std::vector<Vertex>& vertices = result.vertices;
  vertices.resize(source.positions.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    Vertex& vertex = vertices[i];
    vertex.position = glm::vec3(worldFromNode * glm::dvec4(source.positions[i], 1.0));
    if (!source.texCoords.empty()) vertex.texCoord = source.texCoords[i];
    if (!std::isfinite(vertex.texCoord.x) || !std::isfinite(vertex.texCoord.y)) vertex.texCoord = glm::vec2(0.0f);
    const glm::dvec3 normal =
        source.normals.empty() ? glm::dvec3(0.0) : cofactor * glm::dvec3(source.normals[i]) * (mirrored ? -1.0 : 1.0);
    const double length = glm::length(normal);
    vertex.normal = std::isfinite(length) && length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0f);
  }

  // Triangles, and the normals that they lend, area-weighted, to vertices that have none.
  std::vector<std::array<unsigned, 3>>& triangles = result.triangles;
  triangles.reserve(source.triangles.size());
  std::vector<glm::dvec3> lentNormals(vertices.size(), glm::dvec3(0.0));
  double agreement = 0.0;  // area-weighted agreement of faces' sides with vertices' normals
  for (std::array<unsigned, 3> t : source.triangles) {
    if (mirrored) std::swap(t[1], t[2]);
    const glm::dvec3 a(vertices[t[0]].position), b(vertices[t[1]].position), c(vertices[t[2]].position);
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double longest2 = std::max({glm::dot(b - a, b - a), glm::dot(c - a, c - a), glm::dot(c - b, c - b)});
    if (!isFinite(a) || !isFinite(b) || !isFinite(c)) {
      ++result.dropped;
      continue;
    }
    // Exact up to rounding in double: collinear float corners give 0, or 1e-16 of the longest side squared.
    if (!(glm::length(cross) > 1e-14 * longest2)) ++result.degenerate;
    for (const unsigned i : t) lentNormals[i] += cross, agreement += glm::dot(cross, glm::dvec3(vertices[i].normal));
    triangles.push_back(t);
  }
  if (triangles.empty()) return result;
  // A mesh whose faces are wound against its normals was written for another handedness. Its author judged the normals,
  // so faces follow them, as shading turns normals to the viewer by the side of the face.
  if (agreement < 0.0) {
    for (std::array<unsigned, 3>& t : triangles) std::swap(t[1], t[2]);
    for (glm::dvec3& normal : lentNormals) normal = -normal;
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double length = glm::length(lentNormals[i]);
    if (vertices[i].normal == glm::vec3(0.0f))
      vertices[i].normal = length > 0.0 ? glm::vec3(lentNormals[i] / length) : glm::vec3(0.0f, 1.0f, 0.0f);
  }
  return result;
}

}  // namespace

void replaceMesh(Scene& scene, std::size_t index, const MeshData& source, const glm::dmat4& worldFromNode) {
  const PlacedMesh mesh = placed(source, worldFromNode);
  const Mesh& to = scene.meshes[index];
  const std::uint32_t first =
      *std::min_element(scene.indices.begin() + to.firstIndex, scene.indices.begin() + to.firstIndex + to.indexCount);
  if (3 * mesh.triangles.size() == to.indexCount)
    for (std::size_t i = 0; i < to.indexCount; ++i)
      scene.indices[to.firstIndex + i] = first + mesh.triangles[i / 3][i % 3];
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), scene.vertices.begin() + first);
}

void appendMesh(Scene& scene, const MeshData& source, const glm::dmat4& worldFromNode, int material,
                SharedVertices shared) {
  const auto [vertices, triangles, dropped, degenerate] = placed(source, worldFromNode);
  scene.droppedTriangles += dropped;
  scene.degenerateTriangles += degenerate;
  if (triangles.empty()) return;

  // Indices of merged vertices.
  Mesh mesh;
  mesh.name = source.name;
  mesh.material = material;
  mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  const auto firstVertex = static_cast<std::uint32_t>(scene.vertices.size());
  if (shared == SharedVertices::no) {
    scene.vertices.insert(scene.vertices.end(), vertices.begin(), vertices.end());
    for (const std::array<unsigned, 3>& t : triangles)
      for (const unsigned i : t) {
        scene.indices.push_back(firstVertex + i);
        mesh.bounds.add(glm::dvec3(vertices[i].position));
      }
  }
  std::unordered_map<std::array<std::uint32_t, 8>, std::uint32_t, VertexHash> joined;
  joined.reserve(triangles.size());
  if (shared == SharedVertices::yes)
    for (const std::array<unsigned, 3>& t : triangles) {
      for (const unsigned i : t) {
        const Vertex& vertex = vertices[i];
        const auto next = static_cast<std::uint32_t>(scene.vertices.size());
        std::array<std::uint32_t, 8> bits;
        std::memcpy(bits.data(), &vertex, sizeof vertex);
        const auto [entry, isNew] = joined.try_emplace(bits, next);
        if (isNew) {
          scene.vertices.push_back(vertex);
          mesh.bounds.add(glm::dvec3(vertex.position));
        }
        scene.indices.push_back(entry->second);
      }
    }
  mesh.indexCount = static_cast<std::uint32_t>(scene.indices.size()) - mesh.firstIndex;
  scene.bounds.add(mesh.bounds);
  scene.meshes.push_back(std::move(mesh));
  if (scene.indices.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throwBadInput("{}: more than {} triangles", scene.file.string(), std::numeric_limits<std::uint32_t>::max() / 6);
}

}  // namespace lucerna
