#include "settings/deviations.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>

namespace lucerna {

namespace {

/// Source of a deviation: the text, the program published with it, both, or other publications.
enum Source : unsigned { elsewhere = 0, text = 1, program = 2, both = text | program };

#define SWITCH(name, meaning, source, member)                                                                     \
  Deviation {                                                                                                     \
    name, meaning, ((source)&text) != 0, ((source)&program) != 0,                                                 \
        [](const RenderSettings& s) { return bool{s.member}; }, [](RenderSettings& s, bool on) { s.member = on; } \
  }
#define LPV_DEVIATION(name, meaning, source, member) SWITCH("lpv." name, meaning, source, lpv.deviations.member)

/// Those of radiosity are in a separate table, which its files and the published solver use.
template <bool RadiosityDeviations::*kMember>
Deviation radiosityDeviation() {
  const auto all = allRadiosityDeviations();
  const auto found =
      std::find_if(all.begin(), all.end(), [](const RadiosityDeviation& d) { return d.member == kMember; });
  return {found->name,
          found->meaning,
          true,
          true,
          [](const RenderSettings& s) { return s.radiosity.solution.deviations.*kMember; },
          [](RenderSettings& s, bool on) { s.radiosity.solution.deviations.*kMember = on; }};
}

const std::array kDeviations{
    SWITCH("rsm.flux-cosine", "flux of a texel times the cosine to the light", both, rsm.fluxCosine),
    Deviation{"rsm.gather-weight", "samples of the gather weighted by xi^2 instead of xi", true, true,
              [](const RenderSettings& s) { return s.gather.weight == RsmGather::Weight::published; },
              [](RenderSettings& s, bool on) {
                s.gather.weight = on ? RsmGather::Weight::published : RsmGather::Weight::unbiased;
              }},
    Deviation{
        "rsm.unbounded", "1/d^4 without a bound beside a surfel", true, true,
        [](const RenderSettings& s) { return s.gather.nearField == RsmGather::Near::none; },
        [](RenderSettings& s, bool on) { s.gather.nearField = on ? RsmGather::Near::none : RsmGather::Near::quad; }},
    LPV_DEVIATION("flux-units", "brightness follows the number of texels and the cell size; lookup times 1.7", program,
                  fluxUnits),
    LPV_DEVIATION("sum-cascades", "all cascades are added", program, sumCascades),
    LPV_DEVIATION("unjoined", "cascades are blended without handing light over", text, unjoined),
    LPV_DEVIATION("truncate", "conversion to int instead of floor; grids snap to whole world units", program, truncate),
    LPV_DEVIATION("first-cell", "bounds tested with > for >=: cell 0 of every axis is lost", elsewhere, firstCell),
    LPV_DEVIATION("side-directions", "side faces by component-wise product", program, sideDirections),
    LPV_DEVIATION("side-solid-angle", "0.4234413544 sr for 0.4234313544", program, sideSolidAngle),
    LPV_DEVIATION("four-pi-kernel", "Omega / (4 pi) and an amplifier (--set lpv.amplifier)", elsewhere, fourPiKernel),
    LPV_DEVIATION("fewer-steps", "N steps run N - 1, and the injected grid is left out of the sum", program,
                  fewerSteps),
    LPV_DEVIATION("block-first-step", "a light's own surface blocks it", both, blockFirstStep),
    LPV_DEVIATION("surfel-area", "surfel areas of a perspective light, times N.L, for an orthographic one", program,
                  surfelArea),
    LPV_DEVIATION("unwindowed", "light travelling away from a surface counts as negative", both, unwindowed),
    SWITCH("path.distance-without-pdf", "free flights from the smallest extinction, weighted only by the transmittance",
           both, path.deviations.distanceWithoutPdf),
    SWITCH("path.boosted-interaction", "probability of an interaction raised to a half, and not divided out", both,
           path.deviations.boostedInteraction),
    SWITCH("path.roulette-without-division", "survivors of Russian roulette are not weighted", both,
           path.deviations.rouletteWithoutDivision),
    SWITCH("path.fresnel-amplitudes", "mean of the Fresnel amplitudes instead of their squares", both,
           path.deviations.fresnelAmplitudes),
    SWITCH("path.schlick", "Schlick's approximation with the cosine on the incident side", elsewhere,
           path.deviations.schlick),
    SWITCH("path.straight-shadow-rays", "shadow rays go straight through refracting boundaries", both,
           path.deviations.straightShadowRays),
    SWITCH("path.linear-seeds", "PCG seeded with the pixel's number", both, path.deviations.linearSeeds),
    SWITCH("path.fixed-epsilon", "rays start 0.001 scene units beside a surface", both, path.deviations.fixedEpsilon),
    SWITCH("path.roulette-at-surfaces", "Russian roulette only at surfaces, never at a collision in a medium", both,
           path.deviations.rouletteAtSurfaces),
    SWITCH("path.unattenuated-shadow-rays", "media on the way to a lamp do not attenuate its light", both,
           path.deviations.unattenuatedShadowRays),
    SWITCH("path.unscaled-refraction", "radiance keeps its value where light is refracted", both,
           path.deviations.unscaledRefraction),
    radiosityDeviation<&RadiosityDeviations::publishedMap>(),
    radiosityDeviation<&RadiosityDeviations::centroid>(),
    radiosityDeviation<&RadiosityDeviations::fixedOrientation>(),
    radiosityDeviation<&RadiosityDeviations::noNearField>(),
    LPV_DEVIATION("half-grids", "grids in 16 bits all along, filled and propagated by layered passes", both, halfGrids),
    LPV_DEVIATION("blocking-direction", "blocking potential evaluated in the direction of travel", both,
                  blockingDirection),
};

#undef LPV_DEVIATION
#undef SWITCH

}  // namespace

std::span<const Deviation> allDeviations() { return kDeviations; }

void applyFidelity(RenderSettings& settings, Fidelity fidelity) {
  for (const Deviation& deviation : kDeviations)
    deviation.turn(settings, fidelity == Fidelity::demo ? deviation.inDemo
                                                        : fidelity != Fidelity::corrected && deviation.inOriginal);
  if (fidelity == Fidelity::corrected) return;
  settings.lpv.propagate = LpvPropagate::layered;
  settings.lpv.lookup = LpvLookup::published;
  settings.lpv.lookupOffset = 0.0f;
  // The demo's cells are 2.5, 1.625 and 1.0 units, its coarsest grid 80 units in a scene of about 112; the text gives
  // no sizes. Neither clamps grids to the scene.
  settings.lpv.cascades.ratio = 1.58;
  settings.lpv.cascades.spanOfScene = 80.0 / 112.0;
  settings.lpv.cascades.heldInScene = false;
}

void applyDeviation(RenderSettings& settings, std::string_view assignment) {
  const auto equals = assignment.find('=');
  const std::string name(assignment.substr(0, equals));
  const std::string_view value = equals == std::string_view::npos ? "" : assignment.substr(equals + 1);
  if (value != "on" && value != "off") throwBadInput("--deviation {}: expected NAME=on or NAME=off", assignment);
  if (name == "radiosity.24-bit")
    throwBadInput(
        "--deviation {}: only the published solver has 24-bit values; use lucerna radiosity solve --fidelity original",
        assignment);
  const auto found =
      std::find_if(kDeviations.begin(), kDeviations.end(), [&](const Deviation& d) { return d.name == name; });
  if (found == kDeviations.end()) {
    std::string known;
    for (const Deviation& d : kDeviations) known += (known.empty() ? "" : ", ") + std::string(d.name);
    throwBadInput("--deviation {}: unknown; expected one of {}", assignment, known);
  }
  found->turn(settings, value == "on");
}

std::vector<std::string> activeDeviations(const RenderSettings& settings) {
  std::vector<std::string> names;
  for (const Deviation& deviation : kDeviations)
    if (deviation.isOn(settings)) names.emplace_back(deviation.name);
  return names;
}

}  // namespace lucerna
