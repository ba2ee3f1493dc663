// The path tracer as a technique of the frame: the film's pictures, bit by bit, shown with the frame's own tone
// mapping; more samples while the view stands still.
#include "lpv/lpv_frame.hpp"
#include "pathtracer/path_frame.hpp"
#include "render/renderer.hpp"
#include "rsm/rsm_frame.hpp"
#include "scene/motion.hpp"
#include "support/path_scenes.hpp"
#include "support/small_scenes.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <vector>

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

/// Root mean square over pixels and channels.
double difference(const Image& a, const Image& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(a.pixels[i]) - glm::dvec3(b.pixels[i]);
    squares += glm::dot(d, d);
  }
  return std::sqrt(squares / (3.0 * static_cast<double>(a.pixels.size())));
}

Camera walked(int step) { return lookingAt({0.05 * step, 1.0 + 0.02 * step, 11.0 - 0.1 * step}, {0.0, -1.0, 0.0}); }

// The scene moves too in the second half of the walk.
TEST_F(PathFrameGl, AFrameInMotionHasLessErrorThanItsSampleAlone) {
  constexpr int kSteps = 6;
  RenderSettings s = settings(64);
  s.size = {36, 24};
  double error[2] = {0.0, 0.0};
  std::vector<Image> right;
  for (const bool reprojects : {true, false}) {
    Scene scene = openBox();
    s.reprojection = reprojects;
    Renderer renderer(context(), library(), scene, s);
    renderer.render(walked(0));
    for (int step = 1; step < kSteps; ++step) {
      if (2 * step > kSteps) {
        transformMesh(scene, scene.meshes[2], glm::translate(glm::dmat4(1.0), {0.05, 0.0, 0.0}));
        updateBounds(scene, 2);
        SceneChange change;
        change.meshes = {2};
        ASSERT_TRUE(renderer.follow(context(), library(), scene, change));
      }
      renderer.render(walked(step));
      EXPECT_FALSE(renderer.isSettled());
      if (reprojects) right.push_back(alone(scene, walked(step), s, Transport::all, 128));
      error[reprojects] += difference(renderer.readRadiance(), right[static_cast<std::size_t>(step - 1)]);
    }
  }
  EXPECT_LT(error[1], 0.5 * error[0]) << error[1] << " of " << error[0];
}

TEST_F(PathFrameGl, TheSumAtRestIsThatWithoutMotion) {
  Scene scene = openBox();
  const RenderSettings s = settings(16);
  Renderer renderer(context(), library(), scene, s);
  const Image right = alone(scene, walked(3), s, Transport::all, 16),
              four = alone(scene, walked(3), s, Transport::all, 4);
  for (const bool sceneMoves : {false, true}) {
    for (int step = 0; step < 4; ++step) {
      SceneChange change;
      change.meshes = {2};
      if (sceneMoves) { ASSERT_TRUE(renderer.follow(context(), library(), scene, change)); }
      renderer.render(walked(step));
    }
    bool sawFour = false;
    for (int frame = 0; !renderer.isSettled() && frame < 1000; ++frame) {
      renderer.render(walked(3));
      const PathTracer& tracer = *pathOf(renderer.technique());
      if (tracer.samples() != 4 || !tracer.isBetweenTiles()) continue;
      sawFour = true;
      expectSame(tracer.mean(), four, "the film");
      EXPECT_LT(difference(renderer.readRadiance(), right), difference(four, right)) << "earlier frames show through";
    }
    EXPECT_TRUE(sawFour);
    expectSame(renderer.readRadiance(), right, "settled");
  }
}

TEST_F(PathFrameGl, WithoutReprojectionAFrameInMotionIsItsOwnSamples) {
  const Scene scene = openBox();
  RenderSettings s = settings(16);
  s.reprojection = false;
  Renderer renderer(context(), library(), scene, s);
  renderer.render(walked(0));
  const std::size_t bytes = renderer.gpuBytes();
  renderer.render(walked(1));
  expectSame(renderer.readRadiance(), alone(scene, walked(1), s, Transport::all, 1), "in motion");
  EXPECT_EQ(renderer.gpuBytes(), bytes);
  s.reprojection = true;
  renderer.apply(s);
  renderer.render(walked(1));
  EXPECT_EQ(renderer.gpuBytes(), bytes) << "nothing moves";
  renderer.render(walked(2));
  EXPECT_GT(renderer.gpuBytes(), bytes);
}

// Shining plates, without noise: a near one in front of a far one. What the near one uncovers shows nothing of it.
TEST_F(PathFrameGl, WhatComesOutFromBehindAnotherSurfaceShowsNoGhost) {
  test::SceneBuilder builder;
  const int near = builder.material(glm::vec3(0.0f)), far = builder.material(glm::vec3(0.0f));
  builder.materialAt(near).emission = glm::vec3(4.0f);
  builder.materialAt(far).emission = glm::vec3(1.0f);
  builder.plate({0, 0, -8}, {40, 0, 0}, {0, 40, 0}, far);
  builder.plate({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, near);
  RenderSettings s = settings(64);
  s.size = {48, 32};
  Renderer renderer(context(), library(), builder.scene(), s);
  const auto cameraAt = [](int step) { return lookingAt({0.3 * step, 0, 6}, {0.3 * step, 0, 0}); };
  for (int step = 0; step < 6; ++step) renderer.render(cameraAt(step));
  const Image shown = renderer.readRadiance(), right = alone(builder.scene(), cameraAt(5), s, Transport::all, 16);
  int ghosts = 0, uniform = 0;
  for (int y = 1; y + 1 < right.height; ++y)
    for (int x = 1; x + 1 < right.width; ++x) {
      bool isUniform = true;  // no edge within a pixel
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) isUniform = isUniform && right.at(x + i, y + j) == right.at(x, y);
      if (!isUniform) continue;
      ++uniform;
      if (std::abs(shown.at(x, y).x - right.at(x, y).x) > 0.1f) ++ghosts;
    }
  EXPECT_GT(uniform, 1000);
  EXPECT_LE(ghosts, 8);
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
