// Smaller versions of a mask that keep its coverage (no GL, pure): a cut at 1/2 keeps the share of the area that it has
// in the picture itself, so that foliage and chains do not thin out at a distance [Castano2010].
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace lucerna {

/// The share of a picture's area where its bilinear interpolation is at least 1/2.
double maskCoverage(const std::vector<std::uint8_t>& texels, glm::ivec2 size, TextureWraps wraps);

/// Levels 1 and up, each of half the size: the means of the texels that each covers, scaled to the coverage of the
/// picture; as far as they can have it, since one texel covers all or nothing.
std::vector<std::vector<std::uint8_t>> maskLevels(const std::vector<std::uint8_t>& texels, glm::ivec2 size,
                                                  TextureWraps wraps);

}  // namespace lucerna
