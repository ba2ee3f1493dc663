// Three ways to tell what a hemicube's pixels see: each against closed forms, their rows against one another, and the
// choice among them.
#include "base/error.hpp"
#include "radiosity/hemicubes.hpp"
#include "radiosity/solution.hpp"
#include "support/faulty_shaders.hpp"
#include "support/gl_fixture.hpp"
#include "support/radiosity_scenes.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lucerna {
namespace {

using test::cubeRoom;
using test::lambertian;
using test::pixelsAlone;
using test::SceneBuilder;

constexpr HemicubeVisibility kWays[] = {HemicubeVisibility::raster, HemicubeVisibility::rays,
                                        HemicubeVisibility::itemBuffer};

class HemicubeVisibilityTest : public test::SharedProgramsTest {
 protected:
  struct Rows {
    std::vector<std::vector<double>> factors;  // dense
    std::vector<double> fronts, backs;
  };
  static Rows rowsBy(HemicubeVisibility way, const Scene& scene, HemicubeSettings settings) {
    settings.visibility = way;
    const RadiosityMesh mesh = makePatches(scene, {});
    Hemicubes hemicubes(library(), capabilities(), mesh, settings);
    EXPECT_EQ(hemicubes.visibility(), way);
    EXPECT_TRUE(hemicubes.costs().empty());
    Rows all;
    for (int first = 0; first < hemicubes.patchCount(); first += hemicubes.batchSize()) {
      const FormFactorRows rows =
          hemicubes.rows(first, std::min(hemicubes.batchSize(), hemicubes.patchCount() - first));
      std::size_t at = 0;
      for (std::size_t k = 0; k < rows.counts.size(); ++k) {
        auto& dense = all.factors.emplace_back(mesh.patches.size(), 0.0);
        for (const std::size_t end = at + rows.counts[k]; at < end; ++at)
          dense[rows.patches[at]] = static_cast<double>(rows.factors[at]);
        all.fronts.push_back(static_cast<double>(rows.fronts[k]));
        all.backs.push_back(static_cast<double>(rows.backs[k]));
      }
    }
    return all;
  }
  static Scene litCube(int n) {
    return cubeRoom(n, [](SceneBuilder& builder, int wall, double u, double v) {
      return lambertian(builder, 0.5, wall == 1 && std::abs(u - 0.5) < 0.2 && std::abs(v - 0.5) < 0.2 ? 1.0 : 0.0);
    });
  }
};

TEST_F(HemicubeVisibilityTest, EachMeetsClosedForms) {
  // A tiny triangle that looks up at a square, and at a wall. The item buffer snaps corners to 1/256 of a pixel.
  for (const HemicubeVisibility way : kWays) {
    const auto factor = [&](const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v,
                            const HemicubeSettings& settings) {
      SceneBuilder builder;
      const int m = lambertian(builder, 0.5);
      builder.triangle({-1e-4, 0, 1e-4}, {1e-4, 0, 1e-4}, {0, 0, -2e-4}, m);
      builder.plate(centre, u, v, m);
      const Rows rows = rowsBy(way, builder.scene(), settings);
      return rows.factors[0][1] + rows.factors[0][2];
    };
    const double closedForm = way == HemicubeVisibility::itemBuffer ? 2e-3 : 2e-5;
    EXPECT_NEAR(factor({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {}) / 0.239456470460774, 1.0, closedForm) << nameOf(way);
    EXPECT_NEAR(factor({0, 0.5, -0.5}, {1, 0, 0}, {0, 1, 0}, {}) / 0.190135882384807, 1.0, closedForm) << nameOf(way);
    EXPECT_NEAR(factor({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, pixelsAlone(256)) / 0.239456470460774, 1.0, 0.004)
        << nameOf(way);
    EXPECT_NEAR(factor({0, 0.5, -0.5}, {1, 0, 0}, {0, 1, 0}, pixelsAlone(256)) / 0.190135882384807, 1.0, 0.006)
        << nameOf(way);
  }
}

// Two sheets in one place, back to back: the one that shows its front is met, whichever comes first in the scene.
TEST_F(HemicubeVisibilityTest, OfTwoSheetsInOnePlaceTheFrontIsMet) {
  const glm::dvec3 u{1, 0, 0}, v{0, 0, 1};
  for (const HemicubeVisibility way : kWays)
    for (const bool frontFirst : {true, false}) {
      SceneBuilder builder;
      const int m = lambertian(builder, 0.5);
      builder.triangle({-1e-4, 0, 1e-4}, {1e-4, 0, 1e-4}, {0, 0, -2e-4}, m);
      builder.plate({0, 1, 0}, frontFirst ? u : v, frontFirst ? v : u, m);
      builder.plate({0, 1, 0}, frontFirst ? v : u, frontFirst ? u : v, m);
      const Rows rows = rowsBy(way, builder.scene(), pixelsAlone(256));
      const double first = rows.factors[0][1] + rows.factors[0][2], second = rows.factors[0][3] + rows.factors[0][4];
      EXPECT_NEAR((frontFirst ? first : second) / 0.239456470460774, 1.0, 0.004)
          << nameOf(way) << ", front first: " << frontFirst;
      EXPECT_EQ(frontFirst ? second : first, 0.0) << nameOf(way);
      EXPECT_EQ(rows.backs[0], 0.0) << nameOf(way);
    }
}

TEST_F(HemicubeVisibilityTest, NothingIsLostInAClosedRoom) {
  for (const HemicubeVisibility way : kWays)
    for (const int n : {16, 64}) {
      const Rows rows = rowsBy(way, cubeRoom(5, 0.5, 1.0), pixelsAlone(n));
      for (std::size_t i = 0; i < rows.factors.size(); ++i) {
        ASSERT_NEAR(rows.fronts[i], 1.0, 2e-6) << nameOf(way) << ' ' << i;
        ASSERT_NEAR(std::accumulate(rows.factors[i].begin(), rows.factors[i].end(), 0.0), 1.0, 2e-6)
            << nameOf(way) << ' ' << i;
        ASSERT_EQ(rows.backs[i], 0.0) << nameOf(way);
      }
    }
}

TEST_F(HemicubeVisibilityTest, RowsAgree) {
  // Occluders, backs, sheets of one and of two fronts, a small source: what two rows of one patch differ by, in parts
  // of the hemisphere.
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5), lamp = lambertian(builder, 0.5, 10.0);
  addSphere(builder, 2.0, 2, true, [&](const glm::dvec3&) { return m; });
  addSphere(builder, 0.5, 1, false, [&](const glm::dvec3&) { return m; });
  builder.plate({0.9, 0.3, 0.1}, {0.5, 0.2, 0}, {0, 0.5, 0.4}, m);
  builder.plate({-1.0, 0.2, 0.1}, {0.5, 0.2, 0}, {0, 0.5, 0.4}, m);
  builder.plate({-1.0, 0.2, 0.1}, {0, 0.5, 0.4}, {0.5, 0.2, 0}, m);
  builder.plate({0.2, 1.2, 0.1}, {0.02, 0, 0}, {0, 0, 0.02}, lamp);
  const Scene scene = builder.scene();
  for (const int exactPixels : {0, 12}) {
    HemicubeSettings settings = pixelsAlone(64);
    settings.exactPixels = exactPixels;
    const Rows raster = rowsBy(HemicubeVisibility::raster, scene, settings);
    EXPECT_GT(*std::max_element(raster.backs.begin(), raster.backs.end()), 0.01);
    for (const HemicubeVisibility way : {HemicubeVisibility::rays, HemicubeVisibility::itemBuffer}) {
      const Rows other = rowsBy(way, scene, settings);
      double worst = 0.0, mean = 0.0;
      for (std::size_t i = 0; i < raster.factors.size(); ++i) {
        double off = std::abs(raster.backs[i] - other.backs[i]);
        for (std::size_t j = 0; j < raster.factors.size(); ++j)
          off += std::abs(raster.factors[i][j] - other.factors[i][j]);
        worst = std::max(worst, off);
        mean += off / static_cast<double>(raster.factors.size());
      }
      RecordProperty(std::string(nameOf(way)) + std::to_string(exactPixels),
                     std::to_string(mean) + " " + std::to_string(worst));
      EXPECT_LT(mean, way == HemicubeVisibility::rays ? 5e-5 : 2e-3) << nameOf(way) << ' ' << exactPixels;
      EXPECT_LT(worst, way == HemicubeVisibility::rays ? 2e-3 : 0.01) << nameOf(way) << ' ' << exactPixels;
      // A batch leaves nothing behind for the next: in batches of 5 the rows are the same bits.
      HemicubeSettings few = settings;
      few.batchBytes = 5 * 3 * 64 * 64 * sizeof(GLuint);
      const Rows inFives = rowsBy(way, scene, few);
      EXPECT_EQ(inFives.factors, other.factors);
      EXPECT_EQ(inFives.fronts, other.fronts);
      EXPECT_EQ(inFives.backs, other.backs);
    }
  }
}

TEST_F(HemicubeVisibilityTest, TheCheapestIsChosenAndTheOthersAreGone) {
  const RadiosityMesh mesh = makePatches(litCube(5), {});
  HemicubeSettings settings;
  settings.worthMeasuring = 0.0;
  const Hemicubes chosen(library(), capabilities(), mesh, settings);
  ASSERT_EQ(chosen.costs().size(), 3u);
  for (const Hemicubes::Cost& cost : chosen.costs()) {
    EXPECT_GT(cost.milliseconds, 0.0);
    const auto own = std::find_if(chosen.costs().begin(), chosen.costs().end(),
                                  [&](const auto& c) { return c.visibility == chosen.visibility(); });
    EXPECT_GE(cost.milliseconds, own->milliseconds);
    // What another way needs is not kept.
    settings.visibility = cost.visibility;
    const Hemicubes asked(library(), capabilities(), mesh, settings);
    if (cost.visibility == chosen.visibility()) EXPECT_EQ(asked.gpuBytes(), chosen.gpuBytes());
    else EXPECT_NE(asked.gpuBytes(), chosen.gpuBytes());
  }
  // Little work: only raster is compiled.
  gl::ProgramLibrary fresh;
  settings.visibility = HemicubeVisibility::automatic;
  settings.worthMeasuring = 1e6;
  const Hemicubes small(fresh, capabilities(), mesh, settings);
  EXPECT_EQ(small.visibility(), HemicubeVisibility::raster);
  EXPECT_EQ(small.costs().size(), 1u);
  EXPECT_EQ(fresh.statistics().built, 7);
}

TEST_F(HemicubeVisibilityTest, AnItemBufferThatLosesTrianglesIsNotChosen) {
  const test::FaultyShaders shaders;
  const RadiosityMesh mesh = makePatches(litCube(5), {});
  HemicubeSettings settings;
  settings.worthMeasuring = 0.0;
  for (const bool loses : {false, true}) {
    if (loses)
      shaders.plant("radiosity/hemicube_item.frag", "void main() {", "void main() { if (fItem % 20u == 0u) discard;");
    gl::ProgramLibrary library(shaders.path());
    const Hemicubes chosen(library, capabilities(), mesh, settings);
    EXPECT_EQ(chosen.costs().size(), loses ? 2u : 3u);
    for (const Hemicubes::Cost& cost : chosen.costs())
      EXPECT_TRUE(!loses || cost.visibility != HemicubeVisibility::itemBuffer);
    EXPECT_TRUE(!loses || chosen.visibility() != HemicubeVisibility::itemBuffer);
  }
}

TEST_F(HemicubeVisibilityTest, SolutionsAgreeAndAStoppedOneGoesOnAsItBegan) {
  const Scene scene = litCube(4);
  RadiositySolutionSettings settings;
  settings.patches.longestEdge = 1.0;
  settings.error = 1e-6;
  settings.hemicubes.resolution = 64;
  std::vector<RadiositySolution> solutions;
  for (const HemicubeVisibility way : kWays) {
    settings.hemicubes.visibility = way;
    solutions.push_back(solveScene(context(), library(), scene, settings));
    EXPECT_EQ(solutions.back().visibility, way);
    double most = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < solutions[0].exitance.size(); ++i) {
      most = std::max(most, std::abs(solutions.back().irradiance[i].x - solutions[0].irradiance[i].x));
      mean += solutions[0].irradiance[i].x / static_cast<double>(solutions[0].exitance.size());
    }
    EXPECT_LT(most / mean, way == HemicubeVisibility::itemBuffer ? 0.01 : 1e-3) << nameOf(way);
  }
  const test::TempFolder folder;
  const auto file = folder.path() / "rows";
  settings.hemicubes.visibility = HemicubeVisibility::rays;
  settings.hemicubes.batchBytes = 1 << 18;
  EXPECT_THROW(
      solveScene(context(), library(), scene, settings, file,
                 [](const RadiosityStage& s) { return s.kind != RadiosityStage::Kind::formFactors || s.done < 60; }),
      Stopped);
  ASSERT_TRUE(std::filesystem::exists(file));
  settings.hemicubes.visibility = HemicubeVisibility::automatic;
  const RadiositySolution resumed = solveScene(context(), library(), scene, settings, file);
  EXPECT_EQ(resumed.visibility, HemicubeVisibility::rays);
  EXPECT_LT(resumed.hemicubes, solutions[1].hemicubes);
  EXPECT_EQ(resumed.exitance, solutions[1].exitance);
}

TEST_F(HemicubeVisibilityTest, NamesAreReadBack) {
  for (const HemicubeVisibility way : kWays) EXPECT_EQ(parseName<HemicubeVisibility>(nameOf(way), ""), way);
  EXPECT_EQ(parseName<HemicubeVisibility>("auto", ""), HemicubeVisibility::automatic);
  EXPECT_THROW(parseName<HemicubeVisibility>("guess", ""), Error);
}

}  // namespace
}  // namespace lucerna
