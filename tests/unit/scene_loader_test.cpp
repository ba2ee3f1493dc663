// Models: geometry, materials, textures, and what broken or odd files lead to.
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"
#include "support/contains.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::TempFolder;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::size_t warningsNaming(std::string_view part) {
  std::size_t count = 0;
  for (const std::string& warning : loggedWarnings()) count += contains(warning, part);
  return count;
}

Scene loadObj(const TempFolder& folder, const std::string& obj, const std::string& mtl = "") {
  clearLoggedWarnings();
  if (!mtl.empty()) folder.write("model.mtl", mtl);
  return loadScene(folder.write("model.obj", (mtl.empty() ? "" : "mtllib model.mtl\n") + obj));
}

std::string loadError(const TempFolder& folder, std::string_view name, std::string_view content) {
  const auto file = folder.write(name, content);
  const std::string message = badInputMessage([&] { loadScene(file); });
  EXPECT_TRUE(contains(message, name)) << message;
  return message;
}

void writePicture(const std::filesystem::path& file, std::uint8_t red) {
  Bitmap bitmap{2, 2, std::vector<std::uint8_t>(16, 255), false};
  for (std::size_t i = 0; i < 16; i += 4) bitmap.rgba[i] = red;
  writePng(file, bitmap);
}

/// A 1 x 2 Targa with alpha: the top pixel opaque, the bottom one clear.
std::string targaWithAlpha() {
  std::string tga(18, '\0');
  tga[2] = 2;
  tga[12] = 1;
  tga[14] = 2;
  tga[16] = 32;
  tga[17] = 8;
  const std::string clear{'\x10', '\x20', '\x30', '\0'}, solid{'\x10', '\x20', '\x30', '\xff'};
  return tga + clear + solid;
}

glm::dvec3 faceNormal(const Scene& scene, std::size_t triangle) {
  const auto corner = [&](std::size_t k) {
    return glm::dvec3(scene.vertices[scene.indices[3 * triangle + k]].position);
  };
  return glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
}

/// Every index in range, meshes covering the indices in order, normals unit, bounds right.
void expectConsistent(const Scene& scene) {
  std::uint32_t next = 0;
  Bounds all;
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_EQ(mesh.firstIndex, next);
    EXPECT_EQ(mesh.indexCount % 3, 0u);
    next += mesh.indexCount;
    ASSERT_GE(mesh.material, 0);
    ASSERT_LT(static_cast<std::size_t>(mesh.material), scene.materials.size());
    for (std::uint32_t i = mesh.firstIndex; i < next; ++i) {
      ASSERT_LT(scene.indices[i], scene.vertices.size());
      const Vertex& vertex = scene.vertices[scene.indices[i]];
      all.add(glm::dvec3(vertex.position));
      EXPECT_NEAR(glm::length(vertex.normal), 1.0f, 1e-5f);
      EXPECT_EQ(glm::clamp(glm::dvec3(vertex.position), mesh.bounds.min, mesh.bounds.max), glm::dvec3(vertex.position));
    }
  }
  EXPECT_EQ(next, scene.indices.size());
  EXPECT_EQ(all.min, scene.bounds.min);
  EXPECT_EQ(all.max, scene.bounds.max);
  EXPECT_FALSE(scene.cameras.empty());
}

TEST(SceneLoader, PolygonsBecomeTrianglesLinesAndPointsAreDropped) {
  const TempFolder folder;
  const Scene scene = loadObj(
      folder,
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 0\nv 0.5 1.5 0\nl 1 5\np 5\nf 1 2 3 4\nf 1 2 3\nf 1 2 3 6 4\n");
  EXPECT_EQ(scene.triangleCount(), 2u + 1u + 3u);
  EXPECT_EQ(scene.name, "model");
  EXPECT_EQ(scene.degenerateTriangles, 0u);
  EXPECT_EQ(scene.bounds.max, glm::dvec3(1, 1.5, 0));  // not the point at (2, 2, 0)
  expectConsistent(scene);
}

TEST(SceneLoader, RelativeIndicesAndContinuedLinesAreRead) {
  const TempFolder folder;
  const Scene scene = loadObj(folder, "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf -3 -2 \\\n -1\r\nv 0 0 1\nf 1 2 4");
  EXPECT_EQ(scene.triangleCount(), 2u);
}

TEST(SceneLoader, ZeroAreaTrianglesAreCountedAndKept) {
  const TempFolder folder;
  const Scene scene = loadObj(folder, kTriangle + "v 2 0 0\nf 1 2 4\nf 1 1 2\n");
  EXPECT_EQ(scene.triangleCount(), 3u);
  EXPECT_EQ(scene.degenerateTriangles, 2u);
  expectConsistent(scene);
  EXPECT_TRUE(contains(loadError(folder, "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "zero area"));
}

TEST(SceneLoader, SliversAreNotDegenerate) {
  const TempFolder folder;
  // 1 : 10^6, and a whole scene of 10^-15 units.
  const Scene scene = loadObj(
      folder, "v 0 0 0\nv 1 0 0\nv 0 1e-6 0\nv 0 0 1e-15\nv 1e-15 0 1e-15\nv 0 1e-15 1e-15\nf 1 2 3\nf 4 5 6\n");
  EXPECT_EQ(scene.triangleCount(), 2u);
  EXPECT_EQ(scene.degenerateTriangles, 0u);
  EXPECT_EQ(scene.vertices.size(), 6u);  // vertices that lie close are not joined
}

TEST(SceneLoader, TrianglesThatAreNotFiniteAreDroppedCountedAndWarnedOf) {
  const TempFolder folder;
  const Scene scene = loadObj(folder, kTriangle + "v nan 0 0\nv 0 inf 0\nf 1 2 4\nf 1 2 5\n");
  EXPECT_EQ(scene.triangleCount(), 1u);
  EXPECT_EQ(scene.droppedTriangles, 2u);
  EXPECT_EQ(warningsNaming("model.obj"), 1u);
  expectConsistent(scene);
  EXPECT_TRUE(contains(loadError(folder, "nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "nothing to draw"));
}

TEST(SceneLoader, MissingNormalsAreMadeWithACrease) {
  const TempFolder folder;
  // Two faces that meet at 90 degrees keep their own normals; at 20 degrees they share one.
  const Scene sharp = loadObj(folder, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\n");
  EXPECT_EQ(sharp.vertices.size(), 6u);
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_GT(glm::dot(glm::dvec3(sharp.vertices[sharp.indices[3 * t + k]].normal), faceNormal(sharp, t)), 0.9999);
  const double angle = 20.0 * 3.14159265 / 180.0;
  const Scene smooth = loadObj(folder, fmt::format("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 {} {}\nf 1 2 3\nf 1 4 2\n",
                                                   -std::cos(angle), std::sin(angle)));
  EXPECT_EQ(smooth.vertices.size(), 4u);
}

TEST(SceneLoader, GivenNormalsAndTextureCoordinatesAreKept) {
  const TempFolder folder;
  const Scene scene = loadObj(folder, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.75\nvn 0 3 4\nf 1/1/1 2/1/1 3/1/1\n");
  EXPECT_LT(glm::distance(scene.vertices[0].normal, glm::vec3(0.0f, 0.6f, 0.8f)), 1e-6f);
  EXPECT_EQ(scene.vertices[0].texCoord, glm::vec2(0.25f, 0.75f));  // v = 0 is the bottom row
}

TEST(SceneLoader, ZeroNormalsAreReplacedByTheFaces) {
  const TempFolder folder;
  const Scene scene = loadObj(folder, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 0\nf 1//1 2//1 3//1\n");
  EXPECT_EQ(scene.vertices[0].normal, glm::vec3(0.0f, 0.0f, 1.0f));
}

TEST(SceneLoader, MaterialsOfMtlAreRead) {
  const TempFolder folder;
  const Scene scene = loadObj(folder, "usemtl shiny\n" + kTriangle,
                              "newmtl unused\nKd 1 0 0\nmap_Kd nowhere.png\n"
                              "newmtl shiny\nKd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nNs 50\nKe 7 8 9\nd 1\nTr 0\n");
  ASSERT_EQ(scene.materials.size(), 1u);  // the unused one is left out, its missing picture with it
  EXPECT_TRUE(loggedWarnings().empty());
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.name, "shiny");
  EXPECT_LT(glm::distance(m.diffuse, glm::vec3(0.1f / 0.6f, 0.2f / 0.5f, 0.3f / 0.4f)), 1e-6f);  // under the coat
  EXPECT_EQ(m.specular, glm::vec3(0.4f, 0.5f, 0.6f));
  EXPECT_FLOAT_EQ(m.roughness, std::sqrt(2.0f / 52.0f));
  EXPECT_EQ(m.emission, glm::vec3(7.0f, 8.0f, 9.0f));
  EXPECT_EQ(m.opacity, 1.0f);
  EXPECT_EQ(m.diffuseTexture, -1);
  EXPECT_FALSE(m.alphaMasked);
}

TEST(SceneLoader, OpacityComesOutTheSameFromDAndTr) {
  const TempFolder folder;
  const std::vector<std::pair<std::string, float>> cases = {
      {"d 1\nTr 0\n", 1.0f}, {"Tr 0\nd 1\n", 1.0f}, {"", 1.0f},      {"d 0.25\n", 0.25f},
      {"Tr 0.75\n", 0.25f},  {"d 0\n", 1.0f},       {"Tr 1\n", 1.0f}};
  for (const auto& [lines, opacity] : cases) {
    const Scene scene = loadObj(folder, "usemtl m\n" + kTriangle, "newmtl m\nKd 1 1 1\n" + lines);
    EXPECT_EQ(scene.materials[0].opacity, opacity) << lines;
    EXPECT_EQ(warningsNaming("opacity 0, which"), lines == "d 0\n" || lines == "Tr 1\n" ? 1u : 0u) << lines;
    EXPECT_EQ(warningsNaming("opaque in spite of an opacity: material 'm' (0.25)"), opacity < 1.0f ? 1u : 0u) << lines;
  }
}

TEST(SceneLoader, ReflectancesAreHeldWithin0And1) {
  const TempFolder folder;
  const Scene scene = loadObj(folder, "usemtl m\n" + kTriangle, "newmtl m\nKd 2 -1 0.5\nKe -1 0 0\nNs 0\n");
  EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(1.0f, 0.0f, 0.5f));
  EXPECT_EQ(scene.materials[0].emission, glm::vec3(0.0f));
  EXPECT_EQ(scene.materials[0].roughness, 1.0f);
}

TEST(SceneLoader, TexturesAreFoundBehindBackSlashesAndShared) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "textures");
  writePicture(folder / "textures/a.png", 10);
  writePicture(folder / "beside.png", 20);
  const Scene scene = loadObj(
      folder, "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n",
      "newmtl a\nmap_Kd textures\\a.png\nnewmtl b\nmap_Kd textures\\a.png\nnewmtl c\nmap_Kd C:\\work\\beside.png\n");
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.materials[0].diffuseTexture, scene.materials[1].diffuseTexture);
  EXPECT_EQ(scene.textures[0].bitmap.rgba[0], 10);
  EXPECT_EQ(scene.textures[1].bitmap.rgba[0], 20);
  EXPECT_TRUE(loggedWarnings().empty());
}

// Other formats say it by Assimp; Collada in Maya's words.
TEST(SceneLoader, TexturesContinueAsColladaSays) {
  const TempFolder folder;
  writePicture(folder / "a.png", 10);
  const auto wraps = [&](const std::string& words) {
    clearLoggedWarnings();
    const Scene scene = loadScene(folder.write("model.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>
<library_images><image id="img"><init_from>a.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON>
<newparam sid="surface"><surface type="2D"><init_from>img</init_from></surface></newparam>
<newparam sid="sampler"><sampler2D><source>surface</source></sampler2D></newparam>
<technique sid="c"><lambert><diffuse><texture texture="sampler" texcoord="T"><extra><technique profile="MAYA">)" +
                                                                words + R"(</technique></extra></texture></diffuse>
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="m" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)"));
    return scene.textures.at(0).wraps;
  };
  EXPECT_EQ(wraps(""), TextureWraps{});
  EXPECT_EQ(wraps("<wrapU>0</wrapU><wrapV>1</wrapV><mirrorV>1</mirrorV>"),
            (TextureWraps{TextureWrap::edge, TextureWrap::mirror}));
}

TEST(SceneLoader, AMissingOrBrokenTextureIsOneWarningAndAChecker) {
  const TempFolder folder;
  folder.write("broken.png", "no picture");
  const Scene scene =
      loadObj(folder, "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n",
              "newmtl a\nmap_Kd none.png\nnewmtl b\nmap_Kd none.png\nnewmtl c\nmap_Kd broken.png\n");
  EXPECT_EQ(warningsNaming("none.png"), 1u);
  EXPECT_EQ(warningsNaming("broken.png"), 1u);
  EXPECT_EQ(loggedWarnings().size(), 2u);
  ASSERT_EQ(scene.textures.size(), 1u);  // one checker for all
  for (const Material& m : scene.materials) EXPECT_EQ(m.diffuseTexture, 0);
  const Bitmap& checker = scene.textures[0].bitmap;
  EXPECT_NE(checker.rgba[0], checker.rgba[4 * 8]);
  EXPECT_FALSE(checker.hasAlpha);
}

TEST(SceneLoader, EmissionMapsCountByTheirMeanAndAreWarnedOfOnce) {
  const TempFolder folder;
  writePng(folder / "glow.png", Bitmap{1, 2, {255, 255, 255, 255, 0, 0, 0, 255}, false});
  const std::string faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
  const Scene glowing = loadObj(folder, faces, "newmtl a\nKe 4 2 0\nmap_Ke glow.png\nnewmtl b\n");
  EXPECT_EQ(glowing.materials[0].emission,
            glm::vec3(2.0f, 1.0f, 0.0f));  // and the picture stays for those who read it texel by texel
  EXPECT_EQ(glowing.materials[0].emissionScale, glm::vec3(4.0f, 2.0f, 0.0f));
  ASSERT_EQ(glowing.materials[0].emissionTexture, 0);
  EXPECT_EQ(glowing.textures.at(0).file.filename(), "glow.png");
  EXPECT_TRUE(analyse(glowing).emissionTextures);
  EXPECT_EQ(glowing.materials[1].emissionTexture, -1);
  const Scene scene = loadObj(
      folder, faces, "newmtl a\nKe 4 2 0\nmap_Ke none.png\nnewmtl b\nKe 1 1 1\nmap_Ke none.png\nmap_Kd none.png\n");
  EXPECT_EQ(scene.materials[0].emission, glm::vec3(4.0f, 2.0f, 0.0f));
  EXPECT_EQ(scene.materials[0].emissionTexture, -1);
  EXPECT_FALSE(analyse(scene).emissionTextures);
  EXPECT_EQ(warningsNaming("none.png"), 1u);
}

TEST(SceneLoader, AlphaMasksComeFromTheirFileOrTheTexture) {
  const TempFolder folder;
  writePicture(folder / "colour.png", 200);
  writePicture(folder / "mask.png", 0);
  folder.write("leaf.tga", targaWithAlpha());
  const auto load = [&](const std::string& lines) {
    return loadObj(folder, "usemtl m\n" + kTriangle, "newmtl m\nKd 1 1 1\n" + lines);
  };
  Scene scene = load("map_Kd colour.png\nmap_d mask.png\n");
  EXPECT_TRUE(scene.materials[0].alphaMasked);
  ASSERT_EQ(scene.materials[0].alphaTexture, 1);
  EXPECT_EQ(scene.textures[1].file.filename(), "mask.png");
  scene = load("map_Kd leaf.tga\n");  // clear and opaque: a cutout
  EXPECT_TRUE(scene.materials[0].alphaMasked);
  std::string gloss = targaWithAlpha();
  gloss[21] = gloss[25] = 60;
  folder.write("gloss.tga", gloss);
  scene = load("map_Kd gloss.tga\n");
  EXPECT_FALSE(scene.materials[0].alphaMasked);
  EXPECT_EQ(warningsNaming("its picture's alpha"), 1u);
  scene = load("map_Kd leaf.tga\nd 0.9\n");
  EXPECT_TRUE(scene.materials[0].alphaMasked);
  EXPECT_EQ(scene.materials[0].alphaTexture, -1);
  EXPECT_TRUE(scene.textures[0].bitmap.hasAlpha);
  EXPECT_TRUE(loggedWarnings().empty());
  scene = load("map_Kd leaf.tga\nmap_d leaf.tga\n");
  EXPECT_TRUE(scene.materials[0].alphaMasked);
  EXPECT_EQ(scene.textures.size(), 1u);
  scene = load("map_Kd colour.png\nmap_d colour.png\n");  // a colour picture without alpha is no mask
  EXPECT_FALSE(scene.materials[0].alphaMasked);
  scene = load("map_Kd colour.png\nmap_d none.png\n");
  EXPECT_FALSE(scene.materials[0].alphaMasked);
  EXPECT_EQ(warningsNaming("none.png"), 1u);
}

TEST(SceneLoader, AMissingMaterialLibraryIsOneWarning) {
  const TempFolder folder;
  clearLoggedWarnings();
  const Scene scene = loadScene(folder.write("a.obj", "mtllib gone.mtl\nusemtl m\n" + kTriangle));
  EXPECT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(warningsNaming("gone.mtl"), 1u);
  EXPECT_EQ(loggedWarnings().size(), 1u);
  folder.write("sub/m.mtl", "newmtl m\nKd 0 1 0\n");
  clearLoggedWarnings();
  EXPECT_EQ(loadScene(folder.write("b.obj", "mtllib sub\\m.mtl\nusemtl m\n" + kTriangle)).materials[0].diffuse,
            glm::vec3(0.0f, 1.0f, 0.0f));
  EXPECT_TRUE(loggedWarnings().empty());
}

TEST(SceneLoader, BrokenObjFilesAreErrorsThatNameTheLine) {
  const TempFolder folder;
  const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {head + "f 1 2 3\nf 1 2 4\n", "x.obj:5: "},  // refers to a vertex that is not there
      {head + "f 1 2 3\n\nf 1 2 -4\n", "x.obj:6: "},
      {head + "f 1 2 0\n", "x.obj:4: "},
      {head + "f 1 2 x\n", "x.obj:4: "},
      {head + "f 1/1/1/1 2 3\n", "x.obj:4: "},
      {head + "f 1 2 3\nf 1 2", "x.obj:5: "},  // cut off within a face
      {head + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 1/", "x.obj:6: "},
      {head + "f 1 2 3\nv 0 1", "x.obj:5: "},  // cut off within a vertex
      {head + "f 1 2 3\nv 0 1 1.", "x.obj:5: "},
      {head + "f 1 2 3\nvn 0 -", "x.obj:5: "},
      {head + "f 1 2 3\nv 1 two 3\nf 1 2 4\n", "x.obj:5: "},
      {std::string("v 0 0 0\0\1\2", 10), "binary"},
      {"", "empty"},
      {"# nothing\n", "x.obj"},
      {head, "x.obj"},
      {head + "l 1 2\n", "nothing to draw: positions (3), points and lines (1) alone, no face"},
  };
  for (const auto& [content, expected] : cases) {
    const std::string message = loadError(folder, "x.obj", content);
    EXPECT_TRUE(contains(message, expected)) << content << "\n" << message;
  }
}

TEST(SceneLoader, MissingFilesFoldersAndGarbageAreErrors) {
  const TempFolder folder;
  EXPECT_TRUE(contains(badInputMessage([&] { loadScene(folder / "none.obj"); }), "none.obj: no such file"));
  EXPECT_TRUE(contains(badInputMessage([&] { loadScene(folder / "none.gltf"); }), "none.gltf: no such file"));
  EXPECT_TRUE(contains(badInputMessage([&] { loadScene(folder.path()); }), "is a folder"));
  std::filesystem::create_directory(folder / "dir.obj");
  EXPECT_TRUE(contains(badInputMessage([&] { loadScene(folder / "dir.obj"); }), "is a folder"));
  std::string garbage;
  for (unsigned i = 0, x = 1; i < 4000; ++i) garbage += static_cast<char>((x = x * 1664525u + 1013904223u) >> 24);
  for (const char* name : {"g.obj", "g.ply", "g.gltf", "g.glb", "g.off", "g.stl", "g.fbx", "g.unknown", "g"})
    for (const std::string& content : {garbage, std::string()}) loadError(folder, name, content);
}

TEST(SceneLoader, TruncatedPlyIsAnError) {
  const TempFolder folder;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 3 "
      "2\n";
  EXPECT_EQ(loadScene(folder.write("whole.ply", ply)).triangleCount(), 2u);
  loadError(folder, "vertices.ply", ply.substr(0, ply.find("1 1 0")));
  loadError(folder, "index.ply", ply.substr(0, ply.find("3 1 3 2")) + "3 1 9 2\n");
}

TEST(SceneLoader, DefaultsForFilesWithoutLightOrCamera) {
  const TempFolder folder;
  const Scene scene = loadObj(folder, "v 10 20 30\nv 12 20 30\nv 10 23 30\nv 10 20 36\nf 1 2 3\nf 1 3 4\n");
  ASSERT_TRUE(scene.sun);
  EXPECT_NEAR(glm::length(scene.sun->direction), 1.0, 1e-12);
  EXPECT_LT(scene.sun->direction.y, -0.8);
  EXPECT_GT(glm::dot(scene.sun->direction, scene.cameras.front().direction),
            0.7);  // over the shoulder of a view that nobody chose
  EXPECT_GT(scene.sun->irradiance.x, 0.0f);
  ASSERT_EQ(scene.cameras.size(), 1u);
  const Camera& camera = scene.cameras[0];
  EXPECT_NEAR(camera.verticalFov, 50.0 * 3.14159265358979 / 180.0, 1e-12);
  EXPECT_NEAR(glm::dot(camera.up, camera.direction), 0.0, 1e-12);
  EXPECT_TRUE(scene.keyFrames.empty());
}

// -----------------------------------------------------------------------------------------------------------------
// glTF

/// One triangle in z = 0, facing +z, with normals; what stands in %nodes%, %material% and %more% is up to the test.
Scene loadGltf(const TempFolder& folder, const std::string& nodes, const std::string& material,
               const std::string& more = "") {
  const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, /* normals */ 0, 0, 1, 0, 0, 1, 0, 0, 1, /* texture */ 0,
                           0, 1, 0, 0, 1};
  std::string bytes(reinterpret_cast<const char*>(numbers), sizeof numbers);
  folder.write("data.bin", bytes);
  return loadScene(folder.write(
      "model.gltf", fmt::format(R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{}],
    "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}},"material":0}}]}}],
    "materials":[{}]{},
    "buffers":[{{"uri":"data.bin","byteLength":96}}],
    "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":36}},{{"buffer":0,
    "byteOffset":72,"byteLength":24}}],
    "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
      {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}},{{"bufferView":2,"componentType":5126,"count":3,
      "type":"VEC2"}}]}})",
                                nodes, material, more)));
}

TEST(SceneLoader, NodeTransformsAreAppliedAndMirroringKeepsTheFront) {
  const TempFolder folder;
  const Scene moved = loadGltf(folder, R"({"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[2,3,4]})", "{}");
  expectConsistent(moved);
  EXPECT_EQ(moved.bounds.min, glm::dvec3(10, 0, 0));
  EXPECT_EQ(moved.bounds.max, glm::dvec3(12, 3, 0));
  EXPECT_GT(faceNormal(moved, 0).z, 0.999);
  const Scene mirrored = loadGltf(folder, R"({"mesh":0,"scale":[-1,1,1]})", "{}");
  expectConsistent(mirrored);
  EXPECT_EQ(mirrored.bounds.min, glm::dvec3(-1, 0, 0));
  EXPECT_GT(faceNormal(mirrored, 0).z, 0.999);  // without swapping two corners it would face -z
  EXPECT_GT(mirrored.vertices[0].normal.z, 0.999f);
  const Scene turned = loadGltf(folder, R"({"mesh":0,"scale":[1,1,-5]})", "{}");
  EXPECT_LT(faceNormal(turned, 0).z, -0.999);
  EXPECT_LT(turned.vertices[0].normal.z, -0.999f);
}

TEST(SceneLoader, MetallicRoughnessBecomesDiffuseAndSpecular) {
  const TempFolder folder;
  const std::string node = R"({"mesh":0})";
  const Material plastic =
      loadGltf(
          folder, node,
          R"({"pbrMetallicRoughness":{"baseColorFactor":[0.2,0.4,0.6,1],"metallicFactor":0,"roughnessFactor":0.5}})")
          .materials[0];
  EXPECT_LT(glm::distance(plastic.diffuse, glm::vec3(0.2f, 0.4f, 0.6f)), 1e-6f);
  EXPECT_LT(glm::distance(plastic.specular, glm::vec3(0.04f)), 1e-6f);
  EXPECT_FLOAT_EQ(plastic.roughness, 0.25f);
  const Material metal =
      loadGltf(folder, node, R"({"pbrMetallicRoughness":{"baseColorFactor":[0.2,0.4,0.6,1],"metallicFactor":1}})")
          .materials[0];
  EXPECT_EQ(metal.diffuse, glm::vec3(0.0f));
  EXPECT_LT(glm::distance(metal.specular, glm::vec3(0.2f, 0.4f, 0.6f)), 1e-6f);
  const Material glowing =
      loadGltf(folder, node, R"({"emissiveFactor":[0.5,1,0],"pbrMetallicRoughness":{"metallicFactor":0}})")
          .materials[0];
  EXPECT_EQ(glowing.emission, glm::vec3(0.5f, 1.0f, 0.0f));
}

TEST(SceneLoader, GltfTexturesCountByTheirMeanWhereTheyAreNotKept) {
  const TempFolder folder;
  writePng(folder / "mr.png",
           Bitmap{1, 2, {0, 255, 0, 255, 0, 255, 51, 255}, false});  // roughness 1; metallic 0 and 0.2
  const Material m =
      loadGltf(folder, R"({"mesh":0})", R"({"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0}}})",
               R"(,"textures":[{"source":0}],"images":[{"uri":"mr.png"}])")
          .materials[0];
  EXPECT_NEAR(m.diffuse.x, 0.9f, 1e-5f);
  EXPECT_NEAR(m.roughness, 1.0f, 1e-5f);
}

TEST(SceneLoader, GltfAlphaModesDecideOverMasks) {
  const TempFolder folder;
  folder.write("leaf.tga", targaWithAlpha());
  const std::string images = R"(,"textures":[{"source":0}],"images":[{"uri":"leaf.tga"}])";
  const std::string base = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0})";
  EXPECT_TRUE(
      loadGltf(folder, R"({"mesh":0})", "{\"alphaMode\":\"MASK\"," + base + "}", images).materials[0].alphaMasked);
  EXPECT_FALSE(loadGltf(folder, R"({"mesh":0})", "{" + base + "}", images).materials[0].alphaMasked);
}

TEST(SceneLoader, GltfTextureCoordinatesCountFromTheBottom) {
  const TempFolder folder;
  const Scene scene = loadGltf(folder, R"({"mesh":0})", "{}");
  // In the file (0,0) is the top left corner of a texture.
  EXPECT_EQ(scene.vertices[0].position, glm::vec3(0.0f));
  EXPECT_EQ(scene.vertices[0].texCoord, glm::vec2(0.0f, 1.0f));
}

TEST(SceneLoader, EmbeddedTexturesAreRead) {
  const TempFolder folder;
  const std::string uri =  // a red 1 x 1 PNG
      "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/"
      "pLvAAAAAElFTkSuQmCC";
  clearLoggedWarnings();
  const Scene scene = loadGltf(folder, R"({"mesh":0})",
                               R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0}})",
                               R"(,"textures":[{"source":0}],"images":[{"uri":")" + uri + "\"}]");
  EXPECT_TRUE(loggedWarnings().empty());
  ASSERT_EQ(scene.materials[0].diffuseTexture, 0);
  EXPECT_EQ(scene.textures[0].bitmap.rgba, (std::vector<std::uint8_t>{255, 0, 0, 255}));
}

TEST(SceneLoader, GltfCamerasAndSunAreRead) {
  const TempFolder folder;
  const Scene scene =
      loadGltf(folder,
               R"({"children":[1,2,3]},{"mesh":0},{"name":"eye","camera":0,"translation":[1,2,3]},
                                  {"name":"sun","rotation":[-0.70710678,0,0,0.70710678],
                                  "extensions":{"KHR_lights_punctual":{"light":0}}})",
               "{}",
               R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.7,"aspectRatio":1.5,"znear":0.1}}],
                                  "extensionsUsed":["KHR_lights_punctual"],
                                  "extensions":{"KHR_lights_punctual":{"lights":[{"type":"directional",
                                  "color":[1,0.5,0.25],"intensity":4}]}})");
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].position, glm::dvec3(1, 2, 3));
  EXPECT_LT(glm::distance(scene.cameras[0].direction, glm::dvec3(0, 0, -1)), 1e-6);
  EXPECT_NEAR(scene.cameras[0].verticalFov, 0.7, 1e-6);
  ASSERT_TRUE(scene.sun);
  EXPECT_LT(glm::distance(scene.sun->direction, glm::dvec3(0, -1, 0)), 1e-6);  // -z turned about x by -90 degrees
  EXPECT_LT(glm::distance(scene.sun->irradiance, glm::vec3(4.0f, 2.0f, 1.0f)), 1e-6f);
}

TEST(SceneLoader, GltfCamerasOfOneNameKeepTheirFieldOfView) {
  const TempFolder folder;
  const Scene scene = loadGltf(folder,
                               R"({"children":[1,2,3,4,5]},{"mesh":0},{"name":"eye","camera":2,"translation":[1,2,3]},
         {"name":"eye","camera":0,"translation":[4,5,6]},{"camera":3,"translation":[0,0,7]},
         {"name":"plan","camera":1})",
                               "{}",
                               R"(,"cameras":[{"type":"perspective","perspective":{"yfov":1.1,"znear":0.1}},
         {"type":"orthographic","orthographic":{"xmag":1,"ymag":1.5,"znear":0.1,"zfar":9}},
         {"name":"lens","type":"perspective","perspective":{"yfov":0.7,"aspectRatio":1.5,"znear":0.1}},
         {"type":"perspective","perspective":{"yfov":0.2,"aspectRatio":0.5,"znear":0.1}}])");
  std::map<std::string, std::map<double, double>> fieldByHeight;  // name, then height above the floor
  for (const Camera& camera : scene.cameras) fieldByHeight[camera.name][camera.position.y] = camera.verticalFov;
  ASSERT_EQ(scene.cameras.size(), 4u);
  for (const Camera& camera : scene.cameras)
    EXPECT_EQ(camera.orthographicHeight, camera.name == "plan" ? 3.0 : 0.0) << camera.name;
  EXPECT_NEAR(fieldByHeight.at("eye").at(2.0), 0.7, 1e-12);
  EXPECT_NEAR(fieldByHeight.at("eye").at(5.0), 1.1, 1e-12);
  EXPECT_NEAR(fieldByHeight.at("nodes_4").at(0.0), 0.2, 1e-12);
}

}  // namespace
}  // namespace lucerna
