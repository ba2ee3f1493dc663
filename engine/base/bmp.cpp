#include "base/bmp.hpp"

#include "base/error.hpp"
#include "base/picture_header.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace lucerna {

namespace {

class BmpReader {
 public:
  BmpReader(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {}

  Bitmap run() {
    readHeader();
    if (bits_ <= 8) readPalette();
    bitmap_.rgba.assign(4 * static_cast<std::size_t>(bitmap_.width) * static_cast<std::size_t>(bitmap_.height), 255);
    if (compression_ == kRunLengths8 || compression_ == kRunLengths4) readRunLengths();
    else readRows();
    for (std::size_t i = 3; i < bitmap_.rgba.size() && !bitmap_.hasAlpha; i += 4)
      bitmap_.hasAlpha = bitmap_.rgba[i] < 255;
    return std::move(bitmap_);
  }

 private:
  static constexpr std::uint32_t kNone = 0, kRunLengths8 = 1, kRunLengths4 = 2, kMasks = 3, kAlphaMasks = 6;
  static constexpr std::size_t kFileHeader = 14;

  void readHeader() {
    begin_ = number(10, 4);
    const std::uint32_t head = headerBytes_ = number(14, 4);
    const bool isOld = head == 12;  // of OS/2 1
    if (!isOld && (head < 40 || head > 124))
      fail(fmt::format("an unsupported kind of BMP: a header of {} bytes", head));
    const auto width = static_cast<std::int64_t>(isOld ? number(18, 2) : number(18, 4));
    const std::int64_t height =
        isOld ? std::int64_t{number(20, 2)} : std::int64_t{static_cast<std::int32_t>(number(22, 4))};
    bits_ = number(isOld ? 24 : 28, 2);
    compression_ = isOld ? kNone : number(30, 4);
    entries_ = isOld ? 0 : number(46, 4);
    topFirst_ = height < 0;
    checkPictureSize(file_, width, height < 0 ? -height : height, bytes_.size(), kFreeBitmapPixels);
    bitmap_.width = static_cast<int>(width);
    bitmap_.height = static_cast<int>(height < 0 ? -height : height);
    const bool masked = (compression_ == kMasks || compression_ == kAlphaMasks) && (bits_ == 16 || bits_ == 32);
    const bool packed = (compression_ == kRunLengths8 && bits_ == 8) || (compression_ == kRunLengths4 && bits_ == 4);
    constexpr std::array<std::uint32_t, 6> kBits = {1, 4, 8, 16, 24, 32};
    const bool plain = compression_ == kNone && std::find(kBits.begin(), kBits.end(), bits_) != kBits.end();
    if (!masked && !packed && !plain)
      fail(fmt::format("an unsupported kind of BMP: {} bits, compression {}", bits_, compression_));
    if (bits_ == 16) masks_ = {0x7c00, 0x3e0, 0x1f, 0};
    if (bits_ == 32) masks_ = {0xff0000, 0xff00, 0xff, 0};
    if (masked) {
      for (std::size_t c = 0; c < 3; ++c) masks_[c] = number(54 + 4 * c, 4);
      masks_[3] = head >= 56 || compression_ == kAlphaMasks ? number(66, 4) : 0;
      for (const std::uint32_t mask : masks_)
        if (mask != 0 && !std::has_single_bit((mask >> std::countr_zero(mask)) + 1u))
          fail("damaged picture: a mask with holes");
    }
  }

  void readPalette() {
    const std::size_t size = headerBytes_ == 12 ? 3 : 4, at = kFileHeader + headerBytes_,
                      most = std::size_t{1} << bits_;
    if (begin_ < at) fail("damaged picture: a BMP whose pixels begin within its header");
    // Files of a short palette may leave its length out.
    const std::size_t count = std::min(entries_ == 0 ? most : std::size_t{entries_}, (begin_ - at) / size);
    if (entries_ > count || entries_ > most) fail("damaged picture: a BMP whose pixels begin within its header");
    for (std::size_t i = 0; i < count; ++i)
      palette_.push_back({static_cast<std::uint8_t>(number(at + size * i + 2, 1)),
                          static_cast<std::uint8_t>(number(at + size * i + 1, 1)),
                          static_cast<std::uint8_t>(number(at + size * i, 1)), 255});
  }

  void readRows() {
    const auto width = static_cast<std::size_t>(bitmap_.width), rowBytes = (width * bits_ + 31) / 32 * 4;
    if (begin_ > bytes_.size() || (bytes_.size() - begin_) / rowBytes < static_cast<std::size_t>(bitmap_.height))
      throwCutOff();
    for (int y = 0; y < bitmap_.height; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t bit = x * bits_, at = begin_ + static_cast<std::size_t>(y) * rowBytes + bit / 8;
        if (bits_ <= 8) {
          put(static_cast<int>(x), y,
              static_cast<std::uint32_t>(bytes_[at] >> (8 - bits_ - bit % 8)) & ((1u << bits_) - 1u));
        } else if (bits_ == 24) {
          put(static_cast<int>(x), y, {bytes_[at + 2], bytes_[at + 1], bytes_[at], 255});
        } else {
          const std::uint32_t value = number(at, bits_ / 8);
          put(static_cast<int>(x), y,
              {channel(value, 0, 0), channel(value, 1, 0), channel(value, 2, 0), channel(value, 3, 255)});
        }
      }
  }

  /// A count and a value, or 0 and: 0, the row's end; 1, the picture's; 2, a step; else that many values as they are,
  /// padded to two bytes. What is skipped is the first colour.
  void readRunLengths() {
    for (int y = 0; y < bitmap_.height; ++y)
      for (int x = 0; x < bitmap_.width; ++x) put(x, y, 0);
    int x = 0, y = 0;
    const auto add = [&](std::uint32_t index) {
      if (x >= bitmap_.width || y >= bitmap_.height) fail("damaged picture: a BMP run that leaves its row");
      put(x++, y, index);
    };
    const auto nibble = [&](std::size_t at, std::size_t i) {  // value i of those that begin at a byte
      return bits_ == 8 ? number(at + i, 1) : number(at + i / 2, 1) >> (i % 2 ? 0 : 4) & 15u;
    };
    for (std::size_t at = begin_; y < bitmap_.height;) {
      const std::uint32_t count = number(at, 1), value = number(at + 1, 1);
      at += 2;
      if (count > 0) {
        for (std::uint32_t i = 0; i < count; ++i) add(bits_ == 8 ? value : value >> (i % 2 ? 0 : 4) & 15u);
      } else if (value == 0) {
        x = 0, ++y;
      } else if (value == 1) {
        return;
      } else if (value == 2) {
        x += static_cast<int>(number(at, 1)), y += static_cast<int>(number(at + 1, 1));
        at += 2;
      } else {
        for (std::uint32_t i = 0; i < value; ++i) add(nibble(at, i));
        at += ((value * bits_ + 7) / 8 + 1) / 2 * 2;
      }
    }
  }

  std::uint8_t channel(std::uint32_t value, std::size_t c, std::uint8_t missing) const {
    if (masks_[c] == 0) return missing;
    const int shift = std::countr_zero(masks_[c]);
    const std::uint64_t highest = masks_[c] >> shift, read = (value & masks_[c]) >> shift;
    return static_cast<std::uint8_t>((255 * read + highest / 2) / highest);
  }

  void put(int x, int y, std::uint32_t index) {
    if (index >= palette_.size())
      fail(fmt::format("damaged picture: a pixel beyond its palette of {}", palette_.size()));
    put(x, y, palette_[index]);
  }
  void put(int x, int y, const std::array<std::uint8_t, 4>& colour) {
    const auto row = static_cast<std::size_t>(topFirst_ ? y : bitmap_.height - 1 - y);
    std::copy(colour.begin(), colour.end(),
              &bitmap_.rgba[4 * (row * static_cast<std::size_t>(bitmap_.width) + static_cast<std::size_t>(x))]);
  }

  std::uint32_t number(std::size_t at, std::size_t count) const {
    if (at + count > bytes_.size()) throwCutOff();
    std::uint32_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8 | bytes_[at + i];
    return value;
  }
  [[noreturn]] void fail(const std::string& what) const { throwBadInput("{}: {}", file_.string(), what); }
  [[noreturn]] void throwCutOff() const { fail("truncated picture: the BMP file ends too early"); }

  std::span<const std::uint8_t> bytes_;
  const std::filesystem::path& file_;
  std::uint32_t begin_ = 0, headerBytes_ = 0, bits_ = 0, compression_ = 0, entries_ = 0;
  bool topFirst_ = false;
  std::array<std::uint32_t, 4> masks_{};
  std::vector<std::array<std::uint8_t, 4>> palette_;
  Bitmap bitmap_;
};

}  // namespace

Bitmap decodeBmp(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) {
  return BmpReader(bytes, file).run();
}

}  // namespace lucerna
