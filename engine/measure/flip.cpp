#include "measure/flip.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"
#include "base/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lucerna::measure {

namespace {

// ---------------------------------------------------------------------------------------------------- colour spaces

/// Linear sRGB to XYZ, IEC 61966-2-1; rows.
constexpr std::array<std::array<double, 3>, 3> kXyzFromRgb{
    {{10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0},
     {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
     {1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0}}};

glm::dvec3 times(const std::array<std::array<double, 3>, 3>& m, const glm::dvec3& v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

std::array<std::array<double, 3>, 3> inverse(const std::array<std::array<double, 3>, 3>& m) {
  const auto cofactor = [&](std::size_t r, std::size_t c) {
    const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
  };
  const double determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  std::array<std::array<double, 3>, 3> result;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) result[r][c] = cofactor(c, r) / determinant;
  return result;
}

const std::array<std::array<double, 3>, 3> kRgbFromXyz = inverse(kXyzFromRgb);
const glm::dvec3 kWhite = times(kXyzFromRgb, glm::dvec3(1.0));

/// YCxCz, a linear relative of CIELAB [Andersson2020, 4.1.1].
glm::dvec3 ycxczFromRgb(const glm::dvec3& rgb) {
  const glm::dvec3 t = times(kXyzFromRgb, rgb) / kWhite;
  return {116.0 * t.y - 16.0, 500.0 * (t.x - t.y), 200.0 * (t.y - t.z)};
}
glm::dvec3 rgbFromYcxcz(const glm::dvec3& c) {
  const double y = (c.x + 16.0) / 116.0;
  return times(kRgbFromXyz, kWhite * glm::dvec3(y + c.y / 500.0, y, y - c.z / 200.0));
}

glm::dvec3 labFromRgb(const glm::dvec3& rgb) {
  const glm::dvec3 t = times(kXyzFromRgb, rgb) / kWhite;
  const auto f = [](double v) {
    constexpr double kDelta = 6.0 / 29.0;
    return v > kDelta * kDelta * kDelta ? std::cbrt(v) : v / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
  };
  return {116.0 * f(t.y) - 16.0, 500.0 * (f(t.x) - f(t.y)), 200.0 * (f(t.y) - f(t.z))};
}

/// Chroma grows with luminance (Hunt) [Andersson2020, 4.1.2].
glm::dvec3 huntLab(const glm::dvec3& rgb) {
  const glm::dvec3 lab = labFromRgb(rgb);
  return {lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z};
}
double hyab(const glm::dvec3& a, const glm::dvec3& b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

// ---------------------------------------------------------------------------------------------------- filters

using Plane = std::vector<glm::dvec3>;
/// A centred odd kernel along one axis.
using Kernel = std::vector<double>;

struct Size {
  int width, height;
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(std::clamp(x, 0, width - 1));
  }
};

/// Each component with its own kernel, along x or along y.
Plane convolve(const Plane& in, Size size, const std::array<const Kernel*, 3>& kernels, bool alongX) {
  Plane out(in.size());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const Kernel& kernel = *kernels[static_cast<std::size_t>(c)];
        const int radius = static_cast<int>(kernel.size() / 2);
        double sum = 0.0;
        for (int k = -radius; k <= radius; ++k)
          sum += kernel[static_cast<std::size_t>(k + radius)] * in[alongX ? size.at(x + k, y) : size.at(x, y + k)][c];
        out[size.at(x, y)][c] = sum;
      }
  return out;
}
Plane convolve(const Plane& in, Size size, const std::array<const Kernel*, 3>& x,
               const std::array<const Kernel*, 3>& y) {
  return convolve(convolve(in, size, x, true), size, y, false);
}

Kernel gaussian(double sigma, int radius) {
  Kernel kernel;
  double sum = 0.0;
  for (int k = -radius; k <= radius; ++k) sum += kernel.emplace_back(std::exp(-0.5 * k * k / (sigma * sigma)));
  for (double& w : kernel) w /= sum;
  return kernel;
}

/// Scales positive weights to sum to 1 and negative ones to -1, like those of the two-dimensional filter
/// [Andersson2020, 4.2.1]: the other axis' Gaussian sums to 1.
Kernel balanced(Kernel kernel) {
  double positive = 0.0, negative = 0.0;
  for (double w : kernel) (w > 0.0 ? positive : negative) += std::abs(w);
  for (double& w : kernel) w /= w > 0.0 ? positive : negative;
  return kernel;
}

// ---------------------------------------------------------------------------------------------------- the two
// pipelines

/// A picture filtered by the eye's contrast sensitivity [Andersson2020, table 1]: a sum of Gaussians a sqrt(pi/b)
/// exp(-pi^2 x^2 / b), x in degrees.
Plane seen(const Plane& ycxcz, Size size, double ppd) {
  struct Term {
    double a, b;
  };
  constexpr Term kAchromatic{1.0, 0.0047}, kRedGreen{1.0, 0.0053}, kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};
  const auto sigma = [&](const Term& t) { return std::sqrt(t.b / (2.0 * kPi * kPi)) * ppd; };
  const int radius = static_cast<int>(std::ceil(3.0 * sigma(kBlueYellow[0])));  // the same for all
  const Kernel y = gaussian(sigma(kAchromatic), radius), cx = gaussian(sigma(kRedGreen), radius);
  const Kernel first = gaussian(sigma(kBlueYellow[0]), radius), second = gaussian(sigma(kBlueYellow[1]), radius);
  Plane result = convolve(ycxcz, size, {&y, &cx, &first}, {&y, &cx, &first});
  const Plane narrow = convolve(ycxcz, size, {&second, &second, &second}, {&second, &second, &second});
  // In two dimensions a term weighs a sqrt(pi/b) times its Gaussian's sum, which is that of exp(-pi^2 (x^2 + y^2) / b):
  // b / pi where it is sampled finely.
  const auto weight = [&](const Term& t) {
    double sum = 0.0;
    for (int k = -radius; k <= radius; ++k) sum += std::exp(-kPi * kPi * (k / ppd) * (k / ppd) / t.b);
    return t.a * std::sqrt(kPi / t.b) * sum * sum;
  };
  const double w0 = weight(kBlueYellow[0]), w1 = weight(kBlueYellow[1]);
  for (std::size_t i = 0; i < result.size(); ++i) result[i].z = (w0 * result[i].z + w1 * narrow[i].z) / (w0 + w1);
  return result;
}

double colourDifference(const glm::dvec3& a, const glm::dvec3& b) {
  constexpr double kPower = 0.7, kSplit = 0.4, kAtSplit = 0.95;
  static const double largest = std::pow(hyab(huntLab({0.0, 1.0, 0.0}), huntLab({0.0, 0.0, 1.0})), kPower);
  const auto shown = [](const glm::dvec3& c) { return huntLab(glm::clamp(rgbFromYcxcz(c), 0.0, 1.0)); };
  const double error = std::pow(hyab(shown(a), shown(b)), kPower), split = kSplit * largest;
  return error < split ? kAtSplit / split * error : kAtSplit + (error - split) / (largest - split) * (1.0 - kAtSplit);
}

/// Edge and point strength of the achromatic channel [Andersson2020, 4.2].
struct Features {
  std::vector<double> edge, point;
};
Features featuresOf(const Plane& ycxcz, Size size, double ppd) {
  constexpr double kWidth = 0.082;  // degrees
  const double sigma = 0.5 * kWidth * ppd;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  Plane luminance(ycxcz.size());
  for (std::size_t i = 0; i < luminance.size(); ++i) luminance[i] = glm::dvec3((ycxcz[i].x + 16.0) / 116.0);
  Kernel first, second;
  for (int k = -radius; k <= radius; ++k) {
    const double g = std::exp(-0.5 * k * k / (sigma * sigma));
    first.push_back(-k * g);
    second.push_back((k * k / (sigma * sigma) - 1.0) * g);
  }
  first = balanced(first);
  second = balanced(second);
  const Kernel smooth = gaussian(sigma, radius);
  // x: d/dx, y: d2/dx2, z: unused; then the same along y.
  const Plane alongX = convolve(luminance, size, {&first, &second, &smooth}, {&smooth, &smooth, &smooth});
  const Plane alongY = convolve(luminance, size, {&smooth, &smooth, &smooth}, {&first, &second, &smooth});
  Features features;
  for (std::size_t i = 0; i < luminance.size(); ++i) {
    features.edge.push_back(std::hypot(alongX[i].x, alongY[i].x));
    features.point.push_back(std::hypot(alongX[i].y, alongY[i].y));
  }
  return features;
}

glm::dvec3 toneMapped(const glm::dvec3& radiance) {
  const glm::dvec3 lit = glm::max(radiance, 0.0);
  return {filmic(lit.x), filmic(lit.y), filmic(lit.z)};
}

double luminanceOf(const glm::vec3& c) { return times(kXyzFromRgb, glm::dvec3(c)).y; }

}  // namespace

Flip flipLdr(const Image& image, const Image& reference, double ppd) {
  if (image.width != reference.width || image.height != reference.height || image.pixels.empty())
    throwBadInput("pictures of {}x{} and {}x{}: FLIP needs pictures of the same size", image.width, image.height,
                  reference.width, reference.height);
  const Size size{image.width, image.height};
  const auto convert = [](const Image& in) {
    Plane out;
    for (const glm::vec3& p : in.pixels) out.push_back(ycxczFromRgb(glm::clamp(glm::dvec3(p), 0.0, 1.0)));
    return out;
  };
  const Plane a = convert(image), b = convert(reference);
  const Plane seenA = seen(a, size, ppd), seenB = seen(b, size, ppd);
  const Features fa = featuresOf(a, size, ppd), fb = featuresOf(b, size, ppd);
  Flip flip;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double feature = std::max(std::abs(fa.edge[i] - fb.edge[i]), std::abs(fa.point[i] - fb.point[i]));
    const double value =
        std::pow(colourDifference(seenA[i], seenB[i]), 1.0 - std::sqrt(feature * std::numbers::sqrt2 / 2.0));
    flip.map.push_back(static_cast<float>(value));
    flip.mean += value / static_cast<double>(a.size());
  }
  return flip;
}

FlipExposures flipExposures(const Image& reference) {
  // Radiance that the curve maps to 0.85: the larger root of (2.51 - 0.85 2.43) x^2 + (0.03 - 0.85 0.59) x - 0.85 0.14,
  // x = 0.6 radiance [Andersson2021, 3].
  constexpr double kTarget = 0.85;
  const double a = 2.51 - kTarget * 2.43, b = 0.03 - kTarget * 0.59, c = -kTarget * 0.14;
  const double bright = (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a) / 0.6;
  std::vector<double> luminance;
  for (const glm::vec3& p : reference.pixels) luminance.push_back(std::max(0.0, luminanceOf(p)));
  FlipExposures exposures;
  const double largest = percentile(luminance, 1.0);
  if (!(largest > 0.0)) return exposures;
  const double middle =
      std::max(median(luminance), largest * std::exp2(-16.0));  // a half-black picture would need infinite exposure
  exposures.start = std::log2(bright / largest);
  exposures.stop = std::log2(bright / middle);
  exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.stop - exposures.start)));
  return exposures;
}

Flip flipHdr(const Image& image, const Image& reference, double ppd) {
  const FlipExposures exposures = flipExposures(reference);
  Flip flip;
  flip.map.assign(reference.pixels.size(), 0.0f);
  for (int i = 0; i < exposures.count; ++i) {
    const double stops = exposures.start + (exposures.stop - exposures.start) * i / (exposures.count - 1);
    const auto expose = [&](const Image& in) {
      Image out(in.width, in.height);
      for (std::size_t p = 0; p < in.pixels.size(); ++p)
        out.pixels[p] = glm::vec3(toneMapped(std::exp2(stops) * glm::dvec3(in.pixels[p])));
      return out;
    };
    const Flip one = flipLdr(expose(image), expose(reference), ppd);
    for (std::size_t p = 0; p < flip.map.size(); ++p) flip.map[p] = std::max(flip.map[p], one.map[p]);
  }
  for (float v : flip.map) flip.mean += static_cast<double>(v) / static_cast<double>(flip.map.size());
  return flip;
}

}  // namespace lucerna::measure
