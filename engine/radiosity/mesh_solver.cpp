#include "radiosity/mesh_solver.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/log.hpp"
#include "radiosity/direct_light.hpp"
#include "radiosity/form_factor_matrix.hpp"
#include "radiosity/hemicube_batch.hpp"
#include "radiosity/hemicubes.hpp"
#include "radiosity/backs.hpp"
#include "radiosity/row_file.hpp"
#include "radiosity/solution_watch.hpp"
#include "scene/features.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <unistd.h>
#include <utility>

namespace lucerna {

namespace {

using Vectors = std::vector<glm::dvec3>;
using Product = decltype(RadiositySystem::product);

// For a form factor, its transposed copy and their mean, during the repair; where the scene moves, for rows of this
// moment and both of the one before.
constexpr double kBytesPerEntry = 32.0, kBytesPerEntryInMotion = 56.0;

std::size_t freeMemory() {
  return static_cast<std::size_t>(std::max(sysconf(_SC_AVPHYS_PAGES), 1L)) *
         static_cast<std::size_t>(std::max(sysconf(_SC_PAGESIZE), 1L));
}

/// The rows of form factors of a mesh so far.
struct FormFactors {
  std::optional<FormFactorMatrix> matrix = FormFactorMatrix();  ///< none: the rows do not fit in memory
  std::vector<double> sums;  ///< of each row
  std::vector<float> fronts, backs;  ///< shares of each hemisphere
  std::size_t hemicubes = 0;  ///< computed, not read from a checkpoint
  double seconds = 0.0;  ///< that those took

  std::size_t entries = 0;  ///< of all rows

  std::size_t rowCount() const { return fronts.size(); }

  /// Adds the next rows.
  void append(const FormFactorRows& rows) {
    std::size_t at = 0;
    for (const std::uint32_t count : rows.counts) {
      const auto own = std::span(rows.factors).subspan(at, count);
      if (matrix) matrix->appendRow(std::span(rows.patches).subspan(at, count), own);
      sums.push_back(std::accumulate(own.begin(), own.end(), 0.0));
      at += count;
    }
    entries += rows.factors.size();
    fronts.insert(fronts.end(), rows.fronts.begin(), rows.fronts.end());
    backs.insert(backs.end(), rows.backs.begin(), rows.backs.end());
  }
  /// With `patches` rows, if the rest is like the rows so far.
  double expectedEntries(std::size_t patches) const {
    return static_cast<double>(entries) / static_cast<double>(rowCount()) * static_cast<double>(patches);
  }
};

/// The sum that each row of form factors must have.
std::vector<double> requiredSums(const FormFactors& factors) {
  std::vector<double> required;
  // Shares are counted in units of 2^-28, each rounded: a row within 1e-5 of closed is closed. An open row sums to its
  // factors: closed forms include lights that no pixel meets.
  for (std::size_t i = 0; i < factors.rowCount(); ++i)
    required.push_back(static_cast<double>(factors.fronts[i]) > 1.0 - 1e-5 ? 1.0 : std::min(1.0, factors.sums[i]));
  return required;
}

double meanDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

/// Areas, reflectance and emission of all patches, where lamps and sky are reflected as emission.
RadiositySystem systemOf(const RadiosityMesh& mesh, const Vectors& fromLamps, const Vectors& fromSky) {
  RadiositySystem system;
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) {
    const Patch& patch = mesh.patches[i];
    system.areas.push_back(patch.area);
    system.reflectance.push_back(patch.reflectance);
    system.emission.push_back(patch.emission + patch.reflectance * (fromLamps[i] + fromSky[i]));
  }
  return system;
}

class MeshSolver {
 public:
  MeshSolver(const MeshSolverInput& input, std::size_t patches)
      : input_(input),
        count_(patches),
        memory_(input.settings.memoryBytes ? input.settings.memoryBytes : freeMemory() / 2) {}

  RadiositySolution solve(RadiosityMesh mesh, HemicubeVisibility visibility) const {
    const gl::Capabilities& capabilities = input_.context.capabilities();
    const Clock::time_point begin = Clock::now();
    report(RadiosityStage::Kind::direct, 0);
    RadiositySolution solution;
    const RayScene rays(sceneOf(mesh), capabilities);
    if (!input_.settings.deviations.centroid) cutHiddenPartsOfFronts(input_.context, input_.programs, rays, mesh);
    solution.direct = directLight(input_.programs, rays, input_.scene, mesh);
    solution.fromSky = analyse(input_.scene).environment ? skyLight(input_.programs, rays, input_.scene, mesh)
                                                         : Vectors(count_, glm::dvec3(0.0));
    HemicubeSettings hemicubeSettings = input_.settings.hemicubes;
    solution.visibility = hemicubeSettings.visibility = visibilityOf(mesh, visibility);
    const std::vector<std::uint32_t> sources = smallSourcesOf(mesh);
    std::optional<MomentBefore> before;
    if (input_.before)
      before.emplace(*input_.before, input_.scene, mesh,
                     hemicubeSettings.exactPixels > 0 ? std::span(sources) : std::span<const std::uint32_t>());

    // Form factors, unless nothing but light has changed.
    FormFactors factors;
    std::optional<Hemicubes> hemicubes;
    std::unique_ptr<RowFile> file;
    if (before && before->isWhole()) {
      factors.fronts = input_.before->fronts;
      factors.backs = input_.before->backs;
    } else {
      hemicubes.emplace(input_.programs, capabilities, mesh, hemicubeSettings, &rays);
      solution.visibility = hemicubeSettings.visibility = hemicubes->visibility();
      constexpr double kLong = 5.0;  // seconds
      if (const double seconds = secondsSince(begin); seconds > kLong)
        logInfo("radiosity: hierarchy and direct light of {} patches took {:.0f} s; its {} hemicubes follow{}", count_,
                seconds, count_, input_.checkpoint.empty() ? "" : ", which are kept when it is stopped");
      file = openCheckpoint(rowsFingerprint(mesh, hemicubeSettings), factors);
      computeRows(*hemicubes, before, file, factors);
    }

    // The system and its solution.
    const Clock::time_point start = Clock::now();
    RadiositySystem system = systemOf(mesh, solution.direct, solution.fromSky);
    auto moment = input_.scene.motion ? std::make_shared<RadiosityMoment>() : nullptr;
    const std::vector<double> required = hemicubes ? requiredSums(factors) : std::vector<double>();
    std::shared_ptr<const FormFactorMatrix> matrix;
    if (!hemicubes) {
      matrix = input_.before->repaired;
      moment->rows = input_.before->rows;
    } else if (factors.matrix) {
      solution.repaired = meanDifference(factors.sums, required);
      // With refinements meshes follow the light, and so would their rows.
      if (moment && input_.settings.refinements == 0)
        moment->rows = std::make_shared<const FormFactorMatrix>(*factors.matrix);
      repair(system, *factors.matrix, required, sources);
      matrix = std::make_shared<const FormFactorMatrix>(*std::exchange(factors.matrix, std::nullopt));
    }
    solution.keptRows = matrix != nullptr;
    if (matrix) {
      useMatrix(system, *matrix);
      solution.entries = matrix->entryCount();
    } else {
      system.rowSums = input_.settings.repair ? required : factors.sums;
      system.product = productOfRows(factors, required, *hemicubes, file.get());
    }
    solution.fromEmitters = lightOfEmitters(mesh, system.product);
    system.product = reusing(mesh, solution.fromEmitters, std::move(system.product));
    RadiositySolved solved = solveSystem(system, factors, before ? before->start(system) : Vectors());
    if (before)
      logVerbose("radiosity: {} of {} rows made again, {:.1f} products", factors.hemicubes, count_,
                 solved.progress.products);

    if (moment) {
      moment->mesh = mesh;
      if (moment->rows) moment->repaired = matrix;
      moment->fronts = factors.fronts;
      moment->backs = factors.backs;
      moment->sources = sources;
      moment->irradiance = solved.irradiance;
      moment->emitted = emittedBy(system);
      solution.moment = std::move(moment);
    }
    solution.exitance = std::move(solved.exitance);
    solution.irradiance = std::move(solved.irradiance);
    for (std::size_t i = 0; i < count_; ++i) solution.irradiance[i] += solution.direct[i] + solution.fromSky[i];
    solution.progress = solved.progress;
    solution.solver = solved.solver;
    solution.reached = solved.reached;
    solution.fronts = std::move(factors.fronts);
    solution.backs = std::move(factors.backs);
    solution.hemicubes = factors.hemicubes;
    solution.hemicubeSeconds = factors.seconds;
    solution.solveSeconds = secondsSince(start);
    solution.mesh = std::move(mesh);
    return solution;
  }

 private:
  /// Reports progress; false: the caller wants it to stop.
  bool report(RadiosityStage::Kind kind, std::size_t done, const RadiosityProgress& progress = {}) const {
    return !input_.onStage || input_.onStage({kind, input_.refinement, done, count_, progress, {}});
  }
  [[noreturn]] void stop(const FormFactors& factors) const {
    const std::string file = input_.checkpoint.string();
    throw Stopped(fmt::format("stopped after {} of {} hemicubes{}", factors.rowCount(), count_,
                              std::filesystem::exists(file) ? "; the same command resumes from " + file : ""));
  }

  /// Rows by different methods differ in their last bits, so a checkpoint is continued with the method that began it.
  HemicubeVisibility visibilityOf(const RadiosityMesh& mesh, HemicubeVisibility asked) const {
    if (asked != HemicubeVisibility::automatic || input_.checkpoint.empty()) return asked;
    const std::optional<std::uint64_t> begun = RowFile::fingerprintOf(input_.checkpoint);
    HemicubeSettings settings = input_.settings.hemicubes;
    for (const HemicubeVisibility one :
         {HemicubeVisibility::raster, HemicubeVisibility::rays, HemicubeVisibility::itemBuffer}) {
      settings.visibility = one;
      if (begun && rowsFingerprint(mesh, settings) == *begun) return one;
    }
    return HemicubeVisibility::automatic;
  }

  // ---------------------------------------------------------------------------------------------- form factors

  /// The checkpoint, if there is to be one; adds the rows that it holds.
  std::unique_ptr<RowFile> openCheckpoint(std::uint64_t fingerprint, FormFactors& factors) const {
    if (input_.checkpoint.empty()) return nullptr;
    if (SolutionWatch::isKept(input_.checkpoint) && RowFile::fingerprintOf(input_.checkpoint) != fingerprint)
      std::filesystem::remove(input_.checkpoint);
    return std::make_unique<RowFile>(input_.checkpoint, fingerprint, static_cast<std::uint32_t>(count_),
                                     [&](const FormFactorRows& rows) { add(rows, factors); });
  }

  /// Computes the missing rows, and appends them to the checkpoint, unless it becomes too large.
  void computeRows(Hemicubes& hemicubes, const std::optional<MomentBefore>& before, std::unique_ptr<RowFile>& file,
                   FormFactors& factors) const {
    const Clock::time_point start = Clock::now();
    const std::size_t known = factors.rowCount();
    const double mostBytes = SolutionWatch::mostBytes(input_.checkpoint);
    bool stopped = false;
    const auto take = [&](const FormFactorRows& rows) {
      add(rows, factors);
      if (file && factors.rowCount() >= count_ / 100) dropIfTooLarge(file, factors, mostBytes);
      if (file) file->append(rows);
    };
    const auto holds = [&](std::size_t row) { return before && before->rowHolds()[row]; };
    for (std::size_t row = known, end = known; row < count_ && !stopped; row = end) {
      while (end < count_ && holds(end) == holds(row)) ++end;
      if (holds(row)) {
        add(before->rows(row, end), factors);
        continue;
      }
      hemicubes.stream(static_cast<int>(row), static_cast<int>(end), take, [&](int done) {
        stopped = !report(RadiosityStage::Kind::formFactors, static_cast<std::size_t>(done));
        return !stopped;
      });
      factors.hemicubes += end - row;
    }
    if (stopped) stop(factors);
    factors.seconds = secondsSince(start);
  }

  void dropIfTooLarge(std::unique_ptr<RowFile>& file, const FormFactors& factors, double mostBytes) const {
    const double bytes = RowFile::kBytesPerEntry * factors.expectedEntries(count_);
    if (bytes <= mostBytes) return;
    logWarning(
        "radiosity: the form factors of {} patches would take {:.0f} GB in {}, more than {:.0f} GB: they are not kept "
        "there, so a stop loses them{} (radiosity.file=FILE keeps them in FILE.part; a larger radiosity.edge makes "
        "fewer)",
        count_, 1e-9 * bytes, input_.checkpoint.parent_path().string(), 1e-9 * mostBytes,
        factors.matrix ? "" : ", and each product computes them again");
    file.reset();
    std::filesystem::remove(input_.checkpoint);
  }

  /// Adds rows; drops the matrix once it is clear that it will not fit in memory.
  void add(const FormFactorRows& rows, FormFactors& factors) const {
    const bool areFirst = factors.rowCount() == 0;
    factors.append(rows);
    const double each = input_.scene.motion ? kBytesPerEntryInMotion : kBytesPerEntry,
                 entries = factors.expectedEntries(count_), bytes = entries * each;
    if (!factors.matrix) return;
    if (bytes <= static_cast<double>(memory_)) {
      // At once: while it grew, all of it would be copied again and again.
      if (areFirst) factors.matrix->reserve(static_cast<std::size_t>(1.2 * entries));
      return;
    }
    logWarning(
        "radiosity: the form factors of {} patches need about {} MiB, {} are available: they are {} for each product",
        count_, static_cast<std::size_t>(bytes) >> 20, memory_ >> 20,
        input_.checkpoint.empty() ? "recomputed" : "read from " + input_.checkpoint.string());
    factors.matrix.reset();
  }

  // ---------------------------------------------------------------------------------------------- system

  /// Makes a matrix reciprocal and corrects its row sums, if the settings say so.
  void repair(const RadiositySystem& system, FormFactorMatrix& matrix, const std::vector<double>& required,
              const std::vector<std::uint32_t>& smallSources) const {
    if (!input_.settings.repair) return;
    const double resolution = input_.settings.hemicubes.resolution,
                 pixel = 4.0 / (std::numbers::pi * resolution * resolution);  // the largest delta form factor
    matrix.repair(system.areas, required, smallSources, input_.settings.hemicubes.exactPixels * pixel);
  }

  void useMatrix(RadiositySystem& system, const FormFactorMatrix& matrix) const {
    system.reciprocal = input_.settings.repair;
    system.matrix = &matrix;
    system.rowSums = matrix.rowSums();
    system.product = [&matrix](auto x, auto y) { matrix.multiply(x, y); };
  }

  /// A product that reads all rows from the checkpoint, or draws all hemicubes again if there is none. Of the repair,
  /// only the row sums are applied; reciprocity stays as the hemicubes left it.
  Product productOfRows(FormFactors& factors, const std::vector<double>& required, Hemicubes& hemicubes,
                        RowFile* file) const {
    return [&, file](std::span<const glm::dvec3> x, std::span<glm::dvec3> y) {
      const auto multiply = [&](const FormFactorRows& rows) {
        std::size_t at = 0, row = static_cast<std::size_t>(rows.first);
        for (const std::uint32_t count : rows.counts) {
          glm::dvec3 sum(0.0);
          for (const std::size_t end = at + count; at < end; ++at)
            sum += static_cast<double>(rows.factors[at]) * x[rows.patches[at]];
          const bool repairs = input_.settings.repair && factors.sums[row] > 0.0;
          y[row] = repairs ? sum * (required[row] / factors.sums[row]) : sum;
          ++row;
        }
      };
      if (file) return file->forEach(multiply);
      for (std::size_t first = 0; first < count_;) {
        const std::size_t batch = std::min(count_ - first, static_cast<std::size_t>(hemicubes.batchSize()));
        const FormFactorRows rows = hemicubes.rows(static_cast<int>(first), static_cast<int>(batch));
        multiply(rows);
        first += rows.counts.size();
        factors.hemicubes += rows.counts.size();
        if (!report(RadiosityStage::Kind::formFactors, first)) stop(factors);
      }
    };
  }

  static Vectors emissionOf(const RadiosityMesh& mesh) {
    Vectors emission;
    for (const Patch& patch : mesh.patches) emission.push_back(patch.emission);
    return emission;
  }
  static bool isDark(const Vectors& emission) {
    return std::ranges::all_of(emission, [](const glm::dvec3& e) { return e == glm::dvec3(0.0); });
  }

  /// Irradiance directly from emissive patches, so that a view can replace it with sharper shadows.
  Vectors lightOfEmitters(const RadiosityMesh& mesh, const Product& product) const {
    Vectors irradiance(count_, glm::dvec3(0.0));
    if (const Vectors emission = emissionOf(mesh); !isDark(emission)) product(emission, irradiance);
    return irradiance;
  }

  /// The product, except for the emission, whose irradiance is known. Without other lamps solvers begin with this very
  /// product, which is expensive if rows are recomputed.
  static Product reusing(const RadiosityMesh& mesh, const Vectors& fromEmitters, Product product) {
    Vectors emission = emissionOf(mesh);
    if (isDark(emission)) return product;
    return [&fromEmitters, emission = std::move(emission), product = std::move(product)](std::span<const glm::dvec3> x,
                                                                                         std::span<glm::dvec3> y) {
      if (std::ranges::equal(x, emission)) std::ranges::copy(fromEmitters, y.begin());
      else product(x, y);
    };
  }

  RadiositySolved solveSystem(const RadiositySystem& system, const FormFactors& factors, const Vectors& start) const {
    bool stopped = false;
    SolverSettings solver;
    solver.start = start;
    solver.solver = input_.settings.solver;
    solver.error = input_.settings.error;
    solver.mostProducts = input_.settings.mostProducts;
    solver.onStep = [&](const RadiosityProgress& p) {
      stopped = !report(RadiosityStage::Kind::solving, count_, p);
      return !stopped;
    };
    RadiositySolved solved = solveRadiosity(system, solver);
    if (stopped) stop(factors);
    return solved;
  }

  const MeshSolverInput& input_;
  const std::size_t count_;  ///< patches
  const std::size_t memory_;  ///< bytes for form factors
};

}  // namespace

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

RadiositySolution solveMesh(const MeshSolverInput& input, RadiosityMesh mesh, HemicubeVisibility visibility) {
  const std::size_t patches = mesh.patches.size();
  return MeshSolver(input, patches).solve(std::move(mesh), visibility);
}

}  // namespace lucerna
