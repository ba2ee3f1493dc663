// Delta form factors: the weight of each pixel of a hemicube (no GL, pure).
#pragma once

#include <vector>

namespace lucerna {

enum class DeltaMap {
  exact,  ///< cos cos' / (pi r^2) integrated over the pixel in closed form; the five faces sum to 1
  centre,  ///< the same at the pixel's centre times its area [CohenGreenberg1985]: off by 0.54 / N^2 in all
  published,  ///< 1/r^2 (full face) and b/r^2 (half faces), r^2 = 1 + a^2 + b^2, divided by the sum over the five
              ///< [RAD2008]
};

/// The full face (N x N, row by row) and then one of the four half faces (N x N/2, rows upwards from the horizon). N
/// even, >= 2.
std::vector<double> deltaFormFactors(int n, DeltaMap map);

/// Their sum over the five faces.
double sumOverHemicube(const std::vector<double>& factors, int n);

}  // namespace lucerna
