// CONTRIBUTING.md's example of a technique is in the frame: added, rendered against its known answer, inspected, left
// out where nothing needs it, and removed again.
#include "base/angles.hpp"
#include "base/error.hpp"
#include "render/renderer.hpp"
#include "render/settings.hpp"
#include "render/techniques.hpp"
#include "support/faulty_shaders.hpp"
#include "support/gl_fixture.hpp"
#include "support/small_scenes.hpp"
#include "support/temp_folder.hpp"

#include <algorithm>
#include <filesystem>

namespace lucerna {

namespace ambient {
TechniqueEntry technique();
}

namespace test {
namespace {

namespace fs = std::filesystem;

/// The project's shaders with those of the example, as in a tree that has its folders.
class ExampleTechnique : public GlTest {
 protected:
  ExampleTechnique() {
    fs::copy(LUCERNA_SOURCE_DIR "/tests/gl/example_technique/shaders", shaders_.path(), fs::copy_options::recursive);
  }
  static RenderSettings settings(Component component) {
    RenderSettings s;
    s.technique = "ambient";
    s.component = component;
    s.size = {32, 24};
    s.fullFloatTarget = true;
    parseSetting(*findSetting("ambient.irradiance"), s, "2.5");
    return s;
  }
  FaultyShaders shaders_;
};

TEST_F(ExampleTechnique, IsAddedAndAddsItsLightToEverySurface) {
  const AddedTechnique added(ambient::technique());
  gl::ProgramLibrary programs(shaders_.path());
  const Scene scene = openBox();
  Renderer renderer(context(), programs, scene, settings(Component::all)),
      without(context(), programs, scene, settings(Component::direct));
  renderer.render(openBoxCamera());
  without.render(openBoxCamera());
  const Image all = renderer.readRadiance(), direct = without.readRadiance();
  for (const glm::ivec2& pixel : {glm::ivec2(4, 4), glm::ivec2(16, 12), glm::ivec2(28, 20)}) {
    const PixelInspection answer = renderer.inspect(programs, openBoxCamera(), pixel);
    ASSERT_TRUE(answer.surface);
    const glm::dvec3 expected = answer.surface->albedo / kPi * 2.5;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(all.at(pixel.x, pixel.y)[c] - direct.at(pixel.x, pixel.y)[c], expected[c], 1e-5 * expected[c] + 1e-6)
          << pixel.x << ", " << pixel.y;
    EXPECT_NO_THROW(answer.checkSum());
  }
}

TEST_F(ExampleTechnique, IsLeftOutWhereNothingNeedsIt) {
  const AddedTechnique added(ambient::technique());
  gl::ProgramLibrary programs(shaders_.path());
  const Scene scene = openBox();
  const Renderer with(context(), programs, scene, settings(Component::all)),
      without(context(), programs, scene, settings(Component::direct));
  const auto isLeftOut = [](const Renderer& renderer) {
    return std::ranges::count(renderer.leftOut(), "constant ambient light") == 1;
  };
  EXPECT_FALSE(isLeftOut(with));
  EXPECT_TRUE(isLeftOut(without));
  EXPECT_EQ(without.technique(), nullptr);
  EXPECT_EQ(with.gpuBytes() - without.gpuBytes(), sizeof(glm::vec4));
}

TEST_F(ExampleTechnique, IsGoneOnceItIsRemoved) {
  {
    const AddedTechnique added(ambient::technique());
    EXPECT_EQ(techniqueNames().back(), "ambient");
    EXPECT_NE(findSetting("ambient.irradiance"), nullptr);
    EXPECT_EQ(onlyTechnique(*findSetting("ambient.irradiance")), "ambient");
  }
  EXPECT_EQ(std::ranges::count(techniqueNames(), "ambient"), 0);
  EXPECT_EQ(findSetting("ambient.irradiance"), nullptr);
  EXPECT_THROW(techniqueNamed("ambient"), Error);
}

}  // namespace
}  // namespace test
}  // namespace lucerna
