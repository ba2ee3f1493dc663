// Technique lpv: its settings, its deviations and its entry in the list of techniques.
#include "cascades/cascade_settings.hpp"
#include "lpv/lpv_frame.hpp"

namespace lucerna {

namespace {

using namespace setting_values;

/// Whether there is a geometry volume, and whose surfels fill it.
SettingValue blocking() {
  SettingValue value = valueOf(SettingType::choice, 0.0, 3.0, {"rsm", "camera", "both", "off"});
  value.get = [](const RenderSettings& s) {
    const auto& lpv = s.of<LpvSettings>();
    return lpv.blocking ? static_cast<double>(lpv.surfels) : 3.0;
  };
  value.set = [](RenderSettings& s, double n) {
    auto& lpv = s.of<LpvSettings>();
    lpv.blocking = n < 3.0;
    lpv.surfels = lpv.blocking ? static_cast<LpvSurfels>(static_cast<int>(n)) : LpvSurfels::rsm;
  };
  return value;
}

std::span<const Setting> lpvSettings() {
  constexpr auto rebuild = SettingCost::rebuild;
  static const std::vector<Setting> table{
      CASCADE_SETTINGS("lpv", LpvSettings, "[Kaplanyan2010, section 5]",
                       "; more do not converge: light crosses more of them and loses its direction in each",
                       "; more raise the error: finer ones take light from coarser ones that has lost its direction"),
      {"lpv.blend", number(SETTING_FIELD(LpvSettings, blendBand), 0.001, 1.0), "half extents",
       "width of the band over which a cascade fades into the next", "[Kaplanyan2010, section 5]"},
      {"lpv.bounces", number(SETTING_FIELD(LpvSettings, bounces), 1, 64), "",
       "reflections before light reaches a surface", "[Kaplanyan2010]"},
      {"lpv.iterations", number(SETTING_FIELD(LpvSettings, iterations), 0, 100000), "steps",
       "propagation steps; more raise the error: light of two bands of directions spreads sideways with each",
       "[Kaplanyan2010, section 4.3]"},
      {"lpv.blocking", blocking(), "", "source of the surfels in the geometry volume, which blocks light; off: none",
       "[Kaplanyan2010, section 4.2]"},
      {"lpv.lookup", choice(SETTING_FIELD(LpvSettings, lookup)), "",
       "irradiance from propagated light: flux, as the kernel sends it through a face; published, 1.91 times as much",
       "[Kaplanyan2010]"},
      {"lpv.lookup-offset", optionalNumber(SETTING_FIELD(LpvSettings, lookupOffset), 0.0, 4.0), "cells",
       "offset along the normal before the lookup", "[Kaplanyan2010]", rebuild, "",
       "auto: 0, with lpv.lookup=published 0.5"},
      {"lpv.hand-over", number(SETTING_FIELD(LpvSettings, handOver), 0, 100000, "auto"), "steps",
       "steps after which finer cascades take a coarser one's light; auto: from iterations and ratio"},
      {"lpv.shafts", boolean(SETTING_FIELD(LpvSettings, shafts)), "",
       "light shafts: single scattering along the view in the scene's homogeneous medium", "[LPV2015]"},
      {"lpv.shaft-steps", number(SETTING_FIELD(LpvSettings, shaftSteps), 1, 4096), "steps",
       "of light shafts along a view ray"},
      {"lpv.glossy", boolean(SETTING_FIELD(LpvSettings, glossy)), "",
       "glossy reflection of the volume's light, along reflected rays to the first surfels of the geometry volume"},
      {"lpv.glossy-steps", number(SETTING_FIELD(LpvSettings, glossySteps), 1, 1024), "cells",
       "along a reflected ray, at most"},
      {"lpv.fill", choice(SETTING_FIELD(LpvSettings, fill)), "",
       "how the grid is filled: layered, by blending; atomic, in floats; fixed, in integers, the same bits every run"},
      {"lpv.tile", number(SETTING_FIELD(LpvSettings, tile), 1, 16), "texels",
       "with lpv.fill=atomic or fixed: side of the square added up before an atomic; 1: one atomic per texel, as "
       "published",
       "[LPV2015]"},
      {"lpv.propagate", choice(SETTING_FIELD(LpvSettings, propagate)), "",
       "compute; layered: one pass per step and cascade, one point per cell, as published", "[LPV2015]"},
      {"lpv.amplifier", number(SETTING_FIELD(LpvSettings, amplifier), 0.0, 100.0), "",
       "factor of the deviation lpv.four-pi-kernel; 4 conserves energy", "[LPV2015]"},
  };
  return table;
}

std::span<const Deviation> lpvDeviations() {
  static const std::vector<Deviation> table{
      LUCERNA_DEVIATION("lpv.flux-units",
                        "brightness depends on the number of texels and the cell size; lookup times 1.7", program,
                        LpvSettings, deviations.fluxUnits),
      LUCERNA_DEVIATION("lpv.sum-cascades", "all cascades are added", program, LpvSettings, deviations.sumCascades),
      LUCERNA_DEVIATION("lpv.unjoined", "cascades are blended without handing light over", text, LpvSettings,
                        deviations.unjoined),
      LUCERNA_DEVIATION("lpv.truncate", "conversion to int instead of floor; grids snap to whole world units", program,
                        LpvSettings, deviations.truncate),
      LUCERNA_DEVIATION("lpv.first-cell", "bounds tested by > instead of >=: cell 0 of every axis is lost", elsewhere,
                        LpvSettings, deviations.firstCell),
      LUCERNA_DEVIATION("lpv.side-directions", "side faces by component-wise product", program, LpvSettings,
                        deviations.sideDirections),
      LUCERNA_DEVIATION("lpv.side-solid-angle", "0.4234413544 sr for 0.4234313544", program, LpvSettings,
                        deviations.sideSolidAngle),
      LUCERNA_DEVIATION("lpv.four-pi-kernel", "Omega / (4 pi) and an amplifier (--set lpv.amplifier)", elsewhere,
                        LpvSettings, deviations.fourPiKernel),
      LUCERNA_DEVIATION("lpv.fewer-steps", "N - 1 steps in place of N, and the injected grid is left out of the sum",
                        program, LpvSettings, deviations.fewerSteps),
      LUCERNA_DEVIATION("lpv.block-first-step", "a light's own surface blocks it", both, LpvSettings,
                        deviations.blockFirstStep),
      LUCERNA_DEVIATION("lpv.surfel-area", "surfel areas of a perspective light, times N.L, for an orthographic one",
                        program, LpvSettings, deviations.surfelArea),
      LUCERNA_DEVIATION("lpv.unwindowed", "light travelling away from a surface is subtracted", both, LpvSettings,
                        deviations.unwindowed),
      LUCERNA_DEVIATION("lpv.half-grids", "grids in 16 bits throughout, filled and propagated by layered passes", both,
                        LpvSettings, deviations.halfGrids),
      LUCERNA_DEVIATION("lpv.blocking-direction", "blocking potential evaluated in the direction of travel", both,
                        LpvSettings, deviations.blockingDirection)};
  return table;
}

LightModel lpvModel(const RenderSettings& settings) {
  const auto& lpv = settings.of<LpvSettings>();
  if (lpv.bounces != 1) return {Transport::indirect, lpv.bounces};
  return {lpv.blocking ? Transport::oneBounce : Transport::oneBounceUnoccluded};
}

/// As published besides the deviations.
void publishLpv(RenderSettings& settings) {
  auto& lpv = settings.of<LpvSettings>();
  lpv.propagate = LpvPropagate::layered;
  lpv.lookup = LpvLookup::published;
  lpv.lookupOffset = 0.0f;
  // The demo's cells are 2.5, 1.625 and 1.0 units, its coarsest grid 80 units in a scene of about 112; the text gives
  // no sizes. Neither clamps grids to the scene.
  lpv.cascades.ratio = 1.58;
  lpv.cascades.spanOfScene = 80.0 / 112.0;
  lpv.cascades.heldInScene = false;
}

bool needsLpv(const RenderSettings& settings, const SceneFeatures& features) {
  return settings.of<LpvSettings>().shafts || LpvFrame::needsVolume(settings, features);
}

std::unique_ptr<FrameTechnique> makeLpv(const FrameParts& parts) { return std::make_unique<LpvFrame>(parts); }

}  // namespace

namespace lpv {

TechniqueEntry technique() {
  return {.name = "lpv",
          .settings = lpvSettings(),
          .deviations = lpvDeviations(),
          .reads = {{"maps"}, {"shadows"}, {"textures"}},
          .stages = {"reflective shadow map", "light propagation volume", "light shafts", "glossy reflection"},
          .model = lpvModel,
          .isNeeded = needsLpv,
          .make = makeLpv,
          .readsLightMaps = LpvFrame::needsVolume,
          .prepare = LpvFrame::prepare,
          .publish = publishLpv};
}

}  // namespace lpv

}  // namespace lucerna
