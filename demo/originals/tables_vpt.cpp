// The published times of the VPT original [VPT2024, 5.7], measured again with our scenes.
//
// With --scale below 1 the pictures are smaller and have fewer samples. The measured time is then scaled to the
// published number of pixels times samples, as a path tracer's work is proportional to both. A picture that would take
// too long ends early and is scaled likewise.
#include "base/provenance.hpp"
#include "originals/vpt_estimators.hpp"
#include "originals/vpt_series.hpp"

#include "measure/image_errors.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>

namespace lucerna::demo::bench {

namespace {

/// Maximum seconds for a picture below full scale.
constexpr double kMostSecondsATable = 15.0;

/// The picture used to compare estimators: espresso, with equal absorption and scattering behind a refracting boundary.
constexpr std::size_t kEstimatorPicture = 14;

/// Compares the estimators with the first one, corrected or published: time, and error of the picture. Fills "summary"
/// and "estimators"; incomplete if interrupted.
PartFolder::Json measureEstimators(const VptTablesInput& input, glm::ivec2 size, double mostSeconds) {
  const VptPicture& picture = vptPictures()[kEstimatorPicture];
  const Scene scene = loadVptScene(picture, input.fidelity);
  const std::uint32_t samples = vptSamples(picture, input.scale);
  const std::vector<VptEstimator> estimators = vptEstimators(input.fidelity);
  PartFolder::Json made{{"summary", ""}, {"estimators", PartFolder::Json::array()}};
  std::string summary;
  if (interrupted()) return made;
  // With the published random numbers all pixels and seeds share one sequence: the reference uses others.
  PathDeviations independent = estimators[0].deviations;
  independent.linearSeeds = false;
  const VptResult reference =
      renderVpt(input.context, input.programs, picture, scene, size, 4 * samples, 4.0 * mostSeconds, independent, 1);
  const auto channelMean = [](const glm::dvec3& v) { return (v.x + v.y + v.z) / 3.0; };
  const double right = channelMean(reference.statistics.mean);
  summary += fmt::format(
      "\nThe estimator on {} ({}), beside the {} one with other random numbers and {:.4g} samples a pixel. Bias: of "
      "the picture's mean.\n{:<38}{:>12}{:>14}{:>22}{:>12}{:>14}\n",
      picture.label, picture.figure, estimators[0].name, reference.statistics.samples, "", "ms a sample", "NRMSE",
      "bias", "time", "iterations");
  double firstMs = 0.0, firstIterations = 0.0;
  for (const VptEstimator& estimator : estimators) {
    if (interrupted()) break;
    const VptResult result =
        renderVpt(input.context, input.programs, picture, scene, size, samples, mostSeconds, estimator.deviations);
    const double ms = result.ms / result.statistics.samples,
                 iterations = result.statistics.iterations / result.statistics.samples;
    if (firstMs == 0.0) firstMs = ms, firstIterations = iterations;
    const double bias = channelMean(result.statistics.mean) / right - 1.0;
    const double error =
        std::hypot(channelMean(result.statistics.meanError), channelMean(reference.statistics.meanError)) / right;
    const double nrmse = measure::errorsOf(result.image, reference.image).nrmse;
    summary += fmt::format("{:<38}{:>12.4g}{:>14.4g}{:>22}{:>11.3g}x{:>13.3g}x\n", estimator.name, ms, nrmse,
                           fmt::format("{:+.4f} +- {:.4f}", bias, error), ms / firstMs, iterations / firstIterations);
    made["estimators"].push_back({{"estimator", estimator.name},
                                  {"figure", picture.figure},
                                  {"ms_a_sample", ms},
                                  {"spp", result.statistics.samples},
                                  {"nrmse", nrmse},
                                  {"bias", bias},
                                  {"bias_error", error},
                                  {"time_ratio", ms / firstMs},
                                  {"iterations_ratio", iterations / firstIterations}});
  }
  made["summary"] = summary;
  return made;
}

/// Growth along each series: time and loop iterations, per sample and relative to the series' first picture.
std::string growthOf(const std::vector<VptPicture>& pictures, const std::vector<VptResult>& results, glm::ivec2 size) {
  std::string text = fmt::format("\n{:<44}{:>12}{:>12}{:>12}{:>16}\n", "Growth a sample over a series", "published",
                                 "time here", "iterations", "collisions a path");
  const double pixels = static_cast<double>(size.x) * size.y;
  for (std::size_t i = 0, first = 0; i < results.size(); ++i) {
    if (std::string_view(pictures[i].table) != pictures[first].table) first = i;
    const auto over = [&](auto figure) { return figure(i) / figure(first); };
    const double published = over([&](std::size_t k) { return pictures[k].publishedMs / pictures[k].samples; });
    const double time = over([&](std::size_t k) { return results[k].ms / results[k].statistics.samples; });
    const double iterations =
        over([&](std::size_t k) { return results[k].statistics.iterations / results[k].statistics.samples; });
    text += fmt::format("{:<44}{:>12.3g}{:>12.3g}{:>12.3g}{:>16.4g}\n",
                        fmt::format("{} {}", pictures[i].figure, pictures[i].label), published, time, iterations,
                        results[i].statistics.collisions / (results[i].statistics.samples * pixels));
  }
  return text;
}

/// A picture's measurement as stored: everything but its pixels, with the time of preparation.
PartFolder::Json keptOf(const VptResult& result, double preparationMs) {
  const PathTracer::Statistics& s = result.statistics;
  return {{"ms", result.ms},
          {"preparation_ms", preparationMs},
          {"samples", s.samples},
          {"iterations", s.iterations},
          {"collisions", s.collisions},
          {"mean", {s.mean.x, s.mean.y, s.mean.z}},
          {"relative_error", s.relativeError}};
}
VptResult resultOf(const PartFolder::Json& kept) {
  const auto number = [](const PartFolder::Json& value) { return value.is_number() ? value.get<double>() : NAN; };
  VptResult result;
  result.ms = number(kept.at("ms"));
  result.preparationMs = number(kept.at("preparation_ms"));  // loading is in it
  result.statistics.samples = number(kept.at("samples"));
  result.statistics.iterations = number(kept.at("iterations"));
  result.statistics.collisions = number(kept.at("collisions"));
  for (int c = 0; c < 3; ++c) result.statistics.mean[c] = number(kept.at("mean").at(static_cast<std::size_t>(c)));
  result.statistics.relativeError = number(kept.at("relative_error"));
  return result;
}

}  // namespace

Tables measureVptTables(const VptTablesInput& input) {
  // What is measured, at this scale.
  const glm::ivec2 size = vptSize(input.scale);
  const double mostSeconds = input.scale < 1.0 ? kMostSecondsATable : 0.0;
  Tables tables;
  const bool published = input.fidelity != Fidelity::corrected;
  tables.notes.push_back(published ? fmt::format("Scenes of our own after the published pictures (assets/media) in the "
                                                 "original's format, lit by points, by the published estimator; rows "
                                                 "named corrected: the corrected one, lit by an area. Lowered ior: {}.",
                                                 kVptLoweredIor)
                                   : fmt::format("Scenes of our own after the published pictures (assets/media), lit "
                                                 "by area lights; the estimator is the corrected one. Lowered ior: {}.",
                                                 kVptLoweredIor));
  if (input.scale < 1.0)
    tables.notes.push_back(fmt::format(
        "Scaled by {}: {}x{} pixels instead of {}x{}, samples times {} (a series on samples keeps different ones), at "
        "most {:.0f} s a picture; times are multiplied up to the published pixels and samples.",
        input.scale, size.x, size.y, kVptSize.x, kVptSize.y, input.scale, mostSeconds));
  tables.json["size"] = {size.x, size.y};
  tables.json["fidelity"] = published ? "original" : "corrected";
  tables.json["pictures"] = nlohmann::ordered_json::array();
  const auto& pictures = vptPictures();
  std::vector<Fidelity> fidelities{input.fidelity};
  if (published) fidelities.push_back(Fidelity::corrected);
  // One unit per picture; the estimators are the last.
  const std::size_t units = pictures.size() * fidelities.size() + 1;
  const PartFolder part(input.part, "bench tables",
                        fmt::format("vpt, scale {}, {}, {} on {}", input.scale, published ? "original" : "corrected",
                                    input.context.capabilities().renderer, cpuName()),
                        units);
  // One picture per unit: drawn, or read from the part's folder; its row, and one for its scene's preparation.
  Progress progress("bench tables", static_cast<int>(part.last() - part.first()), input.quiet);
  std::size_t unit = 0;
  for (const Fidelity fidelity : fidelities) {
    const char* name = published && fidelity == Fidelity::corrected ? " (corrected)" : "";
    std::vector<VptResult> results;
    std::vector<Row> preparations;
    double measured = 0.0, publishedMs = 0.0;
    for (const VptPicture& picture : pictures) {
      Row row;
      row.table = picture.table;
      row.setting = fmt::format("{}: {}{}", picture.figure, picture.label, name);
      row.stage = "the picture";
      row.published = {{kVptGpu, picture.publishedMs}};
      const std::size_t own = unit++;
      if (!interrupted() && own >= part.first() && own < part.last()) {
        if (const auto kept = part.load(own)) {
          results.push_back(resultOf(*kept));
        } else {
          const auto start = std::chrono::steady_clock::now();
          const Scene scene = loadVptScene(picture, fidelity);
          const double loadMs =
              std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
          const PathDeviations deviations = vptDeviations(picture, fidelity);
          const VptResult drawn = renderVpt(input.context, input.programs, picture, scene, size,
                                            vptSamples(picture, input.scale), mostSeconds, deviations);
          const PartFolder::Json made =
              keptOf(drawn, loadMs + vptPreparationMs(input.context, input.programs, scene, size, deviations));
          if (!interrupted()) part.store(own, made);  // otherwise it ended early
          results.push_back(resultOf(made));
        }
        // Extrapolated to the published pixels and samples.
        const VptResult& result = results.back();
        const double done = result.statistics.samples * size.x * size.y;
        const double wanted = static_cast<double>(picture.samples) * kVptSize.x * kVptSize.y;
        row.samples = {result.ms * wanted / done};
        measured += row.samples[0];
        publishedMs += picture.publishedMs;
        const std::string file = std::string(fidelity == Fidelity::corrected ? picture.scene : picture.original) + name;
        const bool known =
            std::any_of(preparations.begin(), preparations.end(), [&](const Row& r) { return r.setting == file; });
        if (!known) {
          Row& preparation = preparations.emplace_back();
          preparation.table = "preparation of a scene, 5.7";
          preparation.setting = file;
          preparation.stage = "reading, hierarchy, upload";
          preparation.published = {{"its CPU, about", 500.0}};
          preparation.samples = {result.preparationMs};
        }
        tables.json["pictures"].push_back(
            {{"figure", picture.figure},
             {"scene", fidelity == Fidelity::corrected ? picture.scene : picture.original},
             {"fidelity", fidelity == Fidelity::corrected ? "corrected" : "original"},
             {"ms", result.ms},
             {"preparation_ms", result.preparationMs},
             {"spp", result.statistics.samples},
             {"iterations", result.statistics.iterations},
             {"collisions", result.statistics.collisions},
             {"million_paths_per_s", done / (1000.0 * result.ms)},
             {"published_million_paths_per_s", wanted / (1000.0 * picture.publishedMs)},
             {"mean", {result.statistics.mean.x, result.statistics.mean.y, result.statistics.mean.z}},
             {"relative_error", result.statistics.relativeError}});
      }
      tables.rows.push_back(std::move(row));
      if (own >= part.first() && own < part.last()) progress.update(static_cast<int>(own + 1 - part.first()));
    }
    if (part.isPart()) continue;  // sums and growth need all pictures
    tables.rows.insert(tables.rows.end(), preparations.begin(), preparations.end());
    tables.summary += fmt::format("All pictures together{}: {:.4g} s here, {:.4g} s published ({:.4g} times).\n", name,
                                  measured / 1000.0, publishedMs / 1000.0, measured / publishedMs);
    tables.summary += growthOf(pictures, results, size);
  }
  // The estimators, the last unit.
  if (!interrupted() && part.last() == units) {
    auto estimators = part.load(units - 1);
    if (!estimators) {
      estimators = measureEstimators(input, size, 0.5 * mostSeconds);
      if (!interrupted()) part.store(units - 1, *estimators);
    }
    tables.summary += estimators->at("summary").get<std::string>();
    tables.json["estimators"] = estimators->at("estimators");
  }
  if (!interrupted()) part.finish();
  if (part.isPart()) tables.json["rows_here"] = part.last() - part.first();
  return tables;
}

}  // namespace lucerna::demo::bench
