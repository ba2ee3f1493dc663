#include "bench/error_report.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/image.hpp"
#include "base/log.hpp"
#include "shared/figure.hpp"
#include "bench/plot.hpp"
#include "measure/front.hpp"
#include "measure/heat_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>

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

/// "12.3 %", or "< 0.4 % (noise)" if the reference is too noisy. measure: l2 or nrmse.
std::string errorText(const ErrorRow& errors, const char* measure) {
  const auto notFinite = errors.find("not_finite");
  if (notFinite != errors.end() && notFinite->is_number() && notFinite->get<double>() > 0) return "not finite";
  if (flag(errors, "at_noise"))
    return fmt::format("< {:.3g} % (noise)", 300.0 * number(errors, (std::string("noise_") + measure).c_str()));
  const double value = 100.0 * number(errors, measure);
  return std::isfinite(value) ? fmt::format("{:.3g} %", value) : "";
}
/// The part "blocks", "lit", "other" or "inside_model"; an empty row if there is none.
const ErrorRow& part(const ErrorRow& row, const char* key) {
  static const ErrorRow kNone = ErrorRow::object();
  const auto found = row.find(key);
  return found == row.end() || !found->is_object() ? kNone : *found;
}
std::string biasText(const ErrorRow& row) {
  const double mean = number(row, "bias") / number(row, "relative_bias"),
               error = 100.0 * number(row, "bias_error") / std::abs(mean);
  if (!std::isfinite(error))
    return fmt::format("{:+.3g} % +- ?", 100.0 * number(row, "relative_bias"));  // one sample has no spread
  return fmt::format("{:+.3g} % +- {:.2g}{}", 100.0 * number(row, "relative_bias"), error,
                     flag(row, "bias_at_noise") ? " (0)" : "");
}
/// The bias of lit pixels, or of the others: "+275 %"; (0) below three standard errors.
std::string partBiasText(const ErrorRow& errors, const char* key) {
  const ErrorRow& p = part(errors, key);
  const double bias = number(p, "relative_bias"), error = number(p, "bias_error");
  if (!std::isfinite(bias)) return "";
  return fmt::format("{:+.3g} %{}", 100.0 * bias, std::abs(bias) < 3.0 * error ? " (0)" : "");
}
std::string bytesText(double bytes) { return std::isnan(bytes) ? "" : fmt::format("{:.2f} MiB", bytes / 1048576.0); }
/// Empty for NaN: baselines take no time.
std::string fixed(double value, int digits) { return std::isnan(value) ? "" : fmt::format("{:.{}f}", value, digits); }

struct Column {
  const char* title;
  std::string (*of)(const ErrorRow&);
};
const Column kColumns[] = {
    {"technique and settings", [](const ErrorRow& r) { return text(r, "label"); }},
    {"front", [](const ErrorRow& r) { return flag(r, "pareto") ? fmt::format("{:g}", number(r, "front")) : ""; }},
    {"ms", [](const ErrorRow& r) { return fixed(number(r, "ms"), 2); }},
    {"5..95 %",
     [](const ErrorRow& r) {
       return std::isnan(spread(r, 0)) ? "" : fmt::format("{:.2f}..{:.2f}", spread(r, 0), spread(r, 1));
     }},
    {"query ms", [](const ErrorRow& r) { return fixed(number(r, "query_ms"), 2); }},
    {"set-up ms", [](const ErrorRow& r) { return fixed(number(r, "setup_ms"), 0); }},
    {"rel. L2", [](const ErrorRow& r) { return errorText(r, "l2"); }},
    {"in blocks", [](const ErrorRow& r) { return errorText(part(r, "blocks"), "l2"); }},
    {"bias, lit", [](const ErrorRow& r) { return partBiasText(r, "lit"); }},
    {"bias, other", [](const ErrorRow& r) { return partBiasText(r, "other"); }},
    {"inside model", [](const ErrorRow& r) { return errorText(part(r, "inside_model"), "l2"); }},
    {"NRMSE", [](const ErrorRow& r) { return errorText(r, "nrmse"); }},
    {"bias", biasText},
    {"rel. MSE", [](const ErrorRow& r) { return fmt::format("{:.3g}", number(r, "relmse")); }},
    {"99 %", [](const ErrorRow& r) { return fmt::format("{:.3g}", number(r, "p99")); }},
    {"FLIP", [](const ErrorRow& r) { return fixed(number(r, "flip"), 3); }},
    {"GPU memory", [](const ErrorRow& r) { return bytesText(number(r, "gpu_bytes")); }},
};

/// Inside the model: the values in row["inside_model"].
const Column kInsideColumns[] = {
    {"technique and settings", [](const ErrorRow& r) { return text(r, "label"); }},
    {"ms", [](const ErrorRow& r) { return fixed(number(r, "ms"), 2); }},
    {"rel. L2", [](const ErrorRow& r) { return errorText(part(r, "inside_model"), "l2"); }},
    {"in blocks", [](const ErrorRow& r) { return errorText(part(part(r, "inside_model"), "blocks"), "l2"); }},
    {"bias, lit", [](const ErrorRow& r) { return partBiasText(part(r, "inside_model"), "lit"); }},
    {"bias, other", [](const ErrorRow& r) { return partBiasText(part(r, "inside_model"), "other"); }},
    {"squares in lit",
     [](const ErrorRow& r) {
       return fmt::format("{:.0f} %", 100.0 * number(part(part(r, "inside_model"), "lit"), "squares"));
     }},
    {"bias", [](const ErrorRow& r) { return biasText(part(r, "inside_model")); }},
    {"NRMSE", [](const ErrorRow& r) { return errorText(part(r, "inside_model"), "nrmse"); }},
    {"NRMSE in blocks", [](const ErrorRow& r) { return errorText(part(part(r, "inside_model"), "blocks"), "nrmse"); }},
};

/// Table cells of rows, one line each.
HtmlPage::Table tableOf(std::span<const Column> columns, const std::vector<const ErrorRow*>& rows, const char* marked) {
  HtmlPage::Table table;
  for (const Column& column : columns) table.columns.push_back(column.title);
  for (const ErrorRow* row : rows) {
    table.rows.emplace_back();
    for (const Column& column : columns) table.rows.back().push_back(column.of(*row));
    table.marked.push_back(flag(*row, marked));
  }
  return table;
}

std::string textOf(const HtmlPage::Table& table) {
  std::vector<std::size_t> widths;
  for (const std::string& title : table.columns) widths.push_back(title.size());
  for (const auto& cells : table.rows)
    for (std::size_t c = 0; c < widths.size(); ++c) widths[c] = std::max(widths[c], cells[c].size());
  const auto line = [&](const std::vector<std::string>& cells, bool isMarked) {
    std::string result = isMarked ? "* " : "  ";
    for (std::size_t c = 0; c < widths.size(); ++c)
      result += c == 0 ? fmt::format("{:<{}}", cells[c], widths[c]) : fmt::format("  {:>{}}", cells[c], widths[c]);
    return result + "\n";
  };
  std::string result = line(table.columns, false);
  for (std::size_t r = 0; r < table.rows.size(); ++r) result += line(table.rows[r], table.marked[r]);
  return result;
}

std::vector<ErrorRow> rowsBefore(const ErrorReport& report) {
  return report.before.is_null() ? std::vector<ErrorRow>{} : report.before.at("rows").get<std::vector<ErrorRow>>();
}

constexpr const char* kBeforeNote =
    "Dotted curves are of the earlier program. Time to equal error, over before: the ratio of ms times the square of "
    "the relative L2, as independent samples would need it; without rows at the noise of either reference.";

/// Rows of both programs by their settings.
HtmlPage::Table beforeTable(const ErrorReport& report) {
  HtmlPage::Table table{
      {"technique and settings", "ms, before", "now", "rel. L2, before", "now", "to equal error"}, {}, {}};
  const std::vector<ErrorRow> before = rowsBefore(report);
  for (const ErrorRow& row : report.rows) {
    const auto old = std::find_if(before.begin(), before.end(),
                                  [&](const ErrorRow& r) { return text(r, "label") == text(row, "label"); });
    if (old == before.end() || flag(row, "at_noise") || flag(*old, "at_noise")) continue;
    const double error = number(row, "l2") / number(*old, "l2"),
                 ratio = number(row, "ms") / number(*old, "ms") * error * error;
    table.rows.push_back({text(row, "label"), fixed(number(*old, "ms"), 2), fixed(number(row, "ms"), 2),
                          errorText(*old, "l2"), errorText(row, "l2"), fixed(ratio, 2)});
    table.marked.push_back(ratio < 1.0);
  }
  return table;
}

HtmlPage::Table allLightTable(const ErrorReport& report) {
  std::vector<const ErrorRow*> rows;
  for (const ErrorRow& row : report.baselines) rows.push_back(&row);
  for (const ErrorRow& row : report.rows) rows.push_back(&row);
  return tableOf(kColumns, rows, "pareto");
}

/// Baselines, then the model's rows, best first.
HtmlPage::Table insideTable(const ErrorReport& report, const InsideModel& model) {
  std::vector<const ErrorRow*> rows;
  for (const ErrorRow& row : report.rows)
    if (text(part(row, "inside_model"), "model") == model.name) rows.push_back(&row);
  std::stable_sort(rows.begin(), rows.end(), [](const ErrorRow* a, const ErrorRow* b) {
    const double x = rankedError(part(*a, "inside_model"), "l2"), y = rankedError(part(*b, "inside_model"), "l2");
    return std::isnan(y) ? !std::isnan(x) : x < y;
  });
  rows.insert(rows.begin(), {&model.black, &model.constant});
  return tableOf(kInsideColumns, rows, "inside_front");
}

constexpr const char* kInsideHeading =
    "Inside the model: the light that the technique promises, from the lights it supports";
constexpr const char* kInsideNote =
    "Settings of a technique are ranked here, never by the error of all light, where errors of the model and of the "
    "settings may cancel. Marked: on the front of their technique by time and error. "
    "squares in lit: share of sum d^2 in directly lit pixels. Bounds (--bounds): what is left of the error without "
    "cells, and of the exact radiance in them.";

std::string notes(const ErrorReport& report) {
  std::string line = fmt::format("Renderer {}\nHost     {}, {}\nBench    {}\n", report.renderer, report.host,
                                 report.cpu, report.title);
  for (const std::string& left : report.leftOut) line += left + "\n";
  std::size_t longest = 0;
  for (const auto& [paths, r] : report.references->of) longest = std::max(longest, nameOf(paths).size());
  for (const auto& [paths, r] : report.references->of) {
    const measure::ReferenceNoise noise = report.references->noise(r);
    const glm::dvec3 mean = meanOf(r.mean);
    const double m = (mean.x + mean.y + mean.z) / 3.0;
    line += fmt::format(
        "Reference {:<{}} {:>6} samples per pixel, {:.1f} s; mean {:.6g} +- {:.2g}; noise of a pixel {:.3g} % of the "
        "mean\n",
        nameOf(paths), longest, r.samples, r.seconds, m, r.meanError,
        m > 0.0 ? 100.0 * std::sqrt(noise.variance) / m : 0.0);
  }
  return line;
}

constexpr const char* kSweepsNote =
    "More is better: relative L2 along each sweep, inside its model, or of all light where its points have several. "
    "Worse: the error rises by more than two standard errors, which the reference's noise gives.";

HtmlPage::Table sweepsTable(const std::vector<Sweep>& sweeps) {
  HtmlPage::Table table{{"sweep", "errors, %", "worse"}, {}, {}};
  for (const Sweep& sweep : sweeps) {
    std::string errors, worse;
    for (std::size_t i = 0; i < sweep.errors.size(); ++i) {
      const double e = 100.0 * sweep.errors[i];
      errors += (i == 0 ? "" : ", ") + (std::isfinite(e) ? fmt::format("{:.3g}", e) : std::string("noise"));
    }
    for (const Sweep::Rise& rise : sweep.rises)
      worse += fmt::format("{}{} by {:.2g} % +- {:.1g}", worse.empty() ? "" : "; ", sweep.labels[rise.to],
                           100.0 * rise.by, 100.0 * rise.error);
    table.rows.push_back({sweep.series, errors, worse.empty() ? "never" : worse});
    table.marked.push_back(sweep.rises.empty());
  }
  return table;
}

std::string modelErrorText(const ModelError& m) {
  return m.errors.atNoise ? fmt::format("< {:.3g} % (noise)", 300.0 * m.errors.noiseL2)
                          : fmt::format("{:.3g} %", 100.0 * m.errors.l2);
}
std::string modelBiasText(const ModelError& m) {
  return fmt::format("{:+.3g} % +- {:.2g}{}", 100.0 * m.errors.measured.relativeBias,
                     100.0 * m.errors.biasError / m.errors.measured.referenceMean, m.errors.biasAtNoise ? " (0)" : "");
}
std::string modelText(const ModelError& m) {
  return fmt::format("{:<64}relative L2 {}, bias {} of {}", m.name, modelErrorText(m), modelBiasText(m), m.of);
}

/// Exponents of the path tracer's error by samples and, from the eighth on, by wall-clock and processor time. A pass
/// doubles the samples; in the first passes lanes wait for the longest of few paths, so a sample costs more there.
struct PathSlope {
  measure::Slope samples, time, processor;
  double first = 0.0, last = 0.0;  ///< samples
};

/// Slopes over time use 32 samples and more: in the first passes lanes wait for the longest of few paths. None with
/// fewer than three such rows above the reference's noise.
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
  return PathSlope{measure::logLogSlope(samples, errors), measure::logLogSlope(ms, errorsOverTime),
                   measure::logLogSlope(cpuMs, errorsOverTime), samples.front(), samples.back()};
}

std::string slopeText(const std::vector<ErrorRow>& rows) {
  const std::optional<PathSlope> s = pathSlope(rows);
  if (!s) return "";
  return fmt::format(
      "Path tracing: error ~ samples^({:.3f} +- {:.3f}), time^({:.3f} +- {:.3f}), processor time^({:.3f} +- {:.3f}) "
      "from {:g} to {:g} samples, by time from 32 on; -1/2 is what independent samples give.",
      s->samples.slope, s->samples.error, s->time.slope, s->time.error, s->processor.slope, s->processor.error,
      s->first, s->last);
}

std::string timeText(double ms) {
  return ms < 1.0      ? fmt::format("{:.2g} ms", ms)
         : ms < 1000.0 ? fmt::format("{:.0f} ms", ms)
                       : fmt::format("{:.3g} s", ms / 1000.0);
}

/// A technique, from the time in which its first picture of the front is drawn to that of the next technique's.
struct Choice {
  std::string technique;
  const ErrorRow *first, *last;  ///< of the front, by time
};

/// The front by time of what is not as published, less what improves the error by less than kWorthwhile. Empty if
/// nothing was measured.
std::vector<Choice> choicesOf(const std::vector<ErrorRow>& rows) {
  constexpr double kWorthwhile = 0.1;
  std::vector<Choice> choices;
  for (const ErrorRow* row : correctedFront(rows)) {
    const bool isFirst = choices.empty();
    if (!isFirst && rankedError(*row, "l2") > (1.0 - kWorthwhile) * rankedError(*choices.back().last, "l2")) continue;
    if (isFirst || choices.back().technique != text(*row, "technique"))
      choices.push_back({text(*row, "technique"), row, row});
    choices.back().last = row;
  }
  return choices;
}

}  // namespace

std::string choiceText(const std::vector<ErrorRow>& rows) {
  const std::vector<Choice> choices = choicesOf(rows);
  if (choices.empty()) return "";
  std::string result = "What to use for a picture's time: ";
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const Choice& choice = choices[i];
    const std::string until = i + 1 < choices.size() ? timeText(number(*choices[i + 1].first, "ms")) : "";
    result += i == 0 ? (until.empty() ? "at any: " : fmt::format("below {}: ", until))
                     : fmt::format("; from {} {}: ", timeText(number(*choice.first, "ms")),
                                   until.empty() ? "on" : "to " + until);
    const auto add = [&](const ErrorRow& row) {
      result +=
          fmt::format("{} (error {} in {})", text(row, "label"), errorText(row, "l2"), timeText(number(row, "ms")));
    };
    add(*choice.first);
    if (choice.last != choice.first) {
      result += " to ";
      add(*choice.last);
    }
  }
  return result + ". Times are this machine's; an error that falls by less than a tenth counts as none.";
}

nlohmann::ordered_json choiceJson(const std::vector<ErrorRow>& rows) {
  auto json = nlohmann::ordered_json::array();
  for (const Choice& choice : choicesOf(rows))
    json.push_back({{"technique", choice.technique},
                    {"from_ms", json.empty() ? 0.0 : number(*choice.first, "ms")},
                    {"first", text(*choice.first, "label")},
                    {"last", text(*choice.last, "label")}});
  return json;
}

std::string terminalTable(const ErrorReport& report) {
  std::string result = notes(report) + "\nAll light:\n" + textOf(allLightTable(report));
  result +=
      "* nothing measured here is better in both time and relative L2 (Pareto front; rel. L2: a black picture has 100 "
      "%)\n";
  if (const std::string slope = slopeText(report.rows); !slope.empty()) result += slope + "\n";
  if (!report.inside.empty()) result += fmt::format("\n{}.\n{}\n", kInsideHeading, kInsideNote);
  for (const InsideModel& model : report.inside)
    result += fmt::format("\n{}\n{}", model.name, textOf(insideTable(report, model)));
  if (const std::vector<Sweep> sweeps = sweepsOf(report.rows); !sweeps.empty())
    result += fmt::format("\n{}\n{}", kSweepsNote, textOf(sweepsTable(sweeps)));
  if (!report.model.empty()) result += "\nWhat the models leave out, whatever the settings:\n";
  for (const ModelError& m : report.model) result += "  " + modelText(m) + "\n";
  if (const std::string choice = choiceText(report.rows); !choice.empty()) result += "\n" + choice + "\n";
  return result;
}

std::string csvOf(const ErrorReport& report) {
  const char* kKeys[] = {"ms",    "wall_ms", "query_ms", "setup_ms",    "frames",         "gpu_bytes",     "l2",
                         "nrmse", "rmse",    "relmse",   "bias",        "bias_error",     "relative_bias", "p99",
                         "max",   "flip",    "noise_l2", "noise_nrmse", "measured_nrmse", "not_finite"};
  std::string csv = "technique,fidelity,series,settings,pareto,inside_front,at_noise";
  for (const char* key : kKeys) csv += std::string(",") + key;
  csv +=
      ",blocks_l2,lit_bias,other_bias,inside_l2,inside_blocks_l2,inside_lit_bias,inside_other_bias,inside_nrmse,inside_"
      "blocks_nrmse\n";
  const auto figure = [](double value) { return std::isnan(value) ? std::string(",") : fmt::format(",{:.9g}", value); };
  const auto add = [&](const ErrorRow& row) {
    csv += fmt::format("{},{},{},\"{}\",{:d},{:d},{:d}", text(row, "technique"), text(row, "fidelity"),
                       text(row, "series"), text(row, "label"), flag(row, "pareto"), flag(row, "inside_front"),
                       flag(row, "at_noise"));
    for (const char* key : kKeys) csv += figure(number(row, key));
    const ErrorRow& inside = part(row, "inside_model");
    for (const ErrorRow* errors : {&row, &inside}) {
      if (errors == &inside) csv += figure(number(inside, "l2"));
      csv += figure(number(part(*errors, "blocks"), "l2")) + figure(number(part(*errors, "lit"), "relative_bias")) +
             figure(number(part(*errors, "other"), "relative_bias"));
    }
    csv += figure(number(inside, "nrmse")) + figure(number(part(inside, "blocks"), "nrmse")) + "\n";
  };
  for (const ErrorRow& row : report.baselines) add(row);
  for (const ErrorRow& row : report.rows) add(row);
  return csv;
}

nlohmann::ordered_json pathSlopeJson(const std::vector<ErrorRow>& rows) {
  const std::optional<PathSlope> s = pathSlope(rows);
  if (!s) return {};
  return {{"samples", s->samples.slope},
          {"samples_error", s->samples.error},
          {"time", s->time.slope},
          {"time_error", s->time.error},
          {"processor_time", s->processor.slope},
          {"processor_time_error", s->processor.error},
          {"from", s->first},
          {"to", s->last}};
}

nlohmann::ordered_json sweepsJson(const std::vector<ErrorRow>& rows) {
  auto json = nlohmann::ordered_json::array();
  for (const Sweep& sweep : sweepsOf(rows)) {
    auto rises = nlohmann::ordered_json::array();
    for (const Sweep::Rise& rise : sweep.rises)
      rises.push_back({{"to", sweep.labels[rise.to]}, {"by", rise.by}, {"error", rise.error}});
    json.push_back({{"series", sweep.series},
                    {"model", sweep.model.empty() ? "all light" : sweep.model},
                    {"labels", sweep.labels},
                    {"l2", sweep.errors},
                    {"rises", rises}});
  }
  return json;
}

nlohmann::ordered_json modelJson(const std::vector<ModelError>& model) {
  auto json = nlohmann::ordered_json::array();
  for (const ModelError& m : model)
    json.push_back({{"leaves_out", m.name},
                    {"of", m.of},
                    {"l2", m.errors.l2},
                    {"nrmse", m.errors.nrmse},
                    {"relative_bias", m.errors.measured.relativeBias},
                    {"at_noise", m.errors.atNoise}});
  return json;
}

nlohmann::ordered_json insideModelsJson(const std::vector<InsideModel>& inside) {
  auto json = nlohmann::ordered_json::array();
  for (const InsideModel& model : inside)
    json.push_back({{"model", model.name},
                    {"black", model.black.at("inside_model")},
                    {"constant", model.constant.at("inside_model")}});
  return json;
}

nlohmann::ordered_json referencesJson(const References& references) {
  auto json = nlohmann::ordered_json::array();
  const auto add = [&](const LightPaths& paths, const char* materials, const measure::Reference& r) {
    const glm::dvec3 mean = meanOf(r.mean);
    json.push_back({{"transport", std::string(nameOf(paths.transport))},
                    {"lights", measure::nameOf(paths.lights)},
                    {"bounces", paths.bounces},
                    {"materials", materials},
                    {"samples", r.samples},
                    {"seconds", r.seconds},
                    {"mean", {mean.x, mean.y, mean.z}},
                    {"mean_error", r.meanError},
                    {"pixel_error", std::sqrt(references.noise(r).variance)},
                    {"renderer", r.renderer}});
  };
  for (const auto& [paths, r] : references.of) add(paths, "lambert", r);
  if (references.own) add({Transport::all, references.lights}, "all", *references.own);
  return json;
}

namespace {

/// Writes the plot; warns and returns false if nothing can be drawn or gnuplot is missing.
bool draw(const fs::path& folder, const std::string& stem, const LogLogPlot& plot) {
  if (std::all_of(plot.series.begin(), plot.series.end(), [](const Series& s) { return s.points.empty(); })) {
    logWarning("no plot {}: every row is at the reference's noise; increase --budget", stem);
    return false;
  }
  try {
    writeLogLogPlot(folder, stem, plot);
    return true;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::missingCapability) throw;
    logWarning("{}", error.what());
    return false;
  }
}

/// Every series has the same style in all plots and in the figure: its index among those of the report.
std::map<std::string, std::size_t> stylesOf(const ErrorReport& report) {
  std::map<std::string, std::size_t> styles;
  for (const ErrorRow& row : report.rows) styles.try_emplace(text(row, "series"), styles.size());
  return styles;
}

/// Sorts the points of one series by time.
void sortByTime(LogLogPlot& plot) {
  for (Series& series : plot.series)
    std::sort(series.points.begin(), series.points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
}

bool plotAllLight(const fs::path& folder, const ErrorReport& report) {
  LogLogPlot plot;
  plot.title = report.title + ": all light";
  plot.xLabel = "time of a picture, ms";
  plot.yLabel = "relative L2 error against path tracing, % (black = 100 %)";
  Series front{"Pareto front", {}, true, true, false, 0};
  const std::map<std::string, std::size_t> styles = stylesOf(report);
  std::map<std::string, std::size_t> index;
  for (const ErrorRow& row : report.rows) {
    const std::string name = text(row, "series");
    const auto [found, isNew] = index.try_emplace(name, plot.series.size());
    if (isNew) plot.series.push_back({name, {}, true, false, false, styles.at(name)});
    if (!flag(row, "at_noise"))
      plot.series[found->second].points.push_back({number(row, "ms"), 100.0 * number(row, "l2"), ""});
    if (flag(row, "pareto") && !flag(row, "at_noise"))
      front.points.push_back({number(row, "ms"), 100.0 * number(row, "l2"), fmt::format("{:g}", number(row, "front"))});
  }
  const std::vector<ErrorRow> rowsOfBefore = rowsBefore(report);
  for (const auto& [name, style] : styles) {
    Series before{name + ", before", {}, true, false, true, style};
    for (const ErrorRow& row : rowsOfBefore)
      if (text(row, "series") == name && !flag(row, "at_noise"))
        before.points.push_back({number(row, "ms"), 100.0 * number(row, "l2"), ""});
    if (!before.points.empty()) plot.series.push_back(before);
  }
  plot.series.insert(plot.series.begin(), front);
  sortByTime(plot);
  for (const ErrorRow& row : report.baselines) plot.levels.push_back({100.0 * number(row, "l2"), text(row, "label")});
  plot.levels.push_back({300.0 * number(report.baselines.front(), "noise_l2"), "3 x noise of the reference"});
  if (index.contains("path")) {
    plot.guideSlope = -0.5;
    std::swap(plot.series[index["path"] + 1], plot.series.back());
  }
  return draw(folder, "error", plot);
}

/// Indirect light of each technique inside its model; direct light, and models of all light, appear only in tables.
bool plotInside(const fs::path& folder, const ErrorReport& report) {
  LogLogPlot plot;
  plot.title = report.title + ": indirect light inside each model";
  plot.xLabel = "time of a picture (of all light), ms";
  plot.yLabel = "relative L2 error inside the model, % (black = 100 %)";
  std::map<std::string, std::size_t> index;
  const std::map<std::string, std::size_t> styles = stylesOf(report);
  std::map<std::string, std::string> models;  // a short name of each model drawn
  for (const ErrorRow& row : report.rows) {
    const ErrorRow& inside = part(row, "inside_model");
    if (inside.empty() || text(inside, "transport") == "direct" || text(inside, "transport") == "all") continue;
    models[text(inside, "model")];
    const auto [found, isNew] = index.try_emplace(text(row, "series"), plot.series.size());
    if (isNew) plot.series.push_back({text(row, "series"), {}, true, false, false, styles.at(text(row, "series"))});
    if (!flag(inside, "at_noise"))
      plot.series[found->second].points.push_back({number(row, "ms"), 100.0 * number(inside, "l2"), ""});
  }
  if (models.empty()) return false;
  sortByTime(plot);
  plot.levels.push_back({100.0, "black"});
  for (const InsideModel& model : report.inside)
    if (models.contains(model.name))
      plot.levels.push_back({100.0 * number(part(model.constant, "inside_model"), "l2"), "constant, " + model.name});
  return draw(folder, "error_inside", plot);
}

}  // namespace

nlohmann::ordered_json readErrorReport(const std::string& path) {
  const fs::path file = fs::is_directory(path) ? fs::path(path) / "error.json" : fs::path(path);
  nlohmann::ordered_json report = nlohmann::ordered_json::parse(readFileText(file), nullptr, false);
  if (report.is_discarded() || !report.is_object() || !report.contains("rows") || !report.at("rows").is_array() ||
      !report.contains("bench"))
    throwBadInput("{}: no report of lucerna bench error (its JSON, or the folder that holds error.json)", path);
  return report;
}

bool plotRows(const fs::path& folder, const ErrorReport& report) {
  const bool all = plotAllLight(folder, report), inside = plotInside(folder, report);
  return all || inside;
}

namespace {

/// Converts the report for the figure; pictures that the folder does not hold in linear form are left out.
Figure figureOf(const fs::path& folder, const ErrorReport& report, std::vector<Image>& store) {
  Figure figure;
  figure.facts = {{"title", report.title},
                  {"renderer", report.renderer},
                  {"driver", report.driver},
                  {"host", report.host},
                  {"cpu", report.cpu},
                  {"program", programVersion()},
                  {"command", report.command},
                  {"exposure", report.exposure},
                  {"relmse_epsilon", measure::kRelativeEpsilon},
                  {"references", referencesJson(*report.references)},
                  {"baselines", report.baselines},
                  {"rows", report.rows}};
  const measure::Reference &all = report.references->all(), &path = report.references->path();
  figure.references.push_back(
      {&path == &all ? "reference, all light" : "reference, Lambert surfaces", &all.mean, &all.standardError});
  if (&path != &all) figure.references.push_back({"reference, all materials", &path.mean, &path.standardError});
  store.reserve(2 * report.rows.size());
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const ErrorRow& row = report.rows[i];
    const std::string stem = (folder / text(row, "picture")).string();
    if (!fs::exists(stem + ".pfm")) continue;
    FigurePicture picture;
    picture.row = i;
    picture.reference = text(row, "technique") == "path" && &path != &all ? 1 : 0;
    picture.picture = &store.emplace_back(readImage(stem + ".pfm"));
    if (fs::exists(stem + ".error.pfm")) picture.standardError = &store.emplace_back(readImage(stem + ".error.pfm"));
    if (fs::exists(stem + ".flip.png")) picture.flip = readBitmap(stem + ".flip.png");
    // The whole front, and the last row of every series; the rest if there is room.
    const bool isLastOfSeries =
        i + 1 == report.rows.size() || text(row, "series") != text(report.rows[i + 1], "series");
    picture.isFirstChoice = flag(row, "pareto") || isLastOfSeries;
    figure.pictures.push_back(std::move(picture));
  }
  return figure;
}

}  // namespace

void addToPage(HtmlPage& page, const fs::path& folder, const ErrorReport& report, std::size_t bytes) {
  page.section(fmt::format("{}: {}", report.isDeviationStudy ? "Deviations" : "Error against run time", report.title));
  page.preformatted(notes(report));
  if (const std::string choice = choiceText(report.rows); !choice.empty()) page.paragraph(choice);
  std::vector<Image> store;
  const Figure figure = figureOf(folder, report, store);
  page.figure(figureHtml(figure, bytes));
  if (fs::exists(folder / "error.svg")) page.svgWithoutScripts(folder / "error.svg");
  page.table(allLightTable(report));
  page.paragraph(
      "Marked: nothing measured here is better in both time and relative L2; their numbers (front) are those of the "
      "plot. Of the settings of one technique only those take part that are on its front inside its "
      "model (below). ms: the median of a picture, wall clock on software renderers, GPU timer queries else; 5..95 % "
      "of the wall clock. rel. L2: sqrt(sum d^2 / sum r^2) of the light that surfaces scatter (what is seen of lights "
      "and background themselves is taken off), linear radiance, less the reference's own noise. black: nothing "
      "scattered, 100 %; constant: albedo times one constant irradiance over pi, chosen by least squares. \"noise\": "
      "cannot be told from it. "
      "In blocks: after averaging over blocks of 1/16 of the width. Bias, lit and other: of surface pixels with and "
      "without direct light of sun and lamps. NRMSE: root mean square error over the "
      "reference's mean, for comparison with others' figures. bias: signed, of the mean, with its standard error; (0): "
      "within 3 of it. Relative MSE: epsilon 0.01 mean^2.");
  if (const std::string slope = slopeText(report.rows); !slope.empty()) page.paragraph(slope);
  if (!report.before.is_null()) {
    page.heading(fmt::format("Beside an earlier program: {}, {}", report.before.value("program", "of no known version"),
                             report.before.value("renderer", "of no known renderer")));
    page.paragraph(kBeforeNote);
    page.table(beforeTable(report));
  }
  if (!report.inside.empty()) {
    page.heading(kInsideHeading);
    page.paragraph(kInsideNote);
    if (fs::exists(folder / "error_inside.svg")) page.svg(folder / "error_inside.svg");
  }
  for (const InsideModel& model : report.inside) {
    page.paragraph(model.name);
    page.table(insideTable(report, model));
  }
  if (const std::vector<Sweep> sweeps = sweepsOf(report.rows); !sweeps.empty()) {
    page.heading("More is better");
    page.paragraph(kSweepsNote);
    page.table(sweepsTable(sweeps));
  }
  if (!report.model.empty()) {
    HtmlPage::Table model{{"left out", "of", "relative L2", "bias"}, {}, {}};
    for (const ModelError& m : report.model) model.rows.push_back({m.name, m.of, modelErrorText(m), modelBiasText(m)});
    page.heading("What the models leave out, whatever the settings");
    page.table(model);
  }
  page.heading("Pictures");
  const Image& reference = report.references->all().mean;
  const double scale = 0.2 * measure::heatMapScale(Image(reference.width, reference.height), reference);
  page.paragraph(
      fmt::format("Heat maps: absolute, 0 (black) to {0:.3g} and more (white) radiance; signed luminance, -{0:.3g} "
                  "(blue), 0 (white), +{0:.3g} (red). One scale for all.",
                  scale));
  // Tone-mapped copies for readers without scripts, as far as there is room: the figure above holds the pictures
  // themselves.
  std::size_t room = bytes / 8;
  const auto show = [&](const std::vector<HtmlPage::Picture>& pictures) {
    std::size_t size = 0;
    for (const HtmlPage::Picture& picture : pictures) size += 4 * fs::file_size(picture.png) / 3;
    if (size > room) return false;
    room -= size;
    page.pictures(pictures);
    return true;
  };
  int leftOut = show({{folder / "pictures/reference.png", "reference, all light"}}) ? 0 : 1;
  for (const ErrorRow& row : report.rows) {
    // All of the front and of the deviations; of the rest one per series.
    const bool isLastOfSeries = &row == &report.rows.back() || text(row, "series") != text(*(&row + 1), "series");
    if (!flag(row, "pareto") && !isLastOfSeries) continue;
    const std::string stem = text(row, "picture");
    leftOut += !show({{folder / (stem + ".png"), text(row, "label")},
                      {folder / (stem + ".absolute.png"), "absolute error, relative L2 " + errorText(row, "l2")},
                      {folder / (stem + ".signed.png"), "signed error, bias " + biasText(row)}});
  }
  if (leftOut > 0)
    page.paragraph(fmt::format("{} more are in the folder pictures: this page has no room for them.", leftOut));
}

}  // namespace lucerna::demo::bench
