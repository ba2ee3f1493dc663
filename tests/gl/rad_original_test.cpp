// The radiosity original's hemicubes on real GL, against closed-form factors and a double-precision solution.
#include "radiosity/original/checkpoint.hpp"
#include "radiosity/original/coarse_scene.hpp"
#include "radiosity/original/display.hpp"
#include "radiosity/original/rad_models.hpp"
#include "radiosity/original/rad_scene.hpp"
#include "radiosity/original/scene_solution.hpp"
#include "radiosity/original/solver.hpp"
#include "support/gl_fixture.hpp"
#include "support/rad_reference.hpp"
#include "support/radiosity_scenes.hpp"
#include "support/temp_folder.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

namespace lucerna {
namespace {

class RadOriginal : public test::SharedProgramsTest {
 protected:
  using Settings = OriginalRadiosity::Settings;
  static Settings settings(int view, bool floats, bool publishedMap) {
    Settings s;
    s.view = view;
    s.deviations.values24Bit = !floats;
    s.deviations.publishedMap = publishedMap;
    return s;
  }
  static bool always(const OriginalProgress&) { return true; }
};

constexpr double kQuadPower = 1e6;

RadTriangle corner(const std::array<float, 3>& a, const std::array<float, 3>& b, const std::array<float, 3>& c) {
  RadTriangle t;
  t.p1 = a, t.p2 = b, t.p3 = c, t.n = {0, 0, 1};
  t.e = static_cast<std::uint32_t>(kQuadPower);
  return t;
}

// Form factors from a point, exact ones and the known faults of the published map, in percent.
TEST_F(RadOriginal, FactorsFromAPointAreKnownForBothMaps) {
  struct Case {
    const char* name;
    bool wall;
    double distance, exact, faultPercent;
  };
  const Case cases[] = {
      {"opposed square 0.5", false, 0.5, 0.554126423979572, -5.0},
      {"opposed square 1", false, 1.0, 0.239456470460774, -25.8},
      {"opposed square 2", false, 2.0, 0.0734776348125214, -32.8},
      {"opposed square 4", false, 4.0, 0.0194887650518050, -34.7},
      {"wall 0.1", true, 0.1, 0.422544860239058, 2.6},
      {"wall 0.5", true, 0.5, 0.190135882384807, 8.1},
      {"wall 1", true, 1.0, 0.0710934390469455, -5.1},
      {"wall 2", true, 2.0, 0.0153474494524923, -26.6},
  };
  for (const Case& c : cases) {
    // The point is the origin, the normal +y; the unit square above it, or standing on the plane with its foot's middle
    // at distance c.
    const auto d = static_cast<float>(c.distance);
    std::vector<RadTriangle> square;
    if (c.wall)
      square = {corner({d, 0, -0.5f}, {d, 1, -0.5f}, {d, 0, 0.5f}), corner({d, 1, 0.5f}, {d, 0, 0.5f}, {d, 1, -0.5f})};
    else
      square = {corner({-0.5f, d, -0.5f}, {0.5f, d, -0.5f}, {-0.5f, d, 0.5f}),
                corner({0.5f, d, 0.5f}, {-0.5f, d, 0.5f}, {0.5f, d, -0.5f})};
    square.push_back(
        corner({0, -4, 0}, {0.01f, -4, 0}, {0, -4, 0.01f}));  // below the plane: the scene reaches beyond the square
    for (bool published : {false, true}) {
      OriginalRadiosity solver(library(), square, settings(512, true, published));
      const double factor = solver.gatherAt({0, 0, 0}, {0, 1, 0}, {1, 0, 0}) / kQuadPower;
      const double percent = 100.0 * (factor / c.exact - 1.0);
      // Pixels at the edges: half a percent of the smaller squares.
      EXPECT_NEAR(percent, published ? c.faultPercent : 0.0, 0.5)
          << c.name << (published ? ", published map" : ", exact map");
    }
  }
}

// A closed room that sends one number everywhere receives that number: the three bytes go to the screen and back
// unharmed.
TEST_F(RadOriginal, TwentyFourBitsGoThereAndBack) {
  for (std::uint32_t e : {1u, 255u, 256u, 0x00ff00u, 0x010203u, 0xfedcbau, kRadMost}) {
    std::vector<RadTriangle> room = test::litUnitCube(1, 0.0f, 0);
    for (RadTriangle& t : room) t.e = e;
    OriginalRadiosity solver(library(), room, settings(64, false, true));
    for (std::size_t i = 0; i < room.size(); i += 5)
      EXPECT_NEAR(solver.gather(i), e, 1.0 + 4e-7 * e) << e << ", triangle " << i;
  }
}

TEST_F(RadOriginal, NumbersThatDoNotFitLoseTheirUpperBits) {
  std::vector<RadTriangle> room = test::litUnitCube(1, 0.5f, 0);
  for (RadTriangle& t : room) t.e = kRadMost, t.b = 4;
  const OriginalRadiosity solver(library(), room, settings(8, false, true));
  EXPECT_EQ(solver.overflows(), room.size());
  EXPECT_EQ(solver.sentBy(0, 8.0f), 4.0f);  // 2^24 + 3, as a float 2^24 + 4
  EXPECT_EQ(solver.sentBy(0, 0.0f), 16777215.0f);
}

// Furnace: B = E / (1 - ro) whatever the map, so that no furnace finds a wrong one; whole numbers end below it and at
// rest.
TEST_F(RadOriginal, FurnaceIsBlindToTheMapAndWholeNumbersComeToRest) {
  std::vector<RadTriangle> room = test::litUnitCube(1, 0.5f, 0);
  for (RadTriangle& t : room) t.e = 1000;
  for (bool published : {true, false}) {
    OriginalRadiosity floats(library(), room, settings(16, true, published));
    OriginalProgress p = floats.start();
    for (int i = 0; i < 24; ++i) ASSERT_TRUE(floats.sweep(p, always));
    for (float b : p.received) EXPECT_NEAR(b, 2000.0, 0.01) << published;
    EXPECT_NEAR(floats.energyBalance(p.received), 0.0, 1e-5);

    OriginalRadiosity whole(library(), room, settings(16, false, published));
    p = whole.start();
    while (p.sweeps < 30 && (p.sweeps == 0 || p.change > 0.0)) ASSERT_TRUE(whole.sweep(p, always));
    EXPECT_EQ(p.change, 0.0) << "at rest after " << p.sweeps;
    for (float b : p.received) {
      EXPECT_LE(b, 2000.0f);
      EXPECT_GE(b, 1995.0f);
    }
  }
}

// Inside a sphere every point receives the same from any lit patch. The published map gives more to what is near.
TEST_F(RadOriginal, SphereWithALitCapFindsTheWrongMap) {
  const std::vector<RadTriangle> sphere = test::sphereInside(2, 0.0f, 0.6, 1000000);
  const auto deviation = [&](bool published) {
    OriginalRadiosity solver(library(), sphere, settings(64, true, published));
    std::vector<double> received;
    for (std::size_t i = 0; i < sphere.size(); i += 3)
      if (sphere[i].e == 0) received.push_back(static_cast<double>(solver.gather(i)));
    const double mean = std::accumulate(received.begin(), received.end(), 0.0) / static_cast<double>(received.size());
    double squares = 0.0;
    for (double r : received) squares += (r - mean) * (r - mean);
    return std::sqrt(squares / static_cast<double>(received.size())) / mean;
  };
  const double exact = deviation(false), published = deviation(true);
  RecordProperty("exact_percent", std::to_string(100.0 * exact));
  RecordProperty("published_percent", std::to_string(100.0 * published));
  EXPECT_LT(exact, 0.03);
  EXPECT_GT(published, 0.10);
}

// The known error of the published map: 12 to 14 % RMS of the mean in a cube lit from its ceiling (1/96 of its area) at
// reflectance 0.5, 30 to 39 % at worst; 0.7 to 3 % with the exact one.
TEST_F(RadOriginal, LitCubeShowsThePublishedMapsError) {
  const std::vector<RadTriangle> cube = test::litUnitCube(8, 0.5f, 1000000);
  const std::vector<double> exact = test::receivedInConvex(cube);
  const auto error = [&](bool published) {
    Settings s = settings(64, true, published);
    s.gaussSeidel = true;
    OriginalRadiosity solver(library(), cube, s);
    OriginalProgress p = solver.start();
    for (int sweep = 0; sweep < 5; ++sweep) EXPECT_TRUE(solver.sweep(p, always));
    double squares = 0.0, most = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < cube.size(); ++i) {
      const double off = static_cast<double>(p.received[i]) - exact[i];
      squares += off * off;
      sum += exact[i];
      most = std::max(most, std::abs(off) / exact[i]);
    }
    const auto count = static_cast<double>(cube.size());
    return std::pair{std::sqrt(squares / count) / (sum / count), most};  // NRMSE, and the worst triangle's own
  };
  const auto [wrong, wrongMost] = error(true);
  const auto [right, rightMost] = error(false);
  RecordProperty("published_percent", std::to_string(100.0 * wrong));
  RecordProperty("published_most_percent", std::to_string(100.0 * wrongMost));
  RecordProperty("exact_percent", std::to_string(100.0 * right));
  RecordProperty("exact_most_percent", std::to_string(100.0 * rightMost));
  EXPECT_GT(wrong, 0.12);
  EXPECT_LT(wrong, 0.14);
  EXPECT_GT(wrongMost, 0.30);
  EXPECT_LT(wrongMost, 0.39);
  EXPECT_LT(right, 0.03);
}

// A run stopped within a sweep, written, read and taken up by another solver ends with the same bits as one that was
// not stopped.
TEST_F(RadOriginal, ResumedEqualsUninterrupted) {
  const test::TempFolder folder;
  const std::vector<RadTriangle> room = test::litUnitCube(2, 0.5f, 500000);
  for (bool gaussSeidel : {false, true})
    for (bool floats : {false, true}) {
      Settings s = settings(16, floats, true);
      s.gaussSeidel = gaussSeidel;
      OriginalRadiosity whole(library(), room, s);
      OriginalProgress straight = whole.start();
      for (int sweep = 0; sweep < 3; ++sweep) ASSERT_TRUE(whole.sweep(straight, always));

      OriginalProgress broken = whole.start();
      int stops = 0;
      while (broken.sweeps < 3) {
        OriginalRadiosity again(library(), room, s);
        std::size_t left = 17;
        if (again.sweep(broken, [&](const OriginalProgress&) { return --left > 0; })) continue;
        ++stops;
        writeCheckpoint(folder / "run.sweep", {1, 2, 3, broken});
        broken = readCheckpoint(folder / "run.sweep").progress;
      }
      EXPECT_GE(stops, 6);
      EXPECT_EQ(broken.received, straight.received) << gaussSeidel << floats;
      EXPECT_EQ(broken.change, straight.change);
    }
}

TEST_F(RadOriginal, GaussSeidelNeedsFewerSweepsForTheSameAnswer) {
  const std::vector<RadTriangle> room = test::litUnitCube(2, 0.8f, 1000000);
  const auto run = [&](bool gaussSeidel) {
    Settings s = settings(16, false, true);
    s.gaussSeidel = gaussSeidel;
    OriginalRadiosity solver(library(), room, s);
    OriginalProgress p = solver.start();
    do EXPECT_TRUE(solver.sweep(p, always));
    while (p.change > 0.0 && p.sweeps < 200);
    return p;
  };
  const OriginalProgress jacobi = run(false), seidel = run(true);
  EXPECT_EQ(jacobi.change, 0.0);
  EXPECT_EQ(seidel.change, 0.0);
  EXPECT_LT(seidel.sweeps, jacobi.sweeps);
  // Rounding down stops either a little below the answer, at most 1/(1 - ro) = 5 units and as much again from the
  // other.
  for (std::size_t i = 0; i < room.size(); ++i) EXPECT_NEAR(jacobi.received[i], seidel.received[i], 10.0) << i;
}

TEST_F(RadOriginal, ThreeCornersAreAveraged) {
  const std::vector<RadTriangle> room = test::litUnitCube(2, 0.0f, 1000000);
  Settings s = settings(32, true, false);
  s.deviations.centroid = false;
  OriginalRadiosity solver(library(), room, s);
  const std::size_t i = 0;  // on the floor
  double sum = 0.0;
  for (const auto* p : {&room[i].p1, &room[i].p2, &room[i].p3}) {
    const glm::dvec3 point((*p)[0], (*p)[1], (*p)[2]),
        middle = (glm::dvec3(room[i].p1[0], room[i].p1[1], room[i].p1[2]) +
                  glm::dvec3(room[i].p2[0], room[i].p2[1], room[i].p2[2]) +
                  glm::dvec3(room[i].p3[0], room[i].p3[1], room[i].p3[2])) /
                 3.0;
    sum += solver.gatherAt(point, {0, 1, 0},
                           glm::normalize(glm::dvec3(room[i].p1[0], room[i].p1[1], room[i].p1[2]) - middle));
  }
  const std::size_t before = solver.hemicubes();
  EXPECT_NEAR(static_cast<double>(solver.gather(i)), sum / 3.0, 1e-3 * sum);
  EXPECT_EQ(solver.hemicubes(), before + 3);
}

// [RAD2008 figures 3.12, 3.13]: what is nearer than the near plane vanishes, and the light with it.
TEST_F(RadOriginal, NearPlaneCutsWallsOffUnlessDepthIsClamped) {
  std::vector<RadTriangle> room = test::litUnitCube(4, 0.0f, 0);
  for (RadTriangle& t : room) t.e = 100000;
  Settings s = settings(64, true, true);
  s.nearPlane = 0.15;  // the first triangle's centroid is 1/12 from its wall
  OriginalRadiosity cut(library(), room, s);
  s.deviations.noNearField = false;
  OriginalRadiosity clamped(library(), room, s);
  EXPECT_LT(cut.gather(0), 0.9e5f);
  EXPECT_NEAR(clamped.gather(0), 1e5f, 100.0f);
}

TEST_F(RadOriginal, RollTurnsHemicubesOneByOne) {
  const std::vector<RadTriangle> room = test::litUnitCube(2, 0.0f, 1000000);
  Settings s = settings(16, true, false);
  OriginalRadiosity fixed(library(), room, s);
  s.deviations.fixedOrientation = false;
  OriginalRadiosity rolled(library(), room, s);
  s.seed = 2;
  OriginalRadiosity otherwise(library(), room, s);
  int differ = 0, differBySeed = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(rolled.gather(i), fixed.gather(i), 0.35f * fixed.gather(i)) << "the same light, other pixels";
    differ += rolled.gather(i) != fixed.gather(i);
    differBySeed += rolled.gather(i) != otherwise.gather(i);
  }
  EXPECT_GE(differ, 7);
  EXPECT_GE(differBySeed, 7);
}

// A furnace of three colours: after k sweeps every triangle has k + 1 terms of the series E (1 + ro + ro^2 + ...), in
// each channel its own, less what whole numbers lose.
TEST_F(RadOriginal, ScenesAreSolvedInEachChannel) {
  const glm::dvec3 reflectance(0.5, 0.25, 0.75), emitted(1.0, 2.0, 3.0);
  int index = -1;
  const Scene room = test::dark(test::cubeRoom(2, [&](test::SceneBuilder& builder, int, double, double) {
    if (index >= 0) return index;
    index = builder.material(glm::vec3(reflectance));
    builder.materialAt(index).emission = glm::vec3(emitted / std::numbers::pi);
    return index;
  }));
  PublishedSceneSettings settings;
  settings.view = 16;
  const PublishedScene made =
      solveAsPublished(context(), library(), room, settings, [](double share) { return share <= 1.0; });
  ASSERT_EQ(made.solution.exitance.size(), 48u);
  EXPECT_EQ(made.sweeps, (std::array<std::uint32_t, 3>{7, 7, 7}));
  EXPECT_EQ(made.hemicubes, 3u * 7u * 48u);
  EXPECT_EQ(made.overflows, 0u);
  EXPECT_NEAR(made.exitanceOfStep, 3e-6, 1e-11);
  const double mean = (2.0 + 8.0 / 3.0 + 12.0) / 3.0;
  double worst = 0.0;
  for (const glm::dvec3& exitance : made.solution.exitance)
    for (int c = 0; c < 3; ++c) {
      const double whole = emitted[c] / (1.0 - reflectance[c]);
      // A step in each sweep's number, and the map's sum of floats.
      EXPECT_NEAR(exitance[c], whole * (1.0 - std::pow(reflectance[c], 8.0)), 4.0 * 3e-6 + 4e-6 * whole) << c;
      worst = std::max(worst, std::abs(exitance[c] - whole) / mean);
    }
  EXPECT_GE(made.solution.progress.errorBound, worst);
  EXPECT_LT(made.solution.progress.errorBound, 1.3 * worst);
  // With time for all of it nothing changes at the end.
  settings.mostSweeps = 100;
  const PublishedScene rest = solveAsPublished(context(), library(), room, settings, [](double) { return true; });
  for (const std::uint32_t sweeps : rest.sweeps) EXPECT_LT(sweeps, 60u);
  for (const glm::dvec3& exitance : rest.solution.exitance) EXPECT_NEAR(exitance.z, 12.0, 2e-4);
}

// What sun and lamps give is reflected as if it were emitted: the program's files know no other light.
TEST_F(RadOriginal, SunlightIsHandedOverAsEmission) {
  test::SceneBuilder builder;
  builder.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, builder.material(glm::vec3(0.5f, 0.4f, 0.2f)));
  builder.sun({0.0, -1.0, 1.0}, glm::vec3(4.0f));
  const Scene scene = builder.scene();
  PublishedSceneSettings settings;
  settings.view = 8;
  const PublishedScene made = solveAsPublished(context(), library(), scene, settings, [](double) { return true; });
  for (const glm::dvec3& exitance : made.solution.exitance)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(exitance[c], glm::dvec3(0.5, 0.4, 0.2)[c] * 4.0 * std::sqrt(0.5), 1e-5) << c;
  EXPECT_THROW(solveAsPublished(context(), library(), test::dark(scene), settings, [](double) { return true; }), Error);
}

// A model of a few triangles stays closed and keeps its lamp, so the light that walls absorb is that of the lamp.
TEST_F(RadOriginal, ACoarserModelHasTheLightOfItsScene) {
  const Scene fine = test::cubeRoom(12, [](test::SceneBuilder& builder, int wall, double u, double v) {
    const bool isLamp = wall == 1 && std::max(std::abs(u - 0.5), std::abs(v - 0.5)) < 0.1;
    return isLamp ? test::lambertian(builder, 0.0, 100.0) : test::lambertian(builder, 0.5);
  });
  const CoarseScene coarse = coarserScene(fine, PatchSettings{}, 150);
  ASSERT_GT(coarse.cell, 0.0);
  PublishedSceneSettings settings;
  settings.view = 32;
  const PublishedScene made =
      solveAsPublished(context(), library(), coarse.scene, settings, [](double) { return true; });
  double emitted = 0.0, absorbed = 0.0;
  const std::vector<Patch>& patches = made.solution.mesh.patches;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    emitted += patches[i].area * patches[i].emission.x;
    absorbed += patches[i].area * (1.0 - patches[i].reflectance.x) * made.solution.irradiance[i].x;
  }
  std::printf("%zu of %zu triangles, emitted %.4f, absorbed %.4f\n", patches.size(), fine.triangleCount(), emitted,
              absorbed);
  EXPECT_NEAR(emitted, 100.0 * 4.0 / 144.0, 1e-6);
  EXPECT_NEAR(absorbed / emitted, 1.0, 0.15);
}

TEST_F(RadOriginal, TrianglesWithoutAreaKeepTheirBytes) {
  std::vector<RadTriangle> room = test::litUnitCube(1, 0.5f, 1000);
  RadTriangle sliver = room[0];
  sliver.p3 = sliver.p2, sliver.b = 77, sliver.n = {0, 0, 0};
  room.push_back(sliver);
  OriginalRadiosity solver(library(), room, settings(8, false, true));
  OriginalProgress p = solver.start();
  ASSERT_TRUE(solver.sweep(p, always));
  const std::vector<RadTriangle> after = solver.withReceived(p.received);
  EXPECT_EQ(after.back().b, 77u);
  EXPECT_GT(after.front().b, 0u);
  EXPECT_EQ(after.front().e, room.front().e);
}

// White light on a picture of four colours: they are where texture coordinates put them, the bottom row at v = 0.
TEST_F(RadOriginal, ShowDrawsTheScenesTexturesTimesTheLight) {
  test::SceneBuilder builder;
  const int picture = builder.texture(2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255});
  const int painted = builder.material(glm::vec3(0.5f));
  builder.materialAt(painted).diffuseTexture = picture;
  builder.materialAt(painted).emission = glm::vec3(1.0f);
  builder.plate({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, painted);
  const Scene scene = builder.scene();
  std::vector<RadTriangle> triangles = radTrianglesOf(scene, {10.0, 1000}).triangles;
  RadView view(library(), {64, 64});
  Camera camera;
  camera.position = {0, 0, 2}, camera.direction = {0, 0, -1}, camera.up = {0, 1, 0};
  camera.verticalFov = 2.0 * std::atan(0.5);
  const auto at = [](const Bitmap& bitmap, int x, int y) {
    const std::uint8_t* p = &bitmap.rgba[4 * static_cast<std::size_t>(64 * y + x)];
    return std::array<int, 3>{p[0], p[1], p[2]};
  };
  const RadTextures textures = texturesOf(scene, 10.0, triangles, "x.rad");
  view.show(triangles, {}, textures);
  view.record(camera);
  const Bitmap whole = view.read();
  // A texel's middle is 1/64 of a texel beside the pixel's.
  const auto expect = [&](int x, int y, const std::array<int, 3>& colour) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(at(whole, x, y)[c], colour[c], 9) << x << ", " << y;
  };
  expect(16, 16, {255, 0, 0});
  expect(48, 16, {0, 255, 0});
  expect(16, 48, {0, 0, 255});
  expect(48, 48, {255, 255, 255});
  // Half the light is half the colour; without the picture there is grey.
  RadDisplay half;
  half.mapping = RadMapping::linear, half.constant = 0.5 / 1000.0;
  view.show(triangles, half, textures);
  view.record(camera);
  EXPECT_NEAR(at(view.read(), 48, 16)[1], 127.5, 5.0);
  view.show(triangles, half);
  view.record(camera);
  EXPECT_NEAR(at(view.read(), 8, 8)[2], 127.5, 1.0);
  // Triangles of another size are not the scene's.
  EXPECT_THROW(texturesOf(scene, 0.5, triangles, "x.rad"), Error);
  triangles[0].p2[0] += 1.0f;
  EXPECT_THROW(texturesOf(scene, 10.0, triangles, "x.rad"), Error);
}

TEST_F(RadOriginal, ShowLooksIntoRoomsAndDrawsBackCornersAndMesh) {
  std::vector<RadTriangle> room = makeRadModel(1, {60.0, 0.5, 1000000});
  const glm::dvec3 towards = overviewOf(room).direction;
  for (RadTriangle& t : room)
    if (glm::dot(glm::dvec3(t.n[0], t.n[1], t.n[2]), towards) > 0.0) t.b = kRadMost;  // turned away
  RadView view(library(), {200, 150});
  const auto picture = [&](bool backs, bool mesh) {
    RadDisplay display;
    display.backCorners = backs, display.mesh = mesh, display.mapping = RadMapping::bits24;
    view.show(room, display);
    view.record(overviewOf(room));
    return view.read();
  };
  const auto differing = [](const Bitmap& a, const Bitmap& b) {
    int count = 0;
    for (std::size_t i = 0; i < a.rgba.size(); i += 4)
      count += !std::equal(a.rgba.begin() + static_cast<std::ptrdiff_t>(i),
                           a.rgba.begin() + static_cast<std::ptrdiff_t>(i) + 3,
                           b.rgba.begin() + static_cast<std::ptrdiff_t>(i));
    return count;
  };
  const Bitmap plain = picture(false, false);
  // What faces the camera received nothing: it is black, and the bright faces turned away hide none of it. The
  // background is grey.
  int walls = 0;
  for (std::size_t i = 0; i < plain.rgba.size(); i += 4)
    walls += plain.rgba[i] == 0 && plain.rgba[i + 1] == 0 && plain.rgba[i + 2] == 0;
  EXPECT_GT(walls, 200 * 150 / 5);
  EXPECT_NEAR(plain.rgba[0], 25.5, 0.5);  // of a tenth: either way
  EXPECT_GT(differing(plain, picture(true, false)), 20);
  EXPECT_LT(differing(plain, picture(true, false)), 2000);
  EXPECT_GT(differing(plain, picture(false, true)), 500);
}

}  // namespace
}  // namespace lucerna
