// Files that were made to break something: nested without end, forged with right checksums, in circles, or cut. Each is
// one clear line; none crashes, hangs or asks for memory out of proportion.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"
#include "base/json.hpp"
#include "measure/reference.hpp"
#include "radiosity/row_file.hpp"
#include "radiosity/solution.hpp"
#include "scene/scene.hpp"
#include "scene/scene_file.hpp"
#include "support/contains.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::TempFolder;

std::string repeated(std::string_view part, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += part;
  return text;
}

std::string refusal(const TempFolder& folder, std::string_view name, std::string_view content) {
  const auto file = folder.write(name, content);
  const std::string message = badInputMessage([&] { loadScene(file); });
  EXPECT_TRUE(contains(message, name)) << message;
  return message;
}

TEST(BrokenInputs, DeepJsonIsRefused) {
  const TempFolder folder;
  for (const int depth : {201, 100000}) {
    const std::string deep = repeated("[", depth) + repeated("]", depth);
    EXPECT_TRUE(contains(refusal(folder, "a.json", "{\"model\": " + deep + "}"), "nested")) << depth;
    EXPECT_TRUE(contains(refusal(folder, "a.gltf", "{\"extras\": " + deep + "}"), "nested")) << depth;
    EXPECT_TRUE(contains(refusal(folder, "b.json", repeated("{\"a\":", depth)), "nested")) << depth;
  }
  EXPECT_NO_THROW(
      checkJsonDepth("[\"" + repeated("[", 1000) + "\\\"" + repeated("{", 1000) + "\"]", "brackets in a text"));
  EXPECT_NO_THROW(checkJsonDepth(repeated("[", kMostJsonDepth) + repeated("]", kMostJsonDepth), "as deep as may be"));
}

/// A triangle of glTF whose nodes are given.
std::string gltfWithNodes(const std::string& nodes) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,
         "componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
         "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,
         "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

std::string nodeChain(int count) {
  std::string nodes = "[";
  for (int i = 0; i + 1 < count; ++i) nodes += "{\"children\":[" + std::to_string(i + 1) + "]},";
  return nodes + "{\"mesh\":0}]";
}

TEST(BrokenInputs, NodesThatAreNoTreesAreRefused) {
  const TempFolder folder;
  EXPECT_EQ(loadScene(folder.write("good.gltf", gltfWithNodes(nodeChain(500)))).triangleCount(), 1u);
  EXPECT_TRUE(contains(refusal(folder, "deep.gltf", gltfWithNodes(nodeChain(100000))), "more than 1000"));
  EXPECT_TRUE(
      contains(refusal(folder, "self.gltf", gltfWithNodes(R"([{"children":[0],"mesh":0}])")), "its own descendant"));
  EXPECT_TRUE(contains(refusal(folder, "ring.gltf", gltfWithNodes(R"([{"mesh":0},{"children":[2]},{"children":[1]}])")),
                       "its own descendant"));
  // Each node twice below the one before: 2^30 copies.
  std::string doubled = "[";
  for (int i = 0; i < 30; ++i) doubled += fmt::format("{{\"children\":[{0},{0}]}},", i + 1);
  EXPECT_TRUE(contains(refusal(folder, "doubled.gltf", gltfWithNodes(doubled + "{\"mesh\":0}]")), "must be trees"));
  EXPECT_TRUE(
      contains(refusal(folder, "none.gltf", gltfWithNodes(R"([{"children":[7],"mesh":0}])")), "no such node: 7"));
}

TEST(BrokenInputs, AccessorsHoldNoMoreThanTheirBytes) {
  const TempFolder folder;
  std::string text = gltfWithNodes(R"([{"mesh":0}])");
  text.replace(text.find("\"count\":3"), 9, "\"count\":400000000");
  EXPECT_TRUE(contains(refusal(folder, "a.gltf", text), "accessor 0"));
  text.replace(text.find("\"bufferView\":0,"), 15, "");
  EXPECT_TRUE(contains(refusal(folder, "b.gltf", text), "accessor 0"));
}

// Assimp leaves a node of such a file null.
TEST(BrokenInputs, RawFilesWithoutAnyTriangleAreRefused) {
  const TempFolder folder;
  for (const char* text : {"object\n", "1 2 3\nx\n", "a\nb\nc\n", "0 0 0 1 1 1 2 2 2\nname\n"}) {
    const auto file = folder.write("a.raw", text);
    badInputMessage([&] { loadScene(file); });  // an error or none, but no crash
  }
}

TEST(BrokenInputs, ObjNumbersThatBeginWithADotAndIndentedLinesAreRead) {
  const TempFolder folder;
  const auto bounds = [&](const std::string& obj) { return loadScene(folder.write("dot.obj", obj)).bounds; };
  EXPECT_EQ(bounds("v 0 0 0\nv 1 .0 0\nv 0 1 .0\nv 1 1 1\nf 1 2 3\n").max, glm::dvec3(1, 1, 0));
  EXPECT_EQ(bounds("v .5 -.5 0\n v\t+.5 .25 .0\nv 0. 1 .5e1\nf 1 2 3\n").max, glm::dvec3(0.5, 1, 5));
  EXPECT_EQ(bounds("v 0 0 0\n\t v 1 0 \\\n .5\nv 0 1 \\\r\n.25\n  f 1 2 \\\n 3\n").max, glm::dvec3(1, 1, 0.5));
  EXPECT_EQ(bounds("v .5 -.5 0\n v\t+.5 .25 .0\nv 0. 1 .5e1\nf 1 2 3\n").min, glm::dvec3(0, -0.5, 0));
}

TEST(BrokenInputs, ObjIndicesAtTheEndsOfTheirTypeAreRefused) {
  const TempFolder folder;
  for (const char* index :
       {"-9223372036854775808", "9223372036854775807", "-9223372036854775809", "99999999999999999999"})
    EXPECT_TRUE(
        contains(refusal(folder, "a.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 ") + index + "\n"), "a.obj:4"))
        << index;
}

// Written for the other handedness: shading turns normals to the viewer by the side of the face, so that such a sheet
// was lit from behind.
TEST(BrokenInputs, FacesFollowTheNormalsOfTheirMesh) {
  const TempFolder folder;
  const Scene scene = loadScene(
      folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 -1\nf 1//1 2//1 3//1\nf 2//1 4//1 3//1\n"));
  for (std::size_t t = 0; t < 2; ++t) {
    const auto corner = [&](std::size_t k) { return scene.vertices[scene.indices[3 * t + k]].position; };
    EXPECT_LT(glm::cross(corner(1) - corner(0), corner(2) - corner(0)).z, 0.0f);
    EXPECT_EQ(scene.vertices[scene.indices[3 * t]].normal, glm::vec3(0, 0, -1));
  }
}

TEST(BrokenInputs, ACameraThatSeesNothingDoesNotComeFirst) {
  const TempFolder folder;
  const auto first = [&](const std::string& translation) {
    std::string text = gltfWithNodes(R"([{"mesh":0},{"camera":0,"translation":)" + translation + "}]");
    text.replace(text.find("\"nodes\":[0]"), 11, "\"nodes\":[0,1]");
    text.insert(1, R"("cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}],)");
    const Scene scene = loadScene(folder.write("a.gltf", text));
    return scene.cameras.front().name == "default" ? scene.cameras.size() : 0;
  };
  EXPECT_EQ(first("[0,0,5]"), 0u);  // looks along -z
  EXPECT_EQ(first("[0,0,-5]"), 2u);
}

// ---------------------------------------------------------------------------------------------------- forged, with
// right checksums

constexpr std::uint64_t kFingerprint = 7;

/// A row file of one row that sees patch 1; `forge` changes its block's words (first, rows, entries, then counts,
/// fronts, backs, patches, factors) before its sum is made.
std::filesystem::path rowFile(const TempFolder& folder, const std::function<void(std::vector<std::uint32_t>&)>& forge) {
  const auto file = folder / "rows";
  std::filesystem::remove(file);
  {
    RowFile rows(file, kFingerprint, 4, [](const FormFactorRows&) {});
    FormFactorRows one;
    one.counts = {1}, one.fronts = {0.5f}, one.backs = {0.0f}, one.patches = {1}, one.factors = {0.5f};
    rows.append(one);
  }
  std::string bytes = readFileText(file);
  constexpr std::size_t kHeader = 24, kSum = 16;  // of the file; where a block's checksum stands
  std::vector<std::uint32_t> words((bytes.size() - kHeader) / 4);
  std::memcpy(words.data(), bytes.data() + kHeader, 4 * words.size());
  forge(words);
  Hash sum;
  sum.bytes(words.data(), kSum);
  sum.bytes(words.data() + 6, 4 * words.size() - 24);
  const std::uint64_t value = sum.value();
  std::memcpy(words.data() + 4, &value, sizeof value);
  bytes.replace(kHeader, 4 * words.size(), reinterpret_cast<const char*>(words.data()), 4 * words.size());
  return folder.write("rows", bytes);
}

std::size_t rowsTaken(const std::filesystem::path& file) {
  std::size_t taken = 0;
  RowFile rows(file, kFingerprint, 4, [&](const FormFactorRows& r) { taken += r.counts.size(); });
  return taken;
}

TEST(BrokenInputs, ForgedRowsAreNotTaken) {
  const TempFolder folder;
  enum { first, rowCount, entries, entriesHigh, sum, sumHigh, count, front, back, patch, factor };
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  EXPECT_EQ(rowsTaken(rowFile(folder, [](auto&) {})), 1u);
  EXPECT_EQ(rowsTaken(rowFile(folder, [](auto& w) { w[patch] = 4; })), 0u);
  EXPECT_EQ(rowsTaken(rowFile(folder, [](auto& w) { w[count] = 2; })), 0u);
  EXPECT_EQ(rowsTaken(rowFile(folder, [](auto& w) { w[count] = 0; })), 0u);
  EXPECT_EQ(rowsTaken(rowFile(folder, [&](auto& w) { w[factor] = bits(NAN); })), 0u);
  EXPECT_EQ(rowsTaken(rowFile(folder, [&](auto& w) { w[factor] = bits(-1.0f); })), 0u);
  EXPECT_EQ(rowsTaken(rowFile(folder, [&](auto& w) { w[front] = bits(2.0f); })), 0u);
  EXPECT_EQ(rowsTaken(rowFile(folder, [](auto& w) { w[entriesHigh] = 0x20000000; })),
            0u);  // 8 times that is 0 in 64 bits
}

measure::Reference smallReference() {
  measure::Reference r;
  r.mean = Image(2, 1, glm::vec3(1.0f));
  r.standardError = Image(2, 1, glm::vec3(0.1f));
  r.samples = 4;
  r.renderer = "a renderer";
  return r;
}

TEST(BrokenInputs, ForgedReferencesAreNotTaken) {
  const TempFolder folder;
  const measure::ReferenceCache cache(folder.path());
  const measure::ReferenceKey key{5};
  cache.store(key, smallReference());
  ASSERT_TRUE(cache.load(key));
  const std::string name = key.name() + ".lucref", whole = readFileText(folder / name);
  const auto forged = [&](std::size_t at, auto value) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    const std::uint64_t sum = Hash::of(bytes.data(), bytes.size() - 8);
    std::memcpy(bytes.data() + bytes.size() - 8, &sum, 8);
    folder.write(name, bytes);
    return cache.load(key).has_value();
  };
  enum { samples = 16, seconds = 24, width = 40, height = 44, transport = 48, rendererLength = 52 };
  EXPECT_TRUE(forged(samples, std::uint64_t{9}));
  for (const std::int32_t side : {-1, 0, 1, 3, 16384, std::numeric_limits<std::int32_t>::max()}) {
    EXPECT_FALSE(forged(width, side)) << side;
    if (side != 1) { EXPECT_FALSE(forged(height, side)) << side; }
  }
  for (const std::int32_t length : {-1, 0, 1 << 20, std::numeric_limits<std::int32_t>::min()})
    EXPECT_FALSE(forged(rendererLength, length)) << length;
  EXPECT_FALSE(forged(transport, std::int32_t{77}));
  EXPECT_FALSE(forged(samples, std::uint64_t{0}));
  EXPECT_FALSE(forged(seconds, std::numeric_limits<double>::quiet_NaN()));
}

/// A scene of one triangle, and a solution of it whose bytes `forge` changes before the sum is made.
TEST(BrokenInputs, ForgedSolutionsAreRefused) {
  const TempFolder folder;
  const Scene scene = loadScene(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  RadiositySolution s;
  s.mesh = makePatches(scene, {});
  const std::size_t n = s.mesh.patches.size();
  s.direct = s.fromEmitters = s.fromSky = s.irradiance = s.exitance = std::vector<glm::dvec3>(n, glm::dvec3(1.0));
  s.fronts = s.backs = std::vector<float>(n, 0.0f);
  saveSolution(folder / "solution", scene, s);
  const std::string whole = readFileText(folder / "solution");
  const auto message = [&](const std::function<void(std::string&)>& forge) {
    std::string bytes = whole;
    forge(bytes);
    const std::uint64_t sum = Hash::of(bytes.data() + 104, bytes.size() - 104);
    std::memcpy(bytes.data() + 56, &sum, 8);
    const auto file = folder.write("forged", bytes);
    return badInputMessage([&] { loadSolution(file, scene); });
  };
  const auto put = [](std::string& bytes, std::size_t at, auto value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  EXPECT_EQ(message([](std::string&) {}), "");
  EXPECT_TRUE(contains(message([&](std::string& b) { put(b, 12, std::uint32_t{99}); }), "solver"));
  EXPECT_TRUE(contains(message([&](std::string& b) { put(b, 48, std::uint64_t{1} << 60); }), "light vertices"));
  EXPECT_TRUE(
      contains(message([&](std::string& b) { put(b, 80, std::numeric_limits<double>::quiet_NaN()); }), "finite"));
  EXPECT_TRUE(contains(message([&](std::string& b) { put(b, b.size() - 8, std::numeric_limits<double>::infinity()); }),
                       "patch"));
  EXPECT_TRUE(
      contains(message([&](std::string& b) { put(b, 104, std::numeric_limits<double>::quiet_NaN()); }), "finite"));
  EXPECT_TRUE(contains(
      message([&](std::string& b) { b.resize(104), put(b, 32, std::uint64_t{0}), put(b, 40, std::uint64_t{0}); }),
      "without patches"));
}

}  // namespace
}  // namespace lucerna
