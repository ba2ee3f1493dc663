#include "measure/heat_map.hpp"

#include "base/error.hpp"
#include "base/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace lucerna::measure {

namespace {

using Colour = std::array<double, 3>;  // sRGB-encoded, 0..255

// Evenly spaced stops; lightness increases (or increases towards white from both sides), so that they remain readable
// in grey.
constexpr Colour kAbsolute[] = {{0, 0, 0},      {66, 10, 74},    {147, 26, 72},  {222, 66, 37},
                                {250, 146, 14}, {252, 228, 120}, {255, 255, 255}};
constexpr Colour kSigned[] = {{8, 48, 120},    {52, 122, 190}, {150, 199, 226}, {247, 247, 247},
                              {246, 178, 144}, {206, 74, 64},  {110, 4, 28}};
constexpr Colour kNotFinite{0, 255, 0};

Colour colourAt(std::span<const Colour> stops, double t) {
  if (std::isnan(t)) return kNotFinite;
  const double position = std::clamp(t, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const std::size_t lower = std::min(static_cast<std::size_t>(position), stops.size() - 2);
  const double f = position - static_cast<double>(lower);
  Colour result;
  for (std::size_t c = 0; c < 3; ++c) result[c] = stops[lower][c] * (1.0 - f) + stops[lower + 1][c] * f;
  return result;
}

Colour colourOf(HeatMap kind, double t) {
  return kind == HeatMap::absolute ? colourAt(kAbsolute, t) : colourAt(kSigned, 0.5 + 0.5 * t);
}

double difference(HeatMap kind, const glm::vec3& a, const glm::vec3& b) {
  const glm::dvec3 d = glm::dvec3(a) - glm::dvec3(b);
  const double luminance = 0.2126 * d.x + 0.7152 * d.y + 0.0722 * d.z;
  if (!std::isfinite(luminance)) return std::numeric_limits<double>::quiet_NaN();
  return kind == HeatMap::absolute ? std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) : luminance;
}

void put(Bitmap& bitmap, const Colour& colour) {
  for (double c : colour) bitmap.rgba.push_back(static_cast<std::uint8_t>(std::lround(c)));
  bitmap.rgba.push_back(255);
}

void checkSameSize(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throwBadInput("pictures of {}x{} and {}x{}: pictures must have the same size", a.width, a.height, b.width,
                  b.height);
}

}  // namespace

double heatMapScale(const Image& image, const Image& reference) {
  checkSameSize(image, reference);
  std::vector<double> differences;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const double d = difference(HeatMap::absolute, image.pixels[i], reference.pixels[i]);
    if (!std::isnan(d)) differences.push_back(d);
  }
  const double high = percentile(differences, 0.99),
               largest = differences.empty() ? 0.0 : *std::max_element(differences.begin(), differences.end());
  const double value = high > 0.0 ? high : largest;
  if (!(value > 0.0)) return 0.0;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (double step : {1.0, 2.0, 5.0})
    if (value <= step * power * (1.0 + 1e-12)) return step * power;
  return 10.0 * power;
}

Bitmap heatMap(const Image& image, const Image& reference, HeatMap kind, double scale) {
  checkSameSize(image, reference);
  CHECK(scale > 0.0, "scale = {}", scale);
  Bitmap bitmap;
  bitmap.width = image.width;
  bitmap.height = image.height;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    put(bitmap, colourOf(kind, difference(kind, image.pixels[i], reference.pixels[i]) / scale));
  return bitmap;
}

Bitmap heatMapLegend(HeatMap kind, int width, int height) {
  Bitmap bitmap;
  bitmap.width = width;
  bitmap.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double t = width > 1 ? static_cast<double>(x) / (width - 1) : 0.0;
      put(bitmap, colourOf(kind, kind == HeatMap::absolute ? t : 2.0 * t - 1.0));
    }
  return bitmap;
}

}  // namespace lucerna::measure
