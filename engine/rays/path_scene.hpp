// A scene on the GPU for path tracing: triangles and their hierarchy, materials and textures in one atlas, lights and
// environment, for programs that include shaders/rays/{materials,bvh,environment,lights}.glsl. The path tracer starts
// paths at a camera, the irradiance cache's records at surface points
// (irradiance_cache/irradiance_cache.hpp).
//
// Space: the scene moved by -origin() (ray_scene.hpp). Units: scene units.
#pragma once

#include "base/error.hpp"
#include "base/hash.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "rays/light_table.hpp"
#include "rays/ray_scene.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"
#include "shared/path_tracer.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lucerna {

/// A storage block of `values`, at least one element. Throws Error(missingCapability) if it exceeds the driver's limit.
template <class T>
gl::Buffer storageOf(const std::string& name, const std::vector<T>& values, const gl::Capabilities& capabilities) {
  const std::size_t bytes = std::max(values.size(), std::size_t{1}) * sizeof(T);
  if (bytes > static_cast<std::size_t>(capabilities.maxShaderStorageBlockSize))
    throwMissingCapability(
        "{}: {} bytes; this driver's storage blocks have at most {} (GL_MAX_SHADER_STORAGE_BLOCK_SIZE)", name, bytes,
        capabilities.maxShaderStorageBlockSize);
  gl::Buffer buffer(name, bytes, nullptr, gl::Usage::staticDraw);
  if (!values.empty()) buffer.upload(0, values.size() * sizeof(T), values.data());
  return buffer;
}

/// Lamps from which on drawing them from a hierarchy costs less than it saves (light_hierarchy.hpp).
constexpr std::size_t kFewestOfHierarchy = 3;

class PathScene {
 public:
  struct Settings {
    bool diffuseOnly = false;  ///< treat every scattering surface as Lambert with its wholeReflectance (scene/coat.hpp)
    bool nextEvent = true;  ///< with a table of lights for sampling
    RaySceneSettings rays = {};
    bool sunApart = false;  ///< where it pays, the sun is not drawn with other lights (light_table.hpp)
    std::size_t fewestOfHierarchy = kFewestOfHierarchy;  ///< lamps; 0: they are always drawn by power
  };
  /// `features`: the scene's, less those that the programs leave out. rankOfMaterial: for closed boundaries
  /// (media.hpp); may be empty. Throws Error(missingCapability) if the scene exceeds the driver's limits.
  PathScene(const Scene& scene, const SceneFeatures& features, const gl::Capabilities& capabilities,
            const Settings& settings, const std::vector<int>& rankOfMaterial = {});

  /// The same scene with other vertices, lights, materials and environment, but for their pictures: as a new one, whose
  /// features and counts must be the same. RaySceneSettings::moves must be set. `meshes`: whose vertices are others.
  void update(const Scene& scene, std::span<const std::size_t> meshes);

  /// Storage blocks 2, 3, 4; texture units 0, 1, 2, 4, 55, 60, 61, 62, 63.
  void bind() const;
  /// Flags for the shaders named above.
  gl::ShaderFlags flags() const;
  /// Fills in the environment, and the probabilities of sampling it and the lamps.
  void fill(shared::PathConstants& constants) const;
  bool hasLights() const { return lightCount_ > 0; }
  std::size_t lightCount() const { return lightCount_; }  ///< entries of the table: each emissive triangle is one
  bool hasCoats() const { return hasCoats_; }
  bool hasHierarchy() const { return hasHierarchy_.value_or(false); }
  const RayScene& rays() const { return rays_; }
  const glm::dvec3& origin() const { return rays_.origin(); }
  const Hash& hash() const { return hash_; }  ///< over everything that affects paths, as it was made
  std::size_t gpuBytes() const;

 private:
  void setMaterials(const Scene& scene);
  void uploadTextures(const Scene& scene);
  void uploadLights(const Scene& scene);
  void uploadHierarchy(const LightTable& table);
  void uploadTriangles(const Scene& scene);
  void writeTriangle(const Scene& scene, std::size_t triangle, std::uint32_t material);
  void uploadEnvironment(const Environment& environment);

  SceneFeatures features_;
  Settings settings_;
  const gl::Capabilities* capabilities_;
  std::vector<int> rankOfMaterial_;
  RayScene rays_;
  std::vector<shared::PathMaterial> materialValues_;
  bool isTextured_ = false;
  int triangleWords_ = 4;
  std::size_t lightCount_ = 0;
  bool sunApart_ = false;
  std::vector<std::uint32_t> lampWords_;  ///< of each triangle, or none: bits of pickDensity, or its leaf
  std::optional<bool> hasHierarchy_;  ///< as it was made
  gl::BufferTexture hierarchy_;
  std::vector<std::uint32_t> triangleValues_;  ///< as uploaded; only kept where the scene moves
  shared::PathConstants constants_{};
  gl::Buffer triangles_, materials_, lights_;
  bool hasCoats_ = false;
  std::optional<gl::Texture> atlas_, values_, coats_, environmentPicture_, environmentTable_, environmentRows_;
  Hash hash_;
};

}  // namespace lucerna
