// Image files: what is written is read back, as far as each format can keep it; broken files are errors that name the
// file; nothing half-written stays.
#include "base/files.hpp"
#include "base/image.hpp"
#include "base/log.hpp"
#include "support/contains.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::TempFolder;

/// Values over nine decades, no two rows alike.
Image sampleImage(int width, int height) {
  Image image(width, height);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> exponent(-4.0f, 5.0f);
  for (glm::vec3& p : image.pixels)
    for (int c = 0; c < 3; ++c) p[c] = std::pow(10.0f, exponent(random));
  image.at(0, 0) = glm::vec3(0.0f);
  return image;
}

Bitmap sampleBitmap(int width, int height) {
  Bitmap bitmap{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(4 * width * height)), false};
  for (std::size_t i = 0; i < bitmap.rgba.size(); ++i)
    bitmap.rgba[i] = i % 4 == 3 ? 255 : static_cast<std::uint8_t>(i * 37 + i / 64);
  return bitmap;
}

TEST(ImageFiles, FloatFormatsKeepEveryBit) {
  const TempFolder folder;
  for (const char* name : {"a.exr", "a.pfm", "A.EXR", "b.PFM"}) {
    Image image = sampleImage(13, 7);
    image.at(3, 2) = {-1.5f, 3e38f, 1e-40f};
    image.at(4, 2) = {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), 0.0f};
    writeImage(folder / name, image);
    const Image back = readImage(folder / name);
    ASSERT_EQ(back.width, 13);
    ASSERT_EQ(back.height, 7);
    EXPECT_EQ(std::memcmp(back.pixels.data(), image.pixels.data(), image.pixels.size() * sizeof(glm::vec3)), 0) << name;
  }
}

TEST(ImageFiles, FloatFormatsKeepNan) {
  const TempFolder folder;
  for (const char* name : {"a.exr", "a.pfm"}) {
    Image image(2, 2);
    image.at(1, 0).y = std::numeric_limits<float>::quiet_NaN();
    writeImage(folder / name, image);
    const Image back = readImage(folder / name);
    EXPECT_TRUE(std::isnan(back.at(1, 0).y)) << name;
    EXPECT_EQ(back.at(0, 1), glm::vec3(0.0f)) << name;
  }
}

TEST(ImageFiles, PfmIsWrittenBottomRowFirst) {
  const TempFolder folder;
  Image image(1, 2);
  image.at(0, 0) = glm::vec3(1.0f);
  image.at(0, 1) = glm::vec3(2.0f);
  writeImage(folder / "a.pfm", image);
  const std::string text = readFileText(folder / "a.pfm");
  ASSERT_EQ(text.substr(0, 12), "PF\n1 2\n-1.0\n");
  float first = 0.0f;
  std::memcpy(&first, text.data() + 12, sizeof first);
  EXPECT_EQ(first, 2.0f);
}

TEST(ImageFiles, PfmReadsGreyAndBigEndian) {
  const TempFolder folder;
  const std::string one{'\x3f', '\x80', '\0', '\0'}, two{'\x40', '\0', '\0', '\0'};
  const Image image = readImage(folder.write("a.pfm", "Pf\n1 2\n1.0\n" + one + two));
  EXPECT_EQ(image.at(0, 0), glm::vec3(2.0f));
  EXPECT_EQ(image.at(0, 1), glm::vec3(1.0f));
}

// RGBE: the largest channel's mantissa is 128..255, so rounding errs by at most 1/256 of that channel.
TEST(ImageFiles, HdrKeepsEightBitsOfTheLargestChannel) {
  const TempFolder folder;
  // Run-length coding needs 8 to 32767 pixels a row; 3 and 40000 are written flat.
  for (const glm::ivec2& size :
       {glm::ivec2(64, 9), glm::ivec2(3, 5), glm::ivec2(8, 2), glm::ivec2(40000, 1), glm::ivec2(300, 2)}) {
    const Image image = sampleImage(size.x, size.y);
    writeImage(folder / "a.hdr", image);
    const Image back = readImage(folder / "a.hdr");
    ASSERT_EQ(back.width, size.x);
    ASSERT_EQ(back.height, size.y);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const glm::vec3 p = image.pixels[i], q = back.pixels[i];
      const float largest = std::max({p.x, p.y, p.z});
      for (int c = 0; c < 3; ++c)
        ASSERT_LE(std::abs(p[c] - q[c]), largest / 256.0f) << i << " of " << size.x << " x " << size.y;
    }
  }
}

// Cut-off mantissas (DevIL's writer) would lose 0.2 % or more of the mean here; rounding has no bias: its standard
// error is below 0.0015/sqrt(3 * 40000) relative to the mean, and 5 of them are allowed.
TEST(ImageFiles, HdrRoundsWithoutBias) {
  const TempFolder folder;
  Image image(200, 200);
  std::mt19937 random(11);
  std::uniform_real_distribution<float> value(0.51f, 0.99f);
  for (glm::vec3& p : image.pixels) p = {value(random), value(random), value(random)};
  writeImage(folder / "a.hdr", image);
  const glm::dvec3 before = meanOf(image), after = meanOf(readImage(folder / "a.hdr"));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1.0, 3e-5);
}

TEST(ImageFiles, HdrKeepsLongRunsAndExtremes) {
  const TempFolder folder;
  Image image(1000, 3, glm::vec3(0.5f, 0.25f, 1.0f));
  image.at(500, 1) = {1e38f, 0.0f, 0.0f};
  image.at(501, 1) = {1e-37f, 0.0f, 0.0f};
  image.at(502, 1) = {0.99999f, 0.0f, 0.0f};  // rounds up into the next exponent
  writeImage(folder / "a.hdr", image);
  const Image back = readImage(folder / "a.hdr");
  EXPECT_EQ(back.at(0, 0), image.at(0, 0));
  EXPECT_EQ(back.at(999, 2), image.at(0, 0));
  EXPECT_NEAR(back.at(500, 1).x / 1e38f, 1.0f, 1.0f / 256.0f);
  EXPECT_NEAR(back.at(501, 1).x / 1e-37f, 1.0f, 1.0f / 256.0f);
  EXPECT_EQ(back.at(502, 1).x, 1.0f);
}

TEST(ImageFiles, HdrRefusesWhatItCannotHoldAndWarnsOfNegatives) {
  const TempFolder folder;
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e38f}) {
    Image image(8, 8);
    image.at(1, 1).y = value;
    const std::string message = badInputMessage([&] { writeImage(folder / "bad.hdr", image); });
    EXPECT_TRUE(contains(message, "bad.hdr")) << message;
    EXPECT_TRUE(contains(message, "exr")) << message;
    EXPECT_EQ(folder.listing(), "");
  }
  clearLoggedWarnings();
  Image image(8, 8, glm::vec3(1.0f));
  image.at(2, 2).x = -1.0f;
  writeImage(folder / "negative.hdr", image);
  EXPECT_EQ(loggedWarnings().size(), 1u);
  EXPECT_EQ(readImage(folder / "negative.hdr").at(2, 2), glm::vec3(0.0f, 1.0f, 1.0f));
}

TEST(ImageFiles, HdrIsReadTopRowFirst) {
  const TempFolder folder;
  const std::string red{'\x80', '\0', '\0', '\x81'}, green{'\0', '\x80', '\0', '\x81'};  // 128 * 2^(129-136) = 1
  const Image image =
      readImage(folder.write("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 1\n" + red + green));
  EXPECT_EQ(image.at(0, 0), glm::vec3(1.0f, 0.0f, 0.0f));
  EXPECT_EQ(image.at(0, 1), glm::vec3(0.0f, 1.0f, 0.0f));
}

// The other ways the format knows: the old run lengths, another orientation, an exposure.
TEST(ImageFiles, HdrVariantsAreRead) {
  const TempFolder folder;
  const std::string one{'\x80', '\x40', '\x20', '\x81'}, repeat{'\1', '\1', '\1', '\2'};
  const Image old = readImage(folder.write("old.hdr", "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n" + one + repeat));
  for (int x = 0; x < 3; ++x) EXPECT_EQ(old.at(x, 0), glm::vec3(1.0f, 0.5f, 0.25f));
  const std::string two{'\x80', '\x80', '\x80', '\x82'};
  const Image turned = readImage(
      folder.write("turned.hdr", "#?RADIANCE\nEXPOSURE=2\nEXPOSURE=2\n\n+Y 2 -X 2\n" + one + two + two + two));
  EXPECT_EQ(turned.at(1, 1), glm::vec3(0.25f, 0.125f, 0.0625f));
  EXPECT_EQ(turned.at(0, 1), glm::vec3(0.5f));
  EXPECT_TRUE(contains(badInputMessage([&] {
                         readImage(folder.write("xyz.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + one));
                       }),
                       "xyze"));
  EXPECT_TRUE(contains(
      badInputMessage([&] { readImage(folder.write("run.hdr", "#?RADIANCE\n\n-Y 1 +X 2\n" + one + repeat)); }), "run"));
  EXPECT_TRUE(contains(badInputMessage([&] { readImage(folder.write("size.hdr", "#?RADIANCE\n\n-Y 0 +X 2\n" + one)); }),
                       "2 x 0"));
}

TEST(ImageFiles, PngKeepsColoursAndRowOrder) {
  const TempFolder folder;
  const Bitmap bitmap = sampleBitmap(33, 17);
  writePng(folder / "a.png", bitmap);
  const Bitmap back = readBitmap(folder / "a.png");
  EXPECT_EQ(back.width, 33);
  EXPECT_EQ(back.height, 17);
  EXPECT_FALSE(back.hasAlpha);
  EXPECT_EQ(back.rgba, bitmap.rgba);
  EXPECT_EQ(folder.listing(), "a.png");
}

// Written by hand: BMP stores the bottom row first, Targa (type 2, descriptor 0) too; 24 bits, blue first.
TEST(ImageFiles, BottomUpFormatsComeOutTopRowFirst) {
  const TempFolder folder;
  const std::string red{'\0', '\0', '\xff'}, blue{'\xff', '\0', '\0'}, pad("\0", 1);
  std::string bmp = "BM";
  const auto number = [](std::uint32_t v, int bytes) {
    std::string s;
    for (int i = 0; i < bytes; ++i) s += static_cast<char>(i < 4 ? v >> (8 * i) : 0);
    return s;
  };
  bmp += number(54 + 8, 4) + number(0, 4) + number(54, 4) + number(40, 4) + number(1, 4) + number(2, 4) + number(1, 2) +
         number(24, 2) + number(0, 4) + number(8, 4) + number(2835, 4) + number(2835, 4) + number(0, 4) + number(0, 4);
  bmp += blue + pad + red + pad;
  const std::string tga = number(0, 2) + number(2, 1) + number(0, 9) + number(1, 2) + number(2, 2) + number(24, 1) +
                          number(0, 1) + blue + red;
  for (const auto& [name, content] : {std::pair<std::string, std::string>{"a.bmp", bmp}, {"a.tga", tga}}) {
    const Bitmap bitmap = readBitmap(folder.write(name, content));
    ASSERT_EQ(bitmap.width, 1) << name;
    ASSERT_EQ(bitmap.height, 2) << name;
    EXPECT_EQ(bitmap.rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 0, 255, 255})) << name;
  }
}

/// An EXR without compression, written by hand: floats, `value` of each channel at the pixels of the data window.
struct ExrChannel {
  std::string name;
  int sampling;
  float (*value)(int x, int y);
};

std::string exr(const std::vector<ExrChannel>& channels, glm::ivec4 data, glm::ivec4 display,
                const std::vector<float>& chromaticities = {}) {
  const auto number = [](auto value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
  };
  const auto attribute = [&](const std::string& name, const std::string& type, const std::string& value) {
    return name + '\0' + type + '\0' + number(static_cast<std::int32_t>(value.size())) + value;
  };
  const auto box = [&](glm::ivec4 b) { return number(b.x) + number(b.y) + number(b.z) + number(b.w); };
  std::string list, text("\x76\x2f\x31\x01\x02\0\0\0", 8);
  for (const ExrChannel& c : channels)
    list += c.name + '\0' + number(std::int32_t{2}) + std::string(4, '\0') + number(c.sampling) + number(c.sampling);
  text += attribute("channels", "chlist", list + '\0') + attribute("compression", "compression", std::string(1, '\0')) +
          attribute("dataWindow", "box2i", box(data)) + attribute("displayWindow", "box2i", box(display)) +
          attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
          attribute("pixelAspectRatio", "float", number(1.0f)) +
          attribute("screenWindowCenter", "v2f", std::string(8, '\0')) +
          attribute("screenWindowWidth", "float", number(1.0f));
  std::string primaries;
  for (const float v : chromaticities) primaries += number(v);
  if (!primaries.empty()) text += attribute("chromaticities", "chromaticities", primaries);
  text += '\0';
  std::string offsets, lines;
  const std::size_t begin = text.size() + 8 * static_cast<std::size_t>(data.w - data.y + 1);
  for (int y = data.y; y <= data.w; ++y) {
    std::string pixels;
    for (const ExrChannel& c : channels)
      for (int x = data.x; x <= data.z && y % c.sampling == 0; x += c.sampling) pixels += number(c.value(x, y));
    offsets += number(static_cast<std::uint64_t>(begin + lines.size()));
    lines += number(y) + number(static_cast<std::int32_t>(pixels.size())) + pixels;
  }
  return text + offsets + lines;
}

float constant(int, int) { return 0.25f; }
float column(int x, int) { return static_cast<float>(x); }
float row(int, int y) { return static_cast<float>(y); }
float half(int, int) { return 0.5f; }
float negative(int, int) { return -0.25f; }

// What is displayed is the picture: black where there are no data, and data beyond its edge are cut off.
TEST(ImageFiles, ExrShowsItsDisplayWindow) {
  const TempFolder folder;
  const std::vector<ExrChannel> channels = {{"B", 1, constant}, {"G", 1, row}, {"R", 1, column}};
  const Image part = readImage(folder.write("a.exr", exr(channels, {2, 1, 3, 2}, {0, 0, 7, 3})));
  ASSERT_EQ(glm::ivec2(part.width, part.height), glm::ivec2(8, 4));
  EXPECT_EQ(part.at(3, 2), glm::vec3(3.0f, 2.0f, 0.25f));
  EXPECT_EQ(part.at(2, 1), glm::vec3(2.0f, 1.0f, 0.25f));
  EXPECT_EQ(part.at(4, 2), glm::vec3(0.0f));
  EXPECT_EQ(part.at(0, 0), glm::vec3(0.0f));
  const Image cut = readImage(folder.write("a.exr", exr(channels, {-2, -1, 6, 6}, {1, 2, 3, 3})));
  ASSERT_EQ(glm::ivec2(cut.width, cut.height), glm::ivec2(3, 2));
  EXPECT_EQ(cut.at(0, 0), glm::vec3(1.0f, 2.0f, 0.25f));
  EXPECT_EQ(cut.at(2, 1), glm::vec3(3.0f, 3.0f, 0.25f));
  EXPECT_NE(badInputMessage([&] {
              readImage(folder.write("a.exr", exr(channels, {9, 9, 9, 9}, {0, 0, 3, 3})));
            }).find("outside of its display window"),
            std::string::npos);
  EXPECT_NE(badInputMessage([&] {
              readImage(folder.write("a.exr", exr({{"Z", 1, row}}, {0, 0, 1, 1}, {0, 0, 1, 1})));
            }).find("channels Z; R, G and B, or Y, are read"),
            std::string::npos);
}

// R = (RY + 1) Y, B = (BY + 1) Y, and G by the weights of Y (OpenEXR, "Technical Introduction").
TEST(ImageFiles, ExrChromaBecomesColour) {
  const TempFolder folder;
  const float r = 0.375f, b = 0.75f, g = (0.5f - 0.2126f * r - 0.0722f * b) / 0.7152f;
  for (const int sampling : {1, 2}) {
    const std::vector<ExrChannel> channels = {{"BY", sampling, half}, {"RY", sampling, negative}, {"Y", 1, half}};
    const Image image = readImage(folder.write("a.exr", exr(channels, {0, 0, 15, 7}, {0, 0, 15, 7})));
    for (const glm::vec3& p : image.pixels) EXPECT_LT(glm::distance(p, glm::vec3(r, g, b)), 1e-3f) << sampling;
  }
}

TEST(ImageFiles, ExrPrimariesBecomeRec709) {
  const TempFolder folder;
  const std::vector<ExrChannel> channels = {{"B", 1, constant}, {"G", 1, constant}, {"R", 1, half}};
  const auto read = [&](const std::vector<float>& chromaticities) {
    return readImage(folder.write("a.exr", exr(channels, {0, 0, 0, 0}, {0, 0, 0, 0}, chromaticities))).at(0, 0);
  };
  EXPECT_EQ(read({0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f}), glm::vec3(0.5f, 0.25f, 0.25f));
  // ITU-R BT.2087's matrix from BT.2020, of the same white; and a grey of another white stays grey.
  const glm::vec3 wide = read({0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f});
  EXPECT_LT(glm::distance(wide, glm::vec3(0.25f + 0.25f * 1.6605f, 0.25f - 0.25f * 0.1246f, 0.25f - 0.25f * 0.0182f)),
            2e-4f);
  const std::vector<ExrChannel> grey = {{"B", 1, half}, {"G", 1, half}, {"R", 1, half}};
  const Image aces =
      readImage(folder.write("a.exr", exr(grey, {0, 0, 0, 0}, {0, 0, 0, 0},
                                          {0.7347f, 0.2653f, 0.0f, 1.0f, 0.0001f, -0.077f, 0.32168f, 0.33767f})));
  EXPECT_LT(glm::distance(aces.at(0, 0), glm::vec3(0.5f)), 1e-5f);
  EXPECT_NE(badInputMessage([&] { read({0, 0, 0, 0, 0, 0, 0, 0}); }).find("no primaries"), std::string::npos);
}

TEST(ImageFiles, EightBitPicturesAreLinearised) {
  const TempFolder folder;
  Bitmap bitmap = sampleBitmap(1, 1);
  bitmap.rgba = {0, 128, 255, 255};
  writePng(folder / "a.png", bitmap);
  const glm::vec3 p = readImage(folder / "a.png").at(0, 0);
  EXPECT_EQ(p.x, 0.0f);
  EXPECT_NEAR(p.y, 0.2158605f, 1e-6f);  // IEC 61966-2-1 of 128/255
  EXPECT_EQ(p.z, 1.0f);
}

TEST(ImageFiles, SrgbTransferInvertsItself) {
  EXPECT_NEAR(srgbFromLinear(0.5f), 0.735357f, 1e-6f);
  EXPECT_NEAR(srgbFromLinear(0.001f), 0.01292f, 1e-7f);
  for (int i = 0; i <= 255; ++i) {
    const float encoded = static_cast<float>(i) / 255.0f;
    EXPECT_NEAR(srgbFromLinear(linearFromSrgb(encoded)), encoded, 1e-6f);
  }
}

TEST(ImageFiles, MeanIsSummedInDouble) {
  Image image(2000, 2000, glm::vec3(0.1f));  // a float sum of 4 million values would be off by 1e-3
  EXPECT_NEAR(meanOf(image).x, static_cast<double>(0.1f), 1e-9);
}

TEST(ImageFiles, WhatIsNoPictureIsAnErrorThatNamesTheFile) {
  const TempFolder folder;
  std::string garbage;
  std::mt19937 random(3);
  for (int i = 0; i < 5000; ++i) garbage += static_cast<char>(random());
  for (const char* name : {"g.png", "g.jpg", "g.tga", "g.hdr", "g.exr", "g.pfm"}) {
    for (const std::string& content : {garbage, std::string(5000, '\0'), std::string("hello"), std::string()}) {
      const auto file = folder.write(name, content);
      EXPECT_TRUE(contains(badInputMessage([&] { readBitmap(file); }), name)) << name << " " << content.size();
      EXPECT_TRUE(contains(badInputMessage([&] { readImage(file); }), name)) << name << " " << content.size();
    }
  }
  EXPECT_TRUE(contains(badInputMessage([&] { readImage(folder / "none.png"); }), "none.png: no such file"));
  EXPECT_TRUE(contains(badInputMessage([&] { readBitmap(folder.path()); }), "is a folder"));
}

TEST(ImageFiles, TruncatedPicturesAreErrors) {
  const TempFolder folder;
  const Image image = sampleImage(64, 64);
  writeImage(folder / "a.hdr", image);
  writeImage(folder / "a.exr", image);
  writeImage(folder / "a.pfm", image);
  writePng(folder / "a.png", sampleBitmap(64, 64));
  for (const char* name : {"a.hdr", "a.exr", "a.pfm", "a.png"}) {
    const std::string whole = readFileText(folder / name);
    for (const double part : {0.02, 0.5, 0.95}) {
      const auto file =
          folder.write(std::string("cut-") + name,
                       whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
      EXPECT_TRUE(contains(badInputMessage([&] { readImage(file); }), std::string("cut-") + name))
          << name << " " << part;
    }
  }
}

TEST(ImageFiles, DamagedPngIsAnError) {
  const TempFolder folder;
  writePng(folder / "a.png", sampleBitmap(64, 64));
  std::string content = readFileText(folder / "a.png");
  content[content.size() / 2] = static_cast<char>(content[content.size() / 2] ^ 0x55);
  const auto file = folder.write("damaged.png", content);
  EXPECT_TRUE(contains(badInputMessage([&] { readBitmap(file); }), "damaged.png"));
}

// DevIL frees memory twice on truncated ones, so the kind is refused as a whole.
TEST(ImageFiles, PortableAnymapsAreRefused) {
  const TempFolder folder;
  EXPECT_TRUE(contains(badInputMessage([&] { readBitmap(folder.write("a.ppm", "P6\n64 64\n255\nabc")); }), "a.ppm"));
}

TEST(ImageFiles, AbsurdSizesAreRefused) {
  const TempFolder folder;
  EXPECT_TRUE(contains(badInputMessage([&] { writeImage(folder / "a.exr", Image()); }), "0 x 0"));
  EXPECT_TRUE(contains(badInputMessage([&] { writePng(folder / "a.png", Bitmap()); }), "0 x 0"));
  for (const char* size : {"0 4", "4 -4", "2147483647 2147483647", "4294967297 1", "99999999999999999999 1"}) {
    const auto file = folder.write("a.pfm", fmt::format("PF\n{}\n-1.0\n", size));
    EXPECT_TRUE(contains(badInputMessage([&] { readImage(file); }), "a.pfm")) << size;
  }
  EXPECT_EQ(folder.listing(), "a.pfm");
}

TEST(ImageFiles, OnlyKnownExtensionsAreWritten) {
  const TempFolder folder;
  const Image image(2, 2);
  for (const char* name : {"a.png", "a.jpg", "a", "a.exr.bak"})
    EXPECT_TRUE(contains(badInputMessage([&] { writeImage(folder / name, image); }), name)) << name;
  EXPECT_TRUE(contains(badInputMessage([&] { writePng(folder / "a.jpg", sampleBitmap(2, 2)); }), "a.jpg"));
  EXPECT_EQ(folder.listing(), "");
  for (const char* name : {"a.png", "a.HDR", "a.Exr", "dir/a.pfm"}) EXPECT_TRUE(isWritableImageName(name)) << name;
  for (const char* name : {"a.jpg", "png", "a", "a.png.txt", ""}) EXPECT_FALSE(isWritableImageName(name)) << name;
}

TEST(ImageFiles, UnwritablePlacesAreErrors) {
  const TempFolder folder;
  const Image image(2, 2);
  EXPECT_TRUE(contains(badInputMessage([&] { writeImage(folder / "none/a.exr", image); }), "no such folder"));
  std::filesystem::create_directory(folder / "taken.exr");
  EXPECT_TRUE(contains(badInputMessage([&] { writeImage(folder / "taken.exr", image); }), "is a folder"));
  folder.write("file", "x");
  EXPECT_TRUE(contains(badInputMessage([&] { writeImage(folder / "file/a.exr", image); }), "no such folder"));
  EXPECT_EQ(folder.listing(), "file taken.exr");
}

// A limit on file sizes makes write(2) fail midway, as a full disk does.
TEST(ImageFiles, NothingHalfWrittenStaysWhenTheDiskIsFull) {
  const TempFolder folder;
  folder.write("old.pfm", "old content");
  const Image image = sampleImage(256, 256);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto oldHandler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 20000;
  setrlimit(RLIMIT_FSIZE, &small);
  std::string messages;
  for (const char* name : {"new.pfm", "old.pfm", "new.exr", "new.hdr"})
    messages += badInputMessage([&] { writeImage(folder / name, image); }) + "\n";
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, oldHandler);
  for (const char* name : {"new.pfm: cannot be written: ", "old.pfm: cannot be written: ",
                           "new.exr: cannot be written: ", "new.hdr: cannot be written: "})
    EXPECT_TRUE(contains(messages, name)) << messages;
  EXPECT_EQ(folder.listing(), "old.pfm");
  EXPECT_EQ(readFileText(folder / "old.pfm"), "old content");
}

TEST(ImageFiles, DevilIsSafeFromSeveralThreads) {
  const TempFolder folder;
  const Bitmap bitmap = sampleBitmap(64, 64);
  writePng(folder / "a.png", bitmap);
  std::vector<int> wrong(4, 0);
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < wrong.size(); ++t)
      threads.emplace_back([&, t] {
        for (int i = 0; i < 25; ++i) wrong[t] += readBitmap(folder / "a.png").rgba != bitmap.rgba;
      });
  }
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

// Sponza's masks: 1-bit, grey, and grey with alpha.
TEST(ImageFiles, MaskPicturesOfEveryKindAreRead) {
  const auto assets = test::sharedAssets("crytek-sponza");
  if (assets.empty()) GTEST_SKIP() << "shared test data not found";
  const auto share = [](const Bitmap& b, std::size_t channel) {
    std::size_t set = 0;
    for (std::size_t i = channel; i < b.rgba.size(); i += 4) set += b.rgba[i] >= 128;
    return static_cast<double>(set) / (b.width * b.height);
  };
  const Bitmap chain = readBitmap(assets / "textures/chain_texture_mask.png");
  EXPECT_FALSE(chain.hasAlpha);
  EXPECT_GT(share(chain, 0), 0.05);
  EXPECT_LT(share(chain, 0), 0.95);
  const Bitmap thorn = readBitmap(assets / "textures/sponza_thorn_mask.png");
  EXPECT_FALSE(thorn.hasAlpha);
  EXPECT_GT(share(thorn, 0), 0.05);
  const Bitmap plant = readBitmap(assets / "textures/vase_plant_mask.png");
  EXPECT_TRUE(plant.hasAlpha);
  EXPECT_GT(share(plant, 3), 0.05);
  EXPECT_LT(share(plant, 3), 0.95);
}

}  // namespace
}  // namespace lucerna
