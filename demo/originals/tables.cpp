// lucerna bench tables --original NAME [SCENE]: reproduces every published table of an original.
#include "base/error.hpp"
#include "base/statistics.hpp"
#include "base/files.hpp"
#include "base/image.hpp"
#include "originals/originals.hpp"
#include "shared/contact_sheet.hpp"
#include "originals/rad.hpp"
#include "shared/completions.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lucerna::demo {

namespace bench {

std::string Row::name() const {
  std::string text = setting;
  if (grids > 0) text += fmt::format(", {} grid{}", grids, grids > 1 ? "s" : "");
  text += ", " + stage;
  if (!fill.empty()) text += ", " + fill + "/" + propagate;
  return text;
}

double Row::measured() const {
  if (samples.empty()) return NAN;
  if (isMean) return std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
  return median(samples);
}

}  // namespace bench

namespace {

struct TablesOptions {
  CommonOptions common;
  PartOptions part;
  std::string original, scene, fidelity, fill, chart;
  std::optional<double> scale;
};

/// Milliseconds in a column: large values without meaningless decimals.
std::string column(double ms) { return ms < 1e5 ? fmt::format("{:.4f}", ms) : fmt::format("{:.5g}", ms); }

void print(const bench::Tables& tables) {
  for (const std::string& note : tables.notes) fmt::print("{}\n", note);
  std::string table;
  for (const bench::Row& row : tables.rows) {
    if (row.table != table) {
      table = row.table;
      fmt::print("\nTable {}\n{:<50}{:<18}", table, "", "paths");
      for (const auto& published : row.published) fmt::print("{:>14}", published.gpu);
      fmt::print("{:>12}{:>32}  {}\n", "here, ms", "5 .. 95 % (count)", "here / published");
    }
    const std::string paths = row.fill.empty() ? "" : row.fill + (row.propagate.empty() ? "" : "/" + row.propagate);
    const std::string grids = row.grids > 0 ? fmt::format(", {} grid{}", row.grids, row.grids > 1 ? "s" : "") : "";
    fmt::print("{:<50}{:<18}", row.setting + grids + ", " + row.stage, paths);
    for (const auto& published : row.published) fmt::print("{:>14g}", published.ms);
    if (!row.missing.empty()) {
      fmt::print("  not here: {} missing\n", row.missing);
      continue;
    }
    if (row.samples.empty()) {
      fmt::print("  not measured\n");
      continue;
    }
    const double ms = row.measured();
    fmt::print("{:>12}{:>32} ", column(ms),
               fmt::format("{} .. {} ({})", column(percentile(row.samples, 0.05)),
                           column(percentile(row.samples, 0.95)), row.samples.size()));
    for (const auto& published : row.published) fmt::print(" {:>9.4g}", ms / published.ms);
    fmt::print("\n");
  }
  fmt::print("\n{}", tables.summary);
}

nlohmann::ordered_json rowsJson(const bench::Tables& tables, const std::string& renderer) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const bench::Row& row : tables.rows)
    for (const auto& published : row.published) {
      nlohmann::ordered_json json;
      const double ms = row.measured();
      json["table"] = row.table;
      json["row"] = row.name() + ", " + published.gpu;
      json["published"] = published.ms;
      json["measured"] = ms;  // null where there is none
      json["ratio"] = ms / published.ms;
      json["statistic"] = row.isMean ? "mean" : "median";
      json["spread"] = {percentile(row.samples, 0.05), percentile(row.samples, 0.95)};
      json["count"] = row.samples.size();
      json["unit"] = "ms";
      json["renderer"] = renderer;
      json["published_on"] = published.gpu;
      json["setting"] = row.setting;
      if (row.grids > 0) json["grids"] = row.grids;
      json["stage"] = row.stage;
      json["fill"] = row.fill;
      json["propagate"] = row.propagate;
      if (!row.missing.empty()) json["note"] = "not here: " + row.missing + " missing";
      rows.push_back(std::move(json));
    }
  return rows;
}

/// Figure 7.1 of the LPV original: image atomics against the geometry shader (tables 7.6 and 7.7), published and
/// measured here.
void drawChart(const std::string& file, const bench::Tables& tables, const std::string& renderer) {
  std::vector<bench::Bar> published, here;
  for (const bench::Row& injection : tables.rows) {
    const bool isCompared = injection.table == "7.6" || (injection.table == "7.7" && injection.grids == 1);
    if (!isCompared || injection.stage != "injection") continue;
    const auto propagation = std::find_if(tables.rows.begin(), tables.rows.end(), [&](const bench::Row& row) {
      return row.table == injection.table && row.setting == injection.setting && row.grids == injection.grids &&
             row.fill == injection.fill && row.propagate == injection.propagate && row.stage == "propagation";
    });
    if (propagation == tables.rows.end()) continue;
    const std::string label =
        fmt::format("{}, {} grid{}", injection.setting, injection.grids, injection.grids > 1 ? "s" : "");
    if (!injection.published.empty() && !propagation->published.empty() &&
        std::none_of(published.begin(), published.end(), [&](const bench::Bar& bar) { return bar.label == label; }))
      published.push_back({label, {injection.published[0].ms, propagation->published[0].ms}});
    if (!injection.samples.empty() && !propagation->samples.empty())
      here.push_back({fmt::format("{} ({}/{})", label, injection.fill, injection.propagate),
                      {injection.measured(), propagation->measured()}});
  }
  if (published.empty() || here.empty()) throwBadInput("--chart {}: nothing of tables 7.6 and 7.7 was measured", file);
  const std::vector<std::string> stages{"injection", "propagation"};
  const glm::ivec2 size(760, 60 + 46 * static_cast<int>(std::max(published.size(), here.size())));
  writePng(file, bench::contactSheet("LPV original, figure 7.1: image atomics and the geometry shader, 8 iterations",
                                     {{"published, NVIDIA GTX 960", bench::barChart(size, stages, published, "ms")},
                                      {"here, " + renderer, bench::barChart(size, stages, here, "ms")}},
                                     2));
}

/// A software renderer then needs only minutes.
constexpr double kVptTablesScale = 0.05;

int runTables(TablesOptions options) {
  options.common.apply();
  bench::checkOriginal(options.original);
  const bool vpt = options.original == "vpt";
  const double scale = options.scale.value_or(vpt ? kVptTablesScale : 1.0);
  if (!(scale > 0.0 && scale <= 1.0)) throwBadInput("--scale {}: expected a number above 0, at most 1", scale);
  if (!options.chart.empty()) {
    if (options.original != "lpv") throwBadInput("--chart {}: only of --original lpv, its figure 7.1", options.chart);
    if (lowerExtension(options.chart) != ".png") throwBadInput("--chart {}: the extension must be png", options.chart);
    checkWritable(options.chart);
  }
  if (!options.fidelity.empty() && !vpt)
    throwBadInput(
        "--fidelity {}: the tables of {} cover all of its methods; only --original vpt has estimators to choose from",
        options.fidelity, options.original);
  if (!options.fidelity.empty() && options.fidelity != "corrected" && options.fidelity != "original")
    throwBadInput("--fidelity {}: unknown; expected one of corrected, original", options.fidelity);
  if (vpt && !options.scene.empty())
    throwBadInput("SCENE {}: the tables of vpt are measured on their own scenes", options.scene);
  if (options.original == "rad") {
    if (!options.scene.empty())
      throwBadInput("{}: --original rad makes its own models; expected no SCENE", options.scene);
    return bench::runRadTables(options.common, scale, options.part);
  }
  std::optional<LpvFill> fill;
  for (const LpvFill one : {LpvFill::layered, LpvFill::fixed, LpvFill::atomic})
    if (options.fill == nameOf(one)) fill = one;
  if (!options.fill.empty() && options.original != "lpv")
    throwBadInput("--fill {}: only the tables of lpv have grids to fill", options.fill);
  if (!options.fill.empty() && !fill)
    throwBadInput("--fill {}: unknown; expected one of layered, fixed, atomic", options.fill);
  if (options.original == "lpv" && !fill && (options.part.isPart() || !options.part.checkpoint.empty()))
    throwBadInput("--part, --checkpoint: need --fill, since the fastest way differs between machines");
  Scene scene;
  if (!vpt) {
    options.scene = bench::sceneOrAtrium(options.scene);
    scene = loadScene(options.scene);
  }

  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const bench::Tables tables =
      vpt ? bench::measureVptTables({context, programs, scale, options.common.quiet,
                                     options.fidelity == "original" ? Fidelity::original : Fidelity::corrected,
                                     options.part})
          : bench::measureLpvTables({context, programs, scene, scale, options.common.quiet, options.part, fill});
  if (options.part.isPart()) {
    if (!options.common.quiet) fmt::print("{}: {} rows\n", options.part.checkpoint, tables.json.at("rows_here").dump());
    options.common.writeJson({{"part", options.part.part}, {"rows", tables.json.at("rows_here")}});
    return exitCode();
  }
  const std::string& renderer = context.capabilities().renderer;
  fmt::print("Renderer {}\n", renderer);
  if (!vpt) fmt::print("Scene    {}, {} triangles\n", scene.file.string(), scene.triangleCount());
  print(tables);
  if (!options.chart.empty() && !interrupted())
    drawChart(options.chart, tables, renderer + (scale < 0.5 ? ", smaller grids by --scale" : ""));

  nlohmann::ordered_json json;
  json["renderer"] = renderer;
  json["host"] = nameOf(host->kind());
  json["original"] = options.original;
  if (!vpt) {
    json["scene"] = options.scene;
    json["triangles"] = scene.triangleCount();
  }
  json["scale"] = scale;
  json["notes"] = tables.notes;
  json["rows"] = rowsJson(tables, renderer);
  json.update(tables.json);
  options.common.writeJson(json);
  return exitCode();
}

}  // namespace

Work addBenchTables(Command app) {
  auto options = std::make_shared<TablesOptions>();
  app.addOption("SCENE", options->scene,
                "a scene file for lpv (default: the atrium; the published scene is Crytek Sponza)")
      .scene();
  addCompletions(app.addOption("--original", options->original, "the original: lpv, rad or vpt").required(),
                 {"lpv", "rad", "vpt"});
  app.addOption("--scale", options->scale,
                "less work on a slow machine, above 0, at most 1. lpv and rad (1): fewer frames or hemicubes; below "
                "0.5 also smaller "
                "grids and models. vpt (0.05): each side and the samples of the published pictures times this");
  addCompletions(
      app.addOption("--fidelity", options->fidelity,
                    "vpt: original: the published estimator on scenes lit as published, the corrected beside it; or "
                    "corrected (default)"),
      {"corrected", "original"});
  addCompletions(app.addOption("--fill", options->fill,
                               "lpv: the way to fill the grids measured next to the published one: layered, fixed, "
                               "atomic (the fastest here, tried first)"),
                 {"layered", "fixed", "atomic"});
  app.addOption("--chart", options->chart, "lpv: FILE.png, figure 7.1: atomics and the geometry shader as bars");
  options->part.declare(app, "rows");
  options->common.declare(app);
  return [options] { return runTables(*options); };
}

}  // namespace lucerna::demo
