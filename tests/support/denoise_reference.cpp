#include "support/denoise_reference.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <utility>

namespace lucerna::test {

namespace {

constexpr std::size_t kRegressors = 11, kCandidates = 4;
using Fit = std::pair<std::vector<glm::dvec3>, std::vector<double>>;  // values, variances summed over channels

/// Solves a x = b by elimination with pivots; a free variable is 0.
std::vector<double> eliminate(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t pivot = i;
    for (std::size_t k = i; k < n; ++k)
      if (std::abs(a[k][i]) > std::abs(a[pivot][i])) pivot = k;
    std::swap(a[i], a[pivot]), std::swap(b[i], b[pivot]);
    if (std::abs(a[i][i]) < 1e-14) continue;
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = a[k][i] / a[i][i];
      for (std::size_t j = i; j < n; ++j) a[k][j] -= factor * a[i][j];
      b[k] -= factor * b[i];
    }
  }
  std::vector<double> x(n, 0.0);
  for (std::size_t i = n; i-- > 0;) {
    double sum = b[i];
    for (std::size_t j = i + 1; j < n; ++j) sum -= a[i][j] * x[j];
    x[i] = std::abs(a[i][i]) < 1e-14 ? 0.0 : sum / a[i][i];
  }
  return x;
}

class Reference {
 public:
  explicit Reference(const DenoiseInput& input)
      : in_(input), count_(static_cast<std::size_t>(input.width) * static_cast<std::size_t>(input.height)) {}

  DenoiseReference result();

 private:
  using Visit = std::function<void(std::size_t q, int dx, int dy)>;
  void around(std::size_t p, int radius, int stride, const Visit& visit) const {
    const int x = static_cast<int>(p) % in_.width, y = static_cast<int>(p) / in_.width;
    for (int j = -radius; j <= radius; ++j)
      for (int i = -radius; i <= radius; ++i) {
        const int u = x + stride * i, v = y + stride * j;
        if (u >= 0 && v >= 0 && u < in_.width && v < in_.height)
          visit(static_cast<std::size_t>(v * in_.width + u), stride * i, stride * j);
      }
  }
  double variance(std::size_t half, std::size_t p) const {
    const double n = in_.halves[half].samples[p];
    const glm::dvec3 s = in_.halves[half].squares[p];
    return n < 2.0 ? 0.0 : (s.x + s.y + s.z) / (n * (n - 1.0));
  }
  std::vector<double> variances(std::size_t half) const {
    std::vector<double> all(count_);
    for (std::size_t p = 0; p < count_; ++p) all[p] = variance(half, p);
    return all;
  }
  Fit fit(int radius, int stride, const Fit& values, const Fit* guide) const;
  std::vector<glm::dvec3> despeckled(std::size_t half, const Fit& narrow) const;

  const DenoiseInput& in_;
  std::size_t count_;
};

Fit Reference::fit(int radius, int stride, const Fit& values, const Fit* guide) const {
  Fit result{std::vector<glm::dvec3>(count_), std::vector<double>(count_)};
  for (std::size_t p = 0; p < count_; ++p) {
    std::vector<std::vector<double>> m(kRegressors, std::vector<double>(kRegressors, 0.0));
    struct Row {
      std::size_t q;
      double w;
      std::array<double, kRegressors> x;
    };
    std::vector<Row> rows;
    const auto& own = in_.features[p];
    around(p, radius, stride, [&](std::size_t q, int dx, int dy) {
      Row row{q, 0.0, {}};
      const auto& other = in_.features[q];
      row.x[0] = 1.0;
      row.x[1] = static_cast<double>(dx) / (radius * stride);
      row.x[2] = static_cast<double>(dy) / (radius * stride);
      for (std::size_t k = 0; k < 7; ++k) row.x[3 + k] = other[k] - own[k];
      row.x[10] = (other[7] - own[7]) / (other[7] + own[7] + 1e-30);
      constexpr std::array<double, kRegressors> kWidths{1.0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.3, 0.4, 0.4, 0.4, 0.15};
      double far = 0.0;
      for (std::size_t k = 1; k < kRegressors; ++k) far += std::pow(row.x[k] / kWidths[k], 2.0) / 2.0;
      if (guide) {
        double apart = 0.0, equal = 0.0;
        for (int c = 0; c < 3; ++c) {
          const double a = guide->first[p][c], b = guide->first[q][c];
          apart += (a - b) * (a - b);
          equal += std::pow(0.02 * (std::abs(a) + std::abs(b)) / 2.0, 2.0);
        }
        const double a = guide->second[p], b = guide->second[q];
        far += std::max(0.0, (apart - a - std::min(a, b)) / (equal + 0.49 * (a + b) + 1e-30));
      }
      row.w = std::exp(-far);
      for (std::size_t i = 0; i < kRegressors; ++i)
        for (std::size_t j = 0; j < kRegressors; ++j) m[i][j] += row.w * row.x[i] * row.x[j];
      rows.push_back(row);
    });
    for (std::size_t i = 1; i < kRegressors; ++i) m[i][i] += 1e-3 * m[0][0];
    std::vector<double> e(kRegressors, 0.0);
    e[0] = 1.0;
    const std::vector<double> z = eliminate(m, e);
    for (const Row& row : rows) {
      double share = 0.0;
      for (std::size_t i = 0; i < kRegressors; ++i) share += z[i] * row.x[i];
      share *= row.w;
      result.first[p] += share * values.first[row.q];
      result.second[p] += share * share * values.second[row.q];
    }
  }
  return result;
}

std::vector<glm::dvec3> Reference::despeckled(std::size_t half, const Fit& narrow) const {
  std::vector<glm::dvec3> result(count_);
  for (std::size_t p = 0; p < count_; ++p) {
    double others = 0.0, neighbours = 0.0;
    around(p, 7, 1, [&](std::size_t q, int, int) {
      if (q == p) return;
      others += variance(half, q);
      ++neighbours;
    });
    others /= std::max(neighbours, 1.0);
    const double own = variance(half, p), a = own * own, b = others * others;
    const double share = in_.halves[half].samples[p] < 2.0 ? 1.0 : a / (a + b + 1e-30);
    result[p] = in_.halves[half].mean[p] + share * (narrow.first[p] - in_.halves[half].mean[p]);
  }
  return result;
}

struct Terms {
  double variance = 0.0;
  std::array<double, kCandidates> c{};
  std::array<std::array<double, kCandidates>, kCandidates> g{};
};

double errorOf(const Terms& t, const std::array<double, kCandidates>& l) {
  double sum = t.variance;
  for (std::size_t i = 0; i < kCandidates; ++i) {
    sum += 2.0 * l[i] * t.c[i];
    for (std::size_t j = 0; j < kCandidates; ++j) sum += l[i] * l[j] * t.g[i][j];
  }
  return sum;
}

void add(Terms& to, double weight, const Terms& t) {
  for (std::size_t i = 0; i < kCandidates; ++i) {
    to.c[i] += weight * t.c[i];
    for (std::size_t j = 0; j < kCandidates; ++j) to.g[i][j] += weight * t.g[i][j];
  }
}

DenoiseReference Reference::result() {
  // The candidates, each of one half alone.
  std::array<std::array<std::vector<glm::dvec3>, kCandidates>, 2> candidates;
  const bool hasVariance = in_.halves[1].samples[0] >= 2.0;
  for (std::size_t half = 0; half < 2; ++half) {
    const Fit film{in_.halves[half].mean, variances(half)};
    const Fit narrow = fit(2, 1, film, nullptr), coloured = fit(7, 1, film, hasVariance ? &narrow : nullptr);
    candidates[half] = {fit(7, 3, coloured, hasVariance ? &coloured : nullptr).first, fit(7, 1, film, nullptr).first,
                        coloured.first, despeckled(half, narrow)};
  }

  DenoiseReference result;
  result.raw.resize(count_);
  result.picture.resize(count_);
  result.error.resize(count_);
  result.heldOut.resize(count_);
  result.rawError.resize(count_);
  result.shares.resize(count_);
  const auto shareOf = [&](std::size_t p) {
    return in_.halves[0].samples[p] / (in_.halves[0].samples[p] + in_.halves[1].samples[p]);
  };
  double mean = 0.0;
  for (std::size_t p = 0; p < count_; ++p) {
    const double s = shareOf(p);
    result.raw[p] = s * in_.halves[0].mean[p] + (1.0 - s) * in_.halves[1].mean[p];
    mean += (result.raw[p].x + result.raw[p].y + result.raw[p].z) / (3.0 * static_cast<double>(count_));
  }
  const auto changeAt = [&](std::size_t p, std::size_t i) {
    const double s = shareOf(p);
    return s * candidates[0][i][p] + (1.0 - s) * candidates[1][i][p] - result.raw[p];
  };
  const auto termsAt = [&](std::size_t p, bool relative) {
    Terms t;
    const double s = shareOf(p);
    for (int c = 0; c < 3; ++c) {
      std::array<double, 5> values{result.raw[p][c]};
      for (std::size_t i = 0; i < kCandidates; ++i) values[1 + i] = result.raw[p][c] + changeAt(p, i)[c];
      std::sort(values.begin(), values.end());
      const double w = relative ? 1.0 / (values[2] * values[2] + 0.01 * mean * mean + 1e-30) : 1.0;
      const double between = in_.halves[0].mean[p][c] - in_.halves[1].mean[p][c];
      t.variance += w * s * (1.0 - s) * between * between;
      for (std::size_t i = 0; i < kCandidates; ++i) {
        const double ofCandidate = candidates[0][i][p][c] - candidates[1][i][p][c];
        t.c[i] -= w * s * (1.0 - s) * between * (between - ofCandidate);
        for (std::size_t j = 0; j < kCandidates; ++j) t.g[i][j] += w * changeAt(p, i)[c] * changeAt(p, j)[c];
      }
    }
    return t;
  };
  std::vector<Terms> terms(count_);
  for (std::size_t p = 0; p < count_; ++p) terms[p] = termsAt(p, true);
  for (std::size_t p = 0; p < count_; ++p) {
    Terms others, all;
    around(p, 9, 1, [&](std::size_t q, int dx, int dy) {
      const double weight = std::exp(-(dx * dx + dy * dy) / (2.0 * 4.5 * 4.5));
      add(all, weight, terms[q]);
      if (q != p) add(others, weight, terms[q]);
    });
    result.shares[p] = bestShares(all.c, all.g);
    result.picture[p] = result.raw[p];
    for (std::size_t i = 0; i < kCandidates; ++i) result.picture[p] += result.shares[p][i] * changeAt(p, i);
    const Terms own = termsAt(p, false);
    result.rawError[p] = own.variance;
    result.error[p] = errorOf(own, result.shares[p]);
    result.heldOut[p] = errorOf(own, bestShares(others.c, others.g));
  }
  return result;
}

}  // namespace

std::array<double, 4> bestShares(const std::array<double, 4>& c, const std::array<std::array<double, 4>, 4>& g) {
  std::array<double, 4> best{};
  double least = 0.0;
  for (unsigned set = 1; set < 16; ++set)
    for (const bool full : {false, true}) {  // whether the sum is 1
      std::vector<std::size_t> in;
      for (std::size_t i = 0; i < 4; ++i)
        if (set >> i & 1u) in.push_back(i);
      const std::size_t n = in.size() + (full ? 1 : 0);
      std::vector<std::vector<double>> a(n, std::vector<double>(n, 0.0));
      std::vector<double> b(n, 0.0);
      for (std::size_t i = 0; i < in.size(); ++i) {
        for (std::size_t j = 0; j < in.size(); ++j) a[i][j] = g[in[i]][in[j]];
        b[i] = -c[in[i]];
        if (full) a[i][n - 1] = a[n - 1][i] = 1.0;
      }
      if (full) b[n - 1] = 1.0;
      const std::vector<double> x = eliminate(a, b);
      std::array<double, 4> l{};
      double sum = 0.0;
      bool fits = true;
      for (std::size_t i = 0; i < in.size(); ++i) {
        l[in[i]] = x[i];
        sum += x[i];
        fits = fits && std::isfinite(x[i]) && x[i] >= -1e-12;
      }
      if (!fits || sum > 1.0 + 1e-9) continue;
      double value = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        value += 2.0 * c[i] * l[i];
        for (std::size_t j = 0; j < 4; ++j) value += l[i] * l[j] * g[i][j];
      }
      if (value < least) least = value, best = l;
    }
  return best;
}

DenoiseInput denoiseInput(const Film& film, const std::vector<glm::vec4>& colours,
                          const std::vector<glm::vec4>& places) {
  DenoiseInput input;
  input.width = film.size.x;
  input.height = film.size.y / 2;
  const std::vector<FilmPixel> pixels = film.pixels();
  const std::size_t count = pixels.size() / 2;
  for (std::size_t half = 0; half < 2; ++half)
    for (std::size_t p = 0; p < count; ++p) {
      const FilmPixel& pixel = pixels[half * count + p];
      input.halves[half].mean.emplace_back(pixel.mean);
      input.halves[half].squares.emplace_back(pixel.m2);
      input.halves[half].samples.push_back(pixel.samples);
    }
  for (std::size_t p = 0; p < count; ++p) {
    std::array<double, 8> f{};
    for (int k = 0; k < 4; ++k) {
      f[static_cast<std::size_t>(k)] = static_cast<double>(colours[p][k]);
      f[static_cast<std::size_t>(4 + k)] = static_cast<double>(places[p][k]);
    }
    input.features.push_back(f);
  }
  return input;
}

DenoiseReference denoise(const DenoiseInput& input) { return Reference(input).result(); }

}  // namespace lucerna::test
