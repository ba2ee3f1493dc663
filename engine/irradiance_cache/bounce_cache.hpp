// Points of a scene's surfaces that keep light of further bounces (no GL, pure): one per cell of a grid over the whole
// scene, per direction that surfaces face and per layer of them, whatever the camera sees. Units: scene units.
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace lucerna {

struct BounceCache {
  static constexpr double kApart = 0.15;  ///< cells along the normal, beyond which a surface is another layer
  static constexpr int kLayers = 4;  ///< at most, in a slot
  static constexpr int kFaces = 6;  ///< 2 * axis + (1 if the normal points down the axis)
  struct Point {
    glm::dvec3 position;  ///< in the scene's coordinates
    glm::vec3 normal;  ///< for shading, unit, on the point's side
    std::uint32_t triangle;  ///< in the scene's order
    glm::vec2 barycentrics;  ///< weights of its second and third corner
    bool front;  ///< whether the side is the triangle's front
    glm::ivec4 place;  ///< cell; w: face
    std::uint32_t next;  ///< of another layer in the same slot: its number + 1, 0 if there is none
  };
  glm::dvec3 minimum{0.0};  ///< of cell 0
  double cellSize = 1.0;
  glm::ivec3 cells{1};
  std::vector<Point> points;
  std::vector<std::uint32_t>
      slots;  ///< per face and cell, x fastest: number of its first point + 1, 0 if there is none
};

/// `across`: cells along the longest side of the scene, 1..64. Of a layer's points that face a way the one nearest
/// to the cell's middle, and most along the axis, counts: an actual point, since the mean of several may lie buried.
BounceCache bounceCache(const Scene& scene, int across);

}  // namespace lucerna
