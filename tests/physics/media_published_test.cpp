// The published path tracer of participating media [VPT2024] draws what its text shows: bright milk, the order of
// espresso over g, and work that rises along the published series. On the scenes of assets/media in the original's
// format, lit by a point as there.
#include "base/data.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/deviations.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

using namespace test;

PathDeviations original() {
  RenderSettings settings;
  applyFidelity(settings, Fidelity::original);
  return settings.of<PathSettings>().deviations;
}

class MediaPublished : public SharedProgramsTest {
 protected:
  struct Drawn {
    glm::dvec3 middle{0.0};  ///< radiance of the block's centre, over a fifth of the picture's sides
    PathTracer::Statistics statistics;
  };
  /// A block of a medium of the original's catalogue; scattering, absorption and g times these factors, as the text's
  /// series have them.
  struct Block {
    const char* medium = "milk";
    double scattering = 1.0, absorption = 1.0, anisotropy = 1.0;
    double ior = 0.0;  ///< 0: the medium's
  };
  Drawn draw(const Block& block, const PathDeviations& deviations, std::uint32_t samples, glm::ivec2 size = {64, 36}) {
    Scene scene = loadScene(dataFolder() / "assets/media/block" / (std::string(block.medium) + "_original.json"));
    for (Medium& medium : scene.media) {
      medium.scattering *= static_cast<float>(block.scattering);
      medium.absorption *= static_cast<float>(block.absorption);
      medium.anisotropy *= static_cast<float>(block.anisotropy);
    }
    for (Material& material : scene.materials)
      if (block.ior > 0.0 && material.bsdf == Bsdf::dielectric) material.ior = static_cast<float>(block.ior);
    PathTracer::Settings settings;
    settings.size = size;
    settings.deviations = deviations;
    PathTracer tracer(context(), library(), scene, settings);
    tracer.setCamera(scene.cameras.front());
    tracer.record(samples);
    Drawn drawn;
    drawn.statistics = tracer.statistics();
    const Image image = tracer.mean();
    int count = 0;
    for (int y = size.y * 2 / 5; y < size.y * 3 / 5; ++y)
      for (int x = size.x * 2 / 5; x < size.x * 3 / 5; ++x, ++count) drawn.middle += glm::dvec3(image.at(x, y));
    drawn.middle /= count;
    return drawn;
  }
};

TEST_F(MediaPublished, MilkIsAlmostWhollyWhite) {
  // "The result is almost wholly white" (5.7). With shadow rays that media attenuate, or roulette at each collision,
  // little of it is left. What it is on the screen, as the text shows pictures that were tone mapped: by the engine's
  // curve at exposure 1.
  PathDeviations attenuated = original(), everywhere = original(), scaled = original();
  attenuated.unattenuatedShadowRays = false;
  everywhere.rouletteAtSurfaces = false;
  scaled.unscaledRefraction = false;
  const glm::dvec3 published = draw({}, original(), 24).middle;
  const glm::dvec3 withAttenuation = draw({}, attenuated, 24).middle, withRoulette = draw({}, everywhere, 24).middle;
  std::printf("milk: published %.4f %.4f %.4f, shadow rays attenuated %.4f, roulette at collisions %.4f\n", published.x,
              published.y, published.z, withAttenuation.x, withRoulette.x);
  Image patch(1, 1, glm::vec3(published));
  const double shown = toneMapped(patch, 1.0f).rgba[0] / 255.0;
  std::printf("milk's red on the screen: %.3f\n", shown);
  EXPECT_GE(shown, 0.5);
  EXPECT_GT(published.x, 0.3);
  EXPECT_GT(std::min({published.x, published.y, published.z}),
            0.6 * std::max({published.x, published.y, published.z}));  // white
  EXPECT_LT(withAttenuation.x, 0.1 * published.x);
  EXPECT_LT(withRoulette.x, 0.9 * published.x);
  // All but the floor's reflection comes from within, where the published sum does not divide by n^2.
  const double ratio = published.x / draw({}, scaled, 24).middle.x;
  EXPECT_GT(ratio, 1.65);
  EXPECT_LT(ratio, 1.33 * 1.33 + 1e-4);
}

TEST_F(MediaPublished, NoLampOfThisSceneGivesMoreThanTheSumOfItsEquation) {
  // With g = 0 the sum of equation 5.7 has a bound in closed form. A collision happens with probability w, the largest
  // albedo, and leaves half of red's throughput, the least extinction's; so red is at most w/2 / (1 - w/2) I / r^2 /
  // (4 pi) plus what the surface reflects, with r from the lamp to where the picture's middle meets the block.
  const double w = 7.78262 / (7.78262 + 4.79838), r2 = 23.9 * 23.9 + 19.1 * 19.1 + 21.4 * 21.4;
  const double bound = 0.5 * w / (1.0 - 0.5 * w) * 5529.6 / r2 / (4.0 * M_PI);
  const double isotropic = draw({"coffee", 1.0, 1.0, 0.0}, original(), 48).middle.x;
  std::printf("espresso, g 0: %.4f, bound %.4f\n", isotropic, bound);
  EXPECT_LT(isotropic, bound);
  EXPECT_GT(isotropic, 0.8 * bound);  // what leaves through the surface, and roulette
}

TEST_F(MediaPublished, EspressoIsBrightestWithoutADirectionAndDarkestTurnedBack) {
  // Figure 5.16: isotropic scattering lights the object through, backward scattering makes it a little darker than the
  // measured coefficient.
  const double measured = draw({"coffee"}, original(), 48).middle.x,
               isotropic = draw({"coffee", 1.0, 1.0, 0.0}, original(), 48).middle.x;
  const double backward = draw({"coffee", 1.0, 1.0, -1.0}, original(), 48).middle.x;
  std::printf("espresso: g measured %.4f, 0 %.4f, negated %.4f\n", measured, isotropic, backward);
  EXPECT_GT(isotropic, 1.5 * measured);
  EXPECT_GT(measured, 1.5 * backward);
}

TEST_F(MediaPublished, WorkRisesWithScattering) {
  // Figures 5.12 and 5.13 took 15.5, 23.3, 36.5 and 38 s: rising, as more scattering is sampled. Loop turns instead of
  // a clock: rays' nodes and triangles, steps in media. The text calls the last two very alike; here the last has more
  // than twice the turns of the one before.
  double turns[4];
  for (int i = 0; i < 4; ++i)
    turns[i] = draw({"milk", std::pow(10.0, i - 3), 1.0, 1.0, 1.1}, original(), 12).statistics.iterations;
  std::printf("turns, milk %.3g: 1 %.2f %.2f %.2f (published times 1 1.50 2.35 2.45)\n", turns[0], turns[1] / turns[0],
              turns[2] / turns[0], turns[3] / turns[0]);
  for (int i = 1; i < 4; ++i) EXPECT_GT(turns[i], 1.1 * turns[i - 1]) << i;
}

}  // namespace
}  // namespace lucerna
