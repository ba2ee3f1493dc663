// The window's live reference (demo/walk/live_reference.hpp): the interval that it states for a picture's error holds
// the true error in at least 95 of 100 views. The reference here is a reference with many times the samples and other
// random numbers. Its own noise can only make it leave the interval more often. LUCERNA_LONG_TESTS=1: 201 views of
// three scenes, some five minutes of one core.
#include "measure/error_interval.hpp"
#include "measure/reference.hpp"
#include "pathtracer/path_sampler.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/renderer.hpp"
#include "scene/key_frames.hpp"
#include "support/gl_fixture.hpp"
#include "support/long_tests.hpp"

#include <fmt/core.h>

#include <array>

namespace lucerna::test {
namespace {

class LiveReference : public SharedProgramsTest {
 protected:
  /// As demo/walk/live_reference.cpp samples; another seed is independent.
  PathTracer sampler(const Scene& scene, std::uint32_t seed) const {
    PathTracer::Settings settings;
    settings.size = kSize;
    settings.diffuseOnly = true;
    settings.filter = PixelFilter::box;
    settings.halves = true;
    settings.seed = seed;
    return PathTracer(context(), library(), scene, settings);
  }
  struct Tally {
    int views = 0;
    std::array<int, 2> held{};  ///< with 16 samples a pixel, and with 64
    std::array<double, 2> width{};  ///< of the interval over its middle, sums
  };
  static constexpr std::array<std::uint32_t, 2> kSamples{16, 64};
  static constexpr glm::ivec2 kSize{24, 14};

  /// `views` along the scene's path, techniques in turn.
  Tally judge(const std::string& file, int views, std::uint32_t samplesOfReference) const {
    const Scene scene = loadScene(std::string(LUCERNA_SOURCE_DIR "/assets/") + file);
    const Spline path(readKeyFrames(scene.keyFrames).camera);
    PathTracer live = sampler(scene, 1), reference = sampler(scene, 2);
    Tally tally;
    constexpr std::array<std::string_view, 3> kTechniques{"direct", "rsm", "lpv"};
    for (std::size_t turn = 0; turn < kTechniques.size(); ++turn) {
      RenderSettings settings;
      settings.technique = kTechniques[turn];
      settings.size = kSize;
      settings.fullFloatTarget = true;
      Renderer renderer(context(), library(), scene, settings);
      for (int i = static_cast<int>(turn); i < views; i += 3) {
        const Camera camera = path.view(i * (path.viewCount() - 1) / std::max(views - 1, 1));
        renderer.renderToTheEnd(camera);
        const Image picture = renderer.readRadiance();
        reference.setCamera(camera);
        reference.record(samplesOfReference);
        const double error = measure::nrmseInterval(picture, reference.mean(), reference.standardError()).value;
        live.setCamera(camera);
        live.setFirstSample(static_cast<std::uint32_t>(i) * kSamples.back());  // other numbers in each view
        for (std::size_t k = 0; k < kSamples.size(); ++k) {
          live.record(kSamples[k]);
          const measure::ErrorInterval stated = measure::nrmseInterval(picture, live.mean(), live.standardError());
          tally.held[k] += stated.low <= error && error <= stated.high ? 1 : 0;
          tally.width[k] += (stated.high - stated.low) / std::max(error, 1e-9);
        }
        ++tally.views;
      }
    }
    fmt::print("{}: {} views; held {} with 16 samples a pixel (width {:.1f} % of the error), {} with 64 ({:.1f} %)\n",
               file, tally.views, tally.held[0], 100.0 * tally.width[0] / tally.views, tally.held[1],
               100.0 * tally.width[1] / tally.views);
    std::fflush(stdout);
    return tally;
  }
};

TEST_F(LiveReference, TheStatedIntervalHoldsTheTrueError) {
  const bool all = longTests();
  int views = 0;
  std::array<int, 2> held{};
  for (const char* file : {"cornell/cornell.json", "atrium/atrium.json", "media/gems/gems.json"}) {
    const Tally tally = judge(file, all ? 67 : 6, all ? 512 : 256);
    views += tally.views;
    for (std::size_t k = 0; k < held.size(); ++k) held[k] += tally.held[k];
    if (!all) break;  // the others take minutes
  }
  for (const int count : held) EXPECT_GE(count, all ? static_cast<int>(std::ceil(0.95 * views)) : views - 1);
}

// Of sixteen films of two halves, the pictures differ by what their standard errors say. Those of independent samples
// have 3.8 times the squares with 16 samples, and 6.0 times with 64.
TEST_F(LiveReference, HalvesStateTheNoiseOfTheirPicture) {
  const Scene scene = loadScene(LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json");
  constexpr std::uint32_t kFilms = 16;
  PathTracer tracer = sampler(scene, 0);
  for (const std::uint32_t samples : {16u, 64u}) {
    measure::BatchMean found;
    double stated = 0.0;
    for (std::uint32_t k = 0; k < kFilms; ++k) {
      tracer.setCamera(scene.cameras.front());
      tracer.setSeed(k);
      tracer.record(samples);
      found.add(tracer.mean());
      for (const glm::vec3& e : tracer.standardError().pixels) stated += glm::dot(e, e) / kFilms;
    }
    double squares = 0.0;
    for (const glm::vec3& e : found.standardError().pixels) squares += glm::dot(e, e) * kFilms;
    fmt::print("[ measured ] {} samples: {:.3f} of the squared noise is stated\n", samples, stated / squares);
    EXPECT_NEAR(stated / squares, 1.0, 0.15) << samples;
  }
}

// A reference states the noise that it has: of sixteen, from other paths, the differences are what their standard
// errors say. Batches of one sequence of points, over the area of pixels, said 2.9 times the squares with 16 paths.
TEST_F(LiveReference, AReferenceStatesItsNoise) {
  const Scene scene = loadScene(LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json");
  constexpr int kReferences = 16;
  PathSampler sampler(context(), library(), scene, scene.cameras.front(), {24, 24}, PixelFilter::box, Transport::all);
  for (const std::uint64_t samples : {16u, 64u}) {
    measure::BatchMean found;
    double stated = 0.0;
    for (std::uint64_t k = 0; k < kReferences; ++k) {
      const auto reference = measure::sampleReference(sampler.asSampler(), Transport::all, k * samples, {samples});
      ASSERT_TRUE(reference);
      found.add(reference->mean);
      for (const glm::vec3& e : reference->standardError.pixels) stated += glm::dot(e, e) / kReferences;
    }
    double squares = 0.0;  // of a reference: those of the mean of all, times their number
    for (const glm::vec3& e : found.standardError().pixels) squares += glm::dot(e, e) * kReferences;
    fmt::print("[ measured ] {} paths: {:.3f} of the squared noise is stated\n", samples, stated / squares);
    EXPECT_NEAR(stated / squares, 1.0, 0.1) << samples;
  }
}

}  // namespace
}  // namespace lucerna::test
