// Radiosity in scenes that move: a moment solved from the moment before has the form factors and, within the bound, the
// light of one solved from nothing, and makes only those rows again that see what has moved.
#include "base/data.hpp"
#include "radiosity/radiosity_frame.hpp"
#include "radiosity/solution.hpp"
#include "render/renderer.hpp"
#include "scene/motion.hpp"
#include "scene/scene_file.hpp"
#include "support/gl_fixture.hpp"
#include "support/radiosity_scenes.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {
namespace {

using test::addBox;
using test::Box;
using test::lambertian;
using test::SceneBuilder;

constexpr double kError = 1e-4;

RadiositySolutionSettings coarse(double edge) {
  RadiositySolutionSettings settings;
  settings.patches.longestEdge = edge;
  settings.hemicubes.resolution = 32;
  settings.hemicubes.visibility = HemicubeVisibility::raster;
  settings.error = kError;
  return settings;
}

/// The scene's meshes from `first` on move by `offset` of the time.
Scene moved(SceneBuilder& builder, std::size_t first, std::function<glm::dvec3(double)> offset) {
  Scene scene = test::dark(builder.scene());
  SceneMotion& motion = motionOf(scene);
  for (std::size_t m = first; m < scene.meshes.size(); ++m) motion.meshes.push_back(m);
  motion[SceneMotion::Part::objects] = [offset = std::move(offset)](Scene& posed, double t) {
    for (const std::size_t m : posed.motion->meshes)
      transformMesh(posed, posed.meshes[m], glm::translate(glm::dmat4(1.0), offset(t)));
  };
  motion.end = 2.0;
  finishMotion(scene);
  return scene;
}

enum class Thing { box, sheet, lamp, speck };

/// Two rooms of side 4, from x = -4 to 0 and on to 4, with a lamp each and a gap in the wall between them, 0.4 wide at
/// its far end. A thing moves in the room on the left, by `step` a second; a speck hides a lamp's middle.
Scene twoRooms(Thing thing, bool hasGap, bool hasRoof = true, const glm::dvec3& step = {0.8, 0.0, 0.3}) {
  SceneBuilder builder;
  const int white = lambertian(builder, 0.7), red = lambertian(builder, 0.4), lamp = lambertian(builder, 0.0, 60.0);
  if (hasRoof) {
    addBox(builder, {{-4, -2, -2}, {4, 2, 2}}, white, true);
  } else {
    builder.plate({0, -2, 0}, {0, 0, 4}, {8, 0, 0}, white);
    builder.plate({0, 0, -2}, {8, 0, 0}, {0, 4, 0}, white);
  }
  addBox(builder, {{-0.1, -2, -2}, {0.1, 2, hasGap ? 1.6 : 2.0}}, white);
  for (const double x : {-2.0, 2.0}) builder.plate({x, 1.9, 0}, {0.3, 0, 0}, {0, 0, 0.3}, lamp);
  const std::size_t first = builder.scene().meshes.size();
  if (thing == Thing::box) addBox(builder, {{-3, -1.6, -1.5}, {-2.4, -1, -1}}, red);
  else if (thing == Thing::speck) builder.plate({-1.95, 1.86, -0.05}, {0.08, 0, 0}, {0, 0, 0.08}, red);
  else builder.plate({-3, -1, 0.5}, {0, 0.5, 0}, {0, 0, 0.5}, thing == Thing::lamp ? lamp : red);
  return moved(builder, first, [step](double t) { return t * step; });
}

class RadiosityMotion : public test::SharedProgramsTest {
 protected:
  static RadiositySolution solve(const Scene& scene, const RadiositySolutionSettings& settings,
                                 const RadiositySolution* before = nullptr) {
    return solveScene(context(), library(), scene, settings, {}, {}, before);
  }
  /// max |a - b| over the mean of b.
  static double difference(const RadiositySolution& a, const RadiositySolution& b) {
    glm::dvec3 most(0.0), mean(0.0);
    for (std::size_t i = 0; i < b.exitance.size(); ++i) {
      most = glm::max(most, glm::abs(a.exitance[i] - b.exitance[i]));
      mean += b.mesh.patches[i].area * b.exitance[i] / b.mesh.area();
    }
    return std::max({most.x / mean.x, most.y / mean.y, most.z / mean.z});
  }
  static std::size_t rowsUnlike(const RadiositySolution& a, const RadiositySolution& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < b.mesh.patches.size(); ++i) {
      const FormFactorMatrix::Row x = a.moment->rows->row(i), y = b.moment->rows->row(i);
      count += !std::ranges::equal(x.patches, y.patches) || !std::ranges::equal(x.factors, y.factors);
    }
    return count;
  }
  struct Counts {
    std::size_t rows = 0, madeAgain = 0;
    double products = 0.0, productsAnew = 0.0;
  };
  /// Through the moments, each against one solved from nothing.
  static Counts follow(Scene scene, const RadiositySolutionSettings& settings, const std::vector<double>& times) {
    Counts counts;
    poseAt(scene, times.front());
    RadiositySolution solution = solve(scene, settings);
    for (std::size_t k = 1; k < times.size(); ++k) {
      poseAt(scene, times[k]);
      RadiositySolution next = solve(scene, settings, &solution);
      const RadiositySolution anew = solve(scene, settings);
      EXPECT_TRUE(next.reached && next.progress.errorBound <= settings.error);
      EXPECT_EQ(next.mesh.patches.size(), anew.mesh.patches.size());
      if (next.mesh.patches.size() != anew.mesh.patches.size()) return counts;
      EXPECT_EQ(rowsUnlike(next, anew), 0u) << times[k];
      EXPECT_LE(difference(next, anew), 2.0 * settings.error) << times[k];
      EXPECT_GT(difference(solution.mesh.patches.size() == anew.mesh.patches.size() ? solution : anew, anew),
                solution.mesh.patches.size() == anew.mesh.patches.size() ? 20.0 * settings.error : -1.0)
          << "nothing has changed at " << times[k];
      counts.rows += anew.hemicubes;
      counts.madeAgain += next.hemicubes;
      counts.products += next.progress.products;
      counts.productsAnew += anew.progress.products;
      EXPECT_EQ(anew.hemicubes, anew.mesh.patches.size());
      solution = std::move(next);
    }
    return counts;
  }
};

TEST_F(RadiosityMotion, ALampThatMovesMakesNoRowAgain) {
  Scene scene = loadScene(*findDataFolder() / "assets/cornell/moving.json");
  (*scene.motion)[SceneMotion::Part::objects] = {};
  const Counts counts = follow(scene, coarse(0.1), {0.0, 0.1, 1.0, 2.0});
  EXPECT_EQ(counts.madeAgain, 0u);
  EXPECT_GT(counts.rows, 1000u);
  EXPECT_LT(counts.products, counts.productsAnew);
}

TEST_F(RadiosityMotion, ABlockThatTurnsInTheCornellBox) {
  Scene scene = loadScene(*findDataFolder() / "assets/cornell/moving.json");
  const Counts counts = follow(scene, coarse(0.1), {0.0, 0.1, 1.0, 2.0});
  EXPECT_LT(counts.madeAgain, counts.rows);
  EXPECT_GT(counts.madeAgain, counts.rows / 2);  // most see it
  EXPECT_LT(counts.products, counts.productsAnew);
}

// Of the room behind the wall only what sees through the gap is made again; of closed rooms, nothing.
TEST_F(RadiosityMotion, ARoomThatDoesNotSeeTheMotionKeepsItsRows) {
  for (const Thing thing : {Thing::box, Thing::sheet, Thing::lamp}) {
    const std::vector<double> times{0.0, 0.1, 2.0};
    const Counts closed = follow(twoRooms(thing, false), coarse(1.2), times),
                 gap = follow(twoRooms(thing, true), coarse(1.2), times);
    RecordProperty("closed", std::to_string(closed.madeAgain) + "/" + std::to_string(closed.rows));
    EXPECT_LT(static_cast<double>(closed.madeAgain), 0.55 * static_cast<double>(closed.rows));
    EXPECT_LT(static_cast<double>(gap.madeAgain), 0.75 * static_cast<double>(gap.rows));
    EXPECT_GT(static_cast<double>(gap.madeAgain), 0.3 * static_cast<double>(gap.rows));
    EXPECT_LT(closed.products, closed.productsAnew);
    EXPECT_LT(gap.products, gap.productsAnew);
  }
}

// The new place is seen by nothing: what saw the old one is made again, its back too, and what it hid a lamp from
// without being seen by a pixel.
TEST_F(RadiosityMotion, WhatMovesIntoAWallIsGone) {
  for (const auto& [thing, step] :
       {std::pair(Thing::sheet, glm::dvec3(3.0, 0.0, 1.125)), std::pair(Thing::sheet, glm::dvec3(0.0, -2.5, 0.0)),
        std::pair(Thing::speck, glm::dvec3(0.0, 0.3, 0.0))}) {
    const Counts counts = follow(twoRooms(thing, false, true, step), coarse(1.2), {0.0, 1.0, 0.0});
    EXPECT_LT(static_cast<double>(counts.madeAgain), 0.6 * static_cast<double>(counts.rows));
  }
}

// Nothing hides what comes into the open.
TEST_F(RadiosityMotion, OpenScenesMakeAgainWhatFacesTheMotion) {
  for (const Thing thing : {Thing::box, Thing::sheet, Thing::lamp}) {
    const Counts counts = follow(twoRooms(thing, true, false), coarse(1.2), {0.0, 0.1, 2.0, 1.0});
    EXPECT_LT(counts.madeAgain, counts.rows);
  }
}

// A light that goes out leaves nothing, one that brightens is not waited for.
TEST_F(RadiosityMotion, LightThatScalesNeedsNoMoreThanAProduct) {
  SceneBuilder builder;
  const int white = lambertian(builder, 0.7);
  addBox(builder, {{-1, -1, -1}, {1, 1, 1}}, white, true);
  Scene scene = test::dark(builder.scene());
  scene.points.push_back({glm::dvec3(0.2, 0.5, 0.1), glm::vec3(1.0f)});
  motionOf(scene)[SceneMotion::Part::points] = [](Scene& posed, double t) {
    posed.points[0].intensity = glm::vec3(static_cast<float>(t), 1.0f, static_cast<float>(1.0 - t));
  };
  finishMotion(scene);
  poseAt(scene, 0.5);
  const RadiositySolution half = solve(scene, coarse(0.5));
  poseAt(scene, 0.25);
  const RadiositySolution dim = solve(scene, coarse(0.5), &half);
  EXPECT_LE(dim.progress.products, 2.0);
  EXPECT_EQ(dim.hemicubes, 0u);
  EXPECT_LE(difference(dim, solve(scene, coarse(0.5))), 2.0 * kError);
  poseAt(scene, 0.0);
  const RadiositySolution dark = solve(scene, coarse(0.5), &dim);
  for (const glm::dvec3& b : dark.exitance) ASSERT_EQ(b.x, 0.0);
}

// Nothing is compiled again, in a picture by patches as in one by shadow rays.
TEST_F(RadiosityMotion, ARendererFollows) {
  for (const RadiosityView::Direct direct : {RadiosityView::Direct::patches, RadiosityView::Direct::pixels}) {
    Scene scene = loadScene(*findDataFolder() / "assets/cornell/moving.json");
    RenderSettings settings;
    settings.technique = "radiosity";
    settings.size = {24, 24};
    settings.fullFloatTarget = true;
    settings.of<RadiosityView::Settings>().solution = coarse(0.1);
    settings.of<RadiosityView::Settings>().direct = direct;
    const auto picture = [&](Renderer& renderer) {
      renderer.renderToTheEnd(scene.cameras.front());
      return renderer.readRadiance();
    };
    Renderer live(context(), programs(), scene, settings);
    const Image first = picture(live);
    for (const double t : {1.0, 2.5}) {
      const SceneChange change = poseAt(scene, t);
      const int built = programs().statistics().built;
      ASSERT_TRUE(live.follow(context(), programs(), scene, change));
      const Image found = picture(live);
      EXPECT_EQ(programs().statistics().built, built);
      Renderer other(context(), programs(), scene, settings);
      const Image right = picture(other);
      double worst = 0.0, moved = 0.0;
      for (std::size_t i = 0; i < right.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          worst = std::max(worst, static_cast<double>(std::abs(found.pixels[i][c] - right.pixels[i][c])));
          moved = std::max(moved, static_cast<double>(std::abs(first.pixels[i][c] - right.pixels[i][c])));
        }
      const RadiositySolution& solution = radiosityOf(other.technique())->solution();
      glm::dvec3 mean(0.0);
      for (std::size_t i = 0; i < solution.exitance.size(); ++i)
        mean += solution.mesh.patches[i].area * solution.exitance[i] / solution.mesh.area();
      EXPECT_LT(worst, 2.0 * kError * std::max({mean.x, mean.y, mean.z})) << t;
      EXPECT_GT(moved, 0.1) << t;
    }
  }
}

// The method of hemicubes that was chosen by the clock stays; refined meshes follow the light, and far from the origin
// all is as near it.
TEST_F(RadiosityMotion, MethodRefinementsAndPlace) {
  RadiositySolutionSettings settings = coarse(1.2);
  settings.hemicubes.visibility = HemicubeVisibility::automatic;
  Scene scene = twoRooms(Thing::box, true);
  RadiositySolution first = solve(scene, settings);
  first.visibility = HemicubeVisibility::rays;  // as if it had been chosen
  poseAt(scene, 1.0);
  EXPECT_EQ(solve(scene, settings, &first).visibility, HemicubeVisibility::rays);

  RadiositySolutionSettings refining = coarse(1.2);
  refining.refinements = 1;
  poseAt(scene, 0.0);
  const RadiositySolution refined = solve(scene, refining);
  poseAt(scene, 1.0);
  const RadiositySolution next = solve(scene, refining, &refined), anew = solve(scene, refining);
  ASSERT_EQ(next.mesh.patches.size(), anew.mesh.patches.size());
  EXPECT_LE(difference(next, anew), 2.0 * kError);

  Scene far = twoRooms(Thing::box, false);
  for (Vertex& vertex : far.vertices) vertex.position.x += 4096.0f;
  for (Vertex& vertex : far.motion->restVertices) vertex.position.x += 4096.0f;
  for (Bounds* bounds : {&far.bounds, &far.motion->bounds}) bounds->min.x += 4096.0, bounds->max.x += 4096.0;
  for (Mesh& mesh : far.meshes) mesh.bounds.min.x += 4096.0, mesh.bounds.max.x += 4096.0;
  const Counts counts = follow(far, coarse(1.2), {0.0, 1.0});
  EXPECT_LT(static_cast<double>(counts.madeAgain), 0.55 * static_cast<double>(counts.rows));
}

}  // namespace
}  // namespace lucerna
