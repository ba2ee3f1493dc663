// Settings of a path traced picture, and the deviations of the published path tracer of participating media [VPT2024]
// (no GL): README.md, section Deviations, has formula, source and measured effect of each.
#pragma once

#include <cstdint>
#include <limits>

namespace lucerna {

struct PathDeviations {
  bool distanceWithoutPdf = false;
  bool boostedInteraction = false;
  bool rouletteWithoutDivision = false;
  bool fresnelAmplitudes = false;
  bool schlick = false;
  bool straightShadowRays = false;
  bool linearSeeds = false;
  bool fixedEpsilon = false;
  bool rouletteAtSurfaces = false;
  bool unattenuatedShadowRays = false;
  bool unscaledRefraction = false;
  bool operator==(const PathDeviations&) const = default;
};

struct PathSettings {
  static constexpr std::uint32_t kAllScatterings = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t samples = 64;  ///< per pixel of a finished picture
  std::uint32_t leastSamples = 1;  ///< minimum per pixel in the first frame of a view
  std::uint32_t scatterings = kAllScatterings;  ///< light with more scatterings is omitted
  std::uint32_t seed = 0;  ///< pictures of different seeds are independent
  bool denoise = false;  ///< pathtracer/denoiser.hpp
  PathDeviations deviations;
};

}  // namespace lucerna
