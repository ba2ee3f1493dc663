// Crytek Sponza as a whole: published counts, its loader traps, the sun's way into it, and the walk through it.
// Skipped where the shared test data is missing.
#include "base/log.hpp"
#include "scene/key_frames.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"
#include "support/ray_caster.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>

namespace lucerna {
namespace {

using test::RayCaster;

/// Loaded once for all tests here; null where the data is missing.
const Scene* sponza() {
  static const std::unique_ptr<Scene> scene = [] {
    const auto folder = test::sharedAssets("crytek-sponza");
    clearLoggedWarnings();
    return folder.empty() ? nullptr : std::make_unique<Scene>(loadScene(folder / "sponza.obj"));
  }();
  return scene.get();
}

const RayCaster& caster() {
  static const RayCaster rayCaster(*sponza());
  return rayCaster;
}

#define SKIP_WITHOUT_SPONZA() \
  if (!sponza()) GTEST_SKIP() << "shared test data not found: crytek-sponza"

TEST(SponzaTest, CountsAreThePublishedOnes) {
  SKIP_WITHOUT_SPONZA();
  const Scene& scene = *sponza();
  EXPECT_EQ(scene.triangleCount(), 262267u);
  EXPECT_EQ(scene.degenerateTriangles, 0u);
  EXPECT_EQ(scene.droppedTriangles, 0u);
  EXPECT_EQ(scene.meshes.size(), 393u);
  EXPECT_EQ(scene.materials.size(), 25u);
  // 184,406 distinct triples of indices (its README); some of them name equal values.
  EXPECT_NEAR(static_cast<double>(scene.vertices.size()), 184406.0, 10.0);
  EXPECT_EQ(scene.textures.size(), 27u);  // 24 colours and 3 masks; bump maps and the like are not read
  ASSERT_EQ(loggedWarnings().size(), 1u);
  EXPECT_NE(loggedWarnings()[0].find("not read: bump (maps of heights), map_Ks"), std::string::npos);
}

TEST(SponzaTest, MaterialsAreReadRight) {
  SKIP_WITHOUT_SPONZA();
  const Scene& scene = *sponza();
  std::map<std::string, Material> materials;
  for (const Material& m : scene.materials) {
    materials[m.name] = m;
    EXPECT_EQ(m.opacity, 1.0f) << m.name;  // d 1 beside Tr 0
    EXPECT_EQ(m.diffuseTexture < 0, m.name == "Material__47") << m.name;
    EXPECT_EQ(m.alphaMasked, m.name == "leaf" || m.name == "Material__57" || m.name == "chain") << m.name;
    EXPECT_EQ(m.alphaTexture >= 0, m.alphaMasked) << m.name;
  }
  EXPECT_EQ(materials["leaf"].diffuse, glm::vec3(0.588f));
  EXPECT_EQ(materials["bricks"].specular, glm::vec3(0.01f));
  EXPECT_FLOAT_EQ(materials["bricks"].roughness, std::sqrt(2.0f / 12.0f));
  const SceneFeatures features = analyse(scene);
  EXPECT_TRUE(features.diffuseTextures && features.alphaMasks && features.specular && features.directionalLight &&
              features.indirect);
  EXPECT_FALSE(features.emission || features.background);
}

TEST(SponzaTest, TheDefaultSunReachesTheCourtsFloorAndTheCurtains) {
  SKIP_WITHOUT_SPONZA();
  const Scene& scene = *sponza();
  int floor = 0, litFloor = 0;
  for (double x = -900.0; x <= 800.0; x += 25.0)
    for (double z = -150.0; z <= 120.0; z += 15.0) {
      const auto down = caster().firstHit({x, 100.0, z}, {0.0, -1.0, 0.0});
      if (!down) continue;
      ++floor;
      litFloor += !caster().firstHit({x, 100.5 - down->distance, z}, -scene.sun->direction);
    }
  EXPECT_GT(litFloor, floor / 5) << "of " << floor;
  // The curtains at the ground in front of the arcade on +z: materials fabric_c, fabric_f, fabric_g.
  int litCurtain = 0;
  for (double x = -900.0; x <= 800.0; x += 25.0)
    for (double y = 20.0; y <= 270.0; y += 25.0) {
      const auto hit = caster().firstHit({x, y, 100.0}, {0.0, 0.0, 1.0}, 130.0);
      if (hit) litCurtain += !caster().firstHit({x, y, 100.0 + hit->distance - 0.5}, -scene.sun->direction);
    }
  EXPECT_GT(litCurtain, 20);
}

TEST(SponzaTest, TheWalkIsFoundAndGivesTheFirstCamera) {
  SKIP_WITHOUT_SPONZA();
  const Scene& scene = *sponza();
  EXPECT_EQ(scene.keyFrames, std::filesystem::path(LUCERNA_SOURCE_DIR) / "keyFrames/sponza.txt");
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].position, readKeyFrames(scene.keyFrames).camera[0].position);
}

// No view of the walk comes nearer than 30 cm to anything, none lies within stone (where the first hit shows its back),
// and between two views nothing is crossed.
TEST(SponzaTest, TheWalkKeepsClearOfWallsAndColumns) {
  SKIP_WITHOUT_SPONZA();
  const Spline spline(readKeyFrames(sponza()->keyFrames).camera);
  EXPECT_GE(spline.segmentCount(), 7);
  Camera last = spline.view(0);
  for (int i = 0; i < spline.viewCount(); ++i) {
    const Camera view = spline.view(i);
    ASSERT_GT(caster().clearance(view.position, 100.0), 30.0) << "view " << i;
    const auto floor = caster().firstHit(view.position, {0.0, -1.0, 0.0});
    ASSERT_TRUE(floor) << "view " << i;
    ASSERT_GT(floor->normal.y, 0.0) << "view " << i << " looks at a floor's back";
    ASSERT_GT(floor->distance, 120.0) << "view " << i;
    if (i > 0) { ASSERT_FALSE(caster().firstHit(last.position, view.position - last.position, 1.0)) << "view " << i; }
    // At 60 views a second: below 8 m/s and 90 degrees a second.
    ASSERT_LT(glm::distance(view.position, last.position), 800.0 / 60.0) << "view " << i;
    ASSERT_GT(glm::dot(view.direction, last.direction), std::cos(1.5 * 3.14159265 / 180.0)) << "view " << i;
    last = view;
  }
}

}  // namespace
}  // namespace lucerna
