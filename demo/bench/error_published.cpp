// Radiosity as published in `lucerna bench error`: every triangle's five views drawn by the rasteriser, read back by
// glReadPixels and summed on the CPU, in 24-bit colours.
#include "base/clock.hpp"
#include "bench/error_rows.hpp"
#include "radiosity/original/coarse_scene.hpp"
#include "radiosity/original/scene_solution.hpp"
#include "radiosity/radiosity_view.hpp"

#include <fmt/core.h>

namespace lucerna::demo::bench {

namespace {

/// Triangles of a coarser model may be so many times longer than patches of the scene itself: cutting them would leave
/// fewer for its shape.
constexpr double kLongerEdges = 3.0;

/// A point with patches of another edge.
SweepPoint withEdge(SweepPoint point, double edge) {
  for (std::string& setting : point.picture.settings)
    if (setting.starts_with("radiosity.edge=")) setting = fmt::format("radiosity.edge={:.6g}", edge);
  return point;
}

}  // namespace

ErrorRow measurePublished(const ErrorBench& bench, const SweepPoint& asked) {
  const auto solutionOf = [](const SweepPoint& point) {
    return point.picture.parse().of<RadiosityView::Settings>().solution;
  };
  PatchSettings patches = solutionOf(asked).patches;
  const bool fits = bench.scene.triangleCount() <= asked.mostPatches &&
                    makePatches(bench.scene, patches).patches.size() <= asked.mostPatches;
  const SweepPoint point = fits ? asked : withEdge(asked, kLongerEdges * patches.longestEdge);
  const RadiositySolutionSettings given = solutionOf(point);
  PublishedSceneSettings settings;
  settings.longestEdge = given.patches.longestEdge;
  settings.view = given.hemicubes.resolution;

  const CoarseScene model = coarserScene(bench.scene, given.patches, asked.mostPatches);
  const ErrorBench own{bench.context, bench.programs,     model.scene,         bench.camera, bench.size,
                       bench.filter,  bench.pixelSamples, bench.references,    bench.folder, bench.pathSeconds,
                       bench.frames,  bench.command,      bench.pictureCommand};
  const auto start = Clock::now();
  PublishedScene published =
      solveAsPublished(bench.context, bench.programs, model.scene, settings, [](double) { return !interrupted(); });
  const double seconds = secondsSince(start);
  if (interrupted()) return {};

  // Displayed like any solution, from a file.
  const std::filesystem::path file = bench.folder / "published.radiosity";
  RadiositySolution& solution = published.solution;
  solution.deviations = given.deviations;  // the view need not know about 24 bits: they are already in the numbers
  solution.settings = textOf(given);
  saveSolution(file, model.scene, solution);
  const double bound = solution.progress.errorBound;
  std::vector<std::string> shown{"radiosity.file=" + file.string()};
  if (bound < 9.9) shown.push_back(fmt::format("radiosity.error={:.3g}", 1.01 * bound));
  ErrorRow row = measurePoint(own, point, shown);
  row["setup_ms"] = row.at("setup_ms").get<double>() + 1e3 * seconds;
  row["published"] = {{"triangles", solution.mesh.patches.size()},
                      {"scene_triangles", model.triangles},
                      {"model_triangles", model.scene.triangleCount()},
                      {"model_cell", model.cell},
                      {"model_area", model.area},
                      {"sweeps", published.sweeps},
                      {"hemicubes", published.hemicubes},
                      {"overflows", published.overflows},
                      {"exitance_of_step", published.exitanceOfStep},
                      {"error_bound", bound},
                      {"seconds", seconds}};
  keepRow(bench, asked, row);
  return row;
}

std::string describePublished(const ErrorRow& row) {
  const auto& p = row.at("published");
  if (p.at("model_cell") == 0.0) return {};
  return fmt::format(
      "{}: of a coarser model, {} triangles of the scene's {}, cut into {} patches: corners within cells of {:.3g} "
      "units were joined, which left {:.0f} % of the area. Its error against the reference of the scene itself "
      "includes that",
      row.at("label").get<std::string>(), p.at("model_triangles").get<std::size_t>(),
      p.at("scene_triangles").get<std::size_t>(), p.at("triangles").get<std::size_t>(),
      p.at("model_cell").get<double>(), 100.0 * p.at("model_area").get<double>());
}

}  // namespace lucerna::demo::bench
