// Where a scene's surfaces are, coarsely: bits of voxels, for short rays that ask whether anything lies between two points (no GL, pure).
// Units: scene units. Surfaces that a mask cuts out leave no bits.
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace lucerna {

struct SurfaceVoxels {
  static constexpr int kBrick = 4;  ///< voxels a side of a brick
  glm::dvec3 minimum{0.0};          ///< of voxel 0, in the scene's coordinates
  double size = 1.0;                ///< of a voxel
  glm::ivec3 bricks{1};             ///< a direction
  std::vector<glm::uvec2> bits;     ///< a brick's 64 voxels, x fastest, bricks too
  bool isSet(const glm::ivec3& voxel) const;
};

/// `across`: voxels along the longest side of the scene, 1..1024. A voxel is set where a point of a surface lies in it, to within half a voxel's spacing of the points looked at.
SurfaceVoxels surfaceVoxels(const Scene& scene, int across);

}  // namespace lucerna
