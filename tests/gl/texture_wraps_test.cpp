// What textures show beyond their pictures: the rasteriser, the path tracer and the patches of radiosity against the
// bilinear filter of OpenGL in double precision, each texel by its own wrap.
#include "radiosity/direct_rays.hpp"
#include "radiosity/patches.hpp"
#include "support/gltf_file.hpp"
#include "support/path_scenes.hpp"

#include "base/angles.hpp"
#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

namespace lucerna::test {
namespace {

constexpr TextureWrap kWraps[] = {TextureWrap::repeat, TextureWrap::edge, TextureWrap::mirror};

std::string nameOf(const TextureWraps& wraps) {
  static const char* names[] = {"repeat", "edge", "mirror"};
  return std::string(names[static_cast<int>(wraps.u)]) + " x " + names[static_cast<int>(wraps.v)];
}

/// The texel that stands at place i of a row of n [OpenGL 4.3, table 8.20].
int texelAt(int i, int n, TextureWrap wrap) {
  const auto modulo = [](int a, int b) { return (a % b + b) % b; };
  const auto mirror = [](int a) { return a >= 0 ? a : -(1 + a); };
  switch (wrap) {
    case TextureWrap::edge: return std::clamp(i, 0, n - 1);
    case TextureWrap::mirror: return n - 1 - mirror(modulo(i, 2 * n) - n);
    case TextureWrap::repeat: break;
  }
  return modulo(i, n);
}

/// Values 0..1 of a bitmap whose channels are 0 or 255, so that their encoding does not count.
glm::dvec3 bilinear(const Texture& texture, const glm::dvec2& uv) {
  const Bitmap& bitmap = texture.bitmap;
  const glm::dvec2 p = uv * glm::dvec2(bitmap.width, bitmap.height) - 0.5, low = glm::floor(p), f = p - low;
  const auto at = [&](int dx, int dy) {
    const int x = texelAt(static_cast<int>(low.x) + dx, bitmap.width, texture.wraps.u),
              y = texelAt(static_cast<int>(low.y) + dy, bitmap.height, texture.wraps.v);
    const std::uint8_t* texel = &bitmap.rgba[4 * static_cast<std::size_t>((bitmap.height - 1 - y) * bitmap.width + x)];
    return glm::dvec3(texel[0], texel[1], texel[2]) / 255.0;
  };
  return glm::mix(glm::mix(at(0, 0), at(1, 0), f.x), glm::mix(at(0, 1), at(1, 1), f.x), f.y);
}

/// Four by two texels without any symmetry.
Bitmap testPicture() {
  return {4,
          2,
          {255, 0,   0,   255, 0,   255, 0,   255, 0,   0,   255, 255, 255, 255, 255, 255,
           0,   255, 255, 255, 255, 0,   255, 255, 255, 255, 0,   255, 0,   0,   0,   255},
          false};
}

constexpr int kPixels = 48;
/// Texture coordinates of a pixel's middle on a wall that fills the picture, `low` to `high` in both directions.
glm::dvec2 texCoordOf(int x, int y, double low, double high) {
  return low + (high - low) * glm::dvec2(x + 0.5, kPixels - y - 0.5) / static_cast<double>(kPixels);
}

/// A wall of side 8 that faces +z.
Scene wall(const Material& material, const Texture& texture, double low, double high) {
  SceneBuilder builder;
  const int index = builder.material(glm::vec3(1.0f));
  builder.materialAt(index) = material;
  builder.plate({0, 0, 0}, {8, 0, 0}, {0, 8, 0}, index);
  builder.sun({0, 0, -1}, glm::vec3(static_cast<float>(kPi)));
  for (Vertex& v : builder.scene().vertices) v.texCoord = glm::vec2(low + (high - low) * glm::dvec2(v.texCoord));
  builder.scene().textures.push_back(texture);
  return builder.scene();
}

class TextureWrapsGl : public PathTest {
 protected:
  static Camera camera() { return lookingAt({0, 0, 8}, {0, 0, 0}, 2.0 * std::atan(0.5)); }
  static Image rastered(const Scene& scene) {
    RenderSettings settings;
    settings.technique = "direct";
    settings.size = glm::ivec2(kPixels);
    settings.fullFloatTarget = true;
    settings.shadow.size = 256;
    settings.textures.anisotropy = 1.0f;  // llvmpipe's anisotropic filter blurs what is magnified, too
    Renderer renderer(context(), library(), scene, settings);
    renderer.render(camera());
    return renderer.readRadiance();
  }
  Image traced(const Scene& scene) {
    PathTracer::Settings settings = sized(kPixels);
    settings.filter = PixelFilter::centre;
    settings.transport = Transport::direct;
    return tracer(scene, camera(), settings, 1).mean();
  }
  /// Of the wall from -1 to 2; `expected`: radiance by the texture's values, below 0: not to be tested.
  void expectBoth(const Scene& scene, const std::function<glm::dvec3(const glm::dvec3&)>& expected, double low = -1.0,
                  double high = 2.0) {
    const Image raster = rastered(scene), path = traced(scene);
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x) {
        const glm::dvec3 right = expected(bilinear(scene.textures[0], texCoordOf(x, y, low, high)));
        if (right.x < 0.0) continue;
        for (int c = 0; c < 3; ++c) {
          ASSERT_NEAR(raster.at(x, y)[c], right[c], 8e-3) << x << " " << y << " " << c;  // weights have 8 bits
          ASSERT_NEAR(path.at(x, y)[c], right[c], 1e-3) << x << " " << y << " " << c;
        }
      }
  }
};

// ------------------------------------------------------------------------------------------------------- from files

/// The wall with texture coordinates from -1 to 2, its picture with two samplers' values.
Scene gltfWall(const TempFolder& folder, int wrapS, int wrapT) {
  writePng(folder / "four.png", testPicture());
  Gltf gltf;
  gltf.attributes()["POSITION"] = gltf.floats({-4, -4, 0, 4, -4, 0, 4, 4, 0, -4, -4, 0, 4, 4, 0, -4, 4, 0}, "VEC3");
  gltf.attributes()["TEXCOORD_0"] = gltf.floats({-1, 2, 2, 2, 2, -1, -1, 2, 2, -1, -1, -1}, "VEC2");
  gltf.primitive()["material"] = 0;
  gltf.root["images"] = {{{"uri", "four.png"}}};
  gltf.root["samplers"] = {{{"wrapS", wrapS}, {"wrapT", wrapT}}};
  gltf.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
  gltf.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}}}};
  return loadScene(folder.write("wall.gltf", gltf.text()));
}

/// Of one matte material, met straight on by a sun whose light leaves a white surface as radiance 1.
void makeMatte(Scene& scene) {
  ASSERT_EQ(scene.materials.size(), 1u);
  scene.materials[0].specular = glm::vec3(0.0f);
  scene.sun = DirectionalLight{{0, 0, -1}, glm::vec3(static_cast<float>(kPi))};
  scene.background = glm::vec3(0.0f);
  scene.environment.reset();
}

TEST_F(TextureWrapsGl, AGltfSamplerSaysHowColoursContinue) {
  const TempFolder folder;
  constexpr int kValues[] = {10497, 33071, 33648};
  for (std::size_t s = 0; s < 3; ++s)
    for (std::size_t t = 0; t < 3; ++t) {
      clearLoggedWarnings();
      Scene scene = gltfWall(folder, kValues[s], kValues[t]);
      EXPECT_TRUE(loggedWarnings().empty());
      makeMatte(scene);
      ASSERT_EQ(scene.textures.size(), 1u);
      // The reference follows what the file says.
      EXPECT_EQ(scene.textures[0].wraps, (TextureWraps{kWraps[s], kWraps[t]}));
      scene.textures[0].wraps = {kWraps[s], kWraps[t]};
      SCOPED_TRACE(nameOf(scene.textures[0].wraps));
      expectBoth(scene, [](const glm::dvec3& texel) { return texel; });
    }
}

TEST_F(TextureWrapsGl, AClampedPictureOfMtlShowsItsEdgeOutside) {
  const TempFolder folder;
  writePng(folder / "four.png", testPicture());
  const std::string quad =
      "mtllib m.mtl\nv -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "usemtl a\nf 1/1 2/2 3/3 4/4\n";
  const std::filesystem::path file = folder.write("m.obj", quad);
  for (const bool clamped : {false, true}) {
    SCOPED_TRACE(clamped);
    folder.write("m.mtl", std::string("newmtl a\nKd 1 1 1\nmap_Kd -s 3 3 1 -o -1 -1 0 -clamp ") +
                              (clamped ? "on" : "off") + " four.png\n");
    clearLoggedWarnings();
    Scene scene = loadScene(file);
    EXPECT_TRUE(loggedWarnings().empty());
    makeMatte(scene);
    const TextureWrap wrap = clamped ? TextureWrap::edge : TextureWrap::repeat;
    scene.textures[0].wraps = {wrap, wrap};
    EXPECT_EQ(loadScene(file).textures[0].wraps, scene.textures[0].wraps);
    expectBoth(scene, [](const glm::dvec3& texel) { return texel; });
  }
}

// ---------------------------------------------------------------------------------------------------- kinds of maps

TEST_F(TextureWrapsGl, EveryKindOfMapContinuesAsItsTextureSays) {
  for (const TextureWraps wraps :
       {TextureWraps{TextureWrap::edge, TextureWrap::mirror}, TextureWraps{TextureWrap::mirror, TextureWrap::edge}}) {
    SCOPED_TRACE(nameOf(wraps));
    Texture texture{"four", testPicture(), wraps};
    {
      SCOPED_TRACE("emission");
      Material material;
      material.diffuse = glm::vec3(0.0f);
      material.emissionTexture = 0;
      material.emission = material.emissionScale = glm::vec3(1.0f);
      expectBoth(wall(material, texture, -1.0, 2.0), [](const glm::dvec3& texel) { return texel; });
    }
    {
      SCOPED_TRACE("metal");
      Material material;
      material.metalMap = MetalMap{glm::vec3(1.0f), 1.0f, -1.0f, 0};
      expectBoth(wall(material, texture, -1.0, 2.0), [](const glm::dvec3& texel) { return glm::dvec3(1.0 - texel.z); });
    }
    {
      SCOPED_TRACE("mask");
      Material material;
      material.diffuse = glm::vec3(1.0f);
      material.alphaTexture = 0;
      material.alphaMasked = true;
      expectBoth(wall(material, texture, -1.0, 2.0), [](const glm::dvec3& texel) {
        return glm::dvec3(std::abs(texel.x - 0.5) < 0.02 ? -1.0 : texel.x > 0.5 ? 1.0 : 0.0);
      });
    }
    {
      SCOPED_TRACE("normals");
      for (std::size_t i = 2; i < texture.bitmap.rgba.size(); i += 4) texture.bitmap.rgba[i] = 255;
      Material material;
      material.diffuse = glm::vec3(1.0f);
      material.normalTexture = 0;
      Scene scene = wall(material, texture, -1.0, 2.0);
      const glm::dvec3 toSun = glm::normalize(glm::dvec3(0.5, 0.3, 1.0));
      scene.sun->direction = -toSun;
      expectBoth(scene, [&](const glm::dvec3& texel) {
        return glm::dvec3(glm::dot(glm::normalize(2.0 * texel - 1.0), toSun));
      });
    }
  }
}

// Within half a texel of the border a repeated picture is mixed with its other side; a clamped one shows its edge
// alone.
TEST_F(TextureWrapsGl, NothingComesThroughTheBorderOfAClampedPicture) {
  Material material;
  material.diffuse = glm::vec3(1.0f);
  material.diffuseTexture = 0;
  const Bitmap blackAndWhite{2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, false};
  Scene scene = wall(material, {"two", blackAndWhite, {TextureWrap::edge, TextureWrap::edge}}, 0.0, 1.0);
  for (const Image& image : {rastered(scene), traced(scene)})
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels / 4; ++x) {
        ASSERT_LT(image.at(x, y).x, 1e-4) << x << " " << y;
        ASSERT_NEAR(image.at(kPixels - 1 - x, y).x, 1.0, 1e-4) << x << " " << y;
      }
  scene.textures[0].wraps = {};
  EXPECT_GT(rastered(scene).at(0, 0).x, 0.4);
  EXPECT_GT(traced(scene).at(0, 0).x, 0.4);
}

// -------------------------------------------------------------------------------------------------------- radiosity

// A picture of 2 x 2 squares of 8 x 8 texels, coordinates from -1 to 3: each square of the wall's 8 x 8 is one of the
// picture's. Patches read nearest texels, so bilinear means differ at the squares' borders: by (1/2 texel) 1/4 of 8
// texels at each.
TEST_F(TextureWrapsGl, PatchesReflectAndEmitWhatTheyShow) {
  Bitmap squares{16, 16, {}, false};
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const auto channel = [](bool on) { return static_cast<std::uint8_t>(on ? 255 : 0); };
      const bool left = x < 8, top = y < 8;
      squares.rgba.insert(squares.rgba.end(),
                          {channel(left && top), channel(!left && top), channel(!top && left), 255});
    }
  for (const TextureWrap u : kWraps)
    for (const TextureWrap v : kWraps) {
      SCOPED_TRACE(nameOf({u, v}));
      Material material;
      material.diffuse = glm::vec3(1.0f);
      material.diffuseTexture = material.emissionTexture = 0;
      material.emission = material.emissionScale = glm::vec3(2.0f);
      const Scene scene = wall(material, {"squares", squares, {u, v}}, -1.0, 3.0);
      const RadiosityMesh mesh = makePatches(scene, {.longestEdge = 1.0});
      std::array<glm::dvec3, 64> reflected{}, emitted{};
      for (const Patch& patch : mesh.patches) {
        const auto square =
            static_cast<std::size_t>(std::floor(patch.centroid.x + 4.0) + 8.0 * std::floor(patch.centroid.y + 4.0));
        reflected.at(square) += patch.area * patch.reflectance;
        emitted.at(square) += patch.area * patch.emission;
      }
      for (int i = 0; i < 64; ++i) {
        glm::dvec3 expected(0.0);
        constexpr int kPoints = 32;
        for (int k = 0; k < kPoints * kPoints; ++k) {
          const glm::dvec2 at = glm::dvec2(k % kPoints + 0.5, k / kPoints + 0.5) / static_cast<double>(kPoints);
          expected +=
              bilinear(scene.textures[0], -1.0 + 0.5 * (glm::dvec2(i % 8, i / 8) + at)) / (1.0 * kPoints * kPoints);
        }
        for (int c = 0; c < 3; ++c) {
          ASSERT_NEAR(reflected[static_cast<std::size_t>(i)][c], expected[c], 4.0 / 64.0 + 1e-3) << i << " " << c;
          ASSERT_NEAR(emitted[static_cast<std::size_t>(i)][c], 2.0 * kPi * expected[c], 2.0 * kPi * (4.0 / 64.0 + 1e-3))
              << i << " " << c;
        }
      }
    }
}

// Two triangles with a picture of 2 x 1 from -1 to 2. Clamped, each is cut in its middle alone, into a triangle and a
// quadrangle, two triangles. Repeated or mirrored, the picture has 5 borders inside, and one more triangle for each
// border that follows.
TEST_F(TextureWrapsGl, EmittersAreCutWhereTheirPictureChanges) {
  Material material;
  material.emissionTexture = 0;
  material.emission = material.emissionScale = glm::vec3(1.0f);
  const Bitmap two{2, 1, {255, 0, 0, 255, 0, 255, 0, 255}, false};
  const auto pieces = [&](TextureWrap wrap) {
    return DirectRays::emitterCount(wall(material, {"two", two, {wrap, TextureWrap::edge}}, -1.0, 2.0));
  };
  EXPECT_EQ(pieces(TextureWrap::edge), 6u);
  EXPECT_EQ(pieces(TextureWrap::repeat), 22u);
  EXPECT_EQ(pieces(TextureWrap::mirror), 22u);
}

}  // namespace
}  // namespace lucerna::test
