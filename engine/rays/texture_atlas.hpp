// Layout of all textures of a scene in one array texture, since a compute program of OpenGL 4.3 can bind only few. No
// GL.
#pragma once

#include <glm/glm.hpp>

#include <vector>

namespace lucerna {

struct AtlasPlace {
  int layer = 0;
  glm::ivec2 corner{0};  ///< its lower left texel
};

struct AtlasLayout {
  glm::ivec3 size{0};  ///< of the array texture; z: layers
  std::vector<AtlasPlace> places;  ///< in the order given
};

/// Shelf packing: rectangles by decreasing height, from left to right. No rectangle may exceed `limit` in either
/// direction.
AtlasLayout layOutAtlas(const std::vector<glm::ivec2>& sizes, int limit);

}  // namespace lucerna
