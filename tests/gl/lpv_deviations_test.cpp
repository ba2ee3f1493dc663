// Each deviation of engine/NAME/technique.cpp by its own known figure: what is right without it, and what it does
// when it is on.
//
// Switches are turned by name, as on the command line. Where the reference implementation has the matching option, the
// GL is held against it too. Expected values follow from the formulas beside them [Kaplanyan2010; Kirsch2010].
#include "render/deviations.hpp"
#include "rsm/rsm_gather.hpp"
#include "shared/frame.h"
#include "support/gl_fixture.hpp"
#include "support/lpv_on_gl.hpp"
#include "support/rsm_maps.hpp"
#include "support/small_scenes.hpp"
#include "support/sun_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <random>

namespace lucerna {
namespace {

using reference::VolumeRgb;
using test::kFullTolerance;
using test::Probe;
using test::report;
using test::RsmTexel;
using test::RsmTextures;
using test::unitCascade;

const double kFront = reference::frontSolidAngle(), kSide = reference::sideSolidAngle();

/// A light that injection moves to the middle of a unit cell. Its area is as good as none.
RsmTexel lightIn(const glm::ivec3& cell, const glm::vec3& normal, const glm::vec3& flux) {
  const glm::vec3 n = glm::normalize(normal);
  return {glm::vec4(glm::vec3(cell) + 0.5f - 0.5f * n, 1.0f), glm::vec4(n, 1e30f), flux};
}

/// Two opposite lobes in every cell: isotropic, flux 2 a cell.
std::vector<RsmTexel> isotropic(int cells) {
  std::vector<RsmTexel> texels;
  for (int i = 0; i < cells * cells * cells; ++i)
    for (const float way : {1.0f, -1.0f})
      texels.push_back(lightIn({i % cells, i / cells % cells, i / cells / cells}, {0, 0, way}, glm::vec3(1.0f)));
  return texels;
}

/// A black wall in the plane x = `x`: a surfel of one cell's area on each corner, facing along `way`.
void addWall(std::vector<RsmTexel>& texels, int cells, float x, float way) {
  for (int i = 0; i < (cells + 1) * (cells + 1); ++i)
    texels.push_back({{x, i % (cells + 1), i / (cells + 1), 1.0f}, {way, 0.0f, 0.0f, 1.0f}, glm::vec3(0.0f)});
}

class LpvDeviations : public test::SharedProgramsTest {
 protected:
  static LpvSettings settings(int cells, int iterations, bool blocking = false, int cascades = 1) {
    LpvSettings s;
    s.cascades.cells = cells;
    s.cascades.cascades = cascades;
    s.iterations = iterations;
    s.blocking = blocking;
    s.storage = LpvSettings::Storage::full;
    return s;
  }
  /// The settings with one deviation turned on, by name; and propagated as asked for.
  static LpvSettings with(const LpvSettings& s, const std::string& deviation,
                          LpvPropagate propagate = LpvPropagate::compute) {
    RenderSettings all;
    all.of<LpvSettings>() = s;
    all.of<LpvSettings>().propagate = propagate;
    applyDeviation(all, deviation + "=on");
    return all.of<LpvSettings>();
  }
  static RenderSettings with(const std::string& deviation) {
    RenderSettings all;
    if (!deviation.empty()) applyDeviation(all, deviation + "=on");
    return all;
  }

  struct Lights {
    std::vector<RsmTexel> texels;
    double texelArea;
    RsmTextures textures;
    LpvInputs inputs;
    Lights(std::vector<RsmTexel> lights, std::vector<Cascade> cascades, double area = 1.0, float irradiance = 1.0f)
        : texels(std::move(lights)),
          texelArea(area),
          textures(texels, area),
          inputs{{textures.outputs()}, std::move(cascades), irradiance} {}
  };
  static LightPropagationVolume run(const LpvSettings& s, const LpvInputs& inputs) {
    return test::runVolume(library(), capabilities(), s, inputs);
  }
  static VolumeRgb resultOf(const LpvSettings& s, const Lights& lights) {
    return test::readVolume(run(s, lights.inputs).result(), lights.inputs)[0];
  }
  static float seen(const LpvSettings& s, const Lights& lights, const Probe& probe) {
    return test::probeIrradiance(library(), run(s, lights.inputs), std::array{probe})[0].x;
  }

  /// Random lights with surfels in one cascade of unit cells.
  static Lights randomLights(int cells, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    std::normal_distribution<float> gauss;
    std::vector<RsmTexel> texels;
    for (int i = 0; i < 400; ++i) {
      const glm::vec3 n = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
      const glm::vec3 cell =
          glm::floor(static_cast<float>(cells) * 0.999f * glm::vec3(uniform(random), uniform(random), uniform(random)));
      // 0.6 of a cell about its middle after the half-cell shift: in no doubt which cell is its.
      const glm::vec3 p = cell + 0.2f + 0.6f * glm::vec3(uniform(random), uniform(random), uniform(random)) - 0.5f * n;
      const glm::vec3 inCorners = p + 0.5f;
      if (glm::any(glm::lessThan(glm::abs(inCorners - glm::round(inCorners)), glm::vec3(1e-3f)))) continue;
      texels.push_back(
          {glm::vec4(p, 1.0f), glm::vec4(n, 0.2f + 0.8f * uniform(random)), glm::vec3(uniform(random), 0.3f, 1.0f)});
    }
    return Lights(std::move(texels), unitCascade(cells), 0.1);
  }
  /// The GL with the settings beside the reference implementation with the options, sums of all steps.
  static double errorOfReference(const LpvSettings& s, const reference::KernelOptions& options) {
    const int cells = s.cascades.cells;
    const Lights lights = randomLights(cells, 11);
    const std::vector<reference::Vpl> vpls = test::vplsOf(lights.texels, lights.texelArea);
    const reference::GridSpec grid = test::gridOf(lights.inputs.cascades[0], cells);
    VolumeRgb injected = reference::makeVolumeRgb(grid);
    reference::inject(injected, vpls);
    reference::Volume geometry(reference::geometryGrid(grid));
    reference::injectSurfels(geometry, grid, vpls);
    const VolumeRgb expected =
        reference::propagate(injected, s.iterations, options, s.blocking ? &geometry : nullptr).accumulated;
    return test::relativeError(expected, resultOf(s, lights));
  }
  /// A kernel's deviation in both ways to propagate: the reference implementation with the option is met, the reference
  /// implementation without is not.
  static void expectKernelOfReference(const std::string& name, const reference::KernelOptions& options,
                                      float amplifier = 1.0f) {
    LpvSettings s = settings(7, 4, true);
    s.amplifier = amplifier;
    for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered}) {
      EXPECT_LT(errorOfReference(with(s, name, propagate), options), kFullTolerance) << nameOf(propagate);
      EXPECT_GT(errorOfReference(with(s, name, propagate), {}), 1e-3) << nameOf(propagate);
    }
  }
  /// Band-0 gain of the second step over the first in the middle of a homogeneous isotropic field.
  static double isotropicGain(LpvSettings s) {
    const Lights lights(isotropic(5), unitCascade(5));
    const glm::ivec3 middle(2);
    double sums[3];
    for (int i = 0; i < 3; ++i) {
      s.iterations = i;
      sums[i] = resultOf(s, lights)[0].at(middle).c0;
    }
    EXPECT_NEAR((sums[1] - sums[0]) / sums[0], (sums[2] - sums[1]) / (sums[1] - sums[0]), 5e-6);
    return (sums[1] - sums[0]) / sums[0];
  }
};

// ---- the list
// ----------------------------------------------------------------------------------------------------------

/// The deviations that have a test here.
const std::array kTested{
    "rsm.flux-cosine",      "rsm.gather-weight",      "rsm.reach",       "rsm.unbounded",        "lpv.flux-units",
    "lpv.sum-cascades",     "lpv.unjoined",           "lpv.truncate",    "lpv.first-cell",       "lpv.side-directions",
    "lpv.side-solid-angle", "lpv.four-pi-kernel",     "lpv.fewer-steps", "lpv.block-first-step", "lpv.surfel-area",
    "lpv.unwindowed",       "lpv.blocking-direction", "lpv.half-grids"};

TEST_F(LpvDeviations, EachOneHasATestHere) {
  std::size_t others = 0;
  for (const Deviation& deviation : allDeviations()) {
    const std::string_view name = deviation.name;
    if (name.starts_with("path.") ||
        name.starts_with(
            "radiosity.")) {  // tests/physics/media_deviations_test.cpp, tests/gl/radiosity_solution_test.cpp
      ++others;
      continue;
    }
    EXPECT_NE(std::find(kTested.begin(), kTested.end(), name), kTested.end()) << name;
  }
  EXPECT_EQ(allDeviations().size(), kTested.size() + others);
}

// ---- the kernel
// --------------------------------------------------------------------------------------------------------

TEST_F(LpvDeviations, SideSolidAngle) {
  const LpvSettings off = settings(5, 0);
  const double slipped = 1.0 + 4.0 * (reference::kSlippedSideSolidAngle - kSide) / (2.0 * kPi / 3.0);
  EXPECT_NEAR(slipped, 1.0000191, 5e-8);
  for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered}) {
    LpvSettings right = off;
    right.propagate = propagate;
    EXPECT_NEAR(isotropicGain(right), 1.0, 2e-6) << nameOf(propagate);
    EXPECT_NEAR(isotropicGain(with(off, "lpv.side-solid-angle", propagate)), slipped, 2e-6) << nameOf(propagate);
  }
  // An isotropic source of unit flux that reaches no border: what the thirtieth step carries.
  std::vector<RsmTexel> source;
  for (const float way : {1.0f, -1.0f}) source.push_back(lightIn(glm::ivec3(30), {0, 0, way}, glm::vec3(0.5f)));
  const Lights lights(source, unitCascade(61));
  const auto flux = [&](bool on, int steps) {
    const LpvSettings s = settings(61, steps);
    return reference::totalFlux(resultOf(on ? with(s, "lpv.side-solid-angle") : s, lights)[0]);
  };
  const double right = flux(false, 30) - flux(false, 29), on = flux(true, 30) - flux(true, 29);
  EXPECT_NEAR(right, 1.0, 3e-5);
  EXPECT_NEAR(on, 1.000573, 3e-5);
  report("flux of step 30", right);
  report("flux of step 30, lpv.side-solid-angle", on);
}

TEST_F(LpvDeviations, FourPiKernel) {
  LpvSettings s = settings(5, 0);
  EXPECT_NEAR(isotropicGain(s), 1.0, 2e-6);
  s.amplifier = 3.8f;  // does nothing by itself
  EXPECT_NEAR(isotropicGain(s), 1.0, 2e-6);
  for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered})
    for (const float amplifier : {1.0f, 1.75f, 3.0f, 3.8f, 4.0f}) {
      s.amplifier = amplifier;
      EXPECT_NEAR(isotropicGain(with(s, "lpv.four-pi-kernel", propagate)), amplifier / 4.0, 2e-6)
          << amplifier << nameOf(propagate);
    }
  expectKernelOfReference("lpv.four-pi-kernel", reference::fourPiKernel(static_cast<double>(3.8f)), 3.8f);
}

TEST_F(LpvDeviations, SideDirections) {
  // Band 0 of the sum of 8 steps, three cells away along an axis. Isotropic source: 0.006257 on every axis; with the
  // degenerate sides 0.004866 on x and y, 0.006729 on z. A lobe along z beside one along x: 2.17 times as much.
  const auto along = [](int axis, const LpvSettings& s, bool isotropicSource) {
    glm::vec3 way(0.0f);
    way[isotropicSource ? 2 : axis] = 1.0f;
    std::vector<RsmTexel> source{lightIn(glm::ivec3(8), way, glm::vec3(isotropicSource ? 0.5f : 1.0f))};
    if (isotropicSource) source.push_back(lightIn(glm::ivec3(8), -way, glm::vec3(0.5f)));
    glm::ivec3 cell(8);
    cell[axis] += 3;
    return resultOf(s, Lights(source, unitCascade(17)))[0].at(cell).c0;
  };
  const LpvSettings off = settings(17, 8);
  for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered}) {
    LpvSettings right = off;
    right.propagate = propagate;
    const LpvSettings on = with(off, "lpv.side-directions", propagate);
    const std::array figures{0.004866, 0.004866, 0.006729};
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(along(axis, right, true), 0.006257, 6e-7) << axis;
      EXPECT_NEAR(along(axis, on, true), figures[static_cast<std::size_t>(axis)], 6e-7) << axis;
    }
    EXPECT_NEAR(along(2, right, false) / along(0, right, false), 1.0, 1e-5);
    EXPECT_NEAR(along(2, on, false) / along(0, on, false), 2.17, 0.005);
  }
  expectKernelOfReference("lpv.side-directions", reference::componentProductKernel());
}

TEST_F(LpvDeviations, FewerSteps) {
  // A lobe in 3^3 cells: 1 + 1.138208 + 0.880462 + 0.566864 of flux after three steps; with the deviation the middle
  // two.
  const Lights lights({lightIn(glm::ivec3(1), {0, 0, 1}, glm::vec3(1.0f))}, unitCascade(3));
  const LpvSettings s = settings(3, 3);
  EXPECT_NEAR(reference::totalFlux(resultOf(s, lights)[0]), 1.0 + 1.138208 + 0.880462 + 0.566864, 3e-6);
  for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered})
    EXPECT_NEAR(reference::totalFlux(resultOf(with(s, "lpv.fewer-steps", propagate), lights)[0]), 1.138208 + 0.880462,
                3e-6)
        << nameOf(propagate);
}

// ---- blocking
// ----------------------------------------------------------------------------------------------------------

TEST_F(LpvDeviations, BlockFirstStep) {
  // A light on a wall in the plane x = 4 that faces up the x axis, one cell of wall on each corner. The light lies in
  // cell 4; across y and z it leaves through faces with the wall at half of their corners, so up to B = lobe / 2 of its
  // first step is taken: 1.138208 becomes 0.471575 ahead (through faces without wall) and four times what passes
  // across.
  std::vector<RsmTexel> texels{lightIn({4, 4, 4}, {1, 0, 0}, glm::vec3(1.0f))};
  addWall(texels, 8, 4.0f, 1.0f);
  const Lights lights(texels, unitCascade(8));
  const double a = 2.0 / std::sqrt(5.0), b = 1.0 / std::sqrt(5.0);
  const auto leaves = [](double wx) { return std::max(0.0, 0.25 + 0.5 * wx) / kPi; };
  const auto passes = [](double wx) { return 1.0 - std::clamp(0.5 * (0.25 - 0.5 * wx), 0.0, 1.0); };
  const double ahead = kFront * leaves(1.0) + 4.0 * kSide * leaves(a);
  const auto across = [&](bool blocked) {
    const auto term = [&](double wx) { return leaves(wx) * (blocked ? passes(wx) : 1.0); };
    return kFront * term(0.0) + kSide * (term(b) + term(-b) + 2.0 * term(0.0));
  };
  EXPECT_NEAR(ahead + 4.0 * across(false), 1.138208, 1e-6);
  const LpvSettings s = settings(8, 1, true);
  const auto firstStep = [&](const LpvSettings& of) { return reference::totalFlux(resultOf(of, lights)[0]) - 1.0; };
  EXPECT_NEAR(firstStep(s), 1.138208, 3e-6);
  for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered})
    EXPECT_NEAR(firstStep(with(s, "lpv.block-first-step", propagate)), ahead + 4.0 * across(true), 3e-6)
        << nameOf(propagate);
  report("first step of a light on a wall, lpv.block-first-step", firstStep(with(s, "lpv.block-first-step")));
  reference::KernelOptions options;
  options.blockFirstStep = true;
  expectKernelOfReference("lpv.block-first-step", options);
}

TEST_F(LpvDeviations, BlockingDirection) {
  // Isotropic light, a wall in the plane x = 4 that faces down the x axis. Light up the x axis meets its front and
  // loses 3/4 head on; light down the x axis meets its back and passes. With the deviation it is the other way round.
  std::vector<RsmTexel> texels = isotropic(8);
  addWall(texels, 8, 4.0f, -1.0f);
  const Lights lights(texels, unitCascade(8));
  const double b = 1.0 / std::sqrt(5.0);
  // Band 1 along x of the second step in the cells on both sides: front and sides of the neighbour across the wall,
  // sides of the others.
  const auto expected = [&](int x, double towards) {
    const auto passes = [&](double share, double wx) {
      return 1.0 - std::clamp(share * (0.25 + towards * 0.5 * wx), 0.0, 1.0);
    };
    const double up = x == 4 ? passes(1.0, 1.0) : 1.0, down = x == 3 ? passes(1.0, -1.0) : 1.0;
    const double difference = kFront * (up - down) + 4.0 * kSide * (passes(0.5, b) - passes(0.5, -b));
    return reference::kLobeBand1 / kPi * (2.0 / (4.0 * kPi)) * difference;  // intensity of flux 2 a cell
  };
  const auto measured = [&](LpvSettings s, int x) {
    const auto at = [&](int steps) {
      s.iterations = steps;
      return resultOf(s, lights)[0].at({x, 4, 4}).c1.x;
    };
    return at(2) - at(1);
  };
  const LpvSettings s = settings(8, 2, true);
  for (const int x : {3, 4}) {
    EXPECT_NEAR(measured(s, x), expected(x, 1.0), 3e-6) << x;
    for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered})
      EXPECT_NEAR(measured(with(s, "lpv.blocking-direction", propagate), x), expected(x, -1.0), 3e-6)
          << x << nameOf(propagate);
    EXPECT_GT(std::abs(expected(x, 1.0) - expected(x, -1.0)), 0.01);
  }
  reference::KernelOptions options;
  options.blockAlongTravel = true;
  expectKernelOfReference("lpv.blocking-direction", options);
}

TEST_F(LpvDeviations, SurfelArea) {
  // The demo's floor: an orthographic map of 256^2 texels of 0.098 square units, seen from 68 units away: 4 * 68^2 /
  // 256^2 = 0.2822, 2.88 times too much. On a slope at 60 degrees twice the texel is meant and half of that is taken.
  for (const double cosine : {1.0, 0.5}) {
    std::vector<RsmTexel> texels(256 * 256);
    texels[77] = {{2.0f, 2.0f, 2.0f, 1.0f}, {0, 1, 0, static_cast<float>(cosine)}, glm::vec3(0.0f)};
    Lights lights(texels, unitCascade(4), 0.098);
    lights.inputs.lightPosition = {2.0f, 70.0f, 2.0f};
    const auto area = [&](const LpvSettings& s) {
      const LightPropagationVolume lpv = run(s, lights.inputs);
      return test::readGeometryVolume(lpv, lights.inputs)[0].at(glm::ivec3(2)).c0 / reference::kLobeBand0;
    };
    const LpvSettings s = settings(4, 2, true);
    EXPECT_NEAR(area(s), 0.098 / cosine, 1e-6);
    const double perspective = area(with(s, "lpv.surfel-area"));
    EXPECT_NEAR(perspective, 4.0 * 68.0 * 68.0 / 65536.0 * cosine, 1e-6);
    report("surfel area over the right one", perspective / area(s));
  }
}

// ---- where and how much is injected
// ---------------------------------------------------------------------------------------

TEST_F(LpvDeviations, Truncate) {
  // Cells of 1.625 and grids at negative places: right minima are multiples of 1.625, published ones whole units off
  // that raster.
  constexpr int kCells = 6;
  LpvSettings s = settings(kCells, 2, true);
  s.cascades.cellSize = 1.625;
  s.cascades.heldInScene = false;
  for (const glm::dvec3& camera : {glm::dvec3(-11.3, 2.0, 7.7), glm::dvec3(4.0, -0.4, -30.2)}) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.5, 0.1, -0.8));
    const std::vector<Cascade> placed = placeCascades(s.cascades, Bounds{}, camera, direction);
    std::vector<RsmTexel> texels;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-6.0f, 6.0f);
    for (int i = 0; i < 500; ++i)
      texels.push_back(
          {glm::vec4(glm::vec3(placed[0].centre) + glm::vec3(uniform(random), uniform(random), uniform(random)), 1.0f),
           {0, 0, 1, 1},
           glm::vec3(1.0f)});
    const Lights lights(texels, placed, 0.1);
    const std::vector<reference::Vpl> vpls = test::vplsOf(texels, 0.1);
    const LpvSettings published = with(s, "lpv.truncate");
    for (const bool on : {false, true}) {
      const LightPropagationVolume lpv = run(on ? published : s, lights.inputs);
      for (const bool expectedOn : {false, true}) {
        reference::GridSpec grid =
            reference::cameraGrid(camera, direction, glm::ivec3(kCells), 1.625,
                                  expectedOn ? reference::SnapRule::truncate : reference::SnapRule::floor)
                .grid;
        const bool onRaster = glm::length(grid.minimum / 1.625 - glm::round(grid.minimum / 1.625)) < 1e-9;
        EXPECT_EQ(onRaster, !expectedOn);
        VolumeRgb injected = reference::makeVolumeRgb(grid);
        reference::inject(injected, vpls);
        reference::Volume geometry(reference::geometryGrid(grid));
        reference::injectSurfels(geometry, grid, vpls,
                                 expectedOn ? reference::IndexRule::truncate : reference::IndexRule::floor);
        const double error = test::relativeError(injected, test::readVolume(lpv.injected(), lights.inputs)[0]);
        const double errorOfGeometry = test::relativeError(geometry, test::readGeometryVolume(lpv, lights.inputs)[0]);
        if (on == expectedOn) {
          EXPECT_LT(error, kFullTolerance) << on;
          EXPECT_LT(errorOfGeometry, kFullTolerance) << on;
        } else {
          EXPECT_GT(error, 0.1);
          EXPECT_GT(errorOfGeometry, 0.1);
        }
      }
    }
  }
  // A surfel three quarters of a cell below the geometry volume's first centre, index -0.25: outside; truncated it
  // blocks in cell 0.
  const Lights below({{{1.5f, 1.5f, -0.75f, 1.0f}, {0, 0, 1, 1}, glm::vec3(0.0f)}}, unitCascade(4));
  const auto blocks = [&](const LpvSettings& of) {
    return test::readGeometryVolume(run(of, below.inputs), below.inputs)[0].at({2, 2, 0}).c0;
  };
  LpvSettings unit = settings(4, 2, true);
  EXPECT_EQ(blocks(unit), 0.0);
  EXPECT_NEAR(blocks(with(unit, "lpv.truncate")), reference::kLobeBand0, 1e-6);
}

TEST_F(LpvDeviations, FirstCell) {
  // One light in every cell of 4^3: 64 of flux; without the first cells of each axis 27. The same in the geometry
  // volume.
  std::vector<RsmTexel> texels;
  for (int i = 0; i < 64; ++i) texels.push_back(lightIn({i % 4, i / 4 % 4, i / 16}, {0, 1, 0}, glm::vec3(1.0f)));
  const Lights lights(texels, unitCascade(4));
  const LpvSettings s = settings(4, 0);
  for (const LpvFill fill : {LpvFill::layered, LpvFill::fixed}) {
    LpvSettings right = s;
    right.fill = fill;
    EXPECT_NEAR(reference::totalFlux(resultOf(right, lights)[0]), 64.0, 1e-4);
    EXPECT_NEAR(reference::totalFlux(resultOf(with(right, "lpv.first-cell"), lights)[0]), 27.0, 1e-4);
  }
  const Lights surfel({{{0.0f, 2.0f, 2.0f, 1.0f}, {1, 0, 0, 1}, glm::vec3(0.0f)}}, unitCascade(4));
  const auto blocks = [&](const LpvSettings& of) {
    return test::readGeometryVolume(run(of, surfel.inputs), surfel.inputs)[0].at({0, 2, 2}).c0;
  };
  EXPECT_NEAR(blocks(settings(4, 2, true)), reference::kLobeBand0, 1e-6);
  EXPECT_EQ(blocks(with(settings(4, 2, true), "lpv.first-cell")), 0.0);
  // Against the reference implementation's bounds test.
  const Lights random = randomLights(6, 3);
  VolumeRgb expected = reference::makeVolumeRgb(test::gridOf(random.inputs.cascades[0], 6));
  reference::InjectionOptions options;
  options.lowestCell = 1;
  reference::inject(expected, test::vplsOf(random.texels, 0.1), options);
  EXPECT_LT(test::relativeError(expected, resultOf(with(settings(6, 0), "lpv.first-cell"), random)), kFullTolerance);
}

TEST_F(LpvDeviations, FluxUnits) {
  // A plate z = 4 of albedo 1/2 lit by E = 3, seen from the middle of the cells before it: E_seen = 4/pi <c, lobe(-n)
  // windowed> with c = E albedo lobe / pi a unit area: (2 / pi) E albedo, for any number of texels and any cell.
  // Published: 1.7 I(-n) and E albedo a texel in place of E albedo A_texel / s^2: 1.7 * 0.75 / pi E albedo times the
  // texels in a cell.
  const double exitance = 0.5 * 3.0;
  for (const int perUnit : {1, 2, 4})
    for (const double cellSize : {1.0, 2.0}) {
      std::vector<RsmTexel> texels;
      const double area = 1.0 / (perUnit * perUnit);
      for (int i = 0; i < 64 * perUnit * perUnit; ++i) {
        const glm::vec2 p = (glm::vec2(i % (8 * perUnit), i / (8 * perUnit)) + 0.5f) / static_cast<float>(perUnit);
        texels.push_back({{p.x, p.y, 4.0f, 1.0f}, {0, 0, 1, 1}, glm::vec3(static_cast<float>(exitance * area))});
      }
      const Lights lights(texels, unitCascade(static_cast<int>(8.0 / cellSize), cellSize), area, 3.0f);
      LpvSettings s = settings(static_cast<int>(8.0 / cellSize), 0);
      s.lookup = LpvLookup::published;
      s.lookupOffset = 0.0f;
      const auto middle = static_cast<float>(4.0 + 0.5 * cellSize);
      const Probe probe{{middle, middle, middle}, {0, 0, -1}};
      EXPECT_NEAR(seen(s, lights, probe), 2.0 / kPi * exitance, 1e-5) << perUnit << " " << cellSize;
      const double texelsInCell = perUnit * perUnit * cellSize * cellSize;
      for (const LpvFill fill : {LpvFill::layered, LpvFill::fixed}) {
        LpvSettings on = with(s, "lpv.flux-units");
        on.fill = fill;
        EXPECT_NEAR(seen(on, lights, probe) / (1.7 * 0.75 / kPi * exitance * texelsInCell), 1.0, 1e-5)
            << perUnit << " " << cellSize << nameOf(fill);
      }
    }
}

// ---- cascades
// ----------------------------------------------------------------------------------------------------------

TEST_F(LpvDeviations, HalfGrids) {
  // 10,000 equal lights in one cell. Sums in 16 bits end at 4096 steps of what is added at the latest: a step is lost
  // where it is less than half a unit in the last of 11 places, and may count as up to two where it is more. By compute
  // or by layered passes as asked for, the deviation is the same, as it has passes of its own.
  const std::vector<RsmTexel> lights(10000, lightIn({1, 1, 1}, {0, 0, 1}, glm::vec3(1.0f)));
  const Lights all(lights, unitCascade(3));
  LpvSettings s = settings(3, 0);
  const auto band0 = [&](const LpvSettings& how) {
    return static_cast<double>(test::readVolume(run(how, all.inputs).injected(), all.inputs)[0][0].at({1, 1, 1}).c0);
  };
  const double right = band0(s), halves = band0(with(s, "lpv.half-grids"));
  report("10,000 lights in 16 bits over 32", halves / right);
  EXPECT_LT(halves / right, 0.4096);
  EXPECT_GT(halves / right, 0.0);
  // A smooth field of few lights: within the rounding of halves, and not to the bit.
  const Lights few(isotropic(5), unitCascade(5));
  s = settings(5, 4);
  const VolumeRgb exact = resultOf(s, few);
  for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered}) {
    const double error = test::relativeError(exact, resultOf(with(s, "lpv.half-grids", propagate), few));
    report("four steps in 16 bits, relative error", error);
    EXPECT_GT(error, 1e-5);
    EXPECT_LT(error, 2e-2);  // llvmpipe cuts off where it should round: up to 2^-11 a step and sum, on five sums
  }
}

TEST_F(LpvDeviations, SumCascades) {
  // Three cascades of the same cells see the same light: three times too much.
  const Lights lights(isotropic(8), {unitCascade(8)[0], unitCascade(8)[0], unitCascade(8)[0]});
  LpvSettings s = settings(8, 2, false, 3);
  s.cascades.ratio = 1.0;
  const LpvSettings single = settings(8, 2);
  const Lights alone(isotropic(8), unitCascade(8));
  const Probe probe{{4.3f, 3.6f, 4.1f}, {0, 1, 0}};
  const float one = seen(single, alone, probe);
  EXPECT_GT(one, 0.1f);
  EXPECT_NEAR(seen(s, lights, probe) / one, 1.0, 1e-5);
  EXPECT_NEAR(seen(with(s, "lpv.sum-cascades"), lights, probe) / one, 3.0, 1e-5);
}

/// Isotropic light that is emitted all through the scene, f(p) = exp(-|p|^2 / 200) a unit volume, from the middles of
/// the cells of the finest cascade that holds the place; see lpv_test.cpp.
struct SmoothField {
  static constexpr int kCells = 12;
  std::vector<Cascade> all;
  std::vector<RsmTexel> texels;
  std::vector<Probe> probes;
  explicit SmoothField(CascadeSettings c) {
    Bounds bounds;
    bounds.add(glm::dvec3(-12.0));
    bounds.add(glm::dvec3(12.0));
    all = placeCascades(c, bounds, glm::dvec3(0.0), glm::dvec3(0.0));
    for (std::size_t k = 0; k < all.size(); ++k)
      for (int i = 0; i < kCells * kCells * kCells; ++i) {
        const reference::GridSpec grid = test::gridOf(all[k], kCells);
        const glm::dvec3 p = grid.centre({i % kCells, i / kCells % kCells, i / (kCells * kCells)});
        if (k > 0 && reference::cellOf(test::gridOf(all[k - 1], kCells), p)) continue;
        const auto flux = static_cast<float>(std::exp(-glm::dot(p, p) / 200.0) * std::pow(grid.cellSize, 3.0));
        for (const float way : {1.0f, -1.0f})
          texels.push_back({glm::vec4(0.999f * glm::vec3(p), 1.0f), {0, 0, way, 1}, glm::vec3(flux)});
      }
    for (int i = 0; i < 125; ++i)
      for (const glm::vec3& normal : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, -1)})
        probes.push_back({0.2f * (glm::vec3(i % 5, i / 5 % 5, i / 25) - 2.0f), normal});
  }
};

TEST_F(LpvDeviations, Unjoined) {
  // A grid of half the cell size gathers light from half as far. Blended as they are, each cascade more nearly halves
  // the picture (not quite: the coarsest grid's border takes some light of the one that is compared with); joined it
  // stays; summed it is all of these together.
  LpvSettings s = settings(SmoothField::kCells, 8, false, 3);
  s.lookup = LpvLookup::published;
  s.cascades.cellSize = 2.0;
  const SmoothField field(s.cascades);
  const RsmTextures textures(field.texels, 0.0);
  const auto mean = [&](LpvSettings of, int cascades) {
    of.cascades.cascades = cascades;
    const LpvInputs inputs{{textures.outputs()}, {field.all.end() - cascades, field.all.end()}, 1.0f};
    double sum = 0.0;
    for (const glm::vec3& value : test::probeIrradiance(library(), run(of, inputs), field.probes))
      sum += static_cast<double>(value.x);
    return sum / static_cast<double>(field.probes.size());
  };
  const double one = mean(s, 1);
  double sum = 1.0;
  for (int cascades = 2; cascades <= 3; ++cascades) {
    const double unjoined = mean(with(s, "lpv.unjoined"), cascades) / one,
                 summed = mean(with(s, "lpv.sum-cascades"), cascades) / one;
    std::cout << "[ measured ] " << cascades << " cascades over one: unjoined " << unjoined << ", summed " << summed
              << "\n";
    EXPECT_NEAR(mean(s, cascades) / one, 1.0, 0.01);
    sum += unjoined;
    EXPECT_NEAR(unjoined, cascades == 2 ? 0.559 : 0.329, 0.002);
    EXPECT_NEAR(summed, sum, 1e-5);
  }
  // Against the reference implementation: propagated each by itself, then blended or summed.
  const LpvInputs inputs{{textures.outputs()}, field.all, 1.0f};
  const std::vector<reference::Vpl> vpls = test::vplsOf(field.texels, 0.0);
  std::vector<reference::Volume> cascades;
  reference::CascadeBlend blend{{}, static_cast<double>(s.blendBand)};
  std::vector<double> cellSizes;
  for (const Cascade& cascade : field.all) {
    VolumeRgb injected = reference::makeVolumeRgb(test::gridOf(cascade, SmoothField::kCells));
    reference::inject(injected, vpls);
    cascades.push_back(reference::propagate(injected[0], s.iterations).accumulated);
    blend.centres.push_back(cascade.centre);
    cellSizes.push_back(cascade.cellSize);
  }
  std::vector<Probe> probes = field.probes;
  for (std::size_t i = 0; i < probes.size(); ++i)
    probes[i].position *= 1.0f + 0.08f * static_cast<float>(i % 100);  // into all three and the bands between
  const std::vector<glm::vec3> blended = test::probeIrradiance(library(), run(with(s, "lpv.unjoined"), inputs), probes);
  const std::vector<glm::vec3> summed =
      test::probeIrradiance(library(), run(with(s, "lpv.sum-cascades"), inputs), probes);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const glm::dvec3 p(probes[i].position), n(probes[i].normal);
    const auto blendedAt = [&](const glm::dvec3& at) { return reference::blendedIrradiance(cascades, blend, at, n); };
    const auto summedAt = [&](const glm::dvec3& at) { return reference::irradianceSumOfCascades(cascades, at, n); };
    EXPECT_NEAR(blended[i].x, blendedAt(p), 2e-5 * one + test::offByFilters(p, cellSizes, blendedAt)) << i;
    EXPECT_NEAR(summed[i].x, summedAt(p), 2e-5 * one + test::offByFilters(p, cellSizes, summedAt)) << i;
  }
}

// ---- lookup
// ------------------------------------------------------------------------------------------------------------

TEST_F(LpvDeviations, Unwindowed) {
  // Two lights of unit flux in one cell, one towards the receiver and one away from it: 4/pi^2 (pi/4 + w pi/3) and
  // 4/pi^2 (pi/4 - w pi/3). With w = 3/4 the second is nothing, with w = 1 it takes 1 / (3 pi) of 7 / (3 pi).
  const RsmTexel towards = lightIn(glm::ivec3(2), {1, 0, 0}, glm::vec3(1.0f)),
                 away = lightIn(glm::ivec3(2), {-1, 0, 0}, glm::vec3(1.0f));
  const Lights one({towards}, unitCascade(5)), two({towards, away}, unitCascade(5)), behind({away}, unitCascade(5));
  LpvSettings s = settings(5, 0);
  s.lookup = LpvLookup::published;
  s.lookupOffset = 0.0f;
  const Probe probe{glm::vec3(2.5f), {-1, 0, 0}};
  EXPECT_NEAR(seen(s, one, probe), 2.0 / kPi, 1e-5);
  EXPECT_NEAR(seen(s, two, probe), 2.0 / kPi, 1e-5);
  EXPECT_NEAR(seen(s, behind, probe), 0.0, 1e-6);
  const LpvSettings on = with(s, "lpv.unwindowed");
  EXPECT_NEAR(seen(on, one, probe), 7.0 / (3.0 * kPi), 1e-5);
  EXPECT_NEAR(seen(on, two, probe), 6.0 / (3.0 * kPi), 1e-5);
  EXPECT_EQ(seen(on, behind, probe), 0.0f);
  // And against the reference implementation's lookup.
  const Lights random = randomLights(5, 9);
  const VolumeRgb injected = resultOf(s, random);
  for (int i = 0; i < 40; ++i) {
    const Probe at{{1.0f + 0.07f * static_cast<float>(i), 2.6f, 2.0f},
                   glm::normalize(glm::vec3(1, i % 5 - 2, i % 3 - 1))};
    const glm::dvec3 p(at.position), n(at.normal);
    for (const bool unwindowed : {true, false}) {
      const auto expected = [&](const glm::dvec3& moved) {
        return reference::irradiance(injected[0], moved, n,
                                     {unwindowed ? reference::Lookup::cosine : reference::Lookup::windowed, 0.0});
      };
      EXPECT_NEAR(seen(unwindowed ? on : s, random, at), expected(p),
                  1e-5 + test::offByFilters(p, std::array{1.0}, expected));
    }
  }
}

// ---- the reflective shadow map
// --------------------------------------------------------------------------------------------

TEST_F(LpvDeviations, RsmFluxCosine) {
  // A plate tilted by 60 degrees under a sun that falls straight down reflects albedo E (projected area), not half of
  // it.
  for (const double degrees : {0.0, 60.0}) {
    const double tilt = degrees * kPi / 180.0;
    test::SceneBuilder builder;
    builder.plate({0.0, 0.0, 0.0}, {0.0, 0.0, 2.0}, {2.0 * std::cos(tilt), 2.0 * std::sin(tilt), 0.0},
                  builder.material(glm::vec3(0.5f)));
    builder.sun({0.0, -1.0, 0.0}, glm::vec3(4.0f));
    const Scene& scene = builder.scene();
    const GpuScene gpuScene(scene, analyse(scene), capabilities());
    const auto flux = [&](const std::string& deviation) {
      ReflectiveShadowMap::Settings s = with(deviation).of<ReflectiveShadowMap::Settings>();
      s.size = 512;
      ReflectiveShadowMap rsm(library(), gpuScene, s);
      const SunFrustum frustum = fitSunFrustum(scene, scene.sun->direction);
      const gl::Buffer frame = test::bindSunFrame(scene, frustum);
      double sum = 0.0;
      for (const glm::vec4& texel : rsm.record(gpuScene, frustum).flux.readRgba()) sum += static_cast<double>(texel.x);
      return sum;
    };
    const double cosine = std::cos(tilt), right = flux("");
    EXPECT_NEAR(right / (0.5 * 4.0 * 4.0 * cosine), 1.0, 0.01) << degrees;
    EXPECT_NEAR(flux("rsm.flux-cosine") / right, cosine, 1e-3) << degrees;
  }
}

class RsmGatherDeviations : public LpvDeviations {
 protected:
  /// Irradiance at one point of a map, with the engine's shaders.
  static double gathered(const reference::RsmMap& map, RsmGather::Settings s, const glm::dvec3& position,
                         const glm::dvec3& normal) {
    std::vector<glm::vec4> data[3];
    for (const reference::RsmMap::Texel& t : map.texels) {
      data[0].emplace_back(glm::vec3(t.position), 1.0f);
      data[1].emplace_back(glm::vec3(t.normal), static_cast<float>(t.cosine));
      data[2].emplace_back(glm::vec3(t.flux), static_cast<float>(map.texelArea() / std::max(t.cosine, 0.05)));
    }
    gl::Texture textures[3];
    for (int i = 0; i < 3; ++i) {
      textures[i] =
          gl::Texture("test rsm", gl::Format::rgba32f, glm::ivec3(map.size, 1), {}, 1, gl::TextureKind::array);
      textures[i].upload(gl::Texels::rgbaFloat, data[i].data());
    }
    shared::FrameConstants frame{};
    frame.sunClipFromWorld = glm::mat4(map.clipFromWorld(10.0 * map.width));
    frame.sunDirection = glm::vec3(map.direction);
    const gl::Buffer constants("frame", sizeof frame, &frame, gl::Usage::staticDraw);
    const std::array probes{glm::vec4(glm::vec3(position), 0.0f), glm::vec4(glm::vec3(normal), 0.0f)};
    const std::vector<glm::vec4> pattern = RsmGather::pattern(s.samples, s.weight, glm::dvec2(0.0), s.exponent());
    const gl::Buffer in("probes", sizeof probes, probes.data(), gl::Usage::staticDraw),
        out("irradiances", sizeof(glm::vec4), nullptr, gl::Usage::streamRead);
    const gl::Buffer samples("pattern", pattern.size() * sizeof(glm::vec4), pattern.data(), gl::Usage::staticDraw);
    {
      const gl::ComputePass pass("probe");
      RsmGather::bindMap(library().loadCompute("rsm gather probe", "rsm/gather_probe.comp",
                                               RsmGather::flags(s, RsmGather::Light::sun)),
                         s, {{textures[0], textures[1], textures[2], static_cast<float>(map.texelArea())}});
      constants.bindUniform(0);
      samples.bindStorage(0);
      in.bindStorage(1);
      out.bindStorage(2);
      pass.dispatch(glm::ivec3(1), glm::ivec3(64, 1, 1));
    }
    return static_cast<double>(out.read<glm::vec4>()[0].x);
  }
  /// Texels that all lie in one place and face up: every sample sees the same.
  static reference::RsmMap mapOfOnePlace(int side) {
    reference::RsmMap map;
    map.size = glm::ivec2(side);
    map.corner = {-0.5, -0.5, 0.0};
    map.texels.assign(static_cast<std::size_t>(side * side),
                      {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, glm::dvec3(1.0), 1.0, true});
    return map;
  }
};

TEST_F(RsmGatherDeviations, GatherWeight) {
  // Within r = 0.3 of a map of 64 texels there are pi (0.3 * 64)^2, each gives Phi/pi / d^2 to a point straight above.
  // xi^2 for xi leaves 2/3.
  const reference::RsmMap map = mapOfOnePlace(64);
  RsmGather::Settings right = with("").of<RsmGather::Settings>();
  right.samples = 4096;
  right.nearField = RsmGather::Near::none;
  right.reach = RsmGather::Reach::radius;
  RsmGather::Settings published = with("rsm.gather-weight").of<RsmGather::Settings>();
  published.samples = right.samples;
  published.nearField = right.nearField;
  published.reach = right.reach;
  const double exact = kPi * std::pow(0.3 * 64.0, 2.0) / (kPi * 4.0);
  EXPECT_NEAR(gathered(map, right, {0, 0, 2}, {0, 0, -1}) / exact, 1.0, 1e-3);
  EXPECT_NEAR(gathered(map, published, {0, 0, 2}, {0, 0, -1}) / exact, 2.0 / 3.0, 1e-3);
}

TEST_F(RsmGatherDeviations, Reach) {
  // All 64 x 64 texels of the map are one, above which the point is; within r = 0.3 there are pi (0.3 * 64)^2.
  const reference::RsmMap map = mapOfOnePlace(64);
  const auto relative = [&](RsmGather::Settings s) {
    s.samples = 16384;
    s.nearField = RsmGather::Near::none;
    return gathered(map, s, {0, 0, 2}, {0, 0, -1}) / (64.0 * 64.0 / (kPi * 4.0));
  };
  EXPECT_NEAR(relative(with("").of<RsmGather::Settings>()), 1.0, 0.01);
  EXPECT_NEAR(relative(with("rsm.reach").of<RsmGather::Settings>()), kPi * 0.3 * 0.3, 1e-3);
}

TEST_F(RsmGatherDeviations, Unbounded) {
  // One texel of area 1 and exitance 1, 0.1 of its side above its middle: the reach holds pi/4 of it. No receiver can
  // get more than the exitance; Phi/pi / d^2 gives 100/pi.
  const reference::RsmMap map = mapOfOnePlace(1);
  RsmGather::Settings right = with("").of<RsmGather::Settings>(),
                      published = with("rsm.unbounded").of<RsmGather::Settings>();
  right.radius = published.radius = 0.5f;
  right.reach = published.reach = RsmGather::Reach::radius;
  const double bounded = gathered(map, right, {0, 0, 0.1}, {0, 0, -1}) / (kPi / 4.0);
  EXPECT_GT(bounded, 0.9);
  EXPECT_LT(bounded, 1.0);
  EXPECT_NEAR(gathered(map, published, {0, 0, 0.1}, {0, 0, -1}) / (kPi / 4.0) / (100.0 / kPi), 1.0, 0.02);
}

}  // namespace
}  // namespace lucerna
