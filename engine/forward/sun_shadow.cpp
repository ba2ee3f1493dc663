#include "forward/sun_shadow.hpp"

#include "shared/bindings.h"
#include "shared/sun_cascades.h"

#include <vector>

namespace lucerna {

SunShadow::SunShadow(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings)
    : settings_(settings) {
  const int count = settings.cascades.cascades;
  if (count == 1) {
    map_.emplace(programs, scene, ShadowMap::Settings{settings.size});
    return;
  }
  cascades_.emplace(programs, scene, "sun cascades",
                    LayeredDepth::Shape{gl::TextureKind::array, settings.size, count, count, false, true});
  constants_ = gl::Buffer("sun cascades", sizeof(shared::SunCascadeConstants), nullptr, gl::Usage::dynamicDraw);
}

void SunShadow::record(const GpuScene& gpuScene, const SunFrustum& whole, const Camera& camera, double aspect,
                       double near) {
  if (map_) {
    map_->record(gpuScene, glm::mat4(whole.clipFromWorld));
    return;
  }
  const Scene& scene = gpuScene.scene();
  shared::SunCascadeConstants constants{};
  std::vector<LayeredDepth::View> views;
  for (const SunCascade& cascade : placeSunCascades(settings_.cascades, scene, scene.sun->direction, whole, camera,
                                                    aspect, near, cascades_->size())) {
    constants.clipFromWorld[views.size()] = glm::mat4(cascade.clipFromWorld);
    constants.normalOffset[static_cast<int>(views.size())] = normalOffset(cascade.texel);
    views.push_back({glm::mat4(cascade.clipFromWorld), glm::vec3(0.0f)});
  }
  constants_.upload(0, sizeof constants, &constants);
  constants_.bindUniform(BLOCK_SUN_CASCADES);
  cascades_->record(gpuScene, views);
}

void SunShadow::forget() {
  if (map_) map_->forget();
  if (cascades_) cascades_->forget();
}

void SunShadow::bindForShading() const {
  depth().bind(UNIT_SUN_SHADOW);
  if (cascades_) constants_.bindUniform(BLOCK_SUN_CASCADES);
}

float SunShadow::normalOffset(double texel) {
  constexpr float kTexels = 0.03f;
  return kTexels * static_cast<float>(texel);
}

std::size_t SunShadow::gpuBytes() const {
  return cascades_ ? cascades_->gpuBytes() + constants_.bytes() : map_->gpuBytes();
}

}  // namespace lucerna
