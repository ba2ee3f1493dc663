// Materials of glTF 2 files: their properties, and how a Material stands for them (no GL; private to engine/scene).
#pragma once

#include "scene/gltf_file.hpp"
#include "scene/model_parts.hpp"

#include <optional>
#include <string>

namespace lucerna {

/// KHR_texture_transform: where a texture is looked up for texture coordinates (u, v), v = 0 being its top row.
struct TextureTransform {
  glm::dvec2 offset{0.0}, scale{1.0};
  double rotation = 0.0;  ///< radians, counter-clockwise as seen with u to the right and v down
  unsigned texCoord = 0;  ///< which coordinates
  bool operator==(const TextureTransform&) const = default;
  glm::dvec2 apply(const glm::dvec2& uv) const;
};

struct GltfMaterial {
  std::string name;
  glm::vec3 base{1.0f};  ///< baseColorFactor
  PictureUse basePicture;
  float metallic = 1.0f, roughness = 1.0f;
  PictureUse metalPicture;
  glm::vec3 emissive{0.0f};
  float emissiveStrength = 1.0f;  ///< KHR_materials_emissive_strength
  PictureUse emissivePicture;
  float normalScale = 1.0f;
  PictureUse normalPicture;
  enum class Alpha { opaque, mask, blend };
  Alpha alpha = Alpha::opaque;
  double alphaCutoff = 0.5,
         baseAlpha = 1.0;  ///< cut out if baseAlpha * texture's alpha * vertex's alpha is below alphaCutoff (mask)
  std::optional<glm::vec3> specular;  ///< KHR_materials_pbrSpecularGlossiness, in place of the metallic share
  float ior = 1.5f;  ///< KHR_materials_ior
  float transmission = 0.0f;  ///< KHR_materials_transmission
  double thickness = 0.0;  ///< KHR_materials_volume; 0: a thin wall
  glm::vec3 absorption{0.0f};  ///< of the interior, 1 / scene unit: -ln(attenuationColor) / attenuationDistance
  std::optional<TextureTransform> transform;  ///< of the first picture, in the order above; empty: it has none
  std::string notDone;  ///< unsupported properties, for one warning; empty: none

  void lacks(std::string_view what);
};

/// A material of the file; without `index` the default one. Throws Error(badInput) naming file and key.
GltfMaterial gltfMaterial(const GltfFile& file, std::optional<std::size_t> index);

/// Pictures inside the file by their names.
TextureLoader::Embedded gltfPictures(const GltfFile& file);

/// The Material that stands for it. `tint`: the vertices' colour, a factor on the base colour. Appends the medium
/// inside to the scene. What is invisible everywhere has an opacity of 0.
Material materialOf(GltfMaterial& gltf, const glm::vec3& tint, TextureLoader& textures, Scene& scene);

/// Sets what an animated material's factors determine; its pictures and its kind stay. Means of the pictures of
/// metallic-roughness and of emission, 1 without one.
void setFactors(Material& material, const GltfMaterial& gltf, const glm::vec3& tint, const glm::vec3& metalMean,
                const glm::vec3& emissiveMean);

}  // namespace lucerna
