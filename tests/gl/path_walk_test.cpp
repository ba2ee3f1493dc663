// Walks through dense media: the same picture, bit by bit, with and without asking the clearance grid, and however long
// a submission is.
#include "pathtracer/path_tracer.hpp"
#include "support/gl_fixture.hpp"
#include "support/long_tests.hpp"
#include "support/media_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lucerna {
namespace {

using namespace test;

class PathWalkTest : public SharedProgramsTest {
 protected:
  Image picture(const Scene& scene, std::uint32_t samples, const PathTracer::Settings& settings) {
    PathTracer tracer(context(), library(), scene, settings);
    tracer.record(samples);
    EXPECT_EQ(tracer.statistics().leakedPaths, 0.0);
    return tracer.mean();
  }
};

/// A ball of milk of refractive index n, 20 mean free paths in radius, in front of an open sky.
Scene milkBall(double ior) {
  Scene scene;
  scene.media = {homogeneous({18.0, 20.0, 22.0}, {0.002, 0.005, 0.02}, 0.7)};
  addSphere(scene, glm::dvec3(0.0), 1.0, 3, addBoundary(scene, ior == 1.0 ? Bsdf::none : Bsdf::dielectric, ior, 0));
  scene.environment = halves();
  scene.cameras = {cameraAt({0.3, 0.4, 4.0}, glm::dvec3(0.0), 0.6)};
  return scene;
}

/// The same of a liquid that is nearly black, whose samples have two parts.
Scene darkBall() {
  Scene scene = milkBall(1.33);
  scene.media = {homogeneous({2.0, 3.0, 4.0}, {5.0, 6.0, 9.0}, 0.7)};
  return scene;
}

TEST_F(PathWalkTest, LongSubmissionsLoseNoLoopTurns) {
  // llvmpipe leaves every loop of a shader after 65,535 iterations in all: a submission of many segments must not get
  // there.
  PathTracer::Settings settings;
  settings.size = {4, 4};
  settings.walks = false;
  settings.submissionSeconds = 0.002;
  const Image cut = picture(milkBall(1.33), 400, settings);
  settings.submissionSeconds = 20.0;
  EXPECT_EQ(picture(milkBall(1.33), 400, settings).pixels, cut.pixels);
}

TEST_F(PathWalkTest, ShadowRaysEndHoweverFarABoundLiesAboveTheDensity) {
  // A floor under a block of smoke that is thin where the sun shines through, and a million times as dense beside that:
  // a million null collisions a ray.
  Scene scene;
  Medium smoke = homogeneous(glm::dvec3(0.0), glm::dvec3(1.0), 0.0);
  DensityGrid grid;
  grid.size = {8, 8, 8};
  grid.min = {-1.0, -0.5, -1.0};
  grid.max = {1.0, 0.5, 1.0};
  for (int i = 0; i < 512; ++i) grid.density.push_back(i % 8 < 6 ? 0.4f : 1e6f);
  smoke.grid = grid;
  scene.media = {smoke};
  addBox(scene, grid.min, grid.max, addBoundary(scene, Bsdf::none, 1.0, 0));
  scene.materials.emplace_back().diffuse = glm::vec3(1.0f);
  addBox(scene, {-3.0, -1.2, -3.0}, {3.0, -1.0, 3.0}, static_cast<int>(scene.materials.size()) - 1);
  scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(static_cast<float>(M_PI))};
  scene.cameras = {cameraAt({-0.5, -0.7, 2.5}, {-0.5, -1.0, 0.0})};
  PathTracer::Settings settings;
  settings.size = {8, 8};
  settings.transport = Transport::direct;
  PathTracer tracer(context(), library(), scene, settings);
  tracer.record(4);
  for (const glm::vec3& pixel : tracer.mean().pixels) EXPECT_NEAR(pixel.x, std::exp(-0.4), 5e-4);
  // A ray from the camera, a shadow ray with 256 tentative collisions and the planes of 8 cells.
  EXPECT_LT(tracer.submissions().largest, 64u * (256 + 1000));
}

TEST_F(PathWalkTest, WalksAreThePathsThatTraceEveryFlight) {
  // Also with a lamp in the room, a body in the milk that absorbs, and a shell of glass around that overlaps it; and
  // where milk absorbs enough for roulette to end walks.
  for (const float absorbs : {1.0f, 20.0f}) {
    Scene scene = milkBall(1.33);
    scene.media[0].absorption *= absorbs;
    addSphere(scene, glm::dvec3(0.0), 1.2, 3, addBoundary(scene, Bsdf::dielectric, 1.5, -1, -1));
    scene.materials.emplace_back().diffuse = glm::vec3(0.5f);
    addBox(scene, glm::dvec3(-0.1), glm::dvec3(0.2), static_cast<int>(scene.materials.size()) - 1);
    scene.materials.emplace_back().emission = glm::vec3(20.0f);
    addBox(scene, {2.0, 2.0, 1.0}, {2.2, 2.3, 1.5}, static_cast<int>(scene.materials.size()) - 1);
    PathTracer::Settings settings;
    settings.size = {24, 24};
    PathTracer walking(context(), library(), scene, settings);
    EXPECT_TRUE(walking.features().denseMedia);
    walking.record(8);
    settings.walks = false;
    PathTracer tracing(context(), library(), scene, settings);
    EXPECT_FALSE(tracing.features().denseMedia);
    tracing.record(8);
    // The same collisions; sums differ by rounding, since two programs have them.
    EXPECT_EQ(walking.statistics().collisions, tracing.statistics().collisions);
    const Image a = walking.mean(), b = tracing.mean();
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(a.pixels[i][c], b.pixels[i][c], 1e-4f * (1.0f + b.pixels[i][c])) << i;
    EXPECT_EQ(walking.statistics().leakedPaths, 0.0);
  }
}

TEST_F(PathWalkTest, WalksWhereLampsAreSoughtAreThePathsThatTraceEveryFlight) {
  // A lamp without size and the sun are sought from collisions near the boundary. A pixel that is inspected traces
  // every flight.
  Scene scene = milkBall(1.33);
  scene.points.push_back({{0.0, 3.0, 3.0}, glm::vec3(9.0f)});
  scene.sun = DirectionalLight{glm::normalize(glm::dvec3(-1.0, -2.0, -1.0)), glm::vec3(2.0f)};
  PathTracer::Settings settings;
  settings.size = {24, 24};
  PathTracer walking(context(), library(), scene, settings);
  walking.record(4);
  EXPECT_GT(walking.statistics().collisions, 1000.0);
  for (const glm::ivec2& pixel : {glm::ivec2(12, 12), glm::ivec2(9, 14), glm::ivec2(14, 8)}) {
    settings.inspectedPixel = pixel;
    PathTracer tracing(context(), library(), scene, settings);
    tracing.record(4);
    const int row = settings.size.y - 1 - pixel.y;
    const glm::vec3 a = walking.mean().at(pixel.x, row), b = tracing.mean().at(pixel.x, row);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-4f * (1.0f + b[c])) << pixel.x;
    EXPECT_GT(b.y, 0.0f);
  }
}

TEST_F(PathWalkTest, PicturesDoNotDependOnHowSubmissionsAndQueuesDivideThem) {
  // Also of another size than a tile's groups, by passes that double, and continued from a checkpoint.
  for (const Scene& scene : {milkBall(1.33), darkBall()}) {
    PathTracer::Settings settings;
    settings.size = {37, 29};
    settings.submissionSeconds = 20.0;
    const Image whole = picture(scene, 7, settings);
    settings.submissionSeconds = 0.001;
    PathTracer parts(context(), library(), scene, settings);
    while (parts.samples() < 3) parts.advance(7);
    PathTracer continued(context(), library(), scene, settings);
    continued.resume(parts.checkpoint(), "parts");
    while (continued.advance(7)) {}
    EXPECT_EQ(continued.mean().pixels, whole.pixels);
  }
}

/// Lamps, a grid of smoke and rough metal and glass, beside each other.
Scene smokyRoom() {
  Scene scene;
  Medium smoke = homogeneous({0.2, 0.3, 0.4}, {0.8, 0.6, 0.4}, 0.3);
  DensityGrid grid;
  grid.size = {8, 8, 8};
  grid.min = {-1.0, -0.5, -1.0};
  grid.max = {0.0, 0.5, 1.0};
  for (int i = 0; i < 512; ++i) grid.density.push_back(static_cast<float>(i % 7));
  smoke.grid = grid;
  scene.media = {smoke};
  addBox(scene, grid.min, grid.max, addBoundary(scene, Bsdf::none, 1.0, 0));
  Material metal;
  metal.bsdf = Bsdf::conductor;
  metal.specular = {0.9f, 0.7f, 0.5f};
  metal.roughness = 0.3f;
  scene.materials.push_back(metal);
  addSphere(scene, {0.6, 0.0, 0.5}, 0.3, 2, static_cast<int>(scene.materials.size()) - 1);
  const int glass = addBoundary(scene, Bsdf::dielectric, 1.5, -1);
  scene.materials[static_cast<std::size_t>(glass)].roughness = 0.2f;
  addSphere(scene, {0.6, 0.0, -0.5}, 0.3, 2, glass);
  scene.materials.emplace_back().emission = glm::vec3(5.0f);
  addBox(scene, {-0.2, 1.5, -0.2}, {0.2, 1.6, 0.2}, static_cast<int>(scene.materials.size()) - 1);
  scene.environment = halves();
  scene.cameras = {cameraAt({0.3, 0.4, 4.0}, glm::dvec3(0.0), 0.6)};
  return scene;
}

TEST_F(PathWalkTest, TheKernelForGpusDrawsTheSamePicture) {
  // Stack in shared memory, the path in the state buffer while a ray is traced, shadow rays in the same loop as the
  // path's: bit by bit what software renderers get. The picture is no multiple of a group.
  Scene milk = milkBall(1.33);
  addSphere(milk, glm::dvec3(0.0), 1.2, 3, addBoundary(milk, Bsdf::dielectric, 1.5, -1, -1));
  Scene room;
  room.environment = milk.environment;
  room.cameras = milk.cameras;
  Scene smoke = smokyRoom(), dark = darkBall();
  // Milk's programs are two of the largest.
  std::vector<Scene*> scenes{&room, &smoke, &dark};
  if (longTests()) scenes.push_back(&milk);
  for (Scene* scene : scenes) {
    scene->materials.emplace_back().diffuse = glm::vec3(0.5f);
    addBox(*scene, glm::dvec3(-1.0), glm::dvec3(0.2), static_cast<int>(scene->materials.size()) - 1);
    scene->points.push_back({{0.0, 3.0, 3.0}, glm::vec3(9.0f)});
    PathTracer::Settings settings;
    settings.size = {27, 21};
    settings.rays.sharedStack = false;
    const Image software = picture(*scene, 8, settings);
    settings.rays.sharedStack = true;
    settings.submissionSeconds = 0.001;
    EXPECT_EQ(picture(*scene, 8, settings).pixels, software.pixels);
    EXPECT_GT(software.at(12, 12).x, 0.0f);
  }
}

TEST_F(PathWalkTest, TheKernelForGpusTellsTheSameLightsOfAPixel) {
  const Scene scene = smokyRoom();
  PathTracer::Settings settings;
  settings.size = {24, 24};
  settings.inspectedPixel = glm::ivec2(12, 12);
  std::vector<std::vector<PathTracer::InspectedLight>> told;
  for (const bool shared : {false, true}) {
    settings.rays.sharedStack = shared;
    PathTracer tracer(context(), library(), scene, settings);
    tracer.record(16);
    told.push_back(tracer.takeInspected());
  }
  ASSERT_EQ(told[0].size(), told[1].size());
  EXPECT_GT(told[0].size(), 8u);
  for (std::size_t i = 0; i < told[0].size(); ++i) {
    EXPECT_EQ(told[0][i].radiance, told[1][i].radiance) << i;
    EXPECT_EQ(told[0][i].places, told[1][i].places) << i;
  }
}

}  // namespace
}  // namespace lucerna
