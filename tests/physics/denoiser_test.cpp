// What the denoiser promises (engine/pathtracer/denoiser.hpp): at any number of samples the picture is not worse than
// the raw one by relative squared error, it converges to the truth, and the error that it states holds the true error
// in at least 95 of 100 views. Raw is the mean of both halves: of the same samples, so that their luck does not decide.
// LUCERNA_LONG_TESTS=1: nine scenes from 1 to 4096 samples a pixel, an hour of one core, and 201 views, half
// an hour.
#include "measure/error_interval.hpp"
#include "measure/image_errors.hpp"
#include "pathtracer/denoiser.hpp"
#include "scene/key_frames.hpp"
#include "scene/scene_file.hpp"
#include "support/gl_fixture.hpp"
#include "support/long_tests.hpp"

#include <fmt/core.h>

#include <array>

namespace lucerna::test {
namespace {

class DenoiserPromise : public SharedProgramsTest {
 protected:
  static Scene assets(const std::string& file) { return loadScene(std::string(LUCERNA_SOURCE_DIR "/assets/") + file); }
  static PathTracer::Settings settings(glm::ivec2 size, bool halves, std::uint32_t seed) {
    PathTracer::Settings s;
    s.size = size;
    s.halves = halves;
    s.seed = seed;
    return s;
  }
  struct Row {
    std::uint32_t samples = 0;
    double raw = 0.0, denoised = 0.0;  ///< relative squared errors; raw: of the same samples
  };
  /// At each of those numbers of samples, against as many as twice the last.
  std::vector<Row> errors(const std::string& file, glm::ivec2 size, const std::vector<std::uint32_t>& samples) const {
    const Scene scene = assets(file);
    PathTracer truth(context(), library(), scene, settings(size, false, 777)),
        halves(context(), library(), scene, settings(size, true, 0));
    for (PathTracer* tracer : {&truth, &halves}) tracer->setCamera(scene.cameras.front());
    truth.record(2 * samples.back());
    const Image exact = truth.mean();
    // Both pictures' errors contain the truth's own noise.
    const double noise = measure::noiseOf(exact, truth.standardError(), 0.0).relativeVariance;
    Denoiser denoiser(library(), halves);
    std::vector<Row> rows;
    for (const std::uint32_t n : samples) {
      halves.record(n);
      denoiser.denoise();
      rows.push_back({n, measure::errorsOf(halves.mean(), exact).relmse - noise,
                      measure::errorsOf(denoiser.picture(), exact).relmse - noise});
      fmt::print("{} {} samples: raw {:.3g}, denoised {:.3g}, {:.3f} of it\n", file, n, rows.back().raw,
                 rows.back().denoised, rows.back().denoised / rows.back().raw);
    }
    return rows;
  }

  struct Tally {
    int views = 0;
    std::array<int, 2> held{};
    std::array<double, 2> width{};  ///< of the interval over its middle, sums
  };
  static constexpr std::array<std::uint32_t, 2> kSamples{16, 64};

  /// Views along the scene's path, each with other random numbers.
  Tally judge(const std::string& file, int views, std::uint32_t samplesOfTruth) const {
    constexpr glm::ivec2 kSize{48, 27};
    const Scene scene = assets(file);
    const Spline path(readKeyFrames(scene.keyFrames).camera);
    PathTracer truth(context(), library(), scene, settings(kSize, false, 2)),
        halves(context(), library(), scene, settings(kSize, true, 1));
    Denoiser denoiser(library(), halves);
    Tally tally;
    for (int i = 0; i < views; ++i) {
      const Camera camera = path.view(i * (path.viewCount() - 1) / std::max(views - 1, 1));
      truth.setCamera(camera);
      truth.record(samplesOfTruth);
      const Image exact = truth.mean(), own = truth.standardError();
      halves.setCamera(camera);
      halves.setFirstSample(static_cast<std::uint32_t>(i) * kSamples.back());
      denoiser.forget();
      for (std::size_t k = 0; k < kSamples.size(); ++k) {
        halves.record(kSamples[k]);
        denoiser.denoise();
        const double error = measure::nrmseInterval(denoiser.picture(), exact, own).value;
        const DenoisedError stated = denoiser.error();
        tally.held[k] += stated.known && stated.low <= error && error <= stated.high;
        tally.width[k] += (stated.high - stated.low) / (stated.high + stated.low);
        if (!(stated.low <= error && error <= stated.high))
          fmt::print("{} view {}, {} samples: {:.4f} is not in {:.4f} to {:.4f}\n", file, i, kSamples[k], error,
                     stated.low, stated.high);
      }
      ++tally.views;
    }
    return tally;
  }
};

TEST_F(DenoiserPromise, IsNotWorseThanTheRawPictureAndConverges) {
  const bool isLong = longTests();
  const std::vector<const char*> files =
      isLong
          ? std::vector<const char*>{"cornell/cornell.json",   "atrium/atrium.json",           "door/door.json",
                                     "media/gems/gems.json",   "media/espresso/espresso.json", "media/cola/cola.json",
                                     "media/block/juice.json", "media/block/milk.json",        "media/smoke/smoke.json"}
          : std::vector<const char*>{"cornell/cornell.json", "media/block/juice.json"};
  const std::vector<std::uint32_t> samples = isLong ? std::vector<std::uint32_t>{1, 2, 4, 16, 64, 256, 1024, 4096}
                                                    : std::vector<std::uint32_t>{1, 2, 4, 16, 64, 256};
  for (const char* file : files) {
    const std::vector<Row> rows = errors(file, glm::ivec2(48, 27), samples);
    EXPECT_EQ(rows[0].denoised, rows[0].raw) << file << ": a single sample stays as it is";
    for (std::size_t i = 1; i < rows.size(); ++i) {
      EXPECT_LE(rows[i].denoised, rows[i].raw) << file << ", " << rows[i].samples << " samples";
      EXPECT_LT(rows[i].denoised, rows[i - 1].denoised) << file << ", " << rows[i].samples << " samples";
    }
  }
}

TEST_F(DenoiserPromise, TheStatedErrorHoldsTheTrueOneInNinetyFiveOfAHundredViews) {
  const bool isLong = longTests();
  Tally all;
  const auto add = [&](const char* file, int views, std::uint32_t samples) {
    const Tally t = judge(file, views, samples);
    for (std::size_t k = 0; k < kSamples.size(); ++k) {
      all.held[k] += t.held[k];
      all.width[k] += t.width[k];
      fmt::print("{}: {} of {} views held at {} samples, {:.0f} % wide\n", file, t.held[k], t.views, kSamples[k],
                 100.0 * t.width[k] / t.views);
    }
    all.views += t.views;
  };
  add("cornell/cornell.json", isLong ? 67 : 20, 1024);
  if (isLong) {
    add("atrium/atrium.json", 67, 512);
    add("media/gems/gems.json", 67, 1024);
  }
  for (std::size_t k = 0; k < kSamples.size(); ++k) EXPECT_GE(all.held[k], 0.95 * all.views) << kSamples[k];
}

}  // namespace
}  // namespace lucerna::test
