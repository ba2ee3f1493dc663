// Checks a glTF file before Assimp reads it, and reads from its JSON what Assimp 5.2.5 leaves out (no GL; private to
// engine/scene). Source: glTF 2.0 specification, Khronos Group, 2021.
#pragma once

#include "scene/json_value.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// Maximum depth of nodes: importers recurse once per level.
inline constexpr int kMostNodeDepth = 1000;

/// The JSON of a .gltf or .glb file. Throws Error(badInput) naming `file` if it is not glTF, if nodes are not trees (a
/// node with two parents or its own descendant makes an importer loop forever or exponentially long) or nested deeper
/// than kMostNodeDepth, and if an accessor has more elements than its bytes can hold.
Json checkedGltf(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// A glTF 2 with each material's number before its name, "3#paint", since Assimp returns materials in order of first
/// use; and with the number of its camera before the name of each node that has one. `root` is its JSON.
std::vector<std::uint8_t> withNumbers(const Json& root, std::span<const std::uint8_t> bytes);

/// The number before such a name; empty if there is none (Assimp's material for meshes without one).
std::optional<std::size_t> numberOf(std::string_view name);
std::string_view withoutNumber(std::string_view name);

/// The vertical field of view of camera `index` of a glTF 2, in radians: Assimp's number means something else in each
/// of its versions. 0 if it is not a perspective camera.
double gltfFieldOfView(const Json& root, std::size_t index);

/// KHR_texture_transform: where a texture is looked up for texture coordinates (u, v), v = 0 being its top row.
struct TextureTransform {
  glm::dvec2 offset{0.0}, scale{1.0};
  double rotation = 0.0;  ///< radians, counter-clockwise as seen with u to the right and v down
  unsigned texCoord = 0;  ///< which coordinates
  bool operator==(const TextureTransform&) const = default;
  glm::dvec2 apply(const glm::dvec2& uv) const;
};

/// Properties of a glTF 2 material that Assimp 5.2.5 drops or changes.
struct GltfMaterial {
  std::string name;
  enum class Alpha { opaque, mask, blend };
  Alpha alpha = Alpha::opaque;
  double alphaCutoff = 0.5,
         baseAlpha = 1.0;  ///< cut out if baseAlpha * texture's alpha * vertex's alpha is below alphaCutoff (mask)
  float emissiveStrength = 1.0f;  ///< KHR_materials_emissive_strength
  float ior = 1.5f;  ///< KHR_materials_ior
  double transmission = 0.0;  ///< KHR_materials_transmission
  double thickness = 0.0;  ///< KHR_materials_volume; 0: a thin wall
  glm::vec3 absorption{0.0f};  ///< of the interior, 1 / scene unit: -ln(attenuationColor) / attenuationDistance
  float normalScale = 1.0f;  ///< of its normal map
  TextureTransform transform;  ///< of the base colour's texture; without one, of the first other texture
  bool clamped = false;  ///< a texture should be clamped or mirrored beyond its edge; it repeats here
  std::string notDone;  ///< unsupported properties, for one warning; empty: none
};

/// Material `index` of a glTF 2; the default material if there is none with that number. Throws Error(badInput) naming
/// file and key.
GltfMaterial gltfMaterial(const Json& root, const std::filesystem::path& file, std::size_t index);

/// Names of lights (KHR_lights_punctual) that have a range, which contradicts 1/d^2; may be empty.
std::string gltfLightsWithRange(const Json& root);

}  // namespace lucerna
