#include "radiosity/original/scene_solution.hpp"

#include "base/error.hpp"
#include "radiosity/direct_light.hpp"
#include "radiosity/original/rad_scene.hpp"
#include "scene/features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

/// Starts a solution with the mesh's direct light; all solved quantities are still empty.
RadiositySolution begin(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                        const PublishedSceneSettings& settings) {
  RadiositySolution solution;
  PatchSettings patches;
  patches.longestEdge = settings.longestEdge;
  solution.mesh = makePatches(scene, patches);
  solution.deviations = publishedRadiosity();
  const std::size_t count = solution.mesh.patches.size();
  const std::vector<glm::dvec3> none(count, glm::dvec3(0.0));
  const RayScene rays(sceneOf(solution.mesh), context.capabilities());
  solution.direct = directLight(programs, rays, scene, solution.mesh);
  solution.fromSky = analyse(scene).environment ? skyLight(programs, rays, scene, solution.mesh) : none;
  solution.fromEmitters = solution.irradiance = solution.exitance = none;
  solution.fronts.assign(count, 1.0f);
  solution.backs.assign(count, 0.0f);
  return solution;
}

/// Error bound of a patch after a sweep that changed no b by more than `change`: from the missing sweeps, and from
/// numbers rounded down by less than 1 in each. q is the largest reflectance. Rows of the published map sum to at most
/// 1, so a sweep is a contraction by q, and q / (1 - q) times its last step bounds the missing rest.
double errorOfExitance(double q, double change) {
  return q < 1.0 ? q * (q * change + 1.0) / (1.0 - q) : std::numeric_limits<double>::infinity();
}

}  // namespace

PublishedScene solveAsPublished(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                                const PublishedSceneSettings& settings, const std::function<bool(double)>& goOn) {
  PublishedScene result;
  RadiositySolution& solution = result.solution = begin(context, programs, scene, settings);
  const std::vector<Patch>& patches = solution.mesh.patches;
  std::vector<glm::dvec3> own;  // exitance before solving
  double brightest = 0.0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    own.push_back(patches[i].emission + patches[i].reflectance * (solution.direct[i] + solution.fromSky[i]));
    brightest = std::max({brightest, own[i].x, own[i].y, own[i].z});
  }
  if (!(brightest > 0.0)) throwBadInput("{}: nothing is lit", scene.file.string());
  const double step = result.exitanceOfStep = brightest / settings.lightPower;

  OriginalRadiosity::Settings program;
  program.view = settings.view;
  double worst = 0.0, mean = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    const std::vector<RadTriangle> triangles = radTrianglesOf(solution.mesh, own, channel, step);
    OriginalRadiosity solver(programs, triangles, program);
    OriginalProgress progress = solver.start();
    double change = 0.0;  // largest change of a triangle in the last sweep
    bool stopped = false;
    do {
      const std::vector<float> before = progress.received;
      stopped = !solver.sweep(progress, [&](const OriginalProgress& now) {
        const double sweeps = now.sweeps + static_cast<double>(now.done) / static_cast<double>(triangles.size());
        return goOn((channel + sweeps / settings.mostSweeps) / 3.0);
      });
      change = 0.0;
      for (std::size_t i = 0; i < before.size(); ++i)
        change = std::max(change, std::abs(static_cast<double>(progress.received[i]) - static_cast<double>(before[i])));
    } while (!stopped && change > 0.0 && progress.sweeps < settings.mostSweeps);

    double reflectance = 0.0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const double received = step * static_cast<double>(progress.received[i]);
      solution.irradiance[i][channel] = received + solution.direct[i][channel] + solution.fromSky[i][channel];
      solution.exitance[i][channel] = own[i][channel] + patches[i].reflectance[channel] * received;
      mean += solution.exitance[i][channel] / (3.0 * static_cast<double>(patches.size()));
      reflectance = std::max(reflectance, patches[i].reflectance[channel]);
    }
    worst = std::max(worst, step * errorOfExitance(reflectance, change));
    result.sweeps[static_cast<std::size_t>(channel)] = progress.sweeps;
    result.hemicubes += solver.hemicubes();
    result.overflows += solver.overflows();
    if (stopped) break;
  }
  solution.progress.errorBound = worst / mean;
  solution.hemicubes = result.hemicubes;
  return result;
}

}  // namespace lucerna
