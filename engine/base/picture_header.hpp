// What an 8-bit picture file says of itself, checked before a decoder sees it (no GL).
//
// DevIL 1.7.8 crashes on damaged XPM, DDS, ICO and PNM, never ends on a PNG that is cut off, and allocates whatever a header asks for. So only
// PNG, JPEG, Targa and BMP are decoded, told by their content (Targa, which has no magic number, by its extension and its header), and each is
// walked from its first byte to its last before: sizes, chunks and segments, bytes left against pixels.
// Sources: PNG (ISO 15948) section 5; JPEG (ITU T.81) annex B; Truevision TGA 2.0; BITMAPINFOHEADER (Microsoft).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace lucerna {

enum class PictureFormat { png, jpeg, tga, bmp };

struct PictureHeader {
  PictureFormat format = PictureFormat::png;
  int width = 0;
  int height = 0;
};

/// Pixels that a picture may have at most; 2^28 are 3 GiB as float RGB.
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;
/// Pixels that a picture may have for each byte of its file: what deflate, the densest of the formats' codes, makes of one byte.
inline constexpr std::int64_t kMostPixelsPerByte = 1032;
/// Up to so many pixels a file may be smaller: flat pictures of 1 bit a pixel are eight times as dense.
inline constexpr std::int64_t kFreeBitmapPixels = std::int64_t{1} << 24;
inline constexpr std::int64_t kFreeFloatPixels = std::int64_t{1} << 20;

/// Throws Error(badInput) where a picture has no pixels, or more than kMostPixels.
void checkPictureSize(const std::filesystem::path& file, std::int64_t width, std::int64_t height);

/// The same, and where a file of that many bytes cannot honestly hold them: memory stays in proportion to the file.
void checkPictureSize(const std::filesystem::path& file, std::int64_t width, std::int64_t height, std::size_t bytes, std::int64_t freePixels);

/// Throws Error(badInput) naming `file` and what is wrong where the bytes are no whole picture of a format that is read.
PictureHeader checkPicture(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

}  // namespace lucerna
