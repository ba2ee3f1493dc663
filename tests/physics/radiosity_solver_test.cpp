// The solvers on exact form factors: known answers, the counts that others need, stiff systems, and a stop that never
// under-reports.
#include "base/error.hpp"
#include "radiosity/form_factor_matrix.hpp"
#include "radiosity/hemicube_map.hpp"
#include "radiosity/solvers.hpp"
#include "support/form_factor_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <utility>

namespace lucerna {
namespace {

constexpr RadiositySolver kAll[] = {RadiositySolver::jacobi, RadiositySolver::gaussSeidel, RadiositySolver::progressive,
                                    RadiositySolver::anderson, RadiositySolver::conjugateGradients};

FormFactorMatrix matrixOf(const std::vector<std::vector<double>>& dense) {
  FormFactorMatrix matrix;
  for (const auto& row : dense) {
    std::vector<std::uint32_t> patches;
    std::vector<float> factors;
    for (std::size_t j = 0; j < row.size(); ++j)
      if (row[j] > 0.0) patches.push_back(static_cast<std::uint32_t>(j)), factors.push_back(static_cast<float>(row[j]));
    matrix.appendRow(patches, factors);
  }
  return matrix;
}

/// The closed cube of n x n squares a wall; its ceiling's middle 4/64 shine (1/96 of the whole area).
struct Cube {
  FormFactorMatrix matrix;
  RadiositySystem system;

  explicit Cube(int n) {
    const auto squares = reference::cubeSquares(n);
    std::vector<std::vector<double>> dense;
    for (const auto& a : squares) {
      auto& row = dense.emplace_back();
      for (const auto& b : squares) row.push_back(&a == &b ? 0.0 : reference::areaToArea(a, b, 4));
      system.areas.push_back(a.area());
    }
    matrix = matrixOf(dense);
    matrix.repair(system.areas, std::vector<double>(squares.size(), 1.0));
    system.rowSums = matrix.rowSums();
    system.matrix = &matrix;
    system.reciprocal = true;
    system.product = [this](auto x, auto y) { matrix.multiply(x, y); };
    system.emission.assign(squares.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const glm::dvec3 c = squares[i].corner + 0.5 * (squares[i].u + squares[i].v) - glm::dvec3(0.5);
      if (c.y > 0.499 && std::abs(c.x) < 0.125 && std::abs(c.z) < 0.125) system.emission[i] = glm::dvec3(1.0);
    }
    setReflectance(0.5);
  }
  Cube(const Cube&) = delete;
  void setReflectance(double rho) { system.reflectance.assign(system.areas.size(), glm::dvec3(rho)); }
};

/// By elimination, of the same float matrix.
std::vector<double> solvedDirectly(const RadiositySystem& s, int channel) {
  const std::size_t n = s.areas.size();
  std::vector<std::vector<double>> a(n, std::vector<double>(n, 0.0));
  std::vector<double> b(n);
  for (std::size_t i = 0; i < n; ++i) {
    a[i][i] = 1.0;
    const auto row = s.matrix->row(i);
    for (std::size_t k = 0; k < row.patches.size(); ++k)
      a[i][row.patches[k]] -= s.reflectance[i][channel] * row.scale * static_cast<double>(row.factors[k]);
    b[i] = s.emission[i][channel];
  }
  for (std::size_t k = 0; k < n; ++k)  // diagonally dominant: no pivoting
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n && f != 0.0; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

double worstError(const std::vector<glm::dvec3>& b, const std::vector<double>& exact, int channel = 0) {
  const double mean = std::accumulate(exact.begin(), exact.end(), 0.0) / static_cast<double>(exact.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) worst = std::max(worst, std::abs(b[i][channel] - exact[i]) / mean);
  return worst;
}

class RadiositySolvers : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { cube_ = std::make_unique<Cube>(8); }
  static void TearDownTestSuite() { cube_.reset(); }
  static Cube& cube() { return *cube_; }

 private:
  inline static std::unique_ptr<Cube> cube_;
};

TEST_F(RadiositySolvers, AllAgreeWithElimination) {
  for (const double rho : {0.5, 0.9}) {
    cube().setReflectance(rho);
    const auto exact = solvedDirectly(cube().system, 0);
    for (const RadiositySolver solver : kAll) {
      SolverSettings settings;
      settings.solver = solver;
      settings.error = 1e-8;
      const RadiositySolved solved = solveRadiosity(cube().system, settings);
      EXPECT_TRUE(solved.reached) << nameOf(solver);
      EXPECT_LT(worstError(solved.exitance, exact), 1e-8) << nameOf(solver) << " " << rho;
      EXPECT_LT(std::abs(solved.progress.energyBalance), 1e-5) << nameOf(solver);
    }
  }
}

TEST_F(RadiositySolvers, TheBoundIsNeverBelowTheError) {
  for (const double rho : {0.3, 0.8, 0.95}) {
    cube().setReflectance(rho);
    const auto exact = solvedDirectly(cube().system, 0);
    for (const RadiositySolver solver : kAll)
      for (const double error : {1.0, 0.1, 1e-2, 1e-3, 1e-5}) {
        SolverSettings settings;
        settings.solver = solver;
        settings.error = error;
        const RadiositySolved solved = solveRadiosity(cube().system, settings);
        EXPECT_LE(worstError(solved.exitance, exact), solved.progress.errorBound * (1.0 + 1e-6) + 1e-12)
            << nameOf(solver) << " " << rho << " " << error;
        EXPECT_LE(solved.progress.errorBound, error);
      }
  }
}

// From the solution of another light, and from an arbitrary one; a channel that is dark has no light left from before.
TEST_F(RadiositySolvers, AnySolutionIsAStartAndANearOneSavesProducts) {
  cube().setReflectance(0.8);
  RadiositySystem near = cube().system;
  near.emission[0] += glm::dvec3(1e-3);
  for (glm::dvec3& emission : near.emission) emission.z = 0.0;
  const auto exact = solvedDirectly(near, 0);
  for (const RadiositySolver solver : kAll) {
    SolverSettings settings;
    settings.solver = solver;
    settings.error = 1e-6;
    const std::vector<glm::dvec3> before = solveRadiosity(cube().system, settings).irradiance;
    std::vector<glm::dvec3> arbitrary = before;
    for (std::size_t i = 0; i < arbitrary.size(); ++i) arbitrary[i] *= i % 3 ? -2.0 : 30.0;
    const double products = solveRadiosity(near, settings).progress.products;
    for (const bool isNear : {true, false}) {
      settings.start = isNear ? before : arbitrary;
      const RadiositySolved solved = solveRadiosity(near, settings);
      EXPECT_TRUE(solved.reached) << nameOf(solver);
      EXPECT_LE(worstError(solved.exitance, exact), solved.progress.errorBound * (1.0 + 1e-6)) << nameOf(solver);
      EXPECT_LT(solved.progress.products, isNear ? products : 1e9) << nameOf(solver);
      for (const glm::dvec3& b : solved.exitance) ASSERT_EQ(b.z, 0.0) << nameOf(solver);
    }
  }
}

TEST_F(RadiositySolvers, StiffRoomsNeedFewerThanTwentyProducts) {
  for (const double rho : {0.9, 0.99, 0.999, 0.9999}) {
    cube().setReflectance(rho);
    const auto exact = solvedDirectly(cube().system, 0);
    const RadiositySolved solved = solveRadiosity(cube().system, {});
    EXPECT_EQ(solved.solver, RadiositySolver::conjugateGradients);
    EXPECT_TRUE(solved.reached) << rho;
    EXPECT_LT(solved.progress.products, 20.0) << rho;
    EXPECT_LT(worstError(solved.exitance, exact), 1e-6) << rho;
    RecordProperty("products", std::to_string(solved.progress.products));
  }
}

// The least number of products after which the true error is below 1e-3: reference values from exact form factors at
// this mesh and light.
TEST_F(RadiositySolvers, NeedAsManyProductsAsPublishedMethodsDo) {
  struct Expected {
    RadiositySolver solver;
    double rho[3];  // .5, .8, .95
    double slack;
  };
  const Expected table[] = {
      {RadiositySolver::jacobi, {7, 27, 132}, 1.01},
      {RadiositySolver::gaussSeidel, {4, 14, 67}, 1.01},
      {RadiositySolver::conjugateGradients, {3, 5, 5}, 2.01},  // ours counts the final check and the right side
      {RadiositySolver::anderson, {4, 5, 6}, 1.01},
      {RadiositySolver::progressive, {3.2, 13.2, 66}, 1.01}};
  const double rhos[3] = {0.5, 0.8, 0.95};
  for (const Expected& row : table)
    for (int k = 0; k < 3; ++k) {
      cube().setReflectance(rhos[k]);
      const auto exact = solvedDirectly(cube().system, 0);
      double squares = 0.0;
      for (const double b : exact) squares += b * b;
      double needed = 0.0;
      const int start = std::max(1, static_cast<int>(0.8 * row.rho[k]) - 2);  // one that needs fewer is found out too
      for (int most = start; most < 200 && needed == 0.0; ++most) {
        SolverSettings settings;
        settings.solver = row.solver;
        settings.error = 1e-14;
        settings.mostProducts = most;
        const RadiositySolved solved = solveRadiosity(cube().system, settings);
        double off = 0.0;
        for (std::size_t i = 0; i < exact.size(); ++i)
          off += (solved.exitance[i].x - exact[i]) * (solved.exitance[i].x - exact[i]);
        if (off < 1e-6 * squares) needed = most;
      }
      EXPECT_NEAR(needed, row.rho[k], row.slack + 0.03 * row.rho[k]) << nameOf(row.solver) << " " << rhos[k];
    }
}

// The steps of [RAD2008, section 2.2.3.1]: after so many shots, B is theirs, unshot light included.
TEST_F(RadiositySolvers, ProgressiveRefinementStopsAfterAnyShot) {
  cube().setReflectance(0.5);
  const RadiositySystem& s = cube().system;
  const std::size_t n = s.areas.size();
  std::vector<double> all, unshot;
  for (const glm::dvec3& e : s.emission) all.push_back(e.x), unshot.push_back(e.x);
  for (std::size_t shots = 1; shots <= 100; ++shots) {
    std::size_t i = 0;
    for (std::size_t k = 0; k < n; ++k)
      if (unshot[k] * s.areas[k] > unshot[i] * s.areas[i]) i = k;
    const auto row = s.matrix->row(i);
    const double shot = std::exchange(unshot[i], 0.0);
    for (std::size_t k = 0; k < row.patches.size(); ++k) {
      const std::size_t j = row.patches[k];
      const double more =
          s.reflectance[j].x * row.scale * static_cast<double>(row.factors[k]) * s.areas[i] / s.areas[j] * shot;
      all[j] += more, unshot[j] += more;
    }
    if (shots != 1 && shots != 10 && shots != 100) continue;
    SolverSettings settings;
    settings.solver = RadiositySolver::progressive;
    settings.error = 0.0;
    settings.mostProducts = (static_cast<double>(shots) - 0.5) / static_cast<double>(n);
    const RadiositySolved solved = solveRadiosity(s, settings);
    EXPECT_NEAR(solved.progress.products, static_cast<double>(shots) / static_cast<double>(n), 1e-9);
    EXPECT_LT(worstError(solved.exitance, all), 1e-9) << shots;
  }
}

TEST_F(RadiositySolvers, RefusesWhatHasNoSolution) {
  cube().setReflectance(1.0);
  cube().system.rowSums.assign(cube().system.areas.size(), 1.0);
  for (const RadiositySolver solver : {RadiositySolver::automatic, RadiositySolver::jacobi}) {
    SolverSettings settings;
    settings.solver = solver;
    try {
      solveRadiosity(cube().system, settings);
      ADD_FAILURE() << "solved";
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::badInput);
      EXPECT_NE(std::string(e.what()).find("closed scene"), std::string::npos);
    }
  }
  cube().system.rowSums = cube().matrix.rowSums();
}

TEST_F(RadiositySolvers, WhiteWallsAreSolvedWhereOneAbsorbs) {
  cube().setReflectance(1.0);
  for (std::size_t i = 0; i < 64; ++i) cube().system.reflectance[i] = glm::dvec3(0.0, 0.5, 0.99);  // the floor
  for (const RadiositySolver solver : {RadiositySolver::automatic, RadiositySolver::anderson}) {
    SolverSettings settings;
    settings.solver = solver;
    const RadiositySolved solved = solveRadiosity(cube().system, settings);
    EXPECT_TRUE(solved.reached);
    for (int c = 0; c < 3; ++c) EXPECT_LT(worstError(solved.exitance, solvedDirectly(cube().system, c), c), 1e-6) << c;
  }
}

TEST_F(RadiositySolvers, ChannelsDoNotMixAndLightIsLinear) {
  cube().setReflectance(0.7);
  for (auto& r : cube().system.reflectance) r = glm::dvec3(0.7, 0.2, 0.0);
  const auto emission = cube().system.emission;
  SolverSettings settings;
  settings.error = 1e-10;
  const RadiositySolved one = solveRadiosity(cube().system, settings);
  for (auto& e : cube().system.emission) e *= glm::dvec3(1000.0, 1e-6, 0.0);
  const RadiositySolved scaled = solveRadiosity(cube().system, settings);
  for (std::size_t i = 0; i < emission.size(); ++i) {
    EXPECT_NEAR(scaled.exitance[i].x / one.exitance[i].x, 1000.0, 1e-5);
    EXPECT_NEAR(scaled.exitance[i].y / one.exitance[i].y, 1e-6, 1e-14);
    EXPECT_EQ(scaled.exitance[i].z, 0.0);
    EXPECT_EQ(one.exitance[i].z, emission[i].z);
  }
  cube().system.emission = emission;
}

// ---------------------------------------------------------------------------------------------------- known answers

TEST(RadiosityKnown, TheSixPatchCube) {
  std::vector<std::vector<double>> dense(6, std::vector<double>(6));
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      dense[i][j] = i == j ? 0.0 : i / 2 == j / 2 ? 0.199824895698387 : 0.200043776075403;
  const FormFactorMatrix matrix = matrixOf(dense);
  const double table[3][4] = {{0.5, 1.09090909811, 0.181745826108, 0.181836268946},
                              {0.8, 1.55172415364, 0.689551070738, 0.689681193904},
                              {0.95, 4.03361346590, 3.19315984515, 3.19330667224}};
  for (const auto& [rho, ceiling, floor, walls] : table)
    for (const RadiositySolver solver : kAll) {
      RadiositySystem system;
      system.areas.assign(6, 1.0);
      system.reflectance.assign(6, glm::dvec3(rho));
      system.emission.assign(6, glm::dvec3(0.0));
      system.emission[1] = glm::dvec3(1.0);
      system.rowSums = matrix.rowSums();
      system.matrix = &matrix;
      system.reciprocal = true;
      system.product = [&](auto x, auto y) { matrix.multiply(x, y); };
      SolverSettings settings;
      settings.solver = solver;
      settings.error = 1e-9;
      const RadiositySolved solved = solveRadiosity(system, settings);
      EXPECT_NEAR(solved.exitance[1].x, ceiling, 3e-6) << nameOf(solver);  // factors are floats
      EXPECT_NEAR(solved.exitance[0].x, floor, 3e-6) << nameOf(solver);
      EXPECT_NEAR(solved.exitance[3].x, walls, 3e-6) << nameOf(solver);
    }
}

TEST(RadiosityKnown, RepairMakesReciprocityAndSums) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(0.7, 1.3);
  const auto squares = reference::cubeSquares(3);
  std::vector<std::vector<double>> dense;
  std::vector<double> areas;
  for (const auto& a : squares) {
    auto& row = dense.emplace_back();
    for (const auto& b : squares) row.push_back(&a == &b ? 0.0 : noise(random) * reference::areaToArea(a, b, 3));
    areas.push_back(a.area());
  }
  FormFactorMatrix matrix = matrixOf(dense);
  EXPECT_GT(matrix.reciprocityError(areas), 0.3);
  EXPECT_LT(matrix.repair(areas, std::vector<double>(areas.size(), 1.0)), 1e-6);
  EXPECT_LT(matrix.reciprocityError(areas), 1e-5);
  for (const double sum : matrix.rowSums()) { EXPECT_NEAR(sum, 1.0, 1e-14); }
}

TEST(RadiosityKnown, DeltaFormFactors) {
  for (const int n : {8, 16, 32, 64, 100, 128, 256, 500, 512}) {
    const auto exact = deltaFormFactors(n, DeltaMap::exact);
    EXPECT_NEAR(sumOverHemicube(exact, n), 1.0, 1e-12);
    EXPECT_NEAR(std::accumulate(exact.begin(), exact.begin() + n * n, 0.0), 0.554126423979572, 1e-12);
    EXPECT_NEAR(std::accumulate(exact.begin() + n * n, exact.end(), 0.0), 0.111468394005107, 1e-12);
    EXPECT_NEAR(sumOverHemicube(deltaFormFactors(n, DeltaMap::published), n), 1.0, 1e-12);
  }
  // The published map: the middle of the full face has a third of its weight.
  const auto exact = deltaFormFactors(1024, DeltaMap::exact), published = deltaFormFactors(1024, DeltaMap::published);
  EXPECT_NEAR(exact[512 * 1024 + 512] * 1024 * 1024, 1.27322, 1e-4);
  EXPECT_LT(published[512 * 1024 + 512], 0.7 * exact[512 * 1024 + 512]);
}

TEST(RadiosityKnown, TheReferenceKnowsTheClosedForms) {
  EXPECT_NEAR(reference::opposedSquares(1.0), 0.199824895698387, 1e-14);
  const auto walls = reference::cubeSquares(1);
  EXPECT_NEAR(reference::areaToArea(walls[0], walls[1], 12), 0.199824895698387, 1e-10);
  EXPECT_NEAR(reference::areaToArea(walls[0], walls[2], 24), 0.200043776075403, 1e-4);
  const glm::dvec3 wall[4] = {{-0.5, 0, 1}, {0.5, 0, 1}, {0.5, 1, 1}, {-0.5, 1, 1}};
  EXPECT_NEAR(reference::pointToPolygon({0, 0, 0}, {0, 1, 0}, wall), 0.0710934390469455, 1e-14);
}

}  // namespace
}  // namespace lucerna
