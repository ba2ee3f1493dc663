// The path tracer's sweeps, corrected, denoised and as published, and its deviations one by one: pictures that
// accumulate samples, observed at 1, 2, 4, ... samples per pixel.
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/statistics.hpp"
#include "bench/error_rows.hpp"
#include "gl/draw.hpp"
#include "measure/flip.hpp"
#include "pathtracer/denoiser.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/deviations.hpp"

#include <fmt/core.h>

#include <cmath>
#include <ctime>
#include <optional>

namespace lucerna::demo::bench {

namespace {

constexpr std::uint32_t kWarmUp = 8;  // samples per pixel

/// Corrected, denoised, as published, or corrected with one deviation.
struct PathSeries {
  std::string name, fidelity;
  std::vector<std::string> deviations;
  PathDeviations switches;
  int seeds = 1;  ///< the median over this many
  double seconds = 0.0;  ///< for one seed's sweep
  bool lastPoint = false;  ///< keep only that one
  std::uint32_t samples = 0;  ///< the last point; 0: by time
  bool denoised = false;

  std::string label() const {
    std::string text = denoised ? "path denoised" : "path";
    if (fidelity != "corrected") text += " " + fidelity;
    for (const std::string& d : deviations) text += " " + d;
    return text;
  }
};

PathSeries seriesOf(const std::string& fidelity, const std::string& deviation) {
  RenderSettings settings;
  PathSeries series;
  series.fidelity = fidelity;
  series.name = deviation.empty() ? fidelity == "original" ? "path (original)" : "path" : "path " + deviation;
  if (fidelity == "original") applyFidelity(settings, Fidelity::original);
  if (!deviation.empty()) {
    series.deviations = {deviation + "=on"};
    applyDeviation(settings, series.deviations[0]);
  }
  series.switches = settings.of<PathSettings>().deviations;
  return series;
}

/// The sweeps; for the study of deviations, one point each.
std::vector<PathSeries> seriesOf(const ErrorBench& bench, bool deviations) {
  std::vector<PathSeries> all{seriesOf("corrected", "")};
  all[0].seeds = 3;
  if (deviations)
    for (const Deviation& d : allDeviations())
      if (std::string_view(d.name).starts_with("path.")) all.push_back(seriesOf("corrected", std::string(d.name)));
  if (!deviations) {
    all.push_back(seriesOf("corrected", ""));
    all.back().name = "path (denoised)";
    all.back().denoised = true;
  }
  all.push_back(seriesOf("original", ""));
  for (PathSeries& series : all) {
    series.lastPoint = deviations;
    if (deviations) series.seeds = 1;
    series.seconds = bench.pathSeconds / (deviations ? static_cast<double>(all.size()) : 4.0);
  }
  return all;
}

struct Observation {
  std::vector<double> ms, cpuMs;
  std::vector<JudgedPicture> errors;
  std::size_t gpuBytes = 0;
  double setupMs = 0.0;
  Image picture, standardError;  // for the first seed
  DenoisedError denoised;
};

std::uint32_t seedOf(int index) { return 0x51ed270bu + static_cast<std::uint32_t>(index) * 7919u; }

PathTracer::Settings settingsOf(const ErrorBench& bench, const PathSeries& series, int seed) {
  PathTracer::Settings settings;
  settings.size = bench.size;
  settings.diffuseOnly = !bench.references.own;  // like the reference
  settings.deviations = series.switches;
  settings.filter = bench.filter;
  settings.seed = seedOf(seed);
  settings.halves = series.denoised;
  return settings;
}

void observe(const ErrorBench& bench, const PathSeries& series, int seed,
             std::vector<std::pair<std::uint32_t, Observation>>& sweep) {
  const auto made = Clock::now();
  PathTracer tracer(bench.context, bench.programs, bench.scene, settingsOf(bench, series, seed));
  tracer.setCamera(bench.camera);
  // Preparation: the driver finishes each program on first use, path tracing once more after the denoiser's have left
  // their textures bound; and submissions grow until each takes its share of a second.
  std::optional<Denoiser> denoiser;
  if (series.denoised) denoiser.emplace(bench.programs, tracer);
  for (int i = 0; i < (denoiser ? 2 : 1); ++i) {
    tracer.record(kWarmUp);
    if (denoiser) denoiser->denoise();
    tracer.setCamera(bench.camera);
    if (denoiser) denoiser->forget();
  }
  gl::finish();
  const double setup = std::chrono::duration<double, std::milli>(Clock::now() - made).count();
  double spent = 0.0, cpu = 0.0;
  std::size_t step = 0;
  for (std::uint32_t samples = 1; !interrupted(); samples *= 2, ++step) {
    // The first seed decides how far the sweep goes; the others use the same points.
    if (seed == 0 && (series.samples ? samples > series.samples : samples > 4 && 2.0 * spent > 1e3 * series.seconds))
      break;
    if (seed > 0 && step >= sweep.size()) break;
    const auto start = Clock::now();
    const std::clock_t cpuStart = std::clock();
    tracer.record(samples);
    gl::finish();
    spent += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    cpu += 1e3 * static_cast<double>(std::clock() - cpuStart) / CLOCKS_PER_SEC;
    // Each point is a picture of its own, denoised once.
    const auto begun = Clock::now();
    const std::clock_t cpuBegun = std::clock();
    if (denoiser) {
      denoiser->denoise();
      gl::finish();
    }
    const double ownMs = std::chrono::duration<double, std::milli>(Clock::now() - begun).count(),
                 ownCpu = 1e3 * static_cast<double>(std::clock() - cpuBegun) / CLOCKS_PER_SEC;
    if (seed == 0) sweep.emplace_back(samples, Observation{});
    Observation& o = sweep[step].second;
    o.ms.push_back(spent + ownMs);
    o.cpuMs.push_back(cpu + ownCpu);
    const Image picture = denoiser ? denoiser->picture() : tracer.mean();
    const measure::Reference& reference = bench.references.path();
    const glm::dvec3 own = tracer.statistics().meanError;
    // Channels share their paths: their errors add as if fully correlated.
    const double ownError = samples > 1 ? (own.x + own.y + own.z) / 3.0 : INFINITY;
    o.errors.push_back(bench.references.judge(picture, reference, false, ownError));
    if (seed == 0) {
      o.picture = picture;
      if (samples > 1 && !denoiser) o.standardError = tracer.standardError();
      if (denoiser) o.denoised = denoiser->error();
      o.setupMs = setup;
      o.gpuBytes = tracer.gpuBytes() + (denoiser ? denoiser->gpuBytes() : 0);
    }
  }
}

/// One value per seed.
std::vector<double> ofSeeds(const std::vector<JudgedPicture>& errors, double (*of)(const JudgedPicture&)) {
  std::vector<double> values;
  for (const JudgedPicture& e : errors) values.push_back(of(e));
  return values;
}

double medianOf(const std::vector<JudgedPicture>& errors, double (*of)(const JudgedPicture&)) {
  return median(ofSeeds(errors, of));
}

ErrorRow rowOf(const ErrorBench& bench, const PathSeries& series, std::uint32_t samples, const Observation& o) {
  const JudgedPicture& first = o.errors.front();
  ErrorRow row;
  row["technique"] = "path";
  row["fidelity"] = series.fidelity;
  row["settings"] = {fmt::format("spp={}", samples)};
  if (series.denoised) {
    row["settings"].push_back("path.denoise=on");
    row["denoised"] = {{"known", o.denoised.known}};
    if (o.denoised.known)
      row["denoised"].update({{"nrmse", o.denoised.value}, {"low", o.denoised.low}, {"high", o.denoised.high}});
  }
  row["deviations"] = series.deviations;
  row["series"] = series.name;
  row["label"] = fmt::format("{} spp={}", series.label(), samples);
  row["spp"] = samples;
  row["ms"] = median(o.ms);
  row["wall_ms"] = median(o.ms);
  row["cpu_ms"] = median(o.cpuMs);  // of all cores: on software renderers what else the machine does is not in it
  row["wall_ms_spread"] = {percentile(o.ms, 0.0), percentile(o.ms, 1.0)};
  row["frames"] = o.ms.size();
  row["setup_ms"] = o.setupMs;
  row["gpu_bytes"] = o.gpuBytes;
  // Medians over all seeds, but biases of one seed with its own standard error: a median of biases has no equally
  // simple one.
  row.update(errorsJson(first));
  row["l2"] = medianOf(o.errors, [](const JudgedPicture& e) { return e.scattered.l2; });
  row["nrmse"] = medianOf(o.errors, [](const JudgedPicture& e) { return e.pixels.nrmse; });
  row["rmse"] = medianOf(o.errors, [](const JudgedPicture& e) { return e.pixels.rmse; });
  row["relmse"] = medianOf(o.errors, [](const JudgedPicture& e) { return e.pixels.relmse; });
  row["blocks"]["l2"] = medianOf(o.errors, [](const JudgedPicture& e) { return e.blocks.l2; });
  row["blocks"]["nrmse"] =
      medianOf(o.errors, [](const JudgedPicture& e) { return e.blocks.rmse / e.pixels.measured.referenceMean; });
  row["wall_ms_samples"] = o.ms;
  nlohmann::ordered_json& seeds = row["seeds"];
  for (std::size_t i = 0; i < o.errors.size(); ++i) seeds["seed"].push_back(seedOf(static_cast<int>(i)));
  seeds["ms"] = o.ms;
  seeds["cpu_ms"] = o.cpuMs;
  seeds["l2"] = ofSeeds(o.errors, [](const JudgedPicture& e) { return e.scattered.l2; });
  seeds["nrmse"] = ofSeeds(o.errors, [](const JudgedPicture& e) { return e.pixels.nrmse; });
  seeds["relmse"] = ofSeeds(o.errors, [](const JudgedPicture& e) { return e.pixels.relmse; });
  seeds["relative_bias"] = ofSeeds(o.errors, [](const JudgedPicture& e) { return e.pixels.measured.relativeBias; });
  measure::Flip flip{NAN, {}};
  if (first.pixels.measured.notFinite == 0) flip = measure::flipHdr(o.picture, bench.references.path().mean);
  row["flip"] = flip.mean;
  row["picture"] =
      writePictures(bench, fmt::format("{} spp={}", series.label(), samples), o.picture, bench.references.path(),
                    flip.map, o.standardError.pixels.empty() ? nullptr : &o.standardError);
  addProvenance(bench, row);
  return row;
}

/// Standard deviation of a value between seeds, relative to its mean: pooled over points, as three seeds alone are a
/// poor estimate. NaN if no point has two seeds.
double relativeDeviation(const std::vector<ErrorRow>& rows, const char* measure, double& freedom) {
  double squares = 0.0;
  freedom = 0.0;
  for (const ErrorRow& row : rows) {
    if (!row.contains("seeds") || !row.at("seeds").at(measure).is_array()) continue;
    std::vector<double> values;
    for (const auto& v : row.at("seeds").at(measure))
      if (v.is_number()) values.push_back(v.get<double>());
    const double n = static_cast<double>(values.size());
    double mean = 0.0;
    for (const double v : values) mean += v / n;
    if (values.size() < 2 || !(mean > 0.0)) continue;
    for (const double v : values) squares += (v / mean - 1.0) * (v / mean - 1.0);
    freedom += n - 1.0;
  }
  return freedom > 0.0 ? std::sqrt(squares / freedom) : NAN;
}

/// A sampled picture's errors differ from seed to seed: add that to their standard errors.
void addSeedDeviation(std::vector<ErrorRow>& rows) {
  for (const char* measure : {"l2", "nrmse", "relmse"}) {
    double freedom = 0.0;
    const double deviation = relativeDeviation(rows, measure, freedom);
    if (!std::isfinite(deviation)) continue;
    for (ErrorRow& row : rows) {
      const std::size_t n = row.contains("seeds") ? row.at("seeds").at("seed").size() : 1;
      const double ofMedian = n == 3 ? 0.67 : n > 1 ? std::sqrt(1.5708 / static_cast<double>(n)) : 1.0;
      const std::string key = std::string(measure) + "_error";
      const double own = deviation * ofMedian * number(row, measure), reference = number(row, key.c_str());
      row[key] = std::isfinite(reference) ? std::hypot(reference, own) : own;
      row["error_freedom"] =
          std::max(1.0, 0.5 * freedom);  // a point includes the samples of those below it: half as many are independent
    }
  }
}

}  // namespace

std::vector<ErrorRow> measurePath(const ErrorBench& bench, bool deviations) {
  std::vector<ErrorRow> rows;
  for (PathSeries series : seriesOf(bench, deviations)) {
    // Deviations are compared at the number of samples that the corrected tracer had time for.
    if (deviations && !rows.empty()) series.samples = rows.front().at("spp").get<std::uint32_t>();
    // So are denoised pictures, and at each number below it.
    if (series.denoised && !rows.empty()) series.samples = rows.back().at("spp").get<std::uint32_t>();
    const std::filesystem::path file = rowFile(bench.folder, series.name);
    if (std::filesystem::exists(file)) {
      const ErrorRow known = ErrorRow::parse(readFileText(file), nullptr, false);
      if (known.is_array()) {
        rows.insert(rows.end(), known.begin(), known.end());
        continue;
      }
    }
    std::vector<std::pair<std::uint32_t, Observation>> sweep;
    for (int seed = 0; seed < series.seeds && !interrupted(); ++seed) observe(bench, series, seed, sweep);
    if (interrupted()) return {};
    std::vector<ErrorRow> own;
    for (const auto& [samples, observation] : sweep)
      if (!series.lastPoint || samples == sweep.back().first) own.push_back(rowOf(bench, series, samples, observation));
    writeFileAtomically(file, nlohmann::ordered_json(own).dump(1) + "\n");
    rows.insert(rows.end(), own.begin(), own.end());
  }
  addSeedDeviation(rows);
  return rows;
}

}  // namespace lucerna::demo::bench
