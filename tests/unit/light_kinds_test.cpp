// Which kinds of light a scene has, and the scene with some of them alone.
#include "measure/light_kinds.hpp"
#include "measure/reference.hpp"
#include "support/small_scenes.hpp"

#include <gtest/gtest.h>

namespace {

using namespace lucerna;
using namespace lucerna::measure;

/// A floor under everything: a sun, a spot, a lamp, an emissive plate with a picture, a medium that shines, an
/// environment, and a background.
Scene everything() {
  test::SceneBuilder builder;
  const int floor = builder.material(glm::vec3(0.5f)), plate = builder.material(glm::vec3(0.25f));
  builder.plate({0, 0, 0}, {2, 0, 0}, {0, 0, -2}, floor);
  builder.plate({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, plate);
  builder.sun({0, -1, 0}, {3, 2, 1});
  builder.materialAt(plate).emission = {5, 4, 3};
  builder.materialAt(plate).emissionScale = {10, 8, 6};
  builder.materialAt(plate).emissionTexture = 0;
  Scene scene = builder.scene();
  scene.spots.emplace_back();
  scene.spots[0].intensity = {1, 1, 1};
  scene.points.emplace_back();
  scene.points[0].intensity = {0, 0, 2};
  scene.media.emplace_back();
  scene.media[0].emission = {1, 0, 0};
  scene.media[0].scattering = {2, 2, 2};
  scene.environment.emplace();
  scene.environment->radiance = {1, 2, 3};
  scene.background = {4, 5, 6};
  return scene;
}

constexpr LightKinds kNone{false, false, false, false};

TEST(LightKinds, AreThoseThatShine) {
  const Scene scene = everything();
  EXPECT_EQ(kindsOf(scene), LightKinds{});
  Scene dark = scene;
  dark.sun->irradiance = dark.spots[0].intensity = dark.points[0].intensity = dark.materials[1].emission =
      dark.media[0].emission = dark.environment->radiance = glm::vec3(0.0f);
  EXPECT_EQ(kindsOf(dark), kNone);
  dark.background = {1, 1, 1};  // is seen, but lights nothing
  EXPECT_EQ(kindsOf(dark), kNone);
  dark.media[0].emission = {0, 0, 1};
  EXPECT_EQ(kindsOf(dark), (LightKinds{false, false, true, false}));
  dark.points[0].intensity = {0, 1, 0};
  EXPECT_EQ(kindsOf(dark), (LightKinds{false, true, true, false}));
}

// Each kind alone, all of them, none: the scene has those and no other, and nothing else has changed.
TEST(LightKinds, OneCanBeTakenAway) {
  const Scene scene = everything();
  for (const LightKinds kinds :
       {kNone, LightKinds{true, false, false, false}, LightKinds{false, true, false, false},
        LightKinds{false, false, true, false}, LightKinds{false, false, false, true}, LightKinds{}}) {
    const Scene lit = litBy(scene, kinds);
    EXPECT_EQ(kindsOf(lit), kinds) << nameOf(kinds);
    EXPECT_EQ(lit.materials[1].diffuse, scene.materials[1].diffuse);
    EXPECT_EQ(lit.media[0].scattering, scene.media[0].scattering);
    EXPECT_EQ(lit.background, scene.background);
    EXPECT_EQ(lit.indices.size(), scene.indices.size());
  }
  EXPECT_EQ(litBy(scene, LightKinds{}).materials[1].emissionTexture, 0);
  EXPECT_EQ(litBy(scene, kNone).materials[1].emissionTexture, -1);
}

// What a reference of less light is kept as: never taken for one of all light, nor for one of other kinds.
TEST(LightKinds, ReferencesOfThemHaveKeysOfTheirOwn) {
  const Scene scene = everything();
  const Camera camera;
  const auto key = [&](LightKinds kinds) {
    return keyOf(litBy(scene, kinds), camera, {8, 8}, Transport::oneBounce, "sampler").value;
  };
  const std::uint64_t all = key({}), sun = key({true, false, false, false}), delta = key({true, true, false, false}),
                      noSky = key({true, true, true, false});
  EXPECT_EQ(all, keyOf(scene, camera, {8, 8}, Transport::oneBounce, "sampler").value);
  EXPECT_NE(all, sun);
  EXPECT_NE(all, delta);
  EXPECT_NE(all, noSky);
  EXPECT_NE(sun, delta);
  EXPECT_NE(delta, noSky);
}

TEST(LightKinds, HaveSetsAndNames) {
  const LightKinds a{true, true, true, false}, b{true, false, false, true};
  EXPECT_EQ(a & b, (LightKinds{true, false, false, false}));
  EXPECT_EQ(without(a, b), (LightKinds{false, true, true, false}));
  EXPECT_EQ(nameOf(a), "sun, lamps, emissive surfaces");
  EXPECT_EQ(nameOf(kNone), "none");
  EXPECT_FALSE(kNone.any());
}

}  // namespace
