// Models as people's programs write them: OBJ and MTL, PLY, STL.
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/scene.hpp"
#include "support/contains.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::TempFolder;

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
const std::string kQuad = kCorners + "usemtl a\nf 1/1 2/2 3/3 4/4\n";

std::string warnings() {
  std::string all;
  for (const std::string& warning : loggedWarnings()) all += warning + "\n";
  return all;
}

Scene load(const std::filesystem::path& file) {
  clearLoggedWarnings();
  return loadScene(file);
}

/// A square of material a of an MTL.
Scene loadMtl(const TempFolder& folder, const std::string& mtl, const std::string& obj = kQuad) {
  folder.write("m.mtl", mtl);
  return load(folder.write("m.obj", "mtllib m.mtl\n" + obj));
}

void writeLeftRight(const std::filesystem::path& file) {
  writePng(file, Bitmap{2, 1, {255, 0, 0, 255, 0, 0, 255, 255}, false});
}

double areaOf(const Scene& scene) {
  double area = 0.0;
  for (std::size_t t = 0; t < scene.triangleCount(); ++t) {
    const auto corner = [&](std::size_t k) { return glm::dvec3(scene.vertices[scene.indices[3 * t + k]].position); };
    area += 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
  }
  return area;
}

// ---------------------------------------------------------------------------------------------------------------------
// OBJ

TEST(ObjFile, ConcaveFacesAreCoveredOnce) {
  const TempFolder folder;
  const Scene scene =
      load(folder.write("m.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n"));
  EXPECT_EQ(scene.triangleCount(), 4u);
  EXPECT_NEAR(areaOf(scene), 3.0, 1e-12);
}

TEST(ObjFile, VertexColoursAreDrawn) {
  const TempFolder folder;
  const auto colours = [](const std::array<const char*, 4>& c) {
    return fmt::format("v 0 0 0 {}\nv 1 0 0 {}\nv 1 1 0 {}\nv 0 1 0 {}\nf 1 2 3 4\n", c[0], c[1], c[2], c[3]);
  };
  // One colour is the material's; 188 of 255, sRGB-encoded, is 0.5029.
  for (const char* colour : {"1 0.737254902 0", "255 188 0", "1 0.737254902 0 1"}) {
    const Scene scene = load(folder.write("m.obj", colours({colour, colour, colour, colour})));
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_LT(glm::distance(scene.materials[0].diffuse, glm::vec3(1.0f, 0.50289f, 0.0f)), 1e-4f) << colour;
    EXPECT_EQ(scene.materials[0].diffuseTexture, -1);
    EXPECT_TRUE(loggedWarnings().empty()) << warnings();
  }
  // Several are a picture with a block of texels a triangle, whose corners are the vertices' colours.
  const Scene scene = load(folder.write("m.obj", colours({"1 0 0", "0 1 0", "0 0 1", "1 1 1"})));
  ASSERT_EQ(scene.materials.size(), 1u);
  ASSERT_EQ(scene.materials[0].diffuseTexture, 0);
  EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(1.0f));
  const Bitmap& picture = scene.textures[0].bitmap;
  for (const std::uint32_t i : scene.indices) {
    const Vertex& v = scene.vertices[i];
    const double x = static_cast<double>(v.texCoord.x) * picture.width - 0.5,
                 y = (1.0 - static_cast<double>(v.texCoord.y)) * picture.height - 0.5;
    EXPECT_NEAR(x, std::round(x), 1e-5);
    const auto at = 4 * static_cast<std::size_t>(std::lround(y) * picture.width + std::lround(x));
    const bool isRed = v.position == glm::vec3(0.0f), isWhite = v.position == glm::vec3(0.0f, 1.0f, 0.0f);
    EXPECT_EQ(picture.rgba[at], isRed || isWhite ? 255 : 0);
  }
  // Times Kd; and their mean beside a picture.
  writeLeftRight(folder / "lr.png");
  const std::string faces = "vt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
  EXPECT_EQ(loadMtl(folder, "newmtl a\nKd 0.5 0.5 0.5\n", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\n" + faces)
                .materials[0]
                .diffuse,
            glm::vec3(0.5f, 0.0f, 0.0f));
  const Scene mean =
      loadMtl(folder, "newmtl a\nmap_Kd lr.png\n", "v 0 0 0 1 0 0\nv 1 0 0 0 0 0\nv 1 1 0 1 0 0\n" + faces);
  EXPECT_LT(glm::distance(mean.materials[0].diffuse, glm::vec3(2.0f / 3.0f, 0.0f, 0.0f)), 1e-5f);
  EXPECT_TRUE(contains(warnings(), "count by their mean"));
}

TEST(ObjFile, TextsOfEveryEncodingAndLineEndAreRead) {
  const TempFolder folder;
  folder.write("m.mtl", "\xef\xbb\xbfnewmtl a\r\nKd 1 0 0\r\n");
  const std::string text = "mtllib m.mtl\n" + kQuad;
  std::string little = "\xff\xfe", big = "\xfe\xff", old = text;
  for (const char c : text) little += std::string{c, '\0'}, big += std::string{'\0', c};
  std::replace(old.begin(), old.end(), '\n', '\r');
  for (const std::string& content : {"\xef\xbb\xbf" + text, little, big, old}) {
    const Scene scene = load(folder.write("m.obj", content));
    EXPECT_EQ(scene.triangleCount(), 2u);
    EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(1.0f, 0.0f, 0.0f));
    EXPECT_TRUE(loggedWarnings().empty()) << warnings();
  }
  std::string unmarked;
  for (const char c : text) unmarked += std::string{c, '\0'};
  EXPECT_TRUE(contains(badInputMessage([&] { loadScene(folder.write("n.obj", unmarked)); }), "UTF-16"));
}

TEST(ObjFile, LibrariesAreFoundUnderAllTheirNames) {
  const TempFolder folder;
  folder.write("red paint.mtl", "newmtl a\nKd 1 0 0\n");
  folder.write("green.mtl", "newmtl b\nKd 0 1 0\n");
  const std::string faces = kCorners + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n";
  for (const char* line : {"\"red paint.mtl\" green.mtl", "red paint.mtl green.mtl", "green.mtl red paint.mtl ",
                           "C:\\work\\red paint.mtl \"green.mtl\"", "red paint.mtl\nmtllib green.mtl"}) {
    const Scene scene = load(folder.write("m.obj", std::string("mtllib ") + line + "\n" + faces));
    ASSERT_EQ(scene.materials.size(), 2u) << line;
    EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(1.0f, 0.0f, 0.0f)) << line;
    EXPECT_EQ(scene.materials[1].diffuse, glm::vec3(0.0f, 1.0f, 0.0f)) << line;
    EXPECT_TRUE(loggedWarnings().empty()) << line << warnings();
  }
  // One of two is missing; a library of the file's own name steps in.
  load(folder.write("m.obj", "mtllib green.mtl gone.mtl\n" + faces));
  EXPECT_TRUE(contains(warnings(), "gone.mtl is missing; no library has material a")) << warnings();
  folder.write("house.mtl", "newmtl a\nKd 0 0 1\n");
  EXPECT_EQ(load(folder.write("house.obj", "mtllib gone.mtl\n" + kQuad)).materials[0].diffuse, glm::vec3(0, 0, 1));
  EXPECT_TRUE(contains(warnings(), "gone.mtl is missing; using house.mtl")) << warnings();
}

TEST(ObjFile, UnknownMaterialsAreNamed) {
  const TempFolder folder;
  const Scene scene = loadMtl(folder, "newmtl b\nKd 1 0 0\n");
  EXPECT_EQ(scene.materials[0].name, "a");
  EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(0.6f));
  EXPECT_TRUE(contains(warnings(), "no library has material a"));
  load(folder.write("n.obj", kQuad));
  EXPECT_TRUE(contains(warnings(), "no library has material a"));
}

TEST(ObjFile, NormalsAndTextureCoordinatesThatAreNotThereAreMade) {
  const TempFolder folder;
  for (const char* face : {"f 1//1 2//1 3//1", "f 1/9/7 2/1/7 3/1/7", "f 1//-1 2//-1 3//-1", "f 1/-9 2/1 3/1"}) {
    const Scene scene = load(folder.write("m.obj", kCorners + face + "\n"));
    EXPECT_EQ(scene.triangleCount(), 1u) << face;
    for (const Vertex& v : scene.vertices) EXPECT_EQ(v.normal, glm::vec3(0.0f, 0.0f, 1.0f)) << face;
    EXPECT_TRUE(contains(warnings(), "that it does not hold")) << face;
  }
  // Of one corner alone.
  const Scene scene = load(folder.write("m.obj", kCorners + "vn 1 0 0\nf 1//1 2//1 3//2\n"));
  EXPECT_EQ(scene.vertices[0].normal, glm::vec3(1.0f, 0.0f, 0.0f));
  EXPECT_EQ(scene.vertices[2].normal, glm::vec3(0.0f, 0.0f, 1.0f));
}

TEST(ObjFile, PlacesFarFromTheOriginKeepTheirShape) {
  const TempFolder folder;
  // A post of 10 cm at the place of a house in Web Mercator, and a camera of the scene in the same coordinates.
  const std::string post =
      "v 12958091.1 50 -4865487.5\nv 12958091.2 50 -4865487.5\nv 12958091.2 51.2 -4865487.5\nv 12958091.1 51.2 "
      "-4865487.5\nf 1 2 3 4\n";
  folder.write("post.obj", post);
  const Scene scene = load(folder.write("s.json", R"({"model": "post.obj", "points": [
      {"position": [12958091.15, 50.6, -4865486.5], "intensity": [1, 1, 1]}],
      "camera": {"position": [12958091.15, 50.6, -4865485.5], "target": [12958091.15, 50.6, -4865487.5]}})"));
  EXPECT_EQ(scene.origin.y, 0.0);
  EXPECT_NEAR(areaOf(scene), 0.12, 1e-6);
  const glm::dvec3 centre = scene.bounds.centre();
  EXPECT_LT(glm::distance(centre + scene.origin, glm::dvec3(12958091.15, 50.6, -4865487.5)), 1e-6);
  EXPECT_LT(glm::distance(scene.cameras[0].position - centre, glm::dvec3(0.0, 0.0, 2.0)), 1e-5);
  EXPECT_LT(glm::distance(scene.points[0].position - centre, glm::dvec3(0.0, 0.0, 1.0)), 1e-5);
  EXPECT_TRUE(contains(warnings(), "taken off all positions")) << warnings();
  // What single precision holds stays where it is.
  EXPECT_EQ(load(folder.write("m.obj", "v 1024 0 0\nv 1025 0 0\nv 1024 1 0\nf 1 2 3\n")).origin, glm::dvec3(0.0));
  EXPECT_EQ(load(folder.write("m.obj", "v 100.1 0 0\nv 101.1 0 0\nv 100.1 1 0\nf 1 2 3\n")).origin, glm::dvec3(0.0));
  EXPECT_TRUE(loggedWarnings().empty()) << warnings();
}

TEST(ObjFile, OtherStatementsAreNamed) {
  const TempFolder folder;
  load(folder.write("m.obj", "call other.obj\ns 1\ng\n# f 1 2\\\n" + kCorners + "f 1 2 3 # a face\np 1\nl 1 2\n"));
  EXPECT_EQ(warnings().find("not read: call"), warnings().find("not read"));
  EXPECT_EQ(loggedWarnings().size(), 1u) << warnings();
}

// ---------------------------------------------------------------------------------------------------------------------
// MTL

TEST(MtlFile, OptionsStandBeforePictures) {
  const TempFolder folder;
  writeLeftRight(folder / "lr.png");
  writeLeftRight(folder / "left right.png");
  struct Case {
    const char* line;
    glm::vec2 corner;  ///< texture coordinates of (1, 1)
  };
  for (const Case& c :
       {Case{"map_Kd lr.png ", {1, 1}}, Case{"map_Kd\tlr.png\t\r", {1, 1}}, Case{"map_Kd -s 2 3 1 lr.png", {2, 3}},
        Case{"map_Kd -s 2 lr.png", {2, 1}}, Case{"map_Kd -o 0.25 0.5 0 -s 2 2 2 lr.png", {2.25, 2.5}},
        Case{"map_Kd -blendu on -blendv off -texres 512 -boost 2 -mm 0 1 -t 0 0 0 left right.png", {1, 1}},
        Case{"map_Kd -colorspace sRGB -type sphere \"left right.png\"", {1, 1}},
        Case{"map_Kd -clamp on lr.png", {1, 1}}, Case{"map_Kd -clamp on -s 2 2 lr.png", {2, 2}},
        Case{"map_Kd lr.png -s 2 2 2", {2, 2}}, Case{"map_kd lr.png # the wall", {1, 1}},
        Case{"map_Kd D:\\maps\\LR.PNG", {1, 1}}, Case{"map_Kd .\\lr.png", {1, 1}}}) {
    const Scene scene = loadMtl(folder, std::string("newmtl a\n") + c.line + "\n");
    ASSERT_EQ(scene.textures.size(), 1u) << c.line;
    EXPECT_EQ(scene.textures[0].bitmap.width, 2) << c.line;
    EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(1.0f)) << c.line;  // a picture without Kd
    EXPECT_EQ(scene.vertices[2].texCoord, c.corner) << c.line;
    EXPECT_TRUE(loggedWarnings().empty()) << c.line << warnings();
  }
  // What is not done is said.
  for (const auto& [line, said] : {std::pair{"map_Kd -mm 0.2 0.5 lr.png", "-mm 0.2 0.5"},
                                   {"map_Kd -colorspace linear lr.png", "-colorspace linear"},
                                   {"map_Kd lr.png\nmap_Ns lr.png", "map_Ns"},
                                   {"map_Kd lr.png\ndisp lr.png", "disp"}}) {
    loadMtl(folder, std::string("newmtl a\n") + line + "\n");
    EXPECT_EQ(loggedWarnings().size(), 1u) << line << warnings();
    EXPECT_TRUE(contains(warnings(), said)) << line << warnings();
  }
}

// One picture with and without -clamp is two textures; two materials of the same share one.
TEST(MtlFile, ClampingIsOfAPicturesUse) {
  const TempFolder folder;
  writeLeftRight(folder / "lr.png");
  const Scene scene = loadMtl(folder,
                              "newmtl a\nmap_Kd -clamp on lr.png\nmap_Ke -clamp off lr.png\n"
                              "newmtl b\nmap_Kd -clamp on lr.png\n",
                              kQuad + "usemtl b\nf 1/1 2/2 3/3\n");
  EXPECT_TRUE(loggedWarnings().empty()) << warnings();
  ASSERT_EQ(scene.textures.size(), 2u);
  const auto wraps = [&](int texture) { return scene.textures.at(static_cast<std::size_t>(texture)).wraps; };
  EXPECT_EQ(wraps(scene.materials[0].diffuseTexture), (TextureWraps{TextureWrap::edge, TextureWrap::edge}));
  EXPECT_EQ(wraps(scene.materials[0].emissionTexture), TextureWraps{});
  EXPECT_EQ(scene.materials[0].diffuseTexture, scene.materials[1].diffuseTexture);
  // A picture that is its own mask is read as the mask says.
  folder.write("a.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\x20\x08\0\0\xff\xff\0\0\xff\0", 26));
  const Scene masked = loadMtl(folder, "newmtl a\nmap_Kd a.tga\nmap_d -clamp on a.tga\n");
  ASSERT_EQ(masked.textures.size(), 2u) << warnings();
  EXPECT_TRUE(masked.materials[0].alphaMasked);
  EXPECT_EQ(masked.materials[0].diffuseTexture, 0);
  EXPECT_EQ(masked.materials[0].alphaTexture, 1);
  EXPECT_EQ(masked.textures[1].wraps.u, TextureWrap::edge);
}

TEST(MtlFile, NumbersAreReadAsTheyAreWritten) {
  const TempFolder folder;
  const auto diffuse = [&](const std::string& lines) {
    return loadMtl(folder, "newmtl a\n" + lines).materials[0].diffuse;
  };
  EXPECT_EQ(diffuse("Kd 0.25\n"), glm::vec3(0.25f));
  EXPECT_EQ(diffuse("  Kd .25 5e-1 +1.0 # red\n"), glm::vec3(0.25f, 0.5f, 1.0f));
  EXPECT_EQ(diffuse("illum 2\n"), glm::vec3(0.6f));
  EXPECT_TRUE(loggedWarnings().empty()) << warnings();
}

TEST(MtlFile, AColourThatCannotBeIsNamed) {
  const TempFolder folder;
  const auto expect = [&](const std::string& line, const glm::vec3& diffuse, const std::string& said) {
    EXPECT_EQ(loadMtl(folder, "newmtl a\n" + line + "\n").materials[0].diffuse, diffuse) << line;
    EXPECT_EQ(loggedWarnings().size(), 1u) << line << warnings();
    EXPECT_TRUE(contains(warnings(), said)) << line << warnings();
  };
  expect("Kd 2 0.5 -0.5", {1.0f, 0.5f, 0.0f}, "material 'a': Kd 2 0.5 -0.5, which counts as 1 0.5 0");
  expect("Kd nan 0.5 0.5", {0.0f, 0.5f, 0.5f}, "Kd nan 0.5 0.5, which counts as 0 0.5 0.5");
  expect("Kd .2 .4", {0.2f, 0.4f, 0.2f}, "Kd 0.2 0.4 (of two numbers)");
}

TEST(MtlFile, ABackslashContinuesALine) {
  const TempFolder folder;
  const Scene scene = loadMtl(folder, "newmtl a\nKd .2 \\\n .4 .6\n# a comment \\\nNi 1.5\n");
  EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(0.2f, 0.4f, 0.6f));
  EXPECT_TRUE(loggedWarnings().empty()) << warnings();
}

TEST(MtlFile, KeysThatAreNotReadAreOneWarning) {
  const TempFolder folder;
  const Scene scene =
      loadMtl(folder,
              "newmtl a\nKd 0.5 0.25 0.125\nKa spectral a.rfl\nTf xyz 1 1 1\nTf 1 1 1\naniso 0.2\nanisor 0\n"
              "Pc 0\nPcr 0\nPs 0\nillum two\nNs many\nd -halo 1\nunheard of\nsharpness 60\n");
  EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(0.5f, 0.25f, 0.125f));
  ASSERT_EQ(loggedWarnings().size(), 1u) << warnings();
  EXPECT_TRUE(contains(warnings(), "m.mtl: not read: -halo, Ns many, Tf, aniso, illum two, unheard\n")) << warnings();
}

TEST(MtlFile, NormalMapsAreReadUnderAnyKey) {
  const TempFolder folder;
  writePng(folder / "normals.png", Bitmap{2, 1, {218, 127, 218, 255, 128, 128, 255, 255}, false});
  writePng(folder / "heights.png", Bitmap{2, 1, {40, 40, 40, 255, 200, 200, 200, 255}, false});
  for (const char* line : {"norm normals.png", "norm -bm 0.5 normals.png", "map_Bump -bm 0.5 normals.png",
                           "bump normals.png -bm 0.5", "map_bump normals.png"}) {
    const Material material = loadMtl(folder, std::string("newmtl a\nKd 1 1 1\n") + line + "\n").materials[0];
    EXPECT_EQ(material.normalTexture, 0) << line;
    EXPECT_EQ(material.normalScale, contains(line, "-bm") ? 0.5f : 1.0f) << line;
    EXPECT_TRUE(loggedWarnings().empty()) << warnings();
  }
  const Scene scene = loadMtl(folder, "newmtl a\nKd 1 1 1\nbump heights.png\n");
  EXPECT_EQ(scene.materials[0].normalTexture, -1);
  EXPECT_TRUE(scene.textures.empty());
  EXPECT_TRUE(contains(warnings(), "not read: bump (maps of heights)"));
}

TEST(MtlFile, APictureAloneShines) {
  const TempFolder folder;
  writePng(folder / "white.png", Bitmap{1, 1, {255, 255, 255, 255}, false});
  EXPECT_EQ(loadMtl(folder, "newmtl a\nmap_Ke white.png\n").materials[0].emission, glm::vec3(1.0f));
  EXPECT_EQ(loadMtl(folder, "newmtl a\nKe 0 0 0\nmap_Ke white.png\n").materials[0].emission, glm::vec3(0.0f));
  EXPECT_EQ(loadMtl(folder, "newmtl a\nmap_Ke none.png\n").materials[0].emission, glm::vec3(0.0f));
}

// ---------------------------------------------------------------------------------------------------------------------
// PLY

std::string bytesOf(float value, bool big = false) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(bits >> 8 * (big ? 3 - i : i) & 255u);
  return bytes;
}

const std::string kPlyVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n",
                  kPlyFace = "element face 1\nproperty list uchar int vertex_indices\n",
                  kPlyCorners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TEST(PlyFile, EveryFormatIsRead) {
  const TempFolder folder;
  for (const char* end : {"\n", "\r\n", "\r"}) {
    for (const bool big : {false, true}) {
      std::string header = "ply\nformat " + std::string(big ? "binary_big_endian" : "binary_little_endian") + " 1.0\n" +
                           kPlyVertices + "property uchar quality\n" + kPlyFace + "end_header\n";
      for (std::size_t at = 0; (at = header.find('\n', at)) != std::string::npos; at += std::strlen(end))
        header.replace(at, 1, end);
      // Coordinates whose bytes are line ends and blanks.
      std::string data;
      const float one = std::bit_cast<float>(big ? 0x0a0d0a20u : 0x3f800a0au);
      for (const glm::vec3& p : {glm::vec3(one, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0), glm::vec3(0, 1, 0)})
        data += bytesOf(p.x, big) + bytesOf(p.y, big) + bytesOf(p.z, big) + "\x0a";
      data += "\x04";
      for (const char i : {'\0', '\1', '\2', '\3'}) data += big ? std::string{0, 0, 0, i} : std::string{i, 0, 0, 0};
      const Scene scene = load(folder.write("m.ply", header + data));
      EXPECT_EQ(scene.triangleCount(), 2u);
      EXPECT_TRUE(std::any_of(scene.vertices.begin(), scene.vertices.end(),
                              [&](const Vertex& v) { return v.position.x == one; }));
      EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(0.6f));
      EXPECT_TRUE(loggedWarnings().empty()) << warnings();
      EXPECT_TRUE(
          contains(badInputMessage([&] { loadScene(folder.write("n.ply", header + data.substr(0, data.size() - 1))); }),
                   "ends within element face"));
    }
  }
}

TEST(PlyFile, HeadersMayHoldMoreThanMeshes) {
  const TempFolder folder;
  const Scene scene =
      load(folder.write("m.ply",
                        "ply\nformat ascii 1.0\ncomment made by hand\\\nobj_info num_cols 512\nCreated by "
                        "hand\nelement vertex 4\ncomment between\n"
                        "property double x\nproperty float32 y\nproperty float z\nproperty list uchar float weights\n"
                        "element camera 1\nproperty float view_px\nproperty int viewportx\nelement nothing 3\n" +
                            kPlyFace + "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n" +
                            "0 0 0 0\n1 0 0 2 7 8\n1 1 0 0\n0 1 0 1 5\n0.5 640\n4 0 1 2 3\n0 1\n"));
  EXPECT_EQ(scene.triangleCount(), 2u);
  EXPECT_TRUE(contains(warnings(), "not read: element camera, nothing, edge")) << warnings();
}

TEST(PlyFile, StripsAreTrianglesOfOneSide) {
  const TempFolder folder;
  const Scene scene =
      load(folder.write("m.ply", "ply\nformat ascii 1.0\n" + kPlyVertices +
                                     "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                                     kPlyCorners + "8 0 1 3 2 -1 1 0 3\n"));
  EXPECT_EQ(scene.triangleCount(), 3u);
  for (std::size_t t = 0; t < 3; ++t) {
    const auto corner = [&](std::size_t k) { return glm::dvec3(scene.vertices[scene.indices[3 * t + k]].position); };
    EXPECT_EQ(glm::cross(corner(1) - corner(0), corner(2) - corner(0)).z, t < 2 ? 1.0 : -1.0);
  }
}

TEST(PlyFile, ColoursOfVerticesAndFacesAreDrawn) {
  const TempFolder folder;
  const std::string rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const Scene vertices =
      load(folder.write("m.ply", "ply\nformat ascii 1.0\n" + kPlyVertices + rgb + kPlyFace +
                                     "end_header\n0 0 0 255 188 0\n1 0 0 255 188 0\n1 1 0 255 188 0\n0 1 0 255 188 0\n"
                                     "4 0 1 2 3\n"));
  EXPECT_LT(glm::distance(vertices.materials[0].diffuse, glm::vec3(1.0f, 0.50289f, 0.0f)), 1e-4f);
  const Scene faces = load(folder.write(
      "m.ply", "ply\nformat ascii 1.0\n" + kPlyVertices + "element face 2\nproperty list uchar int vertex_index\n" +
                   rgb + "end_header\n" + kPlyCorners + "3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n"));
  ASSERT_EQ(faces.materials[0].diffuseTexture, 0);
  EXPECT_EQ(faces.textures[0].bitmap.rgba[0], 255);
  EXPECT_TRUE(loggedWarnings().empty()) << warnings();
}

TEST(PlyFile, PicturesAreNamedInComments) {
  const TempFolder folder;
  writeLeftRight(folder / "left right.png");
  const Scene scene = load(folder.write(
      "m.ply", "ply\nformat ascii 1.0\ncomment TextureFile left right.png\n" + kPlyVertices +
                   "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
                   "end_header\n" +
                   kPlyCorners + "4 0 1 2 3 8 0 0 1 0 1 0.5 0 1\n"));
  EXPECT_EQ(scene.materials[0].diffuseTexture, 0);
  EXPECT_EQ(scene.vertices[2].texCoord, glm::vec2(1.0f, 0.5f));
}

TEST(PlyFile, WhatIsWrongIsNamed) {
  const TempFolder folder;
  const std::string head = "ply\nformat ascii 1.0\n";
  for (const auto& [content, said] :
       {std::pair<std::string, const char*>{"solid", "does not begin with 'ply'"},
        {head + kPlyVertices, "no end_header"},
        {head + kPlyVertices + "end_header\n" + kPlyCorners, "points alone (4), no face"},
        {head + kPlyVertices + kPlyFace + "end_header\n" + kPlyCorners, "element face"},
        {head + kPlyVertices + kPlyFace + "end_header\n0 0 zero", "'zero' in element vertex"},
        {head + kPlyVertices + kPlyFace + "end_header\n" + kPlyCorners + "3 0 1 4\n",
         "refers to vertex 4, the file holds 4"},
        {head + kPlyVertices + kPlyFace + "end_header\n" + kPlyCorners + "3 0 1 -1\n", "refers to vertex -1"},
        {head + "element vertex many\nend_header\n", "the count 'many'"},
        {head + "element vertex 1\nproperty quad x\nend_header\n", "the type 'quad'"},
        {head + "element vertex 99999999999\nproperty float x\nproperty float y\nproperty "
                "float z\nend_header\n",
         "ends within element vertex"},
        {"ply\nformat binary_middle_endian 1.0\nend_header\n", "binary_middle_endian"}}) {
    const std::filesystem::path file = folder.write("m.ply", content);
    const std::string message = badInputMessage([&] { loadScene(file); });
    EXPECT_TRUE(contains(message, said)) << content << message;
    EXPECT_TRUE(contains(message, "m.ply")) << message;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// STL

std::string binaryStl(std::string header, const std::vector<unsigned>& attributes) {
  header.resize(80, ' ');
  std::string stl = header + std::string{static_cast<char>(attributes.size()), 0, 0, 0};
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    for (const float v : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f}) stl += bytesOf(v);
    stl += std::string{static_cast<char>(attributes[i] & 255u), static_cast<char>(attributes[i] >> 8)};
  }
  return stl;
}

TEST(StlFile, BothKindsAreGreyAndWithoutAHighlight) {
  const TempFolder folder;
  const std::string text =
      "solid a part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n"
      "  endloop\n endfacet\nendsolid a part\n";
  std::string loud = text;
  for (char& c : loud) c = static_cast<char>(std::toupper(c));
  for (const std::string& content : {text, loud, binaryStl("made by hand", {0}), binaryStl("solid by another", {0})}) {
    const Scene scene = load(folder.write("m.stl", content));
    EXPECT_EQ(scene.triangleCount(), 1u);
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(0.6f));
    EXPECT_EQ(scene.materials[0].specular, glm::vec3(0.0f));
    EXPECT_EQ(scene.vertices[0].normal, glm::vec3(0.0f, 0.0f, 1.0f));
    EXPECT_TRUE(loggedWarnings().empty()) << warnings();
  }
  // Far off, in double.
  std::string far = text;
  for (std::size_t at = 0; (at = far.find("vertex ", at)) != std::string::npos;) far.insert(at += 7, "500000");
  far.replace(far.find("vertex 5000001 0 0"), 18, "vertex 5000000.1 0 0");
  EXPECT_NEAR(areaOf(load(folder.write("m.stl", far))), 0.05, 1e-9);
}

TEST(StlFile, ColoursOfFacetsAreDrawn) {
  const TempFolder folder;
  // VisCAM: 15 set, red in 10 to 14. Magics: 15 clear, red in 0 to 4.
  EXPECT_EQ(load(folder.write("m.stl", binaryStl("", {0x8000u | 31u << 10}))).materials[0].diffuse, glm::vec3(1, 0, 0));
  const std::string magics = std::string("COLOR=") + '\0' + '\xff' + '\0' + '\xff';
  EXPECT_EQ(load(folder.write("m.stl", binaryStl(magics, {31u}))).materials[0].diffuse, glm::vec3(1, 0, 0));
  EXPECT_EQ(load(folder.write("m.stl", binaryStl(magics, {0x8000u}))).materials[0].diffuse, glm::vec3(0, 1, 0));
  EXPECT_GE(load(folder.write("m.stl", binaryStl(magics, {31u, 0x8000u}))).materials[0].diffuseTexture, 0);
}

TEST(StlFile, WhatIsCutOffIsSaid) {
  const TempFolder folder;
  const std::string whole = binaryStl("", {0, 0}), solid = binaryStl("solid", {0, 0});
  for (const std::string& content : {whole.substr(0, whole.size() - 1), solid.substr(0, 120),
                                     std::string("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n")})
    EXPECT_TRUE(contains(badInputMessage([&] { loadScene(folder.write("m.stl", content)); }), "cut off"));
}

}  // namespace
}  // namespace lucerna
