// What is made once: stages whose inputs have not changed are not run again, and no bit of any picture changes by that.
#include "irradiance_cache/settings.hpp"
#include "lpv/settings.hpp"
#include "render/renderer.hpp"
#include "render/deviations.hpp"
#include "support/gl_fixture.hpp"
#include "support/small_scenes.hpp"

#include <map>

namespace lucerna {
namespace {

using test::lookingAt;

class Reuse : public test::SharedProgramsTest {
 protected:
  static RenderSettings settings(std::string_view technique) {
    RenderSettings s;
    s.technique = technique;
    s.size = {48, 32};
    s.fullFloatTarget = true;
    s.shadow.size = s.of<ReflectiveShadowMap::Settings>().size = 128;
    s.lights.spotSize = s.lights.pointSize = 128;
    s.of<LpvSettings>().cascades.cells = s.of<IrradianceCacheSettings>().cascades.cells = 8;
    s.of<LpvSettings>().cascades.cascades = s.of<IrradianceCacheSettings>().cascades.cascades = 2;
    s.of<IrradianceCacheSettings>().samples = 64;
    s.of<IrradianceCacheSettings>().bounces = 1;
    return s;
  }
  /// A sun, a spot and an omnidirectional lamp.
  static Scene room() {
    Scene scene = test::openBox();
    scene.points.push_back({{-1.0, 1.0, 2.0}, glm::vec3(5.0f, 9.0f, 12.0f)});
    scene.spots.push_back(
        {{2.0, 4.0, 3.0}, glm::normalize(glm::dvec3(-0.3, -1.0, -0.8)), glm::vec3(60.0f, 50.0f, 40.0f), 0.3, 0.6});
    return scene;
  }
  /// Still, a step of less than a cell, a long way, still, a turn, and back.
  static std::vector<Camera> path() {
    const Camera start = test::openBoxCamera(), near = lookingAt({0.05, 1.02, 11.9}, {0.0, -1.0, 0.0}),
                 far = lookingAt({3.0, 4.0, 4.0}, {-2.0, -2.0, -1.0});
    return {start, start, start, near, near, far, far, lookingAt({3.0, 4.0, 4.0}, {2.0, 0.0, -5.0}), start, start};
  }
  struct Run {
    std::vector<Image> pictures;
    std::vector<Bitmap> displays;
    std::map<std::string, gl::StageStatistics> stages;
    const gl::StageStatistics& stage(const std::string& name) const {
      static const gl::StageStatistics none;
      const auto found = stages.find(name);
      return found == stages.end() ? none : found->second;
    }
  };
  static Run run(const Scene& scene, RenderSettings s, bool reuse, const std::vector<Camera>& cameras,
                 bool toTheEnd = false) {
    s.reuse = reuse;
    Renderer renderer(context(), library(), scene, s);
    Run result;
    for (const Camera& camera : cameras) {
      if (toTheEnd) renderer.renderToTheEnd(camera);
      else renderer.render(camera);
      result.pictures.push_back(renderer.readRadiance());
      result.displays.push_back(renderer.readDisplay());
    }
    renderer.drain();
    for (const gl::StageStatistics& stage : renderer.timer().statistics()) result.stages[stage.name] = stage;
    return result;
  }
  /// The pictures of both ways, and that they are not black and not all the same.
  static void expectSame(const Run& with, const Run& without, const std::string& what) {
    ASSERT_EQ(with.pictures.size(), without.pictures.size());
    for (std::size_t i = 0; i < with.pictures.size(); ++i) {
      EXPECT_EQ(with.pictures[i].pixels, without.pictures[i].pixels) << what << ", frame " << i;
      EXPECT_EQ(with.displays[i].rgba, without.displays[i].rgba) << what << ", frame " << i;
    }
    EXPECT_GT(meanOf(with.pictures[0]).x, 1e-3) << what;
    EXPECT_NE(with.pictures[0].pixels, with.pictures[5].pixels) << what;
  }
};

TEST_F(Reuse, PicturesAreTheSameBitByBitForEachTechnique) {
  const Scene scene = room();
  const std::vector<Camera> cameras = path();
  struct Case {
    std::string name;
    RenderSettings settings;
    bool toTheEnd = false;
  };
  std::vector<Case> cases{{"direct", settings("direct")}, {"rsm", settings("rsm")}, {"lpv", settings("lpv")}};
  Case sunCascades{"sun cascades", settings("direct")};
  sunCascades.settings.shadow.cascades.cascades = 3;
  cases.push_back(sunCascades);
  for (const LpvSurfels surfels : {LpvSurfels::camera, LpvSurfels::both}) {
    Case c{surfels == LpvSurfels::camera ? "lpv, the camera's surfels" : "lpv, all surfels", settings("lpv")};
    c.settings.of<LpvSettings>().surfels = surfels;
    cases.push_back(c);
  }
  Case truncated{"lpv, truncated", settings("lpv")};
  applyDeviation(truncated.settings, "lpv.truncate=on");
  cases.push_back(truncated);
  Case atomics{"lpv, counted", settings("lpv")};
  atomics.settings.of<LpvSettings>().fill = LpvFill::fixed;
  atomics.settings.of<LpvSettings>().bounces = 2;
  cases.push_back(atomics);
  Case original{"original", settings("lpv")};
  applyFidelity(original.settings, Fidelity::original);
  cases.push_back(original);
  for (const int bounces : {1, IrradianceCacheSettings::kAllBounces}) {
    Case c{fmt::format("gather, bounces {}", bounces), settings("irradiance-cache")};
    c.settings.of<IrradianceCacheSettings>().transport = CacheTransport::gather;
    c.settings.of<IrradianceCacheSettings>().bounces = bounces;
    cases.push_back(c);
  }
  for (const int bounces : {2, IrradianceCacheSettings::kAllBounces})
    for (const bool toTheEnd : {true, false}) {
      Case c{fmt::format("rays, bounces {}{}", bounces, toTheEnd ? ", settled" : ""), settings("irradiance-cache"),
             toTheEnd};
      c.settings.of<IrradianceCacheSettings>().bounces = bounces;
      cases.push_back(c);
    }
  for (const Case& c : cases)
    expectSame(run(scene, c.settings, true, cameras, c.toTheEnd), run(scene, c.settings, false, cameras, c.toTheEnd),
               c.name);
}

TEST_F(Reuse, AStageRunsWhenItsInputsChangedAndOnlyThen) {
  const Scene scene = room();
  const std::vector<Camera> cameras = path();
  const Run with = run(scene, settings("lpv"), true, cameras), without = run(scene, settings("lpv"), false, cameras);
  for (const char* once : {"shadow", "spot shadows", "point shadows", "rsm"}) {
    EXPECT_EQ(with.stage(once).ran, 1u) << once;
    EXPECT_EQ(with.stage(once).frames, cameras.size()) << once;
    EXPECT_EQ(without.stage(once).ran, cameras.size()) << once;
    EXPECT_EQ(without.stage(once).savedMs(), 0.0) << once;
    EXPECT_GT(with.stage(once).savedMs(), 0.0) << once;
  }
  // The volume: at first, after the long way, after the turn and on coming back; a step of less than a cell moves no
  // grid.
  for (const char* volume : {"injection", "geometry volume", "propagation"}) {
    EXPECT_EQ(with.stage(volume).ran, 4u) << volume;
    EXPECT_EQ(without.stage(volume).ran, cameras.size()) << volume;
  }
  for (const char* each : {"shading", "tone mapping"}) EXPECT_EQ(with.stage(each).ran, cameras.size()) << each;

  // Surfels of what the camera sees change with every view, so there the volume is made each frame; the lights' maps
  // are not.
  RenderSettings s = settings("lpv");
  s.of<LpvSettings>().surfels = LpvSurfels::both;
  const Run camera = run(scene, s, true, cameras);
  EXPECT_EQ(camera.stage("rsm").ran, 1u);
  EXPECT_EQ(camera.stage("camera surfels").ran, cameras.size());
  EXPECT_EQ(camera.stage("propagation").ran, cameras.size());
  // Cascades of the sun follow the camera.
  s = settings("direct");
  s.shadow.cascades.cascades = 3;
  std::uint64_t views = 1;
  for (std::size_t i = 1; i < cameras.size(); ++i) views += !cameras[i].seesAs(cameras[i - 1]);
  EXPECT_EQ(run(scene, s, true, cameras).stage("shadow").ran, views);
  EXPECT_EQ(run(scene, s, false, cameras).stage("shadow").ran, cameras.size());
  // The gather's pixels are the camera's, its map is the sun's.
  const Run rsm = run(scene, settings("rsm"), true, cameras);
  EXPECT_EQ(rsm.stage("rsm").ran, 1u);
  EXPECT_EQ(rsm.stage("gather full").ran, cameras.size());
}

TEST_F(Reuse, ASettledCacheCostsNothingAndForgettingBeginsAnew) {
  const Scene scene = room();
  const RenderSettings s = settings("irradiance-cache");
  Renderer renderer(context(), library(), scene, s);
  const auto ran = [&](const std::string& name) {
    for (const gl::StageStatistics& stage : renderer.timer().statistics())
      if (stage.name == name) return stage.ran;
    return std::size_t{0};
  };
  renderer.renderToTheEnd(test::openBoxCamera());
  const std::size_t records = ran("irradiance cache"), geometry = ran("geometry");
  EXPECT_GT(records, 0u);
  const Image first = renderer.readRadiance();
  for (int i = 0; i < 5; ++i) renderer.render(test::openBoxCamera());
  EXPECT_EQ(ran("irradiance cache"), records);
  EXPECT_EQ(ran("geometry"), geometry);
  EXPECT_EQ(ran("shadow"), 1u);
  EXPECT_EQ(first.pixels, renderer.readRadiance().pixels);
  renderer.forget();
  renderer.render(test::openBoxCamera());
  EXPECT_EQ(ran("shadow"), 2u);
  EXPECT_EQ(ran("irradiance cache"), records + 1);
  // Another size shows other points, so records are asked for anew, even where the view is the same.
  renderer.renderToTheEnd(test::openBoxCamera());
  renderer.render(test::openBoxCamera());
  const std::size_t before = ran("irradiance cache");
  renderer.resize({96, 64});
  renderer.render(test::openBoxCamera());
  EXPECT_EQ(ran("irradiance cache"), before + 1);
}

TEST_F(Reuse, ForgettingDrawsMapsAndVolumeAnew) {
  const Scene scene = room();
  Renderer renderer(context(), library(), scene, settings("lpv"));
  for (int i = 0; i < 3; ++i) renderer.render(test::openBoxCamera());
  const Image before = renderer.readRadiance();
  renderer.forget();
  renderer.render(test::openBoxCamera());
  EXPECT_EQ(before.pixels, renderer.readRadiance().pixels);
  for (const gl::StageStatistics& stage : renderer.timer().statistics()) {
    const bool each = stage.name == "shading" || stage.name == "tone mapping";
    EXPECT_EQ(stage.ran, each ? 4u : 2u) << stage.name;
  }
}

}  // namespace
}  // namespace lucerna
