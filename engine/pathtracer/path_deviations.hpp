// Deviations of the published path tracer of participating media [VPT2024] (no GL): README.md, section Deviations, has formula,
// source and measured effect of each.
#pragma once

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
};

}  // namespace lucerna
