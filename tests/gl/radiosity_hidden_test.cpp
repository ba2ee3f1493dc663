// Parts of patches inside of solids against where the solids are; and what cutting them does to the light.
#include "radiosity/hemicubes.hpp"
#include "radiosity/hidden_parts.hpp"
#include "radiosity/solution.hpp"
#include "scene/triangle_parts.hpp"
#include "support/form_factor_reference.hpp"
#include "support/gl_fixture.hpp"
#include "support/radiosity_scenes.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace lucerna {
namespace {

using test::addBox;
using test::Box;
using test::cubeRoom;
using test::dark;
using test::lambertian;
using test::SceneBuilder;

class HiddenParts : public test::SharedProgramsTest {
 protected:
  static RadiosityMesh cut(const Scene& scene, const PatchSettings& settings, double& area) {
    RadiosityMesh mesh = makePatches(scene, settings);
    area = cutHiddenParts(library(), RayScene(sceneOf(mesh), capabilities()), mesh);
    return mesh;
  }
};

TEST_F(HiddenParts, AreThoseInsideOfSolidsOrOutsideOfTheRoom) {
  const Box room{{-2, 0, -2}, {2, 3, 2}};
  const Box solids[] = {{{-1.33, 0, -1.21}, {-0.27, 1.1, -0.52}},  // stands on the floor
                        {{0.41, 0, -1.4}, {1.13, 0.7, -0.37}},  // the same, without a bottom
                        {{0.2, -0.6, 0.35}, {1.3, 2.2, 1.45}},  // goes on under the floor
                        {{-2.7, 1.55, 0.31}, {0.6, 1.95, 0.93}}};  // a beam that ends in the wall and in the pillar
  // Within a building all of them are found; where the room stands alone, what sticks out of it and sees the void is
  // not, but never is one cut that is in the room.
  for (const auto& [scale, building] :
       {std::pair{1e-3, true}, std::pair{1.0, true}, std::pair{1e4, true}, std::pair{1.0, false}}) {
    const glm::dvec3 place = scale * glm::dvec3(3.0, -1.0, 7.0);
    SceneBuilder builder;
    const int m = lambertian(builder, 0.5);
    const auto moved = [&, by = scale](const Box& box) { return Box{place + by * box.low, place + by * box.high}; };
    addBox(builder, moved(room), m, true);
    if (building) addBox(builder, moved({{-3, -1, -3}, {3, 4, 3}}), m);
    for (const Box& solid : solids) addBox(builder, moved(solid), m, false, &solid != &solids[1]);
    double area = 0.0;
    const RadiosityMesh mesh = cut(dark(builder.scene()), {.longestEdge = 0.9 * scale}, area);
    const double whole = makePatches(builder.scene(), {.longestEdge = 0.9 * scale}).area();
    std::size_t cutPatches = 0, hidden = 0, found = 0;
    for (const Patch& patch : mesh.patches) {
      const auto c = mesh.corners(patch);
      if (building &&
          std::max({std::abs(patch.centroid.x - place.x), std::abs(patch.centroid.z - place.z)}) > 2.99 * scale)
        continue;  // its outside
      const auto centroids = partCentroids(kPatchParts);
      std::uint16_t expected = 0;
      for (std::size_t k = 0; k < centroids.size(); ++k) {
        // A hair before the surface.
        const glm::dvec3 at = (c[0] + centroids[k].x * (c[1] - c[0]) + centroids[k].y * (c[2] - c[0]) - place) / scale +
                              1e-6 * patch.faceNormal;
        bool inside = !room.holds(at);
        for (const Box& solid : solids) inside = inside || solid.holds(at);
        if (inside) expected = static_cast<std::uint16_t>(expected | 1u << k);
      }
      if (std::popcount(expected) == 16) {
        if (building) { EXPECT_EQ(patch.hidden, 0) << "it stays whole"; }
        continue;
      }
      EXPECT_EQ(patch.hidden & (building ? ~0 : ~expected), building ? expected : 0)
          << scale << ": " << patch.centroid.x << " " << patch.centroid.y << " " << patch.centroid.z;
      cutPatches += expected != 0;
      hidden += static_cast<std::size_t>(std::popcount(expected));
      found += static_cast<std::size_t>(std::popcount(patch.hidden));
      const double all = 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
      EXPECT_NEAR(patch.area / all, 1.0 - std::popcount(patch.hidden) / 16.0, 1e-12);
      // The hemicube stands on what is left.
      const glm::dmat3 basis(c[1] - c[0], c[2] - c[0], patch.faceNormal);
      const glm::dvec3 weights = glm::inverse(basis) * (patch.centroid - c[0]);
      EXPECT_EQ(patch.hidden >> partAt(kPatchParts, {weights.x, weights.y}) & 1, 0);
    }
    EXPECT_GT(cutPatches, 40u);
    EXPECT_GT(hidden, 250u);
    EXPECT_GT(found, building ? hidden - 1 : hidden / 3);
    EXPECT_NEAR((whole - mesh.area()) / area, 1.0, 1e-9);
  }
}

TEST_F(HiddenParts, HardlyAnythingIsCutWhereSheetsShowTheirBacks) {
  double area = 0.0;
  cut(dark(cubeRoom(3, 0.5, 1.0)), {}, area);
  EXPECT_EQ(area, 0.0);
  // A room with a curtain of one side, a leaf, a wall of two sheets in one place, and one that is open to the sky.
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5);
  addBox(builder, {{-2, 0, -2}, {2, 3, 2}}, m, true);
  builder.plate({-1.2, 1.2, 0}, {0, 2, 0}, {0, 0, 2.5}, m);
  builder.plate({0.9, 0.8, 0.9}, {0.4, 0.1, 0}, {0, 0.1, 0.4}, m);
  builder.plate({0.8, 1.0, -1.0}, {2, 0, 0}, {0, 2, 0}, m);
  builder.plate({0.8, 1.0, -1.0}, {0, 2, 0}, {2, 0, 0}, m);
  cut(dark(builder.scene()), {.longestEdge = 0.9}, area);
  EXPECT_LT(area, 0.001 * makePatches(builder.scene(), {}).area());  // one part, close behind the curtain
  SceneBuilder outdoors;
  lambertian(outdoors, 0.5);
  outdoors.plate({0, 0, 0}, {0, 0, 8}, {8, 0, 0}, 0);
  outdoors.plate({0, 2, 0}, {0, 0, 1}, {1, 0, 0}, 0);  // its back towards the ground
  cut(dark(outdoors.scene()), {.longestEdge = 1.5}, area);
  EXPECT_EQ(area, 0.0);
}

TEST_F(HiddenParts, DoNotReceive) {
  // A floor of two triangles, in part under a block: what it receives from the block's side is the mean over the rest.
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5);
  builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, m);
  addBox(builder, {{0.4, 0, -3}, {3, 1, 3}}, m);
  double area = 0.0;
  const RadiosityMesh mesh = cut(dark(builder.scene()), {}, area);
  const std::vector<glm::dvec3> side{{0.4, 0, -3}, {0.4, 0, 3}, {0.4, 1, 3}, {0.4, 1, -3}};
  for (const HemicubeVisibility way : {HemicubeVisibility::raster, HemicubeVisibility::rays}) {
    HemicubeSettings settings;
    settings.visibility = way;
    Hemicubes hemicubes(library(), capabilities(), mesh, settings);
    const FormFactorRows rows = hemicubes.rows(0, 2);
    std::size_t at = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const Patch& floor = mesh.patches[i];
      ASSERT_GT(std::popcount(floor.hidden), 1);
      ASSERT_LT(std::popcount(floor.hidden), 15);
      double received = 0.0, expected = 0.0, open = 0.0;
      for (std::uint32_t k = 0; k < rows.counts[i]; ++k, ++at)
        if (std::abs(mesh.patches[rows.patches[at]].faceNormal.x + 1.0) < 1e-9)
          received += static_cast<double>(rows.factors[at]);
      const auto c = mesh.corners(floor);
      for (const glm::dvec2& w : partCentroids(8)) {  // as finely as near receivers are divided
        if (floor.hidden >> partAt(kPatchParts, w) & 1) continue;
        expected += std::abs(
            reference::pointToPolygon(c[0] + w.x * (c[1] - c[0]) + w.y * (c[2] - c[0]), floor.faceNormal, side));
        open += 1.0;
      }
      EXPECT_NEAR(received / (expected / open), 1.0, 1e-3) << nameOf(way);
    }
  }
}

TEST_F(HiddenParts, AFloorUnderBlocksShinesAsOneThatEndsAtThem) {
  // A sun from straight above: of the floor all that is not under a block is lit in full. A screen beside it, edge on
  // to the sun, sees the floor (and blocks that reflect nothing) alone.
  const Box blocks[] = {{{-1.7, 0, -1.6}, {-0.6, 0.25, -0.3}},
                        {{0.3, 0, -1.5}, {1.6, 0.25, -0.55}},
                        {{-1.5, 0, 0.45}, {-0.4, 0.25, 1.7}},
                        {{0.55, 0, 0.3}, {1.75, 0.25, 1.55}}};
  const auto screenLight = [&](bool cutByHand, double edge) {
    SceneBuilder builder;
    const int grey = lambertian(builder, 0.6), black = lambertian(builder, 0.0);
    const double marks[] = {-2, -1.7, -1.6, -1.5, -0.6, -0.55, -0.4, -0.3, 0.3, 0.45, 0.55, 1.55, 1.6, 1.7, 1.75, 2};
    for (std::size_t i = 1; cutByHand && i < std::size(marks); ++i)
      for (std::size_t k = 1; k < std::size(marks); ++k) {
        const glm::dvec3 low(marks[i - 1], 0, marks[k - 1]), high(marks[i], 0, marks[k]), centre = 0.5 * (low + high);
        bool under = false;
        for (const Box& block : blocks) under = under || block.holds(centre + glm::dvec3(0, 0.1, 0));
        if (!under) builder.plate(centre, {0, 0, high.z - low.z}, {high.x - low.x, 0, 0}, grey);
      }
    if (!cutByHand) builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, grey);
    for (const Box& block : blocks) addBox(builder, block, black);
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) builder.plate({4.0, 2.0 + y / 4.0, z / 4.0}, {0, 0, 0.25}, {0, 0.25, 0}, black);
    builder.sun({0, -1, 0}, glm::vec3(2.0f));
    RadiositySolutionSettings settings;
    settings.patches.longestEdge = edge;
    settings.hemicubes.visibility = HemicubeVisibility::raster;
    const RadiositySolution s = solveScene(context(), library(), builder.scene(), settings);
    double sum = 0.0, area = 0.0;
    for (std::size_t i = 0; i < s.mesh.patches.size(); ++i) {
      const Patch& patch = s.mesh.patches[i];
      if (patch.material == grey) {
        bool under = true;  // all of it: it stays whole and dark
        const auto c = s.mesh.corners(patch);
        for (const glm::dvec2& w : partCentroids(kPatchParts)) {
          const glm::dvec3 at = c[0] + w.x * (c[1] - c[0]) + w.y * (c[2] - c[0]) + glm::dvec3(0, 0.1, 0);
          bool here = false;
          for (const Box& block : blocks) here = here || block.holds(at);
          under = under && here;
        }
        EXPECT_NEAR(s.direct[i].x, under ? 0.0 : 2.0, 1e-6);
      }
      if (patch.centroid.x > 3.9) sum += patch.area * s.irradiance[i].x, area += patch.area;
    }
    return sum / area;
  };
  const double exact = screenLight(true, 0.25), coarse = screenLight(false, 1.5);
  EXPECT_NEAR(coarse / exact, 1.0, 0.01);
}

}  // namespace
}  // namespace lucerna
