#include "bench/sweep.hpp"

#include "base/error.hpp"
#include "render/deviations.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

namespace lucerna::demo::bench {

namespace {

SweepPoint point(const std::string& technique, const std::string& series, std::vector<std::string> settings,
                 const std::string& fidelity = "corrected") {
  SweepPoint r;
  r.series = technique + (series.empty() ? "" : " " + series) + (fidelity == "original" ? " (original)" : "");
  r.picture.technique = technique;
  r.picture.fidelity = fidelity;
  r.picture.settings = std::move(settings);
  r.isStep = !series.empty() && series != "gather visibility" && fidelity == "corrected";
  return r;
}

std::vector<SweepPoint> rsmSweep(bool shrink) {
  std::vector<SweepPoint> points;
  for (const bool interpolate : {true, false})
    for (int samples : {16, 50, 100, 200, 400, 800, 1600}) {
      if (shrink && samples > (interpolate ? 800 : 400)) continue;
      points.push_back(point(
          "rsm", interpolate ? "interpolated" : "full",
          {fmt::format("rsm.samples={}", samples), fmt::format("rsm.interpolate={}", interpolate ? "on" : "off")}));
    }
  for (int samples : {50, 400})
    points.push_back(point("rsm", "", {fmt::format("rsm.samples={}", samples)}, "original"));
  return points;
}

std::vector<SweepPoint> lpvSweep(bool shrink) {
  std::vector<SweepPoint> points;
  for (int cells : {8, 16, 32, 64})
    if (!shrink || cells < 64) points.push_back(point("lpv", "cells", {fmt::format("lpv.cells={}", cells)}));
  for (int cascades : {1, 2, 3, 4})
    points.push_back(point("lpv", "cascades", {fmt::format("lpv.cascades={}", cascades)}));
  for (int iterations : {2, 4, 8, 16, 32})
    points.push_back(point("lpv", "iterations", {fmt::format("lpv.iterations={}", iterations)}));
  // Each number of bounces has a separate reference.
  for (int bounces : {1, 2, 4})
    if (!shrink || bounces != 2) points.push_back(point("lpv", "bounces", {fmt::format("lpv.bounces={}", bounces)}));
  for (int iterations : {8, 12})
    points.push_back(point("lpv", "", {fmt::format("lpv.iterations={}", iterations)}, "original"));
  return points;
}

std::vector<SweepPoint> cacheSweep(bool shrink) {
  std::vector<SweepPoint> points;
  const auto gather = [&](const char* series, std::vector<std::string> settings) {
    settings.insert(settings.begin(), "cache.transport=gather");
    points.push_back(point("irradiance-cache", std::string("gather ") + series, std::move(settings)));
  };
  for (int cells : {16, 32, 64})
    if (!shrink || cells < 64) gather("cells", {"cache.bounces=1", fmt::format("cache.cells={}", cells)});
  for (int size : {64, 128, 256, 512})
    if (!shrink || size < 512) gather("map", {"cache.bounces=1", fmt::format("rsm.size={}", size)});
  for (int cells : {8, 16, 32})
    if (!shrink || cells < 32) gather("bounce cells", {fmt::format("cache.bounce-cells={}", cells)});
  if (!shrink) gather("visibility", {"cache.bounces=1", "cache.visibility=none"});
  // Along paths.
  const auto rays = [&](const char* series, std::string setting) {
    points.push_back(point("irradiance-cache", std::string("rays ") + series, {std::move(setting)}));
  };
  for (int samples : {16, 64, 256, 1024})
    if (!shrink || samples < 1024) rays("samples", fmt::format("cache.samples={}", samples));
  for (int cells : {16, 32, 64})
    if (!shrink || cells < 64) rays("cells", fmt::format("cache.cells={}", cells));
  // The least that records cost: one cascade and few paths.
  for (int cells : {8, 16, 32})
    points.push_back(point("irradiance-cache", "rays coarse",
                           {"cache.samples=16", "cache.cascades=1", fmt::format("cache.cells={}", cells)}));
  // Each cascade more halves the finest cells.
  for (int cascades : {2, 3, 4})
    if (!shrink)
      points.push_back(
          point("irradiance-cache", "rays cascades", {"cache.cells=64", fmt::format("cache.cascades={}", cascades)}));
  for (const char* bounces : {"1", "2", "all"})
    if (!shrink || bounces[0] != '2') rays("bounces", fmt::format("cache.bounces={}", bounces));
  return points;
}

// The cost of a solution is its preparation (setup_ms); drawing it costs almost nothing, however many patches.
std::vector<SweepPoint> radiositySweep(bool shrink, double longestSide) {
  std::vector<SweepPoint> points;
  for (int parts : {3, 6, 12, 24})
    if (!shrink || parts < 24)
      points.push_back(point("radiosity", "patches", {fmt::format("radiosity.edge={:.6g}", longestSide / parts)}));
  for (int pixels : {16, 32, 64, 128})
    if (!shrink || pixels < 128)
      points.push_back(point(
          "radiosity", "hemicubes",
          {fmt::format("radiosity.edge={:.6g}", longestSide / 6), fmt::format("radiosity.resolution={}", pixels)}));
  // As published, next to the compute solution of the same patches.
  SweepPoint published = point("radiosity", "",
                               {fmt::format("radiosity.edge={:.6g}", longestSide / (shrink ? 3 : 6)),
                                fmt::format("radiosity.resolution={}", shrink ? 48 : 100), "radiosity.flat=on"},
                               "original");
  published.byReadPixels = true;
  // Each patch draws all patches five times, in three channels and up to seven sweeps: a minute on two cores.
  published.mostPatches = shrink ? 400 : 1600;
  points.push_back(std::move(published));
  return points;
}

/// The prefix of a technique's settings and deviations.
std::string prefixOf(const std::string& technique) {
  return (technique == "irradiance-cache" ? "cache" : technique) + ".";
}

}  // namespace

std::string SweepPoint::label() const {
  std::string text = picture.technique;
  if (picture.fidelity != "corrected") text += " " + picture.fidelity;
  // "rsm samples=16", not "rsm rsm.samples=16".
  const std::string prefix = prefixOf(picture.technique);
  for (const std::string& setting : picture.settings)
    text += " " + (setting.starts_with(prefix) ? setting.substr(prefix.size()) : setting);
  for (const std::string& deviation : picture.deviations) text += " " + deviation;
  if (bound == Bound::map) text += ", bound: the map at each pixel";
  if (bound == Bound::cells) text += ", bound: exact radiance in the cells";
  if (byReadPixels) text += " by glReadPixels";
  return text;
}

std::string SweepPoint::name() const { return label(); }

std::vector<std::string> sweepTechniques() { return {"direct", "rsm", "lpv", "irradiance-cache", "radiosity"}; }

std::vector<SweepPoint> sweepOf(const std::string& technique, bool shrink, double longestSide) {
  if (technique == "direct") return {point("direct", "", {})};
  if (technique == "rsm") return rsmSweep(shrink);
  if (technique == "lpv") return lpvSweep(shrink);
  if (technique == "irradiance-cache") return cacheSweep(shrink);
  if (technique == "radiosity") return radiositySweep(shrink, longestSide);
  std::string known;
  for (const std::string& t : sweepTechniques()) known += (known.empty() ? "" : ", ") + t;
  throwBadInput("--techniques {}: unknown; expected one of {}", technique, known);
}

std::vector<SweepPoint> boundPoints() {
  const auto of = [](const char* technique, Bound bound, std::vector<std::string> settings) {
    SweepPoint r = point(technique, "bounds", std::move(settings));
    r.isStep = false;
    r.bound = bound;
    return r;
  };
  const std::string gather = "cache.transport=gather", once = "cache.bounces=1";
  return {of("lpv", Bound::map, {}),
          of("lpv", Bound::cells, {}),
          of("lpv", Bound::none, {}),
          of("irradiance-cache", Bound::map, {gather, once}),
          of("irradiance-cache", Bound::none, {once, "cache.samples=2048"}),
          of("irradiance-cache", Bound::none, {gather, once})};
}

SweepPoint parseSweepPoint(const std::string& text, const std::string& option, bool withPath) {
  std::istringstream words(text);
  SweepPoint asked;
  words >> asked.picture.technique;
  std::vector<std::string> known = sweepTechniques();
  if (withPath) known.emplace_back("path");
  if (std::find(known.begin(), known.end(), asked.picture.technique) == known.end())
    throwBadInput("{} '{}': expected \"TECHNIQUE [SETTING=VALUE]...\" with one of {}", option, text,
                  fmt::join(known, ", "));
  for (std::string word; words >> word;) asked.picture.settings.push_back(word);
  asked.series = asked.picture.technique + " as asked";
  asked.picture.parse();  // throws for settings that do not exist
  return asked;
}

std::vector<SweepPoint> deviationPoints(const std::vector<std::string>& techniques) {
  std::vector<SweepPoint> points;
  for (const std::string& technique : techniques) {
    if (technique == "direct" || technique == "irradiance-cache") continue;
    points.push_back(point(technique, "corrected", {}));
    points.back().isStep = false;
    for (const Deviation& deviation : allDeviations()) {
      // A deviation's name begins with the technique that it belongs to; the light propagation volume also reads the
      // reflective shadow map's flux.
      const std::string name(deviation.name);
      const bool reads = name.starts_with(prefixOf(technique)) || (technique == "lpv" && name == "rsm.flux-cosine");
      if (!reads) continue;
      SweepPoint r = point(technique, name, {});
      r.isStep = false;
      r.picture.deviations = {name + "=on"};
      points.push_back(r);
    }
    points.push_back(point(technique, "", {}, "original"));
  }
  return points;
}

}  // namespace lucerna::demo::bench
