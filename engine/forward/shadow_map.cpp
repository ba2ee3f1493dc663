#include "forward/shadow_map.hpp"

namespace lucerna {

ShadowMap::ShadowMap(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings) {
  programs_.opaque = &programs.loadRaster("shadow opaque", "forward/depth.vert", "",
                                          {{"ALPHA_MASK", 0}, {"FROM_SUN", 1}, {"EMITTERS", 0}});
  if (scene.features().alphaMasks)
    programs_.masked = &programs.loadRaster("shadow masked", "forward/depth.vert", "forward/depth.frag",
                                            {{"ALPHA_MASK", 1}, {"FROM_SUN", 1}, {"EMITTERS", 0}});
  depth_ = gl::Texture("shadow map", gl::Format::depth32f, glm::ivec2(settings.size));
  framebuffer_ = gl::Framebuffer("shadow map", {}, &depth_);
}

void ShadowMap::record(const GpuScene& scene) const {
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  state.polygonOffset = {0.0f, 2.0f};  // lookups follow the receiver's plane
  const gl::RasterPass pass("shadow map", framebuffer_, state);
  pass.clearDepth();
  scene.drawDepth(programs_);
}

}  // namespace lucerna
