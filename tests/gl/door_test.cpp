// The room with a door (assets/door): closed, it is dark; open, the sun lights it.
#include "base/data.hpp"
#include "render/renderer.hpp"
#include "scene/motion.hpp"
#include "scene/scene.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

namespace lucerna {
namespace {

class Door : public test::GlTest {
 protected:
  /// The floor inside the door at a time, seen from above, without the candle.
  Image at(double seconds, std::string_view technique) {
    Scene scene = loadScene(*findDataFolder() / "assets/door/door.json", seconds);
    scene.points.clear();
    for (Material& material : scene.materials) material.emission = glm::vec3(0.0f);
    Camera camera = scene.cameras.front();
    camera.position = {0.0, 1.5, -1.0};
    camera.direction = {0.0, -1.0, 0.0};
    camera.up = {0.0, 0.0, 1.0};
    RenderSettings settings;
    settings.technique = technique;
    settings.size = {32, 24};
    settings.fullFloatTarget = true;
    Renderer renderer(context(), programs(), scene, settings);
    renderer.renderToTheEnd(camera);
    return renderer.readRadiance();
  }
  static float brightest(const Image& picture) {
    float most = 0.0f;
    for (const glm::vec3& pixel : picture.pixels) most = std::max({most, pixel.x, pixel.y, pixel.z});
    return most;
  }
};

TEST_F(Door, LetsNoLightInWhereItIsClosed) {
  for (const char* technique : {"direct", "irradiance-cache", "path"}) {
    EXPECT_EQ(brightest(at(0.0, technique)), 0.0f) << technique;
    // The sun's 10 W/m^2 come down at a cosine of 0.64, and the boards reflect 0.36 of them.
    EXPECT_GT(brightest(at(6.0, technique)), 0.36f * 10.0f * 0.64f / 3.1416f * 0.9f) << technique;
  }
}

}  // namespace
}  // namespace lucerna
