// Pictures of normals, of metals and of emission, texel by texel: forward shading, radiosity and the path tracer
// against what the texels say.
#include "lpv/settings.hpp"
#include "radiosity/radiosity_view.hpp"
#include "support/coat_reference.hpp"
#include "support/path_scenes.hpp"

#include "base/angles.hpp"
#include "base/image.hpp"
#include "render/renderer.hpp"
#include "scene/coat.hpp"
#include "scene/texture_mean.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna::test {
namespace {

class SurfaceMaps : public PathTest {
 protected:
  static Image drawn(const Scene& scene, const Camera& camera, std::string_view technique = "direct",
                     Component component = Component::all) {
    RenderSettings settings;
    settings.technique = technique;
    settings.component = component;
    settings.size = glm::ivec2(16);
    settings.fullFloatTarget = true;
    settings.shadow.size = 256;
    settings.of<ReflectiveShadowMap::Settings>().size = 64;
    settings.of<LpvSettings>().cascades.cells = 8;
    settings.of<RadiosityView::Settings>().direct = RadiosityView::Direct::pixels;
    settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 12.0;
    settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 16;
    Renderer renderer(context(), library(), scene, settings);
    renderer.renderToTheEnd(camera);
    return renderer.readRadiance();
  }
  Image traced(const Scene& scene, const Camera& camera) {
    PathTracer::Settings settings = sized(16);
    settings.filter = PixelFilter::centre;
    settings.transport = Transport::direct;
    return tracer(scene, camera, settings, 1).mean();
  }
};

double linear(int byte) { return static_cast<double>(linearFromSrgb(static_cast<float>(byte) / 255.0f)); }

/// llvmpipe decodes sRGB by a polynomial that is off by up to 2 % of a dark value.
constexpr double kDecoding = 0.02;

/// Texels `left` for u < 1/2, `right` beyond.
int twoHalves(SceneBuilder& builder, std::array<std::uint8_t, 3> left, std::array<std::uint8_t, 3> right) {
  std::vector<std::uint8_t> rgba;
  for (int x = 0; x < 16; ++x)
    for (int c = 0; c < 4; ++c) rgba.push_back(c == 3 ? 255 : (x < 8 ? left : right)[static_cast<std::size_t>(c)]);
  return builder.texture(16, 1, rgba);
}

/// A floor of side 8 about the origin, its front up; u grows along +x, v towards -z.
SceneBuilder floorOf(const Material& material) {
  SceneBuilder builder;
  const int index = builder.material(glm::vec3(1.0f));
  builder.materialAt(index) = material;
  builder.plate({0, 0, 0}, {8, 0, 0}, {0, 0, -8}, index);
  return builder;
}

// ------------------------------------------------------------------------------------------------------------- mipmaps

// A chessboard of 48 x 48 texels fills a picture of 16 x 16: each pixel's centre is one texel's, of its 3 x 3. Without
// mipmaps a pixel is that texel, black or white; with them, log2(3) levels up, it is the mean.
TEST_F(SurfaceMaps, MipmapsAreTheMeanOfWhatAPixelCovers) {
  Material material;
  material.diffuse = glm::vec3(1.0f);
  SceneBuilder builder = floorOf(material);
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x)
      for (int c = 0; c < 4; ++c) rgba.push_back(c == 3 || (x + y) % 2 == 0 ? 255 : 0);
  builder.materialAt(0).diffuseTexture = builder.texture(48, 48, rgba);
  builder.sun({0, -1, 0}, glm::vec3(2.0f));
  const Camera camera = lookingAt({0, 20, 0}, {0, 0, 0}, 2.0 * std::atan(4.0 / 20.0));
  RenderSettings settings;
  settings.technique = "direct";
  settings.size = glm::ivec2(16);
  settings.fullFloatTarget = true;
  settings.shadow.size = 256;
  settings.textures.anisotropy = 1.0f;  // its filter too averages over texels
  const double white = 2.0 / kPi;
  for (const bool mipmaps : {true, false}) {
    settings.textures.mipmaps = mipmaps;
    Renderer renderer(context(), library(), builder.scene(), settings);
    renderer.render(camera);
    const Image image = renderer.readRadiance();
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const double seen = image.at(x, y).y / white;  // texel (3 x + 1, 3 y + 1), rows from the top
        if (mipmaps) ASSERT_NEAR(seen, 0.5, 0.5 * kDecoding) << x << " " << y;
        else ASSERT_NEAR(seen, (x + y) % 2 == 0 ? 1.0 : 0.0, 1e-2) << x << " " << y;
      }
  }
}

// ------------------------------------------------------------------------------------------------------------- normals

TEST_F(SurfaceMaps, NormalsLieAlongTheTextureWhicheverWayItLies) {
  struct Coordinates {
    const char* name;
    glm::dmat2 of;  ///< columns: what u and v are made of x and -z
    glm::dvec3 tangent, bitangent;
  };
  const Coordinates kinds[] = {{"as they are", glm::dmat2({1, 0}, {0, 1}), {1, 0, 0}, {0, 0, -1}},
                               {"turned", glm::dmat2({0, -1}, {1, 0}), {0, 0, -1}, {-1, 0, 0}},
                               {"mirrored", glm::dmat2({-1, 0}, {0, 1}), {-1, 0, 0}, {0, 0, -1}}};
  const std::array<std::uint8_t, 4> texel{220, 70, 200, 255};
  for (const Coordinates& kind : kinds)
    for (const float scale : {1.0f, 0.5f, -1.0f})
      for (const double side : {1.0, -1.0}) {
        SCOPED_TRACE(std::string(kind.name) + ", scale " + std::to_string(scale) + ", side " + std::to_string(side));
        Material material;
        material.diffuse = {0.8f, 0.4f, 0.2f};
        material.normalScale = scale;
        SceneBuilder builder = floorOf(material);
        builder.materialAt(0).normalTexture = builder.texture(1, 1, {texel.begin(), texel.end()});
        for (Vertex& v : builder.scene().vertices) v.texCoord = glm::vec2(kind.of * glm::dvec2(v.texCoord));
        const auto component = [&](std::size_t c) { return 2.0 * texel[c] / 255.0 - 1.0; };
        const double s = static_cast<double>(scale);
        const glm::dvec3 normal =
            side * glm::normalize(s * component(0) * kind.tangent + s * component(1) * kind.bitangent +
                                  component(2) * glm::dvec3(0, 1, 0));
        const Camera camera = lookingAt({0.3, 4.0 * side, 0.4}, {0.2, 0.0, 0.1}, 0.7);
        const glm::dvec3 toSun = glm::normalize(glm::dvec3(0.2, side, 0.3));
        builder.sun(-toSun, glm::vec3(2.0f));
        const double expected = 0.4 / kPi * 2.0 * glm::dot(normal, toSun);
        ASSERT_GT(expected, 0.05);
        const Image rastered = drawn(builder.scene(), camera), walked = traced(builder.scene(), camera);
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x) {
            ASSERT_NEAR(rastered.at(x, y).y, expected, 1e-4) << x << " " << y;
            ASSERT_NEAR(walked.at(x, y).y, expected, 1e-4) << x << " " << y;
          }
        if (side < 0.0 || scale != 1.0f) continue;  // radiosity's patches have one side
        const Image solved = drawn(builder.scene(), camera, "radiosity", Component::direct);
        EXPECT_NEAR(solved.at(8, 8).y, expected, 1e-4);
      }
}

/// A direction in a frame whose z is the normal.
glm::dvec3 aboutNormal(const glm::dvec3& normal, const glm::dvec3& direction) {
  const glm::dvec3 x = glm::normalize(glm::cross(normal, glm::dvec3(0.3, -0.4, 0.8))), y = glm::cross(normal, x);
  return {glm::dot(direction, x), glm::dot(direction, y), glm::dot(direction, normal)};
}

TEST_F(SurfaceMaps, LampsAndHighlightsTakeTheMappedNormal) {
  Material material;
  material.diffuse = glm::vec3(0.5f);
  material.specular = {0.3f, 0.2f, 0.1f};
  material.roughness = 0.3f;
  SceneBuilder builder = floorOf(material);
  builder.materialAt(0).normalTexture = builder.texture(1, 1, {200, 128, 220, 255});
  const glm::dvec3 normal =
      glm::normalize(glm::dvec3(2.0 * 200 / 255.0 - 1.0, 2.0 * 220 / 255.0 - 1.0, -(2.0 * 128 / 255.0 - 1.0)));
  const reference::CoatedSurface surface(glm::dvec3(0.5), {0.3, 0.2, 0.1}, 0.3);
  const Camera camera = lookingAt({0, 4, 0}, {0, 0, 0}, 0.1);
  const auto expect = [&](const char* name, const glm::dvec3& toLight, double irradianceAcross) {
    const Image image = drawn(builder.scene(), camera);
    const glm::dvec3 expected = surface.bsdf(aboutNormal(normal, {0, 1, 0}), aboutNormal(normal, toLight)) *
                                (irradianceAcross * glm::dot(normal, toLight));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(image.at(8, 8)[c], expected[c], 0.02 * expected[c]) << name;  // the pixel is not the picture's middle
  };
  const glm::dvec3 toLight = glm::normalize(glm::dvec3(2.0, 3.0, 0.5));
  builder.sun(-toLight, glm::vec3(3.0f));
  expect("sun", toLight, 3.0);
  builder.scene().sun.reset();
  builder.scene().points.push_back({3.0 * toLight, glm::vec3(9.0f)});
  expect("omnidirectional", toLight, 1.0);
  builder.scene().points.clear();
  builder.scene().spots.push_back({3.0 * toLight, -toLight, glm::vec3(9.0f), 0.4, 0.6});
  expect("spot", toLight, 1.0);
}

// Without texture coordinates there is no tangent: the mesh's own normal stays.
TEST_F(SurfaceMaps, WithoutTextureCoordinatesNormalsStay) {
  Material material;
  material.diffuse = glm::vec3(0.5f);
  SceneBuilder builder = floorOf(material);
  builder.materialAt(0).normalTexture = builder.texture(1, 1, {255, 128, 128, 255});
  for (Vertex& v : builder.scene().vertices) v.texCoord = {0.25f, 0.75f};
  builder.sun({0, -1, 0}, glm::vec3(1.0f));
  const Camera camera = lookingAt({0, 4, 0}, {0, 0, 0}, 0.5);
  EXPECT_NEAR(drawn(builder.scene(), camera).at(8, 8).x, 0.5 / kPi, 1e-5);
  EXPECT_NEAR(traced(builder.scene(), camera).at(8, 8).x, 0.5 / kPi, 1e-5);
}

// -------------------------------------------------------------------------------------------------------------- metals

/// Left half: metallic 1/5 of the factor, roughness 153/255; right half: metallic, roughness 102/255. Of one colour's
/// picture.
SceneBuilder halfMetal(float metallic, float roughness) {
  Material material;
  SceneBuilder builder = floorOf(material);
  MetalMap map{{0.9f, 0.8f, 0.7f}, metallic, roughness, twoHalves(builder, {7, 153, 51}, {99, 102, 255})};
  builder.materialAt(0).metalMap = map;
  builder.materialAt(0).diffuse = 0.4f * map.base;
  builder.materialAt(0).specular = glm::vec3(0.5f);
  builder.materialAt(0).diffuseTexture = builder.texture(1, 1, {200, 220, 240, 255});
  return builder;
}

/// The base colour of halfMetal.
const glm::dvec3 kBase = glm::dvec3(0.9, 0.8, 0.7) * glm::dvec3(linear(200), linear(220), linear(240));

TEST_F(SurfaceMaps, MetalsByTexelsAreShadedByTexels) {
  for (const auto& [metallicFactor, roughnessFactor] : {std::pair(1.0f, 1.0f), std::pair(0.5f, 0.9f)}) {
    SceneBuilder builder = halfMetal(metallicFactor, roughnessFactor);
    const glm::dvec3 toSun = glm::normalize(glm::dvec3(0.3, 1.0, 0.2));
    builder.sun(-toSun, glm::vec3(2.0f));
    for (const bool right : {false, true}) {
      const glm::dvec3 place(right ? 2.0 : -2.0, 0.0, 0.0);
      const Image image = drawn(builder.scene(), lookingAt(place + glm::dvec3(0, 4, 0), place, 0.02));
      const double metallic = static_cast<double>(metallicFactor) * (right ? 1.0 : 0.2),
                   roughness = static_cast<double>(roughnessFactor) * (right ? 0.4 : 0.6);
      const reference::CoatedSurface surface(kBase * (1.0 - metallic), glm::mix(glm::dvec3(0.04), kBase, metallic),
                                             roughness * roughness);
      const glm::dvec3 expected = surface.bsdf({0, 0, 1}, aboutNormal({0, 1, 0}, toSun)) * (2.0 * toSun.y);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(image.at(8, 8)[c], expected[c], 0.01 * expected[c]) << metallicFactor << " " << right << " " << c;
    }
  }
}

// The path tracer reads the same texels: a coat over what is left of the base.
TEST_F(SurfaceMaps, MetalsByTexelsAreTracedByTexels) {
  SceneBuilder builder = halfMetal(1.0f, 1.0f);
  const glm::dvec3 toSun = glm::normalize(glm::dvec3(0.3, 1.0, -1.0));
  builder.sun(-toSun, glm::vec3(2.0f));
  for (const bool right : {false, true}) {
    const glm::dvec3 place(right ? 2.0 : -2.0, 0.0, 0.0), eye = place + glm::dvec3(0, 3, 3);
    const double metallic = right ? 1.0 : 0.2, roughness = right ? 0.4 : 0.6;
    const reference::CoatedSurface surface(kBase * (1.0 - metallic), glm::mix(glm::dvec3(0.04), kBase, metallic),
                                           roughness * roughness);
    const Image image = traced(builder.scene(), lookingAt(eye, place, 0.01));
    const glm::dvec3 up(0, 1, 0),
        expected = surface.bsdf(aboutNormal(up, glm::normalize(eye - place)), aboutNormal(up, toSun)) * (2.0 * toSun.y);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.at(8, 8)[c], expected[c], kDecoding * expected[c]) << right << c;
  }
}

// What surfaces throw on each other is all that they reflect, as if matte.
TEST_F(SurfaceMaps, MetalsByTexelsThrowWhatTheyReflect) {
  Material plain[2];
  plain[0].diffuse = glm::vec3(0.8f);
  plain[0].specular = glm::vec3(0.04f);
  plain[1].diffuse = glm::vec3(0.0f);
  plain[1].specular = glm::vec3(0.8f);
  for (const std::string_view technique : {"lpv", "rsm"}) {
    double light[2];
    for (int metallic = 0; metallic < 2; ++metallic) {
      SceneBuilder builder;
      const int lit = builder.material(glm::vec3(0.5f)), grey = builder.material(glm::vec3(0.5f));
      builder.materialAt(lit).metalMap =
          MetalMap{glm::vec3(0.8f), static_cast<float>(metallic), 1.0f, builder.texture(1, 1, {0, 255, 255, 255})};
      builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, lit);
      builder.plate({-2, 2, 0}, {0, 4, 0}, {0, 0, 4}, grey);
      builder.sun({0.0, -1.0, 0.0}, glm::vec3(5.0f));  // along the grey plate
      const Camera camera = lookingAt({3, 1.5, 0}, {-2, 1.0, 0}, 0.3);
      light[metallic] = meanOf(drawn(builder.scene(), camera, technique, Component::indirect)).x;
      plain[metallic].roughness = 1.0f;
    }
    EXPECT_GT(light[0], 0.01) << technique;
    const auto whole = [&](int i) { return static_cast<double>(wholeReflectance(plain[i]).x); };
    EXPECT_NEAR(light[1] / light[0], whole(1) / whole(0), 2e-3) << technique;
  }
}

TEST_F(SurfaceMaps, PatchesReflectTheMeanOfTheirTexels) {
  Scene scene = halfMetal(1.0f, -1.0f).scene();
  scene.materials[0].specular = glm::vec3(0.0f);
  const std::array<glm::vec2, 3> all{{{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}}},
      left{{{0.1f, 0.0f}, {0.4f, 0.0f}, {0.1f, 1.0f}}};
  EXPECT_NEAR(meanAlbedo(scene, scene.materials[0], left).x, kBase.x * 0.8, 1e-6);
  // Of the triangle 3/4 of the area have u < 1/2.
  EXPECT_NEAR(meanAlbedo(scene, scene.materials[0], all).x, kBase.x * 0.8 * 0.75, 0.02);
}

// ------------------------------------------------------------------------------------------------------------ emission

TEST_F(SurfaceMaps, EmissionByTexelsShinesByTexelsInEveryTechnique) {
  Material material;
  material.diffuse = glm::vec3(0.0f);
  SceneBuilder builder = floorOf(material);
  const int texture = twoHalves(builder, {255, 100, 0}, {30, 200, 255});
  builder.materialAt(0).emissionTexture = texture;
  builder.materialAt(0).emissionScale = {3.0f, 2.0f, 1.0f};
  builder.materialAt(0).emission = {1.7f, 0.7f, 0.5f};  // the mean, about
  builder.scene().sun.reset();
  for (const bool right : {false, true}) {
    const glm::dvec3 expected = glm::dvec3(3, 2, 1) * (right ? glm::dvec3(linear(30), linear(200), linear(255))
                                                             : glm::dvec3(linear(255), linear(100), linear(0)));
    const glm::dvec3 place(right ? 2.0 : -2.0, 0.0, 0.0);
    const Camera camera = lookingAt(place + glm::dvec3(0, 4, 0), place, 0.1);
    for (const std::string_view technique : {"direct", "lpv", "radiosity"}) {
      const Image image = drawn(builder.scene(), camera, technique);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(image.at(8, 8)[c], expected[c], kDecoding * expected[c] + 1e-6)
            << technique << " " << right << " " << c;
    }
    const Image walked = traced(builder.scene(), camera);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(walked.at(8, 8)[c], expected[c], kDecoding * expected[c] + 1e-6) << "path " << right << " " << c;
  }
}

}  // namespace
}  // namespace lucerna::test
