// The light propagation volume on GL, held against its double-precision CPU reference implementation and against known
// answers.
//
// Errors are relative to the largest coefficient of the grid that is compared (see relativeError).
// - Storage::full: 1e-5.
// - Storage::half: 1e-3, after any number of steps: wavefronts and the result are rounded to the nearest half, sums are
// kept in 32 bits.
#include "support/gl_fixture.hpp"
#include "support/long_tests.hpp"
#include "support/lpv_on_gl.hpp"
#include "support/temp_folder.hpp"

#include "cascades/cascades.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
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
using Storage = LpvSettings::Storage;

constexpr double kHalfTolerance = 1e-3;
const double kHalfUlp = std::ldexp(1.0, -10);
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

const std::array<glm::vec3, 6> kAxes = {glm::vec3(1, 0, 0),  glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0),
                                        glm::vec3(0, -1, 0), glm::vec3(0, 0, 1),  glm::vec3(0, 0, -1)};

class LpvGlTest : public test::SharedProgramsTest {
 protected:
  static LpvSettings settings(int cells, int cascades, int iterations, bool blocking = false,
                              Storage storage = Storage::full) {
    LpvSettings s;
    s.cascades.cells = cells;
    s.cascades.cascades = cascades;
    s.iterations = iterations;
    s.blocking = blocking;
    s.storage = storage;
    s.handOver = std::max(iterations, 1);  // nothing is handed over: each cascade for itself
    return s;
  }

  /// Runs all stages, join() where asked for.
  static LightPropagationVolume run(const LpvSettings& s, const LpvInputs& inputs, bool join = false) {
    return test::runVolume(library(), capabilities(), s, inputs, join);
  }
};

/// A bad texel of each kind: none of them may leave a trace.
std::vector<RsmTexel> badTexels() {
  const RsmTexel good{{0.3f, 0.4f, 0.5f, 1.0f}, {0, 0, 1, 1}, glm::vec3(1.0f)};
  std::vector<RsmTexel> result;
  RsmTexel background = good;
  background.position.w = 0.0f;
  result.push_back(background);
  RsmTexel noNormal = good;
  noNormal.normal = glm::vec4(0, 0, 0, 1);
  result.push_back(noNormal);
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      RsmTexel position = good, normal = good;
      position.position[axis] = bad;
      normal.normal[axis] = bad;
      result.push_back(position);
      result.push_back(normal);
    }
  }
  for (const float far : {1e30f, -1e30f, 3e9f, -3e9f}) {
    RsmTexel position = good;
    position.position.x = far;
    result.push_back(position);
  }
  return result;
}

/// Random virtual point lights in and around the cascades: axis-aligned and oblique normals, some ten per cell of the
/// coarse grids, those on borders exactly representable, and the bad ones. Where rounding to 32 bits could choose
/// another cell than the reference implementation's 64 (within 1e-3 cells of a border), a light is drawn again.
std::vector<RsmTexel> randomTexels(unsigned seed, std::size_t count, std::span<const Cascade> cascades, double reach) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::normal_distribution<float> gauss;
  const auto nearBorder = [&](const RsmTexel& texel) {
    for (const Cascade& cascade : cascades) {
      const glm::dvec3 surface = (glm::dvec3(texel.position) - cascade.minimum()) / cascade.cellSize;
      for (const glm::dvec3& p : {surface + 0.5 * glm::dvec3(texel.normal), surface + 0.5})
        for (int axis = 0; axis < 3; ++axis)
          if (std::abs(p[axis] - std::round(p[axis])) < 1e-3) return true;
    }
    return false;
  };
  std::vector<RsmTexel> texels = badTexels();
  for (std::size_t i = 0; i < count; ++i) {
    RsmTexel texel;
    do {
      const glm::vec3 p =
          static_cast<float>(reach) * (2.0f * glm::vec3(uniform(random), uniform(random), uniform(random)) - 1.0f);
      glm::vec3 n = kAxes[i % 6];
      if (i % 2) n = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
      texel.position = glm::vec4(p, 1.0f);
      texel.normal = glm::vec4(n, uniform(random));
      texel.flux = glm::vec3(uniform(random), 3.0f * uniform(random), 0.1f * uniform(random));
    } while (nearBorder(texel));
    texels.push_back(texel);
    if (i % 7 == 0)
      for (const float bad : {kNan, kInfinity, -kInfinity}) {  // flux that is not finite, at a place of its own
        RsmTexel badFlux = texel;
        badFlux.flux[static_cast<int>(i) % 3] = bad;
        badFlux.normal.w = 1e30f;  // no area, so that the geometry volume does not see it three times
        texels.push_back(badFlux);
      }
  }
  return texels;
}

/// Lights on corners, edges and faces of cells, and such as are moved there by half a cell: all exact in 32 bits.
std::vector<RsmTexel> borderTexels(std::span<const Cascade> cascades, int cells) {
  std::vector<RsmTexel> texels;
  float flux = 1.0f;
  for (const Cascade& cascade : cascades)
    for (const int i : {-1, 0, 1, cells / 2, cells - 1, cells})
      for (const double half : {0.0, 0.5})
        for (const glm::vec3& normal : kAxes) {
          const glm::dvec3 inCells(i + half, cells / 2, cells / 2 + 0.25);
          for (const glm::dvec3& p :
               {inCells, glm::dvec3(inCells.z, inCells.x, inCells.y), glm::dvec3(inCells.y, inCells.z, inCells.x)}) {
            flux = flux > 4.0f ? 1.0f : flux + 0.125f;  // all different, so that a swap shows
            texels.push_back({glm::vec4(glm::vec3(cascade.minimum() + cascade.cellSize * p), 1.0f),
                              glm::vec4(normal, 0.5f), glm::vec3(flux, 1.0f, 5.0f - flux)});
          }
        }
  return texels;
}

struct Case {
  int cells, cascades;
  double cellSize, ratio;  ///< of the coarsest; powers of two where lights lie on borders: GPUs multiply by 1/x
};
const std::array<Case, 5> kCases{
    {{8, 1, 2.0, 2.0}, {16, 2, 1.0, 2.0}, {8, 3, 2.0, 2.0}, {12, 4, 4.0, 2.0}, {9, 3, 1.37, 1.7}}};

struct CaseInputs {
  std::vector<Cascade> cascades;
  std::vector<RsmTexel> texels;
  double texelArea = 0.07;
  RsmTextures textures;
  LpvInputs inputs;

  explicit CaseInputs(const Case& c, unsigned seed)
      : cascades(place(c)),
        texels(makeTexels(c, seed, cascades)),
        textures(texels, texelArea),
        inputs{{textures.outputs()}, cascades, 3.5f} {}

  static std::vector<Cascade> place(const Case& c) {
    CascadeSettings s;
    s.cells = c.cells;
    s.cascades = c.cascades;
    s.cellSize = c.cellSize;
    s.ratio = c.ratio;
    const double half = 0.5 * c.cells * c.cellSize;
    Bounds bounds;
    bounds.add(glm::dvec3(-half - 1.0));
    bounds.add(glm::dvec3(half + 1.0));
    return placeCascades(s, bounds, glm::dvec3(0.6, -1.3, 0.2), glm::normalize(glm::dvec3(-0.5, 0.3, 0.8)));
  }
  static std::vector<RsmTexel> makeTexels(const Case& c, unsigned seed, std::span<const Cascade> placed) {
    std::vector<RsmTexel> result = randomTexels(seed, 2500, placed, 0.65 * c.cells * c.cellSize);
    if (c.ratio == 2.0) {
      const std::vector<RsmTexel> border = borderTexels(placed, c.cells);
      result.insert(result.end(), border.begin(), border.end());
    }
    return result;
  }
};

/// What the reference implementation makes of the same inputs.
struct ReferenceRun {
  std::vector<VolumeRgb> injected, result;
  std::vector<reference::Volume> geometry;
};
ReferenceRun runReference(const CaseInputs& c, int cells, int iterations, bool blocking) {
  const std::vector<reference::Vpl> vpls = test::vplsOf(c.texels, c.texelArea);
  ReferenceRun run;
  for (const Cascade& cascade : c.cascades) {
    const reference::GridSpec grid = test::gridOf(cascade, cells);
    reference::inject(run.injected.emplace_back(reference::makeVolumeRgb(grid)), vpls);
    reference::injectSurfels(run.geometry.emplace_back(reference::geometryGrid(grid)), grid, vpls);
    run.result.push_back(
        reference::propagate(run.injected.back(), iterations, {}, blocking ? &run.geometry.back() : nullptr)
            .accumulated);
  }
  return run;
}

// ---- against the reference implementation
// ------------------------------------------------------------------------------------------------

class LpvAgainstReference : public LpvGlTest {};

TEST_F(LpvAgainstReference, InjectsLikeTheReference) {
  double worst = 0.0;
  for (const Case& c : kCases) {
    const CaseInputs inputs(c, 1);
    const ReferenceRun expected = runReference(inputs, c.cells, 0, false);
    for (const Storage storage : {Storage::full, Storage::half}) {  // injected light is kept in 32 bits in both
      const LightPropagationVolume lpv = run(settings(c.cells, c.cascades, 1, false, storage), inputs.inputs);
      const std::vector<VolumeRgb> actual = test::readVolume(lpv.injected(), inputs.inputs);
      for (std::size_t k = 0; k < actual.size(); ++k) {
        const double error = test::relativeError(expected.injected[k], actual[k]);
        EXPECT_LT(error, kFullTolerance) << c.cells << "^3, cascade " << k << " of " << c.cascades;
        worst = std::max(worst, error);
        EXPECT_GT(reference::totalFlux(expected.injected[k]).x, 1.0);  // the test has something to compare
      }
    }
  }
  report("injection, largest error", worst);
}

TEST_F(LpvAgainstReference, GeometryVolume) {
  double worst = 0.0;
  for (const Case& c : kCases) {
    const CaseInputs inputs(c, 2);
    const ReferenceRun expected = runReference(inputs, c.cells, 0, false);
    const LightPropagationVolume lpv = run(settings(c.cells, c.cascades, 2, true), inputs.inputs);
    ASSERT_NE(lpv.geometryVolume(), nullptr);
    const std::vector<reference::Volume> actual = test::readGeometryVolume(lpv, inputs.inputs);
    for (std::size_t k = 0; k < actual.size(); ++k) {
      const double error = test::relativeError(expected.geometry[k], actual[k]);
      EXPECT_LT(error, kFullTolerance) << c.cells << "^3, cascade " << k << " of " << c.cascades;
      worst = std::max(worst, error);
    }
  }
  report("geometry volume, largest error", worst);
}

TEST_F(LpvAgainstReference, PropagationAndLookup) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  std::array<double, 9> worst{};
  double worstLookup = 0.0;
  for (const Case& c : kCases) {
    const CaseInputs inputs(c, 4);
    for (const bool blocking : {false, true})
      for (const int iterations : {1, 2, 8}) {
        const ReferenceRun expected = runReference(inputs, c.cells, iterations, blocking);
        LpvSettings s = settings(c.cells, c.cascades, iterations, blocking);
        const LightPropagationVolume lpv = run(s, inputs.inputs);
        const std::vector<VolumeRgb> actual = test::readVolume(lpv.result(), inputs.inputs);
        for (std::size_t k = 0; k < actual.size(); ++k) {
          const double error = test::relativeError(expected.result[k], actual[k]);
          EXPECT_LT(error, kFullTolerance) << c.cells << "^3, cascade " << k << " of " << c.cascades << ", "
                                           << iterations << " steps, blocking " << blocking;
          worst[static_cast<std::size_t>(iterations)] = std::max(worst[static_cast<std::size_t>(iterations)], error);
        }
        if (c.cascades > 1) continue;
        // The lookup in one cascade, in it, across its border and outside; never below zero.
        std::vector<Probe> probes;
        const double reach = 0.6 * c.cells * c.cellSize;
        for (int i = 0; i < 500; ++i)
          probes.push_back({static_cast<float>(reach) * glm::vec3(uniform(random), uniform(random), uniform(random)) +
                                glm::vec3(inputs.cascades[0].minimum() + 0.5 * c.cells * c.cellSize),
                            glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random)))});
        for (const LpvLookup lookup : {LpvLookup::flux, LpvLookup::published}) {
          s.lookup = lookup;
          const bool flux = lookup == LpvLookup::flux;
          const reference::LookupOptions options{flux ? reference::Lookup::flux : reference::Lookup::windowed,
                                                 flux ? 0.0 : 0.5};
          const std::vector<glm::vec3> seen = test::probeIrradiance(library(), run(s, inputs.inputs), probes);
          glm::dvec3 largest(0.0);
          std::vector<glm::dvec3> all;
          for (const Probe& probe : probes) {
            all.push_back(reference::irradiance(expected.result[0], glm::dvec3(probe.position),
                                                glm::dvec3(probe.normal), options));
            largest = glm::max(largest, all.back());
          }
          for (std::size_t i = 0; i < probes.size(); ++i)
            for (int channel = 0; channel < 3; ++channel) {
              const double error = std::abs(all[i][channel] - static_cast<double>(seen[i][channel])) / largest[channel];
              const double off =
                  test::offByFilters(glm::dvec3(probes[i].position), std::array{c.cellSize}, [&](const glm::dvec3& p) {
                    return reference::irradiance(expected.result[0], p, glm::dvec3(probes[i].normal), options)[channel];
                  });
              EXPECT_LT(error, kFullTolerance + off / largest[channel]) << "probe " << i << ", " << nameOf(lookup);
              EXPECT_GE(seen[i][channel], 0.0f);
              worstLookup = std::max(worstLookup, error);
            }
        }
      }
  }
  report("1 step", worst[1]);
  report("2 steps", worst[2]);
  report("8 steps", worst[8]);
  report("lookup", worstLookup);
}

TEST_F(LpvAgainstReference, HalfStorage) {
  for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered})
    for (const int iterations : {1, 2, 8, 16}) {
      double worst = 0.0;
      for (const Case& c : kCases) {
        const CaseInputs inputs(c, 4);
        for (const bool blocking : {false, true}) {
          const ReferenceRun expected = runReference(inputs, c.cells, iterations, blocking);
          LpvSettings s = settings(c.cells, c.cascades, iterations, blocking, Storage::half);
          s.propagate = propagate;
          const std::vector<VolumeRgb> actual = test::readVolume(run(s, inputs.inputs).result(), inputs.inputs);
          for (std::size_t k = 0; k < actual.size(); ++k)
            for (std::size_t channel = 0; channel < 3; ++channel) {
              const double error = test::relativeError(expected.result[k][channel], actual[k][channel]);
              EXPECT_LT(error, kHalfTolerance);  // what is promised
              // And what one rounding to the nearest leaves, half a unit in the last place; a store that cuts off would
              // leave a whole one.
              EXPECT_LT(error, 0.5 * kHalfUlp + kFullTolerance)
                  << c.cells << "^3, cascade " << k << " of " << c.cascades << ", " << iterations << " steps, blocking "
                  << blocking << ", " << nameOf(propagate);
              worst = std::max(worst, error);
            }
        }
      }
      report(fmt::format("{}, {} steps in 16-bit storage, largest error", nameOf(propagate), iterations).c_str(),
             worst);
    }
}

TEST_F(LpvAgainstReference, JoinAndBlendedLookup) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  constexpr int kIterations = 5, kHandOver = 2;
  for (const Storage storage : {Storage::full, Storage::half}) {
    double worst = 0.0, worstLookup = 0.0;
    for (const Case& c : kCases) {
      const CaseInputs inputs(c, 6);
      LpvSettings s = settings(c.cells, c.cascades, kIterations, true, storage);
      s.handOver = kHandOver;
      s.blendBand = 0.4f;
      s.lookupOffset = 0.25f;
      const double tolerance = storage == Storage::full ? kFullTolerance : kHalfTolerance;
      const LightPropagationVolume lpv = run(s, inputs.inputs, true);
      const std::vector<VolumeRgb> actual = test::readVolume(lpv.result(), inputs.inputs);
      const ReferenceRun separate = runReference(inputs, c.cells, 0, false);
      std::vector<reference::CascadeParts> parts;
      for (std::size_t k = 0; k < separate.injected.size(); ++k)
        parts.push_back(
            reference::propagateParts(separate.injected[k], kIterations, kHandOver, {}, &separate.geometry[k]));
      const std::vector<VolumeRgb> expected =
          reference::joinCascades(parts, {4.0, 1e-4 * static_cast<double>(inputs.inputs.referenceIrradiance)});
      for (std::size_t k = 0; k < actual.size(); ++k) {
        const double error = test::relativeError(expected[k], actual[k]);
        EXPECT_LT(error, tolerance) << c.cells << "^3, cascade " << k << " of " << c.cascades << ", half "
                                    << (storage == Storage::half);
        worst = std::max(worst, error);
      }
      reference::CascadeBlend blend{{}, static_cast<double>(s.blendBand)};
      std::vector<double> cellSizes;
      for (const Cascade& cascade : inputs.cascades) {
        blend.centres.push_back(cascade.centre);
        cellSizes.push_back(cascade.cellSize);
      }
      std::vector<Probe> probes;
      for (int i = 0; i < 1500; ++i) {
        const Cascade& around = inputs.cascades[static_cast<std::size_t>(i) % inputs.cascades.size()];
        const auto reach = static_cast<float>(0.55 * c.cells * around.cellSize);
        probes.push_back(
            {glm::vec3(around.centre) + reach * glm::vec3(uniform(random), uniform(random), uniform(random)),
             glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random)))});
      }
      for (const LpvLookup lookup : {LpvLookup::flux, LpvLookup::published}) {
        s.lookup = lookup;
        const reference::LookupOptions options{
            lookup == LpvLookup::flux ? reference::Lookup::flux : reference::Lookup::windowed,
            static_cast<double>(*s.lookupOffset)};
        const std::vector<glm::vec3> seen = test::probeIrradiance(library(), run(s, inputs.inputs, true), probes);
        for (std::size_t channel = 0; channel < 3; ++channel) {
          std::vector<reference::Volume> cascades;
          for (const VolumeRgb& cascade : expected) cascades.push_back(cascade[channel]);
          std::vector<double> all;
          for (const Probe& probe : probes)
            all.push_back(reference::blendedIrradiance(cascades, blend, glm::dvec3(probe.position),
                                                       glm::dvec3(probe.normal), options));
          const double largest = *std::max_element(all.begin(), all.end());
          for (std::size_t i = 0; i < probes.size(); ++i) {
            const double error = std::abs(all[i] - static_cast<double>(seen[i][static_cast<int>(channel)])) / largest;
            const double off = test::offByFilters(glm::dvec3(probes[i].position), cellSizes, [&](const glm::dvec3& p) {
              return reference::blendedIrradiance(cascades, blend, p, glm::dvec3(probes[i].normal), options);
            });
            EXPECT_LT(error, tolerance + off / largest)
                << c.cells << "^3, " << c.cascades << " cascades, probe " << i << ", " << nameOf(lookup);
            worstLookup = std::max(worstLookup, error);
          }
        }
      }
    }
    report(storage == Storage::half ? "half, join" : "full, join", worst);
    report(storage == Storage::half ? "half, blended lookup" : "full, blended lookup", worstLookup);
  }
}

TEST_F(LpvAgainstReference, HandOverStepFollowsTheSpreadOfLight) {
  // Root mean square distances after 1, 2, 4, 8, 16, 24 steps (tests/physics, LpvTransport.MeanDisplacementAndRms): the
  // step whose distance times the ratio is nearest.
  EXPECT_EQ(lpvHandOverStep(8, 2.0), 2);  // 3.222 / 2 = 1.611 beside 1.496
  EXPECT_EQ(lpvHandOverStep(16, 2.0), 4);  // 4.619 / 2 = 2.310 beside 2.216
  EXPECT_EQ(lpvHandOverStep(8, 1.0), 8);
  EXPECT_EQ(lpvHandOverStep(1, 2.0), 1);
  EXPECT_EQ(lpvHandOverStep(0, 2.0), 1);
  EXPECT_EQ(lpvHandOverStep(8, 16.0), 1);
}

// ---- known answers
// ------------------------------------------------------------------------------------------------------

class LpvKnownAnswers : public LpvGlTest {
 protected:
  /// Hand-made lights in one cascade of unit cells, E_ref = 1.
  struct Field {
    std::vector<RsmTexel> texels;
    RsmTextures textures;
    LpvInputs inputs;
    Field(std::vector<RsmTexel> lights, int cells, double texelArea = 1.0)
        : texels(std::move(lights)),
          textures(texels, texelArea),
          inputs{{textures.outputs()}, unitCascade(cells), 1.0f} {}
  };
  static std::vector<RsmTexel> one(int cells, const glm::vec3& normal, const glm::vec3& flux) {
    return {lightIn(glm::ivec3(cells / 2), normal, flux)};
  }
  /// A light that injection moves to the middle of a cell. Its area is as good as none.
  static RsmTexel lightIn(const glm::ivec3& cell, const glm::vec3& normal, const glm::vec3& flux) {
    const glm::vec3 n = glm::normalize(normal);
    return {glm::vec4(glm::vec3(cell) + 0.5f - 0.5f * n, 1.0f), glm::vec4(n, 1e30f), flux};
  }
  /// Two opposite lobes in every cell: isotropic, flux 2 a cell.
  static std::vector<RsmTexel> isotropic(int cells) {
    std::vector<RsmTexel> texels;
    for (int z = 0; z < cells; ++z)
      for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x)
          for (const float way : {1.0f, -1.0f}) texels.push_back(lightIn({x, y, z}, {0, 0, way}, glm::vec3(1.0f)));
    return texels;
  }
  static VolumeRgb resultOf(const Field& field, int cells, int iterations, bool blocking = false,
                            Storage storage = Storage::full) {
    const LightPropagationVolume lpv = run(settings(cells, 1, iterations, blocking, storage), field.inputs);
    return test::readVolume(lpv.result(), field.inputs)[0];
  }
};

TEST_F(LpvKnownAnswers, GainsOfAHomogeneousField) {
  // Isotropic light of flux 2 a cell and lobes of flux 1/2 along some axis: every direction stays above the clamp, so
  // the two bands go their own ways; the middle of 3^3 equal cells sees no border.
  std::vector<RsmTexel> texels = isotropic(3);
  const glm::vec3 axis = glm::normalize(glm::vec3(0.3f, -0.5f, 0.8f));
  for (int i = 0; i < 27; ++i) texels.push_back(lightIn({i % 3, i / 3 % 3, i / 9}, axis, {0.5f, 0.25f, 0.0f}));
  const Field field(texels, 3);
  const VolumeRgb before = resultOf(field, 3, 0), after = resultOf(field, 3, 1);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const reference::Sh injected = before[channel].at(glm::ivec3(1)),
                        step = after[channel].at(glm::ivec3(1)) - injected;
    EXPECT_NEAR(step.c0 / injected.c0, 1.0, 1e-6);
    if (channel == 2) EXPECT_LT(glm::length(step.c1), 1e-6);
    else
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(step.c1[i] / injected.c1[i], 0.36864318, 2e-6) << i;  // a difference of two sums near 1
  }
}

TEST_F(LpvKnownAnswers, FirstStepClamped) {
  const auto gain = [](const glm::vec3& axis) {
    const Field field(one(3, axis, glm::vec3(1.0f)), 3);
    return reference::totalFlux(resultOf(field, 3, 1)[1]) - reference::totalFlux(resultOf(field, 3, 0)[1]);
  };
  for (const glm::vec3& axis : kAxes) EXPECT_NEAR(gain(axis), 1.138208, 1e-6);
  EXPECT_NEAR(gain({1, 1, 0}), 1.122594, 1e-6);
  EXPECT_NEAR(gain({0, -1, 1}), 1.122594, 1e-6);
  EXPECT_NEAR(gain({1, 1, 1}), 1.125830, 1e-6);
  EXPECT_NEAR(gain({-1, 1, -1}), 1.125830, 1e-6);
}

TEST_F(LpvKnownAnswers, InjectedFluxIsBand0TimesTheRootOf4Pi) {
  const Field field(one(5, {2, -1, 3}, {3.0f, 0.5f, 7.0f}), 5);
  const glm::dvec3 total = reference::totalFlux(resultOf(field, 5, 0));
  EXPECT_NEAR(total.x, 3.0, 3e-6);
  EXPECT_NEAR(total.y, 0.5, 5e-7);
  EXPECT_NEAR(total.z, 7.0, 7e-6);
}

TEST_F(LpvKnownAnswers, LightFromAheadIsSeenAndFromBehindIsNot) {
  // One light of flux 1 in a cell of size 1, looked up in the cell's middle: E = 4/pi <c, lobe(-n)>, c = lobe(axis)/pi,
  // which is 4/pi^2 (pi/4 + w pi/3 cos) with the window w of the receiver's lobe: 2/pi ahead and nothing behind for w =
  // 3/4. For w = 1, as published, it is 7/(3 pi) ahead, and behind it would be negative, which is no light.
  const glm::vec3 axis = glm::normalize(glm::vec3(2, -1, 2)), across = glm::normalize(glm::vec3(1, 2, 0));
  const Field field(one(5, axis, glm::vec3(1.0f)), 5);
  const std::vector<Probe> probes{{glm::vec3(2.5f), -axis}, {glm::vec3(2.5f), axis}, {glm::vec3(2.5f), across}};
  for (const bool unwindowed : {false, true}) {
    LpvSettings s = settings(5, 1, 0);
    s.lookup = LpvLookup::published;
    s.lookupOffset = 0.0f;
    s.deviations.unwindowed = unwindowed;
    const LightPropagationVolume lpv = run(s, field.inputs);
    const std::vector<glm::vec3> seen = test::probeIrradiance(library(), lpv, probes);
    EXPECT_NEAR(seen[0].x, unwindowed ? 7.0 / (3.0 * kPi) : 2.0 / kPi, 1e-5);
    EXPECT_NEAR(seen[1].x, 0.0, 1e-6);
    EXPECT_GE(seen[1].x, 0.0f);
    EXPECT_NEAR(seen[2].x, 1.0 / kPi, 1e-5);
  }
}

TEST_F(LpvKnownAnswers, AnIsotropicFillGivesTwoThirdsOfPiTimesItsIntensity) {
  // Two opposite lobes of flux 1 in each cell of size 1 are isotropic, I = 2 / (4 pi). The kernel sends 2 pi / 3 I
  // through a face, whatever way it looks; the published lookup reports 4 I, 6 / pi times as much.
  const Field field(isotropic(5), 5);
  std::vector<Probe> probes;
  for (const glm::vec3& axis : kAxes) probes.push_back({{2.4f, 2.6f, 2.3f}, axis});
  probes.push_back({glm::vec3(2.5f), glm::normalize(glm::vec3(1, -2, 3))});
  constexpr double kIntensity = 2.0 / (4.0 * kPi);
  LpvSettings s = settings(5, 1, 0);
  for (const glm::vec3& seen : test::probeIrradiance(library(), run(s, field.inputs), probes))
    EXPECT_NEAR(seen.x, 2.0 * kPi / 3.0 * kIntensity, 2e-6);
  s.lookup = LpvLookup::published;
  for (const glm::vec3& seen : test::probeIrradiance(library(), run(s, field.inputs), probes))
    EXPECT_NEAR(seen.x, 4.0 * kIntensity, 2e-6);
}

TEST_F(LpvKnownAnswers, AlongAnAxisTheLookupIsWhatTheKernelSendsThroughThatFace) {
  // Isotropic light and two oblique lobes a cell: no direction is negative, so that what is propagated through a face
  // is linear. A volume of two cells of size 1, the light in one: its front in the other, by the reference
  // implementation, is what crossed their face (all lobes of the gather have the flux that they were given).
  std::mt19937 random(11);
  std::normal_distribution<float> gauss;
  for (int trial = 0; trial < 6; ++trial) {
    std::vector<RsmTexel> texels{lightIn(glm::ivec3(2), {0, 0, 1}, glm::vec3(1.0f)),
                                 lightIn(glm::ivec3(2), {0, 0, -1}, glm::vec3(1.0f))};
    for (const float flux : {0.4f, 0.25f})
      texels.push_back(lightIn(glm::ivec3(2), {gauss(random), gauss(random), gauss(random)}, glm::vec3(flux)));
    const Field field(texels, 5);
    const reference::Volume injected = resultOf(field, 5, 0)[0];
    const reference::Sh light = injected.at(glm::ivec3(2));
    ASSERT_GT(reference::kY00 * light.c0, reference::kY1 * glm::length(light.c1));  // no negative intensity
    const reference::Volume front = reference::propagateStep(injected);
    std::vector<Probe> probes;
    for (const glm::vec3& axis : kAxes) probes.push_back({glm::vec3(2.5f), -axis});
    const std::vector<glm::vec3> seen = test::probeIrradiance(library(), run(settings(5, 1, 0), field.inputs), probes);
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      const double sent = reference::flux(front.at(glm::ivec3(2) + glm::ivec3(kAxes[i])));
      EXPECT_NEAR(seen[i].x / sent, 1.0, 1e-5) << trial << ", axis " << i;
    }
  }
}

TEST_F(LpvKnownAnswers, BorderDecay) {
  // Red: a cosine lobe. Green: two opposite lobes of half the flux each, isotropic. The front of step N is what the sum
  // gains.
  std::vector<RsmTexel> texels = one(32, {0, 0, 1}, {1.0f, 0.5f, 0.0f});
  texels.push_back(lightIn(glm::ivec3(16), {0, 0, -1}, {0.0f, 0.5f, 0.0f}));
  const Field field(texels, 32);
  const auto front = [&](int step) {
    return reference::totalFlux(resultOf(field, 32, step)) - reference::totalFlux(resultOf(field, 32, step - 1));
  };
  struct Row {
    int steps;
    double lobe, isotropic;
  };
  for (const Row& row : {Row{16, 1.138208, 1.0}, Row{32, 1.138115, 0.999928}, Row{64, 1.123262, 0.987377}}) {
    const glm::dvec3 flux = front(row.steps);
    // Each of the two sums is at most 1.14 N and rounded to 24 bits; the printed figure to six decimals.
    const double tolerance = 2.0 * 1.14 * row.steps * std::ldexp(1.0, -24) + 5e-7;
    EXPECT_NEAR(flux.x, row.lobe, tolerance) << row.steps;
    EXPECT_NEAR(flux.y, row.isotropic, tolerance) << row.steps;
    EXPECT_EQ(flux.z, 0.0);
  }
}

TEST_F(LpvKnownAnswers, TinyGridsLoseLightAtTheirBorders) {
  const std::array<std::vector<double>, 3> rows = {std::vector<double>{0.0},
                                                   {0.333333, 0.110472, 0.042324},
                                                   {1.138208, 0.880462, 0.566864, 0.355257, 0.233236, 0.147829}};
  for (int cells = 1; cells <= 3; ++cells) {
    const Field field(one(cells, {0, 0, 1}, glm::vec3(1.0f)), cells);
    double before = reference::totalFlux(resultOf(field, cells, 0)[0]);
    EXPECT_NEAR(before, 1.0, 1e-6);
    int steps = 0;
    for (const double row : rows[static_cast<std::size_t>(cells - 1)]) {
      const double now = reference::totalFlux(resultOf(field, cells, ++steps)[0]);
      EXPECT_NEAR(now - before, row, 2e-6) << cells << "^3, step " << steps;
      before = now;
    }
  }
  const Field field(one(1, {0, 0, 1}, glm::vec3(1.0f)), 1);
  EXPECT_EQ(resultOf(field, 1, 0)[0].cells, resultOf(field, 1, 1)[0].cells);  // all of it leaves
}

TEST_F(LpvKnownAnswers, NoLightIsExactlyZero) {
  const Field none({}, 4), background({RsmTexel{}, RsmTexel{}}, 4), black(one(4, {0, 0, 1}, glm::vec3(0.0f)), 4);
  for (const Field* field : {&none, &background, &black})
    for (const int iterations : {0, 1, 8})
      for (const Storage storage : {Storage::full, Storage::half}) {
        const VolumeRgb result = resultOf(*field, 4, iterations, true, storage);
        for (const reference::Volume& channel : result)
          for (const reference::Sh& cell : channel.cells) EXPECT_EQ(cell, reference::Sh{});
      }
}

TEST_F(LpvKnownAnswers, WhatWasInTheVolumeBeforeDoesNotMatter) {
  // A frame must not see the last one: the same volume, once with light, then without, then with it again.
  const Field lit(one(5, {1, 2, 3}, glm::vec3(1.0f)), 5), dark({}, 5);
  LightPropagationVolume lpv(library(), capabilities(), settings(5, 1, 3, true));
  std::vector<VolumeRgb> results;
  for (const Field* field : {&lit, &dark, &lit}) {
    lpv.place(field->inputs);
    lpv.inject(field->inputs);
    lpv.fillGeometryVolume(field->inputs);
    lpv.propagate();
    results.push_back(test::readVolume(lpv.result(), field->inputs)[0]);
  }
  EXPECT_EQ(reference::totalFlux(results[1]), glm::dvec3(0.0));
  for (std::size_t channel = 0; channel < 3; ++channel) EXPECT_EQ(results[0][channel].cells, results[2][channel].cells);
}

TEST_F(LpvKnownAnswers, AWallBlocksThreeQuartersHeadOnAQuarterAcrossAndNothingFromItsBack) {
  // A wall in the plane x = 4 of 8^3 cells facing down the x axis: a black surfel of one cell's area on each corner.
  // Isotropic light, which the first, unblocked step leaves as it is away from the border; in the second, light that
  // travels along w through a face with the wall at all (`share` = 1) or half of its corners passes 1 - B, B = share *
  // (1/4 + w.x/2) in [0, 1]. With surfels of twice the area the half-covered faces show the whole wall: B = 1/4 for
  // light that travels along it.
  for (const float area : {1.0f, 2.0f}) {
    std::vector<RsmTexel> texels = isotropic(8);
    for (int z = 0; z <= 8; ++z)
      for (int y = 0; y <= 8; ++y)
        texels.push_back({{4.0f, y, z, 1.0f}, {-1.0f, 0.0f, 0.0f, 1.0f / area}, glm::vec3(0.0f)});
    const Field field(texels, 8);
    const reference::Volume blocked = resultOf(field, 8, 2, true)[0], first = resultOf(field, 8, 1)[0],
                            injected = resultOf(field, 8, 0)[0];
    const double front = reference::frontSolidAngle(), side = reference::sideSolidAngle();
    const auto passes = [&](double share, double wx) {
      return 1.0 - std::clamp(share * area * (0.25 + 0.5 * wx), 0.0, 1.0);
    };
    const double a = 2.0 / std::sqrt(5.0),
                 b = 1.0 / std::sqrt(5.0);  // a side face's direction: along travel, across it
    struct Side {
      int x;  // of the cell that is looked at
      double up, down;  // transmittance of light that comes along +x and -x: towards the far face
      double upSides, downSides;
    };
    // Right of the wall light along +x crosses it; left of it light along -x does, which meets its back.
    for (const Side& cell :
         {Side{4, passes(1.0, 1.0), 1.0, passes(1.0, a), 1.0}, Side{3, 1.0, passes(1.0, -1.0), 1.0, passes(1.0, -a)}}) {
      const glm::ivec3 at(cell.x, 4, 4);
      const double intensity = reference::kY00 * injected.at(at).c0;
      ASSERT_NEAR((first.at(at) - injected.at(at)).c0, injected.at(at).c0, 1e-6);
      // Four neighbours across, each through a face with the wall at half of its corners.
      const double towardsUp = front * cell.up + 4.0 * side * passes(0.5, b);
      const double towardsDown = front * cell.down + 4.0 * side * passes(0.5, -b);
      // To each of the faces across: its own neighbour's front, two side faces of neighbours across, one each of those
      // along x.
      const double across =
          front * passes(0.5, 0.0) + 2.0 * side * passes(0.5, 0.0) + side * (cell.upSides + cell.downSides);
      const reference::Sh step = blocked.at(at) - first.at(at);
      EXPECT_NEAR(step.c0, reference::kLobeBand0 / kPi * intensity * (towardsUp + towardsDown + 4.0 * across), 2e-6)
          << cell.x;
      EXPECT_NEAR(step.c1.x, reference::kLobeBand1 / kPi * intensity * (towardsUp - towardsDown), 2e-6) << cell.x;
      EXPECT_NEAR(step.c1.y, 0.0, 1e-6);
      EXPECT_NEAR(step.c1.z, 0.0, 1e-6);
    }
    // And what the geometry volume holds.
    const LightPropagationVolume lpv = run(settings(8, 1, 2, true), field.inputs);
    const reference::Sh potential = test::readGeometryVolume(lpv, field.inputs)[0].at({4, 3, 5});
    EXPECT_NEAR(reference::evaluate(potential, {-1, 0, 0}), 0.75 * area, 1e-6);
    EXPECT_NEAR(reference::evaluate(potential, {0, 1, 0}), 0.25 * area, 1e-6);
    EXPECT_NEAR(reference::evaluate(potential, {1, 0, 0}), -0.25 * area, 1e-6);
  }
}

TEST_F(LpvKnownAnswers, FortyEightSymmetriesOfTheCube) {
  constexpr int kCells = 8;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::normal_distribution<float> gauss;
  std::vector<RsmTexel> texels;
  for (int i = 0; i < 300; ++i) {
    RsmTexel texel;
    // Off the borders, so that a mirrored light falls into the mirrored cell.
    const glm::vec3 p = glm::vec3(glm::ivec3(i % 8, i / 8 % 8, i * 7 % 8)) + 0.6f +
                        0.3f * glm::vec3(uniform(random), uniform(random), uniform(random));
    texel.normal = glm::vec4(kAxes[static_cast<std::size_t>(i) % 6], 1.0f);
    if (i % 2) texel.normal = glm::vec4(glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random))), 0.5f);
    texel.position = glm::vec4(p + 0.1f * glm::vec3(texel.normal), 1.0f);
    texel.flux = {uniform(random), uniform(random), 1.0f};
    texels.push_back(texel);
  }
  const auto transformed = [&](const reference::Volume& volume, const glm::dmat3& matrix) {
    reference::Volume result(volume.grid);
    const glm::dvec3 middle(0.5 * (kCells - 1));
    for (int i = 0; i < kCells * kCells * kCells; ++i) {
      const glm::ivec3 cell(i % kCells, i / kCells % kCells, i / (kCells * kCells));
      const reference::Sh& sh = volume.at(cell);
      result.at(glm::ivec3(glm::round(matrix * (glm::dvec3(cell) - middle) + middle))) = {sh.c0, matrix * sh.c1};
    }
    return result;
  };
  const Field field(texels, kCells, 0.3);
  const VolumeRgb reference = resultOf(field, kCells, 6, true), open = resultOf(field, kCells, 6, false);
  EXPECT_GT(test::relativeError(reference, open), 1e-2);  // the geometry volume is at work
  std::array<int, 3> order = {0, 1, 2};
  int symmetries = 0;
  double worst = 0.0;
  do {
    for (int signs = 0; signs < 8; ++signs, ++symmetries) {
      glm::dmat3 matrix(0.0);
      for (int axis = 0; axis < 3; ++axis)
        matrix[axis][order[static_cast<std::size_t>(axis)]] = ((signs >> axis) & 1) == 1 ? -1.0 : 1.0;
      std::vector<RsmTexel> turned = texels;
      for (RsmTexel& texel : turned) {
        texel.position =
            glm::vec4(glm::vec3(matrix * (glm::dvec3(texel.position) - 0.5 * kCells) + 0.5 * kCells), 1.0f);
        texel.normal = glm::vec4(glm::vec3(matrix * glm::dvec3(texel.normal)), texel.normal.w);
      }
      const VolumeRgb actual = resultOf(Field(turned, kCells, 0.3), kCells, 6, true);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double error = test::relativeError(transformed(reference[channel], matrix), actual[channel]);
        EXPECT_LT(error, 1e-6) << "symmetry " << symmetries;
        worst = std::max(worst, error);
      }
    }
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(symmetries, 48);
  report("largest asymmetry", worst);
}

TEST_F(LpvKnownAnswers, StoredValuesDoNotDependOnTheLightsUnit) {
  // The same scene lit with 1e-3, 1 and 1e5 (lux of the sun): stored as c / (E_ref s^2) the grids are the same, finite,
  // and where light is injected far above 6.1e-5, the smallest normal 16-bit float.
  std::vector<std::vector<glm::vec4>> stored;
  for (const float irradiance : {1e-3f, 1.0f, 1e5f}) {
    const float texelArea = 0.01f;
    std::vector<RsmTexel> texels;
    for (int i = 0; i < 100; ++i)
      texels.push_back({{0.05f + 0.1f * static_cast<float>(i % 10) + 3.0f,
                         0.05f + 0.1f * static_cast<float>(i / 10) + 3.0f, 3.0f, 1.0f},
                        {0, 0, 1, 1},
                        glm::vec3(0.5f * irradiance * texelArea)});
    const RsmTextures textures(texels, texelArea);
    const LpvInputs inputs{{textures.outputs()}, unitCascade(7), irradiance};
    const LightPropagationVolume lpv = run(settings(7, 1, 8, true, Storage::half), inputs);
    stored.push_back(lpv.result()[0].readRgba());
  }
  const std::size_t lit = (3 * 7 + 3) * 7 + 3;
  EXPECT_GT(stored[1][lit].x, 0.1f);
  for (std::size_t i = 0; i < stored[1].size(); ++i)
    for (int c = 0; c < 4; ++c) {
      ASSERT_TRUE(std::isfinite(stored[1][i][c]));
      // A rounding of the flux in 32 bits may move a 16-bit value to its neighbour.
      EXPECT_NEAR(stored[0][i][c], stored[1][i][c], 4.0 * kHalfUlp * std::abs(stored[1][i][c]) + 6e-8) << i;
      EXPECT_NEAR(stored[2][i][c], stored[1][i][c], 4.0 * kHalfUlp * std::abs(stored[1][i][c]) + 6e-8) << i;
    }
}

TEST_F(LpvKnownAnswers, AnyNumberOfStepsIsFiniteAndTheSumNeverFalls) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::normal_distribution<float> gauss;
  std::vector<RsmTexel> texels;
  for (int i = 0; i < 60; ++i)
    texels.push_back({{4.0f * uniform(random), 4.0f * uniform(random), 4.0f * uniform(random), 1.0f},
                      glm::vec4(glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random))), 0.5f),
                      glm::vec3(uniform(random), uniform(random), 1.0f)});
  const Field field(texels, 4, 0.2);
  for (const Storage storage : {Storage::full, Storage::half})
    for (const bool blocking : {false, true}) {
      VolumeRgb previous = resultOf(field, 4, 0, blocking, storage);
      for (const int iterations : {1, 2, 3, 5, 8, 256, test::longTests() ? 10000 : 1000}) {
        const VolumeRgb now = resultOf(field, 4, iterations, blocking, storage);
        for (std::size_t channel = 0; channel < 3; ++channel)
          for (std::size_t i = 0; i < now[channel].cells.size(); ++i) {
            const reference::Sh &cell = now[channel].cells[i], &before = previous[channel].cells[i];
            ASSERT_TRUE(std::isfinite(cell.c0) && std::isfinite(cell.c1.x + cell.c1.y + cell.c1.z)) << iterations;
            // Injected light is kept in 32 bits, so its first sum in 16 may be rounded down by half a unit in the last
            // place.
            const double allowed = storage == Storage::half && iterations == 1 ? 0.5 * kHalfUlp * before.c0 : 0.0;
            ASSERT_GE(cell.c0, before.c0 - allowed) << iterations;
          }
        previous = now;
      }
      EXPECT_LT(reference::totalFlux(previous).z, 10.0 * 60.0);
    }
}

TEST_F(LpvKnownAnswers, TheMeanOfASmoothFieldDoesNotDependOnTheNumberOfCascades) {
  // Isotropic light that is emitted all through the scene, f(p) = exp(-|p|^2/200) per unit volume. Each cascade by
  // itself gathers it from so many of its own cells around, so a grid of half the cell size holds half the light:
  // blended as they are, four cascades would show an eighth of what one does, summed nearly twice as much. Joined they
  // show the same. Lights stand in the middle of the cells of the finest cascade that holds the place, so that no grid
  // sees a gap.
  constexpr int kCells = 12;
  LpvSettings s = settings(kCells, 4, 8);
  s.cascades.cellSize = 2.0;
  Bounds bounds;
  bounds.add(glm::dvec3(-12.0));
  bounds.add(glm::dvec3(12.0));
  const std::vector<Cascade> all = placeCascades(s.cascades, bounds, glm::dvec3(0.0), glm::dvec3(0.0));
  std::vector<RsmTexel> texels;
  for (std::size_t k = 0; k < all.size(); ++k)
    for (int i = 0; i < kCells * kCells * kCells; ++i) {
      const reference::GridSpec grid = test::gridOf(all[k], kCells);
      const glm::dvec3 p = grid.centre({i % kCells, i / kCells % kCells, i / (kCells * kCells)});
      if (k > 0 && reference::cellOf(test::gridOf(all[k - 1], kCells), p)) continue;
      const auto flux = static_cast<float>(std::exp(-glm::dot(p, p) / 200.0) * std::pow(grid.cellSize, 3.0));
      // Moved half a cell they would lie on borders: a hair less leaves no doubt which cell is theirs.
      for (const float way : {1.0f, -1.0f})
        texels.push_back({glm::vec4(0.999f * glm::vec3(p), 1.0f), {0, 0, way, 1}, glm::vec3(flux)});
    }
  const RsmTextures textures(texels, 0.0);
  std::vector<Probe> probes;
  for (int i = 0; i < 1000; ++i)
    for (const glm::vec3& normal : kAxes)
      probes.push_back({0.1f * (glm::vec3(i % 10, i / 10 % 10, i / 100) - 4.5f), normal});
  double one = 0.0;
  for (int cascades = 1; cascades <= 4; ++cascades) {
    s.cascades.cascades = cascades;
    s.handOver = 0;  // as it is by default
    const LpvInputs inputs{{textures.outputs()}, {all.end() - cascades, all.end()}, 1.0f};
    const LightPropagationVolume lpv = run(s, inputs, true);
    double mean = 0.0;
    for (const glm::vec3& seen : test::probeIrradiance(library(), lpv, probes))
      mean += static_cast<double>(seen.x) / static_cast<double>(probes.size());
    if (cascades == 1) one = mean;
    std::cout << "[ measured ] " << cascades << " cascades: mean irradiance over that of one " << mean / one << "\n";
    EXPECT_NEAR(mean / one, 1.0, 0.01) << cascades;
  }
}

}  // namespace
}  // namespace lucerna
