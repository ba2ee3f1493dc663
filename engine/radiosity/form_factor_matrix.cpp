#include "radiosity/form_factor_matrix.hpp"

#include "base/error.hpp"
#include "base/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

void FormFactorMatrix::appendRow(std::span<const std::uint32_t> patches, std::span<const float> factors) {
  CHECK(patches.size() == factors.size(), "{} patches, {} factors", patches.size(), factors.size());
  patches_.insert(patches_.end(), patches.begin(), patches.end());
  factors_.insert(factors_.end(), factors.begin(), factors.end());
  starts_.push_back(patches_.size());
  scales_.push_back(1.0);
}

FormFactorMatrix::Row FormFactorMatrix::row(std::size_t i) const {
  const std::size_t size = starts_[i + 1] - starts_[i];
  return {{patches_.data() + starts_[i], size}, {factors_.data() + starts_[i], size}, scales_[i]};
}

void FormFactorMatrix::multiply(std::span<const glm::dvec3> x, std::span<glm::dvec3> y) const {
  CHECK(x.size() == rowCount() && y.size() == rowCount(), "{} rows, vectors of {} and {}", rowCount(), x.size(),
        y.size());
  onAllCores(rowCount(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      glm::dvec3 sum(0.0);
      for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k)
        sum += static_cast<double>(factors_[k]) * x[patches_[k]];
      y[i] = scales_[i] * sum;
    }
  });
}

std::vector<double> FormFactorMatrix::rowSums() const {
  std::vector<double> sums(rowCount(), 0.0);
  for (std::size_t i = 0; i < rowCount(); ++i)
    for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k) sums[i] += scales_[i] * static_cast<double>(factors_[k]);
  return sums;
}

double FormFactorMatrix::repair(std::span<const double> areas, std::span<const double> sums,
                                std::span<const std::uint32_t> sources, double fewPixels) {
  const auto isSource = [&](std::size_t i) { return !sources.empty() && sources[i] != 0; };
  const std::size_t n = rowCount();
  // The transposed matrix; its rows come out in order, as the rows are visited in order.
  std::vector<std::size_t> starts(n + 1, 0);
  for (const std::uint32_t j : patches_) ++starts[j + 1];
  for (std::size_t i = 0; i < n; ++i) starts[i + 1] += starts[i];
  std::vector<std::uint32_t> from(patches_.size());
  std::vector<float> flux(patches_.size());  // A_i F_ij
  {
    std::vector<std::size_t> at(starts.begin(), starts.end() - 1);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k) {
        const std::size_t place = at[patches_[k]]++;
        from[place] = static_cast<std::uint32_t>(i);
        flux[place] = static_cast<float>(areas[i] * static_cast<double>(factors_[k]));
      }
  }
  FormFactorMatrix mean;  // of A F and its transpose
  std::vector<bool> known(n);  // whether the row sum is known: closed rows
  std::vector<std::uint32_t> patches;
  std::vector<float> values;
  for (std::size_t i = 0; i < n; ++i) {
    patches.clear();
    values.clear();
    double whole = 0.0;
    std::size_t a = starts_[i], b = starts[i];
    while (a < starts_[i + 1] || b < starts[i + 1]) {
      const std::uint32_t ja = a < starts_[i + 1] ? patches_[a] : ~0u, jb = b < starts[i + 1] ? from[b] : ~0u,
                          j = std::min(ja, jb);
      // In float as in the transposed copy, and in the order of patches, so that S_ij and S_ji have the same bits.
      const double own = ja == j ? static_cast<double>(static_cast<float>(areas[i] * static_cast<double>(factors_[a])))
                                 : 0.0,
                   other = jb == j ? static_cast<double>(flux[b]) : 0.0;
      // Weight of the row's own entry. Both sums add the same numbers in the same order.
      double weight = areas[j] / (areas[i] + areas[j]), against = areas[i] / (areas[i] + areas[j]);
      if (isSource(i) != isSource(j) && std::max(own, other) < fewPixels * areas[isSource(i) ? i : j])
        weight = isSource(j) ? 1.0 : 0.0, against = 1.0 - weight;
      const double sum = i < j ? weight * own + against * other : against * other + weight * own;
      whole += sum;
      a += ja == j;
      b += jb == j;
      patches.push_back(j);
      values.push_back(static_cast<float>(sum));
    }
    mean.appendRow(patches, values);
    known[i] = sums[i] >= 1.0 || whole > areas[i];
  }
  flux = {};
  from = {};
  // d_i sum_j S_ij d_j = A_i if the sum is known, else d_i = 1.
  std::vector<double> d(n, 1.0), next(n);
  double worst = 0.0;
  constexpr int kMost = 200;
  constexpr double kEnough = 1e-9;
  for (int step = 0; step < kMost; ++step) {
    worst = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      next[i] = d[i];
      if (!known[i]) continue;
      double sum = 0.0;
      for (std::size_t k = mean.starts_[i]; k < mean.starts_[i + 1]; ++k)
        sum += static_cast<double>(mean.factors_[k]) * d[mean.patches_[k]];
      if (sum <= 0.0) continue;
      next[i] = std::sqrt(d[i] * areas[i] / sum);
      worst = std::max(worst, std::abs(areas[i] / (d[i] * sum) - 1.0));
    }
    if (worst < kEnough) break;
    d = next;
  }
  onAllCores(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = mean.starts_[i]; k < mean.starts_[i + 1]; ++k)
        mean.factors_[k] =
            static_cast<float>(static_cast<double>(mean.factors_[k]) * d[i] * d[mean.patches_[k]] / areas[i]);
  });
  *this = std::move(mean);
  const std::vector<double> are = rowSums();
  for (std::size_t i = 0; i < n; ++i) scales_[i] = are[i] > 0.0 && (known[i] || are[i] > 1.0) ? 1.0 / are[i] : 1.0;
  return worst;
}

double FormFactorMatrix::reciprocityError(std::span<const double> areas) const {
  double sum = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < rowCount(); ++i)
    for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k) {
      const std::uint32_t j = patches_[k];
      const double there = areas[i] * static_cast<double>(factors_[k]);
      const Row other = row(j);
      const auto found = std::lower_bound(other.patches.begin(), other.patches.end(), static_cast<std::uint32_t>(i));
      const bool is = found != other.patches.end() && *found == i;
      const double back =
          is ? areas[j] * static_cast<double>(other.factors[static_cast<std::size_t>(found - other.patches.begin())])
             : 0.0;
      sum += there;
      worst = std::max(worst, std::abs(there - back));
    }
  return sum > 0.0 ? worst * static_cast<double>(entryCount()) / sum : 0.0;
}

}  // namespace lucerna
