// The bounds for which resolutions are chosen: without what is far off and small.
#include "scene/main_bounds.hpp"
#include "scene/motion.hpp"
#include "scene/studio.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

Bounds boxAt(const glm::dvec3& centre, double edge) { return {centre - 0.5 * edge, centre + 0.5 * edge}; }

std::optional<Bounds> mainOf(const std::vector<Bounds>& still, const std::vector<SweptBounds>& moving = {},
                             const std::vector<Camera>& cameras = {}) {
  std::vector<SweptBounds> all;
  for (const Bounds& box : still) all.push_back({box, box});
  all.insert(all.end(), moving.begin(), moving.end());
  return boundsWithoutFarMeshes(all, cameras);
}

void expectEqual(const Bounds& found, const Bounds& right) {
  EXPECT_EQ(found.min, right.min);
  EXPECT_EQ(found.max, right.max);
}

TEST(MainBounds, LackWhatIsFarOffAndSmall) {
  const Bounds room = boxAt({0, 0, 0}, 4.0), table = boxAt({1, -1, 0}, 1.0);
  for (const double away : {100.0, 1e4, 1e6, 1e12}) {
    const std::optional<Bounds> found = mainOf({room, boxAt({away, 0, 0}, 0.5), table});
    ASSERT_TRUE(found) << away;
    expectEqual(*found, room);
  }
  EXPECT_FALSE(mainOf({room, table}));
  EXPECT_FALSE(mainOf({room, boxAt({40, 0, 0}, 0.1)}));  // not far: 8 diagonals are 55
  EXPECT_FALSE(mainOf({room, boxAt({0, 0, 0}, 1e4)}));  // a sky
  EXPECT_FALSE(mainOf({room, boxAt({200, 0, 0}, 3.0)}));  // a tower, 0.025 of its distance wide
  EXPECT_FALSE(mainOf({room}));
  EXPECT_FALSE(mainOf({}));
  EXPECT_FALSE(mainOf({room, Bounds{}}));
}

// Two of them that lie together are no reason for each other, however many they are.
TEST(MainBounds, LieWhereMostOfTheSurfacesAre) {
  const Bounds room = boxAt({1e5, 0, 0}, 4.0);
  std::vector<Bounds> all{room};
  for (int i = 0; i < 30; ++i) all.push_back(boxAt({0.3 * i, 0, 0}, 0.2));
  const std::optional<Bounds> found = mainOf(all);
  ASSERT_TRUE(found);
  expectEqual(*found, room);
}

// A room before a mountain that is much larger, but seen from the room.
TEST(MainBounds, HoldWhatACameraIsNear) {
  const Bounds room = boxAt({0, 0, 0}, 4.0), mountain = boxAt({2000, 0, 0}, 100.0);
  Camera camera;
  camera.position = {1, 0, 20};
  EXPECT_FALSE(mainOf({room, mountain}, {}, {camera}));
  camera.position = {1500, 0, 0};
  const std::optional<Bounds> found = mainOf({room, mountain}, {}, {camera});
  ASSERT_TRUE(found);
  expectEqual(*found, mountain);
  // What flies off may begin beside the camera.
  Bounds flight = boxAt({1, 0, 20.2}, 0.2);
  flight.add(boxAt({1, 0, 1e5}, 0.2));
  camera.position = {1, 0, 20};
  const std::optional<Bounds> without = mainOf({room}, {{boxAt({1, 0, 20.2}, 0.2), flight}}, {camera});
  ASSERT_TRUE(without);
  expectEqual(*without, room);
}

// Two groups alike, of which the cameras see one.
TEST(MainBounds, LieWhereTheCamerasAre) {
  const std::vector<Bounds> groups{boxAt({0, 0, 0}, 4.0), boxAt({1, 0, 0}, 1.0), boxAt({5000, 0, 0}, 4.0),
                                   boxAt({5001, 0, 0}, 1.0), boxAt({5002, 0, 0}, 1.0)};
  for (const double place : {0.0, 5000.0}) {
    Camera camera;
    camera.position = {place, 0, 100};
    const std::optional<Bounds> found = mainOf(groups, {}, {camera});
    ASSERT_TRUE(found) << place;
    EXPECT_EQ(found->min.x, place - 2.0);
  }
}

// A row of things, each near to the next, is a scene of its length.
TEST(MainBounds, HoldARowOfThings) {
  std::vector<Bounds> all;
  for (int i = 0; i < 200; ++i) all.push_back(boxAt({3.0 * i, 0, 0}, 1.0));
  EXPECT_FALSE(mainOf(all));
}

TEST(MainBounds, LackWhatFliesFarOffAtAnyTime) {
  const Bounds room = boxAt({0, 0, 0}, 4.0), ball = boxAt({0, 0, 0}, 0.5);
  Bounds flight = ball;
  flight.add(boxAt({1000, 0, 0}, 0.5));
  const std::optional<Bounds> found = mainOf({room}, {{ball, flight}});
  ASSERT_TRUE(found);
  expectEqual(*found, room);
  Bounds walk = ball;
  walk.add(boxAt({20, 0, 0}, 0.5));
  EXPECT_FALSE(mainOf({room}, {{ball, walk}}));
}

TEST(MainBounds, AreThoseOfTheWholeMotion) {
  const test::TempFolder folder;
  folder.write("m.obj",
               "o room\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 4 3 2 1\n"
               "o ball\nv 0 1 0\nv 0.1 1 0\nv 0 1 0.1\nf 7 6 5\n");
  const auto load = [&](const std::string& far) {
    return loadScene(folder.write("s.json", R"({"model": "m.obj", "objects": {"ball": {"translation":
        {"times": [0, 1], "values": [[0, 0, 0], [)" +
                                                far + ", 0, 0]]}}}}"));
  };
  Scene scene = load("1e6");
  for (const double seconds : {0.0, 1e-5, 0.5, 1.0, 1e9}) {
    poseAt(scene, seconds);
    ASSERT_TRUE(scene.mainBounds) << seconds;
    expectEqual(*scene.mainBounds, Bounds{{-2, 0, -2}, {2, 0, 2}});
  }
  EXPECT_FALSE(load("10").mainBounds);
}

TEST(MainBounds, HoldTheStudiosFloor) {
  const test::TempFolder folder;
  Scene scene = loadScene(folder.write("m.obj",
                                       "o box\nv -1 0 -1\nv 1 0 -1\nv 1 2 1\nv -1 2 1\nf 4 3 2 1\n"
                                       "o far\nv 1e4 0 0\nv 10000.1 0 0\nv 10000 0.1 0\nf 5 6 7\n"));
  ASSERT_TRUE(scene.mainBounds);
  expectEqual(*scene.mainBounds, Bounds{{-1, 0, -1}, {1, 2, 1}});
  addFloor(scene);
  EXPECT_LT(scene.mainBounds->max.x, 100.0);
  EXPECT_GT(scene.mainBounds->max.x, 2.0);
}

// Where a view or a lamp is far off, resolutions are as they are at home.
TEST(MainBounds, AroundAPlaceThatIsFarOff) {
  Scene scene;
  scene.bounds = {{-1, -1, -1}, {1e6, 1, 1}};
  expectEqual(scene.mainAround({5, 0, 0}), scene.bounds);
  scene.mainBounds = Bounds{{-1, -1, -1}, {3, 1, 1}};
  expectEqual(scene.mainAround({5, 0, 0}), *scene.mainBounds);
  expectEqual(scene.mainAround({1e5, 7, 0}), Bounds{{1e5 - 2, 6, -1}, {1e5 + 2, 8, 1}});
}

}  // namespace
}  // namespace lucerna
