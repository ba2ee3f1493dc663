// All textures of a scene in one array texture, since a compute program of OpenGL 4.3 can bind but few: where each goes. No GL.
#pragma once

#include <glm/glm.hpp>

#include <vector>

namespace lucerna {

struct AtlasPlace {
  int layer = 0;
  glm::ivec2 corner{0};  ///< texel of its lower left one
};

struct AtlasLayout {
  glm::ivec3 size{0};                ///< of the array texture; z: layers
  std::vector<AtlasPlace> places;    ///< in the order given
};

/// Shelves: rectangles by falling height, from left to right. No rectangle may be larger than `limit` either way.
AtlasLayout layOutAtlas(const std::vector<glm::ivec2>& sizes, int limit);

}  // namespace lucerna
