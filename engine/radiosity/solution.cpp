#include "radiosity/solution.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "radiosity/backs.hpp"
#include "radiosity/hemicube_map.hpp"
#include "radiosity/hemicubes.hpp"
#include "radiosity/mesh_solver.hpp"
#include "radiosity/row_file.hpp"
#include "scene/place.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>

namespace lucerna {

namespace {

constexpr double kEdges = 12.0;  // default: number of longest edges that span the scene

double mean3(const glm::dvec3& v) { return (v.x + v.y + v.z) / 3.0; }

/// Marks patches on both sides of a step in the light, and those along it.
RadiosityMesh refineSteep(const Scene& scene, const RadiositySolution& solution, const PatchSettings& patches,
                          double steep, double shortest) {
  const RadiosityMesh& mesh = solution.mesh;
  double mean = 0.0, area = 0.0;
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) {
    mean += mesh.patches[i].area * mean3(solution.irradiance[i]);
    area += mesh.patches[i].area;
  }
  mean /= area;
  // Light vertices of an edge, mapped to patch and edge.
  std::unordered_map<std::uint64_t, std::pair<std::uint32_t, std::size_t>> across;
  std::vector<bool> steepPatch(mesh.patches.size(), false);
  for (std::size_t i = 0; i < mesh.patches.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.patches[i].light[k], b = mesh.patches[i].light[(k + 1) % 3];
      const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
      const auto [it, fresh] = across.try_emplace(key, std::pair{static_cast<std::uint32_t>(i), k});
      if (fresh) continue;
      const std::size_t other = it->second.first;
      const double step = std::abs(mean3(solution.irradiance[i]) - mean3(solution.irradiance[other]));
      if (step > steep * mean) steepPatch[i] = steepPatch[other] = true;
    }
  return refined(scene, mesh, patches, [&](std::size_t i, int k) {
    const auto c = mesh.corners(mesh.patches[i]);
    return steepPatch[i] &&
           glm::length(c[static_cast<std::size_t>((k + 1) % 3)] - c[static_cast<std::size_t>(k)]) > 2.0 * shortest;
  });
}

/// Implements each deviation in this solver's terms. The published map uses neither closed forms nor a repair, which
/// would hide it. Where the scene moves, so do patches' numbers.
RadiositySolutionSettings settingsFor(const Scene& scene, RadiositySolutionSettings settings) {
  settings.hemicubes.rollsByPlace = scene.motion != nullptr;
  const RadiosityDeviations& d = settings.deviations;
  if (d.values24Bit)
    throwBadInput(
        "--deviation radiosity.24-bit=on: whole numbers are the published solver's; use lucerna radiosity solve "
        "--fidelity original");
  if (d.publishedMap) settings.hemicubes.map = DeltaMap::published;
  if (d.publishedMap || d.noNearField) settings.hemicubes.exactPixels = 0, settings.repair = false;
  if (d.centroid) settings.hemicubes.nearDistance = 0.0f;
  if (d.fixedOrientation) settings.hemicubes.randomRoll = false;
  return settings;
}

double largestExtent(const Scene& scene) {
  const glm::dvec3 extent = scene.main().extent();
  return std::max({extent.x, extent.y, extent.z});
}

PatchSettings patchesOf(const Scene& scene, const RadiositySolutionSettings& settings) {
  PatchSettings patches = settings.patches;
  if (patches.longestEdge <= 0.0) patches.longestEdge = largestExtent(scene) / kEdges;
  if (settings.wholeTriangles) patches.longestEdge = 0.0;
  patches.contacts = !settings.wholeTriangles && !settings.deviations.centroid;
  return patches;
}

RadiosityMesh patchesWithBacks(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                               const PatchSettings& settings) {
  RadiosityMesh mesh = makePatches(scene, settings);
  addBacks(context, programs, scene, mesh, settings);
  return mesh;
}

/// Rays and hemicubes do not read masks.
void warnOfMasks(const Scene& scene) {
  std::set<std::string> masked;
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    if (material.alphaMasked && mesh.indexCount > 0) masked.insert(fmt::format("'{}'", material.name));
  }
  if (!masked.empty())
    logWarning("radiosity: what masks cut out blocks light as if it were there: {} (path lets light through)",
               fmt::join(masked, ", "));
}

std::filesystem::path checkpointOf(std::filesystem::path checkpoint, int refinement) {
  if (!checkpoint.empty() && refinement > 0) checkpoint += fmt::format(".{}", refinement);
  return checkpoint;
}

}  // namespace

struct FormFactorParts::Work {
  std::optional<Scene> moved;  // as in solveScene()
  RadiosityMesh mesh;
  std::optional<RayScene> rays;
  std::optional<Hemicubes> hemicubes;
  std::uint64_t fingerprint = 0;
};

FormFactorParts::FormFactorParts(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& asked,
                                 const RadiositySolutionSettings& requestedSettings)
    : work_(std::make_unique<Work>()) {
  RadiositySolutionSettings settings = settingsFor(asked, requestedSettings);
  if (const glm::dvec3 origin = floatingOrigin(asked.main()); origin != glm::dvec3(0.0))
    work_->moved = movedTo(asked, origin);
  const Scene& scene = work_->moved ? *work_->moved : asked;
  work_->mesh = patchesWithBacks(context, programs, scene, patchesOf(scene, settings));
  work_->rays.emplace(sceneOf(work_->mesh), context.capabilities());
  if (!settings.deviations.centroid) cutHiddenPartsOfFronts(context, programs, *work_->rays, work_->mesh);
  if (settings.hemicubes.visibility == HemicubeVisibility::automatic)
    settings.hemicubes.visibility = visibilityByCount(work_->mesh, settings.hemicubes.resolution);
  work_->hemicubes.emplace(programs, context.capabilities(), work_->mesh, settings.hemicubes, &*work_->rays);
  work_->fingerprint = rowsFingerprint(work_->mesh, settings.hemicubes);
}

FormFactorParts::~FormFactorParts() = default;

std::size_t FormFactorParts::patches() const { return work_->mesh.patches.size(); }
HemicubeVisibility FormFactorParts::visibility() const { return work_->hemicubes->visibility(); }
std::uint64_t FormFactorParts::fingerprint() const { return work_->fingerprint; }

std::size_t FormFactorParts::make(std::size_t first, std::size_t last, const std::filesystem::path& file,
                                  const std::function<bool(std::size_t done)>& goOn) {
  std::size_t next = first;
  const auto count = [&](const FormFactorRows& rows) { next += rows.counts.size(); };
  RowFile rowFile(file, work_->fingerprint, static_cast<std::uint32_t>(patches()), count,
                  static_cast<std::uint32_t>(first));
  const std::size_t known = next - first;
  const auto keep = [&](const FormFactorRows& rows) {
    rowFile.append(rows);
    count(rows);
  };
  work_->hemicubes->stream(static_cast<int>(next), static_cast<int>(last), keep,
                           [&](int done) { return goOn(static_cast<std::size_t>(done) - first); });
  return next - first - known;
}

void removeCheckpoints(const std::filesystem::path& checkpoint) {
  std::error_code ignored;
  for (int refinement = 0; std::filesystem::remove(checkpointOf(checkpoint, refinement), ignored); ++refinement)
    continue;
}

RadiositySolution solveScene(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                             const RadiositySolutionSettings& asked, const std::filesystem::path& checkpoint,
                             const std::function<bool(const RadiosityStage&)>& onStage,
                             const RadiositySolution* before) {
  // Far from the origin, floats cannot represent the patches: solve near the origin, and return the scene's own
  // coordinates.
  if (const glm::dvec3 origin = floatingOrigin(scene.main()); origin != glm::dvec3(0.0)) {
    RadiositySolution solution =
        solveScene(context, programs, movedTo(scene, origin), asked, checkpoint, onStage, before);
    for (glm::dvec3& point : solution.mesh.points) point += origin;
    for (Patch& patch : solution.mesh.patches) patch.centroid += origin;
    return solution;
  }
  const RadiositySolutionSettings settings = settingsFor(scene, asked);
  warnOfMasks(scene);
  const PatchSettings patches = patchesOf(scene, settings);
  const double largest = largestExtent(scene);
  const double shortest =
      (patches.longestEdge > 0.0 ? patches.longestEdge : largest / kEdges) / std::pow(2.0, settings.refinements + 1);
  RadiositySolution solution;
  RadiosityMesh mesh = patchesWithBacks(context, programs, scene, patches);
  HemicubeVisibility visibility = before ? before->visibility : settings.hemicubes.visibility;
  for (int refinement = 0;; ++refinement) {
    RadiositySolution next = solveMesh({context, programs, scene, settings, onStage, refinement,
                                        checkpointOf(checkpoint, refinement), before ? before->moment.get() : nullptr},
                                       std::move(mesh), visibility);
    next.hemicubes += solution.hemicubes;
    next.hemicubeSeconds += solution.hemicubeSeconds;
    next.solveSeconds += solution.solveSeconds;
    solution = std::move(next);
    visibility = solution.visibility;  // the same for all meshes
    if (refinement >= settings.refinements) break;
    mesh = refineSteep(scene, solution, patches, settings.steep, shortest);
    if (mesh.patches.size() == solution.mesh.patches.size()) break;
  }
  solution.deviations = settings.deviations;
  solution.settings = textOf(asked);
  return solution;
}

namespace {

/// Weight of a patch at the light vertices that it contributes to.
double countsAtVertices(const RadiositySolution& solution, std::size_t i) {
  const double seesFronts = std::max(1.0 - static_cast<double>(solution.backs[i]), 0.0);
  return solution.mesh.patches[i].area * (1e-6 + seesFronts * seesFronts * seesFronts);
}

/// Weight of each patch in the light at a point of one of them; they sum to 1.
std::map<std::uint32_t, double> weightsAround(const RadiositySolution& solution, std::uint32_t patch,
                                              const glm::dvec3& corners, bool flat) {
  if (flat) return {{patch, 1.0}};
  std::map<std::uint32_t, double> weights;
  const std::vector<Patch>& patches = solution.mesh.patches;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t vertex = patches[patch].light[static_cast<std::size_t>(k)];
    std::vector<std::pair<std::uint32_t, double>> around;
    double sum = 0.0;
    for (std::uint32_t i = 0; i < patches.size(); ++i)
      for (const std::uint32_t v : patches[i].light)
        if (v == vertex) {
          around.emplace_back(i, countsAtVertices(solution, i));
          sum += around.back().second;
        }
    for (const auto& [i, w] : around)
      if (sum > 0.0) weights[i] += corners[k] * w / sum;
  }
  return weights;
}

/// The patches where they were solved.
RadiosityMesh meshAboutOrigin(const Scene& scene, const RadiositySolution& solution) {
  if (solution.moment) return solution.moment->mesh;
  RadiosityMesh mesh = solution.mesh;
  if (const glm::dvec3 origin = floatingOrigin(scene.main()); origin != glm::dvec3(0.0)) {
    for (glm::dvec3& point : mesh.points) point -= origin;
    for (Patch& p : mesh.patches) p.centroid -= origin;
  }
  return mesh;
}

}  // namespace

HemicubePixels hemicubeOf(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                          const RadiositySolution& solution, const RadiositySolutionSettings& settings,
                          std::uint32_t patch) {
  const RadiosityMesh mesh = meshAboutOrigin(scene, solution);
  HemicubeSettings hemicubeSettings = settingsFor(scene, settings).hemicubes;
  hemicubeSettings.visibility =
      solution.visibility == HemicubeVisibility::itemBuffer ? solution.visibility : HemicubeVisibility::rays;
  Hemicubes hemicubes(programs, context.capabilities(), mesh, hemicubeSettings);
  return {hemicubeSettings.resolution, hemicubes.seenByPixels(static_cast<int>(patch)),
          deltaFormFactors(hemicubeSettings.resolution, hemicubeSettings.map),
          hemicubes.axesOf(static_cast<int>(patch)), hemicubeSettings.visibility};
}

RadiosityOrigins originsOf(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                           const RadiositySolution& solution, const RadiositySolutionSettings& settings,
                           std::uint32_t patch, const glm::dvec3& corners, bool flat) {
  const RadiosityMesh mesh = meshAboutOrigin(scene, solution);
  HemicubeSettings hemicubeSettings = settingsFor(scene, settings).hemicubes;
  if (hemicubeSettings.visibility == HemicubeVisibility::automatic)
    hemicubeSettings.visibility = visibilityByCount(mesh, hemicubeSettings.resolution);
  Hemicubes hemicubes(programs, context.capabilities(), mesh, hemicubeSettings);
  RadiosityOrigins origins;
  std::map<std::uint32_t, double> factors;
  for (const auto& [i, weight] : weightsAround(solution, patch, corners, flat)) {
    if (!(weight > 0.0)) continue;
    origins.lamps += weight * solution.direct[i];
    origins.sky += weight * solution.fromSky[i];
    origins.repairOfEmitted += weight * solution.fromEmitters[i];
    origins.repairOfReflected +=
        weight * (solution.irradiance[i] - solution.direct[i] - solution.fromSky[i] - solution.fromEmitters[i]);
    const FormFactorRows rows = hemicubes.rows(static_cast<int>(i), 1);
    for (std::size_t k = 0; k < rows.patches.size(); ++k)
      factors[rows.patches[k]] += weight * static_cast<double>(rows.factors[k]);
  }
  for (const auto& [i, factor] : factors) {
    const glm::dvec3 emission = mesh.patches[i].emission;
    origins.patches.push_back({i, factor, factor * emission, factor * (solution.exitance[i] - emission)});
    origins.repairOfEmitted -= origins.patches.back().emitted;
    origins.repairOfReflected -= origins.patches.back().reflected;
  }
  const auto brightness = [](const RadiosityOrigins::FromPatch& p) { return mean3(p.emitted + p.reflected); };
  std::ranges::sort(origins.patches, [&](const auto& a, const auto& b) { return brightness(a) > brightness(b); });
  return origins;
}

std::vector<glm::vec3> interpolatedToVertices(const RadiositySolution& solution,
                                              std::span<const glm::dvec3> ofPatches) {
  std::vector<glm::dvec3> sum(solution.mesh.lightVertices, glm::dvec3(0.0));
  std::vector<double> weight(sum.size(), 0.0);
  for (std::size_t i = 0; i < solution.mesh.patches.size(); ++i) {
    const Patch& patch = solution.mesh.patches[i];
    const double w = countsAtVertices(solution, i);
    for (const std::uint32_t v : patch.light) {
      sum[v] += w * ofPatches[i];
      weight[v] += w;
    }
  }
  std::vector<glm::vec3> values;
  for (std::size_t v = 0; v < sum.size(); ++v)
    values.emplace_back(weight[v] > 0.0 ? sum[v] / weight[v] : glm::dvec3(0.0));
  return values;
}

Scene litScene(const Scene& scene, const RadiosityMesh& mesh, const glm::dvec3& origin) {
  Scene lit = movedTo(scene, origin);
  lit.vertices.clear();
  lit.indices.clear();
  lit.meshes.clear();
  for (const Patch& patch : mesh.patches)
    for (std::size_t k = 0; k < 3; ++k)
      lit.vertices.push_back({glm::vec3(mesh.points[patch.point[k]] - origin), patch.texCoord[k], patch.normal[k]});
  std::vector<std::vector<std::uint32_t>> ofMaterial(scene.materials.size());
  for (std::uint32_t i = 0; i < mesh.patches.size(); ++i)
    ofMaterial[static_cast<std::size_t>(mesh.patches[i].material)].push_back(i);
  for (std::size_t m = 0; m < ofMaterial.size(); ++m) {
    if (ofMaterial[m].empty()) continue;
    Mesh& part = lit.meshes.emplace_back();
    part.name = scene.materials[m].name;
    part.firstIndex = static_cast<std::uint32_t>(lit.indices.size());
    part.indexCount = static_cast<std::uint32_t>(3 * ofMaterial[m].size());
    part.material = static_cast<int>(m);
    for (const std::uint32_t patch : ofMaterial[m])
      for (std::uint32_t k = 0; k < 3; ++k) {
        lit.indices.push_back(3 * patch + k);
        part.bounds.add(glm::dvec3(lit.vertices[3 * patch + k].position));
      }
  }
  return lit;
}

}  // namespace lucerna
