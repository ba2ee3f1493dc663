// lucerna radiosity solve --fidelity original: runs the published program, with its files safe at any moment.
#include "radiosity.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "radiosity/original/checkpoint.hpp"
#include "radiosity/original/solver.hpp"

#include <fmt/core.h>

#include <array>
#include <cstring>
#include <numeric>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;

/// OUT and its checkpoint, as this run left them.
class Files {
 public:
  Files(fs::path out, std::uint64_t settings)
      : out_(std::move(out)), checkpoint_(checkpointOf(out_)), settings_(settings) {}

  const fs::path& checkpoint() const { return checkpoint_; }

  /// The content of OUT, or its intended content if it does not exist yet.
  void holds(std::span<const RadTriangle> triangles) {
    digest_ = digestOf(encodeRadFile(triangles));
    stamp_ = stampOf(out_);
  }

  void saveWithinSweep(const OriginalProgress& progress) const {
    refuseIfChanged();
    writeCheckpoint(checkpoint_, {digest_, digest_, settings_, progress});
  }

  /// Writes the checkpoint first, which matches OUT before and after the update, then OUT.
  void saveSweep(const OriginalProgress& progress, std::span<const RadTriangle> triangles) {
    refuseIfChanged();
    const std::uint64_t after = digestOf(encodeRadFile(triangles));
    writeCheckpoint(checkpoint_, {digest_, after, settings_, progress});
    writeRadFile(out_, triangles);
    digest_ = after;
    stamp_ = stampOf(out_);
  }

  void removeCheckpoint() const {
    std::error_code ignored;
    fs::remove(checkpoint_, ignored);
  }

 private:
  void refuseIfChanged() const {
    if (stampOf(out_) != stamp_)
      throwBadInput(
          "{}: was changed by another program since this run last wrote or read it; it is left unchanged, and the "
          "results since then are lost",
          out_.string());
  }

  fs::path out_, checkpoint_;
  std::uint64_t settings_, digest_ = 0;
  std::array<std::int64_t, 4> stamp_{};
};

bool sameButReceived(std::span<const RadTriangle> a, std::span<const RadTriangle> b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    RadTriangle x = a[i], y = b[i];
    x.b = y.b = 0;
    if (std::memcmp(&x, &y, sizeof x) != 0) return false;
  }
  return true;
}

/// The checkpoint next to OUT, if this very run can continue from it; otherwise nothing, with a warning that says why.
std::optional<OriginalProgress> takeUp(const RadiositySolve& options, std::span<const RadTriangle> triangles,
                                       std::uint64_t settings) {
  const fs::path file = checkpointOf(options.out);
  std::error_code error;
  if (options.restart || !fs::exists(file, error)) return std::nullopt;
  const auto unused = [&](const std::string& why) {
    logWarning("{}: not resumed ({}): starts from {}", file.string(), why, options.in);
    return std::nullopt;
  };
  try {
    const OriginalCheckpoint checkpoint = readCheckpoint(file);
    if (checkpoint.settings != settings) return unused("made with different settings or on a different renderer");
    if (checkpoint.progress.received.size() != triangles.size()) return unused("of another scene");
    std::uint64_t there = digestOf(encodeRadFile(triangles));  // OUT may not exist yet: then it would equal IN
    if (fs::exists(options.out, error)) {
      const std::vector<RadTriangle> out = readRadFile(options.out);
      if (!sameButReceived(out, triangles)) return unused(options.out + " holds another scene");
      there = digestOf(encodeRadFile(out));
    }
    if (there != checkpoint.before && there != checkpoint.after)
      return unused(options.out + " is not what it belongs to");
    return checkpoint.progress;
  } catch (const Error& fault) { return unused(fault.what()); }
}

/// Whole numbers stop changing; floats may keep changing their last bit.
double leastChange(const OriginalRadiosity::Settings& settings, std::span<const float> received) {
  return settings.deviations.values24Bit ? 0.0 : 1e-7 * std::accumulate(received.begin(), received.end(), 0.0);
}

}  // namespace

int solveOriginal(const RadiositySolve& options) {
  // Settings from the options.
  OriginalRadiosity::Settings settings;
  settings.view = options.resolution;
  settings.seed = options.seed;
  settings.nearPlane = options.nearPlane.value_or(0.0);
  if (!options.solver.empty()) {
    const RadiositySolver solver = parseName<RadiositySolver>(options.solver, "--solver");
    if (solver != RadiositySolver::jacobi && solver != RadiositySolver::gaussSeidel)
      throwBadInput("--solver {}: the original has jacobi and gauss-seidel", options.solver);
    settings.gaussSeidel = solver == RadiositySolver::gaussSeidel;
  }
  for (const std::string& deviation : options.deviations) applyRadiosityDeviation(settings.deviations, deviation);

  // Read the scene and create the published program's solver.
  const std::vector<RadTriangle> triangles = readRadFile(options.in);
  const std::size_t zeroArea = checkRadTriangles(triangles, options.in);
  if (zeroArea > 0) logWarning("{}: {} triangles without area are left out of the computation", options.in, zeroArea);

  const auto host = options.common.makeHost(false);
  const gl::Context context;
  const std::string& renderer = context.capabilities().renderer;
  gl::ProgramLibrary programs;
  OriginalRadiosity solver(programs, triangles, settings);
  const std::uint64_t key = digestOf(settings, solver.nearPlane(), renderer);

  // Continue a stopped run from its files.
  OriginalProgress progress = solver.start();
  std::error_code error;
  Files files(options.out, key);
  if (const auto taken = takeUp(options, triangles, key)) {
    progress = *taken;
    files.holds(fs::exists(options.out, error) ? readRadFile(options.out) : triangles);
    if (!options.common.quiet)
      fmt::print("{}: resumed at sweep {}, {} of {} triangles done\n", files.checkpoint().string(), progress.sweeps + 1,
                 progress.done, triangles.size());
  } else {
    files.holds(triangles);
    files.saveSweep(progress, triangles);  // so that an unwritable folder or disk is detected before the work
  }

  // Sweep until nothing changes; save after each sweep and regularly within one.
  watchForInterrupt();
  const auto start = Clock::now();
  const std::uint32_t sweepsBefore = progress.sweeps;
  bool settled = false, stopped = false;
  while (!settled && !stopped &&
         (options.maxSweeps == 0 || progress.sweeps < static_cast<std::uint32_t>(options.maxSweeps))) {
    const auto sweepStart = Clock::now();
    const std::size_t hemicubesBefore = solver.hemicubes();
    Progress bar(fmt::format("sweep {}", progress.sweeps + 1), static_cast<int>(triangles.size()),
                 options.common.quiet);
    auto saved = Clock::now();
    const auto goOn = [&](const OriginalProgress& now) {
      bar.update(static_cast<int>(now.done));
      if (interrupted()) return false;
      if (secondsSince(saved) >= options.saveEvery) {
        files.saveWithinSweep(now);
        saved = Clock::now();
      }
      return true;
    };
    if (!solver.sweep(progress, goOn)) {
      files.saveWithinSweep(progress);
      stopped = true;
      break;
    }
    files.saveSweep(progress, solver.withReceived(progress.received));
    settled = progress.change <= leastChange(settings, progress.received);
    if (!options.common.quiet)
      fmt::print("sweep {:>3}: change {:.6g}, {:.1f} hemicubes/s\n", progress.sweeps, progress.change,
                 static_cast<double>(solver.hemicubes() - hemicubesBefore) / secondsSince(sweepStart));
    stopped = !settled && interrupted();
  }
  const double seconds = secondsSince(start);
  if (settled) files.removeCheckpoint();
  if (solver.overflows() > 0)
    logWarning(
        "{}: {} times a triangle sent more than 24 bits hold; the upper bits were lost, as published (a lower "
        "LIGHT_POWER avoids it)",
        options.in, solver.overflows());

  // Report the result, for people and as JSON.
  const double hemicubes = static_cast<double>(solver.hemicubes());
  const double rate = seconds > 0.0 ? hemicubes / seconds : 0.0,
               triangleRate = seconds > 0.0 ? static_cast<double>(solver.drawnTriangles()) / seconds / 1e6 : 0.0;
  const double balance = solver.energyBalance(progress.received);
  if (!options.common.quiet) {
    fmt::print(
        "{}: {} triangles, {} sweeps, {}; {:.2f} s, {:.1f} hemicubes/s, {:.2f} Mtriangles/s, energy balance {:+.4f}, "
        "on {}\n",
        options.out, triangles.size(), progress.sweeps,
        settled   ? "nothing changes any more"
        : stopped ? "stopped; the same command resumes it"
                  : "as many as requested",
        seconds, rate, triangleRate, balance, renderer);
  }
  nlohmann::ordered_json json;
  json["renderer"] = renderer;
  json["host"] = nameOf(host->kind());
  json["fidelity"] = "original";
  json["deviations"] = activeRadiosityDeviations(settings.deviations);
  json["solver"] = settings.gaussSeidel ? "gauss-seidel" : "jacobi";
  json["view"] = settings.view;
  json["near"] = solver.nearPlane();
  json["patches"] = triangles.size();
  json["zero_area"] = zeroArea;
  json["sweeps"] = progress.sweeps;
  json["sweeps_here"] = progress.sweeps - sweepsBefore;
  json["settled"] = settled;
  json["change"] = progress.change;
  json["seconds"] = seconds;
  json["hemicubes"] = solver.hemicubes();
  json["hemicubes_per_s"] = rate;
  json["mtriangles_per_s"] = triangleRate;
  json["error_bound"] = nullptr;
  json["error_bound_note"] = "none: the original stops when no number changes in a sweep, which bounds no error";
  json["energy_balance"] = balance;
  json["overflows"] = solver.overflows();
  json["gpu_bytes"] = solver.gpuBytes();
  options.common.writeJson(json);
  return stopped ? exitCode() : 0;
}

}  // namespace lucerna::demo
