// A scene's surfaces as voxel bits, for short visibility rays between two points (no GL, pure).
// Units: scene units. Surfaces cut out by a mask set no bits.
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace lucerna {

struct SurfaceVoxels {
  static constexpr int kBrick = 4;  ///< voxels per side of a brick
  glm::dvec3 minimum{0.0};  ///< of voxel 0, in the scene's coordinates
  double size = 1.0;  ///< of a voxel
  glm::ivec3 bricks{1};  ///< per axis
  std::vector<glm::uvec2> bits;  ///< a brick's 64 voxels, x fastest, bricks too
  bool isSet(const glm::ivec3& voxel) const;
};

/// `across`: voxels along the longest side of the scene, 1..1024. A voxel is set if a point of a surface lies in it;
/// points are sampled half a voxel apart.
SurfaceVoxels surfaceVoxels(const Scene& scene, int across);

/// Whether a material is cut out at a texture coordinate, as in forward shading, at the nearest texel.
bool isCutOut(const Scene& scene, const Material& material, const glm::dvec2& texCoord);

}  // namespace lucerna
