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

/// Number of a pixel's channel among those of all squares.
std::size_t squareOf(const Image& image, std::size_t pixel, int channel) {
  constexpr std::size_t kSide = 16;
  const auto width = static_cast<std::size_t>(image.width), across = (width + kSide - 1) / kSide;
  return 3 * (pixel / width / kSide * across + pixel % width / kSide) + static_cast<std::size_t>(channel);
}

std::size_t squares(const Image& image) { return squareOf(image, image.pixels.size() - 1, 2) + 1; }

/// Pictures explained by references that are late by some moments, each square and channel with its best gain.
struct Fit {
  double misfit = 0.0;  ///< sum |P - g R|^2 over the pictures that have a reference at each shift
  std::vector<double> gains;  ///< by squareOf; 1 where references are dark or have noise alone
};

// g = PR / RR for the sums PR of P R and RR of R^2 less R's noise s^2, and PP - PR^2 / RR is what is left; of the noise
// PR^2 has the mean of P^2 s^2.
Fit fit(std::span<const Image> pictures, std::span<const Reference> references, double moments) {
  struct Sums {
    double pp = 0.0, pr = 0.0, rr = 0.0, noise = 0.0, noisePR2 = 0.0;
  };
  const auto count = static_cast<int>(pictures.size());
  std::vector<Sums> all(squares(pictures.front()));
  constexpr int kEarliest = 1, kLatest = 4;
  for (int k = std::min(kLatest, count - 2); k + kEarliest < count; ++k) {
    const double place = std::clamp(k - moments, 0.0, static_cast<double>(count - 1));
    const auto a = static_cast<std::size_t>(std::min(static_cast<int>(place), count - 2));
    const double u = place - static_cast<double>(a);
    const Image& picture = pictures[static_cast<std::size_t>(k)];
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        Sums& sums = all[squareOf(picture, i, c)];
        const double p = at(picture, i, c),
                     r = (1.0 - u) * at(references[a].mean, i, c) + u * at(references[a + 1].mean, i, c),
                     sa = (1.0 - u) * at(references[a].standardError, i, c),
                     sb = u * at(references[a + 1].standardError, i, c), s2 = sa * sa + sb * sb;
        sums.pp += p * p;
        sums.pr += p * r;
        sums.rr += r * r - s2;
        sums.noise += s2;
        sums.noisePR2 += p * p * s2;
      }
  }
  Fit result;
  for (const Sums& sums : all) {
    const bool isKnown = sums.rr > sums.noise && sums.rr > 0.0;
    result.gains.push_back(isKnown ? sums.pr / sums.rr : 1.0);
    if (isKnown) result.misfit += sums.pp - (sums.pr * sums.pr - sums.noisePR2) / sums.rr;
  }
  return result;
}

double ghosts(std::span<const Image> pictures, std::span<const Reference> references,
              const std::vector<double>& gains) {
  double kept = 0.0, changed = 0.0;
  for (std::size_t k = 1; k < pictures.size(); ++k)
    for (std::size_t i = 0; i < pictures[k].pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double g = gains[squareOf(pictures[k], i, c)], r = at(references[k].mean, i, c),
                     change = at(references[k - 1].mean, i, c) - r, s = at(references[k].standardError, i, c),
                     before = at(references[k - 1].standardError, i, c);
        kept += g * (at(pictures[k], i, c) - g * r) * change - g * g * s * s;
        changed += g * g * (change * change - s * s - before * before);
      }
  return changed > 0.0 ? kept / changed : kNone;
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

  double changed = 0.0, changeNoise = 0.0;
  for (std::size_t k = 1; k < pictures.size(); ++k) {
    const Image &r = references[k].mean, &before = references[k - 1].mean;
    changed += sumOver(r, [&](std::size_t i, int c) {
      const double d = at(before, i, c) - at(r, i, c);
      return d * d;
    });
    changeNoise += variances[k] + variances[k - 1];
  }
  changed -= changeNoise;
  errors.lag = errors.ghosts = kNone;
  if (changed > kBeyondNoise * changeNoise && changed > 0.0) {
    std::vector<double> gains(squares(pictures.front()), 1.0);
    if (pictures.size() >= 3) {
      constexpr double kStep = 0.05;
      double least = std::numeric_limits<double>::infinity();
      for (int step = -20; step <= 80; ++step)
        if (Fit here = fit(pictures, references, step * kStep); here.misfit < least)
          least = here.misfit, errors.lag = step * kStep, gains = std::move(here.gains);
    }
    errors.ghosts = ghosts(pictures, references, gains);
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
