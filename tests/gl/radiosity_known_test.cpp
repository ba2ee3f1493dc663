// Form factors and solutions from the GPU against known answers of rooms, bowls and doors.
#include "base/error.hpp"
#include "radiosity/form_factor_matrix.hpp"
#include "radiosity/hemicubes.hpp"
#include "radiosity/solution.hpp"
#include "scene/triangle_parts.hpp"
#include "support/form_factor_reference.hpp"
#include "support/gl_fixture.hpp"
#include "support/long_tests.hpp"
#include "support/radiosity_scenes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

namespace lucerna {
namespace {

using test::cubeRoom;
using test::lambertian;
using test::SceneBuilder;
using test::wholeTriangles;

struct Rows {
  RadiosityMesh mesh;
  FormFactorMatrix matrix;
  std::vector<double> fronts, areas;
  /// Of row i, to the patches that `to` says.
  double sum(std::size_t i, const std::function<bool(std::size_t)>& to) const {
    const FormFactorMatrix::Row row = matrix.row(i);
    double total = 0.0;
    for (std::size_t k = 0; k < row.patches.size(); ++k)
      if (to(row.patches[k])) total += row.scale * static_cast<double>(row.factors[k]);
    return total;
  }
};

class RadiosityKnownOnGl : public test::SharedProgramsTest {
 protected:
  static Rows rowsOf(const Scene& scene, const HemicubeSettings& settings) {
    Rows r;
    r.mesh = makePatches(scene, {});
    Hemicubes hemicubes(library(), capabilities(), r.mesh, settings);
    for (int first = 0; first < hemicubes.patchCount(); first += hemicubes.batchSize()) {
      const FormFactorRows rows =
          hemicubes.rows(first, std::min(hemicubes.batchSize(), hemicubes.patchCount() - first));
      std::size_t at = 0;
      for (std::size_t k = 0; k < rows.counts.size(); at += rows.counts[k], ++k) {
        r.matrix.appendRow(std::span(rows.patches).subspan(at, rows.counts[k]),
                           std::span(rows.factors).subspan(at, rows.counts[k]));
        r.fronts.push_back(static_cast<double>(rows.fronts[k]));
      }
    }
    for (const Patch& patch : r.mesh.patches) r.areas.push_back(patch.area);
    return r;
  }
  static RadiositySolution solve(Scene scene, const RadiositySolutionSettings& settings) {
    scene.sun.reset();
    return solveScene(context(), library(), scene, settings);
  }
};

/// Two rooms, unit cubes side by side along x, the wall between them of fronts both ways and no thickness, with a door
/// of a third of its sides in the middle. `material(room, wall)`: walls as in cubeRoom.
constexpr double kDoor = 1.0 / 3.0;
Scene twoRooms(int n, const std::function<int(SceneBuilder&, int room, int wall)>& material) {
  SceneBuilder builder;
  const glm::dvec3 walls[6][3] = {{{0, -0.5, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 0.5, 0}, {1, 0, 0}, {0, 0, 1}},
                                  {{0, 0, -0.5}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 0.5}, {0, 1, 0}, {1, 0, 0}},
                                  {{-0.5, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0.5, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
  for (int room = 0; room < 2; ++room)
    for (int w = 0; w < 6; ++w)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const double u = (i + 0.5) / n - 0.5, v = (j + 0.5) / n - 0.5;
          const bool shared = (room == 0 && w == 5) || (room == 1 && w == 4);
          if (shared && std::max(std::abs(u), std::abs(v)) < 0.5 * kDoor) continue;
          builder.plate(glm::dvec3(room, 0, 0) + walls[w][0] + u * walls[w][1] + v * walls[w][2],
                        walls[w][1] / static_cast<double>(n), walls[w][2] / static_cast<double>(n),
                        material(builder, room, w));
        }
  return builder.scene();
}

TEST_F(RadiosityKnownOnGl, ThroughADoorAsMuchGoesOneWayAsTheOther) {
  // Rooms are convex, so a patch sends its closed form factor to the door into the other room; summed over a room that
  // is the door's own area.
  int grey = -1;
  const Scene scene =
      twoRooms(3, [&](SceneBuilder& b, int, int) { return grey < 0 ? grey = lambertian(b, 0.5) : grey; });
  HemicubeSettings settings;
  settings.resolution = 128;
  settings.nearDistance = 0.0f;  // from centroids, as the closed form below
  const Rows r = rowsOf(scene, settings);
  const std::size_t half = r.areas.size() / 2;
  const std::vector<glm::dvec3> door{{0.5, -0.5 * kDoor, -0.5 * kDoor},
                                     {0.5, -0.5 * kDoor, 0.5 * kDoor},
                                     {0.5, 0.5 * kDoor, 0.5 * kDoor},
                                     {0.5, 0.5 * kDoor, -0.5 * kDoor}};
  double squares = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < r.areas.size(); ++i) {
    // Closed but for the door, and the wall is two sheets in one place, cut along other diagonals: the front that looks
    // here wins. Nothing is lost; where the floor behind the wall meets it, a pixel may hold both at one distance, and
    // counts for both.
    ASSERT_GE(r.fronts[i], 1.0 - 1e-5) << i;
    ASSERT_LE(r.fronts[i], 1.0 + 2.0 * 4.0 / (std::numbers::pi * 128.0 * 128.0)) << i;
    const Patch& patch = r.mesh.patches[i];
    const double across = r.sum(i, [&](std::size_t j) { return (j < half) != (i < half); });
    const double exact = std::abs(patch.centroid.x - 0.5) < 1e-6
                             ? 0.0
                             : reference::pointToPolygon(patch.centroid, patch.faceNormal, door);
    squares += (across - exact) * (across - exact);
    mean += exact;
  }
  EXPECT_LT(std::sqrt(squares * static_cast<double>(r.areas.size())) / mean,
            0.04);  // pixels decide what is seen through the door

  // One room lit: what goes through the door less what comes back is what the other room absorbs.
  int lit = -1, dark = -1;
  const Scene lamp = twoRooms(6, [&](SceneBuilder& b, int room, int wall) {
    if (lit < 0) lit = lambertian(b, 0.8, 1.0), dark = lambertian(b, 0.8);
    return room == 0 && wall == 1 ? lit : dark;
  });
  RadiositySolutionSettings fine = wholeTriangles();
  const RadiositySolution s = solve(lamp, fine);
  const Rows f = rowsOf(lamp, fine.hemicubes);
  double there = 0.0, back = 0.0, absorbed = 0.0, through[2] = {};
  for (std::size_t i = 0; i < f.areas.size(); ++i) {
    const bool second = f.mesh.patches[i].centroid.x > 0.5 + 1e-9 ||
                        (std::abs(f.mesh.patches[i].centroid.x - 0.5) < 1e-9 && f.mesh.patches[i].faceNormal.x > 0.0);
    const auto other = [&](std::size_t j) {
      const Patch& p = f.mesh.patches[j];
      return (p.centroid.x > 0.5 + 1e-9 || (std::abs(p.centroid.x - 0.5) < 1e-9 && p.faceNormal.x > 0.0)) != second;
    };
    const double across = f.areas[i] * f.sum(i, other);
    through[second] += across;
    (second ? back : there) += s.exitance[i].x * across;
    if (second) absorbed += f.areas[i] * (1.0 - 0.8) * s.irradiance[i].x;
  }
  // What a patch sees of the door is asked at its centre: off by the square of its size, 4 % with patches as large as
  // the door, here a quarter of that.
  for (const double area : through) EXPECT_NEAR(area / (kDoor * kDoor), 1.0, 0.02);
  EXPECT_NEAR(through[0] / through[1], 1.0, 0.01);
  EXPECT_GT(back, 0.05 * there);
  EXPECT_NEAR((there - back) / absorbed, 1.0, 0.02);
}

TEST_F(RadiosityKnownOnGl, TwoRoomsTakeKrylovSolversFewProducts) {
  // Light goes back and forth through the door. The slowest modes are constant in each room, and these solvers find
  // them.
  int lit = -1, grey = -1;
  const Scene scene = twoRooms(3, [&](SceneBuilder& b, int room, int wall) {
    if (lit < 0) lit = lambertian(b, 0.95, 1.0), grey = lambertian(b, 0.95);
    return room == 0 && wall == 1 ? lit : grey;
  });
  RadiositySolutionSettings settings = wholeTriangles(1e-8);
  const RadiositySolution best = solve(scene, settings);
  const auto products = [&](RadiositySolver solver, double error) {
    RadiositySolutionSettings one = wholeTriangles(error);
    one.solver = solver;
    const RadiositySolution s = solve(scene, one);
    EXPECT_TRUE(s.reached);
    double mean = 0.0, area = 0.0, worst = 0.0;
    for (std::size_t i = 0; i < s.exitance.size(); ++i) {
      mean += s.mesh.patches[i].area * best.exitance[i].x, area += s.mesh.patches[i].area;
      worst = std::max(worst, std::abs(s.exitance[i].x - best.exitance[i].x));
    }
    EXPECT_LE(worst / (mean / area), error) << nameOf(solver);
    return s.progress.products;
  };
  EXPECT_GT(products(RadiositySolver::jacobi, 1e-3), 100.0);
  for (const RadiositySolver solver : {RadiositySolver::conjugateGradients, RadiositySolver::anderson}) {
    const double coarse = products(solver, 1e-3), finer = products(solver, 1e-6);
    std::printf("%s: %g products to 1e-3, %g to 1e-6\n", std::string(nameOf(solver)).c_str(), coarse, finer);
    EXPECT_LT(coarse, 16.0) << nameOf(solver);
    EXPECT_LT(finer - coarse, 12.0) << nameOf(solver);  // a power of ten takes up to four
  }
}

TEST_F(RadiosityKnownOnGl, ReceiverErrorFallsWithTheFourthPowerOfItsPartsAtRightAngles) {
  // Unit squares with a common edge.
  double error[3] = {};
  for (int k = 0; k < 3; ++k) {
    HemicubeSettings settings;
    settings.resolution = 256;
    settings.nearDistance = 1e6f;
    settings.mostParts = 2 << k;
    SceneBuilder builder;
    const int m = lambertian(builder, 0.5);
    builder.plate({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, m);
    builder.plate({0, 0.5, -0.5}, {1, 0, 0}, {0, 1, 0}, m);
    const Rows r = rowsOf(builder.scene(), settings);
    const auto wall = [](std::size_t j) { return j >= 2; };
    error[k] = std::abs(0.5 * (r.sum(0, wall) + r.sum(1, wall)) / 0.200043776075403 - 1.0);
  }
  // The square of what centroids alone would leave: two numbers of parts take its first term off.
  EXPECT_NEAR(std::log2(error[0] / error[1]), 4.0, 0.5);
  EXPECT_NEAR(std::log2(error[1] / error[2]), 4.0, 0.5);
  EXPECT_LT(error[2], 2e-4);
}

TEST_F(RadiosityKnownOnGl, AnyClosedMeshIsAFurnace) {
  // A ball with dents and bumps is not convex, so patches occlude one another.
  SceneBuilder builder;
  const int m = lambertian(builder, 0.9, 1.0);
  addSphere(builder, 1.0, 2, true, [&](const glm::dvec3&) { return m; });
  Scene scene = builder.scene();
  std::mt19937 random(11);
  std::map<std::array<float, 3>, float> radius;  // corners at one place stay at one place
  for (Vertex& v : scene.vertices) {
    const auto [it, fresh] = radius.try_emplace({v.position.x, v.position.y, v.position.z}, 0.0f);
    if (fresh) it->second = std::uniform_real_distribution<float>(0.6f, 1.4f)(random);
    v.position *= it->second;
    v.normal = glm::vec3(0.0f);  // the winding says where fronts are
  }
  const RadiositySolution s = solve(scene, wholeTriangles());
  for (std::size_t i = 0; i < s.exitance.size(); ++i) {
    ASSERT_NEAR(s.exitance[i].x, 10.0, 3e-3) << i;
    ASSERT_NEAR(s.fronts[i], 1.0f, 2e-5f) << i;
  }
  EXPECT_GT(s.entries, 10000u);
  EXPECT_LT(s.entries, s.exitance.size() * (s.exitance.size() - 1) * 9 / 10)
      << "nothing hides anything: this mesh is convex";
}

TEST_F(RadiosityKnownOnGl, TheSixWallsOfACube) {
  // The GPU's factors, two triangles per wall, summed to those of walls, whose exitances are known.
  HemicubeSettings settings;
  settings.resolution = 64;
  settings.nearDistance = 8.0f;
  settings.mostParts = 16;
  const Rows r = rowsOf(cubeRoom(1, 0.5, 1.0), settings);
  FormFactorMatrix walls;
  for (std::size_t i = 0; i < 6; ++i) {
    std::vector<std::uint32_t> patches;
    std::vector<float> factors;
    for (std::uint32_t j = 0; j < 6; ++j) {
      if (i == j) continue;
      const auto to = [j](std::size_t k) { return k / 2 == j; };
      patches.push_back(j);
      factors.push_back(static_cast<float>(0.5 * (r.sum(2 * i, to) + r.sum(2 * i + 1, to))));
    }
    walls.appendRow(patches, factors);
  }
  RadiositySystem system;
  system.areas.assign(6, 1.0);
  system.emission.assign(6, glm::dvec3(0.0));
  system.emission[1] = glm::dvec3(1.0);
  walls.repair(system.areas, std::vector<double>(6, 1.0));
  system.rowSums = walls.rowSums();
  system.matrix = &walls;
  system.reciprocal = true;
  system.product = [&](auto x, auto y) { walls.multiply(x, y); };
  const double table[3][4] = {{0.5, 1.09090909811, 0.181745826108, 0.181836268946},
                              {0.8, 1.55172415364, 0.689551070738, 0.689681193904},
                              {0.95, 4.03361346590, 3.19315984515, 3.19330667224}};
  for (const auto& [rho, ceiling, floor, side] : table) {
    system.reflectance.assign(6, glm::dvec3(rho));
    const RadiositySolved solved = solveRadiosity(system, {});
    EXPECT_NEAR(solved.exitance[1].x / ceiling, 1.0, 0.002) << rho;
    EXPECT_NEAR(solved.exitance[0].x / floor, 1.0, 0.003) << rho;
    for (std::size_t wall = 2; wall < 6; ++wall) EXPECT_NEAR(solved.exitance[wall].x / side, 1.0, 0.003) << rho;
  }
}

TEST_F(RadiosityKnownOnGl, ABowlIsLitAlikeEverywhereWhateverShines) {
  // B = E + rho f <E> / (1 - rho f) inside a cap that is the fraction f of its sphere; E on one side only.
  SceneBuilder builder;
  const int lit = lambertian(builder, 0.6, 1.0), grey = lambertian(builder, 0.6), none = lambertian(builder, 0.0);
  addSphere(builder, 1.0, 2, true, [&](const glm::dvec3& c) { return c.y > 0.3 ? none : c.x > 0.5 ? lit : grey; });
  Scene scene = builder.scene();
  double whole = 0.0;  // of the ball as it is, of flat triangles: 2 % less than a sphere
  for (const Patch& p : makePatches(test::dark(scene), {}).patches) whole += p.area;
  std::erase_if(scene.meshes, [&](const Mesh& mesh) { return mesh.material == none; });
  const RadiositySolution s = solve(scene, wholeTriangles());
  double area = 0.0, emitted = 0.0;
  for (const Patch& p : s.mesh.patches) area += p.area, emitted += p.area * p.emission.x;
  const double f = area / whole, exact = 0.6 * f * (emitted / area) / (1.0 - 0.6 * f);
  ASSERT_GT(f, 0.5);
  ASSERT_LT(f, 0.75);
  double squares = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < s.exitance.size(); ++i) {
    const double reflected = s.exitance[i].x - s.mesh.patches[i].emission.x;
    mean += s.mesh.patches[i].area * reflected / area;
    squares += s.mesh.patches[i].area * std::pow(reflected / exact - 1.0, 2.0) / area;
  }
  EXPECT_NEAR(mean / exact, 1.0, 0.01);  // flat triangles do not see themselves
  EXPECT_LT(std::sqrt(squares), 0.05);
}

TEST_F(RadiosityKnownOnGl, RepairGivesReciprocityAndEnergyThatHemicubesLack) {
  const Scene scene = cubeRoom(4, 0.5, 1.0);
  HemicubeSettings plain;
  plain.resolution = 32;
  plain.exactPixels = 0;
  plain.nearDistance = 0.0f;
  Rows r = rowsOf(scene, plain);
  EXPECT_GT(r.matrix.reciprocityError(r.areas), 0.1);
  r.matrix.repair(r.areas, std::vector<double>(r.areas.size(), 1.0));
  EXPECT_LT(r.matrix.reciprocityError(r.areas), 1e-5);
  for (const double sum : r.matrix.rowSums()) EXPECT_NEAR(sum, 1.0, 1e-12);
  // sum A E = sum A (1 - rho) H with the ceiling lit.
  const auto balance = [&](bool repair) {
    int lit = -1, grey = -1;
    RadiositySolutionSettings settings = wholeTriangles(1e-8);
    settings.hemicubes = plain;
    settings.repair = repair;
    settings.solver = RadiositySolver::anderson;
    const RadiositySolution s = solve(cubeRoom(4,
                                               [&](SceneBuilder& b, int wall, double u, double v) {
                                                 if (lit < 0) lit = lambertian(b, 0.8, 1.0), grey = lambertian(b, 0.8);
                                                 return wall == 1 && u < 0.3 && v < 0.3 ? lit : grey;
                                               }),
                                      settings);
    double emitted = 0.0, absorbed = 0.0;
    for (std::size_t i = 0; i < s.exitance.size(); ++i) {
      emitted += s.mesh.patches[i].area * s.mesh.patches[i].emission.x;
      absorbed += s.mesh.patches[i].area * (1.0 - static_cast<double>(0.8f)) * s.irradiance[i].x;
    }
    return std::abs(absorbed / emitted - 1.0);
  };
  EXPECT_LT(balance(true), 1e-6);
  EXPECT_GT(balance(false), 1e-3);
}

TEST_F(RadiosityKnownOnGl, AGapAtATJunctionIsSeenAsBackground) {
  // A corner on a neighbour's edge, and a hundredth of the room off it.
  const auto open = [](double gap) {
    SceneBuilder builder;
    const int m = lambertian(builder, 0.5, 1.0);
    Scene room = cubeRoom(1, 0.5, 1.0);
    // The floor's edge towards -z is cut in two, its new corner moved inwards: a sliver along the wall's foot is open.
    const glm::dvec3 a{-0.5, -0.5, -0.5}, b{0.5, -0.5, -0.5}, c{0.5, -0.5, 0.5}, d{-0.5, -0.5, 0.5},
        t{0.0, -0.5, -0.5 + gap};
    builder.triangle(a, d, t, m);
    builder.triangle(t, d, c, m);
    builder.triangle(t, c, b, m);
    const std::uint32_t first = static_cast<std::uint32_t>(builder.scene().vertices.size());
    Scene scene = builder.scene();
    for (const Vertex& v : room.vertices) scene.vertices.push_back(v);
    for (const Mesh& mesh : room.meshes) {
      if (room.vertices[room.indices[mesh.firstIndex]].normal.y > 0.5f) continue;  // its own floor
      Mesh copy = mesh;
      copy.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
      copy.material = m;
      for (std::uint32_t k = 0; k < mesh.indexCount; ++k)
        scene.indices.push_back(first + room.indices[mesh.firstIndex + k]);
      scene.meshes.push_back(copy);
    }
    HemicubeSettings settings;
    settings.resolution = 128;
    const Rows r = rowsOf(scene, settings);
    double sum = 0.0, area = 0.0;
    for (std::size_t i = 0; i < r.areas.size(); ++i) sum += r.areas[i] * (1.0 - r.fronts[i]), area += r.areas[i];
    return std::pair{sum / area, test::countTJunctions(r.mesh)};
  };
  const auto [none, closed] = open(0.0);
  EXPECT_LT(std::abs(none), 1e-5);
  EXPECT_EQ(closed, 1u);  // the corner lies on the back wall's edge: harmless to pixels, and found
  const auto [gap, apart] = open(0.02);
  EXPECT_GT(gap, 5e-4);  // the gap is 1/600 of the walls, seen edge on by its own wall
  EXPECT_LT(gap, 5e-3);
}

TEST_F(RadiosityKnownOnGl, RotatingTheSceneChangesNoFactor) {
  // Rolls follow the patch, not the axes.
  SceneBuilder builder;
  const int m = lambertian(builder, 0.5), light = lambertian(builder, 0.1, 5.0);
  addSphere(builder, 2.0, 1, true, [&](const glm::dvec3& p) { return p.y > 1.8 ? light : m; });
  addSphere(builder, 0.5, 1, false, [&](const glm::dvec3&) { return m; });
  const Scene scene = builder.scene();
  Scene other = scene;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
  const auto rotated = [&](const glm::vec3& v) {
    const glm::dvec3 p(v);
    return glm::vec3(std::cos(0.7) * p + std::sin(0.7) * glm::cross(axis, p) +
                     (1.0 - std::cos(0.7)) * glm::dot(axis, p) * axis);
  };
  for (Vertex& v : other.vertices) v.position = rotated(v.position), v.normal = rotated(v.normal);
  const Rows a = rowsOf(scene, {}), b = rowsOf(other, {});
  double off = 0.0;
  for (std::size_t i = 0; i < a.areas.size(); ++i)
    for (std::size_t j = 0; j < a.areas.size(); j += 5) {
      const auto only = [j](std::size_t k) { return k == j; };
      off += std::abs(a.sum(i, only) - b.sum(i, only));
    }
  EXPECT_LT(5.0 * off / static_cast<double>(a.areas.size()), 0.02);
}

TEST_F(RadiosityKnownOnGl, LightIsLinearAndColoursDoNotMix) {
  const auto room = [](const glm::vec3& factor) {
    int lit = -1, grey = -1;
    return cubeRoom(3, [&, factor](SceneBuilder& b, int wall, double, double) mutable {
      if (lit < 0) {
        lit = lambertian(b, 0.5, 1.0), grey = lambertian(b, 0.5);
        b.materialAt(lit).emission *= factor;
        b.materialAt(grey).diffuse = glm::vec3(0.8f, 0.3f, 0.0f);
      }
      return wall == 1 ? lit : grey;
    });
  };
  const RadiositySolution one = solve(room(glm::vec3(1.0f)), wholeTriangles(1e-9)),
                          scaled = solve(room(glm::vec3(1024.0f, 1.0f / 1024.0f, 0.0f)), wholeTriangles(1e-9));
  for (std::size_t i = 0; i < one.exitance.size(); ++i) {
    EXPECT_NEAR(scaled.exitance[i].x / one.exitance[i].x, 1024.0, 1e-4);
    EXPECT_NEAR(scaled.exitance[i].y / one.exitance[i].y, 1.0 / 1024.0, 1e-10);
    EXPECT_EQ(scaled.exitance[i].z, 0.0);
    if (one.mesh.patches[i].reflectance.z == 0.0) { EXPECT_EQ(one.exitance[i].z, 0.0); }
  }
}

/// The inside of a ball of 20 * 4^level triangles whose cap above y = 0.95 shines.
Scene litBall(int level) {
  SceneBuilder builder;
  const int dim = lambertian(builder, 0.5), lit = lambertian(builder, 0.5, 1.0);
  addSphere(builder, 1.0, level, true, [&](const glm::dvec3& centroid) { return centroid.y > 0.95 ? lit : dim; });
  return builder.scene();
}

// A small source on a hollow surface, and triangles from many pixels down to a seventh of one: what reaches places in
// the light, beside it and opposite.
TEST_F(RadiosityKnownOnGl, ALitCapIsSeenWholeAtAnyTessellation) {
  for (int level = 4; level <= (test::longTests() ? 6 : 5); ++level)
    for (const HemicubeVisibility way :
         {HemicubeVisibility::raster, HemicubeVisibility::rays, HemicubeVisibility::itemBuffer}) {
      if (way != HemicubeVisibility::raster && level != 5) continue;
      const RadiosityMesh mesh = makePatches(test::dark(litBall(level)), {});
      HemicubeSettings settings;
      settings.visibility = way;
      Hemicubes hemicubes(library(), capabilities(), mesh, settings);
      std::vector<bool> lit;
      for (const Patch& patch : mesh.patches) lit.push_back(patch.emission != glm::dvec3(0.0));
      const auto parts = partCentroids(kPatchParts);
      const double heights[4][2] = {{0.96, 1.0}, {0.9, 0.95}, {-0.1, 0.1}, {-1.0, -0.95}};
      for (const auto& [low, high] : heights) {
        double measured = 0.0, expected = 0.0;
        int receivers = 0;
        for (int i = 0; i < hemicubes.patchCount() && receivers < 16; ++i) {
          const Patch& patch = mesh.patches[static_cast<std::size_t>(i)];
          const double y = glm::normalize(patch.centroid).y;
          if (y < low || y > high || (i * 7919) % hemicubes.patchCount() > hemicubes.patchCount() / 2) continue;
          ++receivers;
          const FormFactorRows row = hemicubes.rows(i, 1);
          for (std::size_t k = 0; k < row.patches.size(); ++k)
            if (lit[row.patches[k]]) measured += static_cast<double>(row.factors[k]);
          const auto c = mesh.corners(patch);
          for (std::size_t j = 0; j < mesh.patches.size(); ++j) {
            if (!lit[j] || static_cast<int>(j) == i) continue;
            const auto source = mesh.corners(mesh.patches[j]);
            for (const glm::dvec2& w : parts)
              expected += reference::pointToPolygon(c[0] + w.x * (c[1] - c[0]) + w.y * (c[2] - c[0]), patch.faceNormal,
                                                    source) /
                          static_cast<double>(parts.size());
          }
        }
        ASSERT_GT(receivers, 1) << level << ' ' << low;
        EXPECT_NEAR(measured / expected, 1.0, 1e-3)
            << nameOf(way) << ", " << mesh.patches.size() << " triangles, receivers from y = " << low;
      }
    }
}

/// Mean of f over a triangle by a rule that is exact to the fifth degree [Radon1948], of four parts each where it and
/// theirs differ: beside a neighbour's edge a form factor is bounded, but not smooth at the edge's ends.
double meanOver(const std::array<glm::dvec3, 3>& c, const std::function<double(const glm::dvec3&)>& f, int depth) {
  const auto rule = [&](const std::array<glm::dvec3, 3>& t) {
    const glm::dvec3 centre = (t[0] + t[1] + t[2]) / 3.0;
    double sum = 0.225 * f(centre);
    for (const auto& [weight, at] : {std::pair((155.0 - std::sqrt(15.0)) / 1200.0, (6.0 - std::sqrt(15.0)) / 21.0),
                                     std::pair((155.0 + std::sqrt(15.0)) / 1200.0, (6.0 + std::sqrt(15.0)) / 21.0)})
      for (std::size_t k = 0; k < 3; ++k) sum += weight * f(at * (t[0] + t[1] + t[2]) + (1.0 - 3.0 * at) * t[k]);
    return sum;
  };
  const std::function<double(const std::array<glm::dvec3, 3>&, double, int)> refined =
      [&](const std::array<glm::dvec3, 3>& t, double whole, int left) {
        if (left == 0) return whole;
        const glm::dvec3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
        const std::array<std::array<glm::dvec3, 3>, 4> parts{
            {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}}};
        std::array<double, 4> means;
        double sum = 0.0;
        for (std::size_t k = 0; k < 4; ++k) sum += 0.25 * (means[k] = rule(parts[k]));
        if (std::abs(sum - whole) < 1e-7 * std::pow(4.0, 12 - left))
          return sum;  // of the part's own share in the whole
        double better = 0.0;
        for (std::size_t k = 0; k < 4; ++k) better += 0.25 * refined(parts[k], means[k], left - 1);
        return better;
      };
  return refined(c, rule(c), depth);
}

// The same, solved, against closed forms in double between all triangles: flat ones do not see themselves, so the light
// of few is not that of a sphere.
TEST_F(RadiosityKnownOnGl, ABallWithALitCapIsThatOfClosedForms) {
  for (const int level : {2, 3}) {
    RadiositySolutionSettings settings = wholeTriangles();
    settings.hemicubes.resolution = 64;
    settings.hemicubes.visibility = HemicubeVisibility::raster;
    const RadiositySolution s = solve(litBall(level), settings);
    const std::size_t n = s.mesh.patches.size();
    std::vector<std::array<glm::dvec3, 3>> corners;
    for (const Patch& patch : s.mesh.patches) corners.push_back(s.mesh.corners(patch));
    std::vector<double> flux(n * n, 0.0);  // A_i F_ij
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Patch& patch = s.mesh.patches[i];
        const double distance = glm::length(patch.centroid - s.mesh.patches[j].centroid);
        const auto factorAt = [&](const glm::dvec3& p) {
          return reference::pointToPolygon(p, patch.faceNormal, corners[j]);
        };
        flux[i * n + j] = flux[j * n + i] =
            patch.area * meanOver(corners[i], factorAt, distance > 6.0 * std::sqrt(patch.area) ? 0 : 12);
      }
    for (std::size_t i = 0; i < n; ++i) {
      const double sum = std::accumulate(flux.begin() + static_cast<std::ptrdiff_t>(i * n),
                                         flux.begin() + static_cast<std::ptrdiff_t>((i + 1) * n), 0.0);
      ASSERT_NEAR(sum / s.mesh.patches[i].area, 1.0, 2e-5) << i;  // what the reference itself is worth
    }
    std::vector<double> irradiance(n, 0.0);
    for (int step = 0; step < 50; ++step) {
      std::vector<double> next(n, 0.0);
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          next[i] += flux[i * n + j] / s.mesh.patches[i].area * (s.mesh.patches[j].emission.x + 0.5 * irradiance[j]);
      irradiance = std::move(next);
    }
    for (const auto& [low, high] :
         {std::pair(0.95, 1.0), std::pair(0.8, 0.95), std::pair(-0.5, 0.5), std::pair(-1.0, -0.8)}) {
      double measured = 0.0, expected = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        const Patch& patch = s.mesh.patches[i];
        if (patch.centroid.y <= low || patch.centroid.y > high) continue;
        measured += patch.area * s.irradiance[i].x;
        expected += patch.area * irradiance[i];
      }
      EXPECT_NEAR(measured / expected, 1.0, 1e-3) << n << " triangles, y from " << low << " to " << high;
    }
  }
}

// A square divided into more and more patches: from all of them above the size that takes the closed form to all below
// it. The division does not make it smaller.
TEST_F(RadiosityKnownOnGl, ADividedSquareLosesNothing) {
  const glm::dvec3 centre(0.0, 0.0, 0.5);
  for (const int n : {4, 8, 10, 12, 14, 16, 24}) {
    SceneBuilder builder;
    const int grey = lambertian(builder, 0.5);
    constexpr int kReceivers = 16;  // a side; of one place nearly, each turned by an angle of its own
    for (int i = 0; i < kReceivers * kReceivers; ++i)
      builder.plate({0.002 * (i % kReceivers - 7.5), 0.002 * (i / kReceivers - 7.5), 0.0}, {0.002, 0.0, 0.0},
                    {0.0, 0.002, 0.0}, grey);
    for (int i = 0; i < n * n; ++i)
      builder.plate(centre + glm::dvec3((i % n + 0.5) / n - 0.5, (i / n + 0.5) / n - 0.5, 0.0), {0.0, 1.0 / n, 0.0},
                    {1.0 / n, 0.0, 0.0}, grey);
    HemicubeSettings settings;
    settings.visibility = HemicubeVisibility::raster;
    const RadiosityMesh mesh = makePatches(test::dark(builder.scene()), {});
    Hemicubes hemicubes(library(), capabilities(), mesh, settings);
    const std::vector<glm::dvec3> square{centre + glm::dvec3(-0.5, -0.5, 0), centre + glm::dvec3(-0.5, 0.5, 0),
                                         centre + glm::dvec3(0.5, 0.5, 0), centre + glm::dvec3(0.5, -0.5, 0)};
    double measured = 0.0, expected = 0.0;
    constexpr int kRows = 2 * kReceivers * kReceivers;
    for (int first = 0; first < kRows; first += hemicubes.batchSize()) {
      const FormFactorRows rows = hemicubes.rows(first, std::min(hemicubes.batchSize(), kRows - first));
      measured += std::accumulate(rows.factors.begin(), rows.factors.end(), 0.0);
    }
    for (int i = 0; i < kRows; ++i)
      expected += reference::pointToPolygon(mesh.patches[static_cast<std::size_t>(i)].centroid, {0, 0, 1}, square);
    EXPECT_NEAR(measured / expected, 1.0, 5e-4) << n << " x " << n;
  }
}

}  // namespace
}  // namespace lucerna
