// Where cascades lie: multiples of their cell size, still while the camera moves by less than a cell, at any distance.
#include "cascades/cascades.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace lucerna {
namespace {

Bounds cube(const glm::dvec3& centre, double side) {
  Bounds bounds;
  bounds.add(centre - 0.5 * side);
  bounds.add(centre + 0.5 * side);
  return bounds;
}

const glm::dvec3 kAhead = glm::normalize(glm::dvec3(0.5, -0.2, 0.8));

TEST(Cascades, FinestFirstByTheRatio) {
  for (const double ratio : {1.0, 2.0, 3.0})
    for (int count = 1; count <= 4; ++count) {
      const auto cascades =
          placeCascades({32, count, 4.0, ratio, 0.8}, cube(glm::dvec3(0.0), 100.0), glm::dvec3(0.0), kAhead);
      ASSERT_EQ(cascades.size(), static_cast<std::size_t>(count));
      EXPECT_EQ(cascades.back().cellSize, 4.0);
      for (std::size_t k = 0; k + 1 < cascades.size(); ++k)
        EXPECT_DOUBLE_EQ(cascades[k].cellSize * ratio, cascades[k + 1].cellSize);
    }
}

TEST(Cascades, TheCoarsestCoversTheSceneWithRoomForMovedLights) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-60.0, 60.0);
  for (const int cells : {6, 7, 8, 32, 128})  // fewer leave no room for the margin and the snapping
    for (int trial = 0; trial < 50; ++trial) {
      const Bounds scene = cube({3.0, -7.0, 11.0}, 40.0);
      const auto cascades =
          placeCascades({cells, 3}, scene, glm::dvec3(uniform(random), uniform(random), uniform(random)), kAhead);
      const Cascade& coarsest = cascades.back();
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(coarsest.minimum()[axis], scene.min[axis] - 0.5 * coarsest.cellSize + 1e-9) << cells;
        EXPECT_GE(coarsest.minimum()[axis] + cells * coarsest.cellSize,
                  scene.max[axis] + 0.5 * coarsest.cellSize - 1e-9)
            << cells;
      }
    }
}

TEST(Cascades, TinyGridsAreGrids) {
  for (const int cells : {1, 2, 3, 4, 5})
    for (const double x : {-100.0, 0.0, 100.0})
      for (const Cascade& c : placeCascades({cells, 2}, cube(glm::dvec3(5.0), 10.0), glm::dvec3(x), kAhead)) {
        EXPECT_TRUE(std::isfinite(c.cellSize) && c.cellSize > 0.0) << cells;
      }
}

TEST(Cascades, TheMinimumIsAMultipleOfTheCellSizeJustBelowTheUnsnappedOne) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1e3, 1e3);
  for (int trial = 0; trial < 200; ++trial) {
    const glm::dvec3 camera(uniform(random), uniform(random), uniform(random));
    const auto cascades = placeCascades({16, 3, 1.7}, Bounds{}, camera, kAhead);
    for (std::size_t k = 0; k < cascades.size(); ++k) {
      const Cascade& c = cascades[k];
      for (int axis = 0; axis < 3; ++axis) {
        const double expected = camera[axis] + kAhead[axis] * 0.8 * 8.0 * c.cellSize;
        EXPECT_NEAR(c.centre[axis], expected, 1e-9);
        const double inCells = (c.centre[axis] - 8.0 * c.cellSize) / c.cellSize;
        EXPECT_LE(static_cast<double>(c.firstCell[axis]), inCells);
        EXPECT_GT(static_cast<double>(c.firstCell[axis]) + (k + 1 < cascades.size() ? 2.0 : 1.0),
                  inCells);  // finer ones may move in pairs
        EXPECT_EQ(c.minimum()[axis], static_cast<double>(c.firstCell[axis]) * c.cellSize);
      }
    }
  }
}

TEST(Cascades, SubCellMotionLeavesTheGridFarFromTheOriginToo) {
  // Cells of 1/4 and 1/2, camera positions in the middle of a cell's range, all exact in double precision: 1e6, 1e9 and
  // 1e12 away, in both directions. A whole cell of the coarsest moves its index by exactly one, that of the finer by
  // two of its own.
  for (const double far : {0.0, 1e6, -1e6, 1e9, -1e9, 1e12, -1e12}) {
    const glm::dvec3 camera = glm::dvec3(far) + 0.125;
    const CascadeSettings settings{8, 2, 0.5, 2.0, 0.0};
    const auto still = placeCascades(settings, Bounds{}, camera, kAhead);
    const auto moved = placeCascades(settings, Bounds{}, camera + glm::dvec3(0.1, -0.1, 0.0625), kAhead);
    const auto next = placeCascades(settings, Bounds{}, camera + glm::dvec3(0.5, -0.5, 0.0), kAhead);
    EXPECT_EQ(still[1].firstCell, glm::i64vec3(std::llround(2.0 * far) - 4)) << far;
    EXPECT_EQ(still[0].firstCell, glm::i64vec3(std::llround(4.0 * far) - 4)) << far;
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(still[k].firstCell, moved[k].firstCell) << far;
      EXPECT_NE(still[k].centre, moved[k].centre) << far;  // what blending follows does move
    }
    EXPECT_EQ(next[1].firstCell - still[1].firstCell, glm::i64vec3(1, -1, 0)) << far;
    EXPECT_EQ(next[0].firstCell - still[0].firstCell, glm::i64vec3(2, -2, 0)) << far;
  }
}

TEST(Cascades, AFarSceneIsPlacedLikeANearOne) {
  // Cells of a power of two, so that a shift by 2^20 (about 1e6) is exact and nothing but the index changes.
  const double shift = 1048576.0;
  const CascadeSettings settings{16, 3, 2.0};
  for (const glm::dvec3& camera : {glm::dvec3(0.0), glm::dvec3(7.25, -3.5, 2.0), glm::dvec3(-20.0, 20.0, 5.0)}) {
    const auto near = placeCascades(settings, cube(glm::dvec3(0.0), 40.0), camera, kAhead);
    const auto far = placeCascades(settings, cube(glm::dvec3(shift), 40.0), camera + shift, kAhead);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto cellsAway = static_cast<std::int64_t>(shift / near[k].cellSize);
      EXPECT_EQ(far[k].firstCell - near[k].firstCell, glm::i64vec3(cellsAway));
      EXPECT_EQ(far[k].minimum() - near[k].minimum(), glm::dvec3(shift));
    }
  }
}

TEST(Cascades, NeverFurtherOutOfTheSceneThanItMust) {
  // The camera far outside: grids stay at the scene, at most four cells beyond its bounds or, where they are larger
  // than the scene, about its middle; snapping adds up to two cells.
  const Bounds scene = cube(glm::dvec3(0.0), 64.0);
  for (const double away : {-1e4, 1e4})
    for (const Cascade& c : placeCascades({16, 3}, scene, glm::dvec3(away, 0.0, -away), kAhead)) {
      const double beyond = std::max(4.0 * c.cellSize, 0.5 * (16 * c.cellSize - 64.0)) + 2.0 * c.cellSize + 1e-9;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(c.minimum()[axis], scene.min[axis] - beyond);
        EXPECT_LE(c.minimum()[axis] + 16 * c.cellSize, scene.max[axis] + beyond);
      }
    }
}

TEST(Cascades, TheFinestCountsAtTheScenesOuterSurfaces) {
  // A cascade has faded out 3 cells (2.5 and the lookup's half) within its half extent: beside a wall of the bounds it
  // must still count there.
  const Bounds scene = cube(glm::dvec3(0.0), 64.0);
  const auto cascades = placeCascades({32, 3}, scene, glm::dvec3(0.0, 30.0, 31.0), kAhead);
  const double reach = (0.5 * 32 - 3.0) * cascades[0].cellSize;
  EXPECT_GT(cascades[0].centre.y + reach, scene.max.y);
  EXPECT_GT(cascades[0].centre.z + reach, scene.max.z);
}

TEST(Cascades, NothingOfASceneIsStillAGrid) {
  Bounds point;
  point.add(glm::dvec3(1.0, 2.0, 3.0));
  for (const Bounds& scene : {Bounds{}, point}) {
    const auto cascades = placeCascades({}, scene, glm::dvec3(0.0), kAhead);
    EXPECT_EQ(cascades.size(), 3u);
    for (const Cascade& c : cascades) EXPECT_TRUE(std::isfinite(c.minimum().x) && c.cellSize > 0.0);
  }
}

TEST(CascadesDeathTest, NeedsCells) {
  EXPECT_DEATH(placeCascades({0, 1}, Bounds{}, glm::dvec3(0.0), kAhead), "cells = 0, cascades = 1");
  EXPECT_DEATH(placeCascades({8, 0}, Bounds{}, glm::dvec3(0.0), kAhead), "cells = 8, cascades = 0");
}

// Pairs of cells that are averaged where cascades are joined stay the same.
TEST(Cascades, AllButTheCoarsestMoveByTwoCells) {
  CascadeSettings settings;
  settings.cellSize = 1.0;
  settings.heldInScene = false;
  bool oddCoarsest = false;
  for (int step = 0; step < 40; ++step) {
    const std::vector<Cascade> cascades =
        placeCascades(settings, {}, glm::dvec3(0.23 * step, -0.11 * step, 0.4 * step), {0, 0, -1});
    for (std::size_t k = 0; k < cascades.size(); ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const bool odd = cascades[k].firstCell[axis] % 2 != 0;
        oddCoarsest = oddCoarsest || (odd && k + 1 == cascades.size());
        EXPECT_TRUE(!odd || k + 1 == cascades.size()) << "cascade " << k << ", step " << step;
      }
  }
  EXPECT_TRUE(oddCoarsest);
}

// What is in view and within reach lies at least 1.5 cells inside the grid, whichever way the camera looks.
TEST(Cascades, WhatReceiversReachIsWithinTheirGrid) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto direction = [&] {
    for (;;)
      if (const glm::dvec3 d(uniform(random), uniform(random), uniform(random)); glm::length(d) > 0.1)
        return glm::normalize(d);
  };
  for (const bool held : {false, true})
    for (int i = 0; i < 2000; ++i) {
      CascadeSettings settings{32, 3, 4.0, 2.0, 0.8};
      settings.heldInScene = held;
      const Bounds scene = cube(glm::dvec3(3.0), 140.0);
      Camera camera;
      camera.position = 60.0 * glm::dvec3(uniform(random), uniform(random), uniform(random));
      camera.direction = direction();
      camera.up = direction();
      camera.verticalFov = 0.3 + 0.9 * std::abs(uniform(random));
      const double aspect = 1.3 + 0.5 * uniform(random);
      const auto cascades = placeCascadesAround(settings, scene, camera, aspect);
      EXPECT_EQ(cascades[0].centre, camera.position);
      const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                       up = glm::cross(right, camera.direction);
      const double tangent = std::tan(0.5 * camera.verticalFov);
      for (const Cascade& c : cascades)
        for (int j = 0; j < 20; ++j) {
          const auto side = [&] { return j < 8 ? std::copysign(1.0, uniform(random)) : uniform(random); };
          const glm::dvec3 ray = glm::normalize(camera.direction + tangent * (side() * aspect * right + side() * up));
          const glm::dvec3 point = camera.position + ray * (c.reach * (j < 4 ? 1.0 : std::abs(uniform(random))));
          if (held && glm::any(glm::greaterThan(glm::abs(point - 3.0), glm::dvec3(70.0)))) continue;
          const glm::dvec3 place = (point - c.minimum()) / c.cellSize, rest = glm::min(place, 32.0 - place);
          EXPECT_GE(std::min({rest.x, rest.y, rest.z}), 1.5 - 1e-9);
        }
    }
  // 0.8 * 16 cells c + sqrt(13.5^2 - (0.8 * 16)^2 (1 - c^2)), c = 1 / sqrt(1 + tan^2 30 degrees (1 + (16/9)^2)).
  Camera camera;
  camera.verticalFov = std::numbers::pi / 3.0;
  EXPECT_NEAR(placeCascadesAround({32, 2, 2.0}, Bounds{}, camera, 16.0 / 9.0)[0].reach, 17.6, 0.05);
}

}  // namespace
}  // namespace lucerna
