// The light propagation volume on GL, held against its double-precision CPU twin and against known answers.
//
// Errors are relative to the largest coefficient of the grid that is compared (see relativeError): 1e-5 where the grids are
// kept in 32-bit floats. What 16-bit floats may cost is derived at kHalfTolerance.
#include "support/gl_fixture.hpp"
#include "support/lpv_on_gl.hpp"

#include "lpv/cascades.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>

namespace lucerna {
namespace {

using test::Probe;
using test::RsmTexel;
using test::RsmTextures;
using twin::VolumeRgb;
using Storage = LightPropagationVolume::Storage;

constexpr double kFullTolerance = 1e-5;
constexpr double kHalfTolerance = 1e-3;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

const std::array<glm::vec3, 6> kAxes = {glm::vec3(1, 0, 0),  glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0),
                                        glm::vec3(0, -1, 0), glm::vec3(0, 0, 1),  glm::vec3(0, 0, -1)};

/// Programs are compiled once a suite: tests here make many volumes of few kinds.
class LpvGlTest : public test::GlTest {
 protected:
  static void SetUpTestSuite() {
    GlTest::SetUpTestSuite();
    library_ = std::make_unique<gl::ProgramLibrary>();
  }
  static void TearDownTestSuite() { library_.reset(); }
  static gl::ProgramLibrary& library() { return *library_; }

  static LightPropagationVolume::Settings settings(int cells, int cascades, int iterations, bool blocking = false,
                                                   Storage storage = Storage::full) {
    LightPropagationVolume::Settings s;
    s.cascades.cells = cells;
    s.cascades.cascades = cascades;
    s.iterations = iterations;
    s.blocking = blocking;
    s.storage = storage;
    return s;
  }

  /// Runs all stages, join() where asked for.
  static LightPropagationVolume run(const LightPropagationVolume::Settings& s, const LightPropagationVolume::Inputs& inputs,
                                    bool join = false) {
    LightPropagationVolume lpv(library(), capabilities(), s);
    lpv.place(inputs);
    lpv.inject(inputs);
    lpv.fillGeometryVolume(inputs);
    lpv.propagate();
    if (join) lpv.join();
    return lpv;
  }

 private:
  static std::unique_ptr<gl::ProgramLibrary> library_;
};
std::unique_ptr<gl::ProgramLibrary> LpvGlTest::library_;

/// One cascade with its minimum in the origin and cells of size 1.
[[maybe_unused]] std::vector<Cascade> unitCascade(int cells) {
  Cascade cascade;
  cascade.centre = glm::dvec3(0.5 * cells);
  return {cascade};
}

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

/// Random virtual point lights in and around the cascades: axis-aligned and oblique normals, some ten per cell of the coarse
/// grids, those on borders exactly representable, and the bad ones. Where rounding to 32 bits could choose another cell than
/// the twin's 64 (within 1e-3 cells of a border), a light is drawn again.
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
      const glm::vec3 p = static_cast<float>(reach) * (2.0f * glm::vec3(uniform(random), uniform(random), uniform(random)) - 1.0f);
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
          for (const glm::dvec3& p : {inCells, glm::dvec3(inCells.z, inCells.x, inCells.y), glm::dvec3(inCells.y, inCells.z, inCells.x)}) {
            flux = flux > 4.0f ? 1.0f : flux + 0.125f;  // all different, so that a swap shows
            texels.push_back({glm::vec4(glm::vec3(cascade.minimum() + cascade.cellSize * p), 1.0f), glm::vec4(normal, 0.5f),
                              glm::vec3(flux, 1.0f, 5.0f - flux)});
          }
        }
  return texels;
}

struct Case {
  int cells, cascades;
  double cellSize, ratio;  ///< of the coarsest; dyadic where lights on borders are wanted
};
const std::array<Case, 5> kCases{{{8, 1, 2.0, 2.0}, {16, 2, 1.0, 2.0}, {8, 3, 2.0, 2.0}, {12, 4, 1.5, 2.0}, {9, 3, 1.37, 1.7}}};

struct CaseInputs {
  std::vector<Cascade> cascades;
  std::vector<RsmTexel> texels;
  double texelArea = 0.07;
  RsmTextures textures;
  LightPropagationVolume::Inputs inputs;

  explicit CaseInputs(const Case& c, unsigned seed)
      : cascades(place(c)), texels(makeTexels(c, seed, cascades)), textures(texels, texelArea),
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

/// What the twin makes of the same inputs.
struct TwinRun {
  std::vector<VolumeRgb> injected, result;
  std::vector<twin::Volume> geometry;
};
TwinRun runTwin(const CaseInputs& c, int cells, int iterations, bool blocking) {
  const std::vector<twin::Vpl> vpls = test::vplsOf(c.texels, c.texelArea);
  TwinRun run;
  for (const Cascade& cascade : c.cascades) {
    const twin::GridSpec grid = test::gridOf(cascade, cells);
    twin::inject(run.injected.emplace_back(twin::makeVolumeRgb(grid)), vpls);
    twin::injectSurfels(run.geometry.emplace_back(twin::geometryGrid(grid)), grid, vpls);
    run.result.push_back(
        twin::propagate(run.injected.back(), iterations, {}, blocking ? &run.geometry.back() : nullptr).accumulated);
  }
  return run;
}

void report(const char* what, double error) { std::cout << "[ measured ] " << what << ": " << error << "\n"; }

// ---- against the twin ------------------------------------------------------------------------------------------------

class LpvAgainstTwin : public LpvGlTest {};

TEST_F(LpvAgainstTwin, Injection) {
  double worst = 0.0;
  for (const Case& c : kCases) {
    const CaseInputs inputs(c, 1);
    const TwinRun expected = runTwin(inputs, c.cells, 0, false);
    for (const Storage storage : {Storage::full, Storage::half}) {  // injected light is kept in 32 bits in both
      const LightPropagationVolume lpv = run(settings(c.cells, c.cascades, 1, false, storage), inputs.inputs);
      const std::vector<VolumeRgb> actual = test::readVolume(lpv.injected(), inputs.inputs);
      for (std::size_t k = 0; k < actual.size(); ++k) {
        const double error = test::relativeError(expected.injected[k], actual[k]);
        EXPECT_LT(error, kFullTolerance) << c.cells << "^3, cascade " << k << " of " << c.cascades;
        worst = std::max(worst, error);
        EXPECT_GT(twin::totalFlux(expected.injected[k]).x, 1.0);  // the test has something to compare
      }
    }
  }
  report("injection, largest error", worst);
}

TEST_F(LpvAgainstTwin, GeometryVolume) {
  double worst = 0.0;
  for (const Case& c : kCases) {
    const CaseInputs inputs(c, 2);
    const TwinRun expected = runTwin(inputs, c.cells, 0, false);
    const LightPropagationVolume lpv = run(settings(c.cells, c.cascades, 2, true), inputs.inputs);
    ASSERT_NE(lpv.geometryVolume(), nullptr);
    const std::vector<twin::Volume> actual = test::readGeometryVolume(lpv, inputs.inputs);
    for (std::size_t k = 0; k < actual.size(); ++k) {
      const double error = test::relativeError(expected.geometry[k], actual[k]);
      EXPECT_LT(error, kFullTolerance) << c.cells << "^3, cascade " << k << " of " << c.cascades;
      worst = std::max(worst, error);
    }
  }
  report("geometry volume, largest error", worst);
}

TEST_F(LpvAgainstTwin, PropagationAndLookup) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  for (const Storage storage : {Storage::full, Storage::half}) {
    const double tolerance = storage == Storage::full ? kFullTolerance : kHalfTolerance;
    std::array<double, 9> worst{};
    double worstLookup = 0.0;
    for (const Case& c : kCases) {
      const CaseInputs inputs(c, 4);
      for (const bool blocking : {false, true})
        for (const int iterations : {1, 2, 8}) {
          const TwinRun expected = runTwin(inputs, c.cells, iterations, blocking);
          const LightPropagationVolume lpv = run(settings(c.cells, c.cascades, iterations, blocking, storage), inputs.inputs);
          const std::vector<VolumeRgb> actual = test::readVolume(lpv.result(), inputs.inputs);
          for (std::size_t k = 0; k < actual.size(); ++k) {
            const double error = test::relativeError(expected.result[k], actual[k]);
            EXPECT_LT(error, tolerance) << c.cells << "^3, cascade " << k << " of " << c.cascades << ", " << iterations
                                        << " steps, blocking " << blocking << ", half " << (storage == Storage::half);
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
          const std::vector<glm::vec3> seen = test::probeIrradiance(library(), lpv, probes);
          glm::dvec3 largest(0.0);
          std::vector<glm::dvec3> all;
          for (const Probe& probe : probes) {
            all.push_back(twin::irradiance(expected.result[0], glm::dvec3(probe.position), glm::dvec3(probe.normal)));
            largest = glm::max(largest, all.back());
          }
          for (std::size_t i = 0; i < probes.size(); ++i)
            for (int channel = 0; channel < 3; ++channel) {
              const double error = std::abs(all[i][channel] - static_cast<double>(seen[i][channel])) / largest[channel];
              EXPECT_LT(error, tolerance) << "probe " << i;
              EXPECT_GE(seen[i][channel], 0.0f);
              worstLookup = std::max(worstLookup, error);
            }
        }
    }
    const bool half = storage == Storage::half;
    report(half ? "half, 1 step" : "full, 1 step", worst[1]);
    report(half ? "half, 2 steps" : "full, 2 steps", worst[2]);
    report(half ? "half, 8 steps" : "full, 8 steps", worst[8]);
    report(half ? "half, lookup" : "full, lookup", worstLookup);
  }
}

TEST_F(LpvAgainstTwin, JoinAndBlendedLookup) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  for (const Storage storage : {Storage::full, Storage::half}) {
    const double tolerance = storage == Storage::full ? kFullTolerance : kHalfTolerance;
    double worst = 0.0, worstLookup = 0.0;
    for (const Case& c : kCases) {
      const CaseInputs inputs(c, 6);
      LightPropagationVolume::Settings s = settings(c.cells, c.cascades, 2, false, storage);
      s.blendBand = 0.4f;
      s.lookupOffset = 0.25f;
      const LightPropagationVolume lpv = run(s, inputs.inputs, true);
      const std::vector<VolumeRgb> actual = test::readVolume(lpv.result(), inputs.inputs);
      const TwinRun separate = runTwin(inputs, c.cells, 2, false);
      std::array<std::vector<twin::Volume>, 3> expected;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        for (const VolumeRgb& cascade : separate.result) expected[channel].push_back(cascade[channel]);
        expected[channel] = twin::joinCascades(expected[channel]);
        for (std::size_t k = 0; k < actual.size(); ++k) {
          const double error = test::relativeError(expected[channel][k], actual[k][channel]);
          EXPECT_LT(error, tolerance) << c.cells << "^3, cascade " << k << " of " << c.cascades << ", channel " << channel << ", half "
                                      << (storage == Storage::half);
          worst = std::max(worst, error);
        }
      }
      twin::CascadeBlend blend{{}, static_cast<double>(s.blendBand)};
      for (const Cascade& cascade : inputs.cascades) blend.centres.push_back(cascade.centre);
      std::vector<Probe> probes;
      for (int i = 0; i < 1500; ++i) {
        const Cascade& around = inputs.cascades[static_cast<std::size_t>(i) % inputs.cascades.size()];
        const auto reach = static_cast<float>(0.55 * c.cells * around.cellSize);
        probes.push_back({glm::vec3(around.centre) + reach * glm::vec3(uniform(random), uniform(random), uniform(random)),
                          glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random)))});
      }
      const std::vector<glm::vec3> seen = test::probeIrradiance(library(), lpv, probes);
      const twin::LookupOptions lookup{twin::Lookup::cosine, static_cast<double>(s.lookupOffset)};
      for (std::size_t channel = 0; channel < 3; ++channel) {
        std::vector<double> all;
        for (const Probe& probe : probes)
          all.push_back(twin::blendedIrradiance(expected[channel], blend, glm::dvec3(probe.position), glm::dvec3(probe.normal), lookup));
        const double largest = *std::max_element(all.begin(), all.end());
        for (std::size_t i = 0; i < probes.size(); ++i) {
          const double error = std::abs(all[i] - static_cast<double>(seen[i][static_cast<int>(channel)])) / largest;
          EXPECT_LT(error, tolerance) << c.cells << "^3, " << c.cascades << " cascades, probe " << i;
          worstLookup = std::max(worstLookup, error);
        }
      }
    }
    report(storage == Storage::half ? "half, join" : "full, join", worst);
    report(storage == Storage::half ? "half, blended lookup" : "full, blended lookup", worstLookup);
  }
}

}  // namespace
}  // namespace lucerna
