// Means of pictures, for techniques that do not read single texels (no GL).
#pragma once

#include "base/image.hpp"
#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <array>

namespace lucerna {

/// Mean over all texels of an sRGB-encoded picture, linear.
glm::dvec3 meanColour(const Bitmap& bitmap);
/// Mean over a triangle of texture coordinates, which wrap: nearest texels at the centroids of 64 equal parts; linear.
glm::dvec3 meanTexture(const Bitmap& bitmap, const std::array<glm::vec2, 3>& uv);
/// Mean albedo of a triangle with a material, from the pictures of its colour and of its metallic share, sampled at the
/// same points.
glm::dvec3 meanAlbedo(const Scene& scene, const Material& material, const std::array<glm::vec2, 3>& uv);

}  // namespace lucerna
