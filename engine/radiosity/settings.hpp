// Settings shared by the published program (original_solver) and the corrected one (no GL, pure).
//
// Radiosity here is exitance in the scene's own units; the original counts it in steps of its 24-bit numbers
// (rad_file.hpp).
#pragma once

#include "base/named_values.hpp"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// How the linear system is solved. The original has the first two.
enum class RadiositySolver { automatic, jacobi, gaussSeidel, progressive, anderson, conjugateGradients };
constexpr std::array<std::string_view, 6> namesOf(RadiositySolver) {
  return {"auto", "jacobi", "gauss-seidel", "progressive", "anderson", "cg"};
}

/// Deviations of the published program; false is correct.
struct RadiosityDeviations {
  bool publishedMap = false;  ///< pixels weighted 1/r^2 (top) and b/r^2 (sides) instead of the delta form factor
  bool values24Bit = false;  ///< 24-bit integers, rounded down, instead of floats
  bool centroid = false;  ///< one hemicube at a triangle's centroid, whatever its size
  bool fixedOrientation = false;  ///< hemicubes turned towards the first corner instead of rolled at random
  bool noNearField = false;  ///< no correction closer than the near plane or a patch's own size
};

/// A named switch, as in frame/deviation.hpp. Names begin with "radiosity.".
struct RadiosityDeviation {
  const char* name;
  const char* meaning;
  bool RadiosityDeviations::*member;
};

std::span<const RadiosityDeviation> allRadiosityDeviations();

/// All of them, as published: `--fidelity original`.
RadiosityDeviations publishedRadiosity();

/// "NAME=on" or "NAME=off"; throws Error(badInput) listing the names.
void applyRadiosityDeviation(RadiosityDeviations& deviations, std::string_view assignment);

/// Names of those switched on.
std::vector<std::string> activeRadiosityDeviations(const RadiosityDeviations& deviations);

}  // namespace lucerna
