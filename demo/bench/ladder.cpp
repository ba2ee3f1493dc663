#include "bench/ladder.hpp"

#include "base/error.hpp"
#include "render/deviations.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

namespace lucerna::demo::bench {

namespace {

Rung rung(const std::string& technique, const std::string& series, std::vector<std::string> settings,
          const std::string& fidelity = "corrected") {
  Rung r;
  r.series = technique + (series.empty() ? "" : " " + series) + (fidelity == "original" ? " (original)" : "");
  r.picture.technique = technique;
  r.picture.fidelity = fidelity;
  r.picture.settings = std::move(settings);
  r.isStep = !series.empty() && series != "gather visibility" && fidelity == "corrected";
  return r;
}

std::vector<Rung> rsmLadder(bool shrink) {
  std::vector<Rung> rungs;
  for (const bool interpolate : {true, false})
    for (int samples : {16, 50, 100, 200, 400, 800, 1600}) {
      if (shrink && samples > (interpolate ? 800 : 400)) continue;
      rungs.push_back(rung(
          "rsm", interpolate ? "interpolated" : "full",
          {fmt::format("rsm.samples={}", samples), fmt::format("rsm.interpolate={}", interpolate ? "on" : "off")}));
    }
  for (int samples : {50, 400}) rungs.push_back(rung("rsm", "", {fmt::format("rsm.samples={}", samples)}, "original"));
  return rungs;
}

std::vector<Rung> lpvLadder(bool shrink) {
  std::vector<Rung> rungs;
  for (int cells : {8, 16, 32, 64})
    if (!shrink || cells < 64) rungs.push_back(rung("lpv", "cells", {fmt::format("lpv.cells={}", cells)}));
  for (int cascades : {1, 2, 3, 4})
    rungs.push_back(rung("lpv", "cascades", {fmt::format("lpv.cascades={}", cascades)}));
  for (int iterations : {2, 4, 8, 16, 32})
    rungs.push_back(rung("lpv", "iterations", {fmt::format("lpv.iterations={}", iterations)}));
  // Each number of bounces has a separate reference.
  for (int bounces : {1, 2, 4})
    if (!shrink || bounces != 2) rungs.push_back(rung("lpv", "bounces", {fmt::format("lpv.bounces={}", bounces)}));
  for (int iterations : {8, 12})
    rungs.push_back(rung("lpv", "", {fmt::format("lpv.iterations={}", iterations)}, "original"));
  return rungs;
}

std::vector<Rung> cacheLadder(bool shrink) {
  std::vector<Rung> rungs;
  const auto gather = [&](const char* series, std::vector<std::string> settings) {
    settings.insert(settings.begin(), "cache.transport=gather");
    rungs.push_back(rung("irradiance-cache", std::string("gather ") + series, std::move(settings)));
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
    rungs.push_back(rung("irradiance-cache", std::string("rays ") + series, {std::move(setting)}));
  };
  for (int samples : {16, 64, 256, 1024})
    if (!shrink || samples < 1024) rays("samples", fmt::format("cache.samples={}", samples));
  for (int cells : {16, 32, 64})
    if (!shrink || cells < 64) rays("cells", fmt::format("cache.cells={}", cells));
  // The least that records cost: one cascade and few paths.
  for (int cells : {8, 16, 32})
    rungs.push_back(rung("irradiance-cache", "rays coarse",
                         {"cache.samples=16", "cache.cascades=1", fmt::format("cache.cells={}", cells)}));
  // Each cascade more halves the finest cells.
  for (int cascades : {2, 3, 4})
    if (!shrink)
      rungs.push_back(
          rung("irradiance-cache", "rays cascades", {"cache.cells=64", fmt::format("cache.cascades={}", cascades)}));
  for (const char* bounces : {"1", "2", "all"})
    if (!shrink || bounces[0] != '2') rays("bounces", fmt::format("cache.bounces={}", bounces));
  return rungs;
}

// The cost of a solution is its preparation (setup_ms); drawing it costs almost nothing, however many patches.
std::vector<Rung> radiosityLadder(bool shrink, double longestSide) {
  std::vector<Rung> rungs;
  for (int parts : {3, 6, 12, 24})
    if (!shrink || parts < 24)
      rungs.push_back(rung("radiosity", "patches", {fmt::format("radiosity.edge={:.6g}", longestSide / parts)}));
  for (int pixels : {16, 32, 64, 128})
    if (!shrink || pixels < 128)
      rungs.push_back(rung(
          "radiosity", "hemicubes",
          {fmt::format("radiosity.edge={:.6g}", longestSide / 6), fmt::format("radiosity.resolution={}", pixels)}));
  // As published, next to the compute solution of the same patches.
  Rung published = rung("radiosity", "",
                        {fmt::format("radiosity.edge={:.6g}", longestSide / (shrink ? 3 : 6)),
                         fmt::format("radiosity.resolution={}", shrink ? 48 : 100), "radiosity.flat=on"},
                        "original");
  published.byReadPixels = true;
  // Each patch draws all patches five times, in three channels and up to seven sweeps: a minute on two cores.
  published.mostPatches = shrink ? 400 : 1600;
  rungs.push_back(std::move(published));
  return rungs;
}

/// The prefix of a technique's settings and deviations.
std::string prefixOf(const std::string& technique) {
  return (technique == "irradiance-cache" ? "cache" : technique) + ".";
}

}  // namespace

std::string Rung::label() const {
  std::string text = picture.technique;
  if (picture.fidelity != "corrected") text += " " + picture.fidelity;
  // "rsm samples=16", not "rsm rsm.samples=16".
  const std::string prefix = prefixOf(picture.technique);
  for (const std::string& setting : picture.settings)
    text += " " + (setting.starts_with(prefix) ? setting.substr(prefix.size()) : setting);
  for (const std::string& deviation : picture.deviations) text += " " + deviation;
  if (floor == Floor::map) text += ", floor: the map at each pixel";
  if (floor == Floor::cells) text += ", floor: exact radiance in the cells";
  if (byReadPixels) text += " by glReadPixels";
  return text;
}

std::string Rung::name() const { return label(); }

std::vector<std::string> ladderTechniques() { return {"direct", "rsm", "lpv", "irradiance-cache", "radiosity"}; }

std::vector<Rung> ladderOf(const std::string& technique, bool shrink, double longestSide) {
  if (technique == "direct") return {rung("direct", "", {})};
  if (technique == "rsm") return rsmLadder(shrink);
  if (technique == "lpv") return lpvLadder(shrink);
  if (technique == "irradiance-cache") return cacheLadder(shrink);
  if (technique == "radiosity") return radiosityLadder(shrink, longestSide);
  std::string known;
  for (const std::string& t : ladderTechniques()) known += (known.empty() ? "" : ", ") + t;
  throwBadInput("--techniques {}: unknown; expected one of {}", technique, known);
}

std::vector<Rung> floorRungs() {
  const auto of = [](const char* technique, Floor floor, std::vector<std::string> settings) {
    Rung r = rung(technique, "floors", std::move(settings));
    r.isStep = false;
    r.floor = floor;
    return r;
  };
  const std::string gather = "cache.transport=gather", once = "cache.bounces=1";
  return {of("lpv", Floor::map, {}),
          of("lpv", Floor::cells, {}),
          of("lpv", Floor::none, {}),
          of("irradiance-cache", Floor::map, {gather, once}),
          of("irradiance-cache", Floor::none, {once, "cache.samples=2048"}),
          of("irradiance-cache", Floor::none, {gather, once})};
}

Rung askedRung(const std::string& text) {
  std::istringstream words(text);
  Rung asked;
  words >> asked.picture.technique;
  const std::vector<std::string> known = ladderTechniques();
  if (std::find(known.begin(), known.end(), asked.picture.technique) == known.end())
    throwBadInput("--rung '{}': expected \"TECHNIQUE [SETTING=VALUE]...\" with one of {}", text,
                  fmt::join(known, ", "));
  for (std::string word; words >> word;) asked.picture.settings.push_back(word);
  asked.series = asked.picture.technique + " as asked";
  asked.picture.parse();  // throws for settings that do not exist
  return asked;
}

std::vector<Rung> deviationRungs(const std::vector<std::string>& techniques) {
  std::vector<Rung> rungs;
  for (const std::string& technique : techniques) {
    if (technique == "direct" || technique == "irradiance-cache") continue;
    rungs.push_back(rung(technique, "corrected", {}));
    rungs.back().isStep = false;
    for (const Deviation& deviation : allDeviations()) {
      // A deviation's name begins with the technique that it belongs to; the light propagation volume also reads the
      // reflective shadow map's flux.
      const std::string name(deviation.name);
      const bool reads = name.starts_with(prefixOf(technique)) || (technique == "lpv" && name == "rsm.flux-cosine");
      if (!reads) continue;
      Rung r = rung(technique, name, {});
      r.isStep = false;
      r.picture.deviations = {name + "=on"};
      rungs.push_back(r);
    }
    rungs.push_back(rung(technique, "", {}, "original"));
  }
  return rungs;
}

}  // namespace lucerna::demo::bench
