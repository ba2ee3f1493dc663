// Images in memory and on disk (no GL).
//
// Two kinds:
// - Image: linear RGB in 32-bit float, scene units (radiance, W/(m^2 sr) up to the scene's own scale); row 0 is the TOP
// row.
// - Bitmap: 8-bit RGBA as read from a texture file or written to a PNG, sRGB-encoded unless its user says otherwise;
//   row 0 is the TOP row.
// Formats: png, jpg and tga are read and png is written through DevIL, after a check of every byte count
// (picture_header.hpp); exr through OpenEXR; bmp (bmp.hpp), hdr (Radiance RGBE) and pfm (Debevec's format: bottom row
// first) are small enough to implement here; why not through DevIL: image.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace lucerna {

struct Image {
  int width = 0;
  int height = 0;
  std::vector<glm::vec3> pixels;  ///< width * height, top row first

  Image() = default;
  Image(int width_, int height_, glm::vec3 value = glm::vec3(0.0f));
  glm::vec3& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  const glm::vec3& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

struct Bitmap {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 * width * height, top row first
  bool hasAlpha = false;  ///< whether any texel has alpha < 255
};

/// Mean over all pixels, summed in double precision.
glm::dvec3 meanOf(const Image& image);

/// sRGB transfer function, IEC 61966-2-1. Linear in [0,1] to encoded in [0,1] and back.
float srgbFromLinear(float linear);
float linearFromSrgb(float encoded);

/// The display curve: the rational fit of the ACES reference rendering [Narkowicz2015], as in shaders/lib/tonemap.glsl.
/// From radiance times exposure, at least 0, to linear in [0,1].
template <class T>
T filmic(T x) {
  x *= static_cast<T>(0.6);
  if (!std::isfinite(x * x)) return static_cast<T>(1.0);
  return std::clamp(x * (static_cast<T>(2.51) * x + static_cast<T>(0.03)) /
                        (x * (static_cast<T>(2.43) * x + static_cast<T>(0.59)) + static_cast<T>(0.14)),
                    static_cast<T>(0.0), static_cast<T>(1.0));
}

/// Radiance as shown: exposure, the filmic curve, sRGB encoding. Pixels that are not finite become pure green.
Bitmap toneMapped(const Image& radiance, float exposure);

/// Reads png, jpg, tga or bmp as 8-bit RGBA. Throws Error(badInput) naming the file if it is missing, a folder, of
/// another format, or damaged.
Bitmap readBitmap(const std::filesystem::path& file);

/// The same from a file's bytes in memory (textures embedded in models); `file` only names it in messages.
Bitmap decodeBitmap(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

/// Reads hdr, exr or pfm as linear float; an 8-bit picture is taken as sRGB and linearised. Throws like readBitmap.
Image readImage(const std::filesystem::path& file);

/// Writes a linear image. The extension chooses the format: hdr, exr or pfm; anything else throws, as do images without
/// pixels. exr and pfm keep every float; hdr keeps 8 bits of mantissa, refuses NaN and infinity, and warns of negative
/// values. The file is written completely or not at all (to a temporary file, then renamed).
void writeImage(const std::filesystem::path& file, const Image& image);

/// Writes 8-bit RGB(A) as PNG; alpha is dropped. Completely or not at all.
void writePng(const std::filesystem::path& file, const Bitmap& bitmap);

/// True for the file extensions that `-o` accepts: png, hdr, exr, pfm (any case).
bool isWritableImageName(const std::filesystem::path& file);

}  // namespace lucerna
