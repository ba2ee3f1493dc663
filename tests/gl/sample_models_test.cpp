// The sample models that Debian ships (package assimp-testmodels; its glTF is Khronos's for the most part): each that
// loads shows a surface.
#include "base/error.hpp"
#include "base/files.hpp"
#include "render/renderer.hpp"
#include "scene/scene.hpp"
#include "support/gl_fixture.hpp"
#include "support/long_tests.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

using SampleModels = test::SharedProgramsTest;

TEST_F(SampleModels, EveryOneThatLoadsShowsSomething) {
  const fs::path folder = "/usr/share/assimp/models";
  if (!fs::is_directory(folder / "glTF2"))
    GTEST_SKIP() << "the sample models are missing (Debian package assimp-testmodels)";
  // glTF; and every other format where there is time. A file that is no model, a picture or a text, is refused.
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = lowerExtension(entry.path());
    if (entry.is_regular_file() && (extension == ".gltf" || extension == ".glb" || test::longTests()))
      files.insert(entry.path());
  }
  const char* pictures = std::getenv("LUCERNA_SAMPLE_PICTURES");  // a folder, for those who want to look at them
  std::size_t shown = 0, refusals = 0;
  for (const fs::path& file : files) {
    std::optional<Scene> scene;
    try {
      scene = loadScene(file);
    } catch (const Error& error) {  // broken on purpose, or of lines and points alone
      EXPECT_EQ(error.kind(), ErrorKind::badInput) << error.what();
      EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
      ++refusals;
      continue;
    }
    // Surfaces alone: each would seem to show something where the sky does.
    scene->environment.reset();
    scene->background = glm::vec3(0.0f);
    RenderSettings settings;
    settings.technique = "direct";
    settings.size = {96, 72};
    Renderer renderer(context(), library(), *scene, settings);
    renderer.render(scene->cameras.front());
    const Image image = renderer.readRadiance();
    const auto lit = std::count_if(image.pixels.begin(), image.pixels.end(),
                                   [&](const glm::vec3& p) { return (p.x + p.y + p.z) * scene->exposure > 1e-3f; });
    EXPECT_GT(lit, 0) << file;  // of AMF's two shapes of a unit, 90 units apart, a few
    if (pictures) {
      std::string name = fs::relative(file, folder).string() + ".png";
      std::replace(name.begin(), name.end(), '/', '_');
      writePng(fs::path(pictures) / name, renderer.readDisplay());
    }
    ++shown;
  }
  RecordProperty("shown", static_cast<int>(shown));
  EXPECT_GE(shown, 20u);
  EXPECT_GE(refusals, 10u);
}

}  // namespace
}  // namespace lucerna
