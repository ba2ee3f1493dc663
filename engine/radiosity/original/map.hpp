// The multiplier map: the weight of each pixel of a hemicube (no GL, pure).
#pragma once

#include <vector>

namespace lucerna {

/// Weights of a hemicube's pixels. Over one top and four sides they sum to 1, like a closed scene's form factors.
struct MultiplierMap {
  int view = 0;  ///< pixels per side
  std::vector<float> top;  ///< view x view
  std::vector<float> side;  ///< view x view/2, from the horizon up, as glReadPixels gives the upper half
};

/// published: 1/r * 1/r on top, 1/r * b/r on the sides, r^2 = 1 + a^2 + b^2, where a and b are a pixel's distances from
/// the middle and half a face is 1 [RAD2008 section 3.5.3]. Otherwise the delta form factors 1/(pi r^4) and b/(pi r^4)
/// [CohenGreenberg1985]: a pixel's solid angle also falls with r. An odd view omits the middle row of the sides, as
/// published.
MultiplierMap makeMultiplierMap(int view, bool published);

}  // namespace lucerna
