// lucerna bench pictures --original rad --progressive -o FILE.png: progressive refinement [RAD2008, section 2.2.3.1] on
// its way to the solution, beside Jacobi's and Gauss-Seidel's methods in the same time. A shot and a row of the other
// two each take one hemicube, so that hemicubes count the time alike on every machine.
#include "originals/rad.hpp"

#include "shared/contact_sheet.hpp"
#include "radiosity/original/display.hpp"
#include "radiosity/original/rad_models.hpp"
#include "radiosity/original/rad_scene.hpp"
#include "radiosity/solution.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace lucerna::demo::bench {

namespace {

/// A model of the original, solved by the corrected program, which has all three methods.
class ModelOnTheWay {
 public:
  ModelOnTheWay(const gl::Context& context, gl::ProgramLibrary& programs, std::vector<RadTriangle> triangles)
      : context_(context),
        programs_(programs),
        triangles_(std::move(triangles)),
        scene_(sceneOfTriangles(triangles_, "model 1")),
        solved_(solve(RadiositySolver::automatic, kAllProducts)) {}

  /// After so many hemicubes: shots, or rows of sweeps.
  RadiositySolution after(int hemicubes, RadiositySolver solver) {
    const auto rows = static_cast<int>(solved_.mesh.patches.size());
    // Half a hemicube less, as the sum of their fractions of a product is rounded.
    if (solver == RadiositySolver::progressive) return solve(solver, (hemicubes - 0.5) / rows);
    // A sweep renews each row once, in order: within it, rows have values of this sweep or of the one before.
    const int sweeps = hemicubes / rows;
    RadiositySolution last = solve(solver, sweeps), next = solve(solver, sweeps + 1);
    std::copy_n(next.irradiance.begin(), hemicubes % rows, last.irradiance.begin());
    return last;
  }

  /// RMS difference of received radiosity over its RMS, both by area.
  double errorOf(const RadiositySolution& solution) const {
    double off = 0.0, all = 0.0;
    for (std::size_t i = 0; i < solution.irradiance.size(); ++i) {
      const double area = solved_.mesh.patches[i].area, is = solved_.irradiance[i].x;
      off += area * std::pow(solution.irradiance[i].x - is, 2.0);
      all += area * is * is;
    }
    return std::sqrt(off / all);
  }

  std::vector<RadTriangle> shown(const RadiositySolution& solution) const {
    return withReceived(triangles_, scene_, solution.mesh, solution.irradiance);
  }
  const RadiositySolution& solved() const { return solved_; }

 private:
  static constexpr double kAllProducts = 1e5;

  RadiositySolution solve(RadiositySolver solver, double products) const {
    RadiositySolutionSettings settings;
    settings.wholeTriangles = true;
    settings.hemicubes.visibility = HemicubeVisibility::raster;
    settings.solver = solver;
    settings.error = products < kAllProducts ? 0.0 : 1e-6;
    settings.mostProducts = products;
    RadiositySolution solution = solveScene(context_, programs_, scene_, settings);
    if (products == 0.0) solution.irradiance.assign(solution.irradiance.size(), glm::dvec3(0.0));
    return solution;
  }

  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  std::vector<RadTriangle> triangles_;
  Scene scene_;
  RadiositySolution solved_;
};

}  // namespace

VptSheet drawProgressivePictures(const gl::Context& context, gl::ProgramLibrary& programs, glm::ivec2 size,
                                 double scale, bool quiet) {
  ModelOnTheWay model(context, programs, makeRadModel(1, {10.0 / scale, 0.5, 1000000}));
  const std::vector<RadTriangle> solved = model.shown(model.solved());
  RadDisplay display;
  display.mapping = RadMapping::linear;
  display.constant = exposureOf(solved);  // one for all pictures, so that they compare
  RadView view(programs, size);
  std::vector<Tile> tiles;
  VptSheet result;
  constexpr int kTiles = 12;
  Progress progress("bench pictures", kTiles, quiet);
  for (const auto& [solver, name, unit] : {std::tuple(RadiositySolver::progressive, "progressive refinement", "shot"),
                                           std::tuple(RadiositySolver::jacobi, "Jacobi", "row"),
                                           std::tuple(RadiositySolver::gaussSeidel, "Gauss-Seidel", "row")})
    for (const int hemicubes : {1, 10, 100, 1000}) {
      const RadiositySolution solution = model.after(hemicubes, solver);
      const double error = model.errorOf(solution);
      view.show(model.shown(solution), display);
      view.record(overviewOf(solved));
      const std::string label =
          fmt::format("{}, {} {}{}: {:.3g} % off", name, hemicubes, unit, hemicubes > 1 ? "s" : "", 100.0 * error);
      tiles.push_back({label, view.read()});
      result.json.push_back(
          {{"picture", label}, {"solver", nameOf(solver)}, {"hemicubes", hemicubes}, {"error", error}});
      progress.update(static_cast<int>(tiles.size()));
      if (interrupted()) return {};
    }
  result.tiles = tiles.size();
  result.sheet = contactSheet(
      fmt::format("RAD original, 2.2.3.1: progressive refinement on its way, beside Jacobi and Gauss-Seidel at equal "
                  "time: a shot and a row take one hemicube each; model 1, {} triangles",
                  solved.size()),
      tiles, 4);
  return result;
}

}  // namespace lucerna::demo::bench
