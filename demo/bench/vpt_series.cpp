#include "bench/vpt_series.hpp"

#include "base/data.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

namespace lucerna::demo::bench {

const std::vector<VptPicture>& vptPictures() {
  constexpr float n = kVptLoweredIor;
  static const std::vector<VptPicture> pictures = {
      {"samples, 5.8 to 5.10", "5.8 a", "four gems, 1 sample", "gems/gems.json", "published", 1, 14.0},
      {"samples, 5.8 to 5.10", "5.8 b", "four gems, 8 samples", "gems/gems.json", "published", 8, 61.0},
      {"samples, 5.8 to 5.10", "5.9 a", "four gems, 64 samples", "gems/gems.json", "published", 64, 445.0},
      {"samples, 5.8 to 5.10", "5.9 b", "four gems, 512 samples", "gems/gems.json", "published", 512, 3619.0},
      {"samples, 5.8 to 5.10", "5.10 a", "four gems, 1024 samples", "gems/gems.json", "published", 1024, 7289.0},
      {"samples, 5.8 to 5.10", "5.10 b", "four gems, 2048 samples", "gems/gems.json", "published", 2048, 14580.0},
      {"sigma_s, 5.12 and 5.13", "5.12 a", "milk, sigma_s / 1000", "block/milk.json", "published", 2048, 15500.0, 0.001, 1.0, 1.0, n},
      {"sigma_s, 5.12 and 5.13", "5.12 b", "milk, sigma_s / 100", "block/milk.json", "published", 2048, 23300.0, 0.01, 1.0, 1.0, n},
      {"sigma_s, 5.12 and 5.13", "5.13 a", "milk, sigma_s / 10", "block/milk.json", "published", 2048, 36500.0, 0.1, 1.0, 1.0, n},
      {"sigma_s, 5.12 and 5.13", "5.13 b", "milk, sigma_s", "block/milk.json", "published", 2048, 38000.0, 1.0, 1.0, 1.0, n},
      {"sigma_a, 5.14 and 5.15", "5.14 a", "grape juice, sigma_a / 10", "block/juice.json", "published", 2048, 14500.0, 1.0, 0.1, 1.0, n},
      {"sigma_a, 5.14 and 5.15", "5.14 b", "grape juice, sigma_a", "block/juice.json", "published", 2048, 16700.0, 1.0, 1.0, 1.0, n},
      {"sigma_a, 5.14 and 5.15", "5.15 a", "grape juice, sigma_a x 10", "block/juice.json", "published", 2048, 21900.0, 1.0, 10.0, 1.0, n},
      {"sigma_a, 5.14 and 5.15", "5.15 b", "grape juice, sigma_a x 100", "block/juice.json", "published", 2048, 24300.0, 1.0, 100.0, 1.0, n},
      {"g, 5.16", "5.16 a", "espresso, g as measured", "block/coffee.json", "published", 2048, 25800.0},
      {"g, 5.16", "5.16 b", "espresso, g = 0", "block/coffee.json", "published", 2048, 15100.0, 1.0, 1.0, 0.0},
      {"g, 5.16", "5.16 c", "espresso, g negated", "block/coffee.json", "published", 2048, 23300.0, 1.0, 1.0, -1.0},
      {"scenes, 5.17 to 5.20", "5.17", "espresso in a glass cup", "espresso/espresso.json", "published", 1024, 14500.0},
      {"scenes, 5.17 to 5.20", "5.18", "espresso, close-up", "espresso/espresso.json", "close-up", 1024, 18500.0},
      {"scenes, 5.17 to 5.20", "5.19", "cola with ice", "cola/cola.json", "published", 1024, 27200.0},
      {"scenes, 5.17 to 5.20", "5.20", "smoke cloud", "smoke/smoke.json", "published", 1024, 51300.0},
  };
  return pictures;
}

Scene loadVptScene(const VptPicture& picture) {
  Scene scene = loadScene(dataFolder() / "assets/media" / picture.scene);
  for (Medium& medium : scene.media) {
    medium.scattering *= static_cast<float>(picture.scattering);
    medium.absorption *= static_cast<float>(picture.absorption);
    medium.anisotropy *= static_cast<float>(picture.anisotropy);
  }
  for (Material& material : scene.materials)
    if (picture.ior > 0.0f && material.bsdf == Bsdf::dielectric) material.ior = picture.ior;
  return scene;
}

glm::ivec2 vptSize(double scale) {
  return {std::max(16, static_cast<int>(std::lround(kVptSize.x * scale))), std::max(9, static_cast<int>(std::lround(kVptSize.y * scale)))};
}

std::uint32_t vptSamples(const VptPicture& picture, double scale) {
  return std::max(1u, static_cast<std::uint32_t>(std::lround(picture.samples * scale)));
}

VptResult renderVpt(const gl::Context& context, gl::ProgramLibrary& programs, const VptPicture& picture, const Scene& scene, glm::ivec2 size, std::uint32_t samples,
                    double mostSeconds, const PathDeviations& deviations, std::uint32_t seed) {
  PathTracer::Settings settings;
  settings.deviations = deviations;
  settings.seed = seed;
  settings.size = size;
  PathTracer tracer(context, programs, scene, settings);
  const Camera camera = chooseCamera(scene, picture.camera);
  tracer.setCamera(camera);
  tracer.advance(1);  // a driver may compile at the first dispatch
  tracer.setCamera(camera);
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  while (tracer.advance(samples) && !interrupted() && (mostSeconds <= 0.0 || seconds() < mostSeconds)) {
  }
  VptResult result;
  result.ms = 1000.0 * seconds();
  result.statistics = tracer.statistics();
  result.image = tracer.mean();
  return result;
}

}  // namespace lucerna::demo::bench
