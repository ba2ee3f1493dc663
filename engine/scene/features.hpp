// SceneFeatures: the features that a scene and the chosen settings require (no GL, pure).
//
// The only source of shader flags and of decisions what to build. A feature that is false here is not compiled,
// allocated or run.
#pragma once

#include "scene/scene.hpp"

#include <string>
#include <utility>
#include <vector>

namespace lucerna {

struct SceneFeatures {
  bool diffuseTextures = false;  ///< any drawn mesh has an albedo texture
  bool alphaMasks = false;  ///< any drawn mesh is cut out by a mask
  bool specular = false;  ///< any drawn mesh has a coat, or is a mirror, metal or glass
  bool emission = false;  ///< any drawn mesh emits
  bool directionalLight = false;  ///< a sun with irradiance > 0
  bool background = false;  ///< background radiance > 0
  bool indirect = false;  ///< a light and an albedo > 0
  bool spotLights = false;  ///< a spot light with intensity > 0
  bool pointLights = false;  ///< an omnidirectional light with intensity > 0
  bool environment =
      false;  ///< light from all directions, visible behind surfaces; code that does not let it light them says so
  bool environmentPicture = false;
  bool emissionTextures = false;  ///< any drawn mesh emits by a texture
  bool normalMaps = false;  ///< any drawn mesh has a normal map
  bool metalMaps = false;  ///< any drawn mesh is metallic or rough by a texture
  bool textureWraps = false;  ///< any drawn mesh has a texture that does not repeat (TextureWrap)
  // Only for the path tracer, and for what the irradiance cache reflects:
  bool smoothNormals = false;  ///< a vertex normal that differs from its triangle's
  bool mirrors = false;
  bool conductors = false;
  bool dielectrics = false;  ///< refracting, smooth or rough
  bool roughDielectrics = false;
  bool nullBoundaries = false;  ///< a boundary that changes only the medium
  bool media = false;  ///< a medium with an effect, inside a drawn boundary or around the camera
  bool denseMedia = false;  ///< homogeneous, inside a drawn dielectric, where paths scatter many times (isDense)
  bool heterogeneousMedia = false;  ///< one of them has a density grid
  bool volumeEmission = false;  ///< one of them emits

  /// (name, needed) in declaration order, for `info` and reports.
  std::vector<std::pair<std::string, bool>> named() const;
  /// Any light from one point or one direction: these have shadow maps and reflective shadow maps.
  bool anyLight() const { return directionalLight || spotLights || pointLights; }
  bool operator==(const SceneFeatures&) const = default;
};

SceneFeatures analyse(const Scene& scene);

/// Whether light scatters about 32 times or more in a body of that extent: the path tracer then walks without rays if
/// possible.
bool isDense(const Medium& medium, double extent);

}  // namespace lucerna
