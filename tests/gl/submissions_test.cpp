// The longest submission of each raster technique: work items times iterations, as gl/chunks.hpp counts them, not
// timed. What is cut stays the same bit by bit. Those of path tracing, of radiosity's shadow rays and of hemicubes are
// in PathTracerTest, RadiosityDirect and Hemicube.
#include "gl/chunks.hpp"
#include "irradiance_cache/light_gather.hpp"
#include "irradiance_cache/settings.hpp"
#include "lpv/lpv_frame.hpp"
#include "lpv/settings.hpp"
#include "render/renderer.hpp"
#include "rsm/rsm_gather.hpp"
#include "shared/irradiance_cache.h"
#include "support/gl_fixture.hpp"
#include "support/media_scenes.hpp"
#include "support/small_scenes.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace lucerna {
namespace {

constexpr double kMost = gl::kMostOverUnmeasured * gl::kUnmeasuredIterations;

class Submissions : public test::SharedProgramsTest {
 protected:
  struct Drawn {
    Image picture;
    double largestIterations, largestSubmission;
  };
  static Drawn drawn(const Scene& scene, RenderSettings settings, double unmeasuredIterations) {
    settings.size = {64, 48};
    settings.fullFloatTarget = true;
    settings.of<ReflectiveShadowMap::Settings>().size = 64;
    settings.of<LpvSettings>().cascades.cells = 8;
    settings.unmeasuredIterations = unmeasuredIterations;
    Renderer renderer(context(), library(), scene, settings);
    gl::Submission::forget();
    renderer.render(test::openBoxCamera());
    return {renderer.readRadiance(), renderer.largestIterations(), gl::Submission::largest()};
  }
  /// unmeasuredIterations: such that the picture takes many chunks of at least a work group.
  static void expectSameInChunks(const Scene& scene, const RenderSettings& settings, double unmeasuredIterations) {
    const Drawn whole = drawn(scene, settings, gl::kUnmeasuredIterations),
                cut = drawn(scene, settings, unmeasuredIterations);
    EXPECT_LE(whole.largestIterations, kMost);
    EXPECT_GT(whole.largestIterations, gl::kMostOverUnmeasured * unmeasuredIterations) << "nothing was cut";
    EXPECT_LE(cut.largestIterations, gl::kMostOverUnmeasured * unmeasuredIterations);
    EXPECT_GT(cut.largestIterations, 0.0);
    EXPECT_LE(whole.largestSubmission, kMost);
    EXPECT_LE(cut.largestSubmission,
              settings.technique == "lpv" ? kMost : gl::kMostOverUnmeasured * unmeasuredIterations);
    EXPECT_GE(cut.largestSubmission, cut.largestIterations);
    EXPECT_EQ(cut.picture.pixels, whole.picture.pixels);
    EXPECT_GT(meanOf(whole.picture).x, 0.0);
  }
};

TEST_F(Submissions, NoPieceOfAPictureIsMoreThanIsSafe) {
  struct Case {
    glm::ivec2 picture;
    double iterationsOfPixel;
    int unit;
    bool isCut;
  };
  for (const Case& c : {Case{{1280, 720}, 400.0, 8, true},  // the default gather of 3.7e8 iterations
                        {{640, 360}, 400.0, 8, false},
                        {{1920, 1080}, 12.0, 1, false},  // surfaces in the sun
                        {{7680, 4320}, 100.0, 1, true},
                        {{3840, 2160}, 65536.0, 8, true},  // a row of work groups is too much
                        {{16384, 16384}, 65536.0, 1, true}}) {
    const glm::ivec2 chunk = gl::PictureChunks().sizeOfChunk(c.picture, c.iterationsOfPixel, c.unit);
    EXPECT_EQ(chunk != c.picture, c.isCut) << c.picture.x;
    EXPECT_LE(c.iterationsOfPixel * chunk.x * chunk.y, c.isCut ? gl::kUnmeasuredIterations : kMost) << c.picture.x;
    for (int axis = 0; axis < 2; ++axis) EXPECT_TRUE(chunk[axis] == c.picture[axis] || chunk[axis] % c.unit == 0);
  }
}

TEST_F(Submissions, PiecesMakeUpThePicture) {
  for (const double iterationsOfPixel : {0.1, 4.0, 50.0}) {
    const glm::ivec2 picture(37, 21);
    std::vector<int> times(37 * 21, 0);
    gl::PictureChunks chunks(256.0);
    chunks.forEach(picture, iterationsOfPixel, 2, [&](const glm::ivec2& corner, const glm::ivec2& size) {
      for (int y = corner.y; y < corner.y + size.y; ++y)
        for (int x = corner.x; x < corner.x + size.x; ++x) ++times.at(static_cast<std::size_t>(37 * y + x));
    });
    EXPECT_EQ(times, std::vector<int>(37 * 21, 1)) << iterationsOfPixel;
  }
}

TEST_F(Submissions, DirectLight) {
  Scene scene = test::openBox();
  scene.points.push_back({{0.3, 1.5, 0.2}, glm::vec3(2.0f)});
  RenderSettings settings;
  settings.technique = "direct";
  expectSameInChunks(scene, settings, 1024.0);
}

TEST_F(Submissions, GatherFromTheMap) {
  Scene scene = test::openBox();
  scene.points.push_back({{0.3, 1.5, 0.2}, glm::vec3(2.0f)});  // a map more
  RenderSettings settings;
  settings.technique = "rsm";
  settings.of<RsmGather::Settings>().samples = 64;
  settings.of<RsmGather::Settings>().lowResolution = 2;  // so that each of its passes is cut
  for (const bool interpolate : {false, true}) {
    settings.of<RsmGather::Settings>().interpolate = interpolate;
    expectSameInChunks(scene, settings, 4096.0);
  }
}

TEST_F(Submissions, LightShafts) {
  Scene scene = test::openBox();
  Medium haze;
  haze.scattering = glm::vec3(0.1f);
  scene.media.push_back(haze);
  scene.cameraMedium = 0;
  RenderSettings settings;
  settings.technique = "lpv";
  settings.of<LpvSettings>().shafts = true;
  expectSameInChunks(scene, settings, 65536.0);
}

// A watchdog times all that lies between two flushes: rounds of paths, parts of a list, steps, a map after the other.
TEST_F(Submissions, RoundsAreHandedOverOneByOne) {
  Scene scene = test::openBox();
  scene.points.push_back({{0.3, 1.5, 0.2}, glm::vec3(2.0f)});
  RenderSettings settings;
  settings.size = {16, 16};
  settings.of<IrradianceCacheSettings>().rays = 8;
  settings.of<IrradianceCacheSettings>().samples = 64;
  settings.of<LpvSettings>().iterations = 128;
  using Way = std::pair<std::string_view, CacheTransport>;
  for (const auto& [technique, transport] :
       {Way{"irradiance-cache", CacheTransport::rays}, Way{"irradiance-cache", CacheTransport::gather},
        Way{"lpv", CacheTransport::rays}}) {
    settings.technique = technique;
    settings.of<IrradianceCacheSettings>().transport = transport;
    settings.of<IrradianceCacheSettings>().bounces =
        transport == CacheTransport::gather ? IrradianceCacheSettings::kAllBounces : 1;
    Renderer renderer(context(), library(), scene, settings);
    gl::Submission::forget();
    renderer.renderToTheEnd(test::openBoxCamera());
    EXPECT_LE(gl::Submission::largest(), kMost) << technique << " " << nameOf(transport);
    EXPECT_GT(gl::Submission::largest(), 0.25 * kMost) << technique << " " << nameOf(transport);
  }
}

// The walk of shaders/irradiance_cache/gather/gather.comp through a light tree, with other choices of the nodes that
// are opened.
double iterationsOfWalk(int depth, int top, int layers, const std::function<bool(int i, int depth)>& opens) {
  const std::uint64_t bits = 2 * static_cast<std::uint64_t>(top);
  const auto firstOf = [](int d) { return ((std::uint64_t{1} << (2 * d)) - 1) / 3; };
  const auto depthOf = [&](std::uint64_t node) {
    int d = 0;
    while (firstOf(d + 1) <= node) ++d;
    return d;
  };
  const std::uint64_t tops = static_cast<std::uint64_t>(layers) << bits, firstTop = firstOf(top);
  std::uint64_t coarsest = 0, root = firstTop, node = root;
  int i = 0;
  for (; coarsest < tops; ++i) {
    if (node < firstOf(depth) && i < CACHE_MOST_OPENING && opens(i, depthOf(node))) {
      node = 4 * node + 1;
      continue;
    }
    while (node != root && (node & 3) == 0) node = (node - 1) >> 2;
    if (node != root) {
      ++node;
      continue;
    }
    coarsest += CACHE_LANES;
    root = node = firstTop + (coarsest & ((std::uint64_t{1} << bits) - 1));
  }
  return i;
}

TEST_F(Submissions, NoLaneGathersForLongerThanIsSaid) {
  double longest = 0.0;
  for (const glm::ivec2& tree : {glm::ivec2(8, 1), glm::ivec2(8, 6), glm::ivec2(12, 6), glm::ivec2(13, 1)}) {
    const int depth = tree.x, layers = tree.y;
    const int top = std::min(depth - 1, LightTree::kTop);
    // Without the texels near by, the way to a leaf and the ray.
    const double most =
        LightGather::iterationsOfLane(depth, top, layers) - CACHE_MOST_NEAR - 4.0 * depth - gl::kIterationsOfRay;
    for (int last = CACHE_MOST_OPENING - 3 * depth; last <= CACHE_MOST_OPENING; ++last) {
      // Waits before the last levels, then opens all the way down.
      const double iterations =
          iterationsOfWalk(depth, top, layers, [&](int i, int at) { return i >= last - depth || at + 4 < depth; });
      EXPECT_LE(iterations, most) << depth << ", " << layers;
      longest = std::max(longest, iterations / most);
    }
    EXPECT_LE(LightGather::iterationsOfLane(depth, top, layers) * CACHE_LANES * CACHE_PART_GROUPS, kMost);
  }
  EXPECT_GT(longest, 0.98);
}

// What the volume does in one go has a size of its own, which its settings limit; records come in lists that end
// where a submission would be too long.
TEST_F(Submissions, VolumesAtTheirLargest) {
  RenderSettings settings;
  settings.of<LpvSettings>().cascades.cells = 128;
  settings.of<LpvSettings>().cascades.cascades = MAX_CASCADES;
  settings.of<ReflectiveShadowMap::Settings>().size = 8192;
  for (const bool hasPoints : {false, true}) EXPECT_LE(LpvFrame::largestIterations(settings, hasPoints), kMost);
  const Scene scene = test::openBox();
  settings = {};
  for (const CacheTransport transport : {CacheTransport::rays, CacheTransport::gather})
    for (const int rays : {1, 8, 64}) {
      settings.of<IrradianceCacheSettings>().transport = transport;
      settings.of<IrradianceCacheSettings>().rays = rays;
      settings.of<IrradianceCacheSettings>().bounces =
          transport == CacheTransport::gather ? IrradianceCacheSettings::kAllBounces : 1;
      settings.of<IrradianceCacheSettings>().bounceCells = 64;
      settings.size = {16, 16};
      const Renderer renderer(context(), library(), scene, settings);
      EXPECT_LE(renderer.largestIterations(), kMost) << rays;
      EXPECT_GT(renderer.largestIterations(), 0.0);
    }
}

}  // namespace
}  // namespace lucerna
