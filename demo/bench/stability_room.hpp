// A room without a roof, one wall missing, lit by the sun: the scene of the stability rows, made in memory.
#pragma once

#include "scene/scene.hpp"

namespace lucerna::demo::bench {

struct Room {
  double scale = 1.0;
  glm::dvec3 place{0.0};          ///< of its middle, scene units
  float albedo = 0.7f, irradiance = 3.0f;
  glm::dvec3 sun{-0.35, -1.0, -0.1};
  glm::vec3 emission{0.0f};       ///< of all surfaces
  bool closed = false;            ///< with roof and all walls, the camera inside
  bool badTriangles = false;      ///< zero area, slivers, twice the same
};

Scene makeRoom(const Room& room);

}  // namespace lucerna::demo::bench
