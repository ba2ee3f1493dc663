#include "radiosity/settings.hpp"

#include "base/error.hpp"
#include "base/named_values.hpp"

#include <algorithm>
#include <array>

namespace lucerna {

namespace {

constexpr std::array kSolvers{
    std::pair{RadiositySolver::automatic, "auto"},
    std::pair{RadiositySolver::jacobi, "jacobi"},
    std::pair{RadiositySolver::gaussSeidel, "gauss-seidel"},
    std::pair{RadiositySolver::progressive, "progressive"},
    std::pair{RadiositySolver::overshoot, "overshoot"},
    std::pair{RadiositySolver::anderson, "anderson"},
    std::pair{RadiositySolver::perRoom, "per-room"},
    std::pair{RadiositySolver::conjugateGradients, "cg"},
};

constexpr std::array kDeviations{
    RadiosityDeviation{"rad.published-map", "pixels weighted by 1/r^2 and b/r^2 instead of the delta form factor", &RadiosityDeviations::publishedMap},
    RadiosityDeviation{"rad.24-bit", "radiosity in whole numbers of 24 bits, rounded down", &RadiosityDeviations::values24Bit},
    RadiosityDeviation{"rad.centroid", "one hemicube a triangle, at its centroid", &RadiosityDeviations::centroid},
    RadiosityDeviation{"rad.fixed-orientation", "hemicubes turned towards the first corner, not rolled at random", &RadiosityDeviations::fixedOrientation},
    RadiosityDeviation{"rad.no-near-field", "what is nearer than the near plane or a patch's size is not treated", &RadiosityDeviations::noNearField},
};

}  // namespace

std::string_view nameOf(RadiositySolver solver) { return nameIn(kSolvers, solver); }

RadiositySolver parseRadiositySolver(std::string_view name) { return valueIn(kSolvers, name, "--solver"); }

std::span<const RadiosityDeviation> allRadiosityDeviations() { return kDeviations; }

RadiosityDeviations publishedRadiosity() {
  RadiosityDeviations all;
  for (const RadiosityDeviation& deviation : kDeviations) all.*deviation.member = true;
  return all;
}

void applyRadiosityDeviation(RadiosityDeviations& deviations, std::string_view assignment) {
  const auto equals = assignment.find('=');
  const std::string_view name = assignment.substr(0, equals);
  const std::string_view value = equals == std::string_view::npos ? "" : assignment.substr(equals + 1);
  if (value != "on" && value != "off") throwBadInput("--deviation {}: expected NAME=on or NAME=off", assignment);
  const auto found = std::find_if(kDeviations.begin(), kDeviations.end(), [&](const RadiosityDeviation& d) { return d.name == name; });
  if (found == kDeviations.end()) {
    std::string known;
    for (const RadiosityDeviation& d : kDeviations) known += (known.empty() ? "" : ", ") + std::string(d.name);
    throwBadInput("--deviation {}: unknown; there are {}", assignment, known);
  }
  deviations.*found->member = value == "on";
}

std::vector<std::string> activeRadiosityDeviations(const RadiosityDeviations& deviations) {
  std::vector<std::string> names;
  for (const RadiosityDeviation& deviation : kDeviations)
    if (deviations.*deviation.member) names.emplace_back(deviation.name);
  return names;
}

}  // namespace lucerna
