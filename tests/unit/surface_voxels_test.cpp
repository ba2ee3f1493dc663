// Voxels of surfaces: which are set by a plane, a slanted triangle, a mask.
#include "lpv/surface_voxels.hpp"
#include "support/path_scenes.hpp"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

using test::SceneBuilder;

int countSet(const SurfaceVoxels& voxels) {
  int count = 0;
  for (const glm::uvec2& words : voxels.bits) count += __builtin_popcount(words.x) + __builtin_popcount(words.y);
  return count;
}

TEST(SurfaceVoxels, APlateSetsOneLayerWithoutHoles) {
  SceneBuilder builder;
  builder.plate({0.0, 0.03, 0.0}, {0, 0, 2}, {2, 0, 0}, builder.material(glm::vec3(0.5f)));
  for (const int across : {1, 7, 64, 200}) {
    const SurfaceVoxels voxels = surfaceVoxels(builder.scene(), across);
    EXPECT_NEAR(voxels.size, 2.0 / across, 1e-12);
    const glm::dvec3 first = (glm::dvec3(-1.0, 0.03, -1.0) - voxels.minimum) / voxels.size;
    for (int x = 0; x < across; ++x)
      for (int z = 0; z < across; ++z) {
        // The plate lies on a border of voxels: either side of it may be set.
        const auto isSet = [&](double y) {
          return voxels.isSet(glm::ivec3(glm::floor(first + glm::dvec3(x + 0.5, y, z + 0.5))));
        };
        EXPECT_TRUE(isSet(-1e-4) || isSet(1e-4)) << across << ": " << x << " " << z;
      }
    // Its far edges lie on the border of the next voxels.
    EXPECT_GE(countSet(voxels), across * across);
    EXPECT_LE(countSet(voxels), 2 * (across + 1) * (across + 1));
  }
}

TEST(SurfaceVoxels, ASlantedTriangleIsWhereItsPointsAre) {
  SceneBuilder builder;
  const glm::dvec3 a(-1.0, -0.7, 0.2), b(1.0, 0.4, -0.3), c(0.1, 1.0, 0.9);
  builder.triangle(a, b, c, builder.material(glm::vec3(0.5f)));
  const SurfaceVoxels voxels = surfaceVoxels(builder.scene(), 50);
  for (int i = 0; i < 40; ++i)
    for (int j = 0; i + j < 40; ++j) {
      const double u = (i + 0.25) / 40.0, v = (j + 0.25) / 40.0;
      const glm::dvec3 p = (a + u * (b - a) + v * (c - a) - voxels.minimum) / voxels.size;
      // A corner of a voxel may be cut between two of the points looked at.
      bool near = false;
      for (int k = 0; k < 27; ++k)
        near |= voxels.isSet(glm::ivec3(glm::floor(p)) + glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1);
      EXPECT_TRUE(near) << u << " " << v;
    }
  EXPECT_FALSE(voxels.isSet(glm::ivec3(glm::floor((glm::dvec3(-0.9, 0.9, 0.8) - voxels.minimum) / voxels.size))));
}

TEST(SurfaceVoxels, WhatAMaskCutsOutIsFree) {
  SceneBuilder builder;
  const int leaf = builder.material(glm::vec3(0.5f));
  builder.plate({0.0, 0.0, 0.0}, {0, 0, 2}, {2, 0, 0}, leaf);
  const int solid = countSet(surfaceVoxels(builder.scene(), 32));
  Texture mask;
  mask.bitmap.width = mask.bitmap.height = 1;
  mask.bitmap.hasAlpha = true;
  mask.bitmap.rgba = {255, 255, 255, 0};
  builder.scene().textures.push_back(mask);
  builder.materialAt(leaf).alphaMasked = true;
  builder.materialAt(leaf).alphaTexture = 0;
  EXPECT_EQ(countSet(surfaceVoxels(builder.scene(), 32)), 0);
  builder.scene().textures.front().bitmap.rgba = {255, 255, 255, 255};
  EXPECT_EQ(countSet(surfaceVoxels(builder.scene(), 32)), solid);
}

TEST(SurfaceVoxels, AnEmptySceneHasNone) { EXPECT_EQ(countSet(surfaceVoxels(Scene{}, 16)), 0); }

}  // namespace
}  // namespace lucerna
