// The path tracer as a machine: films, submissions, stopping, checkpoints, and agreement with forward shading.
// Statistical tests: seeds are fixed; 4 standard errors.
#include "support/long_tests.hpp"
#include "support/path_scenes.hpp"

#include "base/error.hpp"
#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string_view>

namespace lucerna::test {
namespace {

class PathTracerTest : public PathTest {
 protected:
  static Scene litBox() {
    Scene scene = openBox();
    scene.spots.push_back(
        {{2.0, 4.0, 3.0}, glm::normalize(glm::dvec3(-0.3, -1.0, -0.8)), glm::vec3(60.0f, 50.0f, 40.0f), 0.3, 0.6});
    scene.points.push_back({{-1.0, 1.0, 2.0}, glm::vec3(5.0f, 9.0f, 12.0f)});
    return scene;
  }
};

TEST_F(PathTracerTest, ThePictureDoesNotDependOnHowWorkIsCut) {
  Scene scene = litBox();
  scene.environment = Environment{};
  scene.environment->radiance = glm::vec3(0.3f);
  // Half of the groups at the lower edge of the second are beyond it; a half may gain no sample in a pass.
  for (const auto& [size, halves] : {std::pair(glm::ivec2(24), false), std::pair(glm::ivec2(24, 20), true)}) {
    PathTracer::Settings settings = sized(24);
    settings.size = size;
    settings.halves = halves;
    const Image whole = tracer(scene, openBoxCamera(), settings, 12).mean();
    settings.submissionSeconds = 1e-9;  // a segment a submission
    PathTracer cut(context(), library(), scene, settings);
    cut.setCamera(openBoxCamera());
    cut.record(4);
    cut.record(5);
    EXPECT_EQ(cut.statistics().fewestSamples, 5u);
    EXPECT_EQ(cut.statistics().mostSamples, 5u);
    cut.record(12);
    EXPECT_EQ(cut.mean().pixels, whole.pixels);
    settings.seed = 1;
    EXPECT_NE(tracer(scene, openBoxCamera(), settings, 12).mean().pixels, whole.pixels);
  }
}

TEST_F(PathTracerTest, NoSubmissionTakesMoreTurnsThanIsSafeHoweverEmptyThePictureIs) {
  // Three tiles of sky, one with a box in its midst: what the sky's clock says must not be granted to the box. Nothing
  // ever seems slow here.
  Scene scene = litBox();
  scene.environment = Environment{};
  scene.environment->radiance = glm::vec3(0.3f);
  PathTracer::Settings settings = sized(256);
  settings.submissionSeconds = 1000.0;
  PathTracer picture(context(), library(), scene, settings);
  Camera camera = lookingAt({0, 1, 60}, {7, -6, 0});
  picture.setCamera(camera);
  picture.record(24);
  const PathTracer::Submissions submissions = picture.submissions();
  const std::uint64_t lanes = capabilities().softwareRenderer ? 128u * 128u : 256u * 256u;
  // A tile's first: the share of each lane, 256 iterations, and one segment more; here some 200.
  std::printf("[ measured ] largest submission %.3g iterations; of those that begin a tile %.3g\n",
              static_cast<double>(submissions.largest), static_cast<double>(submissions.begun));
  EXPECT_GE(submissions.begun, lanes * 200);  // the box took its share
  EXPECT_LE(submissions.begun, lanes * 512);
  EXPECT_LE(static_cast<double>(submissions.largest), gl::kMostOverUnmeasured * gl::kUnmeasuredIterations);
  EXPECT_GT(submissions.largest, submissions.begun);
}

TEST_F(PathTracerTest, AResetOfTheGpuIsSaid) {
  PathTracer picture(context(), library(), litBox(), sized(16));
  picture.setCamera(openBoxCamera());
  const auto real = __glewGetGraphicsResetStatusARB;
  static GLenum status;
  __glewGetGraphicsResetStatusARB = [] { return status; };
  struct Case {
    GLenum status;
    int exitCode;
    const char* says;
  };
  for (const Case& c : {Case{GL_GUILTY_CONTEXT_RESET_ARB, 1, "of this program"},
                        Case{GL_INNOCENT_CONTEXT_RESET_ARB, 3, "of another program"},
                        Case{GL_UNKNOWN_CONTEXT_RESET_ARB, 3, "does not say"}}) {
    status = c.status;
    try {
      picture.advance(100);
      ADD_FAILURE() << c.says;
    } catch (const Error& error) {
      EXPECT_EQ(error.exitCode(), c.exitCode);
      EXPECT_NE(std::string_view(error.what()).find("reset the GPU"), std::string_view::npos) << error.what();
      EXPECT_NE(std::string_view(error.what()).find(c.says), std::string_view::npos) << error.what();
    }
  }
  __glewGetGraphicsResetStatusARB = real;
  EXPECT_TRUE(picture.advance(100));
}

TEST_F(PathTracerTest, AResumedPictureIsTheUninterruptedOne) {
  const Scene scene = litBox();
  const PathTracer::Settings settings = sized(24);
  const Image whole = tracer(scene, openBoxCamera(), settings, 9).mean();
  PathTracer first(context(), library(), scene, settings);
  first.setCamera(openBoxCamera());
  first.record(4);
  first.advance(9);  // some paths are under way: they are followed again
  const std::vector<std::uint8_t> bytes = first.checkpoint();
  PathTracer second(context(), library(), scene, settings);
  second.setCamera(openBoxCamera());
  second.resume(bytes, "memory");
  second.record(9);
  EXPECT_EQ(second.mean().pixels, whole.pixels);
  EXPECT_EQ(second.standardError().pixels, tracer(scene, openBoxCamera(), settings, 9).standardError().pixels);

  PathTracer other = tracer(scene, lookingAt({0, 0, 12}, {0, 0, 0}), settings, 1);
  EXPECT_THROW(other.resume(bytes, "memory"), Error);  // another view
  EXPECT_THROW(second.resume({bytes.begin(), bytes.end() - 1}, "memory"), Error);
  std::vector<std::uint8_t> damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  EXPECT_THROW(second.resume(damaged, "memory"), Error);
}

// Stopped anywhere, the film is that of whole passes: the paths that are under way then are the long ones, and must not
// be missing beside short ones that have ended.
TEST_F(PathTracerTest, AStoppedPictureIsOneOfWholePasses) {
  SceneBuilder room;  // a bright closed room: paths of very different lengths
  addBox(room, 1.0, room.material(glm::vec3(0.9f)), true);
  room.materialAt(0).emission = glm::vec3(1.0f);
  Scene scene = room.scene();
  scene.sun.reset();
  const Camera camera = lookingAt({0, 0, 0.9}, {0, 0, 0});
  constexpr int kSide = 132;  // four tiles
  PathTracer::Settings settings = sized(kSide);
  settings.submissionSeconds = 1e-9;  // a segment a submission: a pass takes many
  std::map<std::uint32_t, Image> whole;
  const auto afterPasses = [&](std::uint32_t samples) -> const Image& {
    Image& image = whole[samples];
    if (image.pixels.empty()) image = tracer(scene, camera, sized(kSide), samples).mean();
    return image;
  };
  int cut = 0;
  for (const int submissions : {150, 151, 160, 200, 290, 460}) {
    PathTracer stopped(context(), library(), scene, settings);
    stopped.setCamera(camera);
    for (int i = 0; i < submissions; ++i) stopped.advance(3);
    PathTracer resumed(context(), library(), scene, settings);
    resumed.setCamera(camera);
    resumed.resume(stopped.checkpoint(), "memory");
    const Image raw = stopped.mean();
    stopped.dropUnfinishedPass();
    const Image mean = stopped.mean();
    cut += raw.pixels != mean.pixels;
    EXPECT_EQ(resumed.mean().pixels, mean.pixels) << submissions;  // so is what a checkpoint holds
    const PathTracer::Statistics statistics = stopped.statistics();
    for (const glm::ivec2& tile : {glm::ivec2(0, 0), glm::ivec2(128, 0), glm::ivec2(0, 128), glm::ivec2(128, 128)}) {
      int samples = -1;  // that all pixels of the tile have
      for (int n = 0; n <= 3 && samples < 0; ++n) {
        bool same = true;
        for (int y = tile.y; y < std::min(tile.y + 128, kSide); ++y)
          for (int x = tile.x; x < std::min(tile.x + 128, kSide); ++x)
            same = same &&
                   mean.at(x, kSide - 1 - y) ==
                       (n == 0 ? glm::vec3(0.0f) : afterPasses(static_cast<std::uint32_t>(n)).at(x, kSide - 1 - y));
        if (same) samples = n;
      }
      EXPECT_GE(samples, 0) << submissions << ": tile " << tile.x << ", " << tile.y << " of "
                            << statistics.fewestSamples << " to " << statistics.mostSamples << " samples";
    }
    stopped.record(3);
    EXPECT_EQ(stopped.mean().pixels, afterPasses(3).pixels) << submissions;
  }
  EXPECT_GE(cut, 3);  // some were in the middle of a pass
}

// One lit texel, at an odd place beyond 2^24, where a float counts in twos. Looked at by its light on a floor.
TEST_F(PathTracerTest, EveryTexelOfALargeEnvironmentIsPicked) {
  SceneBuilder builder;
  builder.plate({0, 0, 0}, {0, 0, 10}, {10, 0, 0}, builder.material(glm::vec3(0.5f)));
  Scene scene = builder.scene();
  scene.sun.reset();
  constexpr int kWidth = 8192, kHeight = 2064;
  std::vector<glm::ivec2> texels{{4097, 700}, {kWidth - 1, kHeight - 8}};
  if (test::longTests()) texels.emplace_back(4097, 2055);
  for (const glm::ivec2& texel : texels) {
    scene.environment = Environment{glm::vec3(1.0f), Image(kWidth, kHeight), 0.0};
    scene.environment->picture->at(texel.x, texel.y) = glm::vec3(1e6f);
    const double pi = 3.14159265358979324, top = pi * texel.y / kHeight, bottom = pi * (texel.y + 1) / kHeight;
    // Irradiance on a plate that faces it from above or from below: the integral of cos over the texel.
    const double expected =
        0.5 / pi * 1e6 * 2.0 * pi / kWidth * 0.5 * std::abs(std::pow(std::sin(bottom), 2) - std::pow(std::sin(top), 2));
    const double side = 2 * texel.y < kHeight ? 1.0 : -1.0;
    Camera camera = lookingAt({0.0, 3.0 * side, 0.01}, {0, 0, 0}, 0.6);
    PathTracer::Settings settings = sized(4);
    settings.transport = Transport::direct;
    const PathTracer picture = tracer(scene, camera, settings, 4);
    EXPECT_NEAR(picture.statistics().mean.x / expected, 1.0, 1e-3) << texel.x << ", " << texel.y;
  }
}

// More than a raster picture draws.
TEST_F(PathTracerTest, EveryLampOfManyGivesItsLight) {
  Scene dark = openBox();
  dark.sun.reset();
  Scene all = dark;
  PathTracer::Settings settings = sized(16);
  settings.transport = Transport::direct;
  PathTracer::Statistics sum;
  for (int i = 0; i < 9; ++i) {
    Scene one = dark;
    const PointLight point{{i - 4.0, 3.0, 2.0 - 0.5 * i}, glm::vec3(2.0f + static_cast<float>(i))};
    const SpotLight spot{
        {4.0 - i, 4.0, 1.0}, glm::normalize(glm::dvec3(0.1 * i, -1.0, -0.5)), glm::vec3(9.0f), 0.4, 0.7};
    one.points.push_back(point), one.spots.push_back(spot);
    all.points.push_back(point), all.spots.push_back(spot);
    settings.seed = static_cast<std::uint32_t>(i + 1);
    const PathTracer::Statistics s = tracer(one, openBoxCamera(), settings, 64).statistics();
    sum.mean += s.mean;
    sum.meanError = glm::sqrt(sum.meanError * sum.meanError + s.meanError * s.meanError);
  }
  settings.seed = 0;
  EXPECT_LT(deviations(tracer(all, openBoxCamera(), settings, 256).statistics(), sum), 4.0);
}

TEST_F(PathTracerTest, SmallestPicturesAndScenes) {
  SceneBuilder empty;
  EXPECT_EQ(tracer(empty.scene(), lookingAt({0, 0, 1}, {0, 0, 0}), 1, 1).mean().pixels,
            std::vector<glm::vec3>{glm::vec3(0.0f)});
  empty.scene().background = {1.0f, 2.0f, 3.0f};
  const PathTracer background = tracer(empty.scene(), lookingAt({0, 0, 1}, {0, 0, 0}), 1, 3);
  EXPECT_EQ(background.mean().pixels, std::vector<glm::vec3>{glm::vec3(1.0f, 2.0f, 3.0f)});
  EXPECT_EQ(background.statistics().standardError, 0.0);
  Scene dark = openBox();
  dark.sun.reset();
  EXPECT_EQ(tracer(dark, openBoxCamera(), 4, 2).statistics().mean, glm::dvec3(0.0));
  EXPECT_EQ(tracer(openBox(), openBoxCamera(), 3, 1).statistics().standardError,
            std::numeric_limits<double>::infinity());
  Camera far = openBoxCamera(1e6);
  for (const glm::vec3& p : tracer(openBox(1e6), far, 8, 2).mean().pixels) EXPECT_TRUE(std::isfinite(p.x));
}

TEST_F(PathTracerTest, TheErrorFallsWithTheRootOfTheSamplesAndIsHonest) {
  const Scene scene = litBox();
  PathTracer::Settings settings = sized(24);
  settings.filter = PixelFilter::centre;
  const PathTracer reference = tracer(scene, openBoxCamera(), settings, 1024);
  const Image exact = reference.mean();
  settings.seed = 9;
  PathTracer picture(context(), library(), scene, settings);
  picture.setCamera(openBoxCamera());
  double last = 0.0;
  for (const std::uint32_t samples : {16u, 64u, 256u}) {
    picture.record(samples);
    const double error = picture.statistics().standardError;
    if (last > 0.0) { EXPECT_NEAR(last / error, 2.0, 0.3) << samples; }
    last = error;
    const Image mean = picture.mean();
    double sum = 0.0;
    for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
      const glm::dvec3 d = glm::dvec3(mean.pixels[i]) - glm::dvec3(exact.pixels[i]);
      sum += glm::dot(d, d) / (3.0 * static_cast<double>(mean.pixels.size()));
    }
    const double expected = std::hypot(error, reference.statistics().standardError);
    // Low-discrepancy points make the true error smaller than independent samples would, never larger.
    EXPECT_LT(std::sqrt(sum), 1.1 * expected) << samples;
    EXPECT_GT(std::sqrt(sum), 0.3 * expected) << samples;
  }
}

// In a closed box that emits 1 and reflects a, a path brings 1 + a + a^2 ... up to a weight of a^k below 1/4. From
// there it goes on with a weight of 1/4: first with probability 4 a^k, then each time with a, since throughput is a/4.
// The number of those hits is geometric. Roulette from a weight of 1 on has 3.7 times this deviation.
TEST_F(PathTracerTest, RouletteBringsNoMoreNoiseThanFromAQuarterOn) {
  constexpr double kA = 0.7, kFirst = 4.0 * kA * kA * kA * kA;  // below 1/4 after four scatterings
  SceneBuilder builder;
  builder.scene().sun.reset();
  const int material = builder.material(glm::vec3(0.7f));
  builder.materialAt(material).emission = glm::vec3(1.0f);
  addBox(builder, 1.0, material, true);
  PathTracer::Settings settings = sized(8);
  settings.nextEvent = false;
  constexpr std::uint32_t kSamples = 4096;
  const auto s = tracer(builder.scene(), lookingAt({0.0, 0.0, 0.0}, {0.3, 0.2, 1.0}), settings, kSamples).statistics();
  EXPECT_LT(deviations(s, glm::dvec3(1.0 / (1.0 - kA))), 4.0);
  const double squares = kA / std::pow(1.0 - kA, 2.0) + std::pow(1.0 - kA, -2.0), mean = kFirst / (1.0 - kA),
               expected = 0.25 * std::sqrt(kFirst * squares - mean * mean);
  EXPECT_NEAR(s.standardError * std::sqrt(double{kSamples}) / expected, 1.0, 0.02);
}

TEST_F(PathTracerTest, ComponentsAddUp) {
  const Scene scene = litBox();
  PathTracer::Settings settings = sized(32);
  const auto result = [&](Transport transport, std::uint32_t bounces = PathTracer::kUnlimited) {
    settings.transport = transport;
    settings.bounces = bounces;
    ++settings.seed;
    return tracer(scene, openBoxCamera(), settings, 64).statistics();
  };
  const auto all = result(Transport::all), direct = result(Transport::direct), indirect = result(Transport::indirect);
  PathTracer::Statistics sum = direct;
  sum.mean += indirect.mean;
  sum.meanError = glm::sqrt(direct.meanError * direct.meanError + indirect.meanError * indirect.meanError);
  EXPECT_LT(deviations(all, sum), 4.0);
  EXPECT_LT(deviations(result(Transport::indirect, 2), result(Transport::oneBounce)), 4.0);
  EXPECT_LT(deviations(result(Transport::all, 1), direct), 4.0);
  EXPECT_GT(indirect.mean.x, 1.2 * result(Transport::oneBounce).mean.x);
}

// Units: the direct light of forward shading is the path tracer's, but for the filtered edges of shadows. (Surfaces
// that shine light others in the path tracer alone.)
TEST_F(PathTracerTest, DirectLightIsThatOfForwardShading) {
  Scene scene = litBox();
  scene.background = {0.1f, 0.2f, 0.3f};
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 16; ++i) texels.insert(texels.end(), {200, 120, 60, 255});
  Texture& texture = scene.textures.emplace_back();
  texture.bitmap = {4, 4, texels, false};
  scene.materials[0].diffuseTexture = 0;
  const Camera camera = openBoxCamera();
  constexpr int kSize = 64;
  RenderSettings forward;
  forward.technique = "direct";
  forward.size = glm::ivec2(kSize);
  forward.fullFloatTarget = true;
  Renderer renderer(context(), library(), scene, forward);
  renderer.render(camera);
  const Image raster = renderer.readRadiance();
  PathTracer::Settings settings = sized(kSize);
  settings.transport = Transport::direct;
  settings.filter = PixelFilter::centre;
  const PathTracer path = tracer(scene, camera, settings, 192);
  const Image traced = path.mean(), error = path.standardError();
  int off = 0;
  double rasterSum = 0.0, tracedSum = 0.0;
  for (std::size_t i = 0; i < traced.pixels.size(); ++i) {
    bool isOff = false;
    for (int c = 0; c < 3; ++c)
      isOff |= std::abs(traced.pixels[i][c] - raster.pixels[i][c]) >
               5.0f * error.pixels[i][c] + 0.004f * raster.pixels[i][c] + 1e-5f;
    off += isOff ? 1 : 0;
    rasterSum += raster.pixels[i].y;
    tracedSum += traced.pixels[i].y;
  }
  EXPECT_LT(off, kSize * kSize / 20);
  EXPECT_NEAR(tracedSum / rasterSum, 1.0, 0.01);
}

// Each kind of lamp by itself, on Lambert's surfaces with a pillar and a shelf that cast shadows: the mean to 1 %, and
// where neither picture has a border of a shadow, pixel by pixel.
TEST_F(PathTracerTest, DirectLightOfEachKindOfLampIsThatOfForwardShading) {
  for (const char* kind : {"sun", "spot", "point"}) {
    Scene scene = openBox();
    SceneBuilder builder;
    builder.scene() = scene;
    builder.plate({-1.0, -3.0, 0.0}, {0, 0, 1.5}, {0, 4, 0}, 0);
    builder.plate({1.5, 0.5, -1.0}, {2, 0, 0}, {0, 0, 2}, 0);
    scene = builder.scene();
    if (kind != std::string_view("sun")) scene.sun.reset();
    if (kind == std::string_view("spot"))
      scene.spots.push_back(
          {{2.0, 4.0, 3.0}, glm::normalize(glm::dvec3(-0.3, -1.0, -0.8)), glm::vec3(60.0f, 50.0f, 40.0f), 0.3, 0.6});
    if (kind == std::string_view("point")) scene.points.push_back({{-1.0, 1.0, 2.0}, glm::vec3(5.0f, 9.0f, 12.0f)});
    constexpr int kSize = 96;
    RenderSettings forward;
    forward.technique = "direct";
    forward.size = glm::ivec2(kSize);
    forward.fullFloatTarget = true;
    Renderer renderer(context(), library(), scene, forward);
    renderer.render(openBoxCamera());
    const Image raster = renderer.readRadiance();
    PathTracer::Settings settings = sized(kSize);
    settings.transport = Transport::direct;
    settings.diffuseOnly = true;
    settings.filter = PixelFilter::centre;
    const Image traced = tracer(scene, openBoxCamera(), settings, 16).mean();
    double rasterSum = 0.0, tracedSum = 0.0;
    int off = 0;
    for (std::size_t i = 0; i < traced.pixels.size(); ++i) {
      rasterSum += raster.pixels[i].y;
      tracedSum += traced.pixels[i].y;
      off += std::abs(traced.pixels[i].y - raster.pixels[i].y) > 1e-3f * traced.pixels[i].y + 1e-6f;
    }
    std::printf("%-6s forward over path traced %.5f, %d of %d pixels off by 0.1 %%\n", kind, rasterSum / tracedSum, off,
                kSize * kSize);
    EXPECT_GT(tracedSum, 0.0);
    EXPECT_NEAR(rasterSum / tracedSum, 1.0, 0.01) << kind;
    EXPECT_LT(off, kSize * kSize / 25) << kind;
  }
}

TEST_F(PathTracerTest, MasksAndBoundariesLetLightThrough) {
  // A plate wholly cut out, and one that is a boundary of nothing, above the floor: as if they were not there.
  const auto make = [](bool plates) {
    SceneBuilder builder;
    builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, builder.material(glm::vec3(0.5f)));
    const int lamp = builder.material(glm::vec3(0.0f));
    builder.materialAt(lamp).emission = glm::vec3(3.0f);
    builder.plate({0, 2, 0}, {1, 0, 0}, {0, 0, 1}, lamp);
    const int masked = builder.material(glm::vec3(0.9f)), boundary = builder.material(glm::vec3(0.0f));
    builder.materialAt(masked).diffuseTexture = builder.texture(1, 1, {255, 255, 255, 0}, true);
    builder.materialAt(masked).alphaMasked = true;
    builder.materialAt(boundary).bsdf = Bsdf::none;
    if (plates) builder.plate({0, 1.2, 0}, {0, 0, 3}, {3, 0, 0}, masked);
    if (plates) builder.plate({0, 0.6, 0}, {0, 0, 3}, {3, 0, 0}, boundary);
    return builder;
  };
  const Camera camera = lookingAt({0.5, 1.7, 2.0}, {0, 0.2, 0});
  SceneBuilder with = make(true), without = make(false);
  PathTracer::Settings settings = sized(24);
  const auto a = tracer(with.scene(), camera, settings, 32).statistics();
  settings.seed = 1;
  const auto b = tracer(without.scene(), camera, settings, 32).statistics();
  EXPECT_LT(deviations(a, b), 4.0);
  EXPECT_GT(a.mean.x, 0.1);
}

}  // namespace
}  // namespace lucerna::test
