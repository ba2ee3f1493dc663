// The reconstruction filter of a pixel: how light that falls beside a pixel's centre counts for it. Offsets in pixels.
//
// The filter is sampled, not weighted [Ernst2006]: samples are placed with the filter as their density and count alike,
// so that neighbouring pixels' noise stays independent. Path tracer and rasteriser place them by the same quantiles.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace lucerna {

/// box: the pixel's own area. gaussian: standard deviation 1/2, cut off at 1.5. blackman-harris: four terms, zero from
/// 1.5 on [Harris1978]. centre: one point, as a single frame of a rasteriser.
enum class PixelFilter { box, gaussian, blackmanHarris, centre };
constexpr std::array<std::string_view, 4> namesOf(PixelFilter) {
  return {"box", "gaussian", "blackman-harris", "centre"};
}

/// Density along one axis; both axes are alike and independent. Not of `centre`.
double filterDensity(PixelFilter filter, double offset);

constexpr std::size_t kFilterNodes = 64;
/// Offsets that (1 - cos(pi i / (n - 1))) / 2 of the filter lie below, n = kFilterNodes, so that nodes are densest in
/// the tails; linear in i between them.
std::array<float, kFilterNodes> filterQuantiles(PixelFilter filter);

/// `count` samples of a pixel, the same for all pixels: the beginning of Sobol's (0,2)-sequence, scrambled for edges of
/// every direction, and moved so that their mean is the centre; one sample is the centre.
std::vector<glm::dvec2> pixelSamples(PixelFilter filter, int count);

}  // namespace lucerna
