// Radiosity as published in `lucerna bench error`: every triangle's five views drawn by the rasteriser, read back by
// glReadPixels and summed on the CPU, in 24-bit colours.
#include "base/clock.hpp"
#include "bench/error_rows.hpp"
#include "radiosity/original/scene_solution.hpp"

#include <fmt/core.h>

namespace lucerna::demo::bench {

ErrorRow measurePublished(const ErrorBench& bench, const Rung& rung) {
  const RadiositySolutionSettings asked = rung.picture.parse().radiosity.solution;
  PublishedSceneSettings settings;
  settings.longestEdge = asked.patches.longestEdge;
  settings.view = asked.hemicubes.resolution;

  const auto start = Clock::now();
  PublishedScene published =
      solveAsPublished(bench.context, bench.programs, bench.scene, settings, [](double) { return !interrupted(); });
  const double seconds = secondsSince(start);
  if (interrupted()) return {};

  // Displayed like any solution, from a file.
  const std::filesystem::path file = bench.folder / "published.radiosity";
  RadiositySolution& solution = published.solution;
  solution.deviations = asked.deviations;  // the view need not know about 24 bits: they are already in the numbers
  solution.settings = textOf(asked);
  saveSolution(file, bench.scene, solution);
  const double bound = solution.progress.errorBound;
  std::vector<std::string> shown{"radiosity.file=" + file.string()};
  if (bound < 9.9) shown.push_back(fmt::format("radiosity.error={:.3g}", 1.01 * bound));
  ErrorRow row = measureRung(bench, rung, shown);
  row["setup_ms"] = row.at("setup_ms").get<double>() + 1e3 * seconds;
  row["published"] = {{"triangles", solution.mesh.patches.size()},
                      {"sweeps", published.sweeps},
                      {"hemicubes", published.hemicubes},
                      {"overflows", published.overflows},
                      {"exitance_of_step", published.exitanceOfStep},
                      {"error_bound", bound},
                      {"seconds", seconds}};
  keepRow(bench, rung, row);
  return row;
}

}  // namespace lucerna::demo::bench
