// Orthographic views in every technique: what is seen does not shrink with distance, and rays are parallel.
#include "lpv/settings.hpp"
#include "render/renderer.hpp"
#include "render/techniques.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "support/gl_fixture.hpp"
#include "support/small_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

constexpr int kSize = 64;

RenderSettings settingsOf(std::string_view technique) {
  RenderSettings s;
  s.technique = technique;
  s.size = {kSize, kSize};
  s.fullFloatTarget = true;
  s.shadow.size = 256;
  s.of<ReflectiveShadowMap::Settings>().size = 32;
  s.of<LpvSettings>().cascades.cells = 8;
  return s;
}

/// A view along -z of height 4, so that a pixel is 1/16 wide.
Camera plan() {
  Camera camera = test::lookingAt({0, 0, 4}, {0, 0, 0});
  camera.orthographicHeight = 4.0;
  return camera;
}

/// Two plates of side 1, 20 units behind each other: 16 x 16 pixels each, x -1.5 to -0.5 and 0.5 to 1.5.
Scene twoPlates() {
  test::SceneBuilder builder;
  const int grey = builder.material(glm::vec3(0.5f));
  builder.plate({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, grey);
  builder.plate({1, 0, -20}, {1, 0, 0}, {0, 1, 0}, grey);
  builder.sun({0, 0, -1}, glm::vec3(3.14159265f));
  return builder.scene();
}

using OrthographicTest = test::SharedProgramsTest;

TEST_F(OrthographicTest, PlatesOfOneSizeCoverTheSamePixelsAtAnyDistance) {
  const Scene scene = twoPlates();
  for (const std::string& technique : techniqueNames()) {
    Renderer renderer(context(), programs(), scene, settingsOf(technique));
    renderer.renderToTheEnd(plan());
    const Image image = renderer.readRadiance();
    int wrong = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const bool isPlate = y >= 24 && y < 40 && ((x >= 8 && x < 24) || (x >= 40 && x < 56));
        // A half of pi over pi, and a little of light between them.
        const float found = image.at(x, y).x;
        if (isPlate ? !(found > 0.45f && found < 0.6f) : found != 0.0f) ++wrong;
      }
    EXPECT_EQ(wrong, 0) << technique;
  }
}

// A mirror-like highlight of the sun depends on the direction to the viewer alone, which is the same at all pixels.
TEST_F(OrthographicTest, HighlightsAreSeenAlongParallelRays) {
  test::SceneBuilder builder;
  const int glossy = builder.material(glm::vec3(0.0f));
  builder.materialAt(glossy).specular = glm::vec3(0.5f);
  builder.materialAt(glossy).roughness = 0.3f;
  builder.plate({0, 0, 0}, {8, 0, 0}, {0, 8, 0}, glossy);
  builder.sun(glm::normalize(glm::dvec3(0.3, 0, -1)), glm::vec3(3.0f));
  Renderer renderer(context(), programs(), builder.scene(), settingsOf("direct"));
  renderer.render(plan());
  const Image image = renderer.readRadiance();
  EXPECT_GT(image.at(0, 0).x, 0.0f);
  for (const glm::vec3& pixel : image.pixels) EXPECT_NEAR(pixel.x, image.pixels[0].x, 1e-5f * image.pixels[0].x);
}

TEST_F(OrthographicTest, OnePointOfTheEnvironmentIsSeen) {
  Scene scene = twoPlates();
  scene.environment = Environment{glm::vec3(1.0f), Image(4, 2), 0.0};
  for (std::size_t i = 0; i < 8; ++i)
    scene.environment->picture->pixels[i] = glm::vec3(0.1f * static_cast<float>(i + 1));
  // Along -z, in the middle of the picture: filtered, or the texel to the right of it.
  const float filtered = 0.25f * (0.2f + 0.3f + 0.6f + 0.7f);
  for (const auto& [technique, expected] : {std::pair{"direct", filtered}, {"path", 0.7f}}) {
    Renderer renderer(context(), programs(), scene, settingsOf(technique));
    renderer.renderToTheEnd(plan());
    const Image image = renderer.readRadiance();
    for (const int x : {0, 32, 63}) EXPECT_NEAR(image.at(x, 2).x, expected, 1e-5f) << technique << " " << x;
  }
}

}  // namespace
}  // namespace lucerna
