// glTF 2: meshes, nodes, lights and cameras by known answers [GLTF2], and files that are broken or ask for more than is
// supported.
#include "base/files.hpp"
#include "base/image.hpp"
#include "base/log.hpp"
#include "scene/scene.hpp"
#include "support/contains.hpp"
#include "support/gltf_file.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::TempFolder;
using Json = nlohmann::json;

using test::base64;
using test::bytesOf;
using test::corners;
using test::expectCorners;
using test::Gltf;

constexpr int kByte = Gltf::kByte, kUnsignedByte = Gltf::kUnsignedByte, kShort = Gltf::kShort,
              kUnsignedShort = Gltf::kUnsignedShort, kUnsignedInt = Gltf::kUnsignedInt, kFloat = Gltf::kFloat;

const std::vector<glm::vec3> kTriangle = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

// ------------------------------------------------------------------------------------------------ accessors

// 3.6.2.2 and KHR_mesh_quantization: signed integers c become max(c / (2^(n-1) - 1), -1), others c / (2^n - 1).
TEST(GltfReader, IntegersAreReadAsTheyAreOrNormalized) {
  const auto positions = [](int type, const std::string& bytes, bool normalized) {
    Gltf gltf;
    gltf.attributes()["POSITION"] = gltf.accessor(gltf.view(bytes), type, "VEC3", 3, normalized);
    gltf.root["extensionsUsed"] = gltf.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    return gltf.load();
  };
  const auto expect = [&](auto most, int type, double divisor) {
    using T = decltype(most);
    const T least = std::numeric_limits<T>::min();
    const std::string bytes = bytesOf(std::vector<T>{least, 0, 0, most, 0, 0, 0, most, 5});
    const float low = std::is_signed_v<T> ? -1.0f : 0.0f, five = static_cast<float>(5.0 / divisor);
    expectCorners(positions(type, bytes, true), {{low, 0, 0}, {1, 0, 0}, {0, 1, five}});
    const auto high = static_cast<float>(most);
    expectCorners(positions(type, bytes, false), {{static_cast<float>(least), 0, 0}, {high, 0, 0}, {0, high, 5}});
    EXPECT_TRUE(loggedWarnings().empty());
  };
  expect(std::int8_t{127}, kByte, 127.0);
  expect(std::uint8_t{255}, kUnsignedByte, 255.0);
  expect(std::int16_t{32767}, kShort, 32767.0);
  expect(std::uint16_t{65535}, kUnsignedShort, 65535.0);
}

TEST(GltfReader, NormalsAndTextureCoordinatesMayBeIntegers) {
  Gltf gltf;
  gltf.attributes()["NORMAL"] =
      gltf.accessor(gltf.view(bytesOf(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}), 4), kByte,
                    "VEC3", 3, true);
  gltf.attributes()["TEXCOORD_0"] =
      gltf.accessor(gltf.view(bytesOf(std::vector<std::uint16_t>{0, 65535, 65535, 0, 13107, 26214})), kUnsignedShort,
                    "VEC2", 3, true);
  const Scene scene = gltf.load();
  ASSERT_EQ(scene.vertices.size(), 3u);
  for (const Vertex& vertex : scene.vertices) EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
  EXPECT_LT(glm::distance(scene.vertices[0].texCoord, glm::vec2(0, 0)), 1e-6f);  // v = 0 is the bottom in a Scene
  EXPECT_LT(glm::distance(scene.vertices[1].texCoord, glm::vec2(1, 1)), 1e-6f);
  EXPECT_LT(glm::distance(scene.vertices[2].texCoord, glm::vec2(0.2f, 0.6f)), 1e-6f);
}

TEST(GltfReader, ElementsMayBeInterleavedAndSparse) {
  Gltf gltf;
  const int both = gltf.view(bytesOf({9, 0, 0, 0, 0, 0, 1, 9, 1, 0, 0, 0, 0, 1, 9, 0, 1, 0, 0, 0, 1}), 28);
  Json position = {{"bufferView", both}, {"byteOffset", 4}, {"componentType", kFloat}, {"type", "VEC3"}, {"count", 3}};
  gltf.attributes()["POSITION"] = gltf.add("accessors", position);
  position["byteOffset"] = 16;
  gltf.attributes()["NORMAL"] = gltf.add("accessors", position);
  expectCorners(gltf.load(), kTriangle);
  // The second and third vertex from elsewhere, by indices of each type; once over bytes, once over zeros.
  const int values = gltf.view(bytesOf({2, 0, 0, 0, 3, 0}));
  for (const auto& [type, indices] : {std::pair{kUnsignedByte, bytesOf(std::vector<std::uint8_t>{1, 2})},
                                      {kUnsignedShort, bytesOf(std::vector<std::uint16_t>{1, 2})},
                                      {kUnsignedInt, bytesOf(std::vector<std::uint32_t>{1, 2})}})
    for (const bool overBytes : {false, true}) {
      Gltf sparse = gltf;
      Json accessor = {{"componentType", kFloat}, {"type", "VEC3"}, {"count", 3}};
      if (overBytes) accessor["bufferView"] = sparse.view(bytesOf({0, 0, 7, 5, 5, 5, 5, 5, 5}));
      accessor["sparse"] = {{"count", 2},
                            {"indices", {{"bufferView", sparse.view(indices)}, {"componentType", type}}},
                            {"values", {{"bufferView", values}}}};
      sparse.attributes()["POSITION"] = sparse.add("accessors", accessor);
      expectCorners(sparse.load(), {{0, 0, overBytes ? 7 : 0}, {2, 0, 0}, {0, 3, 0}});
    }
}

TEST(GltfReader, IndicesMayBeOfEachType) {
  for (const auto& [type, bytes] : {std::pair{kUnsignedByte, bytesOf(std::vector<std::uint8_t>{1, 2, 0})},
                                    {kUnsignedShort, bytesOf(std::vector<std::uint16_t>{1, 2, 0})},
                                    {kUnsignedInt, bytesOf(std::vector<std::uint32_t>{1, 2, 0})}}) {
    Gltf gltf;
    gltf.primitive()["indices"] = gltf.accessor(gltf.view(bytes), type, "SCALAR", 3);
    expectCorners(gltf.load(), {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}});
  }
}

TEST(GltfReader, BrokenAccessorsAreRefused) {
  const auto refusal = [](auto&& breakIt) {
    Gltf gltf;
    gltf.primitive()["indices"] =
        gltf.accessor(gltf.view(bytesOf(std::vector<std::uint16_t>{0, 1, 2, 3})), kUnsignedShort, "SCALAR", 3);
    breakIt(gltf.root);
    return gltf.refusal();
  };
  const auto expect = [&](std::string_view part, auto&& breakIt) {
    const std::string message = refusal(breakIt);
    EXPECT_TRUE(contains(message, part)) << message;
    EXPECT_TRUE(contains(message, "a.gltf")) << message;
  };
  expect("accessor 0: 4 elements", [](Json& g) { g["accessors"][0]["count"] = 4; });
  expect("accessor 0", [](Json& g) { g["accessors"][0]["count"] = std::uint64_t{1} << 62; });
  expect("accessor 0: 3 elements", [](Json& g) { g["accessors"][0]["byteOffset"] = 4; });
  expect("accessor 0: 3 elements", [](Json& g) { g["bufferViews"][0]["byteStride"] = 16; });
  expect("byteStride", [](Json& g) { g["bufferViews"][0]["byteStride"] = 8; });
  expect("buffer view 0", [](Json& g) { g["bufferViews"][0]["byteLength"] = 1000; });
  expect("buffer view 0",
         [](Json& g) { g["bufferViews"][0]["byteOffset"] = std::numeric_limits<std::uint64_t>::max(); });
  expect("bufferViews[0].buffer", [](Json& g) { g["bufferViews"][0]["buffer"] = 1; });
  expect("accessors[0].bufferView", [](Json& g) { g["accessors"][0]["bufferView"] = 7; });
  expect("accessors[0].type", [](Json& g) { g["accessors"][0]["type"] = "VEC2"; });
  expect("accessors[0].type", [](Json& g) { g["accessors"][0]["type"] = "VEC9"; });
  expect("accessors[0].componentType", [](Json& g) { g["accessors"][0]["componentType"] = 5124; });
  expect("accessors[1].componentType", [](Json& g) { g["accessors"][1]["componentType"] = kShort; });
  expect("accessors[0].count", [](Json& g) { g["accessors"][0]["count"] = -1; });
  expect("accessors[0].count", [](Json& g) { g["accessors"][0]["count"] = "3"; });
  expect("accessor 0: no elements", [](Json& g) { g["accessors"][0]["count"] = 0; });
  expect("POSITION", [](Json& g) { g["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 5; });
  expect("indices", [](Json& g) { g["meshes"][0]["primitives"][0]["indices"] = 5; });
  expect("mode", [](Json& g) { g["meshes"][0]["primitives"][0]["mode"] = 7; });
  expect("material", [](Json& g) { g["meshes"][0]["primitives"][0]["material"] = 0; });
  expect("nodes[0].mesh", [](Json& g) { g["nodes"][0]["mesh"] = 1; });
  expect("scenes[0].nodes[0]", [](Json& g) { g["scenes"][0]["nodes"][0] = 4; });
  expect("\"scene\"", [](Json& g) { g["scene"] = 4; });
  expect("nodes[0].scale", [](Json& g) { g["nodes"][0]["scale"] = {1, 2}; });
  expect("nodes[0].matrix", [](Json& g) { g["nodes"][0]["matrix"] = {1, 2}; });
  expect("\"nodes\"", [](Json& g) { g["nodes"] = 3; });
  expect("a sparse element 3, it holds 3", [](Json& g) {
    g["bufferViews"][1]["byteOffset"] = 36 + 6;
    g["bufferViews"][1]["byteLength"] = 2;
    g["meshes"][0]["primitives"][0].erase("indices");
    g["accessors"][0]["sparse"] = {{"count", 1},
                                   {"indices", {{"bufferView", 1}, {"componentType", kUnsignedShort}}},
                                   {"values", {{"bufferView", 0}}}};
  });
}

TEST(GltfReader, IndicesBeyondTheVerticesAreRefused) {
  Gltf gltf;
  gltf.primitive()["indices"] =
      gltf.accessor(gltf.view(bytesOf(std::vector<std::uint16_t>{0, 1, 3})), kUnsignedShort, "SCALAR", 3);
  EXPECT_TRUE(contains(gltf.refusal(), "index 2 refers to vertex 3, the mesh holds 3"));
  Gltf attributes;
  attributes.attributes()["NORMAL"] = attributes.floats({0, 0, 1, 0, 0, 1}, "VEC3");
  EXPECT_TRUE(contains(attributes.refusal(), "NORMAL: accessor 1 holds 2 elements, the mesh has 3 vertices"));
}

// ------------------------------------------------------------------------------------------------ files

TEST(GltfReader, BuffersAreReadFromEachKindOfPlace) {
  const TempFolder folder;
  Gltf gltf;
  expectCorners(gltf.load(), kTriangle);
  expectCorners(loadScene(folder.write("a.glb", gltf.binary())), kTriangle);
  expectCorners(loadScene(folder.write("b.gltf", gltf.binary())), kTriangle);  // told by its content
  folder.write("all my numbers.bin", gltf.numbers());
  folder.write("100%25.bin", gltf.numbers());
  for (const char* uri : {"all%20my%20numbers.bin", "all my numbers.bin", "%61ll my%20numbers.bin", "100%2525.bin",
                          "100%25.bin"}) {  // the last is the file's name as it is
    gltf.root["buffers"] = {{{"byteLength", gltf.numbers().size()}, {"uri", uri}}};
    expectCorners(loadScene(folder.write("c.gltf", gltf.text())), kTriangle);
  }
  std::string percent = "data:,";
  for (const char c : gltf.numbers()) percent += fmt::format("%{:02X}", static_cast<std::uint8_t>(c));
  gltf.root["buffers"][0]["uri"] = percent;
  expectCorners(gltf.load(), kTriangle);

  gltf.root["buffers"][0]["uri"] = "gone.bin";
  EXPECT_TRUE(contains(gltf.refusal(), "buffer 0"));
  EXPECT_TRUE(contains(gltf.refusal(), "gone.bin: no such file"));
  gltf.root["buffers"][0].erase("uri");
  EXPECT_TRUE(contains(gltf.refusal(), "buffer 0 has neither a uri nor a binary chunk"));
  gltf.root["buffers"][0]["uri"] = "data:;base64,AAAA";
  EXPECT_TRUE(contains(gltf.refusal(), "buffer 0: 36 bytes, 3 are there"));
  gltf.root["buffers"][0]["uri"] = "data:;base64,A!AA";
  EXPECT_TRUE(contains(gltf.refusal(), "base64"));
}

TEST(GltfReader, TruncatedBinaryFilesAreRefused) {
  const TempFolder folder;
  const std::string whole = Gltf().binary();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto file = folder.write("a.glb", whole.substr(0, length));
    EXPECT_TRUE(contains(badInputMessage([&] { loadScene(file); }), "a.glb")) << length;
  }
  // The header's length agrees, the chunks' do not.
  std::string shorter = whole.substr(0, whole.size() - 8);
  shorter[8] = static_cast<char>(shorter.size() & 255u);
  shorter[9] = static_cast<char>(shorter.size() >> 8);
  const auto file = folder.write("b.glb", shorter);
  EXPECT_TRUE(contains(badInputMessage([&] { loadScene(file); }), "a binary chunk of 36 bytes, 28 are there"));
}

TEST(GltfReader, OtherVersionsAreRefusedByName) {
  const auto refusal = [](const Json& asset) {
    Gltf gltf;
    gltf.root["asset"] = asset;
    return gltf.refusal();
  };
  EXPECT_TRUE(contains(refusal({{"version", "1.0"}}), "glTF 1.0 is not supported, only glTF 2.0"));
  EXPECT_TRUE(contains(refusal({{"version", "1.1"}}), "glTF 1.1 is not supported"));
  EXPECT_TRUE(contains(refusal({{"version", 1.0}}), "glTF 1.0 is not supported"));
  EXPECT_TRUE(contains(refusal({{"version", "3.0"}}), "glTF 3.0 is not supported"));
  EXPECT_TRUE(contains(refusal({{"version", "2.1"}, {"minVersion", "2.1"}}), "glTF 2.1 is not supported"));
  EXPECT_TRUE(contains(refusal(Json::object()), "not a glTF"));
  Gltf later;
  later.root["asset"] = {{"version", "2.1"}, {"minVersion", "2.0"}};
  expectCorners(later.load(), kTriangle);
  Gltf first;
  first.root.erase("asset");
  first.root["meshes"] = {{"mesh", first.root["meshes"][0]}};
  EXPECT_TRUE(contains(first.refusal(), "glTF 1.0 is not supported"));
  const TempFolder folder;
  std::string binary = Gltf().binary();
  binary[4] = 1;
  const auto file = folder.write("a.glb", binary);
  EXPECT_TRUE(contains(badInputMessage([&] { loadScene(file); }), "glTF 1.0 is not supported"));
}

TEST(GltfReader, ExtensionsThatAreNotSupportedAreNamed) {
  Gltf gltf;
  gltf.root["extensionsUsed"] = {"KHR_lights_punctual", "VENDOR_one", "KHR_xmp_json_ld", "VENDOR_two"};
  gltf.load();
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "not supported: VENDOR_one, VENDOR_two")) << loggedWarnings()[0];
  gltf.root["extensionsRequired"] = {"KHR_mesh_quantization", "VENDOR_two", "KHR_draco_mesh_compression"};
  EXPECT_TRUE(contains(gltf.refusal(), "not supported: VENDOR_two, KHR_draco_mesh_compression"));
  gltf.root["extensionsRequired"] = "VENDOR_two";
  EXPECT_TRUE(contains(gltf.refusal(), "extensionsRequired"));
}

TEST(GltfReader, APictureOfAnExtensionAloneIsNamed) {
  Gltf gltf;
  gltf.root["extensionsUsed"] = {"EXT_texture_webp"};
  gltf.root["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  gltf.root["images"] = {{{"uri", "a.webp"}}};
  gltf.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  gltf.attributes()["TEXCOORD_0"] = gltf.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  gltf.primitive()["material"] = 0;
  gltf.load();
  ASSERT_EQ(loggedWarnings().size(), 2u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "EXT_texture_webp (using a default)")) << loggedWarnings()[0];
}

// 5.26: 10497 REPEAT, also where nothing is said, 33071 CLAMP_TO_EDGE, 33648 MIRRORED_REPEAT. A picture is read once
// for each pair of them.
TEST(GltfReader, SamplersSayHowPicturesContinue) {
  Gltf gltf;
  const std::string red =
      base64(std::string("\x42\x4d\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\1\0\0\0\1\0\0\0\1\0"
                         "\x18\0\0\0\0\0\4\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xff\0",
                         58));
  gltf.attributes()["TEXCOORD_0"] = gltf.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  gltf.primitive()["material"] = 0;
  gltf.root["images"] = {{{"uri", "data:image/bmp;base64," + red}}};
  gltf.root["samplers"] = {Json{{"wrapS", 33071}, {"wrapT", 33648}}, Json{{"wrapT", 33071}}, Json::object()};
  gltf.root["textures"] = {{{"source", 0}, {"sampler", 0}},
                           {{"source", 0}, {"sampler", 1}},
                           {{"source", 0}, {"sampler", 2}},
                           {{"source", 0}}};
  gltf.root["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}},
       {"normalTexture", {{"index", 2}}},
       {"emissiveTexture", {{"index", 3}}},
       {"emissiveFactor", {1, 1, 1}}}};
  const Scene scene = gltf.load();
  EXPECT_TRUE(loggedWarnings().empty());
  const Material& material = scene.materials.at(0);
  const auto wraps = [&](int texture) { return scene.textures.at(static_cast<std::size_t>(texture)).wraps; };
  EXPECT_EQ(wraps(material.diffuseTexture), (TextureWraps{TextureWrap::edge, TextureWrap::mirror}));
  EXPECT_EQ(wraps(material.metalMap->texture), (TextureWraps{TextureWrap::repeat, TextureWrap::edge}));
  EXPECT_EQ(wraps(material.normalTexture), TextureWraps{});
  EXPECT_EQ(material.normalTexture, material.emissionTexture);
  EXPECT_EQ(scene.textures.size(), 3u);
  for (const Json& wrong : {Json(5), Json("REPEAT"), Json(33071.5)}) {
    gltf.root["samplers"][1]["wrapT"] = wrong;
    const std::string message = gltf.refusal();
    EXPECT_TRUE(contains(message, "a.gltf")) << message;
    EXPECT_TRUE(contains(message, "wrapT")) << message;
    EXPECT_TRUE(contains(message, "33071 (CLAMP_TO_EDGE)")) << message;
  }
}

TEST(GltfReader, PicturesWithPercentEncodedNamesAndInsideTheFileAreRead) {
  const TempFolder folder;
  writePng(folder / "left right \xc3\xa4.png", Bitmap{1, 1, {0x30, 0x20, 0x10, 255}, false});
  const std::string picture = readFileText(folder / "left right \xc3\xa4.png");
  Gltf gltf;
  gltf.root["textures"] = {{{"source", 0}}};
  gltf.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  gltf.attributes()["TEXCOORD_0"] = gltf.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  gltf.primitive()["material"] = 0;
  const std::vector<Json> images = {{{"uri", "left%20right%20%C3%A4.png"}},
                                    {{"uri", "left right \xc3\xa4.png"}},
                                    {{"uri", "data:image/png;base64," + base64(picture)}},
                                    {{"mimeType", "image/png"}, {"bufferView", gltf.view(picture)}}};
  for (const Json& image : images) {
    gltf.root["images"] = Json::array({image});
    clearLoggedWarnings();
    const Scene scene = loadScene(folder.write("a.gltf", gltf.text()));
    EXPECT_TRUE(loggedWarnings().empty()) << image.dump();
    ASSERT_EQ(scene.materials.at(0).diffuseTexture, 0) << image.dump();
    EXPECT_EQ(scene.textures[0].bitmap.rgba, (std::vector<std::uint8_t>{0x30, 0x20, 0x10, 255})) << image.dump();
  }
}

// ------------------------------------------------------------------------------------------------ shapes

// 3.7.2.1: without normals a mesh is flat. Two faces with a common edge, at right angles.
TEST(GltfReader, MeshesWithoutNormalsAreFlat) {
  Gltf gltf;
  gltf.attributes()["POSITION"] = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
  gltf.primitive()["indices"] =
      gltf.accessor(gltf.view(bytesOf(std::vector<std::uint8_t>{0, 1, 2, 1, 0, 3})), kUnsignedByte, "SCALAR", 6);
  const Scene scene = gltf.load();
  ASSERT_EQ(scene.indices.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(scene.vertices[scene.indices[i]].normal, i < 3 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0)) << i;
}

TEST(GltfReader, StripsAndFansAreTriangles) {
  Gltf gltf;
  gltf.attributes()["POSITION"] = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3");
  const glm::vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(1, 1, 0), e(0, 2, 0);
  gltf.primitive()["mode"] = 5;
  expectCorners(gltf.load(), {a, b, c, b, d, c, c, d, e});
  gltf.primitive()["indices"] = gltf.accessor(  // two strips, joined by triangles without area
      gltf.view(bytesOf(std::vector<std::uint8_t>{0, 1, 2, 2, 2, 3, 4})), kUnsignedByte, "SCALAR", 7);
  expectCorners(gltf.load(), {a, b, c, c, d, e});
  EXPECT_EQ(gltf.load().degenerateTriangles, 0u);
  gltf.primitive()["indices"] =
      gltf.accessor(gltf.view(bytesOf(std::vector<std::uint8_t>{0, 1, 3, 4})), kUnsignedByte, "SCALAR", 4);
  gltf.primitive()["mode"] = 6;
  expectCorners(gltf.load(), {b, d, a, d, e, a});
}

TEST(GltfReader, PointsAndLinesAreNotDrawn) {
  Gltf gltf;
  Json other = gltf.primitive();
  for (const int mode : {0, 1, 2, 3}) {
    other["mode"] = mode;
    gltf.root["meshes"][0]["primitives"].push_back(other);
  }
  expectCorners(gltf.load(), kTriangle);
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "4 primitives of points or lines are not drawn"));
  gltf.root["meshes"][0]["primitives"] = Json::array({other});
  EXPECT_TRUE(contains(gltf.refusal(), "nothing to draw: points and lines alone"));
}

// p + 0.5 a + 2 b; a node's weights come before its mesh's.
TEST(GltfReader, MorphTargetsMoveByTheirWeights) {
  Gltf gltf;
  gltf.attributes()["NORMAL"] = gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  gltf.primitive()["targets"] = {
      {{"POSITION", gltf.floats({2, 0, 0, 2, 0, 0, 2, 0, 0}, "VEC3")}},
      {{"POSITION", gltf.accessor(gltf.view(bytesOf(std::vector<std::int8_t>{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}), 4),
                                  kByte, "VEC3", 3)},
       {"NORMAL", gltf.floats({0.5f, 0, -0.5f, 0.5f, 0, -0.5f, 0.5f, 0, -0.5f}, "VEC3")}}};
  expectCorners(gltf.load(), kTriangle);  // weights of 0
  gltf.root["meshes"][0]["weights"] = {0.5, 2.0};
  const Scene scene = gltf.load();
  expectCorners(scene, {{1, 0, 2}, {2, 0, 2}, {1, 1, 2}});
  EXPECT_EQ(scene.vertices[0].normal, glm::vec3(1, 0, 0));
  gltf.node()["weights"] = {1.0, 0.0};
  gltf.root["nodes"].push_back({{"mesh", 0}});
  gltf.root["scenes"][0]["nodes"].push_back(1);
  expectCorners(gltf.load(), {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}, {1, 0, 2}, {2, 0, 2}, {1, 1, 2}});
  gltf.primitive()["targets"][0]["POSITION"] = gltf.floats({1, 0, 0}, "VEC3");
  EXPECT_TRUE(contains(gltf.refusal(), "targets[0].POSITION: accessor"));
}

/// Two joints: the first moves by (0,0,5), the second, its child, also turns by 90 degrees about z. They were bound at
/// the origin and at (1,0,0).
Gltf skinned(const std::vector<float>& weights) {
  Gltf gltf;
  gltf.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},  // which is not read
                        {{"translation", {0, 0, 5}}, {"children", {2}}},
                        {{"translation", {1, 0, 0}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}}};
  gltf.root["scenes"][0]["nodes"] = {0, 1};
  gltf.root["skins"] = {{{"joints", {1, 2}},
                         {"inverseBindMatrices", gltf.floats({1,      0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                                              /**/ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
                                                             "MAT4")}}};
  gltf.attributes()["NORMAL"] = gltf.floats({0, 0, 1, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::vector<std::uint8_t> joints = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
  gltf.attributes()["JOINTS_0"] = gltf.accessor(gltf.view(bytesOf(joints)), kUnsignedByte, "VEC4", 3);
  gltf.attributes()["WEIGHTS_0"] = gltf.accessor(gltf.view(bytesOf(weights)), kFloat, "VEC4", 3);
  return gltf;
}

TEST(GltfReader, SkinsStandAsTheirJointsDo) {
  // (1,0,0) turns about itself, its normal x becomes y; (0,1,0) is a quarter of (0,-1,5) and the rest of (0,1,5).
  const Scene scene = skinned({1, 0, 0, 0, 1, 0, 0, 0, 0.75f, 0.25f, 0, 0}).load();
  expectCorners(scene, {{0, 0, 5}, {1, 0, 5}, {0, 0.5f, 5}});
  EXPECT_LT(glm::distance(scene.vertices[1].normal, glm::vec3(0, 1, 0)), 1e-6f);
  // Weights are divided by their sum.
  expectCorners(skinned({2, 0, 0, 0, 3, 0, 0, 0, 3, 1, 0, 0}).load(), {{0, 0, 5}, {1, 0, 5}, {0, 0.5f, 5}});
  // The third vertex's other weights lie in a second set.
  Gltf two = skinned({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  two.attributes()["JOINTS_1"] = two.accessor(
      two.view(bytesOf(std::vector<std::uint16_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0})), kUnsignedShort, "VEC4", 3);
  two.attributes()["WEIGHTS_1"] =
      two.accessor(two.view(bytesOf(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 85, 0, 0, 0})), kUnsignedByte,
                   "VEC4", 3, true);
  expectCorners(two.load(), {{0, 0, 5}, {1, 0, 5}, {0, 0.5f, 5}});
  // Without matrices the joints' own places.
  Gltf unbound = skinned({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  unbound.root["skins"][0].erase("inverseBindMatrices");
  expectCorners(unbound.load(), {{0, 0, 5}, {1, 1, 5}, {0, 1, 5}});

  Gltf broken = skinned({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  broken.root["skins"][0]["joints"] = {1};
  EXPECT_TRUE(contains(broken.refusal(), "vertex 1 names joint 1, the skin has 1"));
  broken = skinned({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  broken.root["skins"][0]["joints"] = {1, 2, 2};
  EXPECT_TRUE(contains(broken.refusal(), "2 inverseBindMatrices of 3 joints"));
  broken.root["skins"][0]["joints"] = {1, 9};
  EXPECT_TRUE(contains(broken.refusal(), "skins[0].joints[1]"));
  broken.node()["skin"] = 3;
  EXPECT_TRUE(contains(broken.refusal(), "nodes[0].skin"));
}

// ------------------------------------------------------------------------------------------------ nodes

TEST(GltfReader, InstancesRepeatAMesh) {
  Gltf gltf;
  gltf.node()["translation"] = {1, 0, 7};
  Json& attributes = gltf.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["TRANSLATION"] = gltf.floats({0, 0, 0, 10, 0, 0}, "VEC3");
  attributes["SCALE"] = gltf.floats({1, 1, 1, 2, 3, 1}, "VEC3");
  const short half = 23170;  // sin 45 degrees
  attributes["ROTATION"] = gltf.accessor(
      gltf.view(bytesOf(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, half, half})), kShort, "VEC4", 2, true);
  attributes["_ID"] = gltf.floats({1, 2}, "SCALAR");
  expectCorners(gltf.load(), {{1, 0, 7}, {2, 0, 7}, {1, 1, 7}, {11, 0, 7}, {11, 2, 7}, {8, 0, 7}}, 1e-4f);
  EXPECT_TRUE(loggedWarnings().empty());
  attributes["SCALE"] = gltf.floats({1, 1, 1}, "VEC3");
  EXPECT_TRUE(contains(gltf.refusal(), "number of instances"));
}

TEST(GltfReader, MirroredNodesKeepTheirFront) {
  for (const bool withNormals : {false, true}) {
    Gltf gltf;
    if (withNormals) gltf.attributes()["NORMAL"] = gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    gltf.node()["scale"] = {-2, 1, 1};
    const Scene scene = gltf.load();
    const std::vector<glm::vec3> p = corners(scene);
    EXPECT_GT(glm::cross(p[1] - p[0], p[2] - p[0]).z, 0.0f);
    for (const Vertex& vertex : scene.vertices) EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.bounds.min.x, -2.0);
  }
}

// 13,000 km off, where single precision keeps whole metres.
TEST(GltfReader, AFarNodeIsBroughtNear) {
  Gltf gltf;
  gltf.root["nodes"] = {{{"translation", {13000000.25, 0, -5000000}}, {"children", {1, 2, 3}}},
                        {{"mesh", 0}, {"scale", {0.5, 0.5, 0.5}}},
                        {{"camera", 0}, {"translation", {0, 0, 4}}},
                        {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"translation", {0, 0, 3}}}};
  gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
  gltf.root["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}, {"intensity", 8}}}}}}};
  const Scene scene = gltf.load();
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "taken off all positions")) << loggedWarnings()[0];
  const glm::dvec3 place = glm::dvec3(13000000.25, 0, -5000000) - scene.origin;
  EXPECT_LT(glm::length(place), 10.0);
  expectCorners(scene,
                {glm::vec3(place), glm::vec3(place + glm::dvec3(0.5, 0, 0)), glm::vec3(place + glm::dvec3(0, 0.5, 0))});
  EXPECT_LT(glm::distance(scene.points.at(0).position, place + glm::dvec3(0, 0, 3)), 1e-9);
  EXPECT_LT(glm::distance(scene.cameras.at(0).position, place + glm::dvec3(0, 0, 4)), 1e-9);
  // With something near the origin, no offset helps.
  gltf.root["scenes"][0]["nodes"].push_back(gltf.add("nodes", {{"mesh", 0}, {"name", "near"}}));
  EXPECT_EQ(gltf.load().origin, glm::dvec3(0.0));
  EXPECT_TRUE(std::any_of(loggedWarnings().begin(), loggedWarnings().end(), [](const std::string& warning) {
    return contains(warning, "single precision moves vertices by up to");
  }));
}

// Meshes may share vertices, and nodes meshes, but small files do not fill the memory.
TEST(GltfReader, FilesThatGrowBeyondMeasureAreRefused) {
  Gltf gltf;
  const int zeros = gltf.add("accessors", {{"componentType", kFloat}, {"type", "VEC3"}, {"count", 3 << 20}});
  gltf.attributes()["POSITION"] = zeros;
  for (int i = 0; i < 8; ++i) gltf.root["scenes"][0]["nodes"].push_back(gltf.add("nodes", {{"mesh", 0}}));
  EXPECT_TRUE(contains(gltf.refusal(), "at most 256 a byte are supported"));
  gltf.root["accessors"][static_cast<std::size_t>(zeros)]["count"] = std::uint64_t{1} << 40;
  EXPECT_TRUE(contains(gltf.refusal(), "elements without a buffer view"));
}

TEST(GltfReader, TheDefaultSceneIsDrawn) {
  Gltf gltf;
  gltf.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}, {{"children", {1}}}};
  gltf.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {2}}}};
  gltf.root["scene"] = 1;
  EXPECT_EQ(gltf.load().bounds.min.x, 5.0);
  gltf.root.erase("scene");
  EXPECT_EQ(gltf.load().bounds.max.x, 1.0);
  gltf.root.erase("scenes");  // all roots
  EXPECT_EQ(gltf.load().triangleCount(), 2u);
}

/// A light in each of two nodes.
Gltf withLights(const Json& nodes, const Json& lights) {
  Gltf gltf;
  for (Json node : nodes) {
    const int light = node["light"];
    node.erase("light");
    node["extensions"] = {{"KHR_lights_punctual", {{"light", light}}}};
    gltf.root["scenes"][0]["nodes"].push_back(gltf.add("nodes", node));
  }
  gltf.root["extensions"] = {{"KHR_lights_punctual", {{"lights", lights}}}};
  gltf.root["extensionsUsed"] = {"KHR_lights_punctual"};
  return gltf;
}

TEST(GltfReader, ALightShinesFromEachOfItsNodes) {
  const Scene same =
      withLights({{{"light", 0}, {"translation", {0, 0, 2}}}, {{"light", 0}, {"translation", {0, 0, 3}}}},
                 {{{"type", "point"}, {"intensity", 8}}})
          .load();
  ASSERT_EQ(same.points.size(), 2u);
  EXPECT_EQ(same.points[0].position, glm::dvec3(0, 0, 2));
  EXPECT_EQ(same.points[1].position, glm::dvec3(0, 0, 3));
  // Two lights in nodes of one name.
  const Scene named = withLights({{{"light", 0}, {"name", "Light"}, {"translation", {0, 0, 2}}},
                                  {{"light", 1}, {"name", "Light"}, {"translation", {0, 0, -2}}}},
                                 {{{"type", "point"}, {"intensity", 8}}, {{"type", "spot"}, {"intensity", 9}}})
                          .load();
  ASSERT_EQ(named.points.size(), 1u);
  EXPECT_EQ(named.points[0].position.z, 2.0);
  ASSERT_EQ(named.spots.size(), 1u);
  EXPECT_EQ(named.spots[0].position.z, -2.0);
  EXPECT_EQ(named.spots[0].intensity, glm::vec3(9.0f));
  EXPECT_NEAR(named.spots[0].outerAngle, std::atan(1.0), 1e-12);  // the extension's default
}

TEST(GltfReader, LightsWithARangeAreNamed) {
  withLights({{{"light", 0}}, {{"light", 0}}}, {{{"type", "point"}, {"name", "bulb"}, {"range", 5}}}).load();
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "lights bulb: range ignored"));
  EXPECT_TRUE(contains(withLights({{{"light", 1}}}, {{{"type", "point"}}}).refusal(), "KHR_lights_punctual.light"));
  EXPECT_TRUE(contains(withLights({{{"light", 0}}}, Json::array({Json::object()})).refusal(), "lights[0]"));
}

TEST(GltfReader, OrthographicCamerasAreRead) {
  Gltf gltf;
  gltf.root["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 1.5}, {"znear", 0}, {"zfar", 9}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 0}, {"znear", 0}, {"zfar", 9}}}}};
  gltf.root["scenes"][0]["nodes"] = {0,
                                     gltf.add("nodes", {{"name", "plan"}, {"camera", 0}, {"translation", {0, 0, 4}}}),
                                     gltf.add("nodes", {{"name", "none"}, {"camera", 1}})};
  const Scene scene = gltf.load();
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].name, "plan");
  EXPECT_TRUE(scene.cameras[0].isOrthographic());
  EXPECT_EQ(scene.cameras[0].orthographicHeight, 3.0);
  EXPECT_EQ(scene.cameras[0].halfHeight(), 1.5);
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "camera 'none'"));
}

TEST(GltfReader, WhatIsBlendedIsSaid) {
  Gltf gltf;
  gltf.root["materials"] = {{{"name", "pane"}, {"alphaMode", "BLEND"}}};
  gltf.primitive()["material"] = 0;
  EXPECT_EQ(gltf.load().triangleCount(), 1u);
  EXPECT_TRUE(loggedWarnings().empty());  // it covers all
  Json& factor = gltf.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"];
  factor = {1, 1, 1, 0.3};
  EXPECT_EQ(gltf.load().triangleCount(), 1u);
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_TRUE(contains(loggedWarnings()[0], "'pane': not blended (BLEND) but drawn opaque, whose alpha is 0.3"));
  factor = {1, 1, 1, 0};
  EXPECT_TRUE(contains(gltf.refusal(), "nothing to draw"));  // it covers nothing
}

}  // namespace
}  // namespace lucerna
