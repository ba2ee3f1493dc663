// Checks the header and structure of an 8-bit picture file before a decoder sees it (no GL).
//
// DevIL 1.7.8 crashes on damaged XPM, DDS, ICO and PNM, hangs on a truncated PNG, and allocates whatever a header asks
// for. So it decodes only PNG, JPEG and Targa, recognised by content (Targa, which has no magic number, by extension
// and header); BMP is read without it (bmp.hpp). Each file is walked completely before it is decoded: sizes, chunks and
// segments, remaining bytes against pixels. Sources: PNG (ISO 15948) section 5; JPEG (ITU T.81) annex B; Truevision TGA
// 2.0.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>

namespace lucerna {

enum class PictureFormat { png, jpeg, tga };

struct PictureHeader {
  PictureFormat format = PictureFormat::png;
  int width = 0;
  int height = 0;
};

/// Maximum pixels of a picture; 2^28 are 3 GiB as float RGB.
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;
/// Maximum pixels per byte of the file: the expansion of deflate, the densest of the formats' codes.
inline constexpr std::int64_t kMostPixelsPerByte = 1032;
/// Pictures up to this size may be denser: flat pictures with 1 bit per pixel are eight times as dense.
inline constexpr std::int64_t kFreeBitmapPixels = std::int64_t{1} << 24;
inline constexpr std::int64_t kFreeFloatPixels = std::int64_t{1} << 20;

/// Whether a file's bytes begin with a format's first ones.
inline bool startsWith(std::span<const std::uint8_t> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// Throws Error(badInput) if a picture has no pixels, or more than kMostPixels.
void checkPictureSize(const std::filesystem::path& file, std::int64_t width, std::int64_t height);

/// The same, and if a file of that many bytes cannot hold them: memory stays proportional to the file.
void checkPictureSize(const std::filesystem::path& file, std::int64_t width, std::int64_t height, std::size_t bytes,
                      std::int64_t freePixels);

/// Throws Error(badInput) naming `file` and the problem if the bytes are not a complete picture of a supported format.
PictureHeader checkPicture(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

}  // namespace lucerna
