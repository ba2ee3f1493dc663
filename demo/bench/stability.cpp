// lucerna bench stability [--technique T]: one row per case: technique, parameter, expected, measured, verdict.
#include "bench/stability.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/hash.hpp"
#include "bench/bench.hpp"
#include "shared/parts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lucerna::demo {

namespace bench {

bool Measurement::passes() const {
  if (!std::isfinite(measured)) return false;
  switch (rule) {
    case Rule::equals: return std::abs(measured - expected) <= tolerance;
    case Rule::atMost: return measured <= expected;
    case Rule::atLeast: return measured >= expected;
  }
  return false;
}

std::string expectedText(const Measurement& m) {
  switch (m.rule) {
    case Rule::equals:
      return m.tolerance > 0.0 ? fmt::format("{:.6g} +- {:.2g}", m.expected, m.tolerance)
                               : fmt::format("{:.6g} exactly", m.expected);
    case Rule::atMost: return fmt::format("<= {:.6g}", m.expected);
    case Rule::atLeast: return fmt::format(">= {:.6g}", m.expected);
  }
  return "";
}

namespace {

StabilityRow runCase(const StabilityCase& c, const StabilityContext& context) {
  StabilityRow row{c.technique, c.name, c.parameter, "", {}, 0.0, false};
  const auto start = Clock::now();
  try {
    row.measurement = c.run(context);
    row.passed = row.measurement.passes();
  } catch (const Error& error) {
    row.measurement.measured = NAN;
    row.note = error.what();
  }
  row.seconds = secondsSince(start);
  return row;
}

// A row as stored: the measurement; the rest comes from the case.
PartFolder::Json keptOf(const StabilityRow& row) {
  const Measurement& m = row.measurement;
  return {{"expected", m.expected},           {"measured", m.measured}, {"tolerance", m.tolerance},
          {"rule", static_cast<int>(m.rule)}, {"seconds", row.seconds}, {"note", row.note}};
}

StabilityRow keptRow(const StabilityCase& c, const PartFolder::Json& kept) {
  const auto number = [&](const char* key) { return kept.at(key).is_number() ? kept.at(key).get<double>() : NAN; };
  StabilityRow row{c.technique, c.name, c.parameter, kept.at("note").get<std::string>(), {}, number("seconds"), false};
  row.measurement = {number("expected"), number("measured"), number("tolerance"),
                     static_cast<Rule>(kept.at("rule").get<int>())};
  row.passed = row.measurement.passes();
  return row;
}

}  // namespace

std::vector<StabilityRow> runStability(const StabilityContext& context, const std::string& technique, bool quiet,
                                       const PartOptions& options) {
  std::vector<StabilityCase> cases;
  addLpvCases(cases);
  addCacheCases(cases);
  addPictureCases(cases);
  addPlaceCases(cases);
  addRadiosityCases(cases);
  addPathCases(cases);
  addMediaCases(cases);
  addLimitCases(cases);
  addLeakCases(cases);
  addMotionCases(cases);
  std::string known;
  for (const StabilityCase& c : cases)
    if (known.find(c.technique) == std::string::npos) known += (known.empty() ? "" : ", ") + c.technique;
  std::erase_if(cases, [&](const StabilityCase& c) { return technique.empty() ? c.isLong : c.technique != technique; });
  if (cases.empty()) throwBadInput("--technique {}: unknown; expected one of {}", technique, known);
  Hash names;
  for (const StabilityCase& c : cases)
    for (const std::string* text : {&c.technique, &c.name, &c.parameter}) names.add(std::string_view(*text));
  const PartFolder part(
      options, "bench stability",
      fmt::format("technique {}, cases {:016x}", technique.empty() ? "all" : technique, names.value()), cases.size());
  std::vector<StabilityRow> rows;
  Progress progress("stability", static_cast<int>(part.last() - part.first()), quiet);
  for (std::size_t i = part.first(); i < part.last(); ++i) {
    if (interrupted()) return rows;
    if (const auto kept = part.load(i)) {
      rows.push_back(keptRow(cases[i], *kept));
    } else {
      StabilityRow row = runCase(cases[i], context);
      if (interrupted()) return rows;  // long rows end early then
      part.store(i, keptOf(row));
      rows.push_back(std::move(row));
    }
    progress.update(static_cast<int>(rows.size()));
  }
  part.finish();
  return rows;
}

nlohmann::ordered_json stabilityJson(const std::vector<StabilityRow>& rows) {
  auto json = nlohmann::ordered_json::array();
  for (const StabilityRow& row : rows) {
    const char* rule = row.measurement.rule == Rule::equals   ? "equals"
                       : row.measurement.rule == Rule::atMost ? "at most"
                                                              : "at least";
    json.push_back({{"technique", row.technique},
                    {"case", row.name},
                    {"parameter", row.parameter},
                    {"expected", row.measurement.expected},
                    {"tolerance", row.measurement.tolerance},
                    {"rule", rule},
                    {"measured", row.measurement.measured},
                    {"verdict", row.passed ? "pass" : "fail"},
                    {"seconds", row.seconds}});
    if (!row.note.empty()) json.back()["note"] = row.note;
  }
  return json;
}

}  // namespace bench

namespace {

struct StabilityOptions {
  CommonOptions common;
  PartOptions part;
  std::string technique, compare;
};

int runStabilityCommand(const StabilityOptions& options) {
  options.common.apply();
  if (options.part.isPart() && !options.compare.empty())
    throwBadInput("--compare {}: needs all rows; --part computes only some", options.compare);
  const nlohmann::ordered_json kept =
      options.compare.empty() ? nlohmann::ordered_json() : bench::readKept(options.compare);
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const std::vector<bench::StabilityRow> rows =
      bench::runStability({context, programs}, options.technique, options.common.quiet, options.part);
  int failed = 0;
  double seconds = 0.0;
  if (!options.common.quiet)
    fmt::print("Renderer {}\n\n{:<11}{:<66}{:<24}{:<26}{:<14}{:>7}\n", context.capabilities().renderer, "technique",
               "case", "parameter", "expected", "measured", "s");
  for (const bench::StabilityRow& row : rows) {
    failed += !row.passed;
    seconds += row.seconds;
    if (options.common.quiet) continue;
    fmt::print("{:<11}{:<66}{:<24}{:<26}{:<14.7g}{:>7.2f}  {}{}\n", row.technique, row.name, row.parameter,
               expectedText(row.measurement), row.measurement.measured, row.seconds, row.passed ? "pass" : "FAIL",
               row.note.empty() ? "" : ": " + row.note);
  }
  if (!options.common.quiet) fmt::print("\n{} rows, {} failed, {:.1f} s\n", rows.size(), failed, seconds);
  const nlohmann::ordered_json json = bench::stabilityJson(rows);
  std::vector<std::string> worse;
  if (!options.compare.empty() && !interrupted()) {
    worse = bench::worseRows(json, kept, options.technique, options.compare);
    for (const std::string& line : worse) fmt::print("worse than {}: {}\n", options.compare, line);
    if (worse.empty() && !options.common.quiet) fmt::print("nothing is worse than {}\n", options.compare);
  }
  options.common.writeJson({{"renderer", context.capabilities().renderer},
                            {"host", std::string(nameOf(host->kind()))},
                            {"rows", json},
                            {"failed", failed},
                            {"worse", worse},
                            {"seconds", seconds}});
  if (interrupted()) return exitCode();
  if (options.part.isPart()) return 0;  // the verdict needs all rows
  // With a stored table to compare, its known defects are not failures.
  return (options.compare.empty() ? failed > 0 : !worse.empty()) ? 1 : 0;
}

}  // namespace

Work addBenchStability(Command app) {
  auto options = std::make_shared<StabilityOptions>();
  app.addOption("--technique", options->technique,
                "only the rows of this technique; motion: 10,000 frames by each, which takes minutes");
  app.addOption(
      "--compare", options->compare,
      "a table stored by --json: reports rows that are missing, fail now, expect another answer or allow more; "
      "exit code 1");
  options->part.declare(app, "rows");
  options->common.declare(app);
  return [options] { return runStabilityCommand(*options); };
}

}  // namespace lucerna::demo
