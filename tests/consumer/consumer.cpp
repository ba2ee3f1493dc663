// consumer SCENE OUT.{png,hdr,exr,pfm} [HOST]: one picture of a scene's first camera, drawn off-screen with
// lucerna::engine. HOST is egl or osmesa; without it the library chooses. Prints the mean radiance.
#include <base/error.hpp>
#include <base/files.hpp>
#include <base/image.hpp>
#include <gl/context.hpp>
#include <gl/program.hpp>
#include <host/host.hpp>
#include <lpv/settings.hpp>
#include <render/renderer.hpp>
#include <scene/scene.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>

namespace {

void draw(const std::filesystem::path& sceneFile, const std::filesystem::path& output, const char* hostName) {
  // Plain data first: meshes, materials, lights, cameras. Wrong files throw before anything is opened.
  const lucerna::Scene scene = lucerna::loadScene(sceneFile);

  // The host owns the OpenGL context, which stays current on this thread as long as it lives.
  const std::unique_ptr<lucerna::Host> host =
      hostName ? lucerna::Host::create(lucerna::parseHostKind(hostName)) : lucerna::Host::createDefault(false);
  const lucerna::gl::Context context;
  lucerna::gl::ProgramLibrary programs;  // the installed shaders

  lucerna::RenderSettings settings;
  settings.technique = "lpv";
  settings.pixelSamples = 16;  // as `lucerna render`; a frame of its own has 1
  settings.size = {96, 64};
  settings.fullFloatTarget = true;
  settings.of<lucerna::LpvSettings>().cascades.cells = 16;
  lucerna::Renderer renderer(context, programs, scene, settings);
  renderer.renderToTheEnd(scene.cameras.front());
  renderer.drain();

  const lucerna::Image radiance = renderer.readRadiance();
  if (lucerna::lowerExtension(output) == ".png") lucerna::writePng(output, renderer.readDisplay());
  else lucerna::writeImage(output, radiance);
  const glm::dvec3 mean = lucerna::meanOf(radiance);
  std::printf("%.9g %.9g %.9g\n", mean.x, mean.y, mean.z);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: consumer SCENE OUT.{png,hdr,exr,pfm} [HOST]\n");
    return 2;
  }
  try {
    draw(argv[1], argv[2], argc == 4 ? argv[3] : nullptr);
  } catch (const lucerna::Error& error) {
    std::fprintf(stderr, "consumer: %s\n", error.what());
    return error.exitCode();
  }
  return 0;
}
