// The published times of the VPT original [VPT2024, 5.7], measured again on scenes of ours.
//
// With --scale below 1 the pictures are smaller and have fewer samples; what was measured is then multiplied up to the published number of pixels times
// samples, as a path tracer's work is proportional to both. A picture that would take too long ends early and is multiplied up likewise.
#include "bench/vpt_series.hpp"

#include "measure/image_errors.hpp"
#include "render/deviations.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo::bench {

namespace {

/// Seconds a picture below full scale may take.
constexpr double kMostSeconds = 15.0;

/// Of the picture that stands for the estimator: espresso, as much absorbed as scattered behind a boundary that refracts.
constexpr std::size_t kEstimatorPicture = 14;

/// The published estimator, and each of its deviations alone, against the corrected one: time, and how far the picture is off.
void measureEstimators(const VptTablesInput& input, glm::ivec2 size, double mostSeconds, Tables& tables) {
  const VptPicture& picture = vptPictures()[kEstimatorPicture];
  const Scene scene = loadVptScene(picture);
  const std::uint32_t samples = vptSamples(picture, input.scale);
  struct Estimator {
    std::string name;
    RenderSettings settings;
  };
  std::vector<Estimator> estimators{{"corrected", {}}, {"original", {}}};
  applyFidelity(estimators[1].settings, Fidelity::original);
  for (const Deviation& deviation : allDeviations()) {
    if (!std::string_view(deviation.name).starts_with("path.")) continue;
    Estimator& alone = estimators.emplace_back(Estimator{deviation.name, {}});
    deviation.turn(alone.settings, true);
  }
  tables.json["estimators"] = nlohmann::ordered_json::array();
  if (interrupted()) return;
  const VptResult reference = renderVpt(input.context, input.programs, picture, scene, size, 4 * samples, 4.0 * mostSeconds, {}, 1);
  const auto channelMean = [](const glm::dvec3& v) { return (v.x + v.y + v.z) / 3.0; };
  const double right = channelMean(reference.statistics.mean);
  tables.summary += fmt::format("\nThe estimator on {} ({}), beside the corrected one with other random numbers and {:.4g} samples a pixel. Bias: of the picture's mean.\n{:<34}{:>12}{:>14}{:>22}{:>12}\n", picture.label,
                                picture.figure, reference.statistics.samples, "", "ms a sample", "NRMSE", "bias", "time");
  double correctedMs = 0.0;
  for (const Estimator& estimator : estimators) {
    if (interrupted()) return;
    const VptResult result = renderVpt(input.context, input.programs, picture, scene, size, samples, mostSeconds, estimator.settings.path);
    const double ms = result.ms / result.statistics.samples;
    if (correctedMs == 0.0) correctedMs = ms;
    const double bias = channelMean(result.statistics.mean) / right - 1.0;
    const double error = std::hypot(channelMean(result.statistics.meanError), channelMean(reference.statistics.meanError)) / right;
    const double nrmse = measure::errorsOf(result.image, reference.image).nrmse;
    tables.summary += fmt::format("{:<34}{:>12.4g}{:>14.4g}{:>22}{:>11.3g}x\n", estimator.name, ms, nrmse, fmt::format("{:+.4f} +- {:.4f}", bias, error), ms / correctedMs);
    tables.json["estimators"].push_back({{"estimator", estimator.name}, {"figure", picture.figure}, {"ms_a_sample", ms}, {"spp", result.statistics.samples}, {"nrmse", nrmse}, {"bias", bias},
                                         {"bias_error", error}, {"time_ratio", ms / correctedMs}});
  }
}

}  // namespace

Tables measureVptTables(const VptTablesInput& input) {
  const glm::ivec2 size = vptSize(input.scale);
  const double mostSeconds = input.scale < 1.0 ? kMostSeconds : 0.0;
  Tables tables;
  tables.notes.push_back(fmt::format("Scenes of our own after the published pictures (assets/media), lit by area lights; the estimator is the corrected one. Lowered ior: {}.", kVptLoweredIor));
  if (input.scale < 1.0)
    tables.notes.push_back(fmt::format("Scaled by {}: {}x{} pixels instead of {}x{}, samples times {}, at most {:.0f} s a picture; times are multiplied up to the published pixels and samples.",
                                       input.scale, size.x, size.y, kVptSize.x, kVptSize.y, input.scale, mostSeconds));
  tables.json["size"] = {size.x, size.y};
  tables.json["pictures"] = nlohmann::ordered_json::array();
  const auto& pictures = vptPictures();
  Progress progress("bench tables", static_cast<int>(pictures.size()), input.quiet);
  double measured = 0.0, published = 0.0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const VptPicture& picture = pictures[i];
    Row row;
    row.table = picture.table;
    row.setting = fmt::format("{}: {}", picture.figure, picture.label);
    row.stage = "the picture";
    row.published = {{kVptGpu, picture.publishedMs}};
    if (!interrupted()) {
      const Scene scene = loadVptScene(picture);
      const VptResult result = renderVpt(input.context, input.programs, picture, scene, size, vptSamples(picture, input.scale), mostSeconds);
      const double done = result.statistics.samples * size.x * size.y;
      const double wanted = static_cast<double>(picture.samples) * kVptSize.x * kVptSize.y;
      row.samples = {result.ms * wanted / done};
      measured += row.samples[0];
      published += picture.publishedMs;
      tables.json["pictures"].push_back({{"figure", picture.figure},
                                         {"scene", picture.scene},
                                         {"ms", result.ms},
                                         {"spp", result.statistics.samples},
                                         {"million_paths_per_s", done / (1000.0 * result.ms)},
                                         {"published_million_paths_per_s", wanted / (1000.0 * picture.publishedMs)},
                                         {"mean", {result.statistics.mean.x, result.statistics.mean.y, result.statistics.mean.z}},
                                         {"relative_error", result.statistics.relativeError}});
    }
    tables.rows.push_back(std::move(row));
    progress.update(static_cast<int>(i) + 1);
  }
  tables.summary = fmt::format("All pictures together: {:.4g} s here, {:.4g} s published ({:.4g} times).\n", measured / 1000.0, published / 1000.0, measured / published);
  measureEstimators(input, size, 0.5 * mostSeconds, tables);
  return tables;
}

}  // namespace lucerna::demo::bench
