// Technique lpv in the frame: light injected from the lights' maps, propagated through nested grids, looked up in
// shading; light shafts over the finished picture.
//
// Stages, with their inputs: rsm (lights, geometry) -> camera surfels (camera; if lpv.blocking requires them) ->
// injection, geometry volume, propagation (maps, placement of the cascades) -> light shafts (the volume, the sun's
// shadow map, the picture). The volume's run again if a grid has moved, or if surfels come from the camera.
#pragma once

#include "frame/technique.hpp"
#include "lpv/glossy_lobes.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "lpv/light_shafts.hpp"
#include "rsm/light_maps.hpp"

#include <optional>
#include <string>
#include <vector>

namespace lucerna {

class LpvFrame final : public FrameTechnique {
 public:
  /// Without a volume there are shafts of the sun alone.
  static bool needsVolume(const RenderSettings& settings, const SceneFeatures& features);
  /// With shafts, maps of lights are attenuated by the scene's medium, whose boundary is not drawn.
  static void prepare(RenderSettings& settings, const Scene& scene);
  explicit LpvFrame(const FrameParts& parts);

  std::string surfaceShader() const override;
  gl::ShaderFlags surfaceFlags() const override;
  bool follow(const SceneChange& change) override;
  bool record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort) override;
  void bindForShading() const override;
  void addToPicture(gl::TimeQuery& timer, const FrameView& view) override;
  void forget() override;

  void addShares(const InspectedPixel& pixel, PixelInspection& answer) override;
  void addStagePictures(std::vector<StagePicture>& pictures) const override;
  void addLeftOut(std::vector<std::string>& names) const override;
  std::string summary() const override;
  /// Estimated iterations of the largest submission (gl/chunks.hpp): filling from a map, or a step of propagation.
  static double largestIterations(const RenderSettings& settings, bool hasPoints);
  double largestIterations() const override;
  double iterationsOfPixel() const override;
  std::size_t gpuBytes() const override;

  const LightPropagationVolume* volume() const { return volume_ ? &*volume_ : nullptr; }

 private:
  void addVolumeShares(const InspectedPixel& pixel, PixelInspection& answer);
  std::vector<ReflectiveShadowMap::Outputs> recordCameraMap(gl::TimeQuery& timer,
                                                            const Camera& camera);  ///< empty if not needed
  const LpvSettings& settings() const { return parts_.settings.of<LpvSettings>(); }

  FrameParts parts_;
  std::optional<LightMaps> maps_;  ///< these four: only with a volume
  std::optional<ReflectiveShadowMap> cameraMap_;  ///< the camera's view, for the geometry volume
  std::optional<LightPropagationVolume> volume_;
  std::optional<GlossyLobes> lobes_;  ///< if lpv.glossy is asked for and a material of the scene is glossy
  std::optional<LightShafts> shafts_;  ///< if lpv.shafts is asked for and the scene has a medium
  std::vector<shared::CascadeGrid> cascades_;  ///< those of the propagated light
};

/// Null if the technique is another, or has none.
inline const LightPropagationVolume* volumeOf(const FrameTechnique* technique) {
  const auto* frame = dynamic_cast<const LpvFrame*>(technique);
  return frame ? frame->volume() : nullptr;
}

}  // namespace lucerna
