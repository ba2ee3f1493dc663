// Emissive surfaces as points of known flux, laid out as a map that a light tree is built over (no GL, pure).
// Units: scene units; flux in W.
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <vector>

namespace lucerna {

struct EmissionPoints {
  int size = 0;  ///< texels per side of the map, a power of two
  std::vector<glm::vec4> position;  ///< row by row, in the scene's coordinates less `origin`; w: 1, 0 where empty
  std::vector<glm::vec4> normal;  ///< of the side that emits
  std::vector<glm::vec4> flux;  ///< w: area that one point of its triangle stands for
  double areaOverDensity = 0.0;  ///< that area times the triangle's `pickDensity`
};

/// pickDensity: of the scene's table of lights (rays/light_table.hpp): triangles get points in proportion. Points of
/// neighbouring places lie next to each other in the map. The flux of a triangle with points is exact.
EmissionPoints emissionPoints(const Scene& scene, const std::vector<float>& pickDensity, const glm::dvec3& origin,
                              int size);

}  // namespace lucerna
