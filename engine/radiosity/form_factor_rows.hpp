// Rows of form factors from the results of hemicubes (no GL, pure).
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace lucerna {

/// Consecutive rows of the matrix; entries in the order of patches.
struct FormFactorRows {
  int first = 0;  ///< patch of the first row
  std::vector<std::uint32_t> counts;  ///< entries per row
  /// Fractions of the hemisphere that show fronts and backs, by pixels. The rest is open.
  std::vector<float> fronts, backs;
  std::vector<std::uint32_t> patches;  ///< of each entry
  std::vector<float> factors;  ///< of each entry, > 0
};

/// Results of a batch, read back.
struct DrawnHemicubes {
  int first = 0, count = 0, patchCount = 0;
  /// Raster: hemicube by hemicube, a factor per patch, by pixels; below 0 if a back was seen.
  std::vector<float> factors;
  /// Rays and item buffer, which leave `factors` empty: hemicube * patchCount + patch, unordered; bits of such a
  /// factor.
  std::vector<glm::uvec2> kept;
  /// Place in `factors` or `kept`; bits of the closed form, which replaces the pixels' factor.
  std::vector<glm::uvec2> exact;
};
/// Without GL: another thread can do it while the next batch is drawn.
FormFactorRows rowsOf(DrawnHemicubes drawn);
/// The mean of hemicubes of the same patches, at least one.
FormFactorRows meanRowsOf(std::vector<DrawnHemicubes> drawn);

}  // namespace lucerna
