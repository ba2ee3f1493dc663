#include "walk/state.hpp"

#include "shared/provenance.hpp"
#include "shared/shell.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace lucerna::demo {

namespace {

/// Quoted for a shell.
}  // namespace

std::string textOf(const PictureOptions& o) {
  return fmt::format("{} {} {} | {} | {}", o.technique, o.component, o.fidelity, fmt::join(o.deviations, " "),
                     fmt::join(o.settings, " "));
}

void chooseTechnique(PictureOptions& options, const std::string& technique) {
  if (technique == options.technique) return;
  options.technique = technique;
  options.settings.clear();
  options.deviations.clear();
}

std::string commandLine(const std::string& command, const std::string& scene, const PictureOptions& o) {
  const PictureOptions usual;
  std::string line = "lucerna " + command + " " + bench::shellWord(scene);
  if (o.technique != kDefaultTechnique) line += " --technique " + o.technique;
  if (o.component != usual.component) line += " --component " + o.component;
  if (o.fidelity != usual.fidelity) line += " --fidelity " + o.fidelity;
  for (const std::string& deviation : o.deviations) line += " --deviation " + bench::shellWord(deviation);
  for (const std::string& setting : o.settings) line += " --set " + bench::shellWord(setting);
  return line;
}

void assign(std::vector<std::string>& assignments, const std::string& key, const std::string& value) {
  const auto known = std::find_if(assignments.begin(), assignments.end(),
                                  [&](const std::string& a) { return a.starts_with(key + "="); });
  if (value.empty()) {
    if (known != assignments.end()) assignments.erase(known);
  } else if (known != assignments.end()) {
    *known = key + "=" + value;
  } else {
    assignments.push_back(key + "=" + value);
  }
}

std::string cameraText(const Scene& scene, const Camera& c) {
  if (c.isOrthographic()) return c.name;  // numbers stand for perspective views alone
  const glm::dvec3 from = c.position + scene.origin, target = from + c.direction;
  const int digits = scene.origin == glm::dvec3(0.0) ? 7 : 13;
  return fmt::format("{:.{}g},{:.{}g},{:.{}g},{:.{}g},{:.{}g},{:.{}g},{:.5g}", from.x, digits, from.y, digits, from.z,
                     digits, target.x, digits, target.y, digits, target.z, digits, glm::degrees(c.verticalFov));
}

}  // namespace lucerna::demo
