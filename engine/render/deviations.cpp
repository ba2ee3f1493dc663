#include "render/deviations.hpp"

#include "base/error.hpp"
#include "base/nearest_words.hpp"
#include "render/techniques.hpp"

#include <algorithm>

namespace lucerna {

std::vector<Deviation> allDeviations() {
  std::vector<Deviation> all;
  for (const TechniqueEntry& technique : allTechniques())
    all.insert(all.end(), technique.deviations.begin(), technique.deviations.end());
  return all;
}

void applyFidelity(RenderSettings& settings, Fidelity fidelity) {
  for (const Deviation& deviation : allDeviations())
    deviation.turn(settings, fidelity == Fidelity::demo ? deviation.inDemo()
                                                        : fidelity != Fidelity::corrected && deviation.inOriginal());
  if (fidelity == Fidelity::corrected) return;
  settings.shadows = ShadowTransport::map;
  settings.shadow.filter = ShadowFilter::tent;
  for (const TechniqueEntry& technique : allTechniques())
    if (technique.publish) technique.publish(settings);
}

void applyDeviation(RenderSettings& settings, std::string_view assignment) {
  const auto equals = assignment.find('=');
  const std::string name(assignment.substr(0, equals));
  const std::string_view value = equals == std::string_view::npos ? "" : assignment.substr(equals + 1);
  if (name == "radiosity.24-bit")
    throwBadInput(
        "--deviation {}: only the published solver has 24-bit values; use lucerna radiosity solve --fidelity original",
        assignment);
  const std::vector<Deviation> all = allDeviations();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Deviation& d) { return d.name == name; });
  if (found == all.end()) {
    std::vector<std::string_view> names;
    for (const Deviation& d : all) names.push_back(d.name);
    throwBadInput("--deviation {}: unknown; nearest: {} (lucerna info --settings lists all)", assignment,
                  nearestList(name, names));
  }
  if (value != "on" && value != "off") throwBadInput("--deviation {}: expected NAME=on or NAME=off", assignment);
  found->turn(settings, value == "on");
}

std::vector<std::string> activeDeviations(const RenderSettings& settings) {
  std::vector<std::string> names;
  for (const Deviation& deviation : allDeviations())
    if (deviation.isOn(settings)) names.emplace_back(deviation.name);
  return names;
}

}  // namespace lucerna
