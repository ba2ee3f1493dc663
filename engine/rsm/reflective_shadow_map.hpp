// Reflective shadow map of the sun [Dachsbacher2005]: what the light sees, each texel a virtual point light.
// See README.md in this folder for inputs, outputs, units and sources.
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/pass.hpp"

namespace lucerna {

class ReflectiveShadowMap {
 public:
  struct Settings {
    int size = 256;  ///< texels a side
    bool fluxCosine = false;  ///< deviation rsm.flux-cosine: flux times N.L
  };
  struct Outputs {
    const gl::Texture& position;  ///< RGBA32F, world; w = 1 where there is a surface, 0 background
    const gl::Texture& normal;    ///< RGBA16F, unit, on the light's side; w = cosine to the light
    const gl::Texture& flux;      ///< RGBA32F, reflected flux of the texel: E * albedo * texelArea, W
    float texelArea;              ///< scene units squared, across the rays
  };
  /// Needed by techniques that light the scene indirectly: something must reflect a light.
  static bool isNeeded(const SceneNeeds& needs) { return needs.directionalLight && needs.indirect; }

  ReflectiveShadowMap(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings);

  /// Draws the scene into it; the frame's uniform block must be bound. texelArea: SunFrustum::texelArea(size).
  Outputs record(const GpuScene& scene, double texelArea);
  int size() const { return position_.size().x; }
  std::size_t gpuBytes() const { return position_.bytes() + normal_.bytes() + flux_.bytes() + depth_.bytes(); }

 private:
  SurfacePrograms programs_;
  gl::Texture position_, normal_, flux_, depth_;
  gl::Framebuffer framebuffer_;
};

}  // namespace lucerna
