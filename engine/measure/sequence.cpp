#include "measure/sequence.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
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

/// Number of a pixel's square.
std::size_t squareOf(const Image& image, std::size_t pixel) {
  constexpr std::size_t kSide = 16;
  const auto width = static_cast<std::size_t>(image.width), across = (width + kSide - 1) / kSide;
  return pixel / width / kSide * across + pixel % width / kSide;
}

/// Sums of pictures P and references R, which are late by some moments, over moments and pixels.
struct Sums {
  double pp = 0.0, pr = 0.0, rr = 0.0;  ///< rr: less R's noise
  double noise = 0.0, noisePR2 = 0.0;  ///< of R^2; of the square of pr

  /// Adds the moments of [first, last] to of(pixel), an array of three channels.
  template <class Of>
  static void add(std::span<const Image> pictures, std::span<const Reference> references, double late, int first,
                  int last, const Of& of) {
    const auto count = static_cast<int>(pictures.size());
    for (int k = first; k <= last; ++k) {
      const double place = std::clamp(k - late, 0.0, static_cast<double>(count - 1));
      const auto a = static_cast<std::size_t>(std::min(static_cast<int>(place), count - 2));
      const double u = place - static_cast<double>(a);
      const Image& picture = pictures[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        std::array<Sums, 3>& channels = of(i);
        for (int c = 0; c < 3; ++c) {
          Sums& sums = channels[static_cast<std::size_t>(c)];
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
    }
  }
  bool isKnown() const { return rr > noise && rr > 0.0; }
  /// 1 where references are dark, or have noise alone.
  double gain() const { return isKnown() ? pr / rr : 1.0; }
  /// sum |P - g R|^2 with the best g; the square of pr has the mean of P^2 s^2 of noise.
  double misfit() const { return isKnown() ? pp - (pr * pr - noisePR2) / rr : 0.0; }
};

/// The moments that have a reference at each shift, from -1 to 4.
int firstOfAll(std::size_t count) { return std::min(4, static_cast<int>(count) - 2); }

/// Pictures explained by references that are late by some moments, each square and channel with its best gain.
std::vector<std::array<Sums, 3>> squaresAt(std::span<const Image> pictures, std::span<const Reference> references,
                                           double late) {
  const Image& image = pictures.front();
  std::vector<std::array<Sums, 3>> sums(squareOf(image, image.pixels.size() - 1) + 1);
  const auto last = static_cast<int>(pictures.size()) - 2;
  Sums::add(pictures, references, late, firstOfAll(pictures.size()), last,
            [&](std::size_t i) -> std::array<Sums, 3>& { return sums[squareOf(image, i)]; });
  return sums;
}

/// Of each pixel, over all moments that have a reference at that shift.
std::vector<std::array<Sums, 3>> pixelsAt(std::span<const Image> pictures, std::span<const Reference> references,
                                          double late) {
  std::vector<std::array<Sums, 3>> sums(pictures.front().pixels.size());
  const int last = static_cast<int>(pictures.size()) - (late < 0.0 ? 2 : 1);
  Sums::add(pictures, references, late, std::max(static_cast<int>(std::ceil(late)), 0), last,
            [&](std::size_t i) -> std::array<Sums, 3>& { return sums[i]; });
  return sums;
}

/// What has changed from each moment to the next, from `first` on: sum of squares, and that of its noise.
struct Change {
  double squares = 0.0, noise = 0.0;
  bool isSeen() const { return squares - noise > kBeyondNoise * noise && squares > noise; }
};

Change changeFrom(std::span<const Reference> references, std::span<const double> variances, std::size_t first) {
  Change change;
  for (std::size_t k = std::max(first, std::size_t{1}); k < references.size(); ++k) {
    const Image &r = references[k].mean, &before = references[k - 1].mean;
    change.squares += sumOver(r, [&](std::size_t i, int c) {
      const double d = at(before, i, c) - at(r, i, c);
      return d * d;
    });
    change.noise += variances[k] + variances[k - 1];
  }
  return change;
}

double ghosts(std::span<const Image> pictures, std::span<const Reference> references, double late) {
  const std::vector<std::array<Sums, 3>> sums = pixelsAt(pictures, references, late);
  double kept = 0.0, changed = 0.0;
  for (std::size_t k = 1; k < pictures.size(); ++k)
    for (std::size_t i = 0; i < pictures[k].pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double g = sums[i][static_cast<std::size_t>(c)].gain(), r = at(references[k].mean, i, c),
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

  errors.lag = errors.ghosts = kNone;
  double late = 0.0;
  if (pictures.size() >= 3 &&
      changeFrom(references, variances, static_cast<std::size_t>(firstOfAll(pictures.size()))).isSeen()) {
    constexpr double kStep = 0.05;
    double least = std::numeric_limits<double>::infinity();
    for (int step = -20; step <= 80; ++step) {
      double here = 0.0;
      for (const std::array<Sums, 3>& square : squaresAt(pictures, references, step * kStep))
        for (const Sums& channel : square) here += channel.misfit();
      if (here < least) least = here, errors.lag = late = step * kStep;
    }
  }
  // Two moments do not tell a pixel's gain from what it still shows.
  if (pictures.size() >= 3 && changeFrom(references, variances, 0).isSeen())
    errors.ghosts = ghosts(pictures, references, late);

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
