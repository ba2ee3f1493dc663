// The sun's shadow map: depth only, sized independently of the reflective shadow map, so shadows stay sharp
// [LPV2015, 6.3.1].
#pragma once

#include "forward/depth_target.hpp"

namespace lucerna {

class ShadowMap {
 public:
  struct Settings {
    int size = 2048;  ///< texels per side
  };
  static bool isNeeded(const SceneFeatures& features) { return features.directionalLight; }

  ShadowMap(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings);

  /// Draws into it what has changed since the last time; the frame's uniform block, with this view, must be bound.
  void record(const GpuScene& scene, const glm::mat4& clipFromWorld);
  void forget() { target_.forget(); }
  /// Depth in [0,1], comparison on: a sampler2DShadow.
  const gl::Texture& depth() const { return target_.depth(); }
  std::size_t gpuBytes() const { return depth().bytes() + target_.keptBytes(); }

 private:
  SurfacePrograms programs_;
  DepthTarget target_;
};

}  // namespace lucerna
