// Means of pictures, for techniques that do not read single texels (no GL).
#pragma once

#include "base/image.hpp"
#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>

namespace lucerna {

/// Mean over all texels of an sRGB-encoded picture, linear.
glm::dvec3 meanColour(const Bitmap& bitmap);
/// The place in a picture, 0..1, that a texture coordinate shows.
double wrapped(double coordinate, TextureWrap wrap);
/// The four bytes of the texel nearest to texture coordinates.
const std::uint8_t* nearestTexel(const Texture& texture, const glm::dvec2& uv);
/// Mean over a triangle of texture coordinates: nearest texels at the centroids of 64 equal parts; linear.
glm::dvec3 meanTexture(const Texture& texture, const std::array<glm::vec2, 3>& uv);
/// Mean albedo of a triangle with a material, from the pictures of its colour and of its metallic share, sampled at the
/// same points.
glm::dvec3 meanAlbedo(const Scene& scene, const Material& material, const std::array<glm::vec2, 3>& uv);

}  // namespace lucerna
