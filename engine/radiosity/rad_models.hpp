// The three scenes of the radiosity original, made by its generator [RAD2008 chapter 4, appendix 1] (no GL).
//
// The text names what they show and how many triangles model 2 has at three thresholds, not their measures: those are ours, model 2's size chosen
// so that it has as many triangles. Every surface is a rectangle, cut into cells about square and those into two triangles each; a triangle is halved
// across its longest side until its area is below the threshold, so that no side is more than about twice as long as another.
#pragma once

#include "radiosity/rad_file.hpp"

#include <vector>

namespace lucerna {

struct RadModelSettings {
  // The only example that the manual gives: genx FILE 1 2.5 0.15 100000.
  double areaThreshold = 2.5;        ///< square units; triangles end below it
  double reflectance = 0.15;         ///< of every surface, 0..1
  std::uint32_t lightPower = 100000; ///< e of the sources, 0..kRadMost
};

/// Model 1: a cube lit by a small square in its ceiling. Model 2: a hall with columns, a pierced wall, a table, a box and a hung panel, two lamps.
/// Model 3: two chambers joined round the end of a wall, a lamp in one. All closed, normals towards the air.
/// Throws Error(badInput): no such model, a threshold that is not above 0 or gives more triangles than a file of 4 GiB holds, a reflectance outside 0..1.
std::vector<RadTriangle> makeRadModel(int model, const RadModelSettings& settings);

}  // namespace lucerna
