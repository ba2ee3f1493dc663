// Light that is reflected several times, and surfels that the camera sees, in the light propagation volume on GL:
// against the double-precision reference implementation and against what must hold whatever the scene.
#include "lpv/lpv_frame.hpp"
#include "support/gl_fixture.hpp"
#include "support/lpv_on_gl.hpp"
#include "support/small_scenes.hpp"

#include "base/error.hpp"
#include "cascades/cascades.hpp"
#include "render/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

namespace lucerna {
namespace {

using reference::VolumeRgb;
using test::RsmTexel;
using test::RsmTextures;
using Storage = LpvSettings::Storage;

class LpvMoreLight : public test::SharedProgramsTest {
 protected:
  static LpvSettings settings(int cells, int iterations, int bounces, int cascades = 1) {
    LpvSettings s;
    s.cascades.cells = cells;
    s.cascades.cascades = cascades;
    s.cascades.cellSize = 1.0;
    s.iterations = iterations;
    s.bounces = bounces;
    s.storage = Storage::full;
    s.handOver = iterations;  // each cascade for itself
    return s;
  }
  static std::vector<Cascade> place(const LpvSettings& s) {
    return placeCascades(s.cascades, Bounds{}, glm::dvec3(0.0), glm::dvec3(0.0));
  }
  static LightPropagationVolume run(const LpvSettings& s, const LpvInputs& inputs) {
    return test::runVolume(library(), capabilities(), s, inputs);
  }
  /// Coloured surfels, off the borders of cells (multiples of 1/4) for axis-aligned normals, so that 32 bits choose
  /// the reference implementation's cell.
  static std::vector<RsmTexel> randomTexels(unsigned seed, int count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    std::uniform_int_distribution<int> cell(-5, 4), axis(0, 5);
    std::vector<RsmTexel> texels;
    for (int i = 0; i < count; ++i) {
      const auto off = [&] { return 0.25f * static_cast<float>(i % 4) + 0.05f + 0.15f * uniform(random); };
      glm::vec3 normal(0.0f);
      const int side = axis(random);
      normal[side / 2] = side % 2 ? 1.0f : -1.0f;
      const glm::vec3 p = glm::vec3(cell(random), cell(random), cell(random)) + glm::vec3(off(), off(), off());
      texels.push_back({glm::vec4(p, 1.0f), glm::vec4(normal, 0.1f + uniform(random)),
                        glm::vec3(uniform(random), 1.0f, 0.1f), glm::vec3(uniform(random), 1.0f, 0.2f)});
    }
    return texels;
  }
  static void report(const std::string& what, double value) {
    std::cout << "[ measured ] " << what << ": " << value << "\n";
  }
};

// ---- bounces
// ----------------------------------------------------------------------------------------------------------------

class LpvBounces : public LpvMoreLight {
 protected:
  /// A closed box of albedo rho, walls of one surfel a corner in the planes 2 and 8 of 10^3 cells, and one light in
  /// it, away from the walls.
  static std::vector<RsmTexel> closedBox(float rho) {
    std::vector<RsmTexel> texels{{{0.4f, 0.3f, -0.9f, 1.0f}, {0, 0, 1, 1e30f}, glm::vec3(1.0f, 0.5f, 0.25f)}};
    for (int axis = 0; axis < 3; ++axis)
      for (const float way : {1.0f, -1.0f})
        for (int i = -3; i <= 3; ++i)
          for (int j = -3; j <= 3; ++j) {
            glm::vec3 p(0.0f), n(0.0f);
            p[axis] = -3.0f * way;
            p[(axis + 1) % 3] = static_cast<float>(i);
            p[(axis + 2) % 3] = static_cast<float>(j);
            n[axis] = way;
            texels.push_back({glm::vec4(p, 1.0f), glm::vec4(n, 1.0f), glm::vec3(0.0f), glm::vec3(rho)});
          }
    return texels;
  }
};

TEST_F(LpvBounces, TheClampGainIsTheOneThatTheShaderDividesOut) { EXPECT_NEAR(reference::clampGain(), 1.138208, 5e-7); }

TEST_F(LpvBounces, AgainstTheReference) {
  const std::vector<RsmTexel> texels = randomTexels(1, 1500);
  constexpr double kTexelArea = 0.05;
  const RsmTextures textures(texels, kTexelArea);
  for (const int cascades : {1, 2})
    for (const int bounces : {2, 4}) {
      LpvSettings s = settings(10, 4, bounces, cascades);
      const LpvInputs inputs{{textures.outputs()}, place(s), 3.5f};
      const std::vector<reference::Vpl> vpls = test::vplsOf(texels, kTexelArea);
      std::vector<VolumeRgb> expected, once;
      for (const Cascade& cascade : inputs.cascades) {
        const reference::GridSpec grid = test::gridOf(cascade, 10);
        VolumeRgb injected = reference::makeVolumeRgb(grid);
        reference::inject(injected, vpls);
        reference::Volume geometry(reference::geometryGrid(grid));
        reference::injectSurfels(geometry, grid, vpls);
        const VolumeRgb reflectance = reference::injectReflectance(grid, vpls);
        expected.push_back(reference::propagateBounces(injected, 4, bounces, geometry, reflectance).light);
        once.push_back(reference::propagateBounces(injected, 4, 1, geometry, reflectance).light);
        EXPECT_GT(reference::totalFlux(expected.back()).y,
                  1.05 * reference::totalFlux(once.back()).y);  // there is something to see
      }
      for (const LpvPropagate propagate : {LpvPropagate::compute, LpvPropagate::layered})
        for (const Storage storage : {Storage::full, Storage::half}) {
          s.propagate = propagate;
          s.storage = storage;
          const std::vector<VolumeRgb> actual = test::readVolume(run(s, inputs).result(), inputs);
          for (std::size_t k = 0; k < actual.size(); ++k) {
            const double error = test::relativeError(expected[k], actual[k]);
            EXPECT_LT(error, storage == Storage::full ? 1e-5 : 1e-3)
                << nameOf(propagate) << ", cascade " << k << ", " << bounces << " bounces";
            report(
                fmt::format("{} bounces, {}, {} bits", bounces, nameOf(propagate), storage == Storage::full ? 32 : 16),
                error);
          }
        }
    }
}

TEST_F(LpvBounces, JoinedCascadesBounceAllTheirLight) {
  // With a hand-over the sum lies in two parts: one cascade's light must come back whole. Joined, one cascade's part
  // that no finer grid takes over is the same as without; so the coarsest is held against the reference implementation.
  const std::vector<RsmTexel> texels = randomTexels(2, 800);
  const RsmTextures textures(texels, 0.05);
  LpvSettings s = settings(8, 5, 3, 2);
  s.handOver = 2;
  const LpvInputs inputs{{textures.outputs()}, place(s), 1.0f};
  const std::vector<reference::Vpl> vpls = test::vplsOf(texels, 0.05);
  const reference::GridSpec grid = test::gridOf(inputs.cascades[1], 8);
  VolumeRgb injected = reference::makeVolumeRgb(grid);
  reference::inject(injected, vpls);
  reference::Volume geometry(reference::geometryGrid(grid));
  reference::injectSurfels(geometry, grid, vpls);
  const VolumeRgb expected =
      reference::propagateBounces(injected, 5, 3, geometry, reference::injectReflectance(grid, vpls)).light;
  EXPECT_LT(test::relativeError(expected, test::readVolume(run(s, inputs).result(), inputs)[1]), 1e-5);
}

TEST_F(LpvBounces, TheSumOfAllBouncesIsBounded) {
  // A source of flux S0 in a closed box: S_b <= S0 (1 + rho + ... + rho^(b-1)) for any albedo up to 1, and every
  // front carries at most the clamp gain times its source, so T <= S (1 + 1.138208 n). More bounces are never darker.
  constexpr int kSteps = 12;
  for (const float rho : {0.0f, 0.5f, 0.99f, 1.0f - 1e-6f}) {
    const std::vector<RsmTexel> texels = closedBox(rho);
    const RsmTextures textures(texels, 1.0);
    glm::dvec3 previous(0.0), once(0.0);
    double series = 0.0;
    int done = 0;
    for (const int bounces : {1, 2, 3, 8, 64}) {
      for (; done < bounces; ++done) series += std::pow(static_cast<double>(rho), done);
      const LpvSettings s = settings(10, kSteps, bounces);
      const LpvInputs inputs{{textures.outputs()}, place(s), 1.0f};
      const VolumeRgb light = test::readVolume(run(s, inputs).result(), inputs)[0];
      const glm::dvec3 flux = reference::totalFlux(light);
      if (bounces == 1) once = flux;
      report(fmt::format("albedo {}, {} bounces: light over that of one", rho, bounces), flux.x / once.x);
      for (int channel = 0; channel < 3; ++channel) {
        const double source = std::ldexp(1.0, -channel);  // red 1, green 1/2, blue 1/4
        ASSERT_TRUE(std::isfinite(flux[channel]));
        EXPECT_LE(flux[channel], source * series * (1.0 + reference::clampGain() * kSteps));
        EXPECT_GE(flux[channel], previous[channel] * (1.0 - 1e-6));
        EXPECT_NEAR(flux[channel] / flux.x, source, 1e-5);  // the walls are grey
        if (rho == 0.0f) {
          EXPECT_NEAR(flux[channel], once[channel], 1e-6 * once[channel]);
        } else if (bounces > 1) {
          EXPECT_GT(flux[channel], (1.0 + 0.1 * static_cast<double>(rho)) * once[channel]);
        }
      }
      previous = flux;
    }
  }
}

TEST_F(LpvBounces, TheReferencesSourcesFollowTheGeometricSeries) {
  // Each bounce adds rho times the one before at most, also in the reference implementation, bounce by bounce.
  for (const float rho : {0.5f, 0.99f, 1.0f}) {
    const std::vector<RsmTexel> texels = closedBox(rho);
    const std::vector<reference::Vpl> vpls = test::vplsOf(texels, 1.0);
    const reference::GridSpec grid{glm::ivec3(10), glm::dvec3(-5.0), 1.0};
    VolumeRgb injected = reference::makeVolumeRgb(grid);
    reference::inject(injected, vpls);
    reference::Volume geometry(reference::geometryGrid(grid));
    reference::injectSurfels(geometry, grid, vpls);
    const VolumeRgb reflectance = reference::injectReflectance(grid, vpls);
    double before = 0.0, added = 0.0;
    for (int bounces = 1; bounces <= 6; ++bounces) {
      const double source =
          reference::totalFlux(reference::propagateBounces(injected, 8, bounces, geometry, reflectance).source).x;
      if (bounces > 1) {
        EXPECT_GT(source - before, 0.0);
        EXPECT_LE(source - before, static_cast<double>(rho) * added * (1.0 + 1e-9)) << rho << ", bounce " << bounces;
        report(fmt::format("albedo {}, bounce {}: added over the one before", rho, bounces), (source - before) / added);
      }
      added = source - before;
      before = source;
    }
  }
}

TEST_F(LpvBounces, OneBounceCostsNothingAndMoreNeedSurfels) {
  gl::ProgramLibrary programs;
  LpvSettings s = settings(6, 4, 1, 2);
  const std::size_t bytes = LightPropagationVolume(programs, capabilities(), s).gpuBytes();
  for (const std::string& name : programs.names()) EXPECT_EQ(name.find("reflect"), std::string::npos) << name;
  s.bounces = 2;
  EXPECT_EQ(LightPropagationVolume(programs, capabilities(), s).gpuBytes(), bytes + 16u * 2u * (3u * 216u + 343u));
  s.blocking = false;
  try {
    const LightPropagationVolume lpv(programs, capabilities(), s);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::badInput);
    EXPECT_NE(std::string(error.what()).find("lpv.bounces=2"), std::string::npos);
  }
}

// ---- surfels of several views
// -------------------------------------------------------------------------------------------------

class LpvViews : public LpvMoreLight {
 protected:
  static std::vector<reference::Volume> geometryOf(const LpvSettings& s, const LpvInputs& inputs) {
    LightPropagationVolume lpv(library(), capabilities(), s);
    lpv.place(inputs);
    lpv.fillGeometryVolume(inputs);
    return test::readGeometryVolume(lpv, inputs);
  }
};

TEST_F(LpvViews, OfASurfaceSeenTwiceTheLongerVectorCounts) {
  const std::vector<RsmTexel> lit = randomTexels(3, 900), seen = randomTexels(4, 900);
  const RsmTextures lightMap(lit, 0.05), cameraMap(seen, 0.08);
  for (const bool twice : {false, true})
    for (const LpvSurfels surfels : {LpvSurfels::rsm, LpvSurfels::camera, LpvSurfels::both}) {
      LpvSettings s = settings(8, 4, 2, 2);
      s.surfels = surfels;
      s.mergeViews = surfels == LpvSurfels::both || twice;
      LpvInputs inputs{{lightMap.outputs()}, place(s), 1.0f, glm::vec3(0.0f), {cameraMap.outputs()}};
      if (twice) {  // every view once more must not change anything
        inputs.rsms.push_back(lightMap.outputs());
        inputs.views.push_back(cameraMap.outputs());
      }
      const std::vector<reference::Volume> actual = geometryOf(s, inputs);
      for (std::size_t k = 0; k < actual.size(); ++k) {
        const reference::GridSpec grid = test::gridOf(inputs.cascades[k], 8);
        reference::Volume expected(reference::geometryGrid(grid)), camera(reference::geometryGrid(grid));
        if (surfels != LpvSurfels::camera) reference::injectSurfels(expected, grid, test::vplsOf(lit, 0.05));
        if (surfels != LpvSurfels::rsm) reference::injectSurfels(camera, grid, test::vplsOf(seen, 0.08));
        reference::mergeByGreatest(expected, camera);
        EXPECT_LT(test::relativeError(expected, actual[k]), 1e-5)
            << static_cast<int>(surfels) << ", cascade " << k << ", twice " << twice;
        EXPECT_GT(reference::length(expected.cells[grid.cellCount() / 2]) + reference::totalFlux(expected), 1.0);
      }
    }
}

TEST_F(LpvViews, TheAlbedoOfTheLongerVectorCounts) {
  // The camera sees more of the same wall, in another colour: its surfels replace the light's, and their albedo too.
  const auto wall = [](float area, const glm::vec3& albedo) {
    std::vector<RsmTexel> texels{{{0.25f, 0.25f, -1.25f, 1.0f}, {0, 0, 1, 1e30f}, glm::vec3(1.0f)}};
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        texels.push_back({{x, y, 1.0f, 1.0f}, {0, 0, -1, 1.0f / area}, glm::vec3(0.0f), albedo});
    return texels;
  };
  const RsmTextures lightMap(wall(0.5f, {1.0f, 0.0f, 0.0f}), 1.0), cameraMap(wall(1.0f, {0.0f, 0.0f, 1.0f}), 1.0);
  LpvSettings s = settings(8, 4, 1);
  s.surfels = LpvSurfels::both;
  s.mergeViews = true;
  const auto gained = [&] {
    LpvInputs inputs{{lightMap.outputs()}, place(s), 1.0f, glm::vec3(0.0f), {cameraMap.outputs()}};
    s.bounces = 1;
    const glm::dvec3 once = reference::totalFlux(test::readVolume(run(s, inputs).result(), inputs)[0]);
    s.bounces = 2;
    return reference::totalFlux(test::readVolume(run(s, inputs).result(), inputs)[0]) - once;
  };
  const glm::dvec3 both = gained();
  EXPECT_NEAR(both.x, 0.0, 1e-6);
  EXPECT_GT(both.z, 0.05);
  s.surfels = LpvSurfels::rsm;
  const glm::dvec3 lightOnly = gained();
  EXPECT_GT(lightOnly.x, 0.02);
  EXPECT_NEAR(lightOnly.z, 0.0, 1e-6);
}

TEST_F(LpvViews, TheCamerasSurfelsHaveTheAreaOfWhatItSees) {
  // A plate of 4 x 3 before the camera, tilted by 40 degrees: the geometry volume holds its true area, whatever the
  // light sees.
  for (const double tilt : {0.0, 0.7}) {
    test::SceneBuilder builder;
    const int grey = builder.material(glm::vec3(0.5f));
    builder.plate({0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, 3.0 * glm::dvec3(0.0, std::cos(tilt), std::sin(tilt)), grey);
    builder.sun({0.0, -1.0, -1.0}, glm::vec3(1.0f));
    RenderSettings s;
    s.technique = "lpv";
    s.component = Component::indirect;
    s.size = {32, 32};
    s.of<LpvSettings>().cascades.cells = 16;
    s.of<LpvSettings>().cascades.cascades = 1;
    s.of<LpvSettings>().surfels = LpvSurfels::camera;
    Renderer renderer(context(), programs(), builder.scene(), s);
    const Camera camera = test::lookingAt({0.3, 0.2, 8.0}, {0.0, 0.0, 0.0});
    renderer.render(camera);
    const double cell =
        placeCascades(s.of<LpvSettings>().cascades, builder.scene().bounds, camera.position, camera.direction)[0]
            .cellSize;
    double area = 0.0;
    for (const glm::vec4& potential : volumeOf(renderer.technique())->geometryVolume()->readRgba())
      area += static_cast<double>(potential.x) / reference::kLobeBand0 * cell * cell;
    report(fmt::format("tilt {}: area seen over the plate's", tilt), area / 12.0);
    EXPECT_NEAR(area / 12.0, 1.0, 0.01);
    const auto left = renderer.leftOut();
    EXPECT_EQ(std::count(left.begin(), left.end(), "camera surfels"), 0);
    EXPECT_EQ(std::count(left.begin(), left.end(), "light bounces"), 1);
  }
}

}  // namespace
}  // namespace lucerna
