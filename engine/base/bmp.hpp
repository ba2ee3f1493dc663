// Windows and OS/2 bitmaps (no GL). Source: Microsoft, BITMAPCOREHEADER to BITMAPV5HEADER. Read here, since DevIL 1.7.8
// reads past palettes, writes past pictures of run lengths, and refuses headers other than of 40 bytes.
#pragma once

#include "base/image.hpp"

namespace lucerna {

/// Any of 1, 4, 8 bits with a palette, also run lengths, and of 16, 24, 32 bits, also with masks. Without an alpha mask
/// the fourth byte of 32 bits means nothing. Throws Error(badInput) naming the file.
Bitmap decodeBmp(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

}  // namespace lucerna
