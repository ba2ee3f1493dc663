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

  /// Visits meshes with faces, node by node, as placed by `worldFromNode`; `name`: the mesh's, or else the node's.
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

/// Values of a material; empty if it has none of that key.
std::optional<float> numberOf(const aiMaterial& material, const char* key, unsigned type, unsigned index);
std::optional<glm::vec3> colourOf(const aiMaterial& material, const char* key, unsigned type, unsigned index,
                                  float highest = 1.0f);
/// The picture of the first of these types that the material has; empty: it has none.
PictureUse pictureOf(const aiMaterial& material, std::initializer_list<aiTextureType> types);

// Parts of a material.
/// Diffuse, specular and emitted colour, and exponent.
Material colours(const aiMaterial& source);
/// Metallic-roughness. `map`: mean of its picture.
void setMetallicRoughness(Material& material, const aiMaterial& source, const glm::vec3& map);
void setEmission(Material& material, const aiMaterial& source, TextureLoader& textures);
void setAlbedoAndMask(Material& material, const aiMaterial& source, TextureLoader& textures);

}  // namespace lucerna
