// Scenes that move, in every technique: a renderer that follows the scene draws what a new one would, whatever it has
// drawn before; lights and surfaces are where the time says.
#include "base/angles.hpp"
#include "base/data.hpp"
#include "gl/pass.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"
#include "render/techniques.hpp"
#include "scene/motion.hpp"
#include "shared/bindings.h"
#include "shared/irradiance_cache.h"
#include "support/gl_fixture.hpp"
#include "support/temp_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

namespace lucerna {
namespace {

constexpr int kPixels = 24;

class MotionGl : public test::GlTest {
 protected:
  static RenderSettings settingsOf(std::string_view technique, ShadowTransport shadows = ShadowTransport::map) {
    RenderSettings settings;
    settings.technique = technique;
    settings.size = {kPixels, kPixels};
    settings.fullFloatTarget = true;
    settings.shadows = shadows;
    // Two solutions from two starts differ by twice this.
    settings.of<RadiosityView::Settings>().solution.error = 1e-5;
    return settings;
  }
  Image anew(const Scene& scene, const RenderSettings& settings) {
    Renderer renderer(context(), programs(), scene, settings);
    renderer.renderToTheEnd(scene.cameras.front());
    return renderer.readRadiance();
  }
  /// Draws at other times first.
  Image followed(Scene& scene, const RenderSettings& settings, double seconds) {
    auto renderer = std::make_unique<Renderer>(context(), programs(), scene, settings);
    for (const double t : {0.0, seconds + 3.0, seconds}) {
      if (!renderer->follow(context(), programs(), scene, poseAt(scene, t)))
        renderer = std::make_unique<Renderer>(context(), programs(), scene, settings);
      renderer->renderToTheEnd(scene.cameras.front());
    }
    return renderer->readRadiance();
  }
  /// Of all light.
  static double wrongShare(const Image& found, const Image& right) {
    double wrong = 0.0, whole = 0.0;
    for (std::size_t i = 0; i < right.pixels.size(); ++i) {
      wrong += glm::distance(found.pixels[i], right.pixels[i]);
      whole += glm::length(right.pixels[i]);
    }
    return wrong / whole;
  }
  static double largestDifference(const Image& a, const Image& b) {
    double worst = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c)
        worst =
            std::max(worst, static_cast<double>(std::abs(a.pixels[i][c] - b.pixels[i][c])) / (1.0 + b.pixels[i][c]));
    return worst;
  }
};

TEST_F(MotionGl, FollowingDrawsWhatANewRendererDraws) {
  const auto file = *findDataFolder() / "assets/cornell/moving.json";
  for (const TechniqueEntry& technique : allTechniques())
    for (const ShadowTransport shadows : {ShadowTransport::map, ShadowTransport::rays}) {
      if (shadows == ShadowTransport::rays && technique.name != "direct") continue;
      const RenderSettings settings = settingsOf(technique.name, shadows);
      Scene scene = loadScene(file), still = loadScene(file, 2.5);
      const Image right = anew(still, settings), found = followed(scene, settings, 2.5);
      EXPECT_LT(largestDifference(found, right), 2e-4) << technique.name;
      EXPECT_GT(largestDifference(found, anew(loadScene(file), settings)), 0.1) << technique.name;
    }
}

TEST_F(MotionGl, SceneFarFromTheOriginFollowsToo) {
  const test::TempFolder folder;
  folder.write("m.obj",
               "o floor\nv 4096 0 0\nv 4098 0 0\nv 4098 0 2\nv 4096 0 2\nvn 0 1 0\nf 4//1 3//1 2//1 1//1\n"
               "o card\nv 4096.5 1 0.5\nv 4097.5 1 0.5\nv 4097.5 1 1.5\nv 4096.5 1 1.5\nf 8//1 7//1 6//1 5//1\n");
  const auto file = folder.write("s.json", R"({"model": "m.obj", "environment": null,
      "camera": {"position": [4097, 3, 1], "direction": [0, -1, 0], "up": [0, 0, -1], "fov": 40},
      "sun": {"direction": {"times": [0, 1], "values": [[0, -1, 0], [0.5, -1, 0]]}, "irradiance": [3, 3, 3]},
      "objects": {"card": {"translation": {"times": [0, 1], "values": [[0, 0, 0], [-0.9, -0.4, 0.3]]}}}})");
  Scene scene = loadScene(file), still = loadScene(file, 0.75);
  EXPECT_LT(largestDifference(followed(scene, settingsOf("direct"), 0.75), anew(still, settingsOf("direct"))), 1e-5);
}

TEST_F(MotionGl, TheBackgroundFollowsToo) {
  const test::TempFolder folder;
  folder.write("m.obj", "v 0 0 -1\nv 0.1 0 -1\nv 0 0.1 -1\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  const auto file = folder.write("s.json", R"({"model": "m.obj", "environment": null, "sun": null,
      "points": [{"position": [0, 0, 1], "intensity": [1, 1, 1]}],
      "camera": {"position": [0, 0, 1], "direction": [0, 0, -1], "fov": 60},
      "background": {"times": [0, 1], "values": [[1, 1, 1], [1, 3, 5]]}})");
  for (const char* technique : {"direct", "path"}) {
    Scene scene = loadScene(file);
    const Image found = followed(scene, settingsOf(technique), 0.5);
    EXPECT_LT(glm::distance(found.at(1, 1), glm::vec3(1, 2, 3)), 1e-3f) << technique;
  }
}

// A lamp above a white floor: radiance albedo / pi * I h / d^3 beneath it, moved and dimmed by curves.
TEST_F(MotionGl, ALampLightsFromWhereItIsThen) {
  const test::TempFolder folder;
  folder.write("m.obj",
               "mtllib m.mtl\nusemtl white\nv -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nvn 0 1 0\nf 4//1 3//1 2//1 1//1\n");
  folder.write("m.mtl", "newmtl white\nKd 1 1 1\n");
  const auto file = folder.write("s.json", R"({"model": "m.obj", "environment": null, "sun": null,
      "camera": {"position": [0, 5, 0], "direction": [0, -1, 0], "up": [0, 0, -1], "fov": 0.1},
      "points": [{"position": {"times": [0, 4], "values": [[0, 1, 0], [4, 1, 0]]},
                  "intensity": {"times": [0, 4], "values": [[1, 1, 1], [5, 5, 5]]}}]})");
  for (const char* technique : {"direct", "irradiance-cache", "path"}) {
    Scene scene = loadScene(file);
    for (const double t : {1.0, 3.0}) {
      const double right = (1.0 + t) / (std::pow(1.0 + t * t, 1.5) * 3.14159265358979);
      EXPECT_NEAR(followed(scene, settingsOf(technique), t).at(kPixels / 2, kPixels / 2).x, right, 1e-3 * right)
          << technique << t;
    }
  }
}

// Frame by frame, as in the window: records stay in their places, and what they show is not that of the time before.
TEST_F(MotionGl, LiveFramesShowTheLightOfTheirTime) {
  const test::TempFolder folder;
  folder.write("m.obj",
               "mtllib m.mtl\nusemtl white\no floor\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nvn 0 1 0\n"
               "f 4//1 3//1 2//1 1//1\no card\nv -1.9 0.02 -1\nv -0.4 0.02 -1\nv -0.4 0.02 1\nv -1.9 0.02 1\n"
               "f 8//1 7//1 6//1 5//1\nusemtl lamp\no lamp\nv -2 3 -2\nv 2 3 -2\nv 2 3 2\nv -2 3 2\nvn 0 -1 0\n"
               "f 9//2 10//2 11//2 12//2\n");
  folder.write("m.mtl", "newmtl white\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n");
  const auto file = folder.write("s.json", R"({"model": "m.obj", "environment": null, "sun": null,
      "camera": {"position": [0, 2.9, 0], "direction": [0, -1, 0], "up": [0, 0, -1], "fov": 60},
      "materials": {"lamp": {"emission": {"times": [0, 1], "values": [[1, 1, 1], [9, 3, 1]]}}},
      "objects": {"card": {"translation": {"times": [0, 1], "values": [[0, 0, 0], [2.3, 0, 0]]}}}})");
  const RenderSettings settings = settingsOf("irradiance-cache");
  Scene scene = loadScene(file);
  Renderer live(context(), programs(), scene, settings);
  live.renderToTheEnd(scene.cameras.front());
  Image before = live.readRadiance();
  for (const double t : {0.25, 0.5, 0.75, 1.0}) {
    ASSERT_TRUE(live.follow(context(), programs(), scene, poseAt(scene, t)));
    live.render(scene.cameras.front());
    const Image found = live.readRadiance(), right = anew(loadScene(file, t), settings);
    EXPECT_LT(wrongShare(found, right), 0.04) << t;
    EXPECT_GT(wrongShare(before, right), 0.2) << t;
    before = right;
  }
}

// The camera jumps in the frame in which the light changes: records that it still sees are lit anew as well.
TEST_F(MotionGl, ALiveFrameAfterACutShowsTheLightOfItsTime) {
  const test::TempFolder folder;
  folder.write("m.obj",
               "mtllib m.mtl\nusemtl white\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nvn 0 1 0\nf 4//1 3//1 2//1 1//1\n"
               "usemtl lamp\nv -2 3 -2\nv 2 3 -2\nv 2 3 2\nv -2 3 2\nvn 0 -1 0\nf 5//2 6//2 7//2 8//2\n");
  folder.write("m.mtl", "newmtl white\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n");
  const auto file = folder.write("s.json", R"({"model": "m.obj", "environment": null, "sun": null,
      "camera": {"position": [-1, 2.9, 0], "direction": [0, -1, 0], "up": [0, 0, -1], "fov": 60},
      "materials": {"lamp": {"emission": {"times": [0, 1], "values": [[1, 1, 1], [9, 3, 1]]}}}})");
  const RenderSettings settings = settingsOf("irradiance-cache");
  Scene scene = loadScene(file), still = loadScene(file, 1.0);
  Renderer live(context(), programs(), scene, settings);
  live.renderToTheEnd(scene.cameras.front());
  Camera camera = scene.cameras.front();
  camera.position.x = 1.0;
  still.cameras.front() = camera;
  ASSERT_TRUE(live.follow(context(), programs(), scene, poseAt(scene, 1.0)));
  live.render(camera);
  const Image found = live.readRadiance(), right = anew(still, settings);
  EXPECT_LT(wrongShare(found, right), 0.04);
}

// A closed room of 2 units with an emissive ceiling, a lamp that moves, and a card that moves by the last key.
class KeptHitsGl : public MotionGl {
 protected:
  /// The card's half size and its height; strengths of ceiling and lamp.
  std::filesystem::path room(double half, double height, double emission, double intensity) {
    std::string model = "mtllib m.mtl\n";
    for (int k = 0; k < 8; ++k) model += fmt::format("v {} {} {}\n", k & 1 ? 1 : -1, k & 2 ? 2 : 0, k & 4 ? 1 : -1);
    for (int k = 0; k < 4; ++k)
      model += fmt::format("v {} {} {}\n", k == 1 || k == 2 ? half : -half, height, k < 2 ? -half : half);
    folder_.write("m.obj", model +
                               "usemtl white\no room\nf 5 6 2 1\nf 1 2 4 3\nf 5 7 8 6\nf 1 3 7 5\nf 2 6 8 4\n"
                               "usemtl lamp\no ceiling\nf 3 4 8 7\nusemtl white\no card\nf 12 11 10 9\n");
    folder_.write("m.mtl",
                  fmt::format("newmtl white\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe {0} {0} {0}\n", emission));
    const std::string lamp = fmt::format(R"("intensity": [{0}, {0}, {0}])", intensity);
    return folder_.write("s.json", R"({"model": "m.obj", "environment": null, "sun": null,
        "camera": {"position": [0, 1, 0.9], "direction": [0, -0.2, -1], "up": [0, 1, 0], "fov": 90},
        "points": [{"position": {"times": [0, 8], "values": [[-0.5, 1, 0], [0.5, 1, 0]]}, )" +
                                       lamp + R"(}],
        "objects": {"card": {"translation": {"times": [0, 8, 9], "values": [[0, 0, 0], [0, 0, 0], [0, 0, 0.45]]}}}})");
  }
  RenderSettings settings() const {
    RenderSettings result = settingsOf("irradiance-cache");
    result.of<IrradianceCacheSettings>().cascades.cells = 8;
    return result;
  }
  /// Draws one frame at a time and returns how many paths were traced again.
  std::uint64_t tracedAt(Renderer& live, Scene& scene, double seconds) {
    EXPECT_TRUE(live.follow(context(), programs(), scene, poseAt(scene, seconds)));
    live.render(scene.cameras.front());
    live.drain();
    return cacheOf(live.technique())->counts().traced;
  }
  test::TempFolder folder_;
};

TEST_F(KeptHitsGl, RelightRecordsWhereALampAloneMoves) {
  const auto file = room(0.1, 0.3, 0.2, 1.0);
  Scene scene = loadScene(file);
  Renderer live(context(), programs(), scene, settings());
  live.renderToTheEnd(scene.cameras.front());
  const Image before = live.readRadiance();
  EXPECT_GT(tracedAt(live, scene, 1.0), 0u);
  for (const double t : {1.5, 2.0, 2.5, 3.0, 4.0, 5.0}) tracedAt(live, scene, t);
  for (const double t : {6.0, 7.0}) {
    EXPECT_EQ(tracedAt(live, scene, t), 0u) << t;  // a record stands for all that paths hit
    const Image found = live.readRadiance(), right = anew(loadScene(file, t), settings());
    EXPECT_LT(wrongShare(found, right), 0.04) << t;
    EXPECT_GT(wrongShare(before, right), 0.2) << t;
  }
}

// As right as records whose paths are all traced in each frame.
TEST_F(KeptHitsGl, AreTracedAgainWhereTheyMeetWhatMoves) {
  const auto file = room(0.2, 1.0, 1.0, 0.02);
  Scene scene = loadScene(file), other = loadScene(file);
  RenderSettings kept = settings();
  kept.of<IrradianceCacheSettings>().cascades.cells = 24;
  RenderSettings traced = kept;
  traced.of<IrradianceCacheSettings>().keepsHits = false;
  Renderer live(context(), programs(), scene, kept), anewEachFrame(context(), programs(), other, traced);
  live.renderToTheEnd(scene.cameras.front());
  anewEachFrame.renderToTheEnd(other.cameras.front());
  for (const double t : {7.0, 7.2, 7.4, 7.6, 7.8, 8.0}) tracedAt(live, scene, t), tracedAt(anewEachFrame, other, t);
  ASSERT_EQ(cacheOf(live.technique())->counts().traced, 0u);
  for (const double t : {8.3, 8.6, 9.0}) {
    const std::uint64_t again = tracedAt(live, scene, t),
                        all = cacheOf(live.technique())->counts().records * CACHE_HITS;
    EXPECT_GT(again, all / 40) << t;  // those of new records alone are a third of that
    EXPECT_LT(again, all / 10) << t;
    tracedAt(anewEachFrame, other, t);
    const Image right = anew(loadScene(file, t), kept);
    const double error = wrongShare(live.readRadiance(), right);
    EXPECT_LT(error, 1.25 * wrongShare(anewEachFrame.readRadiance(), right)) << t;
  }
}

TEST_F(KeptHitsGl, WaitWhereTheBudgetIsSpent) {
  const auto file = room(0.5, 1.6, 1.0, 0.02);
  Scene scene = loadScene(file);
  RenderSettings budget = settings();
  budget.of<IrradianceCacheSettings>().tracedPaths = 100;
  Renderer live(context(), programs(), scene, budget);
  live.renderToTheEnd(scene.cameras.front());
  /// Frames in which the lamp alone moves, until no path waits.
  const auto framesToRest = [&](double seconds) {
    int frames = 0;
    do
      (*scene.motion)[SceneMotion::Part::points] = [frames](Scene& posed, double) {
        posed.points[0].position.x = frames % 2 == 0 ? 0.4 : 0.5;
      };
    while (tracedAt(live, scene, seconds) > 0 && ++frames < 200);
    return frames;
  };
  EXPECT_LT(framesToRest(7.9), 200);
  const std::uint64_t listed = tracedAt(live, scene, 9.0);  // the card moves
  (*scene.motion)[SceneMotion::Part::points] = [](Scene& posed, double) { posed.points[0].position.x = 0.3; };
  const std::uint64_t waiting = tracedAt(live, scene, 9.0);
  ASSERT_GT(waiting, listed / 2);
  const int frames = framesToRest(9.0);
  EXPECT_GT(frames, static_cast<int>(waiting / 200));
  EXPECT_LT(frames, 200);
}

// Light that goes out, after which all rests: light of further bounces goes too, in a second's frames.
TEST_F(KeptHitsGl, LightThatGoesOutLeavesNoneBehind) {
  struct Case {
    const char* name;
    bool isLamp, keepsHits;
  };
  for (const Case& c :
       {Case{"lamp", true, true}, Case{"lamp, all traced anew", true, false}, Case{"emission", false, true}}) {
    Scene scene = loadScene(room(0.1, 0.3, c.isLamp ? 0.02 : 2.0, c.isLamp ? 2.0 : 0.05));
    const auto set = [&](float factor) {
      if (c.isLamp) scene.points[0].intensity = glm::vec3(2.0f * factor);
      else
        for (Material& material : scene.materials)
          if (material.name == "lamp") material.emission = glm::vec3(2.0f * factor);
    };
    RenderSettings s = settings();
    s.of<IrradianceCacheSettings>().keepsHits = c.keepsHits;
    Renderer live(context(), programs(), scene, s);
    live.renderToTheEnd(scene.cameras.front());
    SceneChange change;
    (c.isLamp ? change.lamps : change.materials) = true;
    set(0.1f);
    ASSERT_TRUE(live.follow(context(), programs(), scene, change));
    int frames = 0;
    for (; frames == 0 || (cacheOf(live.technique())->settles() && frames < 100); ++frames)
      live.render(scene.cameras.front());
    EXPECT_LT(frames, 60) << c.name;
    const Image found = live.readRadiance(), right = anew(scene, s);
    EXPECT_LT(wrongShare(found, right), 0.08) << c.name << ", " << frames << " frames";
  }
}

// Where surfaces begin to move, records are dropped, and paths make others under the same numbers.
TEST_F(KeptHitsGl, RecordsThatPathsMakeHaveNoLightOfOlderOnes) {
  Scene scene = loadScene(room(0.5, 1.0, 0.02, 2.0));
  RenderSettings s = settings();
  s.of<IrradianceCacheSettings>().cascades.cells = 16;
  Renderer live(context(), programs(), scene, s);
  live.renderToTheEnd(scene.cameras.front());
  for (const double t : {1.0, 2.0, 3.0, 4.0}) tracedAt(live, scene, t);  // the lamp alone
  (*scene.motion)[SceneMotion::Part::points] = [](Scene& posed, double) {
    posed.points[0].intensity = glm::vec3(0.1f);
  };
  for (int frame = 0; frame < 20; ++frame) tracedAt(live, scene, 8.0 + 0.05 * frame);
  EXPECT_LT(wrongShare(live.readRadiance(), anew(scene, s)), 0.04);
}

struct KeptColour : test::SharedProgramsTest {};

// Against the formula of EXT_texture_shared_exponent (OpenGL 4.3, 8.5.2) in double precision, for the whole range of
// exponents, colours of one channel, and those that round up to the next exponent.
TEST_F(KeptColour, IsPackedAsASharedExponentTexel) {
  std::vector<glm::vec4> colours{{0, 0, 0, 0}, {65408, 1, 0, 0}, {1e6f, 1e6f, 3, 0}, {511.5f, 0.4f, 255, 0}};
  for (int exponent = -30; exponent <= 17; ++exponent)
    for (const float share : {1.0f, 1.37f, 1.997f, 1.9999f}) {
      const float largest = std::ldexp(share, exponent);
      colours.insert(colours.end(),
                     {{largest, 0.31f * largest, 0.0f, 0.0f}, {0.01f * largest, 0.6f * largest, largest, 0.0f}});
    }
  const gl::Buffer in("colours", colours.size() * sizeof(glm::vec4), colours.data(), gl::Usage::staticDraw),
      out("packed", colours.size() * sizeof(glm::vec4), nullptr, gl::Usage::dynamicRead);
  const gl::Program& program = library().loadCompute("kept colour probe", "irradiance_cache/kept_probe.comp", {});
  in.bindStorage(0);
  out.bindStorage(1);
  {
    const gl::ComputePass pass("probe");
    program.use();
    pass.dispatch({static_cast<int>(colours.size()), 1, 1}, {64, 1, 1});
  }
  const std::vector<glm::vec4> found = out.read<glm::vec4>();
  for (std::size_t i = 0; i < colours.size(); ++i) {
    constexpr int kBias = 15, kBits = 9;
    const glm::dvec3 c = glm::min(glm::dvec3(colours[i]), glm::dvec3(65408.0));
    const double largest = std::max({c.x, c.y, c.z});
    int exponent =
        std::max(-kBias - 1, largest > 0.0 ? static_cast<int>(std::floor(std::log2(largest))) : -100) + 1 + kBias;
    if (std::floor(largest / std::exp2(exponent - kBias - kBits) + 0.5) == 512.0) ++exponent;
    const double step = std::exp2(exponent - kBias - kBits);
    auto word = static_cast<std::uint32_t>(exponent) << 27;
    for (int k = 0; k < 3; ++k) {
      const double steps = std::floor(c[k] / step + 0.5);
      EXPECT_EQ(static_cast<double>(found[i][k]), steps * step) << i;
      word |= static_cast<std::uint32_t>(steps) << kBits * k;
    }
    EXPECT_EQ(std::bit_cast<std::uint32_t>(found[i].w), word) << i;
  }
}

struct Relight : test::SharedProgramsTest {};

// A record's irradiance from what its paths have hit, against the sum in double precision: pi times the mean of
// reflectance / pi times the irradiance of what stands for the hit, and of the path's other light. Slots may be empty,
// or hold a record that found no room.
TEST_F(Relight, SumsWhatPathsHaveHit) {
  constexpr std::size_t kRecords = 5, kWithoutHits = 2, kSlots = 40, kWordsOfWork = 64, kWanted = 3;
  std::mt19937 words(11);
  const auto random = [&] { return static_cast<std::uint32_t>(words()); };
  std::uniform_real_distribution<float> strength(0.0f, 3.0f);
  const auto colour = [&] { return glm::vec3(strength(words), strength(words), strength(words)); };
  std::vector<shared::CacheRecord> records(kRecords);
  for (std::size_t r = 0; r < kRecords; ++r) {
    records[r].state = r == kWithoutHits ? CACHE_FRONT : CACHE_FRONT | CACHE_KEPT;
    records[r].irradiance = glm::vec3(-1.0f);
  }
  std::vector<std::uint32_t> slots(kSlots);
  for (std::uint32_t& slot : slots)
    slot = random() % (static_cast<std::uint32_t>(kRecords) + 3);  // 0: empty; beyond the records: no room
  std::vector<glm::vec4> light(kRecords + 2);
  for (glm::vec4& of : light) of = glm::vec4(colour(), 1.0f);
  std::vector<shared::CacheHit> hits(kRecords * CACHE_HITS);
  const auto packed = [&] { return (random() % 6 + 14) << 27 | (random() & 0x7ffffffu); };  // steps of 2^-10 to 2^-5
  for (shared::CacheHit& hit : hits)
    hit = {random() % (static_cast<std::uint32_t>(kSlots) + 1) | (random() % 3 == 0 ? CACHE_STALE : 0u), packed(),
           packed(), 1.0f};
  std::vector<std::uint32_t> work(kWordsOfWork);
  work[kWanted] = kRecords;
  shared::CascadeConstants grids{};
  grids.referenceIrradiance = 7.3f;
  shared::CacheConstants constants{};
  constants.capacity = kRecords;

  gl::Buffer recordBuffer("records", records.size() * sizeof records[0], records.data(), gl::Usage::dynamicRead);
  const auto bufferOf = [](const auto& values) {
    return gl::Buffer("values", values.size() * sizeof values[0], values.data(), gl::Usage::staticDraw);
  };
  const gl::Buffer hitBuffer = bufferOf(hits), workBuffer = bufferOf(work);
  const gl::Buffer gridBuffer("grids", sizeof grids, &grids, gl::Usage::staticDraw),
      constantsBuffer("constants", sizeof constants, &constants, gl::Usage::staticDraw);
  const gl::BufferTexture slotTable("slots", gl::Format::r32ui, slots.size() * sizeof slots[0], slots.data()),
      lights("light", gl::Format::rgba32f, light.size() * sizeof light[0], light.data());
  recordBuffer.bindStorage(CACHE_RECORDS_BUFFER);
  hitBuffer.bindStorage(CACHE_HITS_BUFFER);
  workBuffer.bindStorage(CACHE_WORK_BUFFER);
  gridBuffer.bindUniform(BLOCK_CASCADES);
  constantsBuffer.bindUniform(BLOCK_CACHE);
  slotTable.bind(UNIT_CACHE_SLOTS);
  lights.bind(UNIT_CACHE_LIGHT);
  const gl::Program& program =
      library().loadCompute("relight", "irradiance_cache/relight.comp", IrradianceCache::lookupFlags({}));
  {
    const gl::ComputePass pass("relight");
    program.use();
    pass.dispatch({static_cast<int>(kRecords), 1, 1}, {64, 1, 1});
  }
  const std::vector<shared::CacheRecord> lit = recordBuffer.read<shared::CacheRecord>();

  const auto unpacked = [](std::uint32_t word) {
    return std::exp2(static_cast<int>(word >> 27) - 24) * glm::dvec3(word & 511u, word >> 9 & 511u, word >> 18 & 511u);
  };
  for (std::size_t r = 0; r < kRecords; ++r) {
    if (r == kWithoutHits) {
      EXPECT_EQ(lit[r].irradiance, glm::vec3(-1.0f));
      EXPECT_EQ(lit[r].paths, 0u);
      continue;
    }
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < CACHE_HITS; ++i) {
      const shared::CacheHit& hit = hits[r * CACHE_HITS + i];
      sum += kPi * static_cast<double>(grids.referenceIrradiance) / 16.0 * unpacked(hit.light);
      const std::uint32_t slot = hit.slot & CACHE_SLOT_MASK, holds = slot > 0 ? slots[slot - 1] : 0;
      if (holds > 0 && holds <= kRecords) sum += unpacked(hit.reflectance) * glm::dvec3(light[holds - 1]);
    }
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(static_cast<double>(lit[r].irradiance[c]), sum[c] / CACHE_HITS, 1e-5 * sum[c] / CACHE_HITS) << r;
    EXPECT_EQ(lit[r].paths, static_cast<std::uint32_t>(CACHE_HITS)) << r;
  }
}

}  // namespace
}  // namespace lucerna
