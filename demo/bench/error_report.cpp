#include "bench/error_report.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "bench/plot.hpp"
#include "measure/front.hpp"
#include "measure/heat_map.hpp"
#include "measure/tone_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <thread>

namespace lucerna::demo::bench {

namespace fs = std::filesystem;

namespace {

std::string text(const ErrorRow& row, const char* key) {
  const auto found = row.find(key);
  return found == row.end() || !found->is_string() ? "" : found->get<std::string>();
}
bool flag(const ErrorRow& row, const char* key) {
  const auto found = row.find(key);
  return found != row.end() && found->is_boolean() && found->get<bool>();
}
double spread(const ErrorRow& row, std::size_t i) {
  const auto found = row.find("wall_ms_spread");
  return found == row.end() || !found->is_array() || !(*found)[i].is_number() ? NAN : (*found)[i].get<double>();
}

/// 12.3 %, or "< 0.4 % (noise)" where the reference cannot tell.
std::string errorText(const ErrorRow& row) {
  if (number(row, "not_finite") > 0) return "not finite";
  if (flag(row, "at_noise")) return fmt::format("< {:.3g} % (noise)", 300.0 * number(row, "noise_nrmse"));
  return fmt::format("{:.3g} %", 100.0 * number(row, "nrmse"));
}
std::string biasText(const ErrorRow& row) {
  const double mean = number(row, "bias") / number(row, "relative_bias"), error = 100.0 * number(row, "bias_error") / std::abs(mean);
  if (!std::isfinite(error)) return fmt::format("{:+.3g} % +- ?", 100.0 * number(row, "relative_bias"));  // one sample has no spread
  return fmt::format("{:+.3g} % +- {:.2g}{}", 100.0 * number(row, "relative_bias"), error, flag(row, "bias_at_noise") ? " (0)" : "");
}
std::string insideText(const ErrorRow& row) {
  const auto found = row.find("inside_model");
  return found == row.end() ? "" : errorText(*found);
}
std::string bytesText(double bytes) { return fmt::format("{:.2f} MiB", bytes / 1048576.0); }

struct Column {
  const char* title;
  std::string (*of)(const ErrorRow&);
};
const Column kColumns[] = {
    {"technique and settings", [](const ErrorRow& r) { return text(r, "label"); }},
    {"front", [](const ErrorRow& r) { return flag(r, "pareto") ? fmt::format("{:g}", number(r, "front")) : ""; }},
    {"ms", [](const ErrorRow& r) { return fmt::format("{:.2f}", number(r, "ms")); }},
    {"5..95 %", [](const ErrorRow& r) { return fmt::format("{:.2f}..{:.2f}", spread(r, 0), spread(r, 1)); }},
    {"query ms", [](const ErrorRow& r) { return std::isnan(number(r, "query_ms")) ? "" : fmt::format("{:.2f}", number(r, "query_ms")); }},
    {"set-up ms", [](const ErrorRow& r) { return fmt::format("{:.0f}", number(r, "setup_ms")); }},
    {"NRMSE", errorText},
    {"inside model", insideText},
    {"bias", biasText},
    {"rel. MSE", [](const ErrorRow& r) { return fmt::format("{:.3g}", number(r, "relmse")); }},
    {"99 %", [](const ErrorRow& r) { return fmt::format("{:.3g}", number(r, "p99")); }},
    {"FLIP", [](const ErrorRow& r) { return fmt::format("{:.3f}", number(r, "flip")); }},
    {"GPU memory", [](const ErrorRow& r) { return bytesText(number(r, "gpu_bytes")); }},
};

std::string notes(const ErrorReport& report) {
  std::string line = fmt::format("Renderer {}\nHost     {}, {}\nBench    {}\n", report.renderer, report.host, report.cpu, report.title);
  for (const std::string& left : report.leftOut) line += left + "\n";
  for (const auto& [transport, r] : report.references->of) {
    const measure::ReferenceNoise noise = report.references->noise(r);
    const glm::dvec3 mean = meanOf(r.mean);
    const double m = (mean.x + mean.y + mean.z) / 3.0;
    line += fmt::format("Reference {:<20} {} samples a pixel, {:.1f} s; mean {:.6g} +- {:.2g}; noise of a pixel {:.3g} % of the mean\n", measure::nameOf(transport), r.samples,
                        r.seconds, m, r.meanError, 100.0 * std::sqrt(noise.variance) / m);
  }
  return line;
}

std::string modelText(const ModelError& m) {
  const std::string error = m.errors.atNoise ? fmt::format("< {:.3g} % (noise)", 300.0 * m.errors.noiseNrmse) : fmt::format("{:.3g} %", 100.0 * m.errors.nrmse);
  return fmt::format("{:<44}NRMSE {}, bias {:+.3g} % +- {:.2g} of indirect light", m.name, error, 100.0 * m.errors.measured.relativeBias,
                     100.0 * m.errors.biasError / m.errors.measured.referenceMean);
}

/// How the path tracer's error falls by samples, and from the eighth on by wall clock and processor time: a pass doubles what there is, and in the first ones lanes wait for
/// the longest path of so few, so that a sample alone costs more than one of many.
struct PathSlope {
  measure::Slope samples, time, processor;
  double first = 0.0, last = 0.0;  ///< samples
};

/// Those over time count from 32 samples on: in the first passes lanes wait for the longest path of so few. None with fewer than three such rows above the reference's noise.
std::optional<PathSlope> pathSlope(const std::vector<ErrorRow>& rows) {
  std::vector<double> ms, cpuMs, samples, errors, errorsOverTime;
  for (const ErrorRow& row : rows) {
    if (text(row, "series") != "path" || flag(row, "at_noise") || !(number(row, "nrmse") > 0.0)) continue;
    if (number(row, "spp") >= 32.0) {
      ms.push_back(number(row, "ms"));
      cpuMs.push_back(number(row, "cpu_ms"));
      errorsOverTime.push_back(number(row, "nrmse"));
    }
    samples.push_back(number(row, "spp"));
    errors.push_back(number(row, "nrmse"));
  }
  if (errorsOverTime.size() < 3) return std::nullopt;
  return PathSlope{measure::logLogSlope(samples, errors), measure::logLogSlope(ms, errorsOverTime), measure::logLogSlope(cpuMs, errorsOverTime), samples.front(), samples.back()};
}

std::string slopeText(const std::vector<ErrorRow>& rows) {
  const std::optional<PathSlope> s = pathSlope(rows);
  if (!s) return "";
  return fmt::format("Path tracing: error ~ samples^({:.3f} +- {:.3f}), time^({:.3f} +- {:.3f}), processor time^({:.3f} +- {:.3f}) from {:g} to {:g} samples, by time from 32 on; -1/2 is what independent samples give.",
                     s->samples.slope, s->samples.error, s->time.slope, s->time.error, s->processor.slope, s->processor.error, s->first, s->last);
}

}  // namespace

std::string cpuName() {
  std::ifstream stream("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(stream, line))
    if (line.starts_with("model name")) {
      name = line.substr(line.find(':') + 2);
      break;
    }
  return fmt::format("{}, {} threads", name, std::thread::hardware_concurrency());
}

std::string terminalTable(const ErrorReport& report) {
  std::vector<std::vector<std::string>> cells;
  std::vector<std::size_t> widths;
  for (const Column& column : kColumns) widths.push_back(std::string_view(column.title).size());
  for (const ErrorRow& row : report.rows) {
    cells.emplace_back();
    for (const Column& column : kColumns) cells.back().push_back(column.of(row));
    for (std::size_t c = 0; c < widths.size(); ++c) widths[c] = std::max(widths[c], cells.back()[c].size());
  }
  std::string result = notes(report) + "\n  ";
  for (std::size_t c = 0; c < widths.size(); ++c) result += c == 0 ? fmt::format("{:<{}}", kColumns[c].title, widths[c]) : fmt::format("  {:>{}}", kColumns[c].title, widths[c]);
  result += "\n";
  for (std::size_t r = 0; r < cells.size(); ++r) {
    result += flag(report.rows[r], "pareto") ? "* " : "  ";
    for (std::size_t c = 0; c < widths.size(); ++c) result += c == 0 ? fmt::format("{:<{}}", cells[r][c], widths[c]) : fmt::format("  {:>{}}", cells[r][c], widths[c]);
    result += "\n";
  }
  result += "* nothing measured here is better in both time and error (Pareto front)\n";
  if (const std::string slope = slopeText(report.rows); !slope.empty()) result += slope + "\n";
  if (!report.model.empty()) result += "\nWhat the models leave out, whatever the settings:\n";
  for (const ModelError& m : report.model) result += "  " + modelText(m) + "\n";
  return result;
}

std::string csvOf(const std::vector<ErrorRow>& rows) {
  const char* kKeys[] = {"ms",   "wall_ms", "query_ms", "setup_ms", "frames", "gpu_bytes", "nrmse",       "rmse",           "relmse",
                         "bias", "bias_error", "relative_bias", "p99", "max", "flip", "noise_nrmse", "measured_nrmse", "not_finite"};
  std::string csv = "technique,fidelity,series,settings,pareto,at_noise";
  for (const char* key : kKeys) csv += std::string(",") + key;
  csv += ",inside_nrmse\n";
  for (const ErrorRow& row : rows) {
    csv += fmt::format("{},{},{},\"{}\",{},{}", text(row, "technique"), text(row, "fidelity"), text(row, "series"), text(row, "label"), flag(row, "pareto") ? 1 : 0,
                       flag(row, "at_noise") ? 1 : 0);
    for (const char* key : kKeys) csv += std::isnan(number(row, key)) ? "," : fmt::format(",{:.9g}", number(row, key));
    const auto inside = row.find("inside_model");
    csv += inside == row.end() ? ",\n" : fmt::format(",{:.9g}\n", number(*inside, "nrmse"));
  }
  return csv;
}

nlohmann::ordered_json pathSlopeJson(const std::vector<ErrorRow>& rows) {
  const std::optional<PathSlope> s = pathSlope(rows);
  if (!s) return {};
  return {{"samples", s->samples.slope}, {"samples_error", s->samples.error}, {"time", s->time.slope}, {"time_error", s->time.error}, {"processor_time", s->processor.slope},
          {"processor_time_error", s->processor.error}, {"from", s->first}, {"to", s->last}};
}

nlohmann::ordered_json modelJson(const std::vector<ModelError>& model) {
  auto json = nlohmann::ordered_json::array();
  for (const ModelError& m : model)
    json.push_back({{"leaves_out", m.name}, {"nrmse", m.errors.nrmse}, {"relative_bias", m.errors.measured.relativeBias}, {"at_noise", m.errors.atNoise}});
  return json;
}

nlohmann::ordered_json referencesJson(const References& references) {
  auto json = nlohmann::ordered_json::array();
  for (const auto& [transport, r] : references.of) {
    const glm::dvec3 mean = meanOf(r.mean);
    json.push_back({{"transport", std::string(measure::nameOf(transport))},
                    {"samples", r.samples},
                    {"seconds", r.seconds},
                    {"mean", {mean.x, mean.y, mean.z}},
                    {"mean_error", r.meanError},
                    {"pixel_error", std::sqrt(references.noise(r).variance)},
                    {"renderer", r.renderer}});
  }
  return json;
}

bool plotRows(const fs::path& folder, const ErrorReport& report) {
  LogLogPlot plot;
  plot.title = report.title;
  plot.xLabel = "time of a picture, ms";
  plot.yLabel = "NRMSE against path tracing, %";
  Series front{"Pareto front", {}, true, true};
  std::map<std::string, std::size_t> index;
  for (const ErrorRow& row : report.rows) {
    const std::string name = text(row, "series");
    const auto [found, isNew] = index.try_emplace(name, plot.series.size());
    if (isNew) plot.series.push_back({name, {}, true, false});
    if (!flag(row, "at_noise")) plot.series[found->second].points.push_back({number(row, "ms"), 100.0 * number(row, "nrmse"), ""});
    if (flag(row, "pareto") && !flag(row, "at_noise")) front.points.push_back({number(row, "ms"), 100.0 * number(row, "nrmse"), fmt::format("{:g}", number(row, "front"))});
  }
  std::sort(front.points.begin(), front.points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  for (Series& series : plot.series) std::sort(series.points.begin(), series.points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  plot.series.insert(plot.series.begin(), front);
  const measure::Reference& all = report.references->all();
  const glm::dvec3 mean = meanOf(all.mean);
  plot.floor = 300.0 * std::sqrt(report.references->noise(all).variance) / ((mean.x + mean.y + mean.z) / 3.0);
  plot.floorLabel = "3 x noise of the reference";
  if (index.contains("path")) {
    plot.guideSlope = -0.5;
    std::swap(plot.series[index["path"] + 1], plot.series.back());
  }
  if (std::all_of(plot.series.begin(), plot.series.end(), [](const Series& s) { return s.points.empty(); })) {
    logWarning("no plot: every row is at the reference's noise; give it more --budget");
    return false;
  }
  try {
    writeLogLogPlot(folder, "error", plot);
    return true;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::missingCapability) throw;
    logWarning("{}", error.what());
    return false;
  }
}

void addToPage(HtmlPage& page, const fs::path& folder, const ErrorReport& report) {
  page.section(fmt::format("{}: {}", report.isDeviationStudy ? "Deviations" : "Error against run time", report.title));
  page.preformatted(notes(report));
  if (fs::exists(folder / "error.svg")) page.svg(folder / "error.svg");
  HtmlPage::Table table;
  for (const Column& column : kColumns) table.columns.push_back(column.title);
  for (const ErrorRow& row : report.rows) {
    table.rows.emplace_back();
    for (const Column& column : kColumns) table.rows.back().push_back(column.of(row));
    table.marked.push_back(flag(row, "pareto"));
  }
  page.table(table);
  page.paragraph("Marked: nothing measured here is better in both time and error; their numbers (front) are those of the plot. ms: the median of a picture, wall clock on software renderers, GPU timer queries else; 5..95 % of the wall clock. NRMSE: root mean square "
                 "error over the reference's mean, linear radiance, less the reference's own noise; \"noise\": cannot be told from it. bias: signed, of the mean, with its standard error; "
                 "(0): within 3 of it. Relative MSE: epsilon 0.01 mean^2. Inside model: indirect light against a reference of the technique's own transport.");
  if (const std::string slope = slopeText(report.rows); !slope.empty()) page.paragraph(slope);
  if (!report.model.empty()) {
    HtmlPage::Table model{{"left out", "NRMSE of indirect light", "bias"}, {}, {}};
    for (const ModelError& m : report.model)
      model.rows.push_back({m.name, m.errors.atNoise ? fmt::format("< {:.3g} % (noise)", 300.0 * m.errors.noiseNrmse) : fmt::format("{:.3g} %", 100.0 * m.errors.nrmse),
                            fmt::format("{:+.3g} % +- {:.2g}", 100.0 * m.errors.measured.relativeBias, 100.0 * m.errors.biasError / m.errors.measured.referenceMean)});
    page.heading("What the models leave out, whatever the settings");
    page.table(model);
  }
  page.heading("Pictures");
  page.pictures({{folder / "pictures/reference.png", "reference, all light"}});
  const Image& truth = report.references->all().mean;
  const double scale = 0.2 * measure::heatMapScale(Image(truth.width, truth.height), truth);
  page.paragraph(fmt::format("Heat maps: absolute, 0 (black) to {0:.3g} and more (white) radiance; signed luminance, -{0:.3g} (blue), 0 (white), +{0:.3g} (red). One scale for all.", scale));
  for (const ErrorRow& row : report.rows) {
    // All of the front and of the deviations; of the rest one a series.
    const bool isLastOfSeries = &row == &report.rows.back() || text(row, "series") != text(*(&row + 1), "series");
    if (!flag(row, "pareto") && !isLastOfSeries) continue;
    const std::string stem = text(row, "picture");
    page.pictures({{folder / (stem + ".png"), text(row, "label")},
                   {folder / (stem + ".absolute.png"), "absolute error, NRMSE " + errorText(row)},
                   {folder / (stem + ".signed.png"), "signed error, bias " + biasText(row)}});
  }
}

}  // namespace lucerna::demo::bench
