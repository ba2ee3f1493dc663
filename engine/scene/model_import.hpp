// A model file as Assimp reads it, in the terms of model_parts.hpp (no GL; private to engine/scene).
#pragma once

#include "scene/model_parts.hpp"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/mesh.h>

#include <memory>

struct aiScene;
namespace Assimp {
class Importer;
}

namespace lucerna {

class ImportedModel {
 public:
  /// `content`: of the file. Throws Error(badInput) naming the file if it cannot be read as a model.
  ImportedModel(const std::filesystem::path& file, std::span<const std::uint8_t> content);
  ~ImportedModel();
  ImportedModel(const ImportedModel&) = delete;
  ImportedModel& operator=(const ImportedModel&) = delete;

  /// Visits meshes with triangles, node by node, as placed by `worldFromNode`; `name`: the mesh's, or else the node's.
  using MeshVisitor = std::function<void(const aiMesh& mesh, const glm::dmat4& worldFromNode, const std::string& name)>;
  void forEachMesh(const MeshVisitor& visit) const;
  /// Throws Error(badInput) if the file has no such material.
  const aiMaterial& material(unsigned index) const;
  TextureLoader::Embedded embedded() const;
  std::vector<ModelLight> lights() const;
  std::vector<Camera> cameras() const;
  /// The transform of the node of that name (Assimp ties cameras and lights to nodes by name).
  glm::dmat4 worldFromNamedNode(const std::string& name) const;

 private:
  std::filesystem::path file_;
  std::unique_ptr<Assimp::Importer> importer_;
  const aiScene* scene_ = nullptr;
};

/// Its meshes and their materials, whatever the format.
void readMeshes(Scene& scene, const ImportedModel& model);

/// `texCoords`: which of the mesh's coordinates.
MeshData meshData(const aiMesh& mesh, const std::string& name, unsigned texCoords = 0);

/// Values of a material; empty if it has none of that key.
std::optional<float> numberOf(const aiMaterial& material, const char* key, unsigned type, unsigned index);
std::optional<glm::vec3> colourOf(const aiMaterial& material, const char* key, unsigned type, unsigned index,
                                  float highest = 1.0f);
/// The picture of the first of these types that the material has; empty: it has none.
std::string pictureOf(const aiMaterial& material, std::initializer_list<aiTextureType> types);

// Parts of a material that formats share.
/// Diffuse, specular and emitted colour, and exponent. `tint`: the vertices' colour, a factor on the base colour.
Material colours(const aiMaterial& source, const glm::vec3& tint);
/// Metallic-roughness. `map`: mean of its picture. Returns the base colour.
glm::vec3 setMetallicRoughness(Material& material, const aiMaterial& source, const glm::vec3& tint,
                               const glm::vec3& map, float transmission);
void setEmission(Material& material, const aiMaterial& source, TextureLoader& textures, float strength);
void setAlbedoAndMask(Material& material, const aiMaterial& source, TextureLoader& textures);

}  // namespace lucerna
