// Media as the technique irradiance-cache previews them: known answers, and the path tracer's pictures.
#include "irradiance_cache/bodies.hpp"
#include "irradiance_cache/settings.hpp"
#include "support/media_scenes.hpp"
#include "support/path_scenes.hpp"
#include "support/radiosity_scenes.hpp"
#include "support/small_scenes.hpp"

#include "base/angles.hpp"
#include "render/renderer.hpp"
#include "scene/scene_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace lucerna::test {
namespace {

class BodyPreview : public PathTest {
 protected:
  static Image drawn(const Scene& scene, const Camera& camera, int samples = 1) {
    RenderSettings s;
    s.technique = "irradiance-cache";
    s.size = {32, 32};
    s.fullFloatTarget = true;
    s.pixelSamples = samples;
    Renderer renderer(context(), library(), scene, s);
    renderer.renderToTheEnd(camera);
    return renderer.readRadiance();
  }
  static Image small(const Scene& scene, const Camera& camera) {
    RenderSettings s;
    s.technique = "irradiance-cache";
    s.size = {24, 14};
    s.fullFloatTarget = true;
    s.pixelSamples = 2;
    s.of<IrradianceCacheSettings>().samples = 16;
    Renderer renderer(context(), library(), scene, s);
    renderer.renderToTheEnd(camera);
    return renderer.readRadiance();
  }
  Image traced(const Scene& scene, const Camera& camera, std::uint32_t samples) {
    return tracer(scene, camera, sized(32), samples).mean();
  }
  /// A ball of radius 1 with a medium inside, in an environment of radiance 1.
  static Scene ballOf(const Medium& medium, double ior) {
    Scene scene;
    scene.media.push_back(medium);
    addSphere(scene, glm::dvec3(0.0), 1.0, 5, addBoundary(scene, Bsdf::dielectric, ior, 0));
    scene.environment.emplace().radiance = glm::vec3(1.0f);
    return scene;
  }
  static Medium medium(const glm::vec3& scattering, const glm::vec3& absorption, float g = 0.0f) {
    Medium m;
    m.name = "medium";
    m.scattering = scattering;
    m.absorption = absorption;
    m.anisotropy = glm::vec3(g);
    return m;
  }
  static Camera atBall(double fov) { return lookingAt({0, 0, 6}, {0, 0, 0}, fov); }
};

// Straight through the middle: what is not reflected passes two units of the medium.
TEST_F(BodyPreview, AnAbsorberHasItsColour) {
  const glm::vec3 absorption(0.05f, 0.4f, 2.0f);
  const Image image = drawn(ballOf(medium(glm::vec3(0.0f), absorption), 1.5), atBall(0.02));
  for (int c = 0; c < 3; ++c) {
    const double expected = 0.04 + 0.96 * std::exp(-2.0 * double(absorption[c]));
    EXPECT_NEAR(meanOf(image)[c], expected, 0.005) << c;
  }
}

// All light that falls in comes out.
TEST_F(BodyPreview, ADenseWhiteBodyIsInvisibleInAFurnace) {
  const Image image = drawn(ballOf(medium(glm::vec3(200.0f), glm::vec3(0.0f), 0.7f), 1.33), atBall(0.2));
  for (const glm::vec3& pixel : image.pixels) ASSERT_NEAR(pixel.y, 1.0f, 0.01f);
}

// Within a fifth: light inside is taken as diffuse, but refraction has turned it inwards, where more is absorbed.
TEST_F(BodyPreview, ADenseBodyIsAboutAsBrightAsByPathTracing) {
  const Scene scene = ballOf(medium({40.0f, 30.0f, 20.0f}, {0.4f, 3.0f, 10.0f}), 1.4);
  const glm::dvec3 seen = meanOf(drawn(scene, atBall(0.2))), expected = meanOf(traced(scene, atBall(0.2), 64));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 0.2 * expected[c]) << c;
}

// Within a boundary that does not refract light walks at random.
TEST_F(BodyPreview, AMatchedCloudIsAsBrightAsByPathTracing) {
  const Scene scene = ballOf(medium({1.5f, 1.0f, 0.5f}, {0.05f, 0.3f, 0.6f}), 1.0);
  const glm::dvec3 seen = meanOf(drawn(scene, atBall(0.3))), expected = meanOf(traced(scene, atBall(0.3), 64));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 0.02) << c;
}

// A picture of an even sky lights a cloud as the even sky does: by rays to the picture, or by rays that find it.
TEST_F(BodyPreview, APictureOfTheSkyLightsACloudOnce) {
  Scene scene = ballOf(medium({1.5f, 1.0f, 0.5f}, {0.05f, 0.3f, 0.6f}), 1.0);
  const glm::dvec3 expected = meanOf(drawn(scene, atBall(0.3), 8));
  scene.environment->picture.emplace(8, 4, glm::vec3(1.0f));
  const glm::dvec3 seen = meanOf(drawn(scene, atBall(0.3), 8));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 0.02) << c;
}

/// A grid of one density, 2 units thick, before a wall that shines.
Scene cloudBeforeAWall(const Medium& medium) {
  SceneBuilder builder;
  builder.plate({0, 0, -2}, {16, 0, 0}, {0, 16, 0}, lambertian(builder, 0.0, 1.0));
  Scene& scene = builder.scene();
  scene.sun.reset();
  scene.media.push_back(medium);
  DensityGrid& grid = scene.media.back().grid.emplace();
  grid.size = {4, 4, 4};
  grid.density.assign(64, 0.5f);
  grid.min = {-1, -1, -1}, grid.max = {1, 1, 1};
  addSphere(scene, glm::dvec3(0.0), 2.0, 2, addBoundary(scene, Bsdf::none, 1.0, 0));
  return builder.scene();
}

TEST_F(BodyPreview, ACloudOnAGridDimsWhatIsBehindByItsDepth) {
  const Scene scene = cloudBeforeAWall(medium(glm::vec3(0.0f), glm::vec3(1.2f)));
  // Each sample passes or does not: 16 of 1,024 pixels, a standard error of 1.1 %.
  EXPECT_NEAR(meanOf(drawn(scene, atBall(0.1))).y * kPi, std::exp(-1.2), 0.04 * std::exp(-1.2));
}

// Lamps that shine are sampled, so a cloud is no noise of rays that find one.
TEST_F(BodyPreview, ACloudOnAGridScattersLikeByPathTracing) {
  const Scene scene = cloudBeforeAWall(medium(glm::vec3(1.5f), glm::vec3(0.1f)));
  const glm::dvec3 seen = meanOf(drawn(scene, atBall(0.25))), expected = meanOf(traced(scene, atBall(0.25), 64));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 0.03 * expected[c]) << c;
}

// Each scene of assets/media, beside itself without its media.
TEST_F(BodyPreview, EverySceneOfMediaShowsThem) {
  int scenes = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(LUCERNA_SOURCE_DIR) / "assets/media")) {
    if (entry.path().extension() != ".json") continue;
    const Scene with = loadScene(entry.path());
    Scene without = with;
    for (Material& material : without.materials)
      if (material.bsdf == Bsdf::dielectric) material.interior = -1;
      else if (material.bsdf == Bsdf::none)
        without.media[static_cast<std::size_t>(material.interior)].grid->density.assign(96 * 96 * 96, 0.0f);
    const Camera& camera = with.cameras.front();
    const Image a = small(with, camera), b = small(without, camera);
    double change = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
      change += static_cast<double>(std::abs(a.pixels[i].y - b.pixels[i].y)) / static_cast<double>(a.pixels.size());
    EXPECT_GT(meanOf(a).y, 0.01) << entry.path();
    EXPECT_GT(change, 0.02 * meanOf(a).y) << entry.path();
    ++scenes;
  }
  EXPECT_GE(scenes, 15);
}

// Fits and integrals against published values.
TEST_F(BodyPreview, ReflectancesAreThoseOfTheTables) {
  EXPECT_NEAR(diffuseFresnel(1.5), 0.0918, 2e-4);  // [Saunderson1942]: 0.0918 of light from outside, 0.596 from inside
  EXPECT_NEAR(1.0 - (1.0 - diffuseFresnel(1.5)) / 2.25, 0.596, 1e-3);
  EXPECT_NEAR(diffuseFresnel(1.0), 0.0, 1e-12);
  EXPECT_EQ(halfSpaceReflectance(0.0), 0.0);
  EXPECT_EQ(halfSpaceReflectance(1.0), 1.0);
  EXPECT_NEAR(halfSpaceReflectance(0.9), 0.479, 3e-3);  // [vandeHulst1980], spherical albedo of isotropic scattering
}

TEST_F(BodyPreview, ScenesWithoutMediaDoWithoutIt) {
  Scene clear = ballOf(medium(glm::vec3(1.0f), glm::vec3(0.0f)), 1.5);
  EXPECT_TRUE(Bodies::isNeeded(analyse(clear)));
  clear.materials.back().interior = -1;
  EXPECT_FALSE(Bodies::isNeeded(analyse(clear)));
  EXPECT_FALSE(Bodies::hasClouds(analyse(clear)));
  EXPECT_TRUE(Bodies::hasClouds(analyse(cloudBeforeAWall(medium(glm::vec3(1.0f), glm::vec3(0.0f))))));
}

}  // namespace
}  // namespace lucerna::test
