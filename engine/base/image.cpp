// Images on disk. The library for each format, and why:
// - 8-bit pictures (png, jpg, tga): DevIL, after the checks of base/picture_header.hpp. It keeps its current image,
//   error stack and modes in globals, so one mutex guards all of it. bmp: base/bmp.cpp.
// - Radiance hdr: implemented here. DevIL 1.7.8 reads every value 256/255 times too large (0.4 %), truncates mantissas
//   instead of rounding them when writing, and accepts truncated files; comparisons here measure bias far below that.
// - exr: OpenEXR, since Debian's DevIL has none. pfm: a header and raw floats.
// Every format goes through memory, so file errors are handled in one place (base/files.hpp).
#include "base/image.hpp"

#include "base/bmp.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "base/picture_header.hpp"

#include <IL/il.h>
#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfRgbaYca.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

std::size_t pixelCount(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

// ----------------------------------------------------------------------------------------------------------------
// DevIL

/// Exclusive use of DevIL with one bound image, freed at the end.
class DevilImage {
 public:
  DevilImage() : lock_(mutex()) {
    static const bool initialised = [] {
      ilInit();
      return true;
    }();
    static_cast<void>(initialised);
    // Decoded pictures have their top row first, whatever the file's order.
    ilEnable(IL_ORIGIN_SET);
    ilOriginFunc(IL_ORIGIN_UPPER_LEFT);
    drainErrors();
    name_ = ilGenImage();
    ilBindImage(name_);
  }
  ~DevilImage() {
    ilDeleteImage(name_);
    drainErrors();
  }
  DevilImage(const DevilImage&) = delete;
  DevilImage& operator=(const DevilImage&) = delete;

  /// Decodes into the bound image, or throws. Damaged pictures may "succeed" with read errors on the stack; those are
  /// refused.
  void decode(std::span<const std::uint8_t> bytes, const fs::path& file) {
    const PictureHeader header = checkPicture(bytes, file);
    constexpr ILenum kTypes[] = {IL_PNG, IL_JPG, IL_TGA};
    const ILenum type = kTypes[static_cast<std::size_t>(header.format)];
    const bool loaded = bytes.size() <= std::numeric_limits<ILuint>::max() &&
                        ilLoadL(type, bytes.data(), static_cast<ILuint>(bytes.size())) != IL_FALSE;
    const ILenum error = drainErrors();
    if (!loaded) throwBadInput("{}: damaged picture: {}", file.string(), describe(error));
    if (error == IL_FILE_READ_ERROR) throwBadInput("{}: truncated picture: the file ends too early", file.string());
    if (ilGetInteger(IL_IMAGE_WIDTH) != header.width || ilGetInteger(IL_IMAGE_HEIGHT) != header.height)
      throwBadInput("{}: damaged picture: {} x {} pixels decoded, its header says {} x {}", file.string(),
                    ilGetInteger(IL_IMAGE_WIDTH), ilGetInteger(IL_IMAGE_HEIGHT), header.width, header.height);
  }

  /// The bound image as RGBA, 8 bits per channel.
  std::span<const std::uint8_t> rgba(const fs::path& file) {
    if (ilConvertImage(IL_RGBA, IL_UNSIGNED_BYTE) == IL_FALSE)
      throwBadInput("{}: a picture that cannot be converted", file.string());
    return {ilGetData(), 4 * pixelCount(ilGetInteger(IL_IMAGE_WIDTH), ilGetInteger(IL_IMAGE_HEIGHT))};
  }

  /// Empties the error stack; returns the first error, or a read error if there was any.
  static ILenum drainErrors() {
    ILenum result = IL_NO_ERROR;
    for (ILenum error = ilGetError(); error != IL_NO_ERROR; error = ilGetError())
      if (result == IL_NO_ERROR || error == IL_FILE_READ_ERROR) result = error;
    return result;
  }

  static std::string describe(ILenum error) {
    switch (error) {
      case IL_OUT_OF_MEMORY: return "out of memory";
      case IL_FORMAT_NOT_SUPPORTED: return "a variant of the format that is not supported";
      case IL_ILLEGAL_FILE_VALUE:
      case IL_INVALID_FILE_HEADER: return "an invalid header";
      case IL_FILE_READ_ERROR: return "the file ends too early";
      case IL_LIB_PNG_ERROR: return "libpng rejects it as damaged or truncated";
      case IL_LIB_JPEG_ERROR: return "libjpeg rejects it as damaged or truncated";
      default: return fmt::format("DevIL error 0x{:x}", error);
    }
  }

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
  ILuint name_ = 0;
};

// ------------------------------------------------------------------------------------------------------------------
// hdr Radiance RGBE: Greg Ward, "Real Pixels", Graphics Gems II, 1991; file layout as in Radiance's reference manual
// (filefmts). A value is mantissa * 2^(exponent - 136), so that the largest channel's mantissa lies in 128..255.

std::array<std::uint8_t, 4> rgbeFromLinear(glm::vec3 colour) {
  const float largest = std::max({colour.x, colour.y, colour.z});
  int exponent = 0;
  const float fraction = std::frexp(largest, &exponent);  // in [0.5, 1)
  if (fraction * 256.0f >= 255.5f) ++exponent;  // would round to 256
  if (largest <= 0.0f || exponent < -127) return {0, 0, 0, 0};
  const auto mantissa = [&](float channel) {
    return static_cast<std::uint8_t>(std::lround(std::ldexp(std::max(channel, 0.0f), 8 - exponent)));
  };
  return {mantissa(colour.x), mantissa(colour.y), mantissa(colour.z), static_cast<std::uint8_t>(exponent + 128)};
}

/// One channel of one row, run-length encoded: a byte above 128 is a run of (byte - 128) equal values, else that many
/// values.
void appendRunLengths(std::string& out, std::span<const std::uint8_t> row) {
  constexpr std::size_t kMinRun = 4, kMaxRun = 127, kMaxLiterals = 128;
  std::size_t literalsBegin = 0;
  const auto flushLiterals = [&](std::size_t end) {
    while (literalsBegin < end) {
      const std::size_t count = std::min(end - literalsBegin, kMaxLiterals);
      out.push_back(static_cast<char>(count));
      out.append(reinterpret_cast<const char*>(row.data()) + literalsBegin, count);
      literalsBegin += count;
    }
  };
  for (std::size_t i = 0; i < row.size();) {
    std::size_t run = 1;
    while (i + run < row.size() && run < kMaxRun && row[i + run] == row[i]) ++run;
    if (run >= kMinRun) {
      flushLiterals(i);
      out.push_back(static_cast<char>(128 + run));
      out.push_back(static_cast<char>(row[i]));
      literalsBegin = i + run;
    }
    i += run;
  }
  flushLiterals(row.size());
}

std::string encodeHdr(const Image& image, const fs::path& file) {
  constexpr float kLargest = 1.69e38f;  // 255/256 * 2^127
  std::size_t negative = 0;
  for (const glm::vec3& p : image.pixels) {
    for (int c = 0; c < 3; ++c) {
      if (!(std::abs(p[c]) <= kLargest))
        throwBadInput("{}: the picture holds {}, which hdr cannot store; write exr or pfm", file.string(), p[c]);
      negative += p[c] < 0.0f;
    }
  }
  if (negative > 0)
    logWarning("{}: {} negative values become 0, since hdr cannot store them; exr and pfm can", file.string(),
               negative);

  std::string out =
      fmt::format("#?RADIANCE\nSOFTWARE=lucerna\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width);
  const bool runLengths = image.width >= 8 && image.width <= 32767;  // outside, only flat pixels are allowed
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> planes(4 * width);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::array<std::uint8_t, 4> rgbe = rgbeFromLinear(image.at(x, y));
      for (std::size_t c = 0; c < 4; ++c)
        planes[runLengths ? c * width + static_cast<std::size_t>(x) : static_cast<std::size_t>(x) * 4 + c] = rgbe[c];
    }
    if (runLengths) {
      const char marker[4] = {2, 2, static_cast<char>(image.width >> 8), static_cast<char>(image.width & 255)};
      out.append(marker, 4);
      for (std::size_t c = 0; c < 4; ++c) appendRunLengths(out, std::span(planes).subspan(c * width, width));
    } else {
      out.append(reinterpret_cast<const char*>(planes.data()), planes.size());
    }
  }
  return out;
}

/// Reads hdr bytes in order and refuses to run past their end.
class HdrBytes {
 public:
  HdrBytes(std::span<const std::uint8_t> bytes, const fs::path& file) : bytes_(bytes), file_(file) {}

  std::size_t left() const { return bytes_.size(); }
  std::uint8_t next() { return take(1)[0]; }
  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > bytes_.size())
      throwBadInput("{}: truncated: the hdr file ends within its pixels or header", file_.string());
    const std::span<const std::uint8_t> taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  bool startsWith(std::initializer_list<int> values) const {
    return bytes_.size() >= values.size() && std::equal(values.begin(), values.end(), bytes_.begin());
  }
  std::string line() {
    std::string text;
    for (char c = static_cast<char>(next()); c != '\n'; c = static_cast<char>(next())) text += c;
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  const fs::path& file_;
};

/// One row of RGBE quadruples, in any of the three ways the format knows.
void decodeHdrRow(HdrBytes& bytes, std::vector<std::array<std::uint8_t, 4>>& row, const fs::path& file) {
  const int width = static_cast<int>(row.size());
  if (width >= 8 && width <= 32767 && bytes.startsWith({2, 2, width >> 8, width & 255})) {
    bytes.take(4);
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t x = 0; x < row.size();) {
        const std::size_t code = bytes.next();
        const std::size_t count = code > 128 ? code - 128 : code;
        if (count == 0 || count > row.size() - x)
          throwBadInput("{}: damaged hdr file: a run that does not fit its row", file.string());
        const std::uint8_t value = code > 128 ? bytes.next() : std::uint8_t{0};
        for (std::size_t i = 0; i < count; ++i) row[x++][c] = code > 128 ? value : bytes.next();
      }
    }
    return;
  }
  // Flat pixels. Among them (1, 1, 1, n) repeats the last one n times; one directly after another supplies the next
  // higher byte of the count.
  int shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    const std::span<const std::uint8_t> pixel = bytes.take(4);
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      std::copy_n(pixel.begin(), 4, row[x++].begin());
      shift = 0;
      continue;
    }
    const std::size_t count = shift < 32 ? std::size_t{pixel[3]} << shift : 0;
    if (x == 0 || count > row.size() - x || shift >= 32)
      throwBadInput("{}: damaged hdr file: a run that does not fit its row", file.string());
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
    x += count;
    shift += 8;
  }
}

Image decodeHdr(std::span<const std::uint8_t> content, const fs::path& file) {
  HdrBytes bytes(content, file);
  double exposure = 1.0;  // factor already applied to the pixels; may be given several times
  bytes.line();  // "#?RADIANCE" or another program's name
  for (std::string line = bytes.line(); !line.empty(); line = bytes.line()) {
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      throwBadInput("{}: hdr pixels of '{}', expected FORMAT=32-bit_rle_rgbe", file.string(), line);
    if (line.starts_with("EXPOSURE=")) exposure *= std::strtod(line.c_str() + 9, nullptr);
  }
  if (!(exposure > 0.0) || !std::isfinite(exposure))
    throwBadInput("{}: an hdr header whose EXPOSURE is not a number above 0", file.string());

  const std::string resolution = bytes.line();
  char signY = 0, signX = 0;
  long long width = 0, height = 0;
  if (std::sscanf(resolution.c_str(), "%cY %lld %cX %lld", &signY, &height, &signX, &width) != 4)
    throwBadInput("{}: an hdr file with the size '{}', expected one like '-Y 512 +X 1024'", file.string(), resolution);
  checkPictureSize(file, width, height, content.size(), kFreeFloatPixels);
  if (bytes.left() / 4 < static_cast<std::size_t>(height))
    throwBadInput("{}: truncated: {} bytes of pixels for {} rows", file.string(), bytes.left(), height);

  Image image(static_cast<int>(width), static_cast<int>(height));
  std::vector<std::array<std::uint8_t, 4>> row(static_cast<std::size_t>(width));
  for (int i = 0; i < image.height; ++i) {
    decodeHdrRow(bytes, row, file);
    const int y = signY == '-' ? i : image.height - 1 - i;
    for (int k = 0; k < image.width; ++k) {
      const std::array<std::uint8_t, 4>& rgbe = row[static_cast<std::size_t>(k)];
      const double scale = rgbe[3] == 0 ? 0.0 : std::ldexp(1.0, rgbe[3] - 136) / exposure;
      image.at(signX == '-' ? image.width - 1 - k : k, y) = glm::vec3(glm::dvec3(rgbe[0], rgbe[1], rgbe[2]) * scale);
    }
  }
  return image;
}

// ------------------------------------------------------------------------------------------------------------------
// exr

class MemoryInput : public Imf::IStream {
 public:
  MemoryInput(const std::string& name, std::span<const std::uint8_t> bytes)
      : Imf::IStream(name.c_str()), bytes_(bytes) {}
  bool read(char target[], int count) override {
    const auto n = static_cast<std::uint64_t>(count);
    if (position_ > bytes_.size() || n > bytes_.size() - position_) throw std::runtime_error("the file ends too early");
    std::memcpy(target, bytes_.data() + position_, n);
    position_ += n;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }
  void clear() override {}

 private:
  std::span<const std::uint8_t> bytes_;
  std::uint64_t position_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  explicit MemoryOutput(const std::string& name) : Imf::OStream(name.c_str()) {}
  void write(const char source[], int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (bytes.size() < position_ + n) bytes.resize(position_ + n);
    std::memcpy(bytes.data() + position_, source, n);
    position_ += n;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

  std::vector<std::uint8_t> bytes;

 private:
  std::size_t position_ = 0;
};

constexpr std::size_t kPixelStride = sizeof(glm::vec3);

std::vector<std::uint8_t> encodeExr(const Image& image, const fs::path& file) {
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer frame;
  const char* names[3] = {"R", "G", "B"};
  // OpenEXR takes writable pointers in both directions and only reads here.
  char* base = const_cast<char*>(reinterpret_cast<const char*>(image.pixels.data()));
  for (std::size_t c = 0; c < 3; ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
    frame.insert(names[c], Imf::Slice(Imf::FLOAT, base + c * sizeof(float), kPixelStride,
                                      kPixelStride * static_cast<std::size_t>(image.width)));
  }
  MemoryOutput stream(file.string());
  {
    Imf::OutputFile output(stream, header);
    output.setFrameBuffer(frame);
    output.writePixels(image.height);
  }
  return std::move(stream.bytes);
}

/// OpenEXR allocates as many bytes as an attribute of the header claims, so the remaining bytes are checked first. An
/// attribute is its name and its type, each ended by a zero byte, its size in four bytes and its value. An empty name
/// ends a part's header; in a file of several parts another empty name ends the last header.
void checkExrHeader(std::span<const std::uint8_t> bytes, const fs::path& file) {
  constexpr std::size_t kAttributes = 8;  // after magic number and version
  constexpr std::uint8_t kSeveralParts = 0x10;  // flag in the version's second byte
  std::size_t at = kAttributes;
  const auto truncated = [&] { throwBadInput("{}: truncated: the EXR picture ends within its header", file.string()); };
  const auto skipText = [&] {
    const std::size_t begin = at;
    while (at < bytes.size() && bytes[at] != 0) ++at;
    if (at == bytes.size()) truncated();
    return at++ > begin;
  };
  if (bytes.size() < kAttributes) truncated();
  bool ended = false;
  for (;;) {
    if (!skipText()) {
      if (ended || !(bytes[5] & kSeveralParts)) return;
      ended = true;
      continue;
    }
    ended = false;
    skipText();
    if (bytes.size() - at < 4) truncated();
    const std::uint32_t size = std::uint32_t{bytes[at]} | std::uint32_t{bytes[at + 1]} << 8 |
                               std::uint32_t{bytes[at + 2]} << 16 | std::uint32_t{bytes[at + 3]} << 24;
    at += 4;
    if (size > bytes.size() - at) truncated();
    at += size;
  }
}

/// XYZ from the colours of three primaries and their white (SMPTE RP 177: the white is the primaries' sum, of Y 1).
glm::dmat3 xyzFrom(const Imf::Chromaticities& c) {
  const auto xyz = [](const Imath::V2f& p) {
    const double x = static_cast<double>(p.x), y = static_cast<double>(p.y);
    return glm::dvec3(x, y, 1.0 - x - y) / y;
  };
  const glm::dmat3 primaries(xyz(c.red), xyz(c.green), xyz(c.blue));
  const glm::dvec3 sums = glm::inverse(primaries) * xyz(c.white);
  return glm::dmat3(primaries[0] * sums[0], primaries[1] * sums[1], primaries[2] * sums[2]);
}

/// To the primaries of Rec. 709; another white becomes its white by Bradford's cone responses [Lam1985].
glm::dmat3 rec709From(const Imf::Chromaticities& from) {
  const Imf::Chromaticities rec709;  // OpenEXR's default
  const glm::dmat3 cones =
      glm::transpose(glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
  const glm::dvec3 white(1.0), ratio = (cones * xyzFrom(rec709) * white) / (cones * xyzFrom(from) * white);
  const glm::dmat3 adapted = glm::inverse(cones) * glm::dmat3(ratio.x, 0, 0, 0, ratio.y, 0, 0, 0, ratio.z) * cones;
  return glm::inverse(xyzFrom(rec709)) * adapted * xyzFrom(from);
}

/// In place. Colours that Rec. 709 cannot show would be negative radiances: those become 0.
void convertToRec709(Image& image, const Imf::Chromaticities& from, const fs::path& file) {
  const glm::dmat3 matrix = rec709From(from);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (!std::isfinite(matrix[c][r])) throwBadInput("{}: chromaticities that are no primaries", file.string());
  std::size_t clipped = 0;
  for (glm::vec3& p : image.pixels) {
    const bool wasRadiance = p.x >= 0.0f && p.y >= 0.0f && p.z >= 0.0f;
    p = glm::vec3(matrix * glm::dvec3(p));
    if (!wasRadiance || (p.x >= 0.0f && p.y >= 0.0f && p.z >= 0.0f)) continue;
    p = glm::max(p, glm::vec3(0.0f));
    ++clipped;
  }
  if (clipped > 0)
    logWarning("{}: {} pixels have colours outside of Rec. 709; their negative channels become 0", file.string(),
               clipped);
}

/// Reads channels, one or three, into the picture's window; what lies outside of it is cut off.
void readExrChannels(Imf::InputFile& input, std::span<const char* const> names, const Imath::Box2i& window,
                     Image& data) {
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < names.size(); ++c)
    frame.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &data.pixels[0][static_cast<int>(c)], window, kPixelStride,
                                            kPixelStride * static_cast<std::size_t>(data.width)));
  input.setFrameBuffer(frame);
  input.readPixels(window.min.y, window.max.y);
  if (names.size() == 1)
    for (glm::vec3& p : data.pixels) p = glm::vec3(p.x);
}

/// Luminance and chroma of the same resolution: RY = (R - Y) / Y and BY = (B - Y) / Y, Y a weighted sum of R, G and B.
void readExrFullChroma(Imf::InputFile& input, const Imath::Box2i& window, Image& data) {
  static constexpr std::array<const char*, 3> kNames{"RY", "Y", "BY"};
  readExrChannels(input, kNames, window, data);
  Imf::Chromaticities primaries;
  if (Imf::hasChromaticities(input.header())) primaries = Imf::chromaticities(input.header());
  const Imath::V3f weights = Imf::RgbaYca::computeYw(primaries);
  for (glm::vec3& p : data.pixels) {
    const float y = p.y, r = (p.x + 1.0f) * y, b = (p.z + 1.0f) * y;
    p = {r, (y - weights.x * r - weights.z * b) / weights.y, b};
  }
}

/// Luminance, and chroma of half the resolution: OpenEXR's own reader interpolates and weighs it.
void readExrChroma(MemoryInput& stream, const Imath::Box2i& window, Image& data) {
  stream.seekg(0);
  Imf::RgbaInputFile input(stream);
  std::vector<Imf::Rgba> row(static_cast<std::size_t>(data.width));
  for (int y = window.min.y; y <= window.max.y; ++y) {
    input.setFrameBuffer(row.data() - window.min.x, 1, 0);
    input.readPixels(y);
    for (int x = 0; x < data.width; ++x) {
      const Imf::Rgba& p = row[static_cast<std::size_t>(x)];
      data.at(x, y - window.min.y) = {p.r, p.g, p.b};
    }
  }
}

Image decodeExr(std::span<const std::uint8_t> bytes, const fs::path& file) {
  checkExrHeader(bytes, file);
  MemoryInput stream(file.string(), bytes);
  Imf::InputFile input(stream);
  const auto checked = [&](const Imath::Box2i& window) {
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    checkPictureSize(file, width, height, bytes.size(), kFreeFloatPixels);
    return glm::ivec2(width, height);
  };
  const Imath::Box2i window = input.header().dataWindow(), display = input.header().displayWindow();
  const glm::ivec2 dataSize = checked(window), size = checked(display);
  const Imf::ChannelList& channels = input.header().channels();
  const bool colour = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
  const bool chroma = !colour && channels.findChannel("Y") && channels.findChannel("RY") && channels.findChannel("BY");
  if (!colour && !channels.findChannel("Y")) {
    std::string names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
      names += fmt::format("{}{}", names.empty() ? "" : ", ", channel.name());
    throwBadInput("{}: an EXR of the channels {}; R, G and B, or Y, are read", file.string(), names);
  }

  Image data(dataSize.x, dataSize.y);
  static constexpr std::array<const char*, 3> kColours{"R", "G", "B"};
  const bool halfChroma = chroma && channels.findChannel("RY")->xSampling == 2;
  if (halfChroma) readExrChroma(stream, window, data);
  else if (chroma) readExrFullChroma(input, window, data);
  else if (colour) readExrChannels(input, kColours, window, data);
  else readExrChannels(input, std::array{"Y"}, window, data);
  if ((colour || chroma) && Imf::hasChromaticities(input.header())) {
    const Imf::Chromaticities given = Imf::chromaticities(input.header()), usual;
    constexpr float kRounding = 1e-4f;
    const auto near = [](const Imath::V2f& a, const Imath::V2f& b) { return (a - b).length() < kRounding; };
    if (!near(given.red, usual.red) || !near(given.green, usual.green) || !near(given.blue, usual.blue) ||
        !near(given.white, usual.white))
      convertToRec709(data, given, file);
  }
  // The picture is what is displayed: black where there are no data, without data around it.
  if (window == display) return data;
  if (!window.intersects(display))
    throwBadInput("{}: an EXR whose pixels lie outside of its display window", file.string());
  Image image(size.x, size.y);
  for (int y = std::max(window.min.y, display.min.y); y <= std::min(window.max.y, display.max.y); ++y)
    for (int x = std::max(window.min.x, display.min.x); x <= std::min(window.max.x, display.max.x); ++x)
      image.at(x - display.min.x, y - display.min.y) = data.at(x - window.min.x, y - window.min.y);
  return image;
}

// ------------------------------------------------------------------------------------------------------------------
// pfm Paul Debevec's portable float map: "PF" (colour) or "Pf" (grey), width, height, a scale whose sign tells the byte
// order (negative: little-endian), one white space, then floats from the bottom row up. The scale's size is a note on
// units: not used.

std::uint32_t byteSwapped(std::uint32_t v) { return v >> 24 | (v >> 8 & 0xff00u) | (v << 8 & 0xff0000u) | v << 24; }

std::string encodePfm(const Image& image) {
  const bool little = std::endian::native == std::endian::little;
  std::string out = fmt::format("PF\n{} {}\n{}\n", image.width, image.height, little ? "-1.0" : "1.0");
  const std::size_t rowBytes = kPixelStride * static_cast<std::size_t>(image.width);
  for (int y = image.height - 1; y >= 0; --y) out.append(reinterpret_cast<const char*>(&image.at(0, y)), rowBytes);
  return out;
}

Image decodePfm(std::span<const std::uint8_t> bytes, const fs::path& file) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto isBlank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
  std::size_t at = 2;
  const auto nextNumber = [&](auto& value) {
    while (at < text.size() && isBlank(text[at])) ++at;
    const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
    if (error != std::errc()) throwBadInput("{}: a PFM header must hold width, height and scale", file.string());
    at = static_cast<std::size_t>(end - text.data());
  };
  std::int64_t width = 0, height = 0;
  double scale = 0.0;
  nextNumber(width);
  nextNumber(height);
  nextNumber(scale);
  checkPictureSize(file, width, height);
  if (!(scale != 0.0) || at >= text.size() || !isBlank(text[at]))
    throwBadInput("{}: a PFM header must end with a scale other than 0 and one white space", file.string());
  ++at;

  const std::size_t channels = text[1] == 'F' ? 3 : 1;
  const std::size_t needed = static_cast<std::size_t>(width * height) * channels * sizeof(float);
  if (text.size() - at < needed)
    throwBadInput("{}: truncated: {} bytes of pixels, {} x {} pixels need {}", file.string(), text.size() - at, width,
                  height, needed);
  Image image(static_cast<int>(width), static_cast<int>(height));
  const bool swap = (scale < 0.0) != (std::endian::native == std::endian::little);
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      for (std::size_t c = 0; c < channels; ++c, at += sizeof(float)) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, text.data() + at, sizeof bits);
        image.at(x, y)[static_cast<int>(c)] = std::bit_cast<float>(swap ? byteSwapped(bits) : bits);
      }
      if (channels == 1) image.at(x, y) = glm::vec3(image.at(x, y).x);
    }
  }
  return image;
}

}  // namespace

Image::Image(int width_, int height_, glm::vec3 value) : width(width_), height(height_) {
  CHECK(width_ >= 0 && height_ >= 0 && std::int64_t{width_} * height_ <= kMostPixels, "{} x {} pixels", width_,
        height_);
  pixels.assign(pixelCount(width_, height_), value);
}

glm::dvec3 meanOf(const Image& image) {
  glm::dvec3 sum(0.0);
  for (const glm::vec3& p : image.pixels) sum += glm::dvec3(p);
  return image.pixels.empty() ? sum : sum / static_cast<double>(image.pixels.size());
}

float srgbFromLinear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float linearFromSrgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

Bitmap toneMapped(const Image& radiance, float exposure) {
  Bitmap bitmap{radiance.width, radiance.height, {}, false};
  bitmap.rgba.reserve(4 * radiance.pixels.size());
  for (const glm::vec3& pixel : radiance.pixels) {
    const bool finite = std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z);
    for (int c = 0; c < 3; ++c) {
      const float shown = finite ? srgbFromLinear(filmic(std::max(exposure * pixel[c], 0.0f))) : c == 1 ? 1.0f : 0.0f;
      bitmap.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * shown)));
    }
    bitmap.rgba.push_back(255);
  }
  return bitmap;
}

Bitmap decodeBitmap(std::span<const std::uint8_t> bytes, const fs::path& file) {
  if (startsWith(bytes, "BM")) return decodeBmp(bytes, file);
  DevilImage devil;
  devil.decode(bytes, file);
  const std::span<const std::uint8_t> rgba = devil.rgba(file);
  Bitmap bitmap;
  bitmap.width = ilGetInteger(IL_IMAGE_WIDTH);
  bitmap.height = ilGetInteger(IL_IMAGE_HEIGHT);
  bitmap.rgba.assign(rgba.begin(), rgba.end());
  for (std::size_t i = 3; i < rgba.size() && !bitmap.hasAlpha; i += 4) bitmap.hasAlpha = rgba[i] < 255;
  return bitmap;
}

Bitmap readBitmap(const fs::path& file) { return decodeBitmap(readFileBytes(file), file); }

Image readImage(const fs::path& file) {
  const std::vector<std::uint8_t> bytes = readFileBytes(file);
  // By content: a wrong extension is not an error.
  if (startsWith(bytes, "\x76\x2f\x31\x01")) {
    try {
      return decodeExr(bytes, file);
    } catch (const Error&) { throw; } catch (const std::exception& e) {
      throwBadInput("{}: a broken EXR picture: {}", file.string(), e.what());
    }
  }
  if (startsWith(bytes, "PF") || startsWith(bytes, "Pf")) return decodePfm(bytes, file);
  if (startsWith(bytes, "#?")) return decodeHdr(bytes, file);
  const Bitmap bitmap = decodeBitmap(bytes, file);
  std::array<float, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i) linear[i] = linearFromSrgb(static_cast<float>(i) / 255.0f);
  Image image(bitmap.width, bitmap.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {linear[bitmap.rgba[4 * i]], linear[bitmap.rgba[4 * i + 1]], linear[bitmap.rgba[4 * i + 2]]};
  return image;
}

void writeImage(const fs::path& file, const Image& image) {
  CHECK(image.pixels.size() == pixelCount(image.width, image.height), "{} pixels for {} x {}", image.pixels.size(),
        image.width, image.height);
  checkPictureSize(file, image.width, image.height);
  const std::string extension = lowerExtension(file);
  if (extension == ".pfm") return writeFileAtomically(file, encodePfm(image));
  if (extension == ".hdr") return writeFileAtomically(file, encodeHdr(image, file));
  if (extension == ".exr") return writeFileAtomically(file, encodeExr(image, file));
  throwBadInput("{}: linear pictures are written as .hdr, .exr or .pfm, not as '{}'", file.string(), extension);
}

void writePng(const fs::path& file, const Bitmap& bitmap) {
  CHECK(bitmap.rgba.size() == 4 * pixelCount(bitmap.width, bitmap.height), "{} bytes for {} x {}", bitmap.rgba.size(),
        bitmap.width, bitmap.height);
  checkPictureSize(file, bitmap.width, bitmap.height);
  if (lowerExtension(file) != ".png") throwBadInput("{}: 8-bit pictures are written as .png", file.string());
  const std::size_t count = pixelCount(bitmap.width, bitmap.height);
  std::vector<std::uint8_t> rgb(3 * count);
  for (std::size_t i = 0; i < count; ++i) std::copy_n(&bitmap.rgba[4 * i], 3, &rgb[3 * i]);

  // Deflate enlarges incompressible data by far less than this.
  std::vector<std::uint8_t> png(rgb.size() + rgb.size() / 50 + static_cast<std::size_t>(bitmap.height) + 65536);
  std::size_t size = 0;
  {
    DevilImage devil;
    const auto width = static_cast<ILuint>(bitmap.width), height = static_cast<ILuint>(bitmap.height);
    if (ilTexImage(width, height, 1, 3, IL_RGB, IL_UNSIGNED_BYTE, rgb.data()) != IL_FALSE) {
      ilRegisterOrigin(IL_ORIGIN_UPPER_LEFT);
      size = ilSaveL(IL_PNG, png.data(), static_cast<ILuint>(png.size()));
    }
  }
  if (size == 0)
    throw Error(ErrorKind::fault, fmt::format("{}: DevIL could not encode {} x {} pixels as PNG", file.string(),
                                              bitmap.width, bitmap.height));
  writeFileAtomically(file, std::span(png).first(size));
}

bool isWritableImageName(const fs::path& file) {
  const std::string extension = lowerExtension(file);
  return extension == ".png" || extension == ".hdr" || extension == ".exr" || extension == ".pfm";
}

}  // namespace lucerna
