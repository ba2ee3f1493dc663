#include "forward/shadow_map.hpp"

namespace lucerna {

ShadowMap::ShadowMap(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings)
    : target_("shadow map", gl::Texture("shadow map", gl::Format::depth32f, glm::ivec2(settings.size))) {
  programs_.opaque = &programs.loadRaster("shadow opaque", "forward/depth.vert", "",
                                          {{"ALPHA_MASK", 0}, {"FROM_SUN", 1}, {"EMITTERS", 0}});
  if (scene.features().alphaMasks)
    programs_.masked = &programs.loadRaster("shadow masked", "forward/depth.vert", "forward/depth.frag",
                                            {{"ALPHA_MASK", 1}, {"FROM_SUN", 1}, {"EMITTERS", 0}});
}

void ShadowMap::record(const GpuScene& scene, const glm::mat4& clipFromWorld) {
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  state.polygonOffset = {0.0f, 2.0f};  // lookups follow the receiver's plane
  const DepthTarget::View view{clipFromWorld, glm::vec3(0.0f)};
  target_.record(scene, programs_, state, {&view, 1});
}

}  // namespace lucerna
