// lucerna radiosity solve --fidelity corrected: any scene, or a triangle file of the original.
// A scene's solution is a file that `render --technique radiosity --set radiosity.file=OUT` displays; a triangle file
// receives its b, as with the original.
#include "radiosity.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "radiosity/original/rad_file.hpp"
#include "radiosity/original/rad_scene.hpp"
#include "radiosity/radiosity_view.hpp"
#include "radiosity/row_file.hpp"
#include "radiosity/solution.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>

namespace lucerna::demo {

namespace {

/// A triangle file's size is determined by its first four bytes.
bool isRadFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::uint32_t count = 0;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  return stream.read(reinterpret_cast<char*>(&count), sizeof count) && !error &&
         size == 4 + std::uintmax_t{count} * sizeof(RadTriangle);
}

/// Computes only a part's rows.
int makePart(const RadiositySolve& options, const gl::Context& context, gl::ProgramLibrary& programs,
             const Scene& scene, const RadiositySolutionSettings& settings) {
  FormFactorParts rows(context, programs, scene, settings);
  const PartFolder part(options.part, "radiosity solve",
                        fmt::format("{}, rows {:016x}, {}", scene.name, rows.fingerprint(), textOf(settings)),
                        rows.patches());
  const std::size_t count = part.last() - part.first();
  Progress progress("hemicubes", static_cast<int>(count), options.common.quiet);
  std::size_t made = 0;
  if (count > 0)
    made = rows.make(part.first(), part.last(), part.file(part.first(), ".rows"), [&](std::size_t done) {
      progress.update(static_cast<int>(done));
      return !interrupted();
    });
  if (interrupted()) throw Stopped(fmt::format("stopped; the same command resumes from {}", options.part.checkpoint));
  part.finish();
  if (!options.common.quiet)
    fmt::print("{}: rows {} to {} of {} by {}, {} made now\n", options.part.checkpoint, part.first(), part.last(),
               part.units(), nameOf(rows.visibility()), made);
  options.common.writeJson({{"rows", {part.first(), part.last()}},
                            {"of", part.units()},
                            {"visibility", nameOf(rows.visibility())},
                            {"made", made}});
  return 0;
}

/// Joins the rows of all parts into the checkpoint from which solving continues.
void takeParts(const RadiositySolve& options, const std::filesystem::path& checkpoint) {
  if (!isPartFolder(options.part.checkpoint))
    throwBadInput("--checkpoint {}: is no folder of lucerna merge; a solution's own checkpoint is OUT.rows",
                  options.part.checkpoint);
  if (std::filesystem::exists(checkpoint)) return;  // already begun
  std::vector<std::pair<std::uint32_t, std::filesystem::path>> files;
  for (const auto& entry : std::filesystem::directory_iterator(options.part.checkpoint))
    if (entry.path().extension() == ".rows")
      files.emplace_back(static_cast<std::uint32_t>(std::stoul(entry.path().stem().string())), entry.path());
  if (files.empty()) throwBadInput("--checkpoint {}: holds no rows of hemicubes", options.part.checkpoint);
  std::sort(files.begin(), files.end());
  joinRowFiles(files, checkpoint);
}

}  // namespace

int solveCorrected(const RadiositySolve& options) {
  // The scene and the settings.
  if (options.nearPlane) throwBadInput("--near-plane: corrected hemicubes have no near plane");
  const bool rad = isRadFile(options.in);
  std::vector<RadTriangle> triangles;
  if (rad) {
    triangles = readRadFile(options.in);
    checkRadTriangles(triangles, options.in);
  }
  const Scene scene = rad ? sceneOfTriangles(triangles, options.in) : loadScene(options.in);
  RenderSettings all;
  for (const auto& [option, assignment] : options.shortSettings) {
    const auto [setting, value] = parseAssignment(assignment);
    parseSetting(*setting, all, value, option + ": ");
  }
  for (const std::string& assignment : options.set) {
    const auto [setting, value] = parseSet(assignment, &kSolutionCost);
    parseSetting(*setting, all, value, "--set ");
  }
  RadiositySolutionSettings& settings = all.of<RadiosityView::Settings>().solution;
  for (const std::string& deviation : options.deviations) applyRadiosityDeviation(settings.deviations, deviation);
  settings.wholeTriangles = rad;
  if (rad) settings.refinements = 0;

  // Compute only a part; or the whole, starting from existing rows.
  const auto host = options.common.makeHost(false);
  gl::Context context;
  gl::ProgramLibrary programs;
  const std::filesystem::path checkpoint = options.out + ".rows";
  if (options.part.isPart()) {
    watchForInterrupt();
    return makePart(options, context, programs, scene, settings);
  }
  if (options.restart) removeCheckpoints(checkpoint);
  if (!options.part.checkpoint.empty()) takeParts(options, checkpoint);
  const auto before = stampOf(options.out);
  watchForInterrupt();
  Progress progress("hemicubes", 1000, options.common.quiet);
  const RadiositySolution solution =
      solveScene(context, programs, scene, settings, checkpoint, [&](const RadiosityStage& stage) {
        showProgress(progress, stage);
        if (stage.kind == RadiosityStage::Kind::solving && !stage.solve.isEstimate && !options.common.quiet)
          fmt::print("{:6.1f} products: residual {:.3g}, error at most {:.3g}, energy balance {:.3g}\n",
                     stage.solve.products, stage.solve.residual, stage.solve.errorBound, stage.solve.energyBalance);
        return !interrupted();
      });
  if (stampOf(options.out) != before)
    throwBadInput(
        "{}: was changed by another program while it was being solved; it is left unchanged. The same command takes "
        "the form factors from {}",
        options.out, checkpoint.string());
  // Store the result in the same kind of file as the input, then report it.
  if (rad) {
    writeRadFile(options.out, withReceived(std::move(triangles), scene, solution.mesh, solution.irradiance));
  } else {
    saveSolution(options.out, scene, solution);
  }
  removeCheckpoints(checkpoint);
  const double rate =
      solution.hemicubeSeconds > 0.0 ? static_cast<double>(solution.hemicubes) / solution.hemicubeSeconds : 0.0;
  if (!options.common.quiet)
    fmt::print(
        "{}: {} patches ({} without area left out), {} hemicubes of {} pixels in {:.2f} s ({:.0f}/s), {} in {:.1f} "
        "products and {:.2f} s, error at most {:.3g}, "
        "energy balance {:.3g} on {}\n",
        options.out, solution.mesh.patches.size(), solution.mesh.degenerate, solution.hemicubes,
        settings.hemicubes.resolution, solution.hemicubeSeconds, rate, nameOf(solution.solver),
        solution.progress.products, solution.solveSeconds, solution.progress.errorBound,
        solution.progress.energyBalance, context.capabilities().renderer);
  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["fidelity"] = options.fidelity;
  json["deviations"] = activeRadiosityDeviations(solution.deviations);
  json["solver"] = nameOf(solution.solver);
  json["visibility"] = nameOf(solution.visibility);
  json["patches"] = solution.mesh.patches.size();
  json["degenerate"] = solution.mesh.degenerate;
  json["sweeps"] = solution.progress.products;
  json["hemicubes"] = solution.hemicubes;
  json["seconds"] = solution.hemicubeSeconds + solution.solveSeconds;
  json["hemicubes_per_s"] = rate;
  json["error_bound"] = solution.progress.errorBound;
  json["energy_balance"] = solution.progress.energyBalance;
  json["entries"] = solution.entries;
  options.common.writeJson(json);
  return 0;
}

}  // namespace lucerna::demo
