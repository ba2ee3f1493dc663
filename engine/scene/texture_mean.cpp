#include "scene/texture_mean.hpp"

#include "scene/coat.hpp"

#include "scene/triangle_parts.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {
/// Bytes of the nearest texel; texture coordinates wrap.
const std::uint8_t* bytesAt(const Bitmap& bitmap, const glm::dvec2& uv) {
  const auto wrap = [](double t, int n) { return std::min(static_cast<int>((t - std::floor(t)) * n), n - 1); };
  const int x = wrap(uv.x, bitmap.width), y = bitmap.height - 1 - wrap(uv.y, bitmap.height);
  return bitmap.rgba.data() +
         4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(bitmap.width) + static_cast<std::size_t>(x));
}

glm::dvec3 texelAt(const Bitmap& bitmap, const glm::dvec2& uv) {
  const std::uint8_t* texel = bytesAt(bitmap, uv);
  glm::dvec3 value;
  for (int c = 0; c < 3; ++c) value[c] = static_cast<double>(linearFromSrgb(static_cast<float>(texel[c]) / 255.0f));
  return value;
}

}  // namespace

glm::dvec3 meanColour(const Bitmap& bitmap) {
  std::array<double, 256> values{};
  for (std::size_t i = 0; i < 256; ++i) values[i] = static_cast<double>(linearFromSrgb(static_cast<float>(i) / 255.0f));
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < bitmap.rgba.size(); i += 4)
    sum += glm::dvec3(values[bitmap.rgba[i]], values[bitmap.rgba[i + 1]], values[bitmap.rgba[i + 2]]);
  return sum / static_cast<double>(bitmap.rgba.size() / 4);
}

namespace {
template <class F>
glm::dvec3 meanOverParts(const std::array<glm::vec2, 3>& uv, const F& valueAt) {
  static const std::vector<glm::dvec2> centroids = partCentroids(8);
  glm::dvec3 sum(0.0);
  for (const glm::dvec2& w : centroids)
    sum += valueAt((1.0 - w.x - w.y) * glm::dvec2(uv[0]) + w.x * glm::dvec2(uv[1]) + w.y * glm::dvec2(uv[2]));
  return sum / static_cast<double>(centroids.size());
}
}  // namespace

glm::dvec3 meanTexture(const Bitmap& bitmap, const std::array<glm::vec2, 3>& uv) {
  return meanOverParts(uv, [&](const glm::dvec2& at) { return texelAt(bitmap, at); });
}

glm::dvec3 meanAlbedo(const Scene& scene, const Material& material, const std::array<glm::vec2, 3>& uv) {
  const auto bitmap = [&](int texture) {
    return texture >= 0 ? &scene.textures[static_cast<std::size_t>(texture)].bitmap : nullptr;
  };
  const Bitmap* colour = bitmap(material.diffuseTexture);
  Material mean = material;
  if (!material.metalMap) {
    if (colour) mean.diffuse *= glm::vec3(meanTexture(*colour, uv));
    return glm::dvec3(wholeReflectance(mean));
  }
  const MetalMap& map = *material.metalMap;
  const Bitmap* metal = bitmap(map.texture);
  const auto metallicAt = [&](const glm::dvec2& at) {
    return static_cast<double>(map.metallic) * (metal ? bytesAt(*metal, at)[2] / 255.0 : 1.0);
  };
  const auto colourAt = [&](const glm::dvec2& at) {
    return glm::dvec3(map.base) * (colour ? texelAt(*colour, at) : glm::dvec3(1.0));
  };
  mean.diffuse =
      glm::vec3(meanOverParts(uv, [&](const glm::dvec2& at) { return colourAt(at) * (1.0 - metallicAt(at)); }));
  if (map.roughness >= 0.0f)
    mean.specular = glm::vec3(meanOverParts(
        uv, [&](const glm::dvec2& at) { return glm::mix(glm::dvec3(0.04), colourAt(at), metallicAt(at)); }));
  return glm::dvec3(wholeReflectance(mean));
}

}  // namespace lucerna
