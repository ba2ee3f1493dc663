#include "measure/sequence.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna::measure {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// A change counts where it is this many times its own noise, both as sums of squares over all pictures.
constexpr double kBeyondNoise = 0.1;

template <class Term>
double sumOver(const Image& image, const Term& term) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) sum += term(i, c);
  return sum;
}

double at(const Image& image, std::size_t pixel, int channel) {
  return static_cast<double>(image.pixels[pixel][channel]);
}

double sumOfSquares(const Image& image) {
  return sumOver(image, [&](std::size_t i, int c) { return at(image, i, c) * at(image, i, c); });
}

/// sum |P_k - (1-u) R_a - u R_b|^2 over the pictures that have both, less noise, for a shift of `moments`.
double misfit(std::span<const Image> pictures, std::span<const Reference> references, std::span<const double> variances,
              double moments) {
  double sum = 0.0;
  const auto count = static_cast<int>(pictures.size());
  constexpr int kEarliest = 1, kLatest = 4;
  for (int k = std::min(kLatest, count - 2); k + kEarliest < count; ++k) {
    const double place = std::clamp(k - moments, 0.0, static_cast<double>(count - 1));
    const int a = std::min(static_cast<int>(place), count - 2);
    const double u = place - a;
    const Image &p = pictures[static_cast<std::size_t>(k)], &ra = references[static_cast<std::size_t>(a)].mean,
                &rb = references[static_cast<std::size_t>(a + 1)].mean;
    sum += sumOver(p, [&](std::size_t i, int c) {
      const double d = at(p, i, c) - (1.0 - u) * at(ra, i, c) - u * at(rb, i, c);
      return d * d;
    });
    sum -= (1.0 - u) * (1.0 - u) * variances[static_cast<std::size_t>(a)] +
           u * u * variances[static_cast<std::size_t>(a + 1)];
  }
  return sum;
}

}  // namespace

SequenceErrors sequenceErrors(std::span<const Image> pictures, std::span<const Reference> references) {
  CHECK(pictures.size() == references.size() && pictures.size() >= 2, "{} pictures of {} references", pictures.size(),
        references.size());
  SequenceErrors errors;
  std::vector<double> variances;  // of the references, sums over pixels and channels
  for (const Reference& r : references) variances.push_back(sumOfSquares(r.standardError));

  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const Image &p = pictures[k], &r = references[k].mean;
    CHECK(p.pixels.size() == r.pixels.size(), "pictures of {} and {} pixels", p.pixels.size(), r.pixels.size());
    const double squares = sumOver(p, [&](std::size_t i, int c) {
      const double d = at(p, i, c) - at(r, i, c);
      return d * d;
    });
    const double whole = std::max(sumOfSquares(r) - variances[k], 0.0);
    errors.l2.push_back(whole > 0.0 ? std::sqrt(std::max(squares - variances[k], 0.0) / whole)
                                    : (squares > variances[k] ? std::numeric_limits<double>::infinity() : 0.0));
    errors.mean += errors.l2.back() / static_cast<double>(pictures.size());
    errors.worst = std::max(errors.worst, errors.l2.back());
  }

  // What has just changed.
  double kept = 0.0, changed = 0.0, changeNoise = 0.0;
  for (std::size_t k = 1; k < pictures.size(); ++k) {
    const Image &p = pictures[k], &r = references[k].mean, &before = references[k - 1].mean;
    kept += sumOver(p, [&](std::size_t i,
                           int c) { return (at(p, i, c) - at(r, i, c)) * (at(before, i, c) - at(r, i, c)); }) -
            variances[k];
    changed += sumOver(p,
                       [&](std::size_t i, int c) {
                         const double d = at(before, i, c) - at(r, i, c);
                         return d * d;
                       }) -
               variances[k] - variances[k - 1];
    changeNoise += variances[k] + variances[k - 1];
  }
  const bool changes = changed > kBeyondNoise * changeNoise && changed > 0.0;
  errors.ghosts = changes ? kept / changed : kNone;

  // The best shift: by steps, then between its neighbours.
  errors.lag = kNone;
  if (changes && pictures.size() >= 3) {
    constexpr double kStep = 0.05;
    double least = std::numeric_limits<double>::infinity();
    for (int step = -20; step <= 80; ++step)
      if (const double here = misfit(pictures, references, variances, step * kStep); here < least)
        least = here, errors.lag = step * kStep;
  }

  errors.flicker = kNone;
  double ours = 0.0, theirs = 0.0, noise = 0.0;
  for (std::size_t k = 1; k + 1 < pictures.size(); ++k) {
    const auto second = [&](const Image& a, const Image& b, const Image& c) {
      return sumOver(b, [&](std::size_t i, int channel) {
        const double d = at(a, i, channel) - 2.0 * at(b, i, channel) + at(c, i, channel);
        return d * d;
      });
    };
    ours += second(pictures[k - 1], pictures[k], pictures[k + 1]);
    theirs += second(references[k - 1].mean, references[k].mean, references[k + 1].mean);
    noise += variances[k - 1] + 4.0 * variances[k] + variances[k + 1];
  }
  if (theirs - noise > kBeyondNoise * noise && theirs > noise) errors.flicker = std::sqrt(ours / (theirs - noise));
  return errors;
}

}  // namespace lucerna::measure
