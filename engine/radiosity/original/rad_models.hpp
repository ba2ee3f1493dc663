// The three scenes of the radiosity original, created by its generator [RAD2008 chapter 4, appendix 1] (no GL).
//
// The text gives their content and the number of triangles of model 2 at three thresholds, but not their dimensions.
// The dimensions are ours; model 2's size is chosen to match the number of triangles. Every surface is a rectangle, cut
// into roughly square cells and those into two triangles each. A triangle is halved across its longest side until its
// area is below the threshold, so that no side exceeds about twice another.
#pragma once

#include "radiosity/original/rad_file.hpp"

#include <vector>

namespace lucerna {

struct RadModelSettings {
  // The only example in the manual: genx FILE 1 2.5 0.15 100000.
  double areaThreshold = 2.5;  ///< square units; triangles are halved until they are smaller
  double reflectance = 0.15;  ///< of every surface, 0..1
  std::uint32_t lightPower = 100000;  ///< e of the sources, 0..kRadMost
};

/// Model 1: a cube lit by a small square in its ceiling. Model 2: a hall with columns, a pierced wall, a table, a box
/// and a hung panel, two lamps. Model 3: two chambers connected around the end of a wall, a lamp in one. All are
/// closed, with normals towards the air. Throws Error(badInput) for an unknown model, a threshold that is not above 0
/// or needs more triangles than a file of 4 GiB holds, or a reflectance outside 0..1.
std::vector<RadTriangle> makeRadModel(int model, const RadModelSettings& settings);

}  // namespace lucerna
