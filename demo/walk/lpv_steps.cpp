#include "walk/lpv_steps.hpp"

#include "lpv/lpv_frame.hpp"
#include "render/renderer.hpp"

#include <cmath>

namespace lucerna::demo {

LpvSteps::LpvSteps(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                   RenderSettings settings, const Camera& camera, const std::function<void(int step)>& note) {
  LpvSettings& lpv = settings.of<LpvSettings>();
  const int steps = lpv.iterations;
  lpv.cascades.cascades = 1;
  lpv.bounces = 1;
  lpv.storage = LpvSettings::Storage::full;  // differences of sums
  settings.size = {64, 36};
  settings.pixelSamples = 1;
  Texels before;
  for (int k = 0; k <= steps; ++k) {
    note(k);
    lpv.iterations = k;
    Renderer renderer(context, programs, scene, settings);
    renderer.render(camera);
    const LightPropagationVolume* volume = volumeOf(renderer.technique());
    if (!volume) return;
    size_ = volume->result()[0].size();
    Texels sum, light;
    double energy = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      sum[c] = volume->result()[c].readRgba();
      light[c] = sum[c];
      if (k > 0)
        for (std::size_t i = 0; i < light[c].size(); ++i) light[c][i] -= before[c][i];
      // Band 0 is the flux of a cell, times a constant.
      for (const glm::vec4& texel : light[c]) energy += static_cast<double>(texel.x);
    }
    before = std::move(sum);
    light_.push_back(std::move(light));
    energies_.push_back(static_cast<float>(energy));
  }
  const float injected = energies_.front() > 0.0f ? energies_.front() : 1.0f;
  for (float& energy : energies_) energy /= injected;
}

StagePicture LpvSteps::picture(int k) {
  if (k != shown_) {
    for (std::size_t c = 0; c < 3; ++c) {
      textures_[c] = gl::Texture("lpv step", gl::Format::rgba32f, size_);
      textures_[c].upload(gl::Texels::rgbaFloat, light_[static_cast<std::size_t>(k)][c].data());
    }
    shown_ = k;
  }
  return {StagePicture::Kind::coefficients, "lpv step " + std::to_string(k), &textures_[0], &textures_[1],
          &textures_[2]};
}

}  // namespace lucerna::demo
