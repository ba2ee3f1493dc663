// Hemicubes on the GPU against closed forms and against rays cast one by one.
#include "radiosity/form_factor_matrix.hpp"
#include "radiosity/hemicubes.hpp"
#include "support/form_factor_reference.hpp"
#include "support/gl_fixture.hpp"
#include "support/radiosity_scenes.hpp"
#include "support/ray_caster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <numeric>
#include <random>

namespace lucerna {
namespace {

using test::cubeRoom;
using test::lambertian;
using test::pixelsAlone;
using test::SceneBuilder;

class Hemicube : public test::SharedProgramsTest {
 protected:
  struct Computed {
    RadiosityMesh mesh;
    FormFactorMatrix matrix;
    std::vector<double> fronts, backs, areas;
    double factor(std::size_t i, std::size_t j) const {
      const auto row = matrix.row(i);
      for (std::size_t k = 0; k < row.patches.size(); ++k)
        if (row.patches[k] == j) return static_cast<double>(row.factors[k]);
      return 0.0;
    }
    double sum(std::size_t i, std::size_t firstPatch, std::size_t lastPatch) const {
      double total = 0.0;
      for (std::size_t j = firstPatch; j <= lastPatch; ++j) total += factor(i, j);
      return total;
    }
  };
  static Computed compute(const Scene& scene, const HemicubeSettings& settings, const PatchSettings& patches = {}) {
    Computed c;
    c.mesh = makePatches(scene, patches);
    Hemicubes hemicubes(library(), capabilities(), c.mesh, settings);
    for (int first = 0; first < hemicubes.patchCount(); first += hemicubes.batchSize()) {
      const FormFactorRows rows =
          hemicubes.rows(first, std::min(hemicubes.batchSize(), hemicubes.patchCount() - first));
      std::size_t at = 0;
      for (std::size_t k = 0; k < rows.counts.size(); ++k) {
        c.matrix.appendRow(std::span(rows.patches).subspan(at, rows.counts[k]),
                           std::span(rows.factors).subspan(at, rows.counts[k]));
        at += rows.counts[k];
        c.fronts.push_back(static_cast<double>(rows.fronts[k]));
        c.backs.push_back(static_cast<double>(rows.backs[k]));
      }
    }
    for (const Patch& p : c.mesh.patches) c.areas.push_back(p.area);
    return c;
  }
};

/// A tiny triangle at the origin that looks up, then plates.
SceneBuilder probeScene(double size = 1e-3) {
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5);
  builder.triangle({-size, 0, size}, {size, 0, size}, {0, 0, -size * 2.0}, m);
  return builder;
}

TEST_F(Hemicube, PointToOpposedSquareAndToWall) {
  // Centre to area: tolerances from the aliasing of N pixels; the closed form where patches cover enough of them.
  const double opposed[][2] = {{0.1, 0.968339556974040}, {0.5, 0.554126423979572}, {1, 0.239456470460774},
                               {2, 0.0734776348125214},  {4, 0.0194887650518050},  {10, 0.0031725255325526}};
  for (const auto& [d, exact] : opposed) {
    SceneBuilder builder = probeScene();
    builder.plate({0, d, 0}, {1, 0, 0}, {0, 0, 1}, 0);
    const Computed pixels = compute(builder.scene(), pixelsAlone(256)), closed = compute(builder.scene(), {});
    EXPECT_NEAR(pixels.sum(0, 1, 2) / exact, 1.0, 0.004 * std::max(1.0, d * d / 4.0)) << d;
    EXPECT_NEAR(pixels.fronts[0], pixels.sum(0, 1, 2), 1e-6);
    EXPECT_NEAR(closed.sum(0, 1, 2) / exact, 1.0, d > 4.0 ? 0.2 : 2e-5) << d;  // at 10 it covers too few pixels
  }
  const double wall[][2] = {{2, 0.0153474494524923},   {1, 0.0710934390469455},  {0.5, 0.190135882384807},
                            {0.25, 0.317549609028599}, {0.1, 0.422544860239058}, {0.05, 0.460912443330788},
                            {0.01, 0.492158952163455}};
  for (const auto& [c, exact] : wall) {
    SceneBuilder builder = probeScene(1e-4);
    builder.plate({0, 0.5, -c}, {1, 0, 0}, {0, 1, 0}, 0);
    const Computed pixels = compute(builder.scene(), pixelsAlone(256)), closed = compute(builder.scene(), {});
    EXPECT_NEAR(pixels.sum(0, 1, 2) / exact, 1.0, c > 1.0 ? 0.02 : 0.006) << c;
    EXPECT_NEAR(closed.sum(0, 1, 2) / exact, 1.0, 1e-4) << c;
  }
}

/// Root mean square of what counting pixel centres is off by, relative to the true area, for squares of that side in
/// pixels, turned and shifted at random.
double errorOfCounting(double side) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  constexpr int kSquares = 4000;
  const int reach = static_cast<int>(side) + 2;
  double squares = 0.0;
  for (int n = 0; n < kSquares; ++n) {
    const double angle = 0.5 * std::numbers::pi * unit(random), c = std::cos(angle), s = std::sin(angle);
    const double x = unit(random), y = unit(random);
    int count = 0;
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        count += std::abs((i + x) * c + (j + y) * s) < 0.5 * side && std::abs((j + y) * c - (i + x) * s) < 0.5 * side;
    const double off = count / (side * side) - 1.0;
    squares += off * off / kSquares;
  }
  return std::sqrt(squares);
}

// Antialiasing by four hemicubes turned against each other, beside doubled resolution: as many pixels. A square
// parallel to the full face is seen from 400 places, turned and shifted at random. The error of each count is that of
// counting pixel centres in such squares, in double precision; the mean of four independent counts has half of it.
// Twice the resolution does better: a factor of about 3 where the square covers many pixels, since neighbouring pixels
// share their task; below a pixel sqrt(1 / p - 1) for p hit pixels becomes sqrt(1 / (4 p) - 1).
TEST_F(Hemicube, AntialiasingHalvesTheErrorAndDoubledResolutionDoesMore) {
  constexpr int kPlaces = 400;
  const auto errorOf = [](double side, int resolution, int rolls) {
    SceneBuilder builder;
    const int m = lambertian(builder, 0.5);
    for (int i = 0; i < kPlaces; ++i) {  // on a spiral, within 45 degrees of the square
      const double r = 0.9 * std::sqrt((i + 0.5) / kPlaces), angle = 2.399963229728653 * i;
      const glm::dvec3 p(r * std::cos(angle), 0.0, r * std::sin(angle));
      builder.triangle(p + glm::dvec3(-1e-4, 0, 1e-4), p + glm::dvec3(1e-4, 0, 1e-4), p + glm::dvec3(0, 0, -2e-4), m);
    }
    builder.plate({0, 1, 0}, {side, 0, 0}, {0, 0, side}, m);
    HemicubeSettings settings = pixelsAlone(resolution);
    settings.rolls = rolls;
    const Computed c = compute(builder.scene(), settings);
    const double h = 0.5 * side;
    const std::vector<glm::dvec3> square{{-h, 1, -h}, {h, 1, -h}, {h, 1, h}, {-h, 1, h}};
    double squares = 0.0;
    for (std::size_t i = 0; i < kPlaces; ++i) {
      const double exact = std::abs(reference::pointToPolygon(c.mesh.patches[i].centroid, {0, 1, 0}, square));
      const double off = c.sum(i, kPlaces, kPlaces + 1) / exact - 1.0;
      squares += off * off / kPlaces;
    }
    return std::sqrt(squares);
  };
  for (const double side : {0.4, 0.02}) {
    const double plain = errorOf(side, 32, 1), rolled = errorOf(side, 32, 4), doubled = errorOf(side, 64, 1);
    std::cout << "[ measured ] square of " << side * 16 << " pixels' side: " << plain << ", 4 rolls " << rolled
              << ", doubled " << doubled << "; counting alone " << errorOfCounting(16.0 * side) << ", "
              << errorOfCounting(32.0 * side) << "\n";
    // A root mean square over 400 has a standard error of 3.5 %, below a pixel (kurtosis 8) 6.7 %; tolerance: 3 of
    // them.
    const double tolerance = side > 0.1 ? 0.11 : 0.2;
    EXPECT_NEAR(plain / errorOfCounting(16.0 * side), 1.0, tolerance) << side;
    EXPECT_NEAR(rolled / errorOfCounting(16.0 * side), 0.5, 0.5 * tolerance) << side;
    EXPECT_NEAR(doubled / errorOfCounting(32.0 * side), 1.0, tolerance) << side;
    EXPECT_LT(doubled, rolled) << side;
  }
}

// The mean of rolls has all entries, sums to 1 in a closed room, and does not depend on how rows are cut.
TEST_F(Hemicube, RollsAreAMean) {
  HemicubeSettings settings = pixelsAlone(16);
  const Scene room = cubeRoom(3, 0.5, 1.0);
  settings.rolls = 3;
  const Computed three = compute(room, settings);
  for (std::size_t i = 0; i < three.fronts.size(); ++i) {
    EXPECT_NEAR(three.fronts[i], 1.0, 2e-6) << i;
    EXPECT_NEAR(three.sum(i, 0, three.fronts.size() - 1), 1.0, 2e-6) << i;
  }
  settings.randomRoll = false;
  const Computed fixed = compute(room, settings);
  settings.rolls = 1;
  const Computed one = compute(room, settings);
  EXPECT_EQ(fixed.factor(0, 20), one.factor(0, 20)) << "turned towards the first corner there is one roll";
}

TEST_F(Hemicube, NothingIsLostInAClosedRoomAndNoPixelFallsBetweenPatches) {
  SceneBuilder ball;
  addSphere(ball, 1.0, 1, true, [m = lambertian(ball, 0.5)](const glm::dvec3&) { return m; });
  for (const Scene& scene : {cubeRoom(1, 0.5, 1.0), cubeRoom(4, 0.5, 1.0), ball.scene()})
    for (const int n : {8, 64, 256}) {
      if (n == 256 && scene.triangleCount() > 12) continue;
      const Computed c = compute(scene, pixelsAlone(n));
      for (std::size_t i = 0; i < c.fronts.size(); ++i) {
        ASSERT_NEAR(c.fronts[i], 1.0, 2e-6) << i;
        ASSERT_EQ(c.backs[i], 0.0);
      }
    }
  // Open by one wall: the rest is open, no more.
  Scene open = cubeRoom(5, 0.5, 1.0);
  open.meshes.resize(open.meshes.size() - 25);
  const Computed c = compute(open, pixelsAlone(64));
  EXPECT_NEAR(c.fronts[24],
              1.0 - reference::pointToPolygon(
                        c.mesh.patches[24].centroid, {0, 1, 0},
                        std::vector<glm::dvec3>{{.5, -.5, -.5}, {.5, -.5, .5}, {.5, .5, .5}, {.5, .5, -.5}}),
              0.003);
}

TEST_F(Hemicube, RowsDoNotDependOnHowTheyAreCutIntoSubmissions) {
  const Scene scene = cubeRoom(4, 0.5, 1.0);
  const RadiosityMesh mesh = makePatches(scene, {});
  for (const HemicubeVisibility visibility :
       {HemicubeVisibility::raster, HemicubeVisibility::rays, HemicubeVisibility::itemBuffer}) {
    HemicubeSettings settings;
    settings.visibility = visibility;
    settings.resolution = 32;
    const auto rowsBy = [&](double unmeasuredIterations, bool streamed, double& largest) {
      settings.unmeasuredIterations = unmeasuredIterations;
      Hemicubes hemicubes(library(), capabilities(), mesh, settings);
      std::vector<FormFactorRows> all;
      if (streamed)
        hemicubes.stream(0, hemicubes.patchCount(), [&](const FormFactorRows& rows) { all.push_back(rows); });
      else
        for (int first = 0, count = hemicubes.batchSize(); first < hemicubes.patchCount(); first += count)
          all.push_back(hemicubes.rows(first, std::min(count, hemicubes.patchCount() - first)));
      largest = hemicubes.largestIterations();
      std::vector<float> values;
      for (const FormFactorRows& rows : all) {
        EXPECT_EQ(rows.counts.size(), rows.fronts.size());
        values.insert(values.end(), rows.counts.begin(), rows.counts.end());
        values.insert(values.end(), rows.fronts.begin(), rows.fronts.end());
        values.insert(values.end(), rows.backs.begin(), rows.backs.end());
        values.insert(values.end(), rows.patches.begin(), rows.patches.end());
        values.insert(values.end(), rows.factors.begin(), rows.factors.end());
      }
      std::sort(values.begin(), values.end());  // rows are cut otherwise
      return values;
    };
    double whole = 0.0, cut = 0.0;
    const std::vector<float> expected = rowsBy(gl::kUnmeasuredIterations, false, whole);
    const double hemicube = 3.0 * 32 * 32 * gl::kIterationsOfRay;
    EXPECT_GT(whole, 20 * hemicube) << nameOf(visibility);
    for (const bool streamed : {false, true}) {
      EXPECT_EQ(rowsBy(2.5 * hemicube, streamed, cut), expected) << nameOf(visibility);
      EXPECT_LE(cut, 10 * hemicube);
      EXPECT_GE(cut, hemicube);
    }
  }
}

TEST_F(Hemicube, PixelsSeeWhatRaysSee) {
  // A room with two boxes of fronts and a thin sheet: every pixel's patch by a ray from the CPU caster, weights from
  // the map.
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5);
  addSphere(builder, 2.0, 1, true, [&](const glm::dvec3&) { return m; });
  addSphere(builder, 0.5, 1, false, [&](const glm::dvec3&) { return m; });
  builder.plate({0.9, 0.3, 0.1}, {0.5, 0.2, 0}, {0, 0.5, 0.4}, m);
  const Scene scene = builder.scene();
  HemicubeSettings settings = pixelsAlone(32);
  settings.randomRoll = false;
  const Computed c = compute(scene, settings);
  const test::RayCaster caster(scene);
  const auto deltas = deltaFormFactors(32, DeltaMap::exact);
  double worst = 0.0, total = 0.0, different = 0.0;
  for (std::size_t i = 0; i < c.mesh.patches.size(); i += 7) {
    const Patch& patch = c.mesh.patches[i];
    const glm::dvec3 n = patch.faceNormal, u = glm::normalize(c.mesh.corners(patch)[0] - patch.centroid),
                     v = glm::cross(n, u);
    std::vector<double> expected(c.mesh.patches.size(), 0.0);
    double backs = 0.0;
    const glm::dvec3 forward[5] = {n, u, v, -u, -v};
    const glm::dvec3 right[5] = {u, v, -u, -v, u};
    for (int face = 0; face < 5; ++face)
      for (int y = 0; y < (face == 0 ? 32 : 16); ++y)
        for (int x = 0; x < 32; ++x) {
          const glm::dvec3 d = forward[face] + ((x + 0.5) / 16.0 - 1.0) * right[face] +
                               ((y + 0.5) / 16.0 - (face == 0 ? 1.0 : 0.0)) * (face == 0 ? v : n);
          const auto hit = caster.firstHit(patch.centroid + 1e-7 * d, d);
          ASSERT_TRUE(hit);
          const double delta = deltas[static_cast<std::size_t>((face == 0 ? 0 : 32 * 32) + y * 32 + x)];
          if (glm::dot(hit->normal, d) < 0.0) expected[hit->triangle] += delta;
          else backs += delta;
        }
    for (std::size_t j = 0; j < expected.size(); ++j) {
      different += std::abs(c.factor(i, j) - expected[j]);
      total += expected[j];
      worst = std::max(worst, std::abs(c.factor(i, j) - expected[j]));
    }
    EXPECT_NEAR(c.backs[i], backs, 0.002) << i;
  }
  EXPECT_LT(different / total, 0.002);  // pixel centres on an edge go either way
  EXPECT_LT(worst, 0.003);
  EXPECT_GT(total, 10.0);
}

TEST_F(Hemicube, AreaFactorsOfACube) {
  // One patch (two triangles) a wall, receivers divided: exact but for the division.
  HemicubeSettings settings;
  settings.resolution = 64;
  settings.nearDistance = 6.0f;
  settings.mostParts = 16;
  const Computed c = compute(cubeRoom(1, 0.5, 1.0), settings);
  for (std::size_t i = 0; i < 2; ++i) {
    const double up = 0.5 * (c.sum(0, 2, 3) + c.sum(1, 2, 3)), side = 0.5 * (c.sum(0, 4, 5) + c.sum(1, 4, 5));
    EXPECT_NEAR(up / 0.199824895698387, 1.0, 0.004);
    EXPECT_NEAR(side / 0.200043776075403, 1.0, 0.01);
  }
  settings.nearDistance = 0.0f;  // the centroid alone gives another number
  const Computed centroid = compute(cubeRoom(1, 0.5, 1.0), settings);
  EXPECT_GT(std::abs(0.5 * (centroid.sum(0, 2, 3) + centroid.sum(1, 2, 3)) / 0.199824895698387 - 1.0), 0.03);
}

// Centroids of parts are off by the square of the parts; what halving them shows of it is taken off [Richardson1911],
// which leaves the fourth power.
TEST_F(Hemicube, ReceiverErrorFallsWithTheFourthPowerOfItsParts) {
  double error[3] = {};
  const int parts[3] = {2, 4, 8};
  for (int k = 0; k < 3; ++k) {
    HemicubeSettings settings;
    settings.nearDistance = 1e6f;
    settings.mostParts = parts[k];
    SceneBuilder builder;
    const int m = lambertian(builder, 0.5);
    builder.plate({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, m);
    builder.plate({0, 0.5, 0}, {1, 0, 0}, {0, 0, 1}, m);
    const Computed c = compute(builder.scene(), settings);
    error[k] = std::abs(0.5 * (c.sum(0, 2, 3) + c.sum(1, 2, 3)) / 0.415253283577147 - 1.0);
  }
  EXPECT_GT(std::log2(error[0] / error[1]), 1.7);  // two parts a side are too few for the limit
  EXPECT_NEAR(std::log2(error[1] / error[2]), 4.0, 0.5);
  EXPECT_LT(error[2], 0.001) << error[0] << " " << error[1];
}

TEST_F(Hemicube, SmallSourcesAreNeitherMissedNorExaggerated) {
  // A source of side 0.02 at distance 1: alone, pixels miss it in 59 of 100 hemicubes of 64 pixels.
  int missed = 0;
  double squares[2] = {0.0, 0.0};
  constexpr int kTries = 40;
  for (int t = 0; t < kTries; ++t) {
    SceneBuilder builder = probeScene();
    const int light = lambertian(builder, 0.0, 100.0);
    const double x = std::sin(7.3 * t), z = std::cos(3.1 * t);
    builder.plate({0.9 * x, 1.0, 0.9 * z}, {0.02, 0, 0}, {0, 0, 0.02}, light);
    builder.plate({0, 1.5, 0}, {20, 0, 0}, {0, 0, 20}, 0);
    const double r2 = 1.0 + 0.81 * (x * x + z * z), exact = 4e-4 / (std::numbers::pi * r2 * r2);
    HemicubeSettings settings;
    settings.seed = static_cast<std::uint32_t>(t);
    HemicubeSettings pixels = pixelsAlone(64);
    pixels.seed = settings.seed;
    const double with = compute(builder.scene(), settings).sum(0, 1, 2) / exact,
                 alone = compute(builder.scene(), pixels).sum(0, 1, 2) / exact;
    missed += alone == 0.0;
    squares[0] += (with - 1.0) * (with - 1.0) / kTries;
    squares[1] += (alone - 1.0) * (alone - 1.0) / kTries;
  }
  EXPECT_GT(missed, kTries / 4);
  EXPECT_GT(std::sqrt(squares[1]), 0.6);
  EXPECT_LT(std::sqrt(squares[0]), 0.002);
}

TEST_F(Hemicube, BacksBlockAndSendNothing) {
  SceneBuilder builder = probeScene();
  builder.plate({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 0);
  builder.plate({0, 0.5, 0}, {0, 0, 4}, {4, 0, 0}, 0);  // faces up: its back hides the other
  const Computed c = compute(builder.scene(), {});
  EXPECT_EQ(c.sum(0, 1, 4), 0.0);
  EXPECT_NEAR(c.backs[0], 0.9468, 0.01);  // a square of side 8 distances
  // A sheet of two fronts in one place: the side that looks here wins.
  SceneBuilder sheet = probeScene();
  sheet.plate({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, 0);
  sheet.plate({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 0);
  const Computed s = compute(sheet.scene(), {});
  EXPECT_NEAR(s.sum(0, 3, 4), 0.239456470460774, 1e-4);
  EXPECT_EQ(s.backs[0], 0.0);
}

TEST_F(Hemicube, PatchesOfAPixelAreHiddenByNearerOnesInAnyOrder) {
  // Triangles of less than a pixel: two plates of them, the farther one inside the shadow of the nearer one.
  constexpr int kSquares = 40;
  const auto addPlate = [](SceneBuilder& builder, double distance, double side) {
    for (int i = 0; i < kSquares; ++i)
      for (int j = 0; j < kSquares; ++j)
        builder.plate({side * ((i + 0.5) / kSquares - 0.5), distance, side * ((j + 0.5) / kSquares - 0.5)},
                      {side / kSquares, 0, 0}, {0, 0, side / kSquares}, 0);
  };
  constexpr std::size_t kPatches = 2 * kSquares * kSquares;
  for (const bool nearFirst : {true, false}) {
    SceneBuilder builder = probeScene();
    addPlate(builder, nearFirst ? 1.0 : 2.0, nearFirst ? 1.0 : 1.8);
    addPlate(builder, nearFirst ? 2.0 : 1.0, nearFirst ? 1.8 : 1.0);
    const Computed c = compute(builder.scene(), pixelsAlone(64));
    const double first = c.sum(0, 1, kPatches), second = c.sum(0, kPatches + 1, 2 * kPatches);
    EXPECT_NEAR(nearFirst ? first : second, 0.239456470460774, 0.004) << nearFirst;
    EXPECT_EQ(nearFirst ? second : first, 0.0) << nearFirst;
  }
}

TEST_F(Hemicube, WhatTouchesThePatchBlocks) {
  // A wall a millionth of the room away from the patch's centre: no near plane lets light past.
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5);
  builder.triangle({-1e-3, 0, 1e-3}, {1e-3, 0, 1e-3}, {0, 0, -2e-3}, m);
  builder.plate({0, 0.5, -1e-5}, {1, 0, 0}, {0, 1, 0}, m);
  builder.plate({0, 5, -5}, {20, 0, 0}, {0, 20, 0}, m);
  const Computed c = compute(builder.scene(), pixelsAlone(64));
  EXPECT_NEAR(c.fronts[0], 0.5, 0.01);
  EXPECT_EQ(c.sum(0, 3, 4), 0.0);
}

TEST_F(Hemicube, BatchesScaleAndPlaceChangeNothing) {
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5), light = lambertian(builder, 0.1, 5.0);
  addSphere(builder, 2.0, 1, true, [&](const glm::dvec3& p) { return p.y > 1.8 ? light : m; });
  addSphere(builder, 0.5, 1, false, [&](const glm::dvec3&) { return m; });
  HemicubeSettings settings, small;
  small.batchBytes = 4 * 64 * 64 * 3 * 5;
  const Scene scene = builder.scene();
  const Computed a = compute(scene, settings), b = compute(scene, small);
  ASSERT_EQ(a.matrix.entryCount(), b.matrix.entryCount());
  for (std::size_t i = 0; i < a.areas.size(); ++i)
    for (std::size_t k = 0; k < a.matrix.row(i).factors.size(); ++k)
      ASSERT_EQ(a.matrix.row(i).factors[k], b.matrix.row(i).factors[k]);  // to the bit
  // The same up to rounding when scaled by a thousand, and moved.
  for (const double scale : {1e-3, 1e3}) {
    Scene moved = scene;
    for (Vertex& v : moved.vertices) v.position = glm::vec3(scale * (glm::dvec3(v.position) + glm::dvec3(1, 2, 3)));
    const Computed c = compute(moved, settings);
    double off = 0.0;
    for (std::size_t i = 0; i < a.areas.size(); i += 9)
      for (std::size_t j = 0; j < a.areas.size(); ++j) off += std::abs(a.factor(i, j) - c.factor(i, j));
    EXPECT_LT(off / (static_cast<double>(a.areas.size()) / 9.0), 0.01) << scale;
  }
}

TEST_F(Hemicube, ASphereSeesItselfAlikeEverywhere) {
  // F_ij = A_j / (4 pi R^2) from anywhere: the whole matrix at once. Finds wrong maps, which sums cannot.
  const auto rms = [&](const HemicubeSettings& settings, int level = 1) {
    SceneBuilder builder;
    addSphere(builder, 1.0, level, true, [m = lambertian(builder, 0.5)](const glm::dvec3&) { return m; });
    const Computed c = compute(builder.scene(), settings);
    const double whole = std::accumulate(c.areas.begin(), c.areas.end(), 0.0);
    double squares = 0.0;
    for (std::size_t i = 0; i < c.areas.size(); ++i)
      for (std::size_t j = 0; j < c.areas.size(); ++j)
        if (i != j) squares += std::pow(c.factor(i, j) * whole / c.areas[j] - 1.0, 2.0);
    return std::sqrt(squares / static_cast<double>(c.areas.size() * (c.areas.size() - 1)));
  };
  HemicubeSettings published = pixelsAlone(128);
  published.map = DeltaMap::published;
  EXPECT_LT(rms({}, 2), 0.06);  // of flat triangles: less with every level
  EXPECT_LT(rms(pixelsAlone(128)), 0.12);
  EXPECT_GT(rms(published), 0.2);
}

}  // namespace
}  // namespace lucerna
