// Where a glTF file's nodes stand, and the vertices of its meshes in a pose (no GL; private to engine/scene).
#pragma once

#include "scene/gltf_file.hpp"
#include "scene/gltf_material.hpp"

#include <array>
#include <map>
#include <memory>
#include <vector>

namespace lucerna {

using GltfTriangles = std::vector<std::array<unsigned, 3>>;

/// A primitive's triangles and the vertices that they use.
struct GltfCorners {
  std::size_t there = 0;  ///< vertices that the primitive has
  std::vector<std::size_t> used;  ///< those in use, in the order of the file
  GltfTriangles triangles;  ///< of the numbers of those in use
};

/// A mesh's vertices in use, before and after its pose.
struct GltfVertices {
  std::vector<glm::dvec3> positions, normals;  ///< without normals: empty
  std::vector<glm::dvec2> texCoords;  ///< as in the file, v = 0 being the top
  std::vector<glm::dvec4> colours;
};

/// A primitive in a node's pose.
struct GltfShape {
  GltfCorners corners;
  GltfVertices vertices;
  MeshData data;  ///< in the node's space, or, skinned, in the world; empty if nothing of it is drawn
};

/// What animations set of a node, instead of what the file says.
struct GltfNodePose {
  std::optional<glm::dvec3> translation, scale;
  std::optional<glm::dvec4> rotation;
  std::optional<std::vector<double>> weights;
};

class GltfMeshes {
 public:
  explicit GltfMeshes(std::shared_ptr<const GltfFile> file) : file_(std::move(file)) { setPose({}); }

  /// Where the nodes stand then. Those that are not named stand as the file says.
  void setPose(std::map<std::size_t, GltfNodePose> pose);
  const glm::dmat4& worldFromNode(std::size_t node) const { return worldFromNode_[node]; }
  /// Weights of morph targets: the pose's, the node's, or else the mesh's.
  std::vector<double> weightsOf(std::size_t node) const;
  /// Matrices of EXT_mesh_gpu_instancing; otherwise one, the node itself.
  std::vector<glm::dmat4> instances(const Value& node) const;
  /// A primitive of the node's mesh, morphed and skinned.
  GltfShape shapeOf(std::size_t node, const Value& primitive, const TextureTransform& transform);
  static bool isSkinned(const Value& node, const Value& primitive) {
    return node.has("skin") && primitive.at("attributes").has("JOINTS_0");
  }

  std::size_t notDrawn = 0, withoutPositions = 0, leftOverIndices = 0;  ///< of cornersOf()

 private:
  /// Of lists, strips and fans (3.7.2.1). No triangles of points and lines, which are counted.
  GltfCorners cornersOf(const Value& primitive);
  /// Morphed: the sum of its attributes and of its targets' by their weights. `texCoords`: which set.
  GltfVertices verticesOf(const Value& primitive, const GltfCorners& corners, const std::vector<double>& weights,
                          unsigned texCoords) const;
  /// Moves the vertices into the world by their joints. Returns of which the joints turn left into right.
  std::vector<bool> skin(GltfVertices& vertices, std::size_t node, const Value& primitive,
                         const GltfCorners& corners) const;
  /// With vertices of its own for each triangle, which are flat, if there are no normals.
  static MeshData dataOf(const GltfVertices& vertices, const GltfTriangles& triangles,
                         const TextureTransform& transform);
  GltfNumbers attribute(const Value& attributes, const std::string& name, std::string_view types,
                        std::size_t count) const;

  std::shared_ptr<const GltfFile> file_;
  std::map<std::size_t, GltfNodePose> pose_;
  std::vector<glm::dmat4> worldFromNode_;
};

}  // namespace lucerna
