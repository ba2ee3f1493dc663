// Materials of glTF 2: what nothing shows is one warning that names the material.
#include "base/angles.hpp"
#include "base/image.hpp"
#include "base/log.hpp"
#include "scene/gltf_material.hpp"
#include "scene/scene.hpp"
#include "support/contains.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::TempFolder;

std::string floats(std::initializer_list<float> values) {
  std::string bytes(4 * values.size(), '\0');
  std::memcpy(bytes.data(), values.begin(), bytes.size());
  return bytes;
}

/// A triangle (0,0,0) (1,0,0) (0,1,0) with texture coordinates (0.25, 0.5), (1, 0), (0, 1) (v = 0 on top) and colours;
/// `material` is the inside of its material's object, `colours` those of the three vertices.
Scene loadTriangle(const TempFolder& folder, const std::string& material,
                   const std::string& colours = floats({1, 1, 1, 1, 1, 1, 1, 1, 1})) {
  clearLoggedWarnings();
  folder.write("a.bin", floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25f, 0.5f, 1, 0, 0, 1}) + colours);
  // Two texels: the left one has alpha 100, the right one 200.
  if (!std::filesystem::exists(folder / "t.tga"))
    folder.write("t.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\x20\x28", 18) +
                              std::string("\x10\x20\x30\x64\x10\x20\x30\xc8", 8));
  return loadScene(
      folder.write("a.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":2},"material":0}]}],
    "materials":[{"name":"paint",)" +
                                 material + R"(}],
    "textures":[{"source":0}],"images":[{"uri":"t.tga"}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
    {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},
                 {"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},{"buffer":0,
    "byteOffset":60,"byteLength":36}],
    "buffers":[{"uri":"a.bin","byteLength":96}]})"));
}

/// The same with colours of four numbers, the last of them 0.5.
Scene loadTriangleOfFour(const TempFolder& folder, const std::string& material) {
  clearLoggedWarnings();
  folder.write("a.bin", floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1, 0.5f, 1, 1, 1, 0.5f, 1, 1, 1, 0.5f}));
  return loadScene(
      folder.write("a.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1},"material":0}]}],"materials":[{"name":"paint",)" +
                                 material + R"(}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
    {"bufferView":1,"componentType":5126,"count":3,"type":"VEC4"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":48}],
    "buffers":[{"uri":"a.bin","byteLength":84}]})"));
}

std::string onlyWarning() {
  EXPECT_EQ(loggedWarnings().size(), 1u);
  return loggedWarnings().empty() ? "" : loggedWarnings().front();
}

TEST(Gltf, EmissiveStrengthMultipliesTheEmission) {
  const TempFolder folder;
  const Scene scene = loadTriangle(
      folder,
      R"("emissiveFactor":[0.5,0.25,1],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}})");
  EXPECT_EQ(scene.materials.at(0).emission, glm::vec3(4, 2, 8));
  EXPECT_TRUE(loggedWarnings().empty());
}

TEST(Gltf, ColoursThatAllVerticesShareTintTheMaterial) {
  const TempFolder folder;
  const std::string material = R"("pbrMetallicRoughness":{"baseColorFactor":[0.8,0.5,1,1],"metallicFactor":0})";
  const Scene same = loadTriangle(folder, material, floats({0.5f, 1, 0, 0.5f, 1, 0, 0.5f, 1, 0}));
  EXPECT_NEAR(glm::length(same.materials.at(0).diffuse - glm::vec3(0.4f, 0.5f, 0)), 0.0f, 1e-6f);
  EXPECT_TRUE(loggedWarnings().empty());
  const Scene mixed = loadTriangle(folder, material, floats({0, 1, 0, 0.5f, 1, 0, 1, 1, 0.75f}));
  EXPECT_NEAR(glm::length(mixed.materials.at(0).diffuse - glm::vec3(0.4f, 0.5f, 0.25f)), 0.0f, 1e-6f);
  EXPECT_TRUE(contains(onlyWarning(), "material 'paint': vertex colours are their mean"));
}

TEST(Gltf, AlphaOfVerticesIsSaidNotToBeRead) {
  const TempFolder folder;
  loadTriangleOfFour(folder, R"("alphaMode":"MASK")");
  EXPECT_TRUE(contains(onlyWarning(), "material 'paint': vertices' alpha is not read"));
  loadTriangleOfFour(folder, R"("alphaMode":"OPAQUE")");
  EXPECT_TRUE(loggedWarnings().empty());
}

// With rotation 90 degrees counter-clockwise (v down): u' = v, v' = -u.
TEST(Gltf, TextureTransformsGoIntoTheCoordinates) {
  const TempFolder folder;
  const auto coordinate = [&](const std::string& transform) {
    const Scene scene = loadTriangle(
        folder, R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{)" +
                    transform + "}}}}");
    return scene.vertices.at(scene.indices.at(0)).texCoord;  // v = 0 at the bottom
  };
  const auto expect = [&](const std::string& transform, double u, double v) {
    const glm::vec2 uv = coordinate(transform);
    EXPECT_NEAR(uv.x, u, 1e-5) << transform;
    EXPECT_NEAR(1.0f - uv.y, v, 1e-5) << transform;
  };
  expect("", 0.25, 0.5);
  expect(R"("offset":[0.5,0.125])", 0.75, 0.625);
  expect(R"("scale":[2,3])", 0.5, 1.5);
  expect(R"("rotation":1.5707963267948966)", 0.5, -0.25);
  expect(R"("offset":[1,2],"scale":[2,3],"rotation":1.5707963267948966)", 1 + 1.5, 2 - 0.5);
  const TextureTransform eighth{.rotation = kPi / 4.0};
  EXPECT_NEAR(eighth.apply({1.0, 0.0}).x, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(eighth.apply({1.0, 0.0}).y, -std::sqrt(0.5), 1e-12);
}

TEST(Gltf, MasksAreCutAtTheirCutoff) {
  const TempFolder folder;
  const auto material = [](const std::string& alpha, const std::string& mode) {
    return R"("alphaMode":")" + mode + R"(","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,)" + alpha +
           R"(],"baseColorTexture":{"index":0}})";
  };
  // Which of the texels of alpha 100 and 200 are left.
  const auto left = [&](const std::string& inside) -> std::string {
    const Scene scene = loadTriangle(folder, inside);
    const Material& m = scene.materials.at(0);
    if (!m.alphaMasked) return "all";
    const Bitmap& bitmap = scene.textures.at(static_cast<std::size_t>(m.diffuseTexture)).bitmap;
    return std::string(bitmap.rgba.at(3) >= 128 ? "100 " : "") + (bitmap.rgba.at(7) >= 128 ? "200" : "");
  };
  EXPECT_EQ(left(material("1", "MASK")), "200");
  EXPECT_EQ(left(material("1", "MASK") + R"(,"alphaCutoff":0.3)"), "100 200");
  EXPECT_EQ(left(material("1", "MASK") + R"(,"alphaCutoff":0.9)"), "");
  EXPECT_EQ(left(material("1", "MASK") + R"(,"alphaCutoff":0)"), "all");
  EXPECT_EQ(left(material("0.7", "MASK")), "200");  // 0.7 * 200 / 255 = 0.55
  EXPECT_EQ(left(material("0.6", "MASK")), "");  // 0.47
  EXPECT_EQ(left(material("0.6", "MASK") + R"(,"alphaCutoff":0.2)"), "100 200");
  EXPECT_EQ(left(material("0.1", "OPAQUE")), "all");
  EXPECT_TRUE(loggedWarnings().empty());
  // Nothing is left at all: alpha cannot reach the cut-off.
  EXPECT_TRUE(contains(badInputMessage([&] { loadTriangle(folder, material("0.4", "MASK")); }), "nothing to draw"));
  EXPECT_EQ(left(material("1", "BLEND")), "200");
  EXPECT_TRUE(contains(onlyWarning(), "material 'paint': not blended (BLEND)"));
}

TEST(Gltf, MaterialsAreThoseOfTheirNumberWhateverTheOrderOfTheirUse) {
  const TempFolder folder;
  folder.write("a.bin", floats({0, 0, 0, 1, 0, 0, 0, 1, 0}));
  const auto strength = [](int value) {
    return fmt::format(
        R"({{"emissiveFactor":[1,1,1],"extensions":{{"KHR_materials_emissive_strength":{{"emissiveStrength":{}}}}}}})",
        value);
  };
  const auto primitive = [](const std::string& material) { return R"({"attributes":{"POSITION":0})" + material + "}"; };
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[)" +
      primitive(R"(,"material":2)") + "," + primitive("") + "," + primitive(R"(,"material":0)") +
      R"(]}],"materials":[)" + strength(3) + "," + strength(5) + "," + strength(7) +
      R"(],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{BUFFER"byteLength":36}]})";
  const auto emissions = [](const Scene& scene) {
    std::vector<float> result;
    for (const Mesh& mesh : scene.meshes)
      result.push_back(scene.materials.at(static_cast<std::size_t>(mesh.material)).emission.x);
    return result;
  };
  const auto withBuffer = [&](const std::string& uri) {
    return std::string(json).replace(json.find("BUFFER"), 6, uri);
  };
  EXPECT_EQ(emissions(loadScene(folder.write("a.gltf", withBuffer(R"("uri":"a.bin",)")))),
            (std::vector<float>{7, 0, 3}));
  std::string chunk = withBuffer("");
  chunk.append((4 - chunk.size() % 4) % 4, ' ');
  const auto word = [](std::size_t value) {
    const auto w = static_cast<std::uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&w), 4);
  };
  const std::string glb = "glTF" + word(2) + word(12 + 8 + chunk.size() + 8 + 36) + word(chunk.size()) + "JSON" +
                          chunk + word(36) + std::string("BIN\0", 4) + floats({0, 0, 0, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(emissions(loadScene(folder.write("a.glb", glb))), (std::vector<float>{7, 0, 3}));
}

TEST(Gltf, VolumesBecomeMedia) {
  const TempFolder folder;
  const std::string transmission =
      R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33},)";
  const Scene scene = loadTriangle(
      folder,
      transmission +
          R"("KHR_materials_volume":{"thicknessFactor":0.1,"attenuationDistance":2,"attenuationColor":[0.25,1,0.5]}})");
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.bsdf, Bsdf::dielectric);
  EXPECT_FLOAT_EQ(m.ior, 1.33f);
  ASSERT_EQ(m.interior, 0);
  const Medium& medium = scene.media.at(0);
  EXPECT_NEAR(glm::length(medium.absorption - glm::vec3(std::log(2.0), 0.0, 0.5 * std::log(2.0))), 0.0f,
              1e-6f);  // -ln(1/4) / 2
  EXPECT_EQ(medium.scattering, glm::vec3(0.0f));
  EXPECT_TRUE(loggedWarnings().empty());
  EXPECT_EQ(
      loadTriangle(folder,
                   transmission + R"("KHR_materials_volume":{"attenuationDistance":2,"attenuationColor":[0.5,1,0.5]}})")
          .materials.at(0)
          .interior,
      -1);
}

TEST(Gltf, PicturesOfNormalsMetalAndEmissionAreRead) {
  const TempFolder folder;
  const Scene scene = loadTriangle(
      folder, R"("normalTexture":{"index":0,"scale":0.75},"emissiveFactor":[1,0.5,0.25],"emissiveTexture":{"index":0},
    "pbrMetallicRoughness":{"baseColorFactor":[0.5,0.6,0.7,1],"metallicFactor":0.8,"roughnessFactor":0.9,
    "metallicRoughnessTexture":{"index":0}})");
  EXPECT_TRUE(loggedWarnings().empty());
  const Material& m = scene.materials.at(0);
  ASSERT_EQ(m.normalTexture, 0);  // one picture, whatever it is used for
  EXPECT_FLOAT_EQ(m.normalScale, 0.75f);
  EXPECT_EQ(m.emissionTexture, 0);
  EXPECT_EQ(m.emissionScale, glm::vec3(1, 0.5f, 0.25f));
  ASSERT_TRUE(m.metalMap);
  EXPECT_EQ(m.metalMap->texture, 0);
  EXPECT_FLOAT_EQ(m.metalMap->metallic, 0.8f);
  EXPECT_FLOAT_EQ(m.metalMap->roughness, 0.9f);
  EXPECT_NEAR(glm::length(m.metalMap->base - glm::vec3(0.5f, 0.6f, 0.7f)), 0.0f, 1e-6f);
  // The picture's texels are blue 16, green 32, red 48 as the file lies in memory.
  const float metallic = 0.8f * 16.0f / 255.0f;
  EXPECT_NEAR(glm::length(m.diffuse - (1.0f - metallic) * m.metalMap->base), 0.0f, 1e-5f);
  // A metal's picture is the colour of its reflection, with a picture of the metallic share or without.
  EXPECT_TRUE(loadTriangle(folder, R"("pbrMetallicRoughness":{"metallicFactor":1,"baseColorTexture":{"index":0}})")
                  .materials.at(0)
                  .metalMap);
  EXPECT_FALSE(loadTriangle(folder, R"("pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":{"index":0}})")
                   .materials.at(0)
                   .metalMap);
  EXPECT_FALSE(loadTriangle(folder, R"("pbrMetallicRoughness":{"metallicFactor":1})").materials.at(0).metalMap);
  // One set of texture coordinates serves all.
  loadTriangle(folder,
               R"("normalTexture":{"index":0,"texCoord":1},"pbrMetallicRoughness":{"baseColorTexture":{"index":0}})");
  EXPECT_TRUE(contains(onlyWarning(), "material 'paint': the normal texture lies as the first one does"));
}

TEST(Gltf, WhatIsNotShownIsOneWarning) {
  const TempFolder folder;
  loadTriangle(folder,
               R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]},
      "extensions":{"KHR_materials_sheen":{"sheenRoughnessFactor":1},
      "KHR_materials_clearcoat":{"clearcoatFactor":1}})");
  const std::string warning = onlyWarning();
  for (const char* part :
       {"a.gltf", "material 'paint'", "not blended (BLEND)", "no KHR_materials_sheen", "no KHR_materials_clearcoat"})
    EXPECT_TRUE(contains(warning, part)) << warning;
}

TEST(Gltf, ValuesOfOtherTypesAreRefused) {
  const TempFolder folder;
  const auto refusal = [&](const std::string& material) {
    return badInputMessage([&] { loadTriangle(folder, material); });
  };
  EXPECT_TRUE(contains(refusal(R"("extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":-1}})"),
                       "emissiveStrength"));
  EXPECT_TRUE(
      contains(refusal(R"("extensions":{"KHR_materials_volume":{"attenuationDistance":0}})"), "attenuationDistance"));
  EXPECT_TRUE(contains(refusal(R"("alphaCutoff":-2)"), "alphaCutoff"));
  EXPECT_TRUE(contains(refusal(R"("alphaMode":"SOME")"), "alphaMode"));
}

}  // namespace
}  // namespace lucerna
