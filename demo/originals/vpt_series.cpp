#include "originals/vpt_series.hpp"

#include "base/clock.hpp"
#include "base/data.hpp"
#include "gl/draw.hpp"
#include "gl/objects.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>

namespace lucerna::demo::bench {

const std::vector<VptPicture>& vptPictures() {
  constexpr float n = kVptLoweredIor;
  // Scenes lit by an area light, with their camera; and the same as published, lit by a point.
  struct Files {
    const char *scene, *camera, *original;
  };
  constexpr Files gems{"gems/gems.json", "published", "gems/gems_original.json"};
  constexpr Files milk{"block/milk.json", "published", "block/milk_original.json"};
  constexpr Files juice{"block/juice.json", "published", "block/juice_original.json"};
  constexpr Files coffee{"block/coffee.json", "published", "block/coffee_original.json"};
  constexpr Files cup{"espresso/espresso.json", "published", "espresso/espresso_original.json"};
  constexpr Files closeUp{"espresso/espresso.json", "close-up", "espresso/espresso_close_original.json"};
  constexpr Files cola{"cola/cola.json", "published", "cola/cola_original.json"};
  constexpr Files smoke{"smoke/smoke.json", "published", "smoke/smoke_cloud.json"};
  struct Change {
    double scattering = 1.0, absorption = 1.0, anisotropy = 1.0;
    float ior = 0.0f;
  };
  const auto make = [](const char* table, const char* figure, const char* label, const Files& files,
                       std::uint32_t samples, double ms, const Change& c = {}) {
    return VptPicture{table,   figure, label,        files.scene,  files.camera, files.original,
                      samples, ms,     c.scattering, c.absorption, c.anisotropy, c.ior};
  };
  static const std::vector<VptPicture> pictures = {
      make(kVptSampleSeries, "5.8 a", "four gems, 1 sample", gems, 1, 14.0),
      make(kVptSampleSeries, "5.8 b", "four gems, 8 samples", gems, 8, 61.0),
      make(kVptSampleSeries, "5.9 a", "four gems, 64 samples", gems, 64, 445.0),
      make(kVptSampleSeries, "5.9 b", "four gems, 512 samples", gems, 512, 3619.0),
      make(kVptSampleSeries, "5.10 a", "four gems, 1024 samples", gems, 1024, 7289.0),
      make(kVptSampleSeries, "5.10 b", "four gems, 2048 samples", gems, 2048, 14580.0),
      make("sigma_s, 5.12 and 5.13", "5.12 a", "milk, sigma_s / 1000", milk, 2048, 15500.0,
           {.scattering = 0.001, .ior = n}),
      make("sigma_s, 5.12 and 5.13", "5.12 b", "milk, sigma_s / 100", milk, 2048, 23300.0,
           {.scattering = 0.01, .ior = n}),
      make("sigma_s, 5.12 and 5.13", "5.13 a", "milk, sigma_s / 10", milk, 2048, 36500.0,
           {.scattering = 0.1, .ior = n}),
      make("sigma_s, 5.12 and 5.13", "5.13 b", "milk, sigma_s", milk, 2048, 38000.0, {.ior = n}),
      make("sigma_a, 5.14 and 5.15", "5.14 a", "grape juice, sigma_a / 10", juice, 2048, 14500.0,
           {.absorption = 0.1, .ior = n}),
      make("sigma_a, 5.14 and 5.15", "5.14 b", "grape juice, sigma_a", juice, 2048, 16700.0, {.ior = n}),
      make("sigma_a, 5.14 and 5.15", "5.15 a", "grape juice, sigma_a x 10", juice, 2048, 21900.0,
           {.absorption = 10.0, .ior = n}),
      make("sigma_a, 5.14 and 5.15", "5.15 b", "grape juice, sigma_a x 100", juice, 2048, 24300.0,
           {.absorption = 100.0, .ior = n}),
      make("g, 5.16", "5.16 a", "espresso, g as measured", coffee, 2048, 25800.0),
      make("g, 5.16", "5.16 b", "espresso, g = 0", coffee, 2048, 15100.0, {.anisotropy = 0.0}),
      make("g, 5.16", "5.16 c", "espresso, g negated", coffee, 2048, 23300.0, {.anisotropy = -1.0}),
      make("scenes, 5.17 to 5.20", "5.17", "espresso in a glass cup", cup, 1024, 14500.0),
      make("scenes, 5.17 to 5.20", "5.18", "espresso, close-up", closeUp, 1024, 18500.0),
      make("scenes, 5.17 to 5.20", "5.19", "cola with ice", cola, 1024, 27200.0),
      make("scenes, 5.17 to 5.20", "5.20", "smoke cloud", smoke, 1024, 51300.0),
  };
  return pictures;
}

const std::vector<VptPicture>& vptUntimedPictures() {
  // The text does not name the scene of figure 5.7. We use a medium that absorbs far more than it scatters, like grape
  // juice.
  static const std::vector<VptPicture> pictures = [] {
    VptPicture picture = vptPictures()[11];
    picture.table = "interaction, 5.7";
    picture.samples = 256;
    picture.publishedMs = 0.0;
    picture.figure = "5.7 a", picture.label = "grape juice, probability as it is", picture.boosted = false;
    std::vector<VptPicture> both{picture};
    picture.figure = "5.7 b", picture.label = "grape juice, raised to a half", picture.boosted = true;
    both.push_back(picture);
    return both;
  }();
  return pictures;
}

Scene loadVptScene(const VptPicture& picture, Fidelity fidelity) {
  const bool published = fidelity != Fidelity::corrected;
  Scene scene = loadScene(dataFolder() / "assets/media" / (published ? picture.original : picture.scene));
  for (Medium& medium : scene.media) {
    medium.scattering *= static_cast<float>(picture.scattering);
    medium.absorption *= static_cast<float>(picture.absorption);
    medium.anisotropy *= static_cast<float>(picture.anisotropy);
  }
  for (Material& material : scene.materials)
    if (picture.ior > 0.0f && material.bsdf == Bsdf::dielectric) material.ior = picture.ior;
  return scene;
}

PathDeviations vptDeviations(const VptPicture& picture, Fidelity fidelity) {
  RenderSettings settings;
  applyFidelity(settings, fidelity);
  if (!picture.boosted) settings.of<PathSettings>().deviations.boostedInteraction = false;
  return settings.of<PathSettings>().deviations;
}

glm::ivec2 vptSize(double scale) {
  return {std::max(16, static_cast<int>(std::lround(kVptSize.x * scale))),
          std::max(9, static_cast<int>(std::lround(kVptSize.y * scale)))};
}

std::uint32_t vptSamples(const VptPicture& picture, double scale) {
  const auto scaled = [&](std::uint32_t samples) {
    return std::max(1u, static_cast<std::uint32_t>(std::lround(samples * scale)));
  };
  std::uint32_t samples = scaled(picture.samples);
  if (std::string_view(picture.table) != kVptSampleSeries) return samples;
  std::uint32_t before = 0;
  for (const VptPicture& other : vptPictures()) {
    if (std::string_view(other.table) != kVptSampleSeries || other.samples > picture.samples) break;
    samples = before = std::max(before + 1, scaled(other.samples));
  }
  return samples;
}

VptResult renderVpt(const gl::Context& context, gl::ProgramLibrary& programs, const VptPicture& picture,
                    const Scene& scene, glm::ivec2 size, std::uint32_t samples, double mostSeconds,
                    const PathDeviations& deviations, std::uint32_t seed) {
  PathTracer::Settings settings;
  settings.deviations = deviations;
  settings.seed = seed;
  settings.size = size;
  PathTracer tracer(context, programs, scene, settings);
  const Camera camera = scene.cameras.size() > 1 ? chooseCamera(scene, picture.camera) : scene.cameras.front();
  tracer.setCamera(camera);
  tracer.advance(1);  // a driver may compile at the first dispatch
  tracer.setCamera(camera);
  const auto start = Clock::now();
  const auto seconds = [&] { return secondsSince(start); };
  while (tracer.advance(samples) && !interrupted() && (mostSeconds <= 0.0 || seconds() < mostSeconds)) {}
  VptResult result;
  result.ms = 1000.0 * seconds();
  result.statistics = tracer.statistics();
  result.image = tracer.mean();
  return result;
}

double vptPreparationMs(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, glm::ivec2 size,
                        const PathDeviations& deviations) {
  PathTracer::Settings settings;
  settings.deviations = deviations;
  settings.size = size;
  const auto begin = Clock::now();
  const PathTracer tracer(context, programs, scene, settings);
  gl::finish();
  return 1000.0 * secondsSince(begin);
}

}  // namespace lucerna::demo::bench
