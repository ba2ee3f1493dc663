// lucerna tune SCENE --frame-time MS | --error E: measures the scene, then picks the technique and settings that best
// meet one of these goals.
#include "base/error.hpp"
#include "base/files.hpp"
#include "bench/bench.hpp"
#include "bench/error_bench.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna::demo {

namespace {

struct TuneOptions {
  CommonOptions common;
  bench::ErrorBenchOptions bench;
  std::string output;
  std::optional<double> frameTime, error;
  double setupTime = 10.0;
};

using bench::ErrorRow;
using bench::number;

double figure(const ErrorRow& row, std::string_view name) {
  return name == "nrmse" ? bench::rankedError(row, "nrmse") : number(row, "ms");
}

/// Time before the first picture: compiling programs, uploading the scene, computing a solution.
double setupSeconds(const ErrorRow& row) { return 1e-3 * number(row, "setup_ms"); }

/// Settings of one technique are ranked inside their model: another row of it is as fast, or fast enough, and more
/// accurate there.
bool isOutranked(const ErrorRow& row, const std::vector<ErrorRow>& rows, const char* wish, double limit,
                 double mostSetup) {
  if (!row.contains("inside_model")) return false;
  const ErrorRow& inside = row.at("inside_model");
  for (const ErrorRow& other : rows) {
    if (!other.contains("inside_model") || other.at("technique") != row.at("technique") ||
        other.at("inside_model").at("model") != inside.at("model"))
      continue;
    if (setupSeconds(other) > mostSetup ||
        !(bench::rankedError(other.at("inside_model"), "l2") < bench::rankedError(inside, "l2")))
      continue;
    if (number(other, "ms") <= number(row, "ms") || (std::string_view(wish) == "ms" && number(other, "ms") <= limit))
      return true;
  }
  return false;
}

/// The row that meets the goal and is best in the other quantity; if none does, the one that comes closest. Rows that
/// need more than `mostSetup` seconds before their first picture are skipped.
const ErrorRow& choose(const std::vector<ErrorRow>& rows, const char* wish, double limit, const char* other,
                       double mostSetup, bool& met) {
  const ErrorRow* best = nullptr;
  met = false;
  double leastSetup = std::numeric_limits<double>::infinity();
  for (const ErrorRow& row : rows) {
    if (row.contains("published")) continue;  // shown from a file of the bench: no settings that render could take
    leastSetup = std::min(leastSetup, setupSeconds(row));
    if (setupSeconds(row) > mostSetup) continue;
    if (isOutranked(row, rows, wish, limit, mostSetup)) continue;
    const double value = figure(row, wish), cost = figure(row, other);
    if (!std::isfinite(value) || !std::isfinite(cost)) continue;
    const bool meets = value <= limit;
    const bool better = !best || (meets && !met) ||
                        (meets == met && (meets ? cost < figure(*best, other) : value < figure(*best, wish)));
    if (better) best = &row;
    met |= meets;
  }
  if (!best && leastSetup > mostSetup)
    throwBadInput("tune: no settings are ready within --setup-time {:g} s; the fastest need {:.3g} s", mostSetup,
                  leastSetup);
  if (!best) throw Error(ErrorKind::fault, "tune: no row has a finite time and error");
  return *best;
}

/// Whether the reference's noise hides the error, which then has a bound only.
bool isBound(const ErrorRow& row) { return row.value("at_noise", false); }

std::string describe(const ErrorRow& row) {
  return fmt::format("{}: {:.2f} ms per picture after {:.3g} s of set-up, NRMSE {}{:.3g} %",
                     row.at("label").get<std::string>(), number(row, "ms"), setupSeconds(row), isBound(row) ? "< " : "",
                     100.0 * bench::rankedError(row, "nrmse"));
}

int runTune(TuneOptions options) {
  if (options.frameTime.has_value() == options.error.has_value())
    throwBadInput("tune: give either --frame-time MS or --error E");
  checkWritable(options.output);
  if (options.bench.out.empty()) options.bench.out = "bench-error";
  if (options.bench.techniques.empty())
    options.bench.techniques = bench::sweepTechniques();  // the real-time techniques; path tracing on request
  const auto result = bench::benchScene(options.common, options.bench);
  if (!result) return exitCode();

  bool met = false;
  const ErrorRow& row = options.frameTime
                            ? choose(result->report.rows, "ms", *options.frameTime, "nrmse", options.setupTime, met)
                            : choose(result->report.rows, "nrmse", *options.error, "ms", options.setupTime, met);
  if (!met)
    throwBadInput(
        "tune: no settings meet {}; the closest are {}",
        options.frameTime ? fmt::format("{:g} ms", *options.frameTime) : fmt::format("NRMSE {:g}", *options.error),
        describe(row));
  nlohmann::ordered_json settings = {
      {"technique", row.at("technique")},
      {"fidelity", row.at("fidelity")},
      {"deviations", row.at("deviations")},
      {"settings", row.contains("spp") ? nlohmann::ordered_json::array() : row.at("settings")}};
  if (row.contains("spp")) settings["spp"] = row.at("spp");
  if (row.contains("denoised")) settings["settings"].push_back("path.denoise=on");
  // What all rows have been measured with, where it is not what a picture has anyway.
  if (options.bench.filter != nameOf(PixelFilter{}))
    settings["settings"].push_back("picture.filter=" + options.bench.filter);
  if (!row.contains("spp") && options.bench.pixelSamples != PictureOptions::kPixelSamples)
    settings["settings"].push_back(fmt::format("picture.samples={}", options.bench.pixelSamples));
  settings["measured"] = {{"ms", row.at("ms")},
                          {"setup_ms", row.at("setup_ms")},
                          {"nrmse", bench::rankedError(row, "nrmse")},
                          {"nrmse_is_bound", isBound(row)},
                          {"size", options.bench.size},
                          {"scene", options.bench.scene},
                          {"renderer", result->report.renderer}};
  writeFileAtomically(options.output, settings.dump(2) + "\n");
  if (!options.common.quiet)
    fmt::print("{}\n{}: lucerna render {} --settings {} -o OUT.png\n", describe(row), options.output,
               options.bench.scene, options.output);
  options.common.writeJson(settings);
  return 0;
}

}  // namespace

Work addTune(Command app) {
  auto options = std::make_shared<TuneOptions>();
  app.addOption("SCENE", options->bench.scene, "a scene file (default: the atrium)").scene();
  app.addOption("--frame-time", options->frameTime,
                "at most this many milliseconds per picture: settings with the least error")
      .positive();
  app.addOption("--error", options->error, "at most this NRMSE, such as 0.1: settings with the least time").positive();
  app.addOption(
         "--setup-time", options->setupTime,
         "at most this many seconds before the first picture (10); a radiosity solution of a large scene takes longer")
      .positive();
  app.addOption("-o,--output", options->output, "the settings file").required();
  options->bench.declare(app);
  options->common.declare(app);
  return [options] { return runTune(*options); };
}

}  // namespace lucerna::demo
