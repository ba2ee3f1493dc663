#include "radiosity/solution.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"
#include "base/log.hpp"
#include "radiosity/direct_light.hpp"
#include "radiosity/form_factor_matrix.hpp"
#include "radiosity/hemicubes.hpp"
#include "radiosity/hidden_parts.hpp"
#include "radiosity/row_file.hpp"
#include "scene/needs.hpp"
#include "scene/place.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <unistd.h>
#include <unordered_map>

namespace lucerna {

namespace {

constexpr double kEdges = 12.0;  // default: number of longest edges that span the scene
// For a form factor, its transposed copy and their mean, during the repair.
constexpr std::size_t kBytesPerEntry = 32;

std::size_t freeMemory() {
  return static_cast<std::size_t>(std::max(sysconf(_SC_AVPHYS_PAGES), 1L)) *
         static_cast<std::size_t>(std::max(sysconf(_SC_PAGESIZE), 1L));
}

std::uint64_t rowsFingerprint(const RadiosityMesh& mesh, const HemicubeSettings& s) {
  Hash f;
  f.add(std::uint32_t{2});  // version of how rows are computed
  for (const Patch& patch : mesh.patches) {
    for (const glm::dvec3& corner : mesh.corners(patch)) f.add(corner);
    f.add(patch.emission != glm::dvec3(0.0));
    f.add(patch.hidden);
  }
  f.add(s.visibility);
  f.add(s.resolution);
  f.add(s.map);
  f.add(s.randomRoll);
  f.add(s.seed);
  if (s.rolls != 1) f.add(s.rolls);
  f.add(s.exactPixels);
  f.add(s.nearDistance);
  f.add(s.mostParts);
  return f.value();
}

void append(FormFactorMatrix& matrix, const FormFactorRows& rows) {
  std::size_t at = 0;
  for (const std::uint32_t count : rows.counts) {
    matrix.appendRow(std::span(rows.patches).subspan(at, count), std::span(rows.factors).subspan(at, count));
    at += count;
  }
}

/// Solves one mesh: direct light, form factors, system. The results go into the solution.
class MeshSolver {
 public:
  MeshSolver(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
             const RadiositySolutionSettings& settings, int refinement, std::filesystem::path checkpoint,
             const std::function<bool(const RadiosityStage&)>& onStage, RadiositySolution& solution)
      : context_(context),
        programs_(programs),
        scene_(scene),
        settings_(settings),
        refinement_(refinement),
        checkpoint_(std::move(checkpoint)),
        onStage_(onStage),
        solution_(solution),
        count_(solution.mesh.patches.size()) {}

  void solve() {
    stage(RadiosityStage::Kind::direct, 0);
    const RayScene& rays = rays_.emplace(sceneOf(solution_.mesh), context_.capabilities());
    if (!settings_.deviations.centroid) cutHiddenParts(programs_, rays, solution_.mesh);
    solution_.direct = directLight(programs_, rays, scene_, solution_.mesh);
    solution_.fromSky = analyse(scene_).environment ? skyLight(programs_, rays, scene_, solution_.mesh)
                                                    : std::vector<glm::dvec3>(count_, glm::dvec3(0.0));
    HemicubeSettings way = settings_.hemicubes;
    way.visibility = visibility();
    hemicubes_.emplace(programs_, context_.capabilities(), solution_.mesh, way, &rays);
    makeRows();

    const Clock::time_point start = Clock::now();
    RadiositySystem system = balances();
    if (kept_) keptProduct(system);
    else streamedProduct(system);
    shareOfEmitters(system);
    solveSystem(system);
    solution_.solveSeconds += secondsSince(start);
  }

 private:
  /// Reports progress; false: the caller wants it to stop.
  bool stage(RadiosityStage::Kind kind, std::size_t done, const RadiosityProgress& progress = {}) const {
    return !onStage_ || onStage_({kind, refinement_, done, count_, progress});
  }
  [[noreturn]] void stop() const {
    throw Stopped(fmt::format(
        "stopped after {} of {} hemicubes{}", solution_.fronts.size(), count_,
        checkpoint_.empty() ? std::string() : fmt::format("; the same command resumes from {}", checkpoint_.string())));
  }

  // ---------------------------------------------------------------------------------------------- form factors

  /// The visibility method. Rows by different methods differ in their last bits, so a checkpoint is continued with the
  /// method it was begun with, and a refinement uses the method of the previous mesh.
  HemicubeVisibility visibility() const {
    if (refinement_ > 0) return solution_.visibility;
    HemicubeSettings way = settings_.hemicubes;
    if (way.visibility != HemicubeVisibility::automatic || checkpoint_.empty()) return way.visibility;
    const std::optional<std::uint64_t> begun = RowFile::fingerprintOf(checkpoint_);
    for (const HemicubeVisibility one :
         {HemicubeVisibility::raster, HemicubeVisibility::rays, HemicubeVisibility::itemBuffer}) {
      way.visibility = one;
      if (begun && rowsFingerprint(solution_.mesh, way) == *begun) return one;
    }
    return HemicubeVisibility::automatic;
  }

  /// Rows of form factors: reads those of the checkpoint, then computes the rest and appends them to it.
  void makeRows() {
    solution_.fronts.clear();
    solution_.backs.clear();
    if (!checkpoint_.empty()) {
      HemicubeSettings way = settings_.hemicubes;
      way.visibility = hemicubes_->visibility();
      file_ = std::make_unique<RowFile>(checkpoint_, rowsFingerprint(solution_.mesh, way),
                                        static_cast<std::uint32_t>(count_),
                                        [&](const FormFactorRows& rows) { take(rows); });
    }
    const Clock::time_point start = Clock::now();
    const std::size_t from = solution_.fronts.size();
    std::size_t computed = 0;
    bool stopped = false;
    const auto keep = [&](const FormFactorRows& rows) {
      take(rows);
      if (file_) file_->append(rows);
    };
    hemicubes_->stream(static_cast<int>(from), static_cast<int>(count_), keep, [&](int done) {
      solution_.hemicubes += static_cast<std::size_t>(done) - from - computed;
      computed = static_cast<std::size_t>(done) - from;
      stopped = !stage(RadiosityStage::Kind::formFactors, static_cast<std::size_t>(done));
      return !stopped;
    });
    solution_.hemicubeSeconds += secondsSince(start);
    solution_.keptRows = kept_;
    solution_.visibility = hemicubes_->visibility();
    if (stopped) stop();
  }

  /// Takes the next rows into the matrix, as long as all of it will fit in memory.
  void take(const FormFactorRows& rows) {
    if (kept_) append(matrix_, rows);
    auto factor = rows.factors.begin();
    for (const std::uint32_t count : rows.counts)
      rowSums_.push_back(std::accumulate(factor, factor + count, 0.0)), factor += count;
    solution_.fronts.insert(solution_.fronts.end(), rows.fronts.begin(), rows.fronts.end());
    solution_.backs.insert(solution_.backs.end(), rows.backs.begin(), rows.backs.end());
    const double perPatch = static_cast<double>(matrix_.entryCount()) / static_cast<double>(solution_.fronts.size()),
                 bytes = perPatch * static_cast<double>(count_) * static_cast<double>(kBytesPerEntry);
    if (!kept_ || bytes <= static_cast<double>(memory_)) return;
    logWarning(
        "radiosity: the form factors of {} patches need about {} MiB, {} are available: they are {} for each product",
        count_, static_cast<std::size_t>(bytes) >> 20, memory_ >> 20,
        checkpoint_.empty() ? "recomputed" : "read from " + checkpoint_.string());
    kept_ = false;
    matrix_ = {};
  }

  // ---------------------------------------------------------------------------------------------- system

  /// Areas, reflectance and emission of all patches, and the required sum of each row of form factors.
  RadiositySystem balances() {
    RadiositySystem system;
    for (std::size_t i = 0; i < count_; ++i) {
      const Patch& patch = solution_.mesh.patches[i];
      system.areas.push_back(patch.area);
      system.reflectance.push_back(patch.reflectance);
      system.emission.push_back(patch.emission + patch.reflectance * (solution_.direct[i] + solution_.fromSky[i]));
      // Shares are counted in units of 2^-28, each rounded: a row within 1e-5 of closed is closed. An open row sums to
      // its factors: closed forms include lights that no pixel meets.
      sums_.push_back(static_cast<double>(solution_.fronts[i]) > 1.0 - 1e-5 ? 1.0 : std::min(1.0, rowSums_[i]));
    }
    return system;
  }

  /// The product with the matrix in memory, made reciprocal and with corrected row sums.
  void keptProduct(RadiositySystem& system) {
    double off = 0.0;
    for (std::size_t i = 0; i < count_; ++i) off += std::abs(rowSums_[i] - sums_[i]);
    solution_.repaired = off / static_cast<double>(count_);
    if (settings_.repair) {
      const double resolution = settings_.hemicubes.resolution,
                   pixel = 4.0 / (std::numbers::pi * resolution * resolution);  // the largest delta form factor
      matrix_.repair(system.areas, sums_, hemicubes_->smallSources(), settings_.hemicubes.exactPixels * pixel);
      system.reciprocal = true;
    }
    system.matrix = &matrix_;
    system.rowSums = matrix_.rowSums();
    solution_.entries = matrix_.entryCount();
    system.product = [this](auto x, auto y) { matrix_.multiply(x, y); };
  }

  /// Each product reads all rows from the checkpoint, or draws all hemicubes again if there is none. Of the repair,
  /// only the row sums are applied; reciprocity stays as the hemicubes left it.
  void streamedProduct(RadiositySystem& system) {
    system.rowSums = settings_.repair ? sums_ : rowSums_;
    system.product = [this](std::span<const glm::dvec3> x, std::span<glm::dvec3> y) {
      const auto multiply = [&](const FormFactorRows& rows) {
        std::size_t at = 0, row = static_cast<std::size_t>(rows.first);
        for (const std::uint32_t count : rows.counts) {
          glm::dvec3 sum(0.0);
          for (const std::size_t end = at + count; at < end; ++at)
            sum += static_cast<double>(rows.factors[at]) * x[rows.patches[at]];
          y[row] = settings_.repair && rowSums_[row] > 0.0 ? sum * (sums_[row] / rowSums_[row]) : sum;
          ++row;
        }
      };
      if (file_) return file_->forEach(multiply);
      for (std::size_t first = 0; first < count_;) {
        const std::size_t batch = std::min(count_ - first, static_cast<std::size_t>(hemicubes_->batchSize()));
        const FormFactorRows rows = hemicubes_->rows(static_cast<int>(first), static_cast<int>(batch));
        multiply(rows);
        first += rows.counts.size();
        solution_.hemicubes += rows.counts.size();
        if (!stage(RadiosityStage::Kind::formFactors, first)) stop();
      }
    };
  }

  /// Separates light directly from emitters, so that a view can replace it with sharper shadows.
  void shareOfEmitters(RadiositySystem& system) {
    solution_.fromEmitters.assign(count_, glm::dvec3(0.0));
    std::vector<glm::dvec3> emission;
    for (const Patch& patch : solution_.mesh.patches) emission.push_back(patch.emission);
    if (std::ranges::all_of(emission, [](const glm::dvec3& e) { return e == glm::dvec3(0.0); })) return;
    system.product(emission, solution_.fromEmitters);
    // Without other lamps, solvers begin with this very product. Reuse it, since it is expensive if rows are
    // recomputed.
    system.product = [this, emission = std::move(emission), product = std::move(system.product)](
                         std::span<const glm::dvec3> x, std::span<glm::dvec3> y) {
      if (std::ranges::equal(x, emission)) std::ranges::copy(solution_.fromEmitters, y.begin());
      else product(x, y);
    };
  }

  void solveSystem(const RadiositySystem& system) {
    bool stopped = false;
    SolverSettings solver;
    solver.solver = settings_.solver;
    solver.error = settings_.error;
    solver.mostProducts = settings_.mostProducts;
    solver.onStep = [&](const RadiosityProgress& p) {
      stopped = !stage(RadiosityStage::Kind::solving, count_, p);
      return !stopped;
    };
    RadiositySolved solved = solveRadiosity(system, solver);
    if (stopped) stop();
    solution_.exitance = std::move(solved.exitance);
    solution_.irradiance = std::move(solved.irradiance);
    for (std::size_t i = 0; i < count_; ++i) solution_.irradiance[i] += solution_.direct[i] + solution_.fromSky[i];
    solution_.progress = solved.progress;
    solution_.solver = solved.solver;
    solution_.reached = solved.reached;
  }

  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  const Scene& scene_;
  const RadiositySolutionSettings& settings_;
  const int refinement_;
  const std::filesystem::path checkpoint_;
  const std::function<bool(const RadiosityStage&)>& onStage_;
  RadiositySolution& solution_;
  const std::size_t count_;  ///< patches

  std::optional<RayScene> rays_;  ///< for the patches
  std::optional<Hemicubes> hemicubes_;
  std::unique_ptr<RowFile> file_;  ///< the checkpoint
  const std::size_t memory_ = settings_.memoryBytes ? settings_.memoryBytes : freeMemory() / 2;
  bool kept_ = true;  ///< whether the matrix is in memory
  FormFactorMatrix matrix_;
  std::vector<double> rowSums_;  ///< from the hemicubes
  std::vector<double> sums_;  ///< required
};

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
  std::unordered_map<std::uint64_t, std::pair<std::uint32_t, std::size_t>>
      across;  // light vertices of an edge, mapped to patch and edge
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
/// would hide it.
RadiositySolutionSettings withDeviations(RadiositySolutionSettings settings) {
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
  const glm::dvec3 extent = scene.bounds.extent();
  return std::max({extent.x, extent.y, extent.z});
}

PatchSettings patchesOf(const Scene& scene, const RadiositySolutionSettings& settings) {
  PatchSettings patches = settings.patches;
  if (patches.longestEdge <= 0.0) patches.longestEdge = largestExtent(scene) / kEdges;
  if (settings.wholeTriangles) patches.longestEdge = 0.0;
  return patches;
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
                                 const RadiositySolutionSettings& askedSettings)
    : work_(std::make_unique<Work>()) {
  RadiositySolutionSettings settings = withDeviations(askedSettings);
  if (const glm::dvec3 origin = exactOrigin(asked.bounds); origin != glm::dvec3(0.0))
    work_->moved = movedTo(asked, origin);
  const Scene& scene = work_->moved ? *work_->moved : asked;
  work_->mesh = makePatches(scene, patchesOf(scene, settings));
  work_->rays.emplace(sceneOf(work_->mesh), context.capabilities());
  if (!settings.deviations.centroid) cutHiddenParts(programs, *work_->rays, work_->mesh);
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
                             const std::function<bool(const RadiosityStage&)>& onStage) {
  // Far from the origin, floats cannot represent the patches: solve near the origin, and return the scene's own
  // coordinates.
  if (const glm::dvec3 origin = exactOrigin(scene.bounds); origin != glm::dvec3(0.0)) {
    RadiositySolution solution = solveScene(context, programs, movedTo(scene, origin), asked, checkpoint, onStage);
    for (glm::dvec3& point : solution.mesh.points) point += origin;
    for (Patch& patch : solution.mesh.patches) patch.centroid += origin;
    return solution;
  }
  const RadiositySolutionSettings settings = withDeviations(asked);
  const PatchSettings patches = patchesOf(scene, settings);
  const double largest = largestExtent(scene);
  RadiositySolution solution;
  solution.deviations = settings.deviations;
  solution.settings = textOf(asked);
  solution.mesh = makePatches(scene, patches);
  const double shortest =
      (patches.longestEdge > 0.0 ? patches.longestEdge : largest / kEdges) / std::pow(2.0, settings.refinements + 1);
  for (int refinement = 0;; ++refinement) {
    MeshSolver(context, programs, scene, settings, refinement, checkpointOf(checkpoint, refinement), onStage, solution)
        .solve();
    if (refinement >= settings.refinements) return solution;
    RadiosityMesh finer = refineSteep(scene, solution, patches, settings.steep, shortest);
    if (finer.patches.size() == solution.mesh.patches.size()) return solution;
    solution.mesh = std::move(finer);
  }
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

}  // namespace

RadiosityOrigins originsOf(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                           const RadiositySolution& solution, const RadiositySolutionSettings& settings,
                           std::uint32_t patch, const glm::dvec3& corners, bool flat) {
  RadiosityMesh mesh = solution.mesh;
  if (const glm::dvec3 origin = exactOrigin(scene.bounds); origin != glm::dvec3(0.0)) {
    for (glm::dvec3& point : mesh.points) point -= origin;
    for (Patch& p : mesh.patches) p.centroid -= origin;
  }
  HemicubeSettings hemicubeSettings = withDeviations(settings).hemicubes;
  if (hemicubeSettings.visibility == HemicubeVisibility::automatic)
    hemicubeSettings.visibility = visibilityByCount(mesh, hemicubeSettings.resolution);
  Hemicubes hemicubes(programs, context.capabilities(), mesh, hemicubeSettings);
  RadiosityOrigins origins;
  std::map<std::uint32_t, double> factors;
  for (const auto& [i, weight] : weightsAround(solution, patch, corners, flat)) {
    if (!(weight > 0.0)) continue;
    origins.lamps += weight * solution.direct[i];
    origins.sky += weight * solution.fromSky[i];
    const FormFactorRows rows = hemicubes.rows(static_cast<int>(i), 1);
    for (std::size_t k = 0; k < rows.patches.size(); ++k)
      factors[rows.patches[k]] += weight * static_cast<double>(rows.factors[k]);
  }
  for (const auto& [i, factor] : factors) {
    const glm::dvec3 emission = mesh.patches[i].emission;
    origins.patches.push_back({i, factor, factor * emission, factor * (solution.exitance[i] - emission)});
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
