// The denoiser on the GPU: its result by a reference implementation in double, what it reads, and that nothing of it is
// there where it is off.
#include "pathtracer/denoiser.hpp"
#include "pathtracer/path_frame.hpp"
#include "render/renderer.hpp"
#include "support/denoise_reference.hpp"
#include "support/path_scenes.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::test {
namespace {

class DenoiserGl : public PathTest {
 protected:
  static constexpr glm::ivec2 kSize{30, 20};
  static PathTracer::Settings halves() {
    PathTracer::Settings settings;
    settings.size = kSize;
    settings.halves = true;
    return settings;
  }
  /// With lamps of all kinds: fireflies, shadows.
  static Scene scene() {
    Scene scene = openBox();
    scene.environment = Environment{};
    scene.environment->radiance = glm::vec3(0.1f, 0.2f, 0.4f);
    return scene;
  }
  /// Largest |difference| over what pixels differ by on average.
  static double worst(const Image& image, const std::vector<glm::dvec3>& expected) {
    double largest = 0.0, mean = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const glm::dvec3& e = expected[static_cast<std::size_t>((image.height - 1 - y) * image.width + x)];
        for (int c = 0; c < 3; ++c) {
          largest = std::max(largest, std::abs(static_cast<double>(image.at(x, y)[c]) - e[c]));
          mean += e[c] / (3.0 * static_cast<double>(expected.size()));
        }
      }
    return largest / mean;
  }
};

TEST_F(DenoiserGl, EqualsTheReferenceInDouble) {
  for (const std::uint32_t samples : {2u, 3u, 8u, 37u}) {
    const Scene lit = scene();
    const PathTracer path = tracer(lit, openBoxCamera(), halves(), samples);
    Denoiser denoiser(library(), path);
    denoiser.denoise();
    const DenoiseReference expected = denoise(denoiseInput(
        filmOf(path.checkpoint(), "film"), denoiser.surfaceColours().readRgba(), denoiser.surfacePlaces().readRgba()));
    EXPECT_LT(worst(path.mean(), expected.raw), 1e-5) << samples;
    EXPECT_GT(worst(path.mean(), expected.picture), 0.05) << samples << ": it does something";
    EXPECT_LT(worst(denoiser.picture(), expected.picture), 2e-3) << samples;
    // The stated error is that of the reference's sums over the same blocks.
    const DenoisedError error = denoiser.error();
    EXPECT_EQ(error.known, samples >= Denoiser::kFewestSamples);
    if (!error.known) continue;
    double raw = 0.0, least = 0.0, most = 0.0, mean = 0.0;
    const double values = 3.0 * static_cast<double>(expected.raw.size());
    for (std::size_t p = 0; p < expected.raw.size(); ++p) {
      raw += expected.rawError[p] / values;
      least += expected.error[p] / values;
      most += expected.heldOut[p] / values;
      mean += (expected.raw[p].x + expected.raw[p].y + expected.raw[p].z) / values;
    }
    EXPECT_NEAR(error.raw, std::sqrt(raw) / mean, 1e-3 * error.raw);
    EXPECT_NEAR(error.value, std::sqrt(0.5 * (least + most)) / mean, 5e-3 * error.value);
    EXPECT_LT(error.low, error.value);
    EXPECT_GT(error.high, error.value);
  }
}

TEST_F(DenoiserGl, ASingleSampleStaysAsItIs) {
  const PathTracer path = tracer(scene(), openBoxCamera(), halves(), 1);
  Denoiser denoiser(library(), path);
  denoiser.denoise();
  denoiser.denoise();  // again, as frames in motion do
  EXPECT_EQ(denoiser.picture().pixels, path.mean().pixels);
  EXPECT_FALSE(denoiser.error().known);
}

TEST_F(DenoiserGl, HalvesAreIndependentPicturesOfTheSameView) {
  const Scene lit = scene();
  const PathTracer path = tracer(lit, openBoxCamera(), halves(), 128);
  const Film film = filmOf(path.checkpoint(), "film");
  const std::vector<FilmPixel> pixels = film.pixels();
  const std::size_t count = pixels.size() / 2;
  EXPECT_EQ(film.size, glm::ivec2(kSize.x, 2 * kSize.y));
  double product = 0.0, first = 0.0, second = 0.0;
  const Image truth = tracer(
                          lit, openBoxCamera(),
                          [&] {
                            PathTracer::Settings s = halves();
                            s.halves = false;
                            s.seed = 99;
                            return s;
                          }(),
                          2048)
                          .mean();
  for (std::size_t p = 0; p < count; ++p) {
    EXPECT_EQ(pixels[p].samples, 64u);
    EXPECT_EQ(pixels[p + count].samples, 64u);
    const glm::vec3 t = truth.at(static_cast<int>(p) % kSize.x, kSize.y - 1 - static_cast<int>(p) / kSize.x);
    const double a = static_cast<double>(pixels[p].mean.x - t.x),
                 b = static_cast<double>(pixels[p + count].mean.x - t.x);
    product += a * b, first += a * a, second += b * b;
  }
  // Uncorrelated: within 4 standard errors of a correlation of 600 pixels, and what the truth's own noise adds.
  EXPECT_LT(std::abs(product) / std::sqrt(first * second), 4.0 / std::sqrt(600.0) + 0.05);
  EXPECT_NEAR(first / second, 1.0, 0.3);
}

TEST_F(DenoiserGl, FeaturesAreThoseOfTheSurfacesSeen) {
  // A mirror at the left shows the red floor; an emitting plate at the right shines; between them there is nothing.
  SceneBuilder builder = inEnvironment(1.0f);
  const int red = builder.material({0.8f, 0.1f, 0.1f}), mirror = builder.material({0.0f, 0.0f, 0.0f}),
            lamp = builder.material({0.5f, 0.5f, 0.5f});
  builder.materialAt(mirror).bsdf = Bsdf::mirror;
  builder.materialAt(mirror).specular = glm::vec3(0.5f, 1.0f, 1.0f);
  builder.materialAt(lamp).emission = glm::vec3(2.0f);
  builder.plate({-2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, mirror);
  builder.plate({2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, lamp);
  builder.plate({0.0, 0.0, 20.0}, {0.0, 40.0, 0.0}, {40.0, 0.0, 0.0}, red);
  const Camera camera = lookingAt({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0}, 0.3);
  const PathTracer path = tracer(builder.scene(), camera, halves(), 2);
  Denoiser denoiser(library(), path);
  denoiser.denoise();
  const std::vector<glm::vec4> colours = denoiser.surfaceColours().readRgba(),
                               places = denoiser.surfacePlaces().readRgba();
  const auto at = [&](const std::vector<glm::vec4>& texels, double x) {  // place in the picture, at its middle row
    const double column = kSize.x / 2.0 + x / (2.0 * 10.0 * std::tan(0.15)) * kSize.y;
    return texels[static_cast<std::size_t>(kSize.y / 2 * kSize.x) + static_cast<std::size_t>(column)];
  };
  const glm::vec4 mirrored = at(colours, -2.0), shining = at(colours, 2.0), nothing = at(colours, 0.0);
  EXPECT_NEAR(mirrored.x, 0.4f, 1e-5);
  EXPECT_NEAR(mirrored.y, 0.1f, 1e-5);
  EXPECT_EQ(mirrored.w, 0.0f);
  EXPECT_NEAR(shining.x, 0.5f, 1e-5);
  EXPECT_NEAR(shining.w, 1.0f, 1e-6);
  EXPECT_EQ(nothing, glm::vec4(0.0f));
  EXPECT_NEAR(1.0 / at(places, 2.0).w, std::hypot(10.0, 2.0), 0.15);
  EXPECT_NEAR(1.0 / at(places, -2.0).w, 3.0 * std::hypot(10.0, 2.0), 0.45) << "to the mirror and on to the wall";
  EXPECT_NEAR(at(places, 2.0).z, 1.0f, 1e-5);
  EXPECT_NEAR(at(places, -2.0).z, -1.0f, 1e-5);
}

TEST_F(DenoiserGl, OffNothingOfItIsThere) {
  const Scene lit = scene();
  RenderSettings settings;
  settings.technique = "path";
  settings.size = kSize;
  settings.fullFloatTarget = true;
  settings.of<PathSettings>().samples = 8;
  std::array<std::size_t, 2> bytes{}, stages{};
  std::array<Image, 2> pictures;
  for (const std::size_t on : {std::size_t{0}, std::size_t{1}}) {
    settings.of<PathSettings>().denoise = on == 1;
    gl::ProgramLibrary own;
    Renderer renderer(context(), own, lit, settings);
    renderer.renderToTheEnd(openBoxCamera());
    renderer.drain();
    bytes[on] = renderer.gpuBytes();
    pictures[on] = renderer.readRadiance();
    for (const gl::StageStatistics& stage : renderer.timer().statistics()) stages[on] += stage.name == "denoising";
    const auto has = [&](const char* resource) {
      return std::any_of(own.programs().begin(), own.programs().end(), [&](const auto& program) {
        const auto names = program->activeResources();
        return std::find(names.begin(), names.end(), resource) != names.end();
      });
    };
    EXPECT_EQ(has("surfaceColours"), on == 1);
    EXPECT_EQ(has("terms0"), on == 1);
    EXPECT_EQ(pathFrameOf(renderer.technique())->denoisedSamples(), on == 1 ? 8u : 0u);
  }
  // 48 bytes of film, 32 of features, 160 of fits, 128 of terms and rows, 32 of results.
  EXPECT_EQ(bytes[1] - bytes[0] >= 400u * 600u, true);
  // Without it the picture has the bits of the path tracer's.
  PathTracer::Settings alone = halves();
  alone.halves = false;
  EXPECT_EQ(pictures[0].pixels, tracer(lit, openBoxCamera(), alone, 8).mean().pixels);
  // With it, those of the denoiser.
  const PathTracer path = tracer(lit, openBoxCamera(), halves(), 8);
  Denoiser denoiser(library(), path);
  denoiser.denoise();
  EXPECT_EQ(pictures[1].pixels, denoiser.picture().pixels);
}

TEST_F(DenoiserGl, AStoppedFilmOfHalvesGoesOnToTheSameBits) {
  const Scene lit = scene();
  PathTracer whole = tracer(lit, openBoxCamera(), halves(), 21), first = tracer(lit, openBoxCamera(), halves(), 7);
  PathTracer second = tracer(lit, openBoxCamera(), halves(), 1);
  second.resume(first.checkpoint(), "film");
  EXPECT_EQ(second.samples(), 7u);
  second.record(21);
  EXPECT_EQ(second.mean().pixels, whole.mean().pixels);
  EXPECT_EQ(second.checkpoint(), whole.checkpoint());
  PathTracer::Settings other = halves();
  other.halves = false;
  PathTracer single = tracer(lit, openBoxCamera(), other, 1);
  EXPECT_THROW(single.resume(first.checkpoint(), "film"), Error);
}

}  // namespace
}  // namespace lucerna::test
