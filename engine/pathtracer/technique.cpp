// Technique path: its settings, its deviations and its entry in the list of techniques.
#include "pathtracer/path_frame.hpp"

namespace lucerna {

namespace {

std::span<const Setting> pathSettings() {
  using namespace setting_values;
  static const std::vector<Setting> table{
      {"path.samples", number(SETTING_FIELD(PathSettings, samples), 1, 4000000000.0), "samples",
       "a pixel, of a finished picture (--spp)"},
      {"path.least-samples", number(SETTING_FIELD(PathSettings, leastSamples), 1, 4000000000.0), "samples",
       "a pixel in the first frame of a view, at least"},
      {"path.scatterings",
       number(SETTING_FIELD(PathSettings, scatterings), 0, 1000000, "all", PathSettings::kAllScatterings), "",
       "between light and camera; light scattered more often is left out (--bounces; 2 is one bounce)"},
      {"path.seed", number(SETTING_FIELD(PathSettings, seed), 0, 4294967295.0), "", "of the random numbers (--seed)"},
      {"path.denoise", boolean(SETTING_FIELD(PathSettings, denoise)), "",
       "fits to the surfaces seen take the noise's place where they are nearer to the truth (--denoise)",
       "[Bitterli2016]"},
  };
  return table;
}

std::span<const Deviation> pathDeviations() {
  static const std::vector<Deviation> table{
      LUCERNA_DEVIATION("path.distance-without-pdf",
                        "free flights from the smallest extinction, weighted only by the transmittance", both,
                        PathSettings, deviations.distanceWithoutPdf),
      LUCERNA_DEVIATION("path.boosted-interaction",
                        "probability of an interaction raised to one half, and not divided out", both, PathSettings,
                        deviations.boostedInteraction),
      LUCERNA_DEVIATION("path.roulette-without-division", "survivors of Russian roulette are not weighted", both,
                        PathSettings, deviations.rouletteWithoutDivision),
      LUCERNA_DEVIATION("path.fresnel-amplitudes", "mean of the Fresnel amplitudes instead of their squares", both,
                        PathSettings, deviations.fresnelAmplitudes),
      LUCERNA_DEVIATION("path.schlick", "Schlick's approximation with the cosine on the incident side", elsewhere,
                        PathSettings, deviations.schlick),
      LUCERNA_DEVIATION("path.straight-shadow-rays", "shadow rays go straight through refracting boundaries", both,
                        PathSettings, deviations.straightShadowRays),
      LUCERNA_DEVIATION("path.linear-seeds", "PCG seeded with the pixel's number", both, PathSettings,
                        deviations.linearSeeds),
      LUCERNA_DEVIATION("path.fixed-epsilon", "rays start 0.001 scene units beside a surface", both, PathSettings,
                        deviations.fixedEpsilon),
      LUCERNA_DEVIATION("path.roulette-at-surfaces",
                        "Russian roulette only at surfaces, never at a collision in a medium", both, PathSettings,
                        deviations.rouletteAtSurfaces),
      LUCERNA_DEVIATION("path.unattenuated-shadow-rays", "media between surface and lamp do not attenuate its light",
                        both, PathSettings, deviations.unattenuatedShadowRays),
      LUCERNA_DEVIATION("path.unscaled-refraction", "radiance keeps its value where light is refracted", both,
                        PathSettings, deviations.unscaledRefraction)};
  return table;
}

LightModel pathModel(const RenderSettings&) { return {Transport::all, 0, true}; }

std::unique_ptr<FrameTechnique> makePaths(const FrameParts& parts) { return std::make_unique<PathFrame>(parts); }

}  // namespace

namespace pathtracer {

TechniqueEntry technique() {
  return {.name = "path",
          .settings = pathSettings(),
          .deviations = pathDeviations(),
          .model = pathModel,
          .isNeeded = [](const RenderSettings&, const SceneFeatures&) { return true; },
          .make = makePaths,
          .drawsReflections = true,
          .media = TechniqueEntry::Media::all,
          .drawsSurfaces = false};
}

}  // namespace pathtracer

}  // namespace lucerna
