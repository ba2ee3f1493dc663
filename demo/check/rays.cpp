// lucerna check, part rays: rays a second (lucerna bench rays).
#include "check/check.hpp"

#include "bench/bench.hpp"
#include "bench/rays_bench.hpp"

#include <fmt/core.h>

namespace lucerna::demo::check {

namespace {

Finding traceRays(const std::string& name, const UnitInput& input) {
  Session session(input);
  at("loading " + name);
  const Scene scene = loadScene(bench::asset(fmt::format("{0}/{0}.json", name)));
  bench::RaysOptions options;
  if (session.context.capabilities().softwareRenderer) options.rays = 1 << 14;
  options.repeats = 5;
  at("tracing");
  const bench::RaysResult result = bench::measureRays(session.context, session.programs, scene, options, true);
  Finding finding;
  finding.figures = result.json;
  for (const auto& row : result.json.at("rows"))
    finding.text += fmt::format("{}{} {:.4g}", finding.text.empty() ? "" : ", ", row.at("rays").get<std::string>(),
                                row.at("mrays_per_s").get<double>());
  finding.text += " million a second";
  return finding;
}

}  // namespace

std::vector<Unit> rayUnits() {
  std::vector<Unit> units;
  for (const char* name : {"atrium", "cornell"})
    units.push_back({"rays", name, 30.0, [name](const UnitInput& input) { return traceRays(name, input); }, {}, true});
  return units;
}

}  // namespace lucerna::demo::check
