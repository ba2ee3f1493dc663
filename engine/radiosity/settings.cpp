#include "radiosity/settings.hpp"

#include "base/error.hpp"
#include "base/nearest_words.hpp"
#include "base/log.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace lucerna {

namespace {

constexpr std::array kDeviations{
    RadiosityDeviation{"radiosity.published-map", "pixels weighted by 1/r^2 and b/r^2 instead of the delta form factor",
                       &RadiosityDeviations::publishedMap},
    RadiosityDeviation{"radiosity.24-bit", "radiosity in whole numbers of 24 bits, rounded down",
                       &RadiosityDeviations::values24Bit},
    RadiosityDeviation{"radiosity.centroid", "one hemicube per patch, at its centroid, whatever its size",
                       &RadiosityDeviations::centroid},
    RadiosityDeviation{"radiosity.fixed-orientation", "hemicubes turned towards the first corner, not rolled at random",
                       &RadiosityDeviations::fixedOrientation},
    RadiosityDeviation{"radiosity.no-near-field", "near pairs and small sources by pixels only, without a repair",
                       &RadiosityDeviations::noNearField},
};

}  // namespace

std::span<const RadiosityDeviation> allRadiosityDeviations() { return kDeviations; }

RadiosityDeviations publishedRadiosity() {
  RadiosityDeviations all;
  for (const RadiosityDeviation& deviation : kDeviations) all.*deviation.member = true;
  return all;
}

void applyRadiosityDeviation(RadiosityDeviations& deviations, std::string_view assignment) {
  const auto equals = assignment.find('=');
  const std::string name(assignment.substr(0, equals));
  const std::string_view value = equals == std::string_view::npos ? "" : assignment.substr(equals + 1);
  const auto found =
      std::find_if(kDeviations.begin(), kDeviations.end(), [&](const RadiosityDeviation& d) { return d.name == name; });
  if (found == kDeviations.end()) {
    std::vector<std::string_view> names;
    for (const RadiosityDeviation& d : kDeviations) names.push_back(d.name);
    throwBadInput("--deviation {}: unknown; nearest: {} (lucerna info --settings lists all)", assignment,
                  nearestList(name, names));
  }
  if (value != "on" && value != "off") throwBadInput("--deviation {}: expected NAME=on or NAME=off", assignment);
  deviations.*found->member = value == "on";
}

std::vector<std::string> activeRadiosityDeviations(const RadiosityDeviations& deviations) {
  std::vector<std::string> names;
  for (const RadiosityDeviation& deviation : kDeviations)
    if (deviations.*deviation.member) names.emplace_back(deviation.name);
  return names;
}

}  // namespace lucerna
