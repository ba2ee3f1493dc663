// The radiosity system B = E + rho F B and its solvers (no GL, pure, double precision).
//
// B: exitance, E: a patch's own, rho: reflectance, F B = H: irradiance; three channels at once. All solvers stop at the
// same bound: after a last Jacobi step of change c, |B - exact| <= q / (1 - q) max |c| in every patch, q = max rho_i
// sum_j F_ij. If q is not below 1 (a white surface in an open scene) a supersolution replaces it: (I - rho F) w >= o >
// 0 gives |error| <= max w / min o times the residual.
#pragma once

#include "radiosity/settings.hpp"

#include <glm/glm.hpp>

#include <functional>
#include <span>
#include <vector>

namespace lucerna {

class FormFactorMatrix;

struct RadiositySystem {
  std::vector<double> areas;
  std::vector<glm::dvec3> reflectance, emission;  ///< per patch
  std::vector<double> rowSums;  ///< of F
  /// H = F B. The cost of a solver is the number of its calls.
  std::function<void(std::span<const glm::dvec3> exitance, std::span<glm::dvec3> irradiance)> product;
  const FormFactorMatrix* matrix = nullptr;  ///< if rows are stored: Gauss-Seidel and progressive need them
  bool reciprocal = false;  ///< A_i F_ij = A_j F_ji: conjugate gradients need it
};

struct RadiosityProgress {
  double products = 0.0;  ///< so far; for solvers that use single rows, rows used over number of rows
  double residual = 0.0;  ///< max |E + rho F B - B| over the mean exitance
  double errorBound = 0.0;  ///< guaranteed: max |B - exact| over the mean exitance
  double energyBalance = 0.0;  ///< (emitted - absorbed - lost through openings) / emitted
  bool isEstimate = false;  ///< residual and bound are, while the balance is that of the last report
};

struct SolverSettings {
  RadiositySolver solver = RadiositySolver::automatic;
  double error = 1e-6;  ///< stop at this errorBound
  double mostProducts = 100000.0;  ///< progressive refinement stops within a product
  std::span<const glm::dvec3> start{};  ///< irradiance from patches to begin with; empty: none
  std::function<bool(const RadiosityProgress&)> onStep;  ///< called after each product; false stops
};

struct RadiositySolved {
  std::vector<glm::dvec3> exitance, irradiance;
  RadiosityProgress progress;
  RadiositySolver solver = RadiositySolver::jacobi;  ///< actually used
  bool reached = false;  ///< the requested error
};

/// Throws Error(badInput) if the system has no solution (reflectance 1 everywhere in a closed scene) or a solver lacks
/// what it needs.
RadiositySolved solveRadiosity(const RadiositySystem& system, const SolverSettings& settings);

}  // namespace lucerna
