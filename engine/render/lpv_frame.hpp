// Technique lpv in the frame: light injected from the lights' maps, propagated through nested
// grids, looked up in shading.
//
// Stages, with their inputs: rsm (lights, geometry) -> camera surfels (camera; if lpv.blocking requires them) ->
// injection, geometry volume, propagation (maps, placement of the cascades). They run again if a grid has moved, or if
// surfels come from the camera.
#pragma once

#include "lpv/glossy_lobes.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "render/light_maps.hpp"

#include <optional>
#include <string>
#include <vector>

namespace lucerna {

class LpvFrame {
 public:
  static bool isNeeded(const RenderSettings& settings, const SceneFeatures& features) {
    return settings.technique == Technique::lpv && settings.component != Component::direct &&
           LightPropagationVolume::isNeeded(features);
  }
  explicit LpvFrame(const FrameParts& parts);

  void record(gl::TimeQuery& timer, const FrameView& view);
  void forget();

  /// Flags of shaders/forward/indirect.glsl, and its inputs.
  gl::ShaderFlags shadingFlags() const;
  void bindForShading() const {
    volume_.bindForLookup();
    if (lobes_) lobes_->bind();
  }

  const LightPropagationVolume& volume() const { return volume_; }
  /// Estimated iterations of the largest submission (gl/chunks.hpp): filling from a map, or a step of propagation.
  static double largestIterations(const RenderSettings& settings, bool hasPoints);
  double largestIterations() const { return largestIterations(parts_.settings, !parts_.points.empty()); }
  bool hasMaps() const { return maps_.count() > 0; }
  bool isGlossy() const { return lobes_.has_value(); }
  void addStagePictures(std::vector<StagePicture>& pictures) const;
  void addLeftOut(std::vector<std::string>& names) const;
  std::size_t gpuBytes() const {
    return maps_.gpuBytes() + volume_.gpuBytes() + (cameraMap_ ? cameraMap_->gpuBytes() : 0) +
           (lobes_ ? lobes_->gpuBytes() : 0);
  }

 private:
  std::vector<ReflectiveShadowMap::Outputs> recordCameraMap(gl::TimeQuery& timer,
                                                            const Camera& camera);  ///< empty if not needed

  FrameParts parts_;
  LightMaps maps_;
  std::optional<ReflectiveShadowMap> cameraMap_;  ///< the camera's view, for the geometry volume
  LightPropagationVolume volume_;
  std::optional<GlossyLobes> lobes_;  ///< if lpv.glossy is asked for and a material of the scene is glossy
  std::vector<shared::CascadeGrid> cascades_;  ///< those of the propagated light
};

}  // namespace lucerna
