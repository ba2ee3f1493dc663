// Light shafts on GL: against closed forms, and against the path tracer in the same medium.
#include "cascades/cascades.hpp"
#include "lpv/light_shafts.hpp"
#include "lpv/lpv_frame.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/renderer.hpp"
#include "support/gl_fixture.hpp"
#include "support/lpv_on_gl.hpp"
#include "support/media_scenes.hpp"
#include "support/small_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

namespace lucerna {
namespace {

constexpr glm::ivec2 kShaftsSize{48, 32};

class LightShaftsTest : public test::SharedProgramsTest {
 protected:
  /// A box of haze from (-4, 0, -4) to (4, 4, 4) over a floor of that albedo at `floor`.
  static Scene hazeOver(const Medium& medium, float albedo, double floor, const glm::dvec3& sun) {
    test::SceneBuilder builder;
    builder.plate({0, floor, 0}, {0, 0, 7.9}, {7.9, 0, 0}, builder.material(glm::vec3(albedo)));
    builder.sun(sun, {5.0f, 4.0f, 3.0f});
    Scene scene = builder.scene();
    scene.media.push_back(medium);
    test::addBox(scene, {-4, 0, -4}, {4, 4, 4}, test::addBoundary(scene, Bsdf::none, 1.0, 0));
    return scene;
  }
  static RenderSettings settingsOf(Component component) {
    RenderSettings settings;
    settings.technique = "lpv";
    settings.component = component;
    settings.size = kShaftsSize;
    settings.fullFloatTarget = true;
    settings.of<LpvSettings>().shafts = true;
    return settings;
  }
  static Image picture(const Scene& scene, const Camera& camera, const RenderSettings& settings) {
    Renderer renderer(context(), library(), scene, settings);
    renderer.renderToTheEnd(camera);
    return renderer.readRadiance();
  }
  /// Light of at most so many scatterings.
  static Image traced(const Scene& scene, const Camera& camera, Transport transport, std::uint32_t scatterings,
                      std::uint32_t samples) {
    PathTracer::Settings settings;
    settings.size = kShaftsSize;
    settings.transport = transport;
    settings.bounces = scatterings;
    settings.filter = PixelFilter::centre;
    PathTracer tracer(context(), library(), scene, settings);
    tracer.setCamera(camera);
    tracer.record(samples);
    return tracer.mean();
  }
  static glm::dvec3 mean(const Image& image) { return meanOf(image); }
};

// From the side, under a vertical sun: every point of the ray is as deep in the haze, so the integral is a closed
// form. The view is 1e-4 wide, and floats know its rays' directions to as much: phase functions of g = 0.5 and -0.7
// change by 1.2 and 1.4 times that.
TEST_F(LightShaftsTest, HazeUnderTheSunIsAClosedForm) {
  Medium medium = test::homogeneous({0.05, 0.1, 0.4}, {0.0, 0.1, 0.02}, 0.0);
  medium.anisotropy = {0.0f, 0.5f, -0.7f};
  Scene scene = hazeOver(medium, 0.0f, -1.0, {0, -1, 0});
  scene.background = {0.2f, 0.3f, 0.4f};
  const Camera camera = test::cameraAt({0, 2.5, 20}, {0, 2.5, 0});
  const Image image = picture(scene, camera, settingsOf(Component::all));
  for (int c = 0; c < 3; ++c) {
    const double s = medium.scattering[c], t = s + static_cast<double>(medium.absorption[c]), g = medium.anisotropy[c];
    const double phase = (1.0 - g * g) / (4.0 * std::numbers::pi * std::pow(1.0 + g * g, 1.5));
    const double expected = s * phase * static_cast<double>(scene.sun->irradiance[c]) * std::exp(-1.5 * t) *
                                (1.0 - std::exp(-8.0 * t)) / t +
                            static_cast<double>(scene.background[c]) * std::exp(-8.0 * t);
    for (const int x : {0, 20, 47}) EXPECT_NEAR(image.at(x, 7)[c] / expected, 1.0, 3e-4) << c;
  }
  // Rayleigh's: 3 / (16 pi) across the light.
  scene.media[0].phase = PhaseFunction::rayleigh;
  const double t = 0.05, rayleigh = 0.05 * 3.0 / (16.0 * std::numbers::pi) * 5.0 * std::exp(-1.5 * t) *
                                        (1.0 - std::exp(-8.0 * t)) / t +
                                    0.2 * std::exp(-8.0 * t);
  EXPECT_NEAR(picture(scene, camera, settingsOf(Component::all)).at(9, 9).x / rayleigh, 1.0, 3e-4);
}

// A blocker's shaft of shadow, floor and haze, against paths of one scattering: the same light. What differs is
// noise, the shadow map's edges and, of a slanting sun, S within a piece: 64 pieces of 0.17 units of extinction 0.2
// to 0.4 leave less than (0.17 * 0.4)^2 / 24 of it, 2e-4.
TEST_F(LightShaftsTest, ShaftsOfTheSunAgreeWithThePathTracer) {
  Scene scene = hazeOver(test::homogeneous({0.15, 0.2, 0.3}, {0.05, 0.05, 0.1}, 0.4), 0.5f, 0.25, {0.35, -1, 0.2});
  const int black = static_cast<int>(scene.materials.size());
  scene.materials.emplace_back().diffuse = glm::vec3(0.0f);
  test::addBox(scene, {-1.5, 2.9, -1.5}, {1.0, 3.1, 1.5}, black);
  const Camera camera = test::lookingAt({3, 6, 14}, {0, 1.8, 0}, 0.55);
  const Image here = picture(scene, camera, settingsOf(Component::direct));
  const Image there = traced(scene, camera, Transport::direct, 1, 1024);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean(here)[c] / mean(there)[c], 1.0, 0.01) << c;
  double differences = 0.0, squares = 0.0;
  for (int by = 0; by < kShaftsSize.y; by += 4)
    for (int bx = 0; bx < kShaftsSize.x; bx += 4) {
      double a = 0.0, b = 0.0;
      for (int y = by; y < by + 4; ++y)
        for (int x = bx; x < bx + 4; ++x) a += here.at(x, y).y / 16.0, b += there.at(x, y).y / 16.0;
      differences += (a - b) * (a - b), squares += b * b;
    }
  const double error = std::sqrt(differences / squares);
  std::cout << "[ measured ] relative L2 of blocks against the path tracer: " << error << "\n";
  EXPECT_LT(error, 0.03);
  // Without shafts it is another picture: no haze, the boundary a grey box.
  RenderSettings without = settingsOf(Component::direct);
  without.of<LpvSettings>().shafts = false;
  EXPECT_GT(std::abs(mean(picture(scene, camera, without)).y / mean(there).y - 1.0), 0.2);
}

/// What the volume's light scatters towards the eye along a ray from `from` in direction `along`, `length` long,
/// green, per sigma_s: its coefficients read back, interpolated and integrated in double precision.
double scatteredOfVolume(const Renderer& renderer, const Cascade& grid, double irradiance, const glm::dvec3& from,
                         const glm::dvec3& along, double length, double extinction, double g) {
  // Radiance Y00 l0 + Y1 <l1, w> gives a plane pi Y00 l0 + 2 pi / 3 Y1 <l1, -n>; the lookup of coefficients c gives
  // it Y00 2 pi / 3 c0 + Y1 (Omega_f + 8 Omega_s / sqrt 5) <c1, -n> (engine/lpv/README.md).
  const double y00 = 0.5 / std::sqrt(std::numbers::pi), y1 = std::sqrt(0.75 / std::numbers::pi);
  const double band0 = y00 * 2.0 / 3.0,
               band1 = y1 * (0.400669684646 + 8.0 * 0.423431354457 / std::sqrt(5.0)) * 1.5 / std::numbers::pi;
  const gl::Texture& green = volumeOf(renderer.technique())->result()[1];
  const std::vector<glm::vec4> texels = green.readRgba();
  const glm::ivec3 size = green.size();
  const auto at = [&](const glm::ivec3& cell) {
    return glm::dvec4(texels[static_cast<std::size_t>((cell.z * size.y + cell.y) * size.x + cell.x)]);
  };
  constexpr int kPoints = 4000;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double t = (i + 0.5) * length / kPoints;
    const glm::dvec3 texel = (from + t * along - grid.minimum()) / grid.cellSize - 0.5, low = glm::floor(texel),
                     part = texel - low;
    glm::dvec4 c(0.0);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::dvec3 w = glm::mix(1.0 - part, part, glm::dvec3(step));
      c += w.x * w.y * w.z * at(glm::ivec3(low) + step);
    }
    const double scattered = band0 * c.x - g * band1 * glm::dot(glm::dvec3(c.y, c.z, c.w), along);
    sum += std::exp(-extinction * t) * std::max(scattered, 0.0) * irradiance * length / kPoints;
  }
  return sum;
}

// How much light haze gets from the volume. A medium scatters in proportion to the fluence, the path that light
// travels per volume. A step of propagation carries a cell's whole flux one cell on, and the lookup counts 2/3 of a
// cell for it, the mean chord 4 V / A of a cube: c0 gives l0 = 2/3 c0, 4 pi of it the fluence. So after N steps all
// light has been counted with 2/3 (N + 1) cells of path, wherever it went (a lobe's first step gains 1.138208 by the
// kernel's clamp). It went sqrt(1.33 N - 0.33) cells, since it forgets its direction: after 8 steps 5.9 cells of path
// for 3.2 cells of way, 1.84 times too much, after 48 about 4.
TEST_F(LightShaftsTest, EachStepCountsTwoThirdsOfACellOfPath) {
  const std::vector<test::RsmTexel> light{{{10.5f, 10.0f, 10.5f, 1}, {0, 1, 0, 1}, glm::vec3(1.0f)}};
  const test::RsmTextures textures(light, 1.0);
  const LpvInputs inputs{{textures.outputs()}, test::unitCascade(21), 1.0f};
  for (const int steps : {0, 4, 8}) {
    LpvSettings settings;
    settings.cascades.cells = 21;
    settings.cascades.cascades = 1;
    settings.iterations = steps;
    settings.blocking = false;
    settings.storage = LpvSettings::Storage::full;
    const LightPropagationVolume lpv = test::runVolume(library(), capabilities(), settings, inputs);
    const double path = 2.0 / 3.0 * reference::totalFlux(test::readVolume(lpv.result(), inputs)[0][1]);
    EXPECT_NEAR(path / (2.0 / 3.0 * (1.0 + 1.138208 * steps)), 1.0, 1e-5) << steps;
  }
}

/// Fluence in the layers above an endless floor of radiosity 1, by a chain over layers that knows no grid: what the
/// six directions of travel carry per step, of the functions (c0, c1 upwards) of a layer. Cells of side 1.
std::vector<double> fluenceAboveFloor(int steps, int layers) {
  const double y00 = 0.5 / std::sqrt(std::numbers::pi), y1 = std::sqrt(0.75 / std::numbers::pi), root5 = std::sqrt(5.0);
  const double front = 4.0 * std::atan(std::sqrt(11.0) / 33.0);
  const double side = 2.0 * std::atan(3.0 * std::sqrt(11.0) / 11.0) - std::numbers::pi / 3.0;
  const double lobe0 = 0.5 / std::sqrt(std::numbers::pi), lobe1 = 1.0 / std::sqrt(3.0 * std::numbers::pi);  // over pi
  const int count = 2 * (steps + layers) + 1, floor = steps + layers;
  std::vector<glm::dvec2> now(static_cast<std::size_t>(count)), sum(now.size());
  const auto at = [](std::vector<glm::dvec2>& v, int i) -> glm::dvec2& { return v[static_cast<std::size_t>(i)]; };
  at(now, floor) = at(sum, floor) = {lobe0, lobe1};
  for (int k = 0; k < steps; ++k) {
    std::vector<glm::dvec2> next(now.size());
    const auto add = [&](int to, double flux, double up) {
      if (to >= 0 && to < count) at(next, to) += std::max(flux, 0.0) * glm::dvec2(lobe0, up * lobe1);
    };
    for (int i = 0; i < count; ++i) {
      const double zero = y00 * at(now, i).x, first = y1 * at(now, i).y;
      for (const int up : {1, -1}) {  // the next layer: its far face, and four sides whose lobes lie level
        add(i + up, front * (zero + up * first), up);
        for (int face = 0; face < 4; ++face) add(i + up, side * (zero + up * 2.0 * first / root5), 0.0);
      }
      for (int travel = 0; travel < 4; ++travel) {  // a neighbour in this layer: far face, two level sides, up, down
        add(i, front * zero, 0.0);
        for (int face = 0; face < 2; ++face) add(i, side * zero, 0.0);
        for (const int up : {1, -1}) add(i, side * (zero + up * first / root5), up);
      }
    }
    now = next;
    for (int i = 0; i < count; ++i) at(sum, i) += at(now, i);
  }
  std::vector<double> fluence;
  for (int layer = 0; layer < layers; ++layer)
    fluence.push_back(4.0 * std::numbers::pi * y00 * 2.0 / 3.0 * at(sum, floor + layer).x);
  return fluence;
}

// Above an endless floor of radiosity B fluence is 2 B at every height (radiance B / pi from half of all directions).
// The volume's grows with the root of the number of steps, as visits of a random walk to where it began do: for the
// lowest layer 0.33, 1.32 and 1.84 times 2 B after 0, 8 and 16 steps, and it falls with height.
TEST_F(LightShaftsTest, AboveAFloorTheVolumesLightGrowsWithTheSteps) {
  constexpr int kCells = 17, kFloor = 8;
  std::vector<test::RsmTexel> lights;
  for (int z = 0; z < kCells; ++z)
    for (int x = 0; x < kCells; ++x)
      lights.push_back(
          {{static_cast<float>(x) + 0.5f, kFloor, static_cast<float>(z) + 0.5f, 1}, {0, 1, 0, 1}, glm::vec3(1.0f)});
  const test::RsmTextures textures(lights, 1.0);
  const LpvInputs inputs{{textures.outputs()}, test::unitCascade(kCells), 1.0f};
  for (const int steps : {0, 8}) {
    LpvSettings settings;
    settings.cascades.cells = kCells;
    settings.cascades.cascades = 1;
    settings.iterations = steps;
    settings.blocking = false;
    settings.storage = LpvSettings::Storage::full;
    const LightPropagationVolume lpv = test::runVolume(library(), capabilities(), settings, inputs);
    const reference::Volume volume = test::readVolume(lpv.result(), inputs)[0][1];
    const std::vector<double> chain = fluenceAboveFloor(steps, 4);
    for (int layer = 0; layer < 4; ++layer) {  // in the middle, as far from the border as there are steps
      const double here = 2.0 / 3.0 * reference::flux(volume.at({kCells / 2, kFloor + layer, kCells / 2}));
      EXPECT_NEAR(here, chain[static_cast<std::size_t>(layer)], 1e-5) << steps << " steps, layer " << layer;
    }
  }
  const double exact = 2.0;
  EXPECT_NEAR(fluenceAboveFloor(0, 1)[0] / exact, 1.0 / 3.0, 1e-9);
  EXPECT_NEAR(fluenceAboveFloor(8, 1)[0] / exact, 1.323, 1e-3);
  EXPECT_NEAR(fluenceAboveFloor(16, 1)[0] / exact, 1.836, 1e-3);
  // Ever closer to the root of the number: twice as much for four times the steps.
  EXPECT_NEAR(fluenceAboveFloor(512, 1)[0] / fluenceAboveFloor(128, 1)[0], 2.0, 0.02);
}

// Light that a sunlit floor sends up, scattered above it towards a camera below that sees nothing else: rays enter
// over the floor's edge and rise. The volume's part is the integral over what lies in its textures: to 0.3 %, of 16
// bits and of 64 points a ray. How right that light is, paths of floor and haze tell; the two tests above say why it
// is too much.
TEST_F(LightShaftsTest, LightOfTheVolumeScatters) {
  const double sigma = 0.01, g = 0.4;
  const Scene scene = hazeOver(test::homogeneous(glm::dvec3(sigma), glm::dvec3(0.0), g), 0.8f, 0.05, {0, -1, 0});
  RenderSettings settings = settingsOf(Component::indirect);
  settings.of<LpvSettings>().cascades.cells = 16;
  settings.of<LpvSettings>().cascades.cascades = 1;
  for (const int iterations : {8, 48})
    for (const double height : {0.5, 1.0, 1.5}) {
      settings.of<LpvSettings>().iterations = iterations;
      const glm::dvec3 entry(0, height, 4);
      const Camera camera = test::cameraAt({0, -3, 20}, entry);
      Renderer renderer(context(), library(), scene, settings);
      renderer.renderToTheEnd(camera);
      const double here = mean(renderer.readRadiance()).y;
      const std::vector<Cascade> grids =
          placeCascades(settings.of<LpvSettings>().cascades, scene.bounds, camera.position, camera.direction);
      const double integral =
          scatteredOfVolume(renderer, grids[0], 5.0, entry, camera.direction, 8.0 / -camera.direction.z, sigma, g);
      EXPECT_NEAR(here / (sigma * integral), 1.0, 3e-3) << iterations << " steps, height " << height;
      const double there = mean(traced(scene, camera, Transport::indirect, 2, 16)).y;
      std::cout << "[ measured ] " << iterations << " steps, from height " << height << ": volume over path tracer "
                << here / there << "\n";
    }
}

// What a phase function prefers: the floor's light travels up, and more of it is seen from above if haze scatters
// forwards. Not much more, as what has gone through cells travels every way.
TEST_F(LightShaftsTest, AnisotropyTurnsTheVolumesLight) {
  const Camera above = test::cameraAt({0, 20, 0.01}, {0, 0, 0}, 0.02);
  double seen[3];
  const double gs[3] = {-0.6, 0.0, 0.6};
  const RenderSettings settings = settingsOf(Component::indirect);
  const Scene clear = hazeOver(test::homogeneous(glm::dvec3(1e-9), glm::dvec3(0.01), 0.0), 0.8f, 0.05, {0, -1, 0});
  const double floor = mean(picture(clear, above, settings)).y;  // through the same extinction
  for (int i = 0; i < 3; ++i)
    seen[i] =
        mean(picture(hazeOver(test::homogeneous(glm::dvec3(0.01), glm::dvec3(0.0), gs[i]), 0.8f, 0.05, {0, -1, 0}),
                     above, settings))
            .y -
        floor;
  EXPECT_GT(seen[2], 1.1 * seen[1]);
  EXPECT_NEAR(0.5 * (seen[0] + seen[2]) / seen[1], 1.0, 2e-3) << "g counts in band 1 alone";
}

TEST_F(LightShaftsTest, NothingOfThemIsThereUnlessAskedFor) {
  const Scene scene = hazeOver(test::homogeneous(glm::dvec3(0.1), glm::dvec3(0.0), 0.0), 0.5f, 0.25, {0, -1, 0});
  const auto made = [&](const Scene& of, bool shafts) {
    RenderSettings settings = settingsOf(Component::all);
    settings.of<LpvSettings>().shafts = shafts;
    gl::ProgramLibrary own;
    Renderer renderer(context(), own, of, settings);
    renderer.render(test::cameraAt({0, 2, 20}, {0, 2, 0}, 0.5));
    const std::vector<std::string> left = renderer.leftOut(), names = own.names();
    return std::pair(std::count(left.begin(), left.end(), "light shafts"),
                     std::count(names.begin(), names.end(), "light shafts"));
  };
  EXPECT_EQ(made(scene, true), std::pair(std::ptrdiff_t{0}, std::ptrdiff_t{1}));
  EXPECT_EQ(made(scene, false), std::pair(std::ptrdiff_t{1}, std::ptrdiff_t{0}));
  EXPECT_EQ(made(test::openBox(), true), std::pair(std::ptrdiff_t{1}, std::ptrdiff_t{0})) << "no haze there";
  EXPECT_FALSE(hazeOf(test::openBox()).has_value());
  const std::optional<Haze> haze = hazeOf(scene);
  ASSERT_TRUE(haze.has_value());
  EXPECT_EQ(haze->box.min, glm::dvec3(-4, 0, -4));
  EXPECT_EQ(haze->box.max, glm::dvec3(4, 4, 4));
  Scene about = test::openBox();
  about.media = {test::homogeneous(glm::dvec3(0.1), glm::dvec3(0.0), 0.0)};
  about.cameraMedium = 0;
  EXPECT_EQ(hazeOf(about)->box.max, about.bounds.max);
}

}  // namespace
}  // namespace lucerna
