// Reflective shadow map of a light [Dachsbacher2005]: the surfaces that the light sees, each texel a virtual point
// light. One map per light: of the sun, of a spot light, or of an omnidirectional light with its six faces drawn in one
// pass.
#pragma once

#include "forward/gpu_scene.hpp"
#include "forward/light_views.hpp"
#include "forward/sun_frustum.hpp"
#include "gl/pass.hpp"
#include "shared/bindings.h"

#include <optional>

namespace lucerna {

class ReflectiveShadowMap {
 public:
  enum class Light { sun, spot, point };
  struct Settings {
    int size = 256;  ///< texels per side of every layer
    Light light = Light::sun;
    bool fluxCosine = false;  ///< deviation rsm.flux-cosine: flux times N.L
    bool albedo = false;  ///< a fourth target, for several bounces
    bool haze = false;  ///< sunlight is attenuated by the bound medium (lpv/light_shafts.hpp)
  };
  /// 2D arrays: one layer, or the six faces of an omnidirectional light.
  struct Outputs {
    const gl::Texture& position;  ///< RGBA32F, world; w = 1 where there is a surface, 0 background
    const gl::Texture& normal;  ///< RGBA16F, unit, on the light's side; w = cosine to the light
    const gl::Texture&
        flux;  ///< RGBA32F, reflected flux of the texel, W; w = area of the surface in it, scene units squared
    float texelArea = 1.0f;  ///< sun: across the rays, scene units squared; other lights: 1. Only for deviations
    double largestFlux =
        0.0;  ///< of all texels together, W: the light's flux into the map, an upper bound for any albedo up to 1
    Light light = Light::sun;
    const gl::Texture* albedo = nullptr;  ///< RGBA16F, linear; null unless requested
    /// Texels of all layers.
    int texelCount() const { return position.size().x * position.size().y * position.size().z; }
    /// Binds to units 0, 1, 2 and, if there is an albedo, 3, where all readers of a map expect it.
    void bind() const {
      position.bind(UNIT_RSM_POSITION), normal.bind(UNIT_RSM_NORMAL), flux.bind(UNIT_RSM_FLUX);
      if (albedo) albedo->bind(UNIT_RSM_ALBEDO);
    }
  };
  /// Needed by techniques that light the scene indirectly: something must reflect a light.
  static bool isNeeded(const SceneFeatures& features) { return features.anyLight() && features.indirect; }

  ReflectiveShadowMap(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings);

  /// The sun's: draws the scene into it; the frame's uniform block with that frustum must be bound.
  Outputs record(const GpuScene& scene, const SunFrustum& sun);
  /// A spot's or an omnidirectional light's; the frame's uniform block is not read.
  Outputs record(const GpuScene& scene, const LightViews& light);
  int size() const { return position_.size().x; }
  Light light() const { return light_; }
  std::size_t gpuBytes() const {
    return position_.bytes() + normal_.bytes() + flux_.bytes() + albedo_.bytes() + depth_.bytes() +
           (covering_ ? covering_->gpuBytes() : 0);
  }

 private:
  void draw(const GpuScene& scene, bool depthClamp, const GpuScene::Selection* only);
  const gl::Texture* albedo() const { return albedo_.id() ? &albedo_ : nullptr; }
  Light light_;
  SurfacePrograms programs_;
  gl::Texture position_, normal_, flux_, albedo_, depth_;
  gl::Framebuffer framebuffer_;
  std::optional<GpuScene::Selection> covering_;  ///< of the sun's map, if worthwhile
  glm::mat4 coveredFrom_{0.0f};  ///< clipFromWorld for which it was made
};

}  // namespace lucerna
