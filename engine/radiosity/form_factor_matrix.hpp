// The form factor matrix as sparse rows in double-precision products (no GL, pure).
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lucerna {

/// F as compressed rows; entries in the order of patches, factors in float, sums in double. Products use all cores and
/// have the same bits on any number of them: each row is one sum.
class FormFactorMatrix {
 public:
  FormFactorMatrix() : starts_{0} {}

  /// Memory for so many entries in all; more may follow.
  void reserve(std::size_t entries);
  /// Appends the next row.
  void appendRow(std::span<const std::uint32_t> patches, std::span<const float> factors);
  std::size_t rowCount() const { return starts_.size() - 1; }
  std::size_t entryCount() const { return patches_.size(); }

  struct Row {
    std::span<const std::uint32_t> patches;
    std::span<const float> factors;
    double scale;  ///< factor on the row: the part of its sum that floats cannot hold
  };
  Row row(std::size_t i) const;

  /// y = F x, three channels at once: irradiance from exitance.
  void multiply(std::span<const glm::dvec3> x, std::span<glm::dvec3> y) const;
  std::vector<double> rowSums() const;

  /// Repairs errors of hemicubes. Afterwards A_i F_ij = A_j F_ji for all pairs, to the floats' 1e-7, and closed rows,
  /// whose `sums[i]` is 1, sum to 1 in double. Open rows stay unconstrained: forcing a wrong near-field sum would move
  /// the error to far entries. `sources`, if given, marks columns whose factors are closed forms: a source's factor
  /// below `fewPixels` of its hemisphere is taken from the other row. Returns the largest relative error of a closed
  /// row's sum before the last rounding. Symmetric scaling [Sinkhorn1964], [KnightRuizUcar2014] of a weighted mean.
  double repair(std::span<const double> areas, std::span<const double> sums,
                std::span<const std::uint32_t> sources = {}, double fewPixels = 0.0);
  /// Largest |A_i F_ij - A_j F_ji| over the mean of A_i F_ij.
  double reciprocityError(std::span<const double> areas) const;

 private:
  /// A_i F_ij by some columns j: `rows` has each entry's i.
  struct Columns {
    std::vector<std::size_t> starts;
    std::vector<std::uint32_t> rows;
    std::vector<float> flux;
  };
  void fluxByColumns(std::span<const double> areas, std::size_t first, std::size_t last, Columns& columns) const;
  struct SymmetricFlux;
  SymmetricFlux symmetricFlux(std::span<const double> areas, std::span<const std::uint32_t> sources,
                              double fewPixels) const;
  struct Scaling {
    std::vector<double> d;
    double error;  ///< largest relative error of a closed row's sum
  };
  Scaling symmetricScaling(std::span<const double> areas, const std::vector<bool>& closed) const;
  void turnIntoFactors(std::span<const double> areas, const std::vector<double>& d, const std::vector<bool>& closed);

  std::vector<std::size_t> starts_;
  std::vector<std::uint32_t> patches_;
  std::vector<float> factors_;
  std::vector<double> scales_;
};

/// The mean of A F and its transpose.
struct FormFactorMatrix::SymmetricFlux {
  FormFactorMatrix matrix;
  std::vector<double> rowSums;  ///< before rounding to floats
};

}  // namespace lucerna
