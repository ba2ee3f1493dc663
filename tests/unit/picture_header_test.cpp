// Pictures before a decoder sees them: what is no whole picture of a known format is refused in one line, in no time
// and without memory.
#include "base/files.hpp"
#include "base/image.hpp"
#include "base/picture_header.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::TempFolder;

/// 16 x 8 pixels: red grows to the right by 16, green downwards by 32, blue 128; progressive, quality 20.
const char* const kJpegHex =
    "ffd8ffe000104a46494600010100000100010000ffdb004300281c1e231e19282321232d2b28303c64413c37373c7b585d49"
    "64918099968f808c8aa0b4e6c3a0aadaad8a8cc8ffcbdaeef5ffffff9bc1fffffffaffe6fdfff8ffdb0043012b2d2d3c353c"
    "76414176f8a58ca5f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8"
    "f8f8f8f8f8f8f8f8ffc20011080008001003012200021101031101ffc4001500010100000000000000000000000000000002"
    "ffc4001501010100000000000000000000000000000102ffda000c030100021003100000018b09ffc4001510010100000000"
    "000000000000000000000012ffda000801010001050294bfffc400161101010100000000000000000000000000020001ffda"
    "0008010301013f010b6fffc4001511010100000000000000000000000000000100ffda0008010201013f0156ffc400141001"
    "00000000000000000000000000000010ffda0008010100063f023fffc4001510010100000000000000000000000000000001"
    "ffda0008010100013f218c7fffda000c0301000200030000001077ffc40014110100000000000000000000000000000000ff"
    "da0008010301013f100fffc40014110100000000000000000000000000000000ffda0008010201013f102fffc40015100101"
    "00000000000000000000000000000061ffda0008010100013f109a6fffd9";

std::string fromHex(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return bytes;
}

std::string little(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += i < 8 ? static_cast<char>(value >> (8 * i) & 255u) : '\0';
  return text;
}

std::string big(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

/// Header of a Targa file whose rows begin at the top.
std::string tga(int kind, std::uint32_t width, std::uint32_t height, int bits, const std::string& data,
                int paletteEntries = 0) {
  std::string text = {0, static_cast<char>(paletteEntries > 0), static_cast<char>(kind)};
  text += little(0, 2) + little(static_cast<std::uint32_t>(paletteEntries), 2) +
          static_cast<char>(paletteEntries > 0 ? 24 : 0);
  return text + little(0, 4) + little(width, 2) + little(height, 2) + static_cast<char>(bits) +
         static_cast<char>(0x20) + data;
}

std::string bmp(std::uint32_t width, std::uint32_t height, int bits, const std::string& palette,
                const std::string& data, std::uint32_t compression = 0) {
  const auto begin = static_cast<std::uint32_t>(54 + palette.size());
  return "BM" + little(begin + static_cast<std::uint32_t>(data.size()), 4) + little(0, 4) + little(begin, 4) +
         little(40, 4) + little(width, 4) + little(height, 4) + little(1, 2) +
         little(static_cast<std::uint32_t>(bits), 2) + little(compression, 4) + little(0, 12) +
         little(static_cast<std::uint32_t>(palette.size() / 4), 4) + little(0, 4) + palette + data;
}

std::string pngChunk(const std::string& type, const std::string& data) {
  return big(static_cast<std::uint32_t>(data.size())) + type + data + "crc!";
}

std::string pngHead(std::uint32_t width, std::uint32_t height) {
  return std::string("\x89PNG\r\n\x1a\n", 8) +
         pngChunk("IHDR", big(width) + big(height) + std::string("\x08\x02\0\0\0", 5));
}

std::string refusal(const TempFolder& folder, const std::string& name, const std::string& content) {
  const auto file = folder.write(name, content);
  const std::string bitmap = badInputMessage([&] { readBitmap(file); }),
                    image = badInputMessage([&] { readImage(file); });
  EXPECT_NE(bitmap.find(name), std::string::npos) << name << ": " << bitmap;
  EXPECT_NE(image.find(name), std::string::npos) << name << ": " << image;
  return bitmap;
}

using Texel = std::array<int, 4>;
Texel texel(const Bitmap& b, int x, int y) {
  const std::uint8_t* p = &b.rgba[4 * static_cast<std::size_t>(y * b.width + x)];
  return {p[0], p[1], p[2], p[3]};
}

TEST(PictureHeader, TargaOfEveryKindIsRead) {
  const TempFolder folder;
  const auto read = [&](const std::string& content) { return readBitmap(folder.write("a.tga", content)); };
  const std::string bgr = "\x01\x02\x03\x04\x05\x06";
  EXPECT_EQ(texel(read(tga(2, 2, 1, 24, bgr)), 1, 0), (Texel{6, 5, 4, 255}));
  const Bitmap alpha = read(tga(2, 1, 1, 32, "\x01\x02\x03\x04"));
  EXPECT_EQ(texel(alpha, 0, 0), (Texel{3, 2, 1, 4}));
  EXPECT_TRUE(alpha.hasAlpha);
  EXPECT_EQ(texel(read(tga(3, 2, 1, 8, "\x07\x09")), 1, 0), (Texel{9, 9, 9, 255}));
  EXPECT_EQ(texel(read(tga(10, 4, 1, 24, std::string("\x82\x01\x02\x03", 4) + std::string("\0\x04\x05\x06", 4))), 3, 0),
            (Texel{6, 5, 4, 255}));
  EXPECT_EQ(texel(read(tga(11, 3, 1, 8, "\x82\x07")), 2, 0), (Texel{7, 7, 7, 255}));
  EXPECT_EQ(texel(read(tga(1, 2, 1, 8, bgr + std::string("\0\x01", 2), 2)), 1, 0), (Texel{6, 5, 4, 255}));
  EXPECT_EQ(texel(read(tga(9, 2, 1, 8, bgr + "\x81\x01", 2)), 1, 0), (Texel{6, 5, 4, 255}));
}

TEST(PictureHeader, BmpOfEveryKindIsRead) {
  const TempFolder folder;
  const auto read = [&](const std::string& content) { return readBitmap(folder.write("a.bmp", content)); };
  const std::string rows = std::string("\x01\x02\x03\0", 4) + std::string("\x04\x05\x06\0", 4);  // bottom row first
  EXPECT_EQ(texel(read(bmp(1, 2, 24, "", rows)), 0, 0), (Texel{6, 5, 4, 255}));
  EXPECT_EQ(texel(read(bmp(1, static_cast<std::uint32_t>(-2), 24, "", rows)), 0, 0), (Texel{3, 2, 1, 255}));
  EXPECT_EQ(texel(read(bmp(1, 2, 32, "", rows)), 0, 0), (Texel{6, 5, 4, 255}));
  EXPECT_EQ(texel(read(bmp(1, 1, 16, "", std::string("\x1f\x7c\0\0", 4))), 0, 0), (Texel{255, 0, 255, 255}));
  // Palettes: 1, 4 and 8 bits, and run lengths with a step and values as they are.
  const std::string palette = std::string("\x01\x02\x03\0\x04\x05\x06\0", 8);
  EXPECT_EQ(texel(read(bmp(1, 1, 8, palette, std::string("\x01\0\0\0", 4))), 0, 0), (Texel{6, 5, 4, 255}));
  EXPECT_EQ(texel(read(bmp(3, 1, 4, palette, std::string("\x10\x10\0\0", 4))), 2, 0), (Texel{6, 5, 4, 255}));
  EXPECT_EQ(texel(read(bmp(3, 1, 1, palette, std::string("\x20\0\0\0", 4))), 2, 0), (Texel{6, 5, 4, 255}));
  const std::string runs8 = std::string("\x02\x01\0\x02\x01\x01\x01\x01\0\0\0\x01", 12);  // 2 x 1; step 1, 1; 1 x 1
  const Bitmap packed = read(bmp(4, 2, 8, palette, runs8, 1));
  EXPECT_EQ(texel(packed, 1, 1), (Texel{6, 5, 4, 255}));
  EXPECT_EQ(texel(packed, 2, 1), (Texel{3, 2, 1, 255}));
  EXPECT_EQ(texel(packed, 3, 0), (Texel{6, 5, 4, 255}));
  const std::string runs4 = std::string("\0\x05\x01\x01\x10\0\x03\x10\0\x01", 10);  // five as they are; three of 1, 0
  const Bitmap nibbles = read(bmp(8, 1, 4, palette, runs4, 2));
  for (const int x : {1, 3, 4, 5, 7}) EXPECT_EQ(texel(nibbles, x, 0), (Texel{6, 5, 4, 255})) << x;
  for (const int x : {0, 2, 6}) EXPECT_EQ(texel(nibbles, x, 0), (Texel{3, 2, 1, 255})) << x;
  // Masks in a header of version 4, with alpha; 5 of 7 are 182 of 255.
  std::string masked = bmp(1, 1, 16, "", "", 3);
  masked.replace(10, 8, little(14 + 108, 4) + little(108, 4));
  masked += little(0x0007, 4) + little(0x0038, 4) + little(0x01c0, 4) + little(0x0200, 4) + std::string(52, '\0') +
            little(0x0005 | 0x0038, 4);
  const Bitmap alpha = read(masked);
  EXPECT_EQ(texel(alpha, 0, 0), (Texel{182, 255, 0, 0}));
  EXPECT_TRUE(alpha.hasAlpha);
  // OS/2's header.
  EXPECT_EQ(texel(read("BM" + little(30, 4) + little(0, 4) + little(26, 4) + little(12, 4) + little(1, 2) +
                       little(1, 2) + little(1, 2) + little(24, 2) + std::string("\x01\x02\x03\0", 4)),
                  0, 0),
            (Texel{3, 2, 1, 255}));
}

TEST(PictureHeader, BmpStaysWithinItsBytes) {
  const TempFolder folder;
  const std::string palette = std::string("\x01\x02\x03\0\x04\x05\x06\0", 8);
  const std::pair<std::string, const char*> cases[] = {
      {bmp(1, 1, 8, palette, std::string("\x02\0\0\0", 4)), "a pixel beyond its palette of 2"},
      {bmp(2, 1, 4, palette, std::string("\x03\0\0\0", 4)), "a pixel beyond its palette of 2"},
      {bmp(1, 1, 1, palette.substr(0, 4), std::string("\x80\0\0\0", 4)), "a pixel beyond its palette of 1"},
      {bmp(1, 1, 8, palette, std::string("\x01\x02\0\x01", 4), 1), "a pixel beyond its palette of 2"},
      {bmp(4, 4, 8, palette, std::string("\x05\x01\0\x01", 4), 1), "leaves its row"},
      {bmp(4, 4, 8, palette, std::string("\x04\x01", 2), 1), "ends too early"},
      {bmp(4, 4, 8, palette, std::string("\0\x03\x01", 3), 1), "ends too early"},
      {bmp(1, 1, 7, palette, "xxxx"), "an unsupported kind of BMP: 7 bits, compression 0"},
      {bmp(1, 1, 24, "", "xxxx", 4), "an unsupported kind of BMP: 24 bits, compression 4"}};
  for (const auto& [content, said] : cases) {
    const std::string message = refusal(folder, "a.bmp", content);
    EXPECT_NE(message.find(said), std::string::npos) << message;
  }
  EXPECT_NE(refusal(folder, "a.tga", tga(2, 1, 1, 24, "abc").replace(17, 1, 1, '\x10')).find("rows from the left"),
            std::string::npos);
}

TEST(PictureHeader, ProgressiveJpegIsRead) {
  const TempFolder folder;
  const Bitmap bitmap = readBitmap(folder.write("a.jpg", fromHex(kJpegHex)));
  ASSERT_EQ(bitmap.width, 16);
  ASSERT_EQ(bitmap.height, 8);
  EXPECT_NEAR(texel(bitmap, 12, 4)[0], 192, 20);
  EXPECT_NEAR(texel(bitmap, 12, 4)[1], 128, 20);
  EXPECT_NEAR(texel(bitmap, 12, 4)[2], 128, 20);
}

// The image library crashes on damaged XPM, DDS and ICO files and never ends on some others.
TEST(PictureHeader, OtherFormatsAreRefusedWithThoseThatAreRead) {
  const TempFolder folder;
  const std::string xpm =
      "/* XPM */\nstatic char *a[] = {\n\"2 2 2 1\",\n\"a c #000000\",\n\"b c #ffffff\",\n\"ab\",\n\"ba\"};\n";
  for (const auto& [name, content] : {std::pair<std::string, std::string>{"a.xpm", xpm},
                                      {"a.dds", "DDS |" + std::string(200, '\1')},
                                      {"a.ico", std::string("\0\0\1\0\1\0", 6) + std::string(60, '\2')},
                                      {"a.gif", "GIF89a" + std::string(60, '\1')},
                                      {"a.pcx", "\x0a\x05\x01\x08" + std::string(200, '\1')},
                                      {"a.tif", std::string("II*\0", 4) + std::string(60, '\1')}})
    EXPECT_NE(refusal(folder, name, content).find("png, jpg, tga and bmp are read"), std::string::npos) << name;
}

// Cut anywhere, every format says so; DevIL does not end on a PNG whose pixels end early.
TEST(PictureHeader, PicturesCutAnywhereAreRefused) {
  const TempFolder folder;
  writePng(folder / "a.png", {32, 32, std::vector<std::uint8_t>(4096, 200), false});
  const std::pair<std::string, std::string> whole[] = {{"a.png", readFileText(folder / "a.png")},
                                                       {"a.jpg", fromHex(kJpegHex)},
                                                       {"a.tga", tga(2, 8, 4, 24, std::string(96, 'x'))},
                                                       {"b.tga", tga(10, 100, 1, 24,
                                                                     "\xe3"
                                                                     "xyz")},
                                                       {"a.bmp", bmp(8, 4, 24, "", std::string(96, 'x'))}};
  for (const auto& picture : whole) {
    const std::string &name = picture.first, &content = picture.second;
    EXPECT_EQ(badInputMessage([&] { readBitmap(folder.write(name, content)); }), "") << name;
    for (std::size_t size = 0; size<content.size(); size += content.size()> 600 ? 7 : 1) {
      const std::string message = badInputMessage(
          [&] { checkPicture(std::span(reinterpret_cast<const std::uint8_t*>(content.data()), size), folder / name); });
      EXPECT_FALSE(message.empty()) << name << " of " << size << " bytes";
    }
  }
}

TEST(PictureHeader, SizesBeyondTheFilesBytesAreRefused) {
  const TempFolder folder;
  refusal(folder, "a.bmp", bmp(30000, 30000, 24, "", ""));
  refusal(folder, "a.tga", tga(2, 30000, 30000, 32, ""));
  refusal(folder, "b.tga", tga(10, 30000, 30000, 32, std::string(50, '\xff')));
  EXPECT_NE(
      refusal(folder, "a.png", pngHead(16000, 16000) + pngChunk("IDAT", std::string(32000, 'x')) + pngChunk("IEND", ""))
          .find("1032 a byte"),
      std::string::npos);
  refusal(folder, "b.png", pngHead(0, 4) + pngChunk("IDAT", "x") + pngChunk("IEND", ""));
  refusal(folder, "c.png", pngHead(0x7fffffff, 0x7fffffff) + pngChunk("IDAT", "x") + pngChunk("IEND", ""));
  const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n";
  EXPECT_NE(badInputMessage([&] { readImage(folder.write("a.hdr", hdr)); }).find("a byte"), std::string::npos);
  EXPECT_NE(badInputMessage([&] { readImage(folder.write("a.pfm", "PF\n16384 16384\n-1\n")); }).find("truncated"),
            std::string::npos);
}

// An attribute of 1.2 GB in a file of 33 bytes.
TEST(PictureHeader, ExrAttributesHoldNoMoreThanTheFile) {
  const TempFolder folder;
  const auto file = folder.write(
      "a.exr", std::string("\x76\x2f\x31\x01\x02\0\0\0", 8) + std::string("owner\0string\0\x58\x47\x45\x49zz", 19));
  EXPECT_NE(badInputMessage([&] { readImage(file); }).find("within its header"), std::string::npos);
}

TEST(PictureHeader, PacketsAndPalettesStayWithinTheirPicture) {
  const TempFolder folder;
  EXPECT_NE(refusal(folder, "a.tga",
                    tga(10, 2, 1, 24,
                        "\xff"
                        "abc"))
                .find("runs over"),
            std::string::npos);
  EXPECT_NE(refusal(folder, "b.tga",
                    tga(1, 2, 1, 8,
                        "abcdef"
                        "\x01\x02",
                        2))
                .find("palette"),
            std::string::npos);
  EXPECT_NE(refusal(folder, "c.tga",
                    tga(9, 2, 1, 8,
                        "abcdef"
                        "\x81\x02",
                        2))
                .find("palette"),
            std::string::npos);
}

}  // namespace
}  // namespace lucerna
