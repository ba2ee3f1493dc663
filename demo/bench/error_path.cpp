// The path tracer's ladder: pictures that go on being sampled, observed at 1, 2, 4, ... samples a pixel.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/statistics.hpp"
#include "bench/error_rows.hpp"
#include "measure/flip.hpp"
#include "pathtracer/path_tracer.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cmath>

namespace lucerna::demo::bench {

namespace {

using Clock = std::chrono::steady_clock;
constexpr int kSeeds = 3;

struct Observation {
  std::vector<double> ms;
  std::vector<measure::JudgedErrors> errors;
  std::size_t gpuBytes = 0;
  double setupMs = 0.0;
  Image picture;  // of the first seed
};

PathTracer::Settings settingsOf(const ErrorBench& bench, int seed) {
  PathTracer::Settings settings;
  settings.size = bench.size;
  settings.diffuseOnly = true;   // as the reference
  settings.pixelCentres = true;
  settings.seed = 0x51ed270bu + static_cast<std::uint32_t>(seed) * 7919u;
  return settings;
}

void observe(const ErrorBench& bench, int seed, std::vector<std::pair<std::uint32_t, Observation>>& ladder) {
  const auto made = Clock::now();
  PathTracer tracer(bench.context, bench.programs, bench.scene, settingsOf(bench, seed));
  tracer.setCamera(bench.camera);
  tracer.record(1);  // warm-up: the driver finishes the program on first use
  tracer.setCamera(bench.camera);
  glFinish();
  const double setup = std::chrono::duration<double, std::milli>(Clock::now() - made).count();
  double spent = 0.0;
  std::size_t step = 0;
  for (std::uint32_t samples = 1; !interrupted(); samples *= 2, ++step) {
    // The first seed decides how far the ladder goes; the others climb the same rungs.
    if (seed == 0 && samples > 4 && 2.0 * spent > 1e3 * bench.pathSeconds / kSeeds) break;
    if (seed > 0 && step >= ladder.size()) break;
    const auto start = Clock::now();
    tracer.record(samples);
    glFinish();
    spent += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (seed == 0) ladder.emplace_back(samples, Observation{});
    Observation& o = ladder[step].second;
    o.ms.push_back(spent);
    const Image picture = tracer.mean();
    const measure::Reference& truth = bench.references.all();
    const glm::dvec3 own = tracer.statistics().meanError;
    // Channels share their paths: their errors add up as if wholly dependent.
    const double ownError = samples > 1 ? (own.x + own.y + own.z) / 3.0 : INFINITY;
    o.errors.push_back(measure::lessNoise(measure::errorsOf(picture, truth.mean), bench.references.noise(truth), ownError));
    if (seed == 0) {
      o.picture = picture;
      o.setupMs = setup;
      o.gpuBytes = tracer.gpuBytes();
    }
  }
}

double medianOf(const std::vector<measure::JudgedErrors>& errors, double (*of)(const measure::JudgedErrors&)) {
  std::vector<double> values;
  for (const measure::JudgedErrors& e : errors) values.push_back(of(e));
  return median(values);
}

ErrorRow rowOf(const ErrorBench& bench, std::uint32_t samples, const Observation& o) {
  using measure::JudgedErrors;
  const JudgedErrors& first = o.errors.front();
  ErrorRow row;
  row["technique"] = "path";
  row["fidelity"] = "corrected";
  row["settings"] = {fmt::format("spp={}", samples)};
  row["deviations"] = nlohmann::ordered_json::array();
  row["series"] = "path";
  row["label"] = fmt::format("path spp={}", samples);
  row["spp"] = samples;
  row["ms"] = median(o.ms);
  row["wall_ms"] = median(o.ms);
  row["wall_ms_spread"] = {percentile(o.ms, 0.0), percentile(o.ms, 1.0)};
  row["frames"] = o.ms.size();
  row["setup_ms"] = o.setupMs;
  row["gpu_bytes"] = o.gpuBytes;
  row["nrmse"] = medianOf(o.errors, [](const JudgedErrors& e) { return e.nrmse; });
  row["rmse"] = medianOf(o.errors, [](const JudgedErrors& e) { return e.rmse; });
  row["relmse"] = medianOf(o.errors, [](const JudgedErrors& e) { return e.relmse; });
  // Of one seed, with its own standard error; a median of biases has none that is so simple.
  row["bias"] = first.measured.bias;
  row["bias_error"] = first.biasError;
  row["relative_bias"] = first.measured.relativeBias;
  row["p99"] = first.measured.p99;
  row["max"] = first.measured.max;
  row["at_noise"] = first.atNoise;
  row["bias_at_noise"] = first.biasAtNoise;
  row["noise_nrmse"] = first.noiseNrmse;
  row["measured_nrmse"] = first.measured.nrmse;
  row["not_finite"] = first.measured.notFinite;
  row["flip"] = first.measured.notFinite > 0 ? NAN : measure::flipHdr(o.picture, bench.references.all().mean).mean;
  row["picture"] = writePictures(bench, fmt::format("path spp={}", samples), o.picture);
  return row;
}

}  // namespace

std::vector<ErrorRow> measurePath(const ErrorBench& bench) {
  const std::filesystem::path file = bench.folder / "rows" / "path.json";
  if (std::filesystem::exists(file)) {
    const ErrorRow known = ErrorRow::parse(readFileText(file), nullptr, false);
    if (known.is_array()) return known.get<std::vector<ErrorRow>>();
  }
  std::vector<std::pair<std::uint32_t, Observation>> ladder;
  for (int seed = 0; seed < kSeeds && !interrupted(); ++seed) observe(bench, seed, ladder);
  std::vector<ErrorRow> rows;
  if (interrupted()) return rows;
  for (const auto& [samples, observation] : ladder) rows.push_back(rowOf(bench, samples, observation));
  writeFileAtomically(file, nlohmann::ordered_json(rows).dump(1) + "\n");
  return rows;
}

}  // namespace lucerna::demo::bench
