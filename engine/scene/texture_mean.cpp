#include "scene/texture_mean.hpp"

#include "scene/coat.hpp"

#include "scene/triangle_parts.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

double wrapped(double coordinate, TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::edge: return std::clamp(coordinate, 0.0, 1.0);
    case TextureWrap::mirror: return 1.0 - std::abs(1.0 - (coordinate - 2.0 * std::floor(0.5 * coordinate)));
    case TextureWrap::repeat: break;
  }
  return coordinate - std::floor(coordinate);
}

const std::uint8_t* nearestTexel(const Texture& texture, const glm::dvec2& uv) {
  const Bitmap& bitmap = texture.bitmap;
  const auto texel = [](double t, TextureWrap wrap, int n) {
    return std::min(static_cast<int>(wrapped(t, wrap) * n), n - 1);
  };
  const int x = texel(uv.x, texture.wraps.u, bitmap.width),
            y = bitmap.height - 1 - texel(uv.y, texture.wraps.v, bitmap.height);
  return bitmap.rgba.data() +
         4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(bitmap.width) + static_cast<std::size_t>(x));
}

namespace {
glm::dvec3 texelAt(const Texture& texture, const glm::dvec2& uv) {
  const std::uint8_t* texel = nearestTexel(texture, uv);
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

glm::dvec3 meanTexture(const Texture& texture, const std::array<glm::vec2, 3>& uv) {
  return meanOverParts(uv, [&](const glm::dvec2& at) { return texelAt(texture, at); });
}

glm::dvec3 meanAlbedo(const Scene& scene, const Material& material, const std::array<glm::vec2, 3>& uv) {
  const auto textureOf = [&](int index) {
    return index >= 0 ? &scene.textures[static_cast<std::size_t>(index)] : nullptr;
  };
  const Texture* colour = textureOf(material.diffuseTexture);
  Material mean = material;
  if (!material.metalMap) {
    if (colour) mean.diffuse *= glm::vec3(meanTexture(*colour, uv));
    return glm::dvec3(wholeReflectance(mean));
  }
  const MetalMap& map = *material.metalMap;
  const Texture* metal = textureOf(map.texture);
  const auto metallicAt = [&](const glm::dvec2& at) {
    return static_cast<double>(map.metallic) * (metal ? nearestTexel(*metal, at)[2] / 255.0 : 1.0);
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
