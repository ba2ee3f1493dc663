// The radiosity original's files, models, map and switches: everything of it that needs no GL.
#include "radiosity/original/checkpoint.hpp"
#include "radiosity/original/display.hpp"
#include "radiosity/original/map.hpp"
#include "radiosity/original/rad_file.hpp"
#include "radiosity/original/rad_models.hpp"
#include "support/temp_folder.hpp"

#include "base/files.hpp"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <tuple>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::TempFolder;

RadTriangle someTriangle() {
  RadTriangle t;
  t.p1 = {0, 0, 0}, t.p2 = {2, 0, 0}, t.p3 = {0, 3, 0}, t.n = {0, 0, 1}, t.c = {0.5f, 0.25f, 0.125f};
  t.ro = 0.5f, t.e = 0x010203, t.b = 0x040506;
  return t;
}

glm::dvec3 vec(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }

TEST(RadFile, LiesAsPublished) {
  const std::vector<RadTriangle> triangles{someTriangle()};
  const std::vector<std::uint8_t> bytes = encodeRadFile(triangles);
  ASSERT_EQ(bytes.size(), 76u);
  const std::vector<std::uint8_t> count{1, 0, 0, 0}, tail{0x03, 0x02, 0x01, 0x00, 0x06, 0x05, 0x04, 0x00};
  EXPECT_TRUE(std::equal(count.begin(), count.end(), bytes.begin()));
  EXPECT_TRUE(std::equal(tail.begin(), tail.end(), bytes.begin() + 68)) << "e and b end a triangle, lowest byte first";
  const auto floatAt = [&](std::size_t at) {
    float value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  EXPECT_EQ(floatAt(4 + 12), 2.0f) << "p2.x";
  EXPECT_EQ(floatAt(4 + 28), 3.0f) << "p3.y";
  EXPECT_EQ(floatAt(4 + 44), 1.0f) << "n.z";
  EXPECT_EQ(floatAt(4 + 48), 0.5f) << "c";
  EXPECT_EQ(floatAt(4 + 60), 0.5f) << "ro";
}

TEST(RadFile, AnyBytesComeBackAsTheyWere) {
  // Whatever 72 bytes hold: quiet and signalling NaN, infinity, negative zero, denormals, no area.
  std::vector<std::uint8_t> bytes(4 + 72 * 50);
  std::uint32_t state = 1;
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((state = state * 1664525u + 1013904223u) >> 24);
  const std::uint32_t count = 50, signalling = 0x7fa00001u;
  std::memcpy(bytes.data(), &count, 4);
  std::memcpy(bytes.data() + 4, &signalling, 4);
  std::memset(bytes.data() + 4 + 72, 0, 72);
  EXPECT_EQ(encodeRadFile(decodeRadFile(bytes, "x")), bytes);

  const TempFolder folder;
  writeRadFile(folder / "a.rad", decodeRadFile(bytes, "x"));
  EXPECT_EQ(readFileBytes(folder / "a.rad"), bytes);
  EXPECT_EQ(encodeRadFile(readRadFile(folder / "a.rad")), bytes);
  EXPECT_EQ(folder.listing().find("tmp"), std::string::npos) << folder.listing();
}

TEST(RadFile, WrongSizesAndByteOrderAreRefused) {
  const auto refusal = [](std::vector<std::uint8_t> bytes) {
    return badInputMessage([&] { decodeRadFile(bytes, "some.rad"); });
  };
  std::vector<std::uint8_t> bytes = encodeRadFile(std::vector<RadTriangle>(3, someTriangle()));
  auto truncated = bytes;
  truncated.pop_back();
  std::string message = refusal(truncated);
  for (const char* part : {"some.rad", "3 triangles", "220", "219"})
    EXPECT_NE(message.find(part), std::string::npos) << message;
  auto tooLong = bytes;
  tooLong.push_back(0);
  EXPECT_NE(refusal(tooLong).find("221"), std::string::npos);
  auto turned = bytes;
  std::reverse(turned.begin(), turned.begin() + 4);
  message = refusal(turned);
  EXPECT_NE(message.find("byte order"), std::string::npos) << message;
  EXPECT_NE(message.find("3 triangles"), std::string::npos) << message;
  EXPECT_NE(refusal({1, 0}).find("2 bytes"), std::string::npos);
  EXPECT_NE(refusal({}).find("0 bytes"), std::string::npos);
  EXPECT_NE(refusal({0, 0, 0, 0}).find("no triangle"), std::string::npos);
  // A count whose size does not fit 32 bits.
  EXPECT_NE(refusal({0xff, 0xff, 0xff, 0xff, 0}).find("309237645244"), std::string::npos)
      << refusal({0xff, 0xff, 0xff, 0xff, 0});
}

TEST(RadFile, WrongTrianglesAreRefusedByNumber) {
  const auto refusal = [](auto change) {
    std::vector<RadTriangle> triangles(5, someTriangle());
    change(triangles[3]);
    return badInputMessage([&] { checkRadTriangles(triangles, "some.rad"); });
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const std::vector<std::pair<std::string, std::string>> cases{
      {refusal([&](RadTriangle& t) { t.p2[1] = nan; }), "not a finite number"},
      {refusal([&](RadTriangle& t) { t.p3[2] = infinity; }), "not a finite number"},
      {refusal([&](RadTriangle& t) { t.ro = 1.0001f; }), "reflectance 1.0001"},
      {refusal([&](RadTriangle& t) { t.ro = nan; }), "reflectance nan"},
      {refusal([&](RadTriangle& t) { t.ro = -0.1f; }), "reflectance -0.1"},
      {refusal([&](RadTriangle& t) { t.e = 1u << 24; }), "16777216"},
      {refusal([&](RadTriangle& t) { t.b = 0xffffffffu; }), "4294967295"},
      {refusal([&](RadTriangle& t) {
         t.n = {0, 0, 2};
       }),
       "length 2"},
      {refusal([&](RadTriangle& t) {
         t.n = {nan, 0, 0};
       }),
       "length nan"},
  };
  for (const auto& [message, part] : cases) {
    EXPECT_NE(message.find("some.rad: triangle 3"), std::string::npos) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  EXPECT_EQ(refusal([](RadTriangle& t) { t.ro = 1.0f, t.e = t.b = kRadMost; }), "");
}

TEST(RadFile, TrianglesWithoutAreaAreCounted) {
  std::vector<RadTriangle> triangles(4, someTriangle());
  triangles[1].p3 = triangles[1].p2;
  triangles[2].p3 = {1e-9f, 0, 0};  // on the line through the other two
  triangles[2].n = {0, 0, 0};  // and so without a normal
  EXPECT_EQ(checkRadTriangles(triangles, "x"), 2u);
  EXPECT_EQ(areaOf(triangles[0]), 3.0);
  for (RadTriangle& t : triangles) t.p2 = t.p1;
  EXPECT_NE(badInputMessage([&] { checkRadTriangles(triangles, "x"); }).find("none of its 4"), std::string::npos);
}

// [RAD2008 table 4.1]
TEST(RadModels, HallHasThePublishedNumbersOfTriangles) {
  for (const auto& [threshold, published] :
       {std::pair{5.0, 26360.0}, std::pair{1.0, 136512.0}, std::pair{0.25, 546048.0}}) {
    RadModelSettings settings;
    settings.areaThreshold = threshold;
    EXPECT_NEAR(static_cast<double>(makeRadModel(2, settings).size()) / published, 1.0, 0.05) << threshold;
  }
}

TEST(RadModels, TrianglesAreSmallWellShapedAndFaceTheAir) {
  for (int model : {1, 2, 3}) {
    RadModelSettings settings;
    settings.areaThreshold = 5.0, settings.reflectance = 0.25, settings.lightPower = 123456;
    const std::vector<RadTriangle> triangles = makeRadModel(model, settings);
    EXPECT_EQ(checkRadTriangles(triangles, "model"), 0u);
    glm::dvec3 sum(0.0);
    double total = 0.0, worst = 1.0, largest = 0.0, source = 0.0;
    for (const RadTriangle& t : triangles) {
      const glm::dvec3 a = vec(t.p1), b = vec(t.p2), c = vec(t.p3);
      std::array<double, 3> sides{glm::length(b - a), glm::length(c - b), glm::length(a - c)};
      std::sort(sides.begin(), sides.end());
      worst = std::max(worst, sides[2] / sides[0]);
      largest = std::max(largest, areaOf(t));
      sum += areaOf(t) * vec(t.n);
      total += areaOf(t);
      EXPECT_GT(glm::dot(glm::normalize(glm::cross(b - a, c - a)), vec(t.n)), 0.999)
          << "model " << model << ": corners turn about the normal";
      EXPECT_EQ(t.ro, 0.25f);
      EXPECT_TRUE(t.e == 0 || t.e == 123456u);
      EXPECT_EQ(t.b, 0u);
      if (t.e > 0) source += areaOf(t);
    }
    EXPECT_LT(largest, 5.0 * (1.0 + 1e-6)) << model;
    EXPECT_LT(worst, 2.0) << model;
    EXPECT_GT(source, 0.0) << model;
    EXPECT_LT(source, 0.05 * total) << model;
    if (model != 2) {  // there the ends of columns and boxes that touch something are left out
      EXPECT_LT(glm::length(sum), 1e-4 * total) << "a closed surface's area vectors cancel";
    }
  }
  const std::string message = badInputMessage([] { makeRadModel(4, {}); });
  EXPECT_NE(message.find("MODEL 4"), std::string::npos) << message;
  EXPECT_NE(badInputMessage([] { makeRadModel(2, {1e-6, 0.5, 1}); }).find("triangles"), std::string::npos);
  EXPECT_NE(badInputMessage([] { makeRadModel(2, {0.0, 0.5, 1}); }).find("AREA_THRESHOLD 0"), std::string::npos);
  EXPECT_NE(badInputMessage([] { makeRadModel(2, {1.0, 1.5, 1}); }).find("REFLECTANCE 1.5"), std::string::npos);
}

TEST(RadMap, WeightsSumToOne) {
  for (bool published : {true, false})
    for (int view : {2, 3, 16, 101, 500}) {
      const MultiplierMap map = makeMultiplierMap(view, published);
      ASSERT_EQ(map.top.size(), static_cast<std::size_t>(view * view));
      ASSERT_EQ(map.side.size(), static_cast<std::size_t>(view * (view / 2)));
      const double sum = std::accumulate(map.top.begin(), map.top.end(), 0.0) +
                         4.0 * std::accumulate(map.side.begin(), map.side.end(), 0.0);
      EXPECT_NEAR(sum, 1.0, 1e-6) << view;
    }
}

// The known figures of both maps: weight of the middle times N^2, and the top face's share.
TEST(RadMap, CentreWeightAndTopShareAreKnown) {
  for (const auto& [published, centre, share] :
       {std::tuple{true, 0.82303, 0.52634}, std::tuple{false, 4.0 / 3.14159265358979, 0.55413}}) {
    const MultiplierMap map = makeMultiplierMap(1024, published);
    EXPECT_NEAR(static_cast<double>(map.top[512 * 1024 + 512]) * 1024.0 * 1024.0, centre, 1e-5) << published;
    EXPECT_NEAR(std::accumulate(map.top.begin(), map.top.end(), 0.0), share, 1e-5) << published;
  }
}

TEST(RadMap, SidesCountLeastAtTheHorizon) {
  for (bool published : {true, false}) {
    const MultiplierMap map = makeMultiplierMap(8, published);
    for (std::size_t row = 1; row < 4; ++row) EXPECT_LT(2.0f * map.side[4], map.side[8 * row + 4]) << row;
    EXPECT_EQ(map.side[3], map.side[4]);
    EXPECT_LT(map.side[0], map.side[3]);
  }
}

TEST(RadSwitches, AreNamedAndSet) {
  const RadiosityDeviations published = publishedRadiosity();
  EXPECT_EQ(activeRadiosityDeviations(published).size(), 5u);
  EXPECT_TRUE(activeRadiosityDeviations({}).empty());
  RadiosityDeviations some = published;
  applyRadiosityDeviation(some, "radiosity.24-bit=off");
  EXPECT_FALSE(some.values24Bit);
  EXPECT_EQ(activeRadiosityDeviations(some).size(), 4u);
  EXPECT_NE(
      badInputMessage([&] { applyRadiosityDeviation(some, "radiosity.bits=off"); }).find("radiosity.published-map"),
      std::string::npos);
  EXPECT_NE(badInputMessage([&] { applyRadiosityDeviation(some, "radiosity.24-bit"); }).find("NAME=on"),
            std::string::npos);
}

TEST(RadSwitches, HaveTheirLineInTheReadme) {
  const std::string readme = readFileText(std::filesystem::path(LUCERNA_SOURCE_DIR) / "engine/radiosity/README.md");
  for (const RadiosityDeviation& deviation : allRadiosityDeviations())
    EXPECT_NE(readme.find(fmt::format("| `{}` ", deviation.name)), std::string::npos) << deviation.name;
}

TEST(RadCheckpoint, ComesBackAndDamageIsFound) {
  const TempFolder folder;
  OriginalCheckpoint c;
  c.before = 1, c.after = 2, c.settings = 3;
  c.progress.received = {1.5f, 2.25f, 16777215.0f}, c.progress.next = {7.5f, 2.25f, 16777215.0f};
  c.progress.done = 1, c.progress.change = 6.0, c.progress.sweeps = 4;
  writeCheckpoint(folder / "x.sweep", c);
  const OriginalCheckpoint d = readCheckpoint(folder / "x.sweep");
  EXPECT_EQ(std::tie(d.before, d.after, d.settings), std::tie(c.before, c.after, c.settings));
  EXPECT_EQ(d.progress.received, c.progress.received);
  EXPECT_EQ(d.progress.next, c.progress.next);
  EXPECT_EQ(std::tie(d.progress.done, d.progress.change, d.progress.sweeps),
            std::tie(c.progress.done, c.progress.change, c.progress.sweeps));

  const std::vector<std::uint8_t> bytes = readFileBytes(folder / "x.sweep");
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto damaged = bytes;
    damaged[i] ^= 0x10;
    writeFileAtomically(folder / "y.sweep", damaged);
    EXPECT_NE(badInputMessage([&] { readCheckpoint(folder / "y.sweep"); }).find("y.sweep"), std::string::npos)
        << "byte " << i;
  }
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    writeFileAtomically(folder / "y.sweep", std::span(bytes).first(length));
    EXPECT_NE(badInputMessage([&] { readCheckpoint(folder / "y.sweep"); }), "") << length << " bytes";
  }
}

// A floor of two triangles and a wall beside them, which meet in two corners.
TEST(RadDisplayColours, CornersHaveTheMeanOfWhatMeetsThere) {
  RadTriangle a, b, wall;
  a.p1 = {0, 0, 0}, a.p2 = {0, 0, 2}, a.p3 = {2, 0, 0}, a.n = {0, 1, 0}, a.b = 100;
  b.p1 = {2, 0, 2}, b.p2 = {2, 0, 0}, b.p3 = {0, 0, 2}, b.n = {0, 1, 0}, b.b = 10000;
  wall.p1 = {0, 0, 0}, wall.p2 = {0, 3, 0}, wall.p3 = {0, 0, 2}, wall.n = {1, 0, 0}, wall.b = 1000000;
  b.p1 = {4, 0, 4};  // three times as large as a
  const std::vector<RadTriangle> triangles{a, b, wall};
  RadDisplay display;
  const auto grey = [](double value) { return static_cast<float>(std::log(value / 50.0) / std::log(1e6 / 50.0)); };
  const auto check = [&](std::size_t triangle, std::size_t corner, float expected) {
    EXPECT_NEAR(cornerColours(triangles, display)[triangle][corner].x, expected, 1e-6f)
        << triangle << ", " << corner << ", " << nameOf(display.shading);
  };
  check(0, 1, grey(100));
  // As published: colours, of everything that meets, over the edge too.
  display.shading = RadShading::acrossEdges;
  check(0, 0, (grey(100) + grey(1000000)) / 2.0f);
  check(0, 1, (grey(100) + grey(10000) + grey(1000000)) / 3.0f);
  check(0, 2, (grey(100) + grey(10000)) / 2.0f);
  check(1, 0, grey(10000));
  check(2, 2, (grey(100) + grey(10000) + grey(1000000)) / 3.0f);
  // Values by area, of the floor alone.
  display.shading = RadShading::withinFaces;
  check(0, 0, grey(100));
  check(0, 1, grey((100.0 + 3.0 * 10000.0) / 4.0));
  check(2, 2, grey(1000000));
}

TEST(RadDisplayColours, FollowTheirMapping) {
  std::vector<RadTriangle> triangles(3, someTriangle());
  triangles[0].e = 0, triangles[0].b = 0;
  triangles[1].e = 0, triangles[1].b = 1000;
  triangles[2].e = 500000, triangles[2].b = 0;
  RadDisplay display;
  auto colours = displayColours(triangles, display);
  EXPECT_EQ(blackOf(triangles), 500.0) << "half of the least that is lit";
  EXPECT_EQ(colours[0].x, 0.0f);
  EXPECT_NEAR(colours[1].x, std::log10(2.0) / 3.0, 1e-6f) << "a factor of 2 of 1000";
  EXPECT_EQ(colours[2].x, 1.0f);
  display.mapping = RadMapping::linear, display.constant = 1.0 / 2000.0;
  colours = displayColours(triangles, display);
  EXPECT_NEAR(colours[1].x, 0.5f, 1e-6f);
  EXPECT_EQ(colours[2].x, 1.0f);
  display.mapping = RadMapping::bits24;
  triangles[2].e = 0x102030;
  EXPECT_EQ(displayColours(triangles, display)[2], glm::vec3(0x10, 0x20, 0x30) / 255.0f);
  // Of a triangle that is flat all corners are alike.
  EXPECT_EQ(cornerColours(triangles, display)[2][1], glm::vec3(0x10, 0x20, 0x30) / 255.0f);
  EXPECT_EQ(parseName<RadMapping>("filmic", ""), RadMapping::filmic);
  EXPECT_NE(badInputMessage([] { parseName<RadMapping>("x", ""); }).find("log, linear"), std::string::npos);
}

}  // namespace
}  // namespace lucerna
