// lucerna check, part error: error against run time, small (lucerna bench error).
#include "check/check.hpp"

#include "bench/bench.hpp"
#include "bench/error_bench.hpp"
#include "render/techniques.hpp"

#include <fmt/core.h>

#include <filesystem>

namespace lucerna::demo::check {

namespace {

/// The least error that each technique reached, and in which time.
std::string bestOf(const std::vector<bench::ErrorRow>& rows) {
  std::string text;
  for (const std::string& technique : techniqueNames()) {
    const bench::ErrorRow* best = nullptr;
    for (const bench::ErrorRow& row : rows)
      if (row.at("technique") == technique && row.contains("l2") && row.at("l2").is_number() &&
          row.at("ms").is_number() && (!best || row.at("l2").get<double>() < best->at("l2").get<double>()))
        best = &row;
    if (best)
      text += fmt::format("{}{} {:.1f} % in {:.3g} ms", text.empty() ? "" : ", ", technique,
                          100.0 * best->at("l2").get<double>(), best->at("ms").get<double>());
  }
  return text;
}

Finding measureErrors(const UnitInput& input) {
  Session session(input);
  bench::ErrorBenchOptions options;
  options.scene = bench::asset("cornell/cornell.json");
  options.size = session.context.capabilities().softwareRenderer ? "64x36" : "320x180";
  options.out = (std::filesystem::path(input.out) / "error").string();
  options.references = (std::filesystem::path(input.out) / "error" / "references").string();
  options.budget = 0.3 * input.seconds;
  options.frames = 3;
  options.quiet = true;
  // The path tracer's error over time, and one picture by each other technique.
  options.techniques = {"path"};
  options.points = {"direct",
                    "rsm",
                    "lpv",
                    "irradiance-cache",
                    "irradiance-cache cache.transport=gather",
                    "radiosity radiosity.edge=0.1"};
  at("measuring errors");
  const auto result = bench::runErrorBench(session.context, session.programs, loadScene(options.scene), options,
                                           std::string(nameOf(session.host->kind())));
  Finding finding;
  finding.text = bestOf(result->report.rows);
  finding.figures = bench::errorBenchJson(*result, options);
  return finding;
}

}  // namespace

std::vector<Unit> errorUnits() { return {{"error", "cornell", 90.0, measureErrors, {}, true}}; }

}  // namespace lucerna::demo::check
