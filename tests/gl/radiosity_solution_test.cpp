// Whole solutions from the GPU's form factors against exact answers; checkpoints and files.
#include "base/error.hpp"
#include "radiosity/row_file.hpp"
#include "radiosity/radiosity_view.hpp"
#include "radiosity/solution.hpp"
#include "radiosity/solution_watch.hpp"
#include "support/gl_fixture.hpp"
#include "support/radiosity_scenes.hpp"
#include "support/small_scenes.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

namespace lucerna {
namespace {

using test::cubeRoom;
using test::dark;
using test::lambertian;
using test::SceneBuilder;
using test::wholeTriangles;

class RadiositySolutions : public test::SharedProgramsTest {
 protected:
  static RadiositySolution solve(const Scene& scene, const RadiositySolutionSettings& settings,
                                 const std::filesystem::path& checkpoint = {},
                                 const std::function<bool(const RadiosityStage&)>& onStage = {}) {
    return solveScene(context(), library(), scene, settings, checkpoint, onStage);
  }
  static Scene sphere(int level, const std::function<int(SceneBuilder&, const glm::dvec3&)>& material) {
    SceneBuilder builder;
    addSphere(builder, 1.0, level, true, [&](const glm::dvec3& c) { return material(builder, c); });
    return dark(builder.scene());
  }
};

TEST_F(RadiositySolutions, FurnacesHoldTheirRadiosity) {
  for (const double rho : {0.0, 0.5, 0.9, 0.999})
    for (const Scene& scene :
         {dark(cubeRoom(2, rho, 1.0)), sphere(1, [rho, m = -1](SceneBuilder&b, const glm::dvec3&) mutable {
            return m < 0 ? m = lambertian(b, rho, 1.0) : m;
          })}) {
      const RadiositySolution s = solve(scene, wholeTriangles());
      const double exact = 1.0 / (1.0 - static_cast<double>(static_cast<float>(rho)));
      EXPECT_TRUE(s.reached);
      for (const glm::dvec3& b : s.exitance)
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(b[c] / exact, 1.0, 2e-5) << rho;
    }
}

TEST_F(RadiositySolutions, ASphereWithOneLitPatchIsLitAlikeEverywhere) {
  // B = E + rho <E> / (1 - rho): finds wrong maps, which furnaces cannot.
  const Scene scene = sphere(2, [lit = -1, unlit = -1](SceneBuilder& b, const glm::dvec3& c) mutable {
    if (lit < 0) lit = lambertian(b, 0.5, 1.0), unlit = lambertian(b, 0.5);
    return c.y > 0.9 ? lit : unlit;
  });
  const auto deviation = [&](const RadiositySolutionSettings& settings, double& mean) {
    const RadiositySolution s = solve(scene, settings);
    double emitted = 0.0, squares = 0.0, count = 0.0;
    for (const Patch& p : s.mesh.patches) emitted += p.area * p.emission.x / s.mesh.area();
    mean = 0.0;
    for (std::size_t i = 0; i < s.exitance.size(); ++i)
      if (s.mesh.patches[i].emission.x == 0.0) mean += s.exitance[i].x / emitted, count += 1.0;
    mean /= count;
    for (std::size_t i = 0; i < s.exitance.size(); ++i)
      if (s.mesh.patches[i].emission.x == 0.0) squares += std::pow(s.exitance[i].x / emitted / mean - 1.0, 2.0) / count;
    return std::sqrt(squares);
  };
  double mean = 0.0;
  const double exact = deviation(wholeTriangles(), mean);
  EXPECT_LT(exact, 0.03);
  EXPECT_NEAR(mean, 1.0, 0.02);  // rho / (1 - rho) of the mean emission
  RadiositySolutionSettings published = wholeTriangles();
  published.hemicubes.map = DeltaMap::published;
  published.hemicubes.exactPixels = 0;
  published.repair = false;
  EXPECT_GT(deviation(published, mean), 3.0 * exact);
}

TEST_F(RadiositySolutions, ConcentricSpheresAndABowl) {
  SceneBuilder builder;
  const int inner = lambertian(builder, 0.5, 1.0), outer = lambertian(builder, 0.8);
  addSphere(builder, 1.0, 2, false, [&](const glm::dvec3&) { return inner; });
  addSphere(builder, 2.0, 2, true, [&](const glm::dvec3&) { return outer; });
  const RadiositySolution s = solve(dark(builder.scene()), wholeTriangles());
  double sum[2] = {}, area[2] = {};
  for (std::size_t i = 0; i < s.exitance.size(); ++i) {
    const int k = s.mesh.patches[i].material == inner ? 0 : 1;
    sum[k] += s.mesh.patches[i].area * s.exitance[i].x;
    area[k] += s.mesh.patches[i].area;
  }
  // 4/3 and 2/3 of smooth spheres; these are polyhedra of nearly the same shape.
  EXPECT_NEAR(sum[0] / area[0], 4.0 / 3.0, 0.01);
  EXPECT_NEAR(sum[1] / area[1], 2.0 / 3.0, 0.01);

  SceneBuilder bowl;
  const int m = lambertian(bowl, 0.6, 1.0);
  addSphere(bowl, 1.0, 2, true, [&](const glm::dvec3& c) { return c.y < 0.0 ? m : -1; });
  Scene open = dark(bowl.scene());
  std::erase_if(open.meshes, [](const Mesh& mesh) { return mesh.material < 0; });
  const RadiositySolution b = solve(open, wholeTriangles());
  double mean = 0.0;
  for (std::size_t i = 0; i < b.exitance.size(); ++i) mean += b.mesh.patches[i].area * b.exitance[i].x / b.mesh.area();
  const double fraction = b.mesh.area() / (4.0 * std::numbers::pi);
  EXPECT_NEAR(mean, 1.0 + 0.6 * fraction / (1.0 - 0.6 * fraction), 0.02);
  EXPECT_LT(std::abs(b.progress.energyBalance), 1e-4);
}

TEST_F(RadiositySolutions, TheCubeWithALitCeilingAndThePublishedMap) {
  // Exact: many patches a wall, both from closed forms; here 6 x 6 squares a wall of this scene, hemicubes of 64
  // pixels.
  int lit = -1, grey = -1;
  const Scene scene = dark(cubeRoom(6, [&](SceneBuilder& b, int wall, double u, double v) {
    if (lit < 0) lit = lambertian(b, 0.5, 1.0), grey = lambertian(b, 0.5);
    return wall == 1 && std::abs(u - 0.5) < 0.17 && std::abs(v - 0.5) < 0.17 ? lit : grey;
  }));
  RadiositySolutionSettings fine = wholeTriangles(), plain = wholeTriangles(), published = wholeTriangles();
  fine.hemicubes.resolution = 128;
  fine.hemicubes.exactPixels = 1;
  fine.hemicubes.nearDistance = 12.0f;
  fine.hemicubes.mostParts = 16;
  published.hemicubes.map = DeltaMap::published;
  published.hemicubes.exactPixels = 0;
  published.repair = false;
  const RadiositySolution best = solve(scene, fine);
  const auto rms = [&](const RadiositySolution& s) {
    double squares = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < s.irradiance.size(); ++i)
      squares += std::pow(s.irradiance[i].x - best.irradiance[i].x, 2.0), mean += best.irradiance[i].x;
    return std::sqrt(squares * static_cast<double>(s.irradiance.size())) / mean;
  };
  EXPECT_LT(rms(solve(scene, plain)), 0.03);  // 0.7 to 3 % by other hemicubes with the right map
  EXPECT_GT(rms(solve(scene, published)), 0.08);
}

TEST_F(RadiositySolutions, AResumedRunEqualsAnUninterruptedOne) {
  const test::TempFolder folder;
  const Scene scene = dark(cubeRoom(4, 0.7, 1.0));
  RadiositySolutionSettings settings = wholeTriangles(1e-4);
  settings.hemicubes.batchBytes = 3 * 32 * 32 * 4 * 16;
  const RadiositySolution uninterrupted = solve(scene, settings);
  const auto file = folder.path() / "rows";
  int submissions = 0;
  EXPECT_THROW(
      solve(scene, settings, file,
            [&](const RadiosityStage& s) { return s.kind != RadiosityStage::Kind::formFactors || ++submissions < 4; }),
      Stopped);
  ASSERT_TRUE(std::filesystem::exists(file));
  // As a kill in the middle of a write leaves it.
  const auto bytes = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, bytes - 5);
  int first = -1;
  const RadiositySolution resumed = solve(scene, settings, file, [&](const RadiosityStage& s) {
    if (s.kind == RadiosityStage::Kind::formFactors && first < 0) first = static_cast<int>(s.done);
    return true;
  });
  EXPECT_GT(first, 48);  // three blocks of 16 were whole
  EXPECT_LT(resumed.hemicubes, uninterrupted.hemicubes);
  EXPECT_TRUE(std::filesystem::exists(file)) << "the solution is not saved yet";
  removeCheckpoints(file);
  EXPECT_FALSE(std::filesystem::exists(file));
  for (std::size_t i = 0; i < resumed.exitance.size(); ++i) ASSERT_EQ(resumed.exitance[i], uninterrupted.exitance[i]);
  // Another scene's, another setting's, or no checkpoint at all: refused and left as it is.
  EXPECT_THROW(solve(scene, settings, file,
                     [&](const RadiosityStage& s) { return s.kind != RadiosityStage::Kind::formFactors; }),
               Stopped);
  const auto kept = std::filesystem::file_size(file);
  RadiositySolutionSettings other = settings;
  other.hemicubes.seed = 2;
  EXPECT_THROW(solve(scene, other, file), Error);
  EXPECT_THROW(solve(dark(cubeRoom(3, 0.7, 1.0)), settings, file), Error);
  EXPECT_EQ(std::filesystem::file_size(file), kept);
  std::ofstream(folder.path() / "notes") << "not a checkpoint, but somebody's notes";
  EXPECT_THROW(solve(scene, settings, folder.path() / "notes"), Error);
  EXPECT_EQ(std::filesystem::file_size(folder.path() / "notes"), 38u);
}

// A window lights the same surfaces anew: form factors are those of the first solution, and the bits those of one made
// from nothing. At its end nothing is left behind.
TEST_F(RadiositySolutions, OtherLightNeedsNoHemicubesWhereRowsAreKept) {
  const test::TempFolder folder;
  Scene scene = test::openBox();
  RadiosityView::Settings settings;
  settings.solution.patches.longestEdge = 2.5;
  settings.solution.hemicubes.resolution = 32;
  settings.solution.hemicubes.visibility = HemicubeVisibility::raster;
  const RadiosityView dusk(context(), library(), scene, settings);
  EXPECT_GT(dusk.solution().hemicubes, 0u);
  scene.sun->direction = glm::normalize(scene.sun->direction + glm::dvec3(0.0, -0.2, 0.0));
  const RadiosityView noon(context(), library(), scene, settings);
  {
    const SolutionWatch watch(
        folder.path(), [](const RadiosityStage&) { return true; }, SolutionWatch::Rows::keep);
    Scene turned = test::openBox();
    const RadiosityView first(context(), library(), turned, settings);
    EXPECT_TRUE(first.solution().exitance == dusk.solution().exitance);
    turned.sun->direction = scene.sun->direction;
    const RadiosityView second(context(), library(), turned, settings);
    EXPECT_EQ(second.solution().hemicubes, 0u);
    EXPECT_TRUE(second.solution().exitance == noon.solution().exitance);
    EXPECT_FALSE(second.solution().exitance == dusk.solution().exitance);
    turned.sun->direction = glm::normalize(glm::dvec3(0.5, -0.5, 0.5));  // onto walls from behind: other patches
    EXPECT_GT(RadiosityView(context(), library(), turned, settings).solution().hemicubes, 0u);
    EXPECT_NE(folder.listing(), "");
  }
  EXPECT_EQ(folder.listing(), "");
}

// Rows that would fill more of the disk than they may are not kept, and the solution is the same.
TEST_F(RadiositySolutions, RowsOfTheWatchHaveALimit) {
  const test::TempFolder folder;
  const Scene scene = test::openBox();
  RadiosityView::Settings settings;
  settings.solution.patches.longestEdge = 2.5;
  settings.solution.hemicubes.resolution = 32;
  settings.solution.hemicubes.visibility = HemicubeVisibility::raster;
  const RadiosityView alone(context(), library(), scene, settings);
  const auto bytesWith = [&](double mostBytes) {
    const SolutionWatch watch(folder.path(), [](const RadiosityStage&) { return true; }, SolutionWatch::Rows::keep,
                              {.secondsOfChunk = 0.01, .mostBytes = mostBytes});
    const RadiosityView view(context(), library(), scene, settings);
    EXPECT_TRUE(view.solution().exitance == alone.solution().exitance);
    std::uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) bytes += entry.file_size();
    return bytes;
  };
  const std::uintmax_t all = bytesWith(1e9);
  EXPECT_GT(all, 1000u);
  EXPECT_EQ(bytesWith(0.1 * static_cast<double>(all)), 0u);
}

// Each pixel's patch against the first triangle on its ray, found in double precision; weights sum to 1.
TEST_F(RadiositySolutions, AHemicubesPixelsShowTheFirstPatchOnTheirRays) {
  const Scene scene = test::openBox();
  RadiositySolutionSettings settings;
  settings.patches.longestEdge = 2.0;
  settings.hemicubes.resolution = 16;
  const RadiositySolution s = solve(scene, settings);
  const std::vector<Patch>& patches = s.mesh.patches;
  const std::uint32_t patch = static_cast<std::uint32_t>(patches.size()) / 2;
  const HemicubePixels cube = hemicubeOf(context(), library(), scene, s, settings, patch);
  ASSERT_EQ(cube.seen.size(), 3u * 16 * 16);
  const auto distanceTo = [&](std::uint32_t p, const glm::dvec3& direction) {
    const auto c = s.mesh.corners(patches[p]);
    const glm::dmat3 m(c[1] - c[0], c[2] - c[0], -direction);
    if (p == patch || std::abs(glm::determinant(m)) < 1e-12) return 1e300;
    const glm::dvec3 x = glm::inverse(m) * (patches[patch].centroid - c[0]);
    return x.x < 0.0 || x.y < 0.0 || x.x + x.y > 1.0 || x.z < 1e-6 ? 1e300 : x.z;
  };
  // A sheet's two patches are in one place.
  const auto isFirst = [&](std::uint32_t seen, const glm::dvec3& direction) {
    double nearest = 1e300;
    for (std::uint32_t p = 0; p < patches.size(); ++p) nearest = std::min(nearest, distanceTo(p, direction));
    return seen == 0 ? nearest == 1e300 : distanceTo(seen - 1, direction) < 1.000001 * nearest && nearest < 1e300;
  };
  std::size_t pixel = 0, agree = 0;
  double sum = 0.0, fronts = 0.0;
  for (int face = 0; face < 5; ++face)
    for (int row = 0; row < (face == 0 ? 16 : 8); ++row)
      for (int column = 0; column < 16; ++column, ++pixel) {
        const double a = (column + 0.5) / 8.0 - 1.0, b = (row + 0.5) / 8.0 - (face == 0 ? 1.0 : 0.0);
        const glm::dvec3 local[] = {{a, b, 1.0}, {1.0, a, b}, {-a, 1.0, b}, {-1.0, -a, b}, {a, -1.0, b}};
        agree += isFirst(cube.seen[pixel], cube.axes * local[face]);
        const std::size_t inMap = face == 0 ? pixel : static_cast<std::size_t>(256 + row * 16 + column);
        sum += cube.weights[inMap];
        if (cube.seen[pixel] == 0) continue;
        const Patch& other = patches[cube.seen[pixel] - 1];
        if (glm::dot(patches[patch].centroid - other.centroid, other.faceNormal) > 0.0) fronts += cube.weights[inMap];
      }
  EXPECT_GE(agree, pixel - pixel / 100) << "of " << pixel << ", but for edges";
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(fronts, static_cast<double>(s.fronts[patch]), 0.02);
}

TEST_F(RadiositySolutions, FilesGiveBackWhatWasSaved) {
  const test::TempFolder folder;
  Scene scene = dark(cubeRoom(2, 0.7, 1.0));
  scene.environment = Environment{{0.1f, 0.2f, 0.3f}, {}, 0.0};
  RadiositySolution s = solve(scene, wholeTriangles());
  s.fromSky[3] = {0.4, 0.5, 0.6};  // the room is closed: no sky
  const auto file = folder.path() / "solution";
  saveSolution(file, scene, s);
  const RadiositySolution loaded = loadSolution(file, scene);
  ASSERT_EQ(loaded.exitance.size(), s.exitance.size());
  for (std::size_t i = 0; i < s.exitance.size(); ++i) EXPECT_EQ(loaded.exitance[i], s.exitance[i]);
  for (std::size_t i = 0; i < s.exitance.size(); ++i) EXPECT_EQ(loaded.fromEmitters[i], s.fromEmitters[i]);
  for (std::size_t i = 0; i < s.exitance.size(); ++i) EXPECT_EQ(loaded.fromSky[i], s.fromSky[i]);
  EXPECT_EQ(interpolatedToVertices(loaded, loaded.irradiance), interpolatedToVertices(s, s.irradiance));
  EXPECT_THROW(loadSolution(file, dark(cubeRoom(3, 0.7, 1.0))), Error);
  const auto size = std::filesystem::file_size(file);
  {
    std::fstream damaged(file, std::ios::in | std::ios::out | std::ios::binary);
    damaged.seekg(static_cast<std::streamoff>(size / 2));
    const int byte = damaged.get();
    damaged.seekp(static_cast<std::streamoff>(size / 2));
    damaged.put(static_cast<char>(byte ^ 0x55));
  }
  EXPECT_THROW(loadSolution(file, scene), Error);
  std::filesystem::resize_file(file, size - 100);
  EXPECT_THROW(loadSolution(file, scene), Error);
}

TEST_F(RadiositySolutions, AChangedSceneHasAnotherSolution) {
  // What light depends on, not the corners alone: a mask, a medium, a texture's size. (One function knows it:
  // scene/fingerprint.)
  const test::TempFolder folder;
  const Scene scene = dark(cubeRoom(2, 0.7, 1.0));
  RadiositySolution s = solve(scene, wholeTriangles());
  s.deviations.centroid = true;
  saveSolution(folder.path() / "s", scene, s);
  EXPECT_TRUE(loadSolution(folder.path() / "s", scene).deviations.centroid);
  const auto refused = [&](const std::function<void(Scene&)>& change) {
    Scene other = scene;
    change(other);
    EXPECT_THROW(loadSolution(folder.path() / "s", other), Error);
  };
  refused([](Scene& o) { o.materials[0].alphaMasked = true; });
  refused([](Scene& o) { o.materials[0].diffuse.x += 1e-4f; });
  refused([](Scene& o) { o.media.emplace_back(); });
  refused([](Scene& o) { o.vertices[3].normal = -o.vertices[3].normal; });
  refused([](Scene& o) { o.points.push_back({{0, 0, 0}, glm::vec3(1.0f)}); });
  Scene renamed = scene;
  renamed.name = "elsewhere";
  renamed.exposure = 7.0f;
  EXPECT_NO_THROW(loadSolution(folder.path() / "s", renamed));
}

TEST_F(RadiositySolutions, EachDeviationDoesWhatItSays) {
  int lit = -1, grey = -1;
  const Scene scene = dark(cubeRoom(4, [&](SceneBuilder& b, int wall, double u, double v) {
    if (lit < 0) lit = lambertian(b, 0.5, 1.0), grey = lambertian(b, 0.5);
    return wall == 1 && std::abs(u - 0.5) < 0.3 && std::abs(v - 0.5) < 0.3 ? lit : grey;
  }));
  const RadiositySolution right = solve(scene, wholeTriangles(1e-5));
  const auto rms = [&](bool RadiosityDeviations::*member) {
    RadiositySolutionSettings settings = wholeTriangles(1e-5);
    settings.deviations.*member = true;
    const RadiositySolution s = solve(scene, settings);
    EXPECT_TRUE(s.deviations.*member);
    double squares = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < s.irradiance.size(); ++i)
      squares += std::pow(s.irradiance[i].x - right.irradiance[i].x, 2.0), mean += right.irradiance[i].x;
    return std::sqrt(squares * static_cast<double>(s.irradiance.size())) / mean;
  };
  EXPECT_GT(rms(&RadiosityDeviations::publishedMap), 0.08);
  const double centroid = rms(&RadiosityDeviations::centroid), roll = rms(&RadiosityDeviations::fixedOrientation),
               far = rms(&RadiosityDeviations::noNearField);
  EXPECT_GT(centroid, 0.005);
  EXPECT_LT(centroid, 0.2);
  EXPECT_GT(roll, 0.0);
  EXPECT_LT(roll, 0.03);  // noise of 32 pixels
  EXPECT_GT(far, roll);
  EXPECT_LT(far, 0.1);
  RadiositySolutionSettings whole24 = wholeTriangles();
  whole24.deviations.values24Bit = true;
  EXPECT_THROW(solve(scene, whole24), Error);
  // What comes from emitters is part of all that comes, and nothing else is: without reflection it is all.
  Scene black = scene;
  for (Material& m : black.materials) m.diffuse = glm::vec3(0.0f);
  const RadiositySolution once = solve(black, wholeTriangles(1e-5));
  double least = 1e300;
  for (std::size_t i = 0; i < once.irradiance.size(); ++i) {
    ASSERT_NEAR(once.fromEmitters[i].x, once.irradiance[i].x, 1e-9);
    ASSERT_NEAR(once.fromEmitters[i].x, right.fromEmitters[i].x, 1e-9);
    least = std::min(least, right.irradiance[i].x - right.fromEmitters[i].x);
  }
  EXPECT_GT(least, 0.0);
}

TEST_F(RadiositySolutions, WithoutMemoryRowsAreComputedAnewToTheSameAnswer) {
  const Scene scene = dark(cubeRoom(3, 0.6, 1.0));
  RadiositySolutionSettings settings = wholeTriangles(1e-5), little = wholeTriangles(1e-5);
  little.memoryBytes = 1000;
  const RadiositySolution kept = solve(scene, settings), anew = solve(scene, little);
  EXPECT_TRUE(kept.keptRows);
  EXPECT_FALSE(anew.keptRows);
  EXPECT_EQ(anew.solver, RadiositySolver::anderson);
  EXPECT_GT(anew.hemicubes, 2 * kept.hemicubes);
  for (std::size_t i = 0; i < kept.exitance.size(); ++i)
    ASSERT_NEAR(anew.exitance[i].x / kept.exitance[i].x, 1.0, 1e-4);
}

TEST_F(RadiositySolutions, ReflectanceOneInAClosedRoomIsRefused) {
  try {
    solve(dark(cubeRoom(2, 1.0, 1.0)), wholeTriangles());
    ADD_FAILURE() << "solved";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::badInput);
    EXPECT_NE(std::string(e.what()).find("closed"), std::string::npos) << e.what();
  }
}

TEST_F(RadiositySolutions, SunSpotAndPointLights) {
  SceneBuilder builder;
  const int m = lambertian(builder, 0.0);
  builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, m);
  builder.plate({0, 1, 0}, {0, 0, 2}, {2, 0, 0}, m);  // hides a square of side 2 from a sun above
  builder.sun({0, -1, 0}, glm::vec3(3.0f));
  RadiositySolutionSettings settings;
  settings.patches.longestEdge = 0.6;
  settings.hemicubes.resolution = 16;
  const RadiositySolution sun = solve(builder.scene(), settings);
  for (std::size_t i = 0; i < sun.direct.size(); ++i) {
    const Patch& p = sun.mesh.patches[i];
    const double away = std::max(std::abs(p.centroid.x), std::abs(p.centroid.z));
    if (p.centroid.y > 0.5 || away > 1.35) {
      EXPECT_NEAR(sun.direct[i].x, 3.0, 1e-5);
    } else if (away < 0.65) {
      EXPECT_EQ(sun.direct[i].x, 0.0);
    }
  }
  Scene lamp = builder.scene();
  lamp.sun.reset();
  lamp.points.push_back({{0, 3, 0}, glm::vec3(2.0f)});
  const RadiositySolution point = solve(lamp, settings);
  for (std::size_t i = 0; i < point.direct.size(); ++i) {
    const Patch& p = point.mesh.patches[i];
    const glm::dvec3 to = glm::dvec3(0, 3, 0) - p.centroid;
    const double r = glm::length(to);
    if (p.centroid.y > 0.5) { EXPECT_NEAR(point.direct[i].x / (2.0 * to.y / (r * r * r)), 1.0, 0.02); }
  }
  EXPECT_GT(point.mesh.patches.size(), 100u);
}

TEST_F(RadiositySolutions, RefinementFollowsShadowBordersWithoutTJunctions) {
  SceneBuilder builder;
  const int m = lambertian(builder, 0.3);
  builder.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, m);
  builder.plate({0, 1, 0}, {0, 0, 1.7}, {1.7, 0, 0}, m);
  builder.sun({0, -1, 0}, glm::vec3(3.0f));
  RadiositySolutionSettings settings;
  settings.patches.longestEdge = 0.8;
  settings.hemicubes.resolution = 16;
  const RadiositySolution coarse = solve(builder.scene(), settings);
  settings.refinements = 2;
  const RadiositySolution fine = solve(builder.scene(), settings);
  EXPECT_GT(fine.mesh.patches.size(), coarse.mesh.patches.size() * 3 / 2);
  EXPECT_EQ(test::countTJunctions(fine.mesh), 0u);
  EXPECT_NEAR(fine.mesh.area(), coarse.mesh.area(), 1e-9);
  double border = 0.0, borders = 0.0, far = 0.0, fars = 0.0;
  for (const Patch& p : fine.mesh.patches) {
    if (p.centroid.y > 0.5) continue;
    const double away = std::abs(std::max(std::abs(p.centroid.x), std::abs(p.centroid.z)) - 0.85);
    (away < 0.1 ? border : far) += away < 0.1 || away > 0.7 ? p.area : 0.0;
    (away < 0.1 ? borders : fars) += away < 0.1 || away > 0.7 ? 1.0 : 0.0;
  }
  EXPECT_LT(border / borders, 0.5 * far / fars);
}

}  // namespace
}  // namespace lucerna
