// The ways to fill the light propagation volume and to propagate in it: each gives what the others give.
//
// Errors are relative to the largest coefficient of the grid (see relativeError).
#include "base/error.hpp"
#include "support/gl_fixture.hpp"
#include "support/lpv_on_gl.hpp"
#include "support/temp_folder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <random>

namespace lucerna {
namespace {

using reference::VolumeRgb;
using test::RsmTexel;
using test::RsmTextures;
using Storage = LpvSettings::Storage;

class LpvWays : public test::SharedProgramsTest {
 protected:
  static LpvSettings settings(int cells, int cascades, int iterations) {
    LpvSettings s;
    s.cascades.cells = cells;
    s.cascades.cascades = cascades;
    s.cascades.cellSize = 1.0;
    s.iterations = iterations;
    s.storage = Storage::full;
    return s;
  }
  static std::vector<Cascade> place(const LpvSettings& s) {
    return placeCascades(s.cascades, Bounds{}, glm::dvec3(0.3, -0.2, 0.1), glm::dvec3(0.0));
  }
  static LightPropagationVolume run(const LpvSettings& s, const LpvInputs& inputs) {
    return test::runVolume(library(), capabilities(), s, inputs);
  }

  static constexpr float kIrradiance = 3.5f;
  static constexpr double kTexelArea = 0.01;
  /// Lights and surfels all through the finest cascades, as bright as E * albedo * texel area allows.
  static std::vector<RsmTexel> randomTexels(unsigned seed, int count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    std::normal_distribution<float> gauss;
    std::vector<RsmTexel> texels;
    for (int i = 0; i < count; ++i) {
      const glm::vec3 n = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
      const glm::vec3 p = 10.0f * (glm::vec3(uniform(random), uniform(random), uniform(random)) - 0.5f);
      texels.push_back(
          {glm::vec4(p, 1.0f), glm::vec4(n, 0.1f + 0.9f * uniform(random)),
           kIrradiance * static_cast<float>(kTexelArea) * glm::vec3(uniform(random), 1.0f, 0.01f * uniform(random))});
    }
    return texels;
  }
  static VolumeRgb firstInjected(const LpvSettings& s, const LpvInputs& inputs) {
    return test::readVolume(run(s, inputs).injected(), inputs)[0];
  }
};

// ---- propagation
// -------------------------------------------------------------------------------------------------------

TEST_F(LpvWays, LayeredPropagationIsTheComputeOne) {
  const std::vector<RsmTexel> texels = randomTexels(1, 3000);
  const RsmTextures textures(texels, kTexelArea);
  for (const Storage storage : {Storage::full, Storage::half}) {
    double worst = 0.0;
    for (const int cascades : {1, 3})
      for (const bool blocking : {false, true})
        for (const int iterations : {1, 2, 8}) {
          LpvSettings s = settings(12, cascades, iterations);
          s.blocking = blocking;
          s.storage = storage;
          const LpvInputs inputs{{textures.outputs()}, place(s), kIrradiance};
          const std::vector<VolumeRgb> compute = test::readVolume(run(s, inputs).result(), inputs);
          s.propagate = LpvPropagate::layered;
          const std::vector<VolumeRgb> layered = test::readVolume(run(s, inputs).result(), inputs);
          for (std::size_t k = 0; k < compute.size(); ++k) {
            const double error = test::relativeError(compute[k], layered[k]);
            // Half storage: one unit in the last place, where the two are rounded to neighbours.
            EXPECT_LT(error, storage == Storage::full ? 1e-6 : 1e-3)
                << cascades << " cascades, " << k << ", " << iterations << " steps, blocking " << blocking;
            EXPECT_GT(reference::totalFlux(compute[k]).y, 0.1);
            worst = std::max(worst, error);
          }
        }
    std::cout << "[ measured ] layered beside compute, " << (storage == Storage::full ? "32" : "16")
              << " bits: " << worst << "\n";
  }
}

// ---- injection
// ---------------------------------------------------------------------------------------------------------

// One light each in places that a brick of 4^3 cells could lose: a corner of the grid, both sides of a border between
// bricks, the last brick of a cascade, which is cut off where cells are no multiple of 4; then several; then none.
TEST_F(LpvWays, LeavingOutDarkBricksGivesTheSameBits) {
  const auto light = [](const glm::vec3& cellOfFirst, const glm::vec3& normal, const Cascade& first) {
    const glm::dvec3 p =
        first.minimum() + first.cellSize * (glm::dvec3(cellOfFirst) + 0.5) - 0.5 * first.cellSize * glm::dvec3(normal);
    return RsmTexel{glm::vec4(glm::vec3(p), 1.0f), glm::vec4(normal, 1.0f), glm::vec3(1.0f, 0.5f, 0.25f)};
  };
  int lit = 0;
  for (const int cells : {1, 3, 4, 9, 12})
    for (const int cascades : {1, 3})
      for (const int iterations : {1, 2, 5, 8}) {
        LpvSettings s = settings(cells, cascades, iterations);
        s.fill = LpvFill::fixed;
        const std::vector<Cascade> placed = place(s);
        const float last = static_cast<float>(cells - 1);
        std::vector<std::vector<RsmTexel>> scenes{{}};
        for (const glm::vec3& normal :
             {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)})
          for (const glm::vec3& cell : {glm::vec3(0.0f), glm::vec3(last), glm::vec3(3, 4, 7), glm::vec3(4, 3, 8)})
            if (glm::all(glm::lessThanEqual(cell, glm::vec3(last)))) scenes.push_back({light(cell, normal, placed[0])});
        scenes.push_back(randomTexels(6, 200));
        for (std::size_t scene = 0; scene < scenes.size(); scene += cells == 12 || scene == 0 ? 1 : 5) {
          const RsmTextures textures(scenes[scene], kTexelArea);
          const LpvInputs inputs{{textures.outputs()}, placed, kIrradiance};
          s.everyBrick = false;
          const LightPropagationVolume few = run(s, inputs);
          s.everyBrick = true;
          const LightPropagationVolume all = run(s, inputs);
          for (std::size_t channel = 0; channel < 3; ++channel) {
            const std::vector<glm::vec4> expected = all.result()[channel].readRgba();
            ASSERT_EQ(expected, few.result()[channel].readRgba())
                << cells << " cells " << cascades << " cascades " << iterations << " steps, scene " << scene;
            const bool dark =
                std::all_of(expected.begin(), expected.end(), [](const glm::vec4& c) { return c == glm::vec4(0.0f); });
            if (scene == 0) { EXPECT_TRUE(dark); }
            lit += dark ? 0 : 1;
          }
        }
      }
  EXPECT_GT(lit, 300);
}

// The bricks of one frame must not stay lit in the next, nor the light of its buffers.
TEST_F(LpvWays, LightThatMovesLeavesNothingBehindInDarkBricks) {
  LpvSettings s = settings(12, 2, 3);
  for (const LpvFill fill : {LpvFill::layered, LpvFill::fixed}) {
    s.fill = fill;
    LightPropagationVolume kept(library(), capabilities(), s);
    std::vector<Cascade> placed = place(s);
    for (const float x : {-4.6f, 4.4f, 0.1f}) {
      const RsmTextures textures(std::vector<RsmTexel>{{{x, x, -x, 1.0f}, {0, 1, 0, 1}, glm::vec3(2.0f)}}, kTexelArea);
      for (const int shift : {0, 1, -3}) {  // the grid snaps on
        for (Cascade& cascade : placed) cascade.firstCell += glm::i64vec3(shift, 0, 0);
        const LpvInputs inputs{{textures.outputs()}, placed, kIrradiance};
        kept.place(inputs);
        kept.inject(inputs);
        kept.fillGeometryVolume(inputs);
        kept.propagate();
        kept.join();
        const LightPropagationVolume fresh = run(s, inputs);
        for (std::size_t channel = 0; channel < 3; ++channel)
          ASSERT_EQ(fresh.result()[channel].readRgba(), kept.result()[channel].readRgba())
              << nameOf(fill) << " " << x << " " << shift;
      }
    }
  }
}

// A second propagation of the same light: the first has overwritten the front that atomics count in.
TEST_F(LpvWays, PropagatedAgainGivesTheSame) {
  const std::vector<RsmTexel> texels = randomTexels(7, 300);
  const RsmTextures textures(texels, kTexelArea);
  LpvSettings s = settings(8, 2, 4);
  s.fill = LpvFill::fixed;
  const LpvInputs inputs{{textures.outputs()}, place(s), kIrradiance};
  LightPropagationVolume lpv = run(s, inputs);
  const std::vector<glm::vec4> first = lpv.result()[1].readRgba();
  lpv.propagate();
  lpv.join();
  EXPECT_EQ(first, lpv.result()[1].readRgba());
}

// ---- filling
// -----------------------------------------------------------------------------------------------------------

TEST_F(LpvWays, FixedPointGivesTheLayeredGridWithinItsQuantum) {
  const std::vector<RsmTexel> texels = randomTexels(2, 5000);
  const RsmTextures textures(texels, kTexelArea);
  for (const int cascades : {1, 3}) {
    LpvSettings s = settings(12, cascades, 0);
    const LpvInputs inputs{{textures.outputs()}, place(s), kIrradiance};
    const std::vector<VolumeRgb> layered = test::readVolume(run(s, inputs).injected(), inputs);
    s.fill = LpvFill::fixed;
    const std::vector<VolumeRgb> fixed = test::readVolume(run(s, inputs).injected(), inputs);
    // 2^30 steps of flux for all texels, as white as can be, in one cell; each light is off by half a step at most.
    const double largest =
        reference::kLobeBand1 / kPi *
        static_cast<double>(textures.outputs().position.size().x * textures.outputs().position.size().y) * kTexelArea;
    for (std::size_t k = 0; k < fixed.size(); ++k) {
      const double quantum = static_cast<double>(kIrradiance) * std::ldexp(largest, -30);
      reference::Volume lights(fixed[k][0].grid);
      for (const RsmTexel& texel : texels) {
        const glm::dvec3 moved = glm::dvec3(texel.position) + 0.5 * lights.grid.cellSize * glm::dvec3(texel.normal);
        if (const auto cell = reference::cellOf(lights.grid, moved)) lights.at(*cell).c0 += 1.0;
      }
      for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t i = 0; i < lights.cells.size(); ++i) {
          const reference::Sh apart = fixed[k][channel].cells[i] - layered[k][channel].cells[i];
          // Half a step a light; the layered sum is rounded to 24 bits at each of them.
          const double allowed =
              lights.cells[i].c0 * (0.5 * quantum + std::ldexp(layered[k][channel].cells[i].c0, -23)) + 1e-12;
          for (const double error : {apart.c0, apart.c1.x, apart.c1.y, apart.c1.z})
            ASSERT_LE(std::abs(error), allowed) << i;
        }
      EXPECT_LT(test::relativeError(layered[k][1], fixed[k][1]), 1e-5)
          << k;  // albedo 1; blue, 1/200 of it, is as many times coarser
      EXPECT_GT(reference::totalFlux(fixed[k]).y, 0.1);
    }
  }
}

TEST_F(LpvWays, AtomicGivesTheLayeredGrid) {
  if (!capabilities().shaderAtomicFloat && !capabilities().shaderAtomicFp16Vector)
    GTEST_SKIP() << "no float image atomics in this driver";
  const std::vector<RsmTexel> texels = randomTexels(3, 5000);
  const RsmTextures textures(texels, kTexelArea);
  LpvSettings s = settings(12, 3, 0);
  const LpvInputs inputs{{textures.outputs()}, place(s), kIrradiance};
  const std::vector<VolumeRgb> layered = test::readVolume(run(s, inputs).injected(), inputs);
  s.fill = LpvFill::atomic;
  const std::vector<VolumeRgb> atomic = test::readVolume(run(s, inputs).injected(), inputs);
  // Half vectors, as published, round each of a cell's some 10 lights to 11 bits.
  for (std::size_t k = 0; k < atomic.size(); ++k)
    EXPECT_LT(test::relativeError(layered[k], atomic[k]), capabilities().shaderAtomicFloat ? 1e-6 : 2e-2) << k;
}

// Surfels counted by atomics are those that blending draws: the geometry volume and what it does to the light.
TEST_F(LpvWays, CountedSurfelsAreTheDrawnOnes) {
  std::vector<RsmTexel> texels = randomTexels(8, 6000);
  for (const int cascades : {1, 3}) {
    LpvSettings s = settings(12, cascades, 4);
    const std::vector<Cascade> placed = place(s);
    const RsmTextures textures(texels, kTexelArea);
    const LpvInputs inputs{{textures.outputs()}, placed, kIrradiance};
    const LightPropagationVolume drawn = run(s, inputs);
    for (const LpvFill fill : {LpvFill::fixed, LpvFill::atomic}) {
      if (fill == LpvFill::atomic && !capabilities().shaderAtomicFloat) continue;
      s.fill = fill;
      const LightPropagationVolume counted = run(s, inputs);
      const std::vector<reference::Volume> expected = test::readGeometryVolume(drawn, inputs),
                                           actual = test::readGeometryVolume(counted, inputs);
      double largest = 0.0;
      for (std::size_t k = 0; k < expected.size(); ++k) {
        // Steps for all texels at a cosine of 1/20 in one cell: half a step a surfel, some ten of them a cell.
        EXPECT_LT(test::relativeError(expected[k], actual[k]), fill == LpvFill::fixed ? 2e-5 : 1e-6)
            << k << " " << nameOf(fill);
        for (const reference::Sh& cell : actual[k].cells) largest = std::max(largest, cell.c0);
      }
      EXPECT_GT(largest, 0.01);
      const std::vector<VolumeRgb> a = test::readVolume(drawn.result(), inputs),
                                   b = test::readVolume(counted.result(), inputs);
      for (std::size_t k = 0; k < a.size(); ++k)
        EXPECT_LT(test::relativeError(a[k][1], b[k][1]), 1e-5) << k << " " << nameOf(fill);
    }
    s.fill = LpvFill::fixed;
    const LightPropagationVolume before = run(s, inputs);
    std::shuffle(texels.begin(), texels.end(), std::mt19937(9));
    const RsmTextures shuffled(texels, kTexelArea);
    const LightPropagationVolume after = run(s, {{shuffled.outputs()}, placed, kIrradiance});
    EXPECT_EQ(before.geometryVolume()->readRgba(), after.geometryVolume()->readRgba());
  }
}

TEST_F(LpvWays, CountedSurfelsNeverOverflow) {
  // All texels of a map, as steep as they are counted, along an axis and in one cell of the finest cascade.
  for (const int count : {64, 64 * 64, 256 * 256})
    for (const bool fluxUnits : {false, true}) {
      LpvSettings s = settings(4, 2, 2);
      s.fill = LpvFill::fixed;
      s.deviations.fluxUnits = fluxUnits;
      const double area = 1e-3;
      const RsmTexel steep{glm::vec4(0.2f, 0.2f, 0.2f, 1.0f), {0, 0, -1, 0.01f}, glm::vec3(1e-6f)};
      const RsmTextures textures(std::vector<RsmTexel>(static_cast<std::size_t>(count), steep), area);
      std::vector<Cascade> cascades(2);
      for (std::size_t k = 0; k < 2; ++k) {
        cascades[k].firstCell = glm::i64vec3(-2);
        cascades[k].cellSize = k == 0 ? 0.5 : 1.0;
      }
      const LpvInputs inputs{{textures.outputs()}, cascades, kIrradiance};
      const std::vector<reference::Volume> volumes = test::readGeometryVolume(run(s, inputs), inputs);
      for (std::size_t k = 0; k < volumes.size(); ++k) {
        double band0 = 0.0, band1 = 0.0;
        for (const reference::Sh& cell : volumes[k].cells) band0 += cell.c0, band1 += cell.c1.z;
        const double s2 = inputs.cascades[k].cellSize * inputs.cascades[k].cellSize, total = count * area * 20.0 / s2;
        EXPECT_NEAR(band0 / (total * reference::kLobeBand0), 1.0, 1e-4) << count << " " << k;
        EXPECT_NEAR(band1 / (total * -reference::kLobeBand1), 1.0, 1e-4) << count << " " << k;
      }
    }
}

TEST_F(LpvWays, FixedPointGivesTheSameBitsInAnyOrder) {
  std::vector<RsmTexel> texels = randomTexels(4, 4096);
  std::array<std::vector<glm::vec4>, 3> first;
  for (int turn = 0; turn < 5; ++turn) {
    const RsmTextures textures(texels, kTexelArea);
    LpvSettings s = settings(8, 2, 0);
    s.fill = LpvFill::fixed;
    const LpvInputs inputs{{textures.outputs()}, place(s), kIrradiance};
    const LightPropagationVolume lpv = run(s, inputs);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::vector<glm::vec4> now = lpv.injected()[channel].readRgba();
      if (turn == 0) first[channel] = now;
      EXPECT_EQ(first[channel], now) << "run " << turn;
    }
    if (turn > 0) std::shuffle(texels.begin(), texels.end(), std::mt19937(static_cast<unsigned>(turn)));
  }
  EXPECT_TRUE(std::any_of(first[0].begin(), first[0].end(), [](const glm::vec4& c) { return c.x > 0.0f; }));
}

TEST_F(LpvWays, AnAtomicALightGivesTheSameBitsAsTiles) {
  const RsmTextures textures(randomTexels(5, 4000), kTexelArea);
  for (const bool blocking : {false, true}) {
    LpvSettings s = settings(12, 2, 2);
    s.fill = LpvFill::fixed;
    s.blocking = blocking;
    const LpvInputs inputs{{textures.outputs()}, place(s), kIrradiance};
    const std::vector<glm::vec4> tiles = run(s, inputs).injected()[1].readRgba();
    double sum = 0.0;
    for (const glm::vec4& texel : tiles) sum += static_cast<double>(texel.x);
    EXPECT_GT(sum, 0.0);
    for (const int side : {1, 2, 3}) {
      s.tile = side;
      EXPECT_EQ(run(s, inputs).injected()[1].readRgba(), tiles) << side;
    }
  }
}

TEST_F(LpvWays, FixedPointNeverOverflows) {
  // All texels of a map, albedo 1, in one cell and along an axis, so that band 1 takes the largest value that there can
  // be: 2^30 steps.
  for (const int count : {64, 64 * 64, 256 * 256})
    for (const bool fluxUnits : {false, true})
      for (const float scale : {1e-3f, 1.0f, 1e3f})
        for (const float way : {1.0f, -1.0f}) {
          LpvSettings s = settings(4, 2, 0);
          s.cascades.cellSize = static_cast<double>(scale);
          s.fill = LpvFill::fixed;
          s.deviations.fluxUnits = fluxUnits;
          const double area = 1e-4 * static_cast<double>(scale) * static_cast<double>(scale);
          const RsmTexel white{glm::vec4(0.2f * scale, 0.2f * scale, 0.2f * scale, 1.0f),
                               {0, 0, way, 1},
                               glm::vec3(kIrradiance * static_cast<float>(area))};
          const RsmTextures textures(std::vector<RsmTexel>(static_cast<std::size_t>(count), white), area);
          std::vector<Cascade> cascades(2);
          for (std::size_t k = 0; k < 2; ++k) {
            cascades[k].firstCell = glm::i64vec3(-2);
            cascades[k].cellSize = (k == 0 ? 0.5 : 1.0) * static_cast<double>(scale);
          }
          const LpvInputs inputs{{textures.outputs()}, cascades, kIrradiance};
          const std::vector<VolumeRgb> injected = test::readVolume(run(s, inputs).injected(), inputs);
          for (std::size_t k = 0; k < injected.size(); ++k) {
            // Without units each counts E albedo in place of E albedo A / s^2.
            const double s2 = std::pow(inputs.cascades[k].cellSize, 2.0);
            const double each = static_cast<double>(kIrradiance) * (fluxUnits ? s2 : area);
            EXPECT_NEAR(reference::totalFlux(injected[k]).x / (each * count), 1.0, 1e-4)
                << count << " " << k << fluxUnits << scale;
            double largest = 0.0;
            for (const reference::Sh& cell : injected[k][2].cells)
              largest = std::abs(cell.c1.z) > std::abs(largest) ? cell.c1.z : largest;
            EXPECT_NEAR(largest / (each * count * way * reference::kLobeBand1 / kPi), 1.0, 1e-4)
                << count << " " << k << fluxUnits << scale;
          }
        }
}

TEST_F(LpvWays, AtomicWithoutTheExtensionIsRefusedAndCompilesNothing) {
  gl::Capabilities without = capabilities();
  without.shaderAtomicFloat = without.shaderAtomicFp16Vector = false;
  gl::ProgramLibrary programs;
  LpvSettings s = settings(4, 1, 2);
  s.fill = LpvFill::atomic;
  try {
    const LightPropagationVolume lpv(programs, without, s);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::missingCapability);
    for (const char* part :
         {"lpv.fill=atomic", "NV_shader_atomic_float", "NV_shader_atomic_fp16_vector", "lpv.fill=fixed"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << part;
  }
  EXPECT_TRUE(programs.names().empty());
  // Nor is anything of it compiled where another way is chosen.
  s.fill = LpvFill::layered;
  const LightPropagationVolume lpv(programs, without, s);
  for (const std::string& name : programs.names()) EXPECT_EQ(name.find("atomic"), std::string::npos) << name;
  EXPECT_FALSE(programs.names().empty());
}

// ---- why injection adds in 32 bits
// ------------------------------------------------------------------------------------------

class LpvHalfStall : public LpvWays {
 protected:
  /// What additive blending of `count` times `value` leaves in one texel.
  static double blended(gl::ProgramLibrary& programs, gl::Format format, float value, int count) {
    const gl::Texture target("blend", format, glm::ivec2(1));
    const std::array<const gl::Texture*, 1> targets{&target};
    gl::clearToZero(targets, false);
    const gl::Framebuffer framebuffer("blend", targets);
    const gl::VertexArray none("blend");
    gl::RasterState state;
    state.blend = gl::Blend::add;
    {
      const gl::RasterPass pass("blend", framebuffer, state);
      const gl::Program& program = programs.loadRaster("blend", "add.vert", "add.frag");
      program.use();
      program.set("value", value);
      none.bind();
      glDrawArrays(GL_POINTS, 0, count);
    }
    return static_cast<double>(target.readRgba()[0].x);
  }
};

TEST_F(LpvHalfStall, SixteenBitSumsStopGrowingAndThirtyTwoBitSumsDoNot) {
  const test::TempFolder folder;
  folder.write("add.vert", "void main() { gl_Position = vec4(0.0, 0.0, 0.0, 1.0); gl_PointSize = 1.0; }\n");
  folder.write("add.frag",
               "layout(location = 0) out vec4 sum;\nuniform float value;\nvoid main() { sum = vec4(value); }\n");
  gl::ProgramLibrary programs(folder.path());
  // OpenGL leaves open how a blended half is rounded. To the nearest, a sum stops where the value is less than half a
  // unit in the last place; cut off, where it is less than a whole one. Of 1 + u, four times, u the last place of 1,
  // the third sum is 3 + 3u in units of 2u, and the fourth in units of 4u: 4 or 4 + 4u.
  const bool nearest = blended(programs, gl::Format::rgba16f, 1.0f + 1.0f / 1024.0f, 4) > 4.0;
  std::cout << "[ measured ] blended 16-bit sums " << (nearest ? "round to the nearest" : "cut off") << "\n";
  struct Row {
    float value;
    double nearest, cut;
  };
  for (const Row& row : {Row{1.0f, 2048.0, 2048.0}, Row{0.1f, 256.0, 128.0}, Row{1e-3f, 4.0, 2.0}}) {
    const double stall = nearest ? row.nearest : row.cut;
    const double half = blended(programs, gl::Format::rgba16f, row.value, 10000),
                 later = blended(programs, gl::Format::rgba16f, row.value, 20000);
    std::cout << "[ measured ] " << row.value << " added 10000 times: " << half << " in 16 bits, "
              << blended(programs, gl::Format::rgba32f, row.value, 10000) << " in 32\n";
    EXPECT_NEAR(half, stall, 0.002 * stall) << row.value;
    EXPECT_EQ(half, later) << row.value;
    EXPECT_LT(half, 0.45 * 10000.0 * static_cast<double>(row.value));
    EXPECT_NEAR(blended(programs, gl::Format::rgba32f, row.value, 10000) / (10000.0 * static_cast<double>(row.value)),
                1.0, 1e-4)
        << row.value;
  }
}

TEST_F(LpvHalfStall, TenThousandEqualLightsInACellAddUp) {
  for (const Storage storage : {Storage::full, Storage::half})
    for (const LpvFill fill : {LpvFill::layered, LpvFill::fixed, LpvFill::atomic})
      for (const float flux : {1.0f, 0.1f, 1e-3f, 1.08e-6f}) {
        if (fill == LpvFill::atomic && !capabilities().shaderAtomicFloat) continue;
        LpvSettings s = settings(4, 1, 0);
        s.fill = fill;
        s.storage = storage;
        const RsmTexel light{{0.2f, 0.2f, 0.2f, 1.0f}, {0, 0, 1, 1}, glm::vec3(flux)};
        const RsmTextures textures(std::vector<RsmTexel>(10000, light), static_cast<double>(flux));
        const LpvInputs inputs{{textures.outputs()}, place(s), 1.0f};
        const double total = reference::totalFlux(test::readVolume(run(s, inputs).injected(), inputs)[0]).x;
        // Equal terms drift in a 32-bit sum by up to 2^-25 each, 3e-4 here; measured 1.3e-4 at the least flux.
        EXPECT_NEAR(total / (10000.0 * static_cast<double>(flux)), 1.0,
                    fill != LpvFill::fixed && flux < 1e-5f ? 2e-4 : 1e-4)
            << flux << nameOf(fill);
      }
}

}  // namespace
}  // namespace lucerna
