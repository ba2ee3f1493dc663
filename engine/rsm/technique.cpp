// Technique rsm: its settings, its deviations and its entry in the list of techniques.
#include "rsm/rsm_frame.hpp"

namespace lucerna {

namespace {

using Gather = RsmGather::Settings;

std::span<const Setting> rsmSettings() {
  using namespace setting_values;
  constexpr auto rebuild = SettingCost::rebuild;
  static const std::vector<Setting> table{
      {"rsm.size", number(SETTING_FIELD(ReflectiveShadowMap::Settings, size), 1, 8192), "texels",
       "side of the reflective shadow map; an omnidirectional light's faces have half of it", "[Dachsbacher2005]",
       rebuild, "", "", "maps"},
      {"rsm.samples", number(SETTING_FIELD(Gather, samples), 1, 65536), "samples", "of the map for a gathered point",
       "[Dachsbacher2005]"},
      {"rsm.radius", number(SETTING_FIELD(Gather, radius), 1e-4, 2.0), "sides of the map",
       "within which samples are dense: rsm.reach", "[Dachsbacher2005]"},
      {"rsm.reach", choice(SETTING_FIELD(Gather, reach)), "",
       "map: half of the samples lie within rsm.radius, the others anywhere in the map; radius: all within",
       "[Dachsbacher2005]"},
      {"rsm.weight", choice(SETTING_FIELD(Gather, weight)), "", "of a sample: unbiased, xi; published, xi^2",
       "[Dachsbacher2005]"},
      {"rsm.rotation", choice(SETTING_FIELD(Gather, rotation)), "",
       "noise: the sample pattern is turned from pixel to pixel", "[Jimenez2014]"},
      {"rsm.near-field", choice(SETTING_FIELD(Gather, nearField)), "",
       "replacement of 1/d^2 near a texel's surface: quad or disc, closed forms; clamp, a least distance; none"},
      {"rsm.clamp", number(SETTING_FIELD(Gather, clampTexels), 0.0, 1000.0), "texels",
       "least distance with rsm.near-field=clamp"},
      {"rsm.interpolate", boolean(SETTING_FIELD(Gather, interpolate)), "",
       "gather at few pixels, interpolate the others where they fit", "[Dachsbacher2005]"},
      {"rsm.low-resolution", number(SETTING_FIELD(Gather, lowResolution), 1, 64), "pixels",
       "between gathered ones, each way", "[Dachsbacher2005]"},
      {"rsm.fit-normal", number(SETTING_FIELD(Gather, fitNormal), -1.0, 1.0), "",
       "least cosine between normals that fit"},
      {"rsm.fit-plane", number(SETTING_FIELD(Gather, fitPlane), 0.0, 1e6), "low-resolution steps",
       "greatest distance off the tangent plane that fits"},
      {"rsm.fit-distance", number(SETTING_FIELD(Gather, fitDistance), 0.0, 1e6), "low-resolution steps",
       "greatest distance that fits"},
      {"rsm.show-refused", boolean(SETTING_FIELD(Gather, showRefused)), "",
       "paint the pixels red that interpolation refused"},
  };
  return table;
}

std::span<const Deviation> rsmDeviations() {
  static const std::vector<Deviation> table{
      LUCERNA_DEVIATION("rsm.flux-cosine", "flux of a texel times the cosine to the light", both,
                        ReflectiveShadowMap::Settings, fluxCosine),
      {"rsm.gather-weight", "samples of the gather weighted by xi^2 instead of xi", DeviationSource::both,
       [](const RenderSettings& s) { return s.of<Gather>().weight == RsmGather::Weight::published; },
       [](RenderSettings& s, bool on) {
         s.of<Gather>().weight = on ? RsmGather::Weight::published : RsmGather::Weight::unbiased;
       }},
      {"rsm.reach", "no light from beyond rsm.radius", DeviationSource::both,
       [](const RenderSettings& s) { return s.of<Gather>().reach == RsmGather::Reach::radius; },
       [](RenderSettings& s, bool on) {
         s.of<Gather>().reach = on ? RsmGather::Reach::radius : RsmGather::Reach::map;
       }},
      {"rsm.unbounded", "1/d^4 without a bound beside a surfel", DeviationSource::both,
       [](const RenderSettings& s) { return s.of<Gather>().nearField == RsmGather::Near::none; },
       [](RenderSettings& s, bool on) {
         s.of<Gather>().nearField = on ? RsmGather::Near::none : RsmGather::Near::quad;
       }}};
  return table;
}

LightModel rsmModel(const RenderSettings&) { return {Transport::oneBounceUnoccluded}; }

bool needsGather(const RenderSettings& settings, const SceneFeatures& features) {
  return settings.component != Component::direct && RsmGather::isNeeded(features);
}

std::unique_ptr<FrameTechnique> makeGather(const FrameParts& parts) { return std::make_unique<RsmFrame>(parts); }

}  // namespace

namespace rsm {

TechniqueEntry technique() {
  return {.name = "rsm",
          .settings = rsmSettings(),
          .deviations = rsmDeviations(),
          .reads = {{"maps"}, {"shadows"}, {"textures"}},
          .stages = {"reflective shadow map", "rsm gather"},
          .model = rsmModel,
          .isNeeded = needsGather,
          .make = makeGather,
          .readsLightMaps = needsGather};
}

}  // namespace rsm

}  // namespace lucerna
