// Hand-made reflective shadow maps for the tests of the gather.
#pragma once

#include "support/rsm_reference.hpp"

#include <cstdint>

namespace lucerna::test {

/// The corner: a wall x = 0, 0 < z < 10, |y| < 50 that light along -x meets straight on, with exitance 1 (flux = texel
/// area). Its exact irradiance at (h, 0, 0) with normal +z is `cornerIrradiance(h)`.
inline constexpr double kCornerHeight = 10.0;
reference::RsmMap cornerMap(glm::ivec2 size);
double cornerIrradiance(double h);

/// Surfels at random depths with random normals towards the light, random flux, one texel in ten background. `scale`:
/// of all lengths.
reference::RsmMap randomMap(glm::ivec2 size, std::uint32_t seed, double scale = 1.0);
/// Rounds every texel as the GL textures (32-bit floats) hold it.
void roundToFloat(reference::RsmMap& map);

/// A point in the space that randomMap's surfels fill, and a random unit normal.
struct SurfacePoint {
  glm::dvec3 position, normal;
};
std::vector<SurfacePoint> randomPoints(const reference::RsmMap& map, int count, std::uint32_t seed);

}  // namespace lucerna::test
