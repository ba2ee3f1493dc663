// The sun's shadow map: depth only, sized independently of the reflective shadow map, so shadows stay sharp
// [LPV2015, 6.3.1].
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/pass.hpp"

namespace lucerna {

class ShadowMap {
 public:
  struct Settings {
    int size = 2048;  ///< texels per side
  };
  static bool isNeeded(const SceneFeatures& features) { return features.directionalLight; }

  ShadowMap(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings);

  /// Draws the scene into it; the frame's uniform block must be bound.
  void record(const GpuScene& scene) const;
  /// Depth in [0,1], comparison on: a sampler2DShadow.
  const gl::Texture& depth() const { return depth_; }
  std::size_t gpuBytes() const { return depth_.bytes(); }

 private:
  SurfacePrograms programs_;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
};

}  // namespace lucerna
