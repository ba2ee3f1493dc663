#include "settings/settings.hpp"

#include "base/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>

namespace lucerna {

namespace {

// ---------------------------------------------------------------------------------------------------- kinds of values

/// Accessor of a value in RenderSettings.
#define FIELD(member) \
  [](auto& s) -> auto& { return s.member; }

template <class Field>
using FieldType = std::remove_cvref_t<decltype(Field{}(std::declval<RenderSettings&>()))>;

SettingValue valueOf(SettingType type, double least = 0.0, double most = 0.0,
                     std::vector<std::string_view> choices = {}) {
  SettingValue value;
  value.type = type;
  value.least = least;
  value.most = most;
  value.choices = std::move(choices);
  return value;
}

template <class Field>
SettingValue boolean(Field) {
  SettingValue value = valueOf(SettingType::boolean, 0.0, 1.0);
  value.get = [](const RenderSettings& s) { return Field{}(s) ? 1.0 : 0.0; };
  value.set = [](RenderSettings& s, double number) { Field{}(s) = number != 0.0; };
  return value;
}

/// Of any arithmetic type; `word` stands for `wordNumber`.
template <class Field>
SettingValue number(Field, double least, double most, std::string_view word = "", double wordNumber = 0.0) {
  using T = FieldType<Field>;
  SettingValue value = valueOf(std::is_integral_v<T> ? SettingType::integer : SettingType::real, least, most);
  value.word = word;
  value.wordNumber = wordNumber;
  value.singlePrecision = std::is_same_v<T, float>;
  value.get = [](const RenderSettings& s) { return static_cast<double>(Field{}(s)); };
  value.set = [](RenderSettings& s, double n) { Field{}(s) = static_cast<T>(n); };
  return value;
}

/// An optional number; "auto" if it is not set.
template <class Field>
SettingValue optionalNumber(Field, double least, double most) {
  using T = typename FieldType<Field>::value_type;
  SettingValue value = valueOf(SettingType::real, least, most);
  value.word = "auto";
  value.wordNumber = std::numeric_limits<double>::quiet_NaN();
  value.singlePrecision = std::is_same_v<T, float>;
  value.get = [](const RenderSettings& s) {
    return Field{}(s) ? static_cast<double>(*Field{}(s)) : std::numeric_limits<double>::quiet_NaN();
  };
  value.set = [](RenderSettings& s, double n) {
    if (std::isnan(n)) Field{}(s).reset();
    else Field{}(s) = static_cast<T>(n);
  };
  return value;
}

template <class Field>
SettingValue choice(Field) {
  using E = FieldType<Field>;
  SettingValue value = valueOf(SettingType::choice);
  for (const std::string_view name : namesOf(E{})) value.choices.push_back(name);
  value.most = static_cast<double>(value.choices.size() - 1);
  value.get = [](const RenderSettings& s) { return static_cast<double>(Field{}(s)); };
  value.set = [](RenderSettings& s, double n) { Field{}(s) = static_cast<E>(static_cast<int>(n)); };
  return value;
}

template <class Field>
SettingValue file(Field) {
  SettingValue value = valueOf(SettingType::file);
  value.getFile = [](const RenderSettings& s) { return Field{}(s).string(); };
  value.setFile = [](RenderSettings& s, const std::string& text) { Field{}(s) = text; };
  return value;
}

/// Bytes, given in MiB; 0 is "auto".
template <class Field>
SettingValue mebibytes(Field, double most) {
  SettingValue value = valueOf(SettingType::real, 0.0, most);
  value.word = "auto";
  value.get = [](const RenderSettings& s) { return static_cast<double>(Field{}(s)) / 1048576.0; };
  value.set = [](RenderSettings& s, double mib) { Field{}(s) = static_cast<std::size_t>(mib * 1048576.0); };
  return value;
}

/// Powers of two up to 64, as required by the groups of lanes that trace paths.
SettingValue raysOfFrame() {
  SettingValue value = valueOf(SettingType::choice, 0.0, 6.0, {"1", "2", "4", "8", "16", "32", "64"});
  value.get = [](const RenderSettings& s) { return std::log2(static_cast<double>(s.cache.rays)); };
  value.set = [](RenderSettings& s, double n) { s.cache.rays = 1 << static_cast<int>(n); };
  return value;
}

/// Whether there is a geometry volume, and whose surfels fill it.
SettingValue blocking() {
  SettingValue value = valueOf(SettingType::choice, 0.0, 3.0, {"rsm", "camera", "both", "off"});
  value.get = [](const RenderSettings& s) { return s.lpv.blocking ? static_cast<double>(s.lpv.surfels) : 3.0; };
  value.set = [](RenderSettings& s, double n) {
    s.lpv.blocking = n < 3.0;
    s.lpv.surfels = s.lpv.blocking ? static_cast<LpvSurfels>(static_cast<int>(n)) : LpvSurfels::rsm;
  };
  return value;
}

/// Pixels per side of a hemicube: its side faces have half as many rows.
template <class Field>
SettingValue evenNumber(Field field, double least, double most) {
  SettingValue value = number(field, least, most);
  value.set = [](RenderSettings& s, double n) { Field{}(s) = 2 * (static_cast<int>(n) / 2); };
  return value;
}

// ---------------------------------------------------------------------------------------------------- the table

constexpr unsigned bit(Technique technique) { return 1u << static_cast<unsigned>(technique); }
constexpr unsigned bit(CacheTransport transport) { return 1u << static_cast<unsigned>(transport); }

constexpr unsigned kDrawn = bit(Technique::direct) | bit(Technique::rsm) | bit(Technique::lpv) |
                            bit(Technique::irradianceCache);  // lit by shadow maps
constexpr SettingReaders kAll{kDrawn | bit(Technique::radiosity) | bit(Technique::path)};
constexpr SettingReaders kTextured{kDrawn | bit(Technique::radiosity)}, kShadowed{kDrawn};
constexpr SettingReaders kRsm{bit(Technique::rsm)}, kRadiosity{bit(Technique::radiosity)}, kPath{bit(Technique::path)};
constexpr SettingReaders kLpv{bit(Technique::lpv)}, kCache{bit(Technique::irradianceCache)};
constexpr SettingReaders kGather{bit(Technique::irradianceCache), bit(CacheTransport::gather)};
constexpr SettingReaders kRays{bit(Technique::irradianceCache), bit(CacheTransport::rays)};
constexpr SettingReaders kMaps{bit(Technique::rsm) | bit(Technique::lpv) | bit(Technique::irradianceCache),
                               bit(CacheTransport::gather)};

const std::vector<Setting>& table() {
  constexpr auto uniform = SettingCost::uniform, rebuild = SettingCost::rebuild, solution = SettingCost::solution;
  static const std::vector<Setting> settings{
      // Light propagation volumes.
      {"lpv.cells", number(FIELD(lpv.cascades.cells), 1, 128), "cells", "along each side of every cascade",
       "[Kaplanyan2010, section 5]", rebuild, kLpv, ""},
      {"lpv.cascades", number(FIELD(lpv.cascades.cascades), 1, MAX_CASCADES), "", "nested grids",
       "[Kaplanyan2010, section 5]", rebuild, kLpv, ""},
      {"lpv.cell-size", number(FIELD(lpv.cascades.cellSize), 0.0, 1e12, "auto"), "scene units",
       "cell size of the coarsest cascade; auto: half of its cells span the scene", "", rebuild, kLpv, ""},
      {"lpv.ratio", number(FIELD(lpv.cascades.ratio), 1.0, 16.0), "",
       "ratio of a cascade's cell size to the next finer one's", "[Kaplanyan2010, section 5]", rebuild, kLpv, ""},
      {"lpv.push", number(FIELD(lpv.cascades.push), 0.0, 1.0), "half extents",
       "offset of the grids ahead of the camera", "[LPV2015, 6.4]", rebuild, kLpv, ""},
      {"lpv.blend", number(FIELD(lpv.blendBand), 0.001, 1.0), "half extents",
       "width of the band over which a cascade fades into the next", "[Kaplanyan2010, section 5]", rebuild, kLpv, ""},
      {"lpv.bounces", number(FIELD(lpv.bounces), 1, 64), "", "reflections before light reaches a surface",
       "[Kaplanyan2010]", rebuild, kLpv, ""},
      {"lpv.iterations", number(FIELD(lpv.iterations), 0, 100000), "steps", "propagation steps",
       "[Kaplanyan2010, section 4.3]", rebuild, kLpv, ""},
      {"lpv.blocking", blocking(), "", "source of the surfels in the geometry volume, which blocks light; off: none",
       "[Kaplanyan2010, section 4.2]", rebuild, kLpv, ""},
      {"lpv.lookup", choice(FIELD(lpv.lookup)), "",
       "irradiance from propagated light: flux, as the kernel sends it through a face; published, 1.91 times as much",
       "[Kaplanyan2010]", rebuild, kLpv, ""},
      {"lpv.lookup-offset", optionalNumber(FIELD(lpv.lookupOffset), 0.0, 4.0), "cells",
       "offset along the normal before the lookup", "[Kaplanyan2010]", rebuild, kLpv,
       "auto: 0, with lpv.lookup=published 0.5"},
      {"lpv.hand-over", number(FIELD(lpv.handOver), 0, 100000, "auto"), "steps",
       "steps after which finer cascades take a coarser one's light; auto: from iterations and ratio", "", rebuild,
       kLpv, ""},
      {"lpv.shafts", boolean(FIELD(lpv.shafts)), "",
       "light shafts: single scattering along the view in the scene's homogeneous medium", "[LPV2015]", rebuild, kLpv,
       ""},
      {"lpv.shaft-steps", number(FIELD(lpv.shaftSteps), 1, 4096), "steps", "of light shafts along a view ray", "",
       rebuild, kLpv, ""},
      {"lpv.glossy", boolean(FIELD(lpv.glossy)), "",
       "glossy reflection of the volume's light, along reflected rays to the first surfels of the geometry volume", "",
       rebuild, kLpv, ""},
      {"lpv.glossy-steps", number(FIELD(lpv.glossySteps), 1, 1024), "cells", "along a reflected ray, at most", "",
       rebuild, kLpv, ""},
      {"lpv.fill", choice(FIELD(lpv.fill)), "",
       "how the grid is filled: layered, by blending; atomic, in floats; fixed, in integers, the same bits every run",
       "", rebuild, kLpv, ""},
      {"lpv.tile", number(FIELD(lpv.tile), 1, 16), "texels",
       "with lpv.fill=atomic or fixed: side of the square added up before an atomic; 1: one atomic per texel, as "
       "published",
       "[LPV2015]", rebuild, kLpv, ""},
      {"lpv.propagate", choice(FIELD(lpv.propagate)), "",
       "compute; layered: one pass per step and cascade, one point per cell, as published", "[LPV2015]", rebuild, kLpv,
       ""},
      {"lpv.amplifier", number(FIELD(lpv.amplifier), 0.0, 100.0), "",
       "factor of the deviation lpv.four-pi-kernel; 4 conserves energy", "[LPV2015]", rebuild, kLpv, ""},
      // The irradiance cache.
      {"cache.transport", choice(FIELD(cache.transport)), "",
       "source of a record's light: rays, along paths; gather, from the lights' maps and a bounce cache", "", rebuild,
       kCache, ""},
      {"cache.cells", number(FIELD(cache.cascades.cells), 1, 128), "cells", "along each side of every cascade", "",
       rebuild, kCache, ""},
      {"cache.cascades", number(FIELD(cache.cascades.cascades), 1, MAX_CASCADES), "", "nested grids",
       "[Kaplanyan2010, section 5]", rebuild, kCache, ""},
      {"cache.cell-size", number(FIELD(cache.cascades.cellSize), 0.0, 1e12, "auto"), "scene units",
       "cell size of the coarsest cascade; auto: half of its cells span the scene", "", rebuild, kCache, ""},
      {"cache.ratio", number(FIELD(cache.cascades.ratio), 1.0, 16.0), "",
       "ratio of a cascade's cell size to the next finer one's", "", rebuild, kCache, ""},
      {"cache.push", number(FIELD(cache.cascades.push), 0.0, 1.0), "half extents",
       "offset of the grids ahead of the camera", "[LPV2015, 6.4]", rebuild, kCache, ""},
      {"cache.blend", number(FIELD(cache.blendBand), 0.001, 1.0), "of its reach",
       "width of the band over which a cascade fades into the next", "", rebuild, kCache, ""},
      {"cache.bounces", number(FIELD(cache.bounces), 1, 64, "all", IrradianceCacheSettings::kAllBounces), "",
       "reflections before light reaches a surface", "", rebuild, kCache, ""},
      {"cache.visibility", choice(FIELD(cache.visibility)), "",
       "occlusion of light gathered from maps and emissive surfaces: none, or by rays", "", rebuild, kGather, ""},
      {"cache.bounce-cells", number(FIELD(cache.bounceCells), 1, 64), "cells",
       "along the longest side of the scene: of the bounce cache", "", rebuild, kGather, ""},
      {"cache.rays", raysOfFrame(), "paths", "per record and frame", "", rebuild, kRays, ""},
      {"cache.least-rays", number(FIELD(cache.leastRays), 1, 1 << 20), "paths",
       "of a record in its first frame, at least", "", rebuild, kRays, ""},
      {"cache.samples", number(FIELD(cache.samples), 1, 1 << 24), "paths",
       "of a record while light and geometry are static", "", rebuild, kRays, ""},
      {"cache.prefetch", number(FIELD(cache.prefetch), 0, 1 << 16), "directions",
       "around the camera, in which surfaces get records before they come into view, while it moves", "", rebuild,
       kCache, ""},
      {"cache.most-change", number(FIELD(cache.mostChange), 0.0, 1.0), "",
       "largest relative change of a record's shown irradiance per frame; 0: no limit", "", rebuild, kCache, ""},
      // Reflective shadow maps and their gather.
      {"rsm.size", number(FIELD(rsm.size), 1, 8192), "texels",
       "side of the reflective shadow map; an omnidirectional light's faces have half of it", "[Dachsbacher2005]",
       rebuild, kMaps, ""},
      {"rsm.samples", number(FIELD(gather.samples), 1, 65536), "samples", "of the map for a gathered point",
       "[Dachsbacher2005]", rebuild, kRsm, ""},
      {"rsm.radius", number(FIELD(gather.radius), 1e-4, 2.0), "sides of the map", "reach of the gather",
       "[Dachsbacher2005]", rebuild, kRsm, ""},
      {"rsm.weight", choice(FIELD(gather.weight)), "", "of a sample: unbiased, xi; published, xi^2",
       "[Dachsbacher2005]", rebuild, kRsm, ""},
      {"rsm.rotation", choice(FIELD(gather.rotation)), "", "noise: the sample pattern is turned from pixel to pixel",
       "[Jimenez2014]", rebuild, kRsm, ""},
      {"rsm.near-field", choice(FIELD(gather.nearField)), "",
       "replacement of 1/d^2 near a texel's surface: quad or disc, closed forms; clamp, a least distance; none", "",
       rebuild, kRsm, ""},
      {"rsm.clamp", number(FIELD(gather.clampTexels), 0.0, 1000.0), "texels",
       "least distance with rsm.near-field=clamp", "", rebuild, kRsm, ""},
      {"rsm.interpolate", boolean(FIELD(gather.interpolate)), "",
       "gather at few pixels, interpolate the others where they fit", "[Dachsbacher2005]", rebuild, kRsm, ""},
      {"rsm.low-resolution", number(FIELD(gather.lowResolution), 1, 64), "pixels", "between gathered ones, each way",
       "[Dachsbacher2005]", rebuild, kRsm, ""},
      {"rsm.fit-normal", number(FIELD(gather.fitNormal), -1.0, 1.0), "", "least cosine between normals that fit", "",
       rebuild, kRsm, ""},
      {"rsm.fit-plane", number(FIELD(gather.fitPlane), 0.0, 1e6), "low-resolution steps",
       "greatest distance off the tangent plane that fits", "", rebuild, kRsm, ""},
      {"rsm.fit-distance", number(FIELD(gather.fitDistance), 0.0, 1e6), "low-resolution steps",
       "greatest distance that fits", "", rebuild, kRsm, ""},
      {"rsm.show-refused", boolean(FIELD(gather.showRefused)), "", "paint the pixels red that interpolation refused",
       "", rebuild, kRsm, ""},
      // Radiosity.
      {"radiosity.edge", number(FIELD(radiosity.solution.patches.longestEdge), 0.0, 1e12, "auto"), "scene units",
       "longest edge of a patch; auto: a 12th of the scene", "", solution, kRadiosity, ""},
      {"radiosity.resolution", evenNumber(FIELD(radiosity.solution.hemicubes.resolution), 2, 4096), "pixels",
       "side of a hemicube; even", "[CohenGreenberg1985]", solution, kRadiosity, ""},
      {"radiosity.visibility", choice(FIELD(radiosity.solution.hemicubes.visibility)), "",
       "how a hemicube's pixels find the visible patch; auto: the fastest, measured at start", "[CohenGreenberg1985]",
       solution, kRadiosity, ""},
      {"radiosity.error", number(FIELD(radiosity.solution.error), 1e-12, 10.0), "",
       "guaranteed relative error of the solution", "", solution, kRadiosity, ""},
      {"radiosity.solver", choice(FIELD(radiosity.solution.solver)), "", "of the linear system", "[Gortler1993]",
       solution, kRadiosity, ""},
      {"radiosity.products", number(FIELD(radiosity.solution.mostProducts), 1, 100000000), "products",
       "with the form factor matrix, at most", "", solution, kRadiosity, ""},
      {"radiosity.refinements", number(FIELD(radiosity.solution.refinements), 0, 8), "",
       "how often patches are halved where light changes steeply", "[Rivara1984]", solution, kRadiosity, ""},
      {"radiosity.steep", number(FIELD(radiosity.solution.steep), 1e-6, 1e6), "mean irradiance",
       "difference between neighbouring patches that is refined", "", solution, kRadiosity, ""},
      {"radiosity.seed", number(FIELD(radiosity.solution.hemicubes.seed), 0, 4294967295.0), "",
       "of the hemicubes' random roll", "", solution, kRadiosity, ""},
      {"radiosity.rolls", number(FIELD(radiosity.solution.hemicubes.rolls), 1, 64), "hemicubes",
       "per patch, turned against each other, whose mean counts: antialiasing; twice the resolution is better (4 rolls "
       "cost as much)",
       "[RAD2008]", solution, kRadiosity, ""},
      {"radiosity.exact-pixels", number(FIELD(radiosity.solution.hemicubes.exactPixels), 0, 1 << 24), "pixels",
       "covered by a patch that gets its closed form factor; 0: never", "[Lambert1760]", solution, kRadiosity, ""},
      {"radiosity.part-distance", number(FIELD(radiosity.solution.hemicubes.nearDistance), 0.0, 1e6), "part sizes",
       "receivers are divided until their sources are this far away; 0: never", "[BaumRushmeierWinget1989]", solution,
       kRadiosity, ""},
      {"radiosity.parts", number(FIELD(radiosity.solution.hemicubes.mostParts), 1, 64), "parts",
       "along each side of a divided receiver, at most", "[BaumRushmeierWinget1989]", solution, kRadiosity, ""},
      {"radiosity.repair", boolean(FIELD(radiosity.solution.repair)), "",
       "repair reciprocity and row sums of the form factors", "[Sinkhorn1964]", solution, kRadiosity, ""},
      {"radiosity.memory", mebibytes(FIELD(radiosity.solution.memoryBytes), 1 << 30), "MiB",
       "for form factors; the rest is recomputed; auto: half of the free memory", "", solution, kRadiosity, ""},
      {"radiosity.batch", mebibytes(FIELD(radiosity.solution.hemicubes.batchBytes), 1e6), "MiB",
       "of GPU memory for the hemicubes of one submission; auto: depends on the renderer", "", solution, kRadiosity,
       ""},
      {"radiosity.file", file(FIELD(radiosity.file)), "", "a solution: loaded if it exists, else saved there", "",
       rebuild, kRadiosity, "none"},
      {"radiosity.mapping", choice(FIELD(radiosity.mapping)), "", "of radiance to the display", "[RAD2008]", rebuild,
       kRadiosity, ""},
      {"radiosity.decades", number(FIELD(radiosity.decades), 0.1, 30.0), "powers of ten",
       "that the mappings log and false-colours span", "", rebuild, kRadiosity, ""},
      {"radiosity.mesh", boolean(FIELD(radiosity.mesh)), "", "draw the edges of patches", "", rebuild, kRadiosity, ""},
      {"radiosity.flat", boolean(FIELD(radiosity.flat)), "", "show patches without interpolation", "", rebuild,
       kRadiosity, ""},
      {"radiosity.direct", choice(FIELD(radiosity.direct)), "",
       "direct light: pixels, by shadow rays per pixel; patches, one value per patch; auto: pixels in render, patches "
       "elsewhere",
       "", rebuild, kRadiosity, ""},
      {"radiosity.shadow-rays", number(FIELD(radiosity.shadowRays), 1, 4096), "rays",
       "a pixel with radiosity.direct=pixels, divided among the emissive triangles", "", rebuild, kRadiosity, ""},
      // Path tracing.
      {"path.samples", number(FIELD(path.samples), 1, 4000000000.0), "samples",
       "a pixel, of a finished picture (--spp)", "", rebuild, kPath, ""},
      {"path.least-samples", number(FIELD(path.leastSamples), 1, 4000000000.0), "samples",
       "a pixel in the first frame of a view, at least", "", rebuild, kPath, ""},
      {"path.scatterings", number(FIELD(path.scatterings), 0, 1000000, "all", PathSettings::kAllScatterings), "",
       "between light and camera; light that was scattered more often is left out (--bounces; 2 is one bounce)", "",
       rebuild, kPath, ""},
      {"path.seed", number(FIELD(path.seed), 0, 4294967295.0), "", "of the random numbers (--seed)", "", rebuild, kPath,
       ""},
      // Shadow maps, textures, the frame.
      {"shadow.size", number(FIELD(shadow.size), 1, 16384), "texels", "side of the sun's shadow map, of each cascade",
       "", rebuild, kShadowed, ""},
      {"shadow.cascades", number(FIELD(sunCascades.cascades), 1, SUN_MAX_CASCADES), "",
       "shadow maps of the sun along the view; 1: one for the whole scene", "[Zhang2006]", rebuild, kShadowed, ""},
      {"shadow.split", number(FIELD(sunCascades.split), 0.0, 1.0), "",
       "how cascades divide the view's depth: 0 uniformly, 1 logarithmically", "[Zhang2006, section 3.2]", rebuild,
       kShadowed, ""},
      {"shadow.spot-size", number(FIELD(lights.spotSize), 1, 16384), "texels", "side of a spot light's shadow map", "",
       rebuild, kShadowed, ""},
      {"shadow.point-size", number(FIELD(lights.pointSize), 1, 16384), "texels",
       "side of each face of an omnidirectional light's shadow map", "", rebuild, kShadowed, ""},
      {"texture.anisotropy", number(FIELD(textures.anisotropy), 1.0, 16.0), "",
       "anisotropic filtering of what is seen, at most; 1 without mipmaps", "", rebuild, kTextured, ""},
      {"texture.mipmaps", boolean(FIELD(textures.mipmaps)), "",
       "textures in smaller versions with distance; off: they flicker", "[LPV2015]", rebuild, kTextured, ""},
      {"frame.reuse", boolean(FIELD(reuse)), "", "reuse unchanged results of the previous frame: maps, volume, cache",
       "", uniform, kTextured, ""},
      {"exposure", optionalNumber(FIELD(exposure), 1e-12, 1e12), "", "multiplies radiance before tone mapping", "",
       uniform, kAll, "auto: the scene's"},
  };
  return settings;
}

#undef FIELD

// ---------------------------------------------------------------------------------------------------- text

std::string numberText(const SettingValue& value, double number) {
  if (!value.word.empty() && (number == value.wordNumber || (std::isnan(number) && std::isnan(value.wordNumber))))
    return std::string(value.word);
  if (value.type == SettingType::integer) return fmt::format("{}", static_cast<long long>(number));
  return value.singlePrecision ? fmt::format("{}", static_cast<float>(number)) : fmt::format("{}", number);
}

std::string joined(const std::vector<std::string_view>& words) { return fmt::format("{}", fmt::join(words, ", ")); }

/// The number as stored in the setting's type: a rounded float is brought back within its bounds.
double held(const SettingValue& value, double number) {
  return value.singlePrecision ? static_cast<double>(static_cast<float>(number)) : number;
}

bool isWithin(const SettingValue& value, double number) {
  return held(value, number) >= held(value, value.least) && held(value, number) <= held(value, value.most);
}

[[noreturn]] void refuse(const Setting& setting, std::string_view value, std::string_view where) {
  const std::string begin = fmt::format("{}{}: '{}' is ", where, setting.key, value);
  switch (setting.value.type) {
    case SettingType::boolean: throwBadInput("{}neither on nor off", begin);
    case SettingType::choice: throwBadInput("{}unknown; expected one of {}", begin, joined(setting.value.choices));
    case SettingType::integer: throwBadInput("{}not a whole number from {}", begin, allowedValues(setting));
    case SettingType::real: throwBadInput("{}not a number from {}", begin, allowedValues(setting));
    case SettingType::file: throwBadInput("{}no name of a file", begin);
  }
  CHECK(false, "type {}", static_cast<int>(setting.value.type));
}

template <class T>
std::optional<double> parsed(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return static_cast<double>(value);
}

}  // namespace

std::span<const Setting> allSettings() { return table(); }

const Setting* findSetting(std::string_view key) {
  const auto found = std::find_if(table().begin(), table().end(), [&](const Setting& s) { return s.key == key; });
  return found == table().end() ? nullptr : &*found;
}

SettingAssignment parseAssignment(std::string_view assignment, std::string_view where, const SettingCost* only) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) throwBadInput("{}{}: expected key=value", where, assignment);
  const Setting* setting = findSetting(assignment.substr(0, equals));
  if (setting && (!only || setting->cost == *only)) return {setting, std::string(assignment.substr(equals + 1))};
  std::vector<std::string_view> keys;
  for (const Setting& s : table())
    if (!only || s.cost == *only) keys.push_back(s.key);
  throwBadInput("{}{}: unknown key; expected one of {}", where, assignment, joined(keys));
}

std::string printSetting(const Setting& setting, const RenderSettings& settings) {
  const SettingValue& value = setting.value;
  if (value.type == SettingType::file) return value.getFile(settings);
  const double number = value.get(settings);
  if (value.type == SettingType::boolean) return number != 0.0 ? "on" : "off";
  if (value.type == SettingType::choice) return std::string(value.choices.at(static_cast<std::size_t>(number)));
  return numberText(value, number);
}

void parseSetting(const Setting& setting, RenderSettings& settings, std::string_view text, std::string_view where) {
  const SettingValue& value = setting.value;
  const auto set = [&](std::optional<double> number) {
    if (!number || !isWithin(value, *number)) refuse(setting, text, where);
    value.set(settings, *number);
  };
  switch (value.type) {
    case SettingType::file: value.setFile(settings, std::string(text)); return;
    case SettingType::boolean:
      for (const std::string_view on : {"on", "true", "1"})
        if (text == on) return set(1.0);
      for (const std::string_view off : {"off", "false", "0"})
        if (text == off) return set(0.0);
      refuse(setting, text, where);
    case SettingType::choice: {
      const auto found = std::find(value.choices.begin(), value.choices.end(), text);
      if (found == value.choices.end()) refuse(setting, text, where);
      return set(static_cast<double>(found - value.choices.begin()));
    }
    case SettingType::integer:
    case SettingType::real:
      if (!value.word.empty() && text == value.word) return value.set(settings, value.wordNumber);
      return set(value.type == SettingType::integer ? parsed<long long>(text) : parsed<double>(text));
  }
}

double settingNumber(const Setting& setting, const RenderSettings& settings) {
  CHECK(setting.value.get, "{} is no number", setting.key);
  return setting.value.get(settings);
}

void setSettingNumber(const Setting& setting, RenderSettings& settings, double number) {
  const SettingValue& value = setting.value;
  CHECK(value.set, "{} is no number", setting.key);
  const bool isWord =
      !value.word.empty() && (number == value.wordNumber || (std::isnan(number) && std::isnan(value.wordNumber)));
  if (value.type != SettingType::real && std::isfinite(number)) number = std::round(number);
  if (!isWord && !isWithin(value, number)) refuse(setting, fmt::format("{}", number), "");
  value.set(settings, number);
}

std::string allowedValues(const Setting& setting) {
  const SettingValue& value = setting.value;
  switch (value.type) {
    case SettingType::boolean: return "on or off";
    case SettingType::choice: return joined(value.choices);
    case SettingType::file: return "a file";
    case SettingType::integer:
    case SettingType::real: break;
  }
  // Bounds as numbers, even if a word stands for one of them.
  SettingValue plain;
  plain.type = value.type;
  return fmt::format("{} to {}{}", numberText(plain, value.least), numberText(plain, value.most),
                     value.word.empty() ? "" : fmt::format(", or {}", value.word));
}

std::string defaultValue(const Setting& setting) {
  return setting.usually.empty() ? printSetting(setting, RenderSettings{}) : std::string(setting.usually);
}

bool isReadBy(const Setting& setting, Technique technique) {
  return (setting.readers.techniques & bit(technique)) != 0;
}

bool isReadBy(const Setting& setting, CacheTransport transport) {
  return isReadBy(setting, Technique::irradianceCache) && (setting.readers.transports & bit(transport)) != 0;
}

bool isRead(const Setting& setting, const RenderSettings& settings) {
  return settings.technique == Technique::irradianceCache ? isReadBy(setting, settings.cache.transport)
                                                          : isReadBy(setting, settings.technique);
}

std::optional<Technique> onlyTechnique(const Setting& setting) {
  for (std::size_t i = 0; i < namesOf(Technique{}).size(); ++i)
    if (setting.readers.techniques == 1u << i) return static_cast<Technique>(i);
  return {};
}

std::optional<CacheTransport> onlyTransport(const Setting& setting) {
  for (const CacheTransport transport : {CacheTransport::rays, CacheTransport::gather})
    if (isReadBy(setting, Technique::irradianceCache) && setting.readers.transports == bit(transport)) return transport;
  return {};
}

}  // namespace lucerna
