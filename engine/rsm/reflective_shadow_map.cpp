#include "rsm/reflective_shadow_map.hpp"

#include <array>

namespace lucerna {

ReflectiveShadowMap::ReflectiveShadowMap(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings) {
  const auto load = [&](const std::string& name, bool masked) {
    gl::ShaderFlags flags = scene.materialFlags(masked);
    flags.emplace_back("FLUX_COSINE", settings.fluxCosine);
    return &programs.loadRaster(name, "rsm/rsm.vert", "rsm/rsm.frag", flags);
  };
  programs_.opaque = load("rsm opaque", false);
  if (scene.needs().alphaMasks) programs_.masked = load("rsm masked", true);
  // Positions and flux in 32 bits: world coordinates do not fit 16, nor does a flux of any unit. Read texel by texel.
  const glm::ivec2 size(settings.size);
  position_ = gl::Texture("rsm position", GL_RGBA32F, size);
  normal_ = gl::Texture("rsm normal", GL_RGBA16F, size);
  flux_ = gl::Texture("rsm flux", GL_RGBA32F, size);
  depth_ = gl::Texture("rsm depth", GL_DEPTH_COMPONENT32F, size);
  const std::array<const gl::Texture*, 3> colors{&position_, &normal_, &flux_};
  framebuffer_ = gl::Framebuffer("rsm", colors, &depth_);
}

ReflectiveShadowMap::Outputs ReflectiveShadowMap::record(const GpuScene& scene, double texelArea) {
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  const gl::RasterPass pass("rsm", framebuffer_, state);
  for (int attachment = 0; attachment < 3; ++attachment) pass.clearColor(attachment, glm::vec4(0.0f));
  pass.clearDepth();
  programs_.opaque->set("texelArea", static_cast<float>(texelArea));
  if (programs_.masked) programs_.masked->set("texelArea", static_cast<float>(texelArea));
  scene.draw(programs_, {});
  return {position_, normal_, flux_, static_cast<float>(texelArea)};
}

}  // namespace lucerna
