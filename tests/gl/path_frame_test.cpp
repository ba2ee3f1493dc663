// The path tracer as a technique of the frame: the film's pictures, bit by bit, shown with the frame's own tone
// mapping; more samples while the view stands still.
#include "lpv/lpv_frame.hpp"
#include "pathtracer/path_frame.hpp"
#include "render/renderer.hpp"
#include "rsm/rsm_frame.hpp"
#include "support/path_scenes.hpp"

namespace lucerna {
namespace {

using test::lookingAt;
using test::openBox;
using test::openBoxCamera;

class PathFrameGl : public test::PathTest {
 protected:
  static RenderSettings settings(std::uint32_t samples) {
    RenderSettings s;
    s.technique = "path";
    s.size = {24, 16};
    s.fullFloatTarget = true;
    s.of<PathSettings>().samples = samples;
    return s;
  }
  /// The same picture by the path tracer alone.
  Image alone(const Scene& scene, const Camera& camera, const RenderSettings& s, Transport transport,
              std::uint32_t samples) {
    PathTracer::Settings path;
    path.size = s.size;
    path.transport = transport;
    path.seed = s.of<PathSettings>().seed;
    path.bounces = s.of<PathSettings>().scatterings;
    return tracer(scene, camera, path, samples).mean();
  }
  static void expectSame(const Image& a, const Image& b, const char* what) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size()) << what;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) ASSERT_EQ(a.pixels[i], b.pixels[i]) << what << ", pixel " << i;
  }
};

TEST_F(PathFrameGl, APictureIsThePathTracersAndItsDisplayTheFrames) {
  const Scene scene = openBox();
  for (const auto& [component, transport] : {std::pair{Component::all, Transport::all},
                                             {Component::direct, Transport::direct},
                                             {Component::indirect, Transport::indirect}}) {
    RenderSettings s = settings(6);
    s.component = component;
    s.of<PathSettings>().seed = 3;
    s.of<PathSettings>().scatterings = 4;
    Renderer renderer(context(), library(), scene, s);
    renderer.renderToTheEnd(openBoxCamera());
    EXPECT_TRUE(renderer.isSettled());
    const Image expected = alone(scene, openBoxCamera(), s, transport, 6);
    expectSame(renderer.readRadiance(), expected, nameOf(component).data());
    // The shader's curve and the CPU's differ by rounding.
    const Bitmap shown = renderer.readDisplay(), mapped = toneMapped(expected, scene.exposure);
    ASSERT_EQ(shown.rgba.size(), mapped.rgba.size());
    for (std::size_t i = 0; i < shown.rgba.size(); ++i) EXPECT_NEAR(shown.rgba[i], mapped.rgba[i], 1) << i;
  }
}

TEST_F(PathFrameGl, GetsBetterWhileTheViewStandsStillAndBeginsAnewWhereItMoves) {
  const Scene scene = openBox();
  RenderSettings s = settings(16);
  Renderer renderer(context(), library(), scene, s);
  const Camera other = lookingAt({0.5, 1.0, 11.0}, {0.0, -1.0, 0.0});
  renderer.render(openBoxCamera());
  EXPECT_GE(pathOf(renderer.technique())->statistics().fewestSamples, 1u);
  EXPECT_FALSE(renderer.isSettled());
  int frames = 1;
  for (; !renderer.isSettled() && frames < 1000; ++frames) renderer.render(openBoxCamera());
  EXPECT_GT(frames, 2);
  expectSame(renderer.readRadiance(), alone(scene, openBoxCamera(), s, Transport::all, 16), "settled");
  renderer.render(openBoxCamera());
  expectSame(renderer.readRadiance(), alone(scene, openBoxCamera(), s, Transport::all, 16), "a frame more");
  renderer.render(other);
  EXPECT_FALSE(renderer.isSettled());
  renderer.renderToTheEnd(other);
  expectSame(renderer.readRadiance(), alone(scene, other, s, Transport::all, 16), "another view");
  renderer.forget();
  renderer.render(other);
  EXPECT_LT(pathOf(renderer.technique())->statistics().fewestSamples, 16u) << "nothing is kept";
}

TEST_F(PathFrameGl, AnotherSizeIsAnotherFilm) {
  const Scene scene = openBox();
  RenderSettings s = settings(4);
  Renderer renderer(context(), library(), scene, s);
  renderer.renderToTheEnd(openBoxCamera());
  renderer.resize({40, 12});
  renderer.renderToTheEnd(openBoxCamera());
  s.size = {40, 12};
  expectSame(renderer.readRadiance(), alone(scene, openBoxCamera(), s, Transport::all, 4), "after resize");
}

TEST_F(PathFrameGl, NothingElseIsMade) {
  Renderer renderer(context(), library(), openBox(), settings(1));
  renderer.render(openBoxCamera());
  renderer.drain();
  for (const gl::StageStatistics& stage : renderer.timer().statistics())
    EXPECT_TRUE(stage.name == "path tracing" || stage.name == "film" || stage.name == "tone mapping") << stage.name;
  const std::vector<std::string> names = renderer.leftOut();
  for (const char* name :
       {"shadow map", "reflective shadow map", "irradiance cache", "light propagation volume", "radiosity"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  EXPECT_EQ(volumeOf(renderer.technique()), nullptr);
  EXPECT_EQ(gatherOf(renderer.technique()), nullptr);
}

}  // namespace
}  // namespace lucerna
