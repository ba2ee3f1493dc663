// The glTF sample models that Debian ships (package assimp-testmodels, mostly Khronos's): each that loads and has a face towards its view shows something.
#include "base/error.hpp"
#include "render/renderer.hpp"
#include "scene/scene.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <set>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

using SampleModels = test::SharedProgramsTest;

TEST_F(SampleModels, EveryOneThatLoadsShowsSomething) {
  const fs::path folder = "/usr/share/assimp/models";
  if (!fs::is_directory(folder / "glTF2")) GTEST_SKIP() << "the sample models are missing (Debian package assimp-testmodels)";
  std::set<fs::path> files;
  for (const char* part : {"glTF", "glTF2"})
    for (const auto& entry : fs::recursive_directory_iterator(folder / part))
      if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") files.insert(entry.path());
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
    RenderSettings settings;
    settings.technique = Technique::direct;
    settings.size = {48, 36};
    Renderer renderer(context(), library(), *scene, settings);
    renderer.render(scene->cameras.front());
    const glm::dvec3 mean = meanOf(renderer.readRadiance());
    EXPECT_GT(mean.x + mean.y + mean.z, 1e-4) << file;
    ++shown;
  }
  RecordProperty("shown", static_cast<int>(shown));
  EXPECT_GE(shown, 20u);
  EXPECT_GE(refusals, 10u);
}

}  // namespace
}  // namespace lucerna
