#include "lpv/light_shafts.hpp"

#include "gl/pass.hpp"
#include "shared/bindings.h"
#include "shared/haze.h"

#include <algorithm>

namespace lucerna {

namespace {

constexpr int kGroup = 8;  // pixels each way of a work group
constexpr double kIterationsOfStep = 8.0;  // lookups in the sun's maps and the volume's cascades

}  // namespace

std::optional<Haze> hazeOf(const Scene& scene) {
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    if (material.bsdf != Bsdf::none || material.interior < 0) continue;
    const Medium& medium = scene.media[static_cast<std::size_t>(material.interior)];
    if (medium.grid) continue;
    Haze haze{medium, {}};
    bool isUsed = false;
    for (const Mesh& mesh : scene.meshes) {
      if (mesh.material != static_cast<int>(m)) continue;
      for (std::uint32_t i = 0; i < mesh.indexCount; ++i)
        haze.box.add(glm::dvec3(scene.vertices[scene.indices[mesh.firstIndex + i]].position));
      isUsed = true;
    }
    if (isUsed) return haze;
  }
  if (scene.cameraMedium < 0) return std::nullopt;
  const Medium& medium = scene.media[static_cast<std::size_t>(scene.cameraMedium)];
  return medium.grid ? std::nullopt : std::optional(Haze{medium, scene.bounds});
}

LightShafts::LightShafts(gl::ProgramLibrary& programs, const Haze& haze, const Settings& settings)
    : steps_(settings.steps), chunks_(settings.unmeasuredIterations) {
  gl::ShaderFlags flags{{"SUN", settings.sun},
                        {"SUN_CASCADES", settings.sunCascades},
                        {"PENUMBRA_TAPS", 0},
                        {"SOFT_SPOTS", 0},
                        {"SOFT_POINTS", 0},
                        {"PROPAGATED", settings.volume},
                        {"FULL_FLOAT", settings.fullFloat}};
  if (settings.volume) flags.insert(flags.end(), settings.lookup.begin(), settings.lookup.end());
  program_ = &programs.loadCompute("light shafts", "lpv/shafts.comp", flags);
  shared::HazeConstants constants{};
  constants.low = glm::vec3(haze.box.min);
  constants.high = glm::vec3(haze.box.max);
  constants.scattering = haze.medium.scattering;
  constants.extinction = haze.medium.scattering + haze.medium.absorption;
  const bool isRayleigh = haze.medium.phase == PhaseFunction::rayleigh;
  constants.isRayleigh = isRayleigh ? 1.0f : 0.0f;
  constants.anisotropy = isRayleigh ? glm::vec3(0.0f) : haze.medium.anisotropy;
  constants_ = gl::Buffer("haze", sizeof constants, &constants, gl::Usage::staticDraw);
}

void LightShafts::bind() const { constants_.bindUniform(BLOCK_HAZE); }

void LightShafts::record(const gl::Texture& radiance, const gl::Texture& depth, const glm::dmat4& clipFromWorld) {
  const gl::ComputePass pass("light shafts", gl::Barrier::textureFetch | gl::Barrier::framebuffer, gl::Barrier::image);
  program_->use();
  program_->set("worldFromClip", glm::mat4(glm::inverse(clipFromWorld)));
  program_->set("steps", steps_);
  bind();
  depth.bind(0);
  radiance.bindImage(0, gl::Access::readWrite);
  chunks_.forEach(radiance.size2d(), kIterationsOfStep * steps_, kGroup,
                  [&](const glm::ivec2& corner, const glm::ivec2& size) {
                    program_->set("firstPixel", corner);
                    pass.dispatch(glm::ivec3(size, 1), glm::ivec3(kGroup, kGroup, 1));
                  });
}

}  // namespace lucerna
