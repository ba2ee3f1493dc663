#include "scene/texture_mean.hpp"

#include "scene/triangle_parts.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {
/// Linear value of a texture where texture coordinates wrap; nearest texel.
glm::dvec3 texelAt(const Bitmap& bitmap, const glm::dvec2& uv) {
  const auto wrap = [](double t, int n) { return std::min(static_cast<int>((t - std::floor(t)) * n), n - 1); };
  const int x = wrap(uv.x, bitmap.width), y = bitmap.height - 1 - wrap(uv.y, bitmap.height);
  const std::uint8_t* texel = bitmap.rgba.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(bitmap.width) + static_cast<std::size_t>(x));
  glm::dvec3 value;
  for (int c = 0; c < 3; ++c) value[c] = static_cast<double>(linearFromSrgb(static_cast<float>(texel[c]) / 255.0f));
  return value;
}

}  // namespace

glm::dvec3 meanColour(const Bitmap& bitmap) {
  std::array<double, 256> values{};
  for (std::size_t i = 0; i < 256; ++i) values[i] = static_cast<double>(linearFromSrgb(static_cast<float>(i) / 255.0f));
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < bitmap.rgba.size(); i += 4) sum += glm::dvec3(values[bitmap.rgba[i]], values[bitmap.rgba[i + 1]], values[bitmap.rgba[i + 2]]);
  return sum / static_cast<double>(bitmap.rgba.size() / 4);
}

glm::dvec3 meanTexture(const Bitmap& bitmap, const std::array<glm::vec2, 3>& uv) {
  static const std::vector<glm::dvec2> centroids = partCentroids(8);
  glm::dvec3 sum(0.0);
  for (const glm::dvec2& w : centroids) sum += texelAt(bitmap, (1.0 - w.x - w.y) * glm::dvec2(uv[0]) + w.x * glm::dvec2(uv[1]) + w.y * glm::dvec2(uv[2]));
  return sum / static_cast<double>(centroids.size());
}

}  // namespace lucerna
