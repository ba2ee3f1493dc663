// Delta form factors: the weight of each pixel of a hemicube (no GL, pure).
#pragma once

#include <vector>

namespace lucerna {

enum class DeltaMap {
  exact,  ///< cos cos' / (pi r^2) [CohenGreenberg1985] integrated over the pixel; the five faces sum to 1
  published,  ///< 1/r^2 (full face) and b/r^2 (half faces), r^2 = 1 + a^2 + b^2, divided by the sum over the five
              ///< [RAD2008]
};

/// The full face (N x N, row by row) and then one of the four half faces (N x N/2, rows upwards from the horizon). N
/// even, >= 2.
std::vector<double> deltaFormFactors(int n, DeltaMap map);

/// Their sum over the five faces.
double sumOverHemicube(const std::vector<double>& factors, int n);

}  // namespace lucerna
