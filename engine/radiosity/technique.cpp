// Technique radiosity: its settings, its deviations and its entry in the list of techniques.
#include "radiosity/radiosity_frame.hpp"

namespace lucerna {

namespace {

using View = RadiosityView::Settings;

std::span<const Setting> radiositySettings() {
  using namespace setting_values;
  constexpr auto rebuild = SettingCost::rebuild, solution = SettingCost::solution;
  static const std::vector<Setting> table{
      {"radiosity.edge", number(SETTING_FIELD(View, solution.patches.longestEdge), 0.0, 1e12, "auto"), "scene units",
       "longest edge of a patch; auto: a 12th of the scene", "", solution},
      {"radiosity.resolution", evenNumber(SETTING_FIELD(View, solution.hemicubes.resolution), 2, 4096), "pixels",
       "side of a hemicube; even", "[CohenGreenberg1985]", solution},
      {"radiosity.visibility", choice(SETTING_FIELD(View, solution.hemicubes.visibility)), "",
       "how a hemicube's pixels find the visible patch; auto: the fastest, measured at start", "[CohenGreenberg1985]",
       solution},
      {"radiosity.error", number(SETTING_FIELD(View, solution.error), 1e-12, 10.0), "",
       "guaranteed relative error of the solution", "", solution},
      {"radiosity.solver", choice(SETTING_FIELD(View, solution.solver)), "", "of the linear system", "[Gortler1993]",
       solution},
      {"radiosity.products", number(SETTING_FIELD(View, solution.mostProducts), 1, 100000000), "products",
       "with the form factor matrix, at most", "", solution},
      {"radiosity.refinements", number(SETTING_FIELD(View, solution.refinements), 0, 8), "",
       "how often patches are halved where light changes steeply", "[Rivara1984]", solution},
      {"radiosity.steep", number(SETTING_FIELD(View, solution.steep), 1e-6, 1e6), "mean irradiance",
       "difference between neighbouring patches that is refined", "", solution},
      {"radiosity.seed", number(SETTING_FIELD(View, solution.hemicubes.seed), 0, 4294967295.0), "",
       "of the hemicubes' random roll", "", solution},
      {"radiosity.rolls", number(SETTING_FIELD(View, solution.hemicubes.rolls), 1, 64), "hemicubes",
       "per patch, turned against each other and averaged: antialiasing; twice the resolution is better (4 rolls "
       "cost as much)",
       "[RAD2008]", solution},
      {"radiosity.exact-pixels", number(SETTING_FIELD(View, solution.hemicubes.exactPixels), 0, 1 << 24), "pixels",
       "covered by a patch that gets its closed form factor; 0: never", "[Lambert1760]", solution},
      {"radiosity.part-distance", number(SETTING_FIELD(View, solution.hemicubes.nearDistance), 0.0, 1e6), "part sizes",
       "receivers are divided until their sources are this far away; 0: never", "[BaumRushmeierWinget1989]", solution},
      {"radiosity.parts", number(SETTING_FIELD(View, solution.hemicubes.mostParts), 1, 64), "parts",
       "along each side of a divided receiver, at most", "[BaumRushmeierWinget1989]", solution},
      {"radiosity.repair", boolean(SETTING_FIELD(View, solution.repair)), "",
       "repair reciprocity and row sums of the form factors", "[Sinkhorn1964]", solution},
      {"radiosity.memory", mebibytes(SETTING_FIELD(View, solution.memoryBytes), 1 << 30), "MiB",
       "for form factors; the rest is recomputed; auto: half of the free memory", "", solution},
      {"radiosity.batch", mebibytes(SETTING_FIELD(View, solution.hemicubes.batchBytes), 1e6), "MiB",
       "of GPU memory for the hemicubes of one submission; auto: depends on the renderer", "", solution},
      {"radiosity.file", file(SETTING_FIELD(View, file)), "", "a solution: loaded if it exists, else saved there", "",
       rebuild, "", "none"},
      {"radiosity.mapping", choice(SETTING_FIELD(View, mapping)), "", "of radiance to the display", "[RAD2008]"},
      {"radiosity.decades", number(SETTING_FIELD(View, decades), 0.1, 30.0), "powers of ten",
       "that the mappings log and false-colours span"},
      {"radiosity.mesh", boolean(SETTING_FIELD(View, mesh)), "", "draw the edges of patches"},
      {"radiosity.flat", boolean(SETTING_FIELD(View, flat)), "", "show patches without interpolation"},
      {"radiosity.direct", choice(SETTING_FIELD(View, direct)), "",
       "direct light: pixels, by shadow rays per pixel; patches, one value per patch; auto: pixels in render without "
       "deviations, patches elsewhere"},
      {"radiosity.shadow-rays", number(SETTING_FIELD(View, shadowRays), 1, 4096), "rays",
       "a pixel with radiosity.direct=pixels, divided among the emissive triangles"},
  };
  return table;
}

/// Those with a switch in the table of settings.hpp, which its files and the published solver use.
template <bool RadiosityDeviations::*kMember>
Deviation radiosityDeviation() {
  const auto all = allRadiosityDeviations();
  const auto found =
      std::find_if(all.begin(), all.end(), [](const RadiosityDeviation& d) { return d.member == kMember; });
  return {found->name, found->meaning, DeviationSource::both,
          [](const RenderSettings& s) { return s.of<View>().solution.deviations.*kMember; },
          [](RenderSettings& s, bool on) { s.of<View>().solution.deviations.*kMember = on; }};
}

std::span<const Deviation> radiosityDeviations() {
  static const std::vector<Deviation> table{radiosityDeviation<&RadiosityDeviations::publishedMap>(),
                                            radiosityDeviation<&RadiosityDeviations::centroid>(),
                                            radiosityDeviation<&RadiosityDeviations::fixedOrientation>(),
                                            radiosityDeviation<&RadiosityDeviations::noNearField>()};
  return table;
}

LightModel radiosityModel(const RenderSettings&) { return {Transport::all, 0, true}; }

std::unique_ptr<FrameTechnique> makeRadiosity(const FrameParts& parts) {
  return std::make_unique<RadiosityFrame>(parts);
}

}  // namespace

namespace radiosity {

TechniqueEntry technique() {
  return {.name = "radiosity",
          .settings = radiositySettings(),
          .deviations = radiosityDeviations(),
          .reads = {{"textures"}},
          .stages = {"radiosity", "shadow rays"},
          .model = radiosityModel,
          .isNeeded = [](const RenderSettings&, const SceneFeatures&) { return true; },
          .make = makeRadiosity,
          .drawsSurfaces = false};
}

}  // namespace radiosity

}  // namespace lucerna
