#include "base/picture_header.hpp"

#include "base/error.hpp"
#include "base/files.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::int64_t kMostSide = std::int64_t{1} << 20;
constexpr const char* kFormats = "png, jpg, tga and bmp are read (and hdr, exr and pfm as linear pictures)";

std::int64_t bigEndian(Bytes bytes, std::size_t at, std::size_t count) {
  std::int64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | bytes[at + i];
  return value;
}

std::int64_t littleEndian(Bytes bytes, std::size_t at, std::size_t count) {
  std::int64_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}

[[noreturn]] void throwTruncated(const fs::path& file, const char* format) {
  throwBadInput("{}: truncated picture: the {} file ends too early", file.string(), format);
}

PictureHeader checkedHeader(const fs::path& file, Bytes bytes, PictureFormat format, std::int64_t width,
                            std::int64_t height) {
  checkPictureSize(file, width, height, bytes.size(), kFreeBitmapPixels);
  return {format, static_cast<int>(width), static_cast<int>(height)};
}

/// Chunk by chunk up to IEND: length, type, data, checksum. Data after IEND are ignored.
PictureHeader checkPng(Bytes bytes, const fs::path& file) {
  constexpr std::size_t kSignature = 8, kFrame = 12;  // chunk overhead: length, type, checksum
  if (bytes.size() < kSignature + kFrame + 13) throwTruncated(file, "PNG");
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (bigEndian(bytes, 8, 4) != 13 || all.substr(12, 4) != "IHDR")
    throwBadInput("{}: damaged picture: a PNG that does not begin with IHDR", file.string());
  const PictureHeader header =
      checkedHeader(file, bytes, PictureFormat::png, bigEndian(bytes, 16, 4), bigEndian(bytes, 20, 4));
  bool pixels = false;
  for (std::size_t at = kSignature;;) {
    if (bytes.size() - at < kFrame) throwTruncated(file, "PNG");
    const auto length = static_cast<std::size_t>(bigEndian(bytes, at, 4));
    if (length > bytes.size() - at - kFrame) throwTruncated(file, "PNG");
    const std::string_view type = all.substr(at + 4, 4);
    pixels |= type == "IDAT";
    if (type == "IEND") break;
    at += kFrame + length;
  }
  if (!pixels) throwBadInput("{}: damaged picture: a PNG without pixels (IDAT)", file.string());
  return header;
}

/// Segment by segment up to EOI; the entropy-coded data after SOS end at the next marker that is not a restart.
PictureHeader checkJpeg(Bytes bytes, const fs::path& file) {
  constexpr std::uint8_t kSof0 = 0xc0, kSof2 = 0xc2, kDht = 0xc4, kJpg = 0xc8, kDac = 0xcc, kSof15 = 0xcf, kRst0 = 0xd0,
                         kRst7 = 0xd7, kSoi = 0xd8, kEoi = 0xd9, kSos = 0xda, kTem = 0x01;
  constexpr int kMostScans =
      100;  // progressive pictures have about ten; each takes the decoder through the whole picture
  std::optional<PictureHeader> header;
  int scans = 0;
  for (std::size_t at = 2;;) {
    while (at < bytes.size() && bytes[at] == 0xff && at + 1 < bytes.size() && bytes[at + 1] == 0xff)
      ++at;  // fill bytes
    if (bytes.size() - at < 2) throwTruncated(file, "JPEG");
    if (bytes[at] != 0xff) throwBadInput("{}: damaged picture: a JPEG without a marker at byte {}", file.string(), at);
    const std::uint8_t marker = bytes[at + 1];
    at += 2;
    if (marker == kEoi) break;
    if (marker == kTem || marker == kSoi || (marker >= kRst0 && marker <= kRst7)) continue;
    if (bytes.size() - at < 2) throwTruncated(file, "JPEG");
    const auto length = static_cast<std::size_t>(bigEndian(bytes, at, 2));
    if (length < 2) throwBadInput("{}: damaged picture: a JPEG segment of {} bytes", file.string(), length);
    if (length > bytes.size() - at) throwTruncated(file, "JPEG");
    if (marker >= kSof0 && marker <= kSof15 && marker != kDht && marker != kJpg && marker != kDac) {
      if (length < 8) throwBadInput("{}: damaged picture: a JPEG frame header of {} bytes", file.string(), length);
      if (header) throwBadInput("{}: damaged picture: a JPEG of two frames", file.string());
      const int bits = bytes[at + 2], components = bytes[at + 7];
      if (marker > kSof2 || bits != 8 || (components != 1 && components != 3))
        throwBadInput("{}: an unsupported kind of JPEG: expected baseline or progressive, 8 bits, grey or YCbCr",
                      file.string());
      header =
          checkedHeader(file, bytes, PictureFormat::jpeg, bigEndian(bytes, at + 5, 2), bigEndian(bytes, at + 3, 2));
    }
    at += length;
    if (marker != kSos) continue;
    if (++scans > kMostScans) throwBadInput("{}: a JPEG of more than {} scans", file.string(), kMostScans);
    while (at + 1 < bytes.size() && !(bytes[at] == 0xff && bytes[at + 1] != 0 && bytes[at + 1] != 0xff &&
                                      !(bytes[at + 1] >= kRst0 && bytes[at + 1] <= kRst7)))
      ++at;
  }
  if (!header || scans == 0) throwBadInput("{}: damaged picture: a JPEG without pixels", file.string());
  return *header;
}

/// 18 bytes of header, an identification, a palette, pixels raw or as packets of up to 128.
PictureHeader checkTga(Bytes bytes, const fs::path& file) {
  constexpr std::size_t kHead = 18;
  if (bytes.size() < kHead) throwTruncated(file, "Targa");
  const int paletteKind = bytes[1], kind = bytes[2];
  const std::int64_t paletteEntries = littleEndian(bytes, 5, 2), width = littleEndian(bytes, 12, 2),
                     height = littleEndian(bytes, 14, 2);
  const int paletteBits = bytes[7], bits = bytes[16];
  constexpr int kOtherOrders = 0xd0;  // rows from the right, interleaved rows
  const bool grey = kind == 3 || kind == 11, palette = kind == 1 || kind == 9, packets = kind >= 9;
  const bool known = (kind >= 1 && kind <= 3) || (kind >= 9 && kind <= 11);
  const bool depth = palette || grey ? bits == 8 : bits == 24 || bits == 32;
  // Palettes: entries from 0 on, of whole bytes. Other kinds may have no palette (DevIL would read its bytes as
  // pixels).
  const bool paletteFits = palette ? paletteKind == 1 && paletteEntries >= 1 && paletteEntries <= 256 &&
                                         littleEndian(bytes, 3, 2) == 0 && (paletteBits == 24 || paletteBits == 32)
                                   : paletteKind == 0;
  if (!known || !depth || !paletteFits || (bytes[17] & kOtherOrders))
    throwBadInput(
        "{}: an unsupported kind of Targa: expected grey of 8 bits, colours of 24 or 32, or a palette of them, rows "
        "from "
        "the left",
        file.string());
  const PictureHeader header = checkedHeader(file, bytes, PictureFormat::tga, width, height);
  const std::size_t begin =
      kHead + bytes[0] + (palette ? static_cast<std::size_t>(paletteEntries * (paletteBits / 8)) : 0);
  if (begin > bytes.size()) throwTruncated(file, "Targa");
  const Bytes data = bytes.subspan(begin);
  const auto pixelBytes = static_cast<std::size_t>(bits / 8), count = static_cast<std::size_t>(width * height);
  if (!packets) {
    if (data.size() / pixelBytes < count) throwTruncated(file, "Targa");
    if (palette && std::any_of(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(count),
                               [&](std::uint8_t index) { return index >= paletteEntries; }))
      throwBadInput("{}: damaged picture: a pixel beyond its palette of {}", file.string(), paletteEntries);
    return header;
  }
  for (std::size_t at = 0, done = 0; done < count;) {
    if (at >= data.size()) throwTruncated(file, "Targa");
    const std::size_t run = std::size_t{data[at] & 127u} + 1, stored = data[at] & 128u ? 1 : run;
    if (stored * pixelBytes > data.size() - at - 1) throwTruncated(file, "Targa");
    if (run > count - done) throwBadInput("{}: damaged picture: a Targa packet that runs over its end", file.string());
    for (std::size_t i = 0; palette && i < stored; ++i)
      if (data[at + 1 + i] >= paletteEntries)
        throwBadInput("{}: damaged picture: a pixel beyond its palette of {}", file.string(), paletteEntries);
    at += 1 + stored * pixelBytes;
    done += run;
  }
  return header;
}

}  // namespace

void checkPictureSize(const fs::path& file, std::int64_t width, std::int64_t height) {
  if (width < 1 || height < 1 || width > kMostSide || height > kMostSide || width * height > kMostPixels)
    throwBadInput("{}: a picture of {} x {} pixels; sides must be 1 to {} and the whole at most {} pixels",
                  file.string(), width, height, kMostSide, kMostPixels);
}

void checkPictureSize(const fs::path& file, std::int64_t width, std::int64_t height, std::size_t bytes,
                      std::int64_t freePixels) {
  checkPictureSize(file, width, height);
  if (width * height > std::max(freePixels, kMostPixelsPerByte * static_cast<std::int64_t>(bytes)))
    throwBadInput(
        "{}: a picture of {} x {} pixels in {} bytes; above {} pixels at most {} a byte are taken: is its header "
        "broken?",
        file.string(), width, height, bytes, freePixels, kMostPixelsPerByte);
}

PictureHeader checkPicture(Bytes bytes, const fs::path& file) {
  if (startsWith(bytes, "\x89PNG\r\n\x1a\n")) return checkPng(bytes, file);
  if (startsWith(bytes, "\xff\xd8\xff")) return checkJpeg(bytes, file);
  if (lowerExtension(file) == ".tga") return checkTga(bytes, file);
  throwBadInput("{}: not a picture of a known format: {}", file.string(), kFormats);
}

}  // namespace lucerna
