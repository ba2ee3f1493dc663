// lucerna bench diff A B: compares two reports of `bench error` row by row. Decides whether B is better or worse than A
// by tests that use the spreads of both.
//
// Errors (relative L2, the same inside the model, bias): the difference over its standard error, which comes from the
// noise of the references and, for path tracing, from seeds. Student's t applies where the standard error is estimated
// from few seeds. A value below the reference's noise is an upper bound, and is decided only if the other one clearly
// exceeds it. Times: the logarithm of B over A. Two runs of one program differ by more than the spread within each
// (load, clock, memory), and the rows show by how much: the median over all rows is attributed to the machine and
// reported separately; the rows' scatter about it (median absolute deviation) adds to each row's own spread. Many rows
// mean many chances of error: the significance level is Sidak-corrected for all tests together [Sidak1967].
//
// If the processor renders, other load on the machine lengthens some pictures' times more than others. Their processor
// time, which excludes other load, must then agree.
//
// A row of A that B lacks counts as a loss, unless it belongs to a sweep of path tracing that had less time.
#include "bench/diff.hpp"

#include "base/error.hpp"
#include "base/statistics.hpp"
#include "bench/error_report.hpp"
#include "host/host.hpp"
#include "shared/completions.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna::demo {

namespace bench {

namespace {

struct DiffOptions {
  CommonOptions common;
  std::string a, b;
  std::vector<std::string> what{"error", "time"};
  double significance = 0.01, timeMargin = 0.1;
};

/// Equal up to rounding: atomics add in any order.
constexpr double kRounding = 1e-5;

enum class Verdict { undecided, better, worse };
std::string_view nameOf(Verdict v) {
  return v == Verdict::better ? "better" : v == Verdict::worse ? "worse" : "undecided";
}

/// A value with its standard error, estimated with `freedom` degrees of freedom; infinite: known exactly.
struct Estimate {
  double value = NAN, error = 0.0, freedom = INFINITY;
  bool isBound = false;  ///< at most `value`
};

struct Finding {
  std::string what;
  double a = NAN, b = NAN, apart = NAN;  ///< in standard errors of the difference
  Verdict verdict = Verdict::undecided;
};
struct RowDiff {
  std::string label;
  std::vector<Finding> findings;
  Verdict verdict = Verdict::undecided;
};

/// The z exceeded on either side with this total probability by a normal variable, found by bisection.
double normalLimit(double probability) {
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::sqrt(2.0)) > probability ? low : high) = middle;
  }
  return low;
}
/// Student's limit from the normal one [AbramowitzStegun 26.7.5].
double studentLimit(double z, double freedom) {
  if (!std::isfinite(freedom)) return z;
  const double v = std::max(freedom, 1.0);
  return z + (z * z * z + z) / (4.0 * v) + (5.0 * std::pow(z, 5) + 16.0 * z * z * z + 3.0 * z) / (96.0 * v * v);
}

bool flagOf(const ErrorRow& row, const char* key) {
  const auto found = row.find(key);
  return found != row.end() && found->is_boolean() && found->get<bool>();
}

/// errors: a row, or its inside_model. freedom: degrees of freedom from the row's seeds.
Estimate l2Of(const ErrorRow& errors, double freedom) {
  if (flagOf(errors, "at_noise")) return {3.0 * number(errors, "noise_l2"), 0.0, INFINITY, true};
  const double error = number(errors, "l2_error");
  return {number(errors, "l2"), std::isfinite(error) ? error : 0.0, freedom, false};
}
/// Relative, signed.
Estimate biasOf(const ErrorRow& row, double freedom) {
  const double mean = number(row, "bias") / number(row, "relative_bias"),
               error = number(row, "bias_error") / std::abs(mean);
  return {number(row, "relative_bias"), std::isfinite(error) ? error : 0.0, freedom, false};
}
double freedomOf(const ErrorRow& row) {
  const double freedom = number(row, "error_freedom");
  return std::isfinite(freedom) ? freedom : INFINITY;
}

/// Smaller is better. z: the normal limit.
Finding judge(const std::string& what, const Estimate& a, const Estimate& b, double z) {
  Finding finding{what, a.value, b.value, NAN, Verdict::undecided};
  if (!std::isfinite(a.value) || !std::isfinite(b.value)) {
    // A value that is no longer finite is worse, whatever it was.
    if (std::isfinite(a.value) != std::isfinite(b.value))
      finding.verdict = std::isfinite(a.value) ? Verdict::worse : Verdict::better;
    return finding;
  }
  const double difference = b.value - a.value, error = std::hypot(a.error, b.error);
  if ((a.isBound && b.isBound) || (a.isBound && difference <= 0.0) || (b.isBound && difference >= 0.0)) return finding;
  if (std::abs(difference) <= kRounding * std::max(std::abs(a.value), std::abs(b.value))) return finding;
  finding.apart = error > 0.0 ? difference / error : std::copysign(INFINITY, difference);
  if (std::abs(finding.apart) > studentLimit(z, std::min(a.freedom, b.freedom)))
    finding.verdict = std::abs(b.value) > std::abs(a.value) ? Verdict::worse : Verdict::better;
  return finding;
}

/// A median time as a logarithm, "ms" or "cpu_ms", with the standard error of "ms" from its samples.
Estimate logTimeOf(const ErrorRow& row, const char* key) {
  std::vector<double> samples;
  if (const auto found = row.find("wall_ms_samples");
      found != row.end() && found->is_array() && key == std::string_view("ms"))
    for (const auto& value : *found) samples.push_back(value.get<double>());
  const double error = medianError(samples) / median(samples);
  return {std::log(number(row, key)), std::isfinite(error) ? error : 0.0,
          std::isfinite(error) ? static_cast<double>(samples.size()) - 1.0 : INFINITY, false};
}

/// Logarithms of the time ratios B over A of many rows: the shift that the machine causes in all of them, and their
/// scatter about it.
struct TimeRatios {
  double shift = 0.0, scatter = INFINITY;  ///< infinite: too few rows to estimate it
  std::size_t count = 0;
};
TimeRatios timeRatios(const std::vector<std::pair<ErrorRow, ErrorRow>>& rows, const char* key) {
  std::vector<double> ratios, deviations;
  for (const auto& [a, b] : rows)
    if (const double ratio = logTimeOf(b, key).value - logTimeOf(a, key).value; std::isfinite(ratio))
      ratios.push_back(ratio);
  TimeRatios result;
  result.count = ratios.size();
  if (!ratios.empty()) result.shift = median(ratios);
  for (const double ratio : ratios) deviations.push_back(std::abs(ratio - result.shift));
  if (deviations.size() >= 4) result.scatter = 1.4826 * median(deviations);
  return result;
}

/// margin: changes below this fraction are undecided.
Finding judgeTime(const ErrorRow& a, const ErrorRow& b, const char* key, const TimeRatios& all, double z,
                  double margin) {
  Finding finding{key, number(a, key), number(b, key), NAN, Verdict::undecided};
  const Estimate timeA = logTimeOf(a, key), timeB = logTimeOf(b, key);
  const double change = timeB.value - timeA.value - all.shift,
               error = std::hypot(std::hypot(timeA.error, timeB.error), all.scatter);
  if (!std::isfinite(change) || !std::isfinite(error)) return finding;
  finding.apart = error > 0.0 ? change / error : change == 0.0 ? 0.0 : std::copysign(INFINITY, change);
  if (std::abs(finding.apart) > studentLimit(z, static_cast<double>(all.count) - 1.0) &&
      std::abs(change) > std::log1p(margin))
    finding.verdict = change > 0.0 ? Verdict::worse : Verdict::better;
  return finding;
}

std::map<std::string, ErrorRow> byLabel(const nlohmann::ordered_json& report, std::vector<std::string>& order) {
  std::map<std::string, ErrorRow> rows;
  for (const ErrorRow& row : report.at("rows")) {
    const std::string label = row.at("label").get<std::string>();
    if (rows.emplace(label, row).second) order.push_back(label);
  }
  return rows;
}

/// Whether a path tracing sweep, which climbs as long as time permits, ends before this row in the other report.
bool isBeyondSweep(const ErrorRow& row, const std::map<std::string, ErrorRow>& others) {
  double longest = -INFINITY;
  for (const auto& [label, other] : others)
    if (row.contains("series") && other.contains("series") && row.at("series") == other.at("series"))
      longest = std::max(longest, number(other, "spp"));
  return number(row, "spp") > longest && std::isfinite(longest);
}

int runDiff(const DiffOptions& options) {
  // Read the inputs.
  options.common.apply();
  const auto wants = [&](const char* what) {
    return std::find(options.what.begin(), options.what.end(), what) != options.what.end();
  };
  for (const std::string& what : options.what)
    if (what != "error" && what != "time") throwBadInput("--only {}: unknown; expected error or time", what);
  if (!(options.significance > 0.0 && options.significance < 1.0))
    throwBadInput("--significance {}: expected a number between 0 and 1", options.significance);
  // Match rows by their labels: in both reports, or in only one.
  const nlohmann::ordered_json reportA = readErrorReport(options.a), reportB = readErrorReport(options.b);
  if (reportA.at("bench") != reportB.at("bench"))
    throwBadInput("{} is of '{}', {} of '{}': only reports of one scene, view and size are compared", options.a,
                  reportA.at("bench").get<std::string>(), options.b, reportB.at("bench").get<std::string>());
  std::vector<std::string> orderA, orderB;
  const auto a = byLabel(reportA, orderA), b = byLabel(reportB, orderB);
  std::vector<std::string> both, onlyA, onlyB, unreached;
  for (const std::string& label : orderA)
    (b.contains(label) ? both : isBeyondSweep(a.at(label), b) ? unreached : onlyA).push_back(label);
  for (const std::string& label : orderB)
    if (!a.contains(label)) onlyB.push_back(label);
  if (both.empty()) throwBadInput("{} and {} have no row in common", options.a, options.b);

  // Sidak correction: four tests per row.
  const double tests = 4.0 * static_cast<double>(both.size()),
               z = normalLimit(1.0 - std::pow(1.0 - options.significance, 1.0 / tests));
  std::vector<std::pair<ErrorRow, ErrorRow>> pairs;
  for (const std::string& label : both) pairs.emplace_back(a.at(label), b.at(label));
  const TimeRatios times = timeRatios(pairs, "ms"), processorTimes = timeRatios(pairs, "cpu_ms");
  const bool byProcessor = Host::isSoftwareRenderer(reportA.value("renderer", "")) &&
                           Host::isSoftwareRenderer(reportB.value("renderer", ""));

  // Each row's findings, and its verdict: worse if any finding is.
  std::vector<RowDiff> diffs;
  int worse = 0, better = 0;
  for (const std::string& label : both) {
    const ErrorRow &rowA = a.at(label), &rowB = b.at(label);
    RowDiff diff{label, {}, Verdict::undecided};
    const double freedomA = freedomOf(rowA), freedomB = freedomOf(rowB);
    if (wants("error")) {
      diff.findings.push_back(judge("relative L2", l2Of(rowA, freedomA), l2Of(rowB, freedomB), z));
      if (rowA.contains("inside_model") && rowB.contains("inside_model"))
        diff.findings.push_back(
            judge("inside model", l2Of(rowA.at("inside_model"), INFINITY), l2Of(rowB.at("inside_model"), INFINITY), z));
      diff.findings.push_back(judge("bias", biasOf(rowA, INFINITY), biasOf(rowB, INFINITY), z));
    }
    if (wants("time")) {
      Finding time = judgeTime(rowA, rowB, "ms", times, z, options.timeMargin);
      if (byProcessor && std::isfinite(number(rowA, "cpu_ms")) && std::isfinite(number(rowB, "cpu_ms")) &&
          judgeTime(rowA, rowB, "cpu_ms", processorTimes, z, options.timeMargin).verdict != time.verdict)
        time.verdict = Verdict::undecided;
      diff.findings.push_back(time);
    }
    for (const Finding& f : diff.findings) {
      if (f.verdict == Verdict::worse) diff.verdict = Verdict::worse;
      if (f.verdict == Verdict::better && diff.verdict == Verdict::undecided) diff.verdict = Verdict::better;
    }
    worse += diff.verdict == Verdict::worse;
    better += diff.verdict == Verdict::better;
    diffs.push_back(std::move(diff));
  }

  // Print for people, and write JSON.
  if (!options.common.quiet) {
    std::size_t width = 10;
    for (const RowDiff& diff : diffs) width = std::max(width, diff.label.size());
    for (const RowDiff& diff : diffs) {
      std::string line = fmt::format("{:<9}  {:<{}}", nameOf(diff.verdict), diff.label, width);
      for (const Finding& f : diff.findings) {
        const double scale = f.what == "ms" ? 1.0 : 100.0;
        line += fmt::format("  {} {:.4g} -> {:.4g}{}{}", f.what, scale * f.a, scale * f.b, f.what == "ms" ? "" : " %",
                            std::isfinite(f.apart) ? fmt::format(" ({:+.1f})", f.apart) : "");
        if (f.verdict != Verdict::undecided) line += fmt::format(" {}", nameOf(f.verdict));
      }
      fmt::print("{}\n", line);
    }
    for (const std::string& label : onlyA) fmt::print("gone       {}\n", label);
    for (const std::string& label : unreached) fmt::print("no time    {}\n", label);
    for (const std::string& label : onlyB) fmt::print("new        {}\n", label);
    fmt::print("In brackets: standard errors of the difference; decided beyond {:.2f} (level {:g} for all {} rows).\n",
               z, options.significance, both.size());
    if (wants("time"))
      fmt::print(
          "All rows together: B takes {:.3f} times A's time (median), machine or program; rows scatter by {:.1f} % "
          "about that.\n",
          std::exp(times.shift), std::isfinite(times.scatter) ? 100.0 * times.scatter : NAN);
    fmt::print("{} better, {} worse, {} undecided\n", better, worse, static_cast<int>(diffs.size()) - better - worse);
  }
  nlohmann::ordered_json json;
  json["a"] = options.a;
  json["b"] = options.b;
  json["significance"] = options.significance;
  json["limit"] = z;
  json["time_ratio"] = std::exp(times.shift);
  json["time_scatter"] = times.scatter;
  json["better"] = better;
  json["worse"] = worse;
  json["gone"] = onlyA;
  json["not_reached"] = unreached;
  json["new"] = onlyB;
  json["rows"] = nlohmann::ordered_json::array();
  for (const RowDiff& diff : diffs) {
    nlohmann::ordered_json row{{"label", diff.label}, {"verdict", nameOf(diff.verdict)}};
    for (const Finding& f : diff.findings)
      row["findings"].push_back(
          {{"what", f.what}, {"a", f.a}, {"b", f.b}, {"standard_errors", f.apart}, {"verdict", nameOf(f.verdict)}});
    json["rows"].push_back(std::move(row));
  }
  options.common.writeJson(json);
  return worse > 0 || !onlyA.empty() ? 1 : 0;
}

}  // namespace

}  // namespace bench

Work addBenchDiff(Command app) {
  auto options = std::make_shared<bench::DiffOptions>();
  app.addOption("A", options->a, "a report: its JSON, or the folder of `bench error`").required();
  app.addOption("B", options->b,
                "another one of the same scene, view and size; exit code 1 if a row of it is worse or missing")
      .required();
  addCompletions(app.addOption("--only", options->what, "compare only error or time; default: both").delimiter(','),
                 {"error", "time"});
  app.addOption("--significance", options->significance,
                "probability that any row is called better or worse although nothing changed")
      .showDefault();
  app.addOption("--time-margin", options->timeMargin, "smaller changes of a time, as a fraction, are undecided")
      .showDefault()
      .notNegative();
  options->common.declare(app);
  return [options] {
    try {
      return bench::runDiff(*options);
    } catch (const nlohmann::json::exception& error) {
      throwBadInput("{}, {}: no reports of lucerna bench error ({})", options->a, options->b, error.what());
    }
  };
}

}  // namespace lucerna::demo
