// Technique irradiance-cache: its settings, its deviations and its entry in the list of techniques.
#include "cascades/cascade_settings.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"

namespace lucerna {

namespace {

using namespace setting_values;

/// Powers of two up to 64, as required by the groups of lanes that trace paths.
SettingValue raysOfFrame() {
  SettingValue value = valueOf(SettingType::choice, 0.0, 6.0, {"1", "2", "4", "8", "16", "32", "64"});
  value.get = [](const RenderSettings& s) {
    return std::log2(static_cast<double>(s.of<IrradianceCacheSettings>().rays));
  };
  value.set = [](RenderSettings& s, double n) { s.of<IrradianceCacheSettings>().rays = 1 << static_cast<int>(n); };
  return value;
}

std::span<const Setting> cacheSettings() {
  constexpr auto rebuild = SettingCost::rebuild;
  static const std::vector<Setting> table{
      CASCADE_SETTINGS("cache", IrradianceCacheSettings, "[Kaplanyan2010, section 5]", "", ""),
      {"cache.transport", choice(SETTING_FIELD(IrradianceCacheSettings, transport)), "",
       "source of a record's light: rays, along paths; gather, from the lights' maps and a bounce cache"},
      {"cache.blend", number(SETTING_FIELD(IrradianceCacheSettings, blendBand), 0.001, 1.0), "of its reach",
       "width of the band over which a cascade fades into the next; a fifth of it in finished pictures"},
      {"cache.bounces",
       number(SETTING_FIELD(IrradianceCacheSettings, bounces), 1, 64, "all", IrradianceCacheSettings::kAllBounces), "",
       "reflections before light reaches a surface"},
      {"cache.visibility", choice(SETTING_FIELD(IrradianceCacheSettings, visibility)), "",
       "occlusion of light gathered from maps and emissive surfaces: none, or by rays", "", rebuild,
       "cache.transport=gather"},
      {"cache.bounce-cells", number(SETTING_FIELD(IrradianceCacheSettings, bounceCells), 1, 64), "cells",
       "of the bounce cache along the longest side of the scene", "", rebuild, "cache.transport=gather"},
      {"cache.rays", raysOfFrame(), "paths", "per record and frame", "", rebuild, "cache.transport=rays"},
      {"cache.least-rays", number(SETTING_FIELD(IrradianceCacheSettings, leastRays), 1, 1 << 20), "paths",
       "of a record in its first frame, at least", "", rebuild, "cache.transport=rays"},
      {"cache.samples", number(SETTING_FIELD(IrradianceCacheSettings, samples), 1, 1 << 24), "paths",
       "of a record while light and geometry are static", "", rebuild, "cache.transport=rays"},
      {"cache.split", number(SETTING_FIELD(IrradianceCacheSettings, split), 1, 8), "parts a side",
       "of a cell where surfaces are close, in finished pictures; 1: no cell is split", "", rebuild,
       "cache.transport=rays"},
      {"cache.split-share", number(SETTING_FIELD(IrradianceCacheSettings, splitShare), 0.0, 100.0), "",
       "paths of all parts of cells over those of all cells", "", rebuild, "cache.transport=rays"},
      {"cache.smooths", boolean(SETTING_FIELD(IrradianceCacheSettings, smooths)), "",
       "in finished pictures, noise of records is smoothed, and records that count little have fewer paths", "",
       rebuild, "cache.transport=rays"},
      {"cache.keeps-hits", boolean(SETTING_FIELD(IrradianceCacheSettings, keepsHits)), "",
       "in a moving scene, records are relit, and only paths that meet what has moved are traced again", "", rebuild,
       "cache.transport=rays"},
      {"cache.traced",
       number(SETTING_FIELD(IrradianceCacheSettings, tracedPaths), 1, 1 << 20, "all",
              IrradianceCacheSettings::kAllPaths),
       "paths", "of kept ones traced again per frame of a moving scene, at most", "", rebuild, "cache.transport=rays"},
      {"cache.prefetch", number(SETTING_FIELD(IrradianceCacheSettings, prefetch), 0, 1 << 16), "directions",
       "around a moving camera in which surfaces get records before they come into view"},
      {"cache.reflections", number(SETTING_FIELD(IrradianceCacheSettings, reflections), 0, 1024), "rays",
       "per pixel of a coat, a mirror or glass, for its reflections; 0: lamps alone"},
      {"cache.most-change", number(SETTING_FIELD(IrradianceCacheSettings, mostChange), 0.0, 1.0), "",
       "largest relative change of a record's shown irradiance per frame; 0: no limit"},
  };
  return table;
}

LightModel cacheModel(const RenderSettings& settings) {
  const auto& cache = settings.of<IrradianceCacheSettings>();
  if (cache.bounces != 1) return {Transport::indirect, cache.bounces, true};
  const bool isOccluded = cache.transport == CacheTransport::rays || cache.visibility == GatherVisibility::rays;
  return {isOccluded ? Transport::oneBounce : Transport::oneBounceUnoccluded, 0, true};
}

std::unique_ptr<FrameTechnique> makeCache(const FrameParts& parts) {
  return std::make_unique<IrradianceCacheFrame>(parts);
}

}  // namespace

namespace irradiance_cache {

TechniqueEntry technique() {
  return {.name = "irradiance-cache",
          .settings = cacheSettings(),
          .reads = {{"maps", "cache.transport=gather"}, {"shadows"}, {"textures"}},
          .stages = {"reflective shadow map", "irradiance cache"},
          .model = cacheModel,
          .isNeeded = IrradianceCacheFrame::isNeeded,
          .make = makeCache,
          .drawsReflections = true,
          .media = TechniqueEntry::Media::preview,
          .readsLightMaps = IrradianceCacheFrame::takesMaps,
          .prepare = IrradianceCacheFrame::prepare};
}

}  // namespace irradiance_cache

}  // namespace lucerna
