// SceneFeatures: each flag is up exactly where a drawn mesh or a light asks for it.
#include "scene/features.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace lucerna {
namespace {

/// One drawn mesh of a plain white material, a sun; and a second material that no mesh uses.
Scene plainScene() {
  Scene scene;
  scene.vertices.resize(3);
  scene.indices = {0, 1, 2};
  scene.materials.resize(2);
  Mesh mesh;
  mesh.indexCount = 3;
  scene.meshes.push_back(mesh);
  scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(1.0f)};
  return scene;
}

SceneFeatures plainFeatures() {
  SceneFeatures features;
  features.directionalLight = true;
  features.indirect = true;
  return features;
}

TEST(SceneFeaturesTest, AnEmptySceneNeedsNothing) { EXPECT_EQ(analyse(Scene{}), SceneFeatures{}); }

TEST(SceneFeaturesTest, APlainSceneNeedsOnlyItsLight) { EXPECT_EQ(analyse(plainScene()), plainFeatures()); }

TEST(SceneFeaturesTest, EachFeatureRaisesItsFlagAlone) {
  struct Case {
    const char* name;
    std::function<void(Scene&)> change;
    bool SceneFeatures::*flag;
  };
  const std::vector<Case> cases = {
      {"texture", [](Scene& s) { s.materials[0].diffuseTexture = 0; }, &SceneFeatures::diffuseTextures},
      {"mask", [](Scene& s) { s.materials[0].alphaMasked = true; }, &SceneFeatures::alphaMasks},
      {"specular", [](Scene& s) { s.materials[0].specular.z = 0.01f; }, &SceneFeatures::specular},
      {"normal map", [](Scene& s) { s.materials[0].normalTexture = 0; }, &SceneFeatures::normalMaps},
      {"map of no metal",
       [](Scene& s) {
         s.materials[0].metalMap = MetalMap{glm::vec3(0.5f), 0.5f, 1.0f, 0};
       },
       &SceneFeatures::metalMaps},
      {"mirror", [](Scene& s) { s.materials[0].bsdf = Bsdf::mirror; }, &SceneFeatures::mirrors},
      {"conductor", [](Scene& s) { s.materials[0].bsdf = Bsdf::conductor; }, &SceneFeatures::conductors},
      {"dielectric", [](Scene& s) { s.materials[0].bsdf = Bsdf::dielectric; }, &SceneFeatures::dielectrics},
      {"boundary", [](Scene& s) { s.materials[0].bsdf = Bsdf::none; }, &SceneFeatures::nullBoundaries},
      {"environment",
       [](Scene& s) {
         s.environment = Environment{glm::vec3(0.0f, 1.0f, 0.0f), {}, 0.0};
       },
       &SceneFeatures::environment},
      {"emission", [](Scene& s) { s.materials[0].emission.y = 1e-6f; }, &SceneFeatures::emission},
      {"background", [](Scene& s) { s.background.x = 0.1f; }, &SceneFeatures::background},
  };
  for (const Case& c : cases) {
    Scene scene = plainScene();
    c.change(scene);
    SceneFeatures expected = plainFeatures();
    expected.*c.flag = true;
    const Bsdf bsdf = scene.materials[0].bsdf;
    expected.specular |= bsdf != Bsdf::diffuse && bsdf != Bsdf::none;  // they reflect too
    expected.specular |= scene.materials[0].metalMap.has_value();
    EXPECT_EQ(analyse(scene), expected) << c.name;
  }
}

TEST(SceneFeaturesTest, AMapOfMetalIsACoat) {
  Scene scene = plainScene();
  scene.materials[0].metalMap = MetalMap{glm::vec3(0.5f), 1.0f, 1.0f, 0};
  EXPECT_TRUE(analyse(scene).specular);
  scene.materials[0].metalMap->roughness = -1.0f;  // says nothing of one
  EXPECT_FALSE(analyse(scene).specular);
  scene.materials[0].normalTexture = 0;
  scene.materials[0].normalScale = 0.0f;
  EXPECT_FALSE(analyse(scene).normalMaps);
}

TEST(SceneFeaturesTest, ATextureThatDoesNotRepeatIsSeenWhereverItIsUsed) {
  const std::vector<std::function<void(Material&)>> uses = {
      [](Material& m) { m.diffuseTexture = 0; }, [](Material& m) { m.alphaTexture = 0; },
      [](Material& m) { m.emissionTexture = 0; }, [](Material& m) { m.normalTexture = 0; },
      [](Material& m) {
        m.metalMap = MetalMap{glm::vec3(1.0f), 1.0f, 1.0f, 0};
      }};
  for (const auto& use : uses) {
    Scene scene = plainScene();
    scene.textures.resize(1);
    use(scene.materials[0]);
    EXPECT_FALSE(analyse(scene).textureWraps);
    scene.textures[0].wraps.v = TextureWrap::mirror;
    EXPECT_TRUE(analyse(scene).textureWraps);
    scene.textures[0].wraps = {TextureWrap::edge, TextureWrap::repeat};
    EXPECT_TRUE(analyse(scene).textureWraps);
  }
}

TEST(SceneFeaturesTest, MaterialsOfNoDrawnMeshDoNotCount) {
  Scene scene = plainScene();
  Material& unused = scene.materials[1];
  unused.diffuseTexture = 0;
  unused.alphaMasked = true;
  unused.specular = unused.emission = glm::vec3(1.0f);
  EXPECT_EQ(analyse(scene), plainFeatures());
  Mesh empty;
  empty.material = 1;
  scene.meshes.push_back(empty);  // no indices: not drawn
  EXPECT_EQ(analyse(scene), plainFeatures());
  scene.meshes.back().indexCount = 3;
  EXPECT_NE(analyse(scene), plainFeatures());
}

TEST(SceneFeaturesTest, NoSunOrADarkSunIsNoLight) {
  Scene scene = plainScene();
  scene.sun->irradiance = glm::vec3(0.0f);
  EXPECT_EQ(analyse(scene), SceneFeatures{});
  scene.sun.reset();
  EXPECT_EQ(analyse(scene), SceneFeatures{});
}

TEST(SceneFeaturesTest, IndirectLightNeedsALightAndAnAlbedo) {
  Scene black = plainScene();
  for (Material& m : black.materials) m.diffuse = glm::vec3(0.0f);
  EXPECT_FALSE(analyse(black).indirect);
  Scene glowing = plainScene();
  glowing.sun.reset();
  glowing.background = glm::vec3(1.0f);  // lights nothing
  EXPECT_FALSE(analyse(glowing).indirect);
  glowing.materials[0].emission = glm::vec3(1.0f);
  EXPECT_TRUE(analyse(glowing).indirect);
}

TEST(SceneFeaturesTest, NamesComeInDeclarationOrder) {
  SceneFeatures features;
  features.specular = true;
  const auto named = features.named();
  ASSERT_EQ(named.size(), sizeof(SceneFeatures));  // a bool each: a new flag must get its name
  EXPECT_EQ(named[0].first, "diffuseTextures");
  EXPECT_EQ(named[2], (std::pair<std::string, bool>("specular", true)));
  EXPECT_EQ(named[6].first, "indirect");
}

}  // namespace
}  // namespace lucerna
