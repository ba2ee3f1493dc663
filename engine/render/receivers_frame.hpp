// Technique lpv with transport gather or rays in the frame: irradiance stored at surface points, chosen by camera and
// grids.
//
// Stages, with their inputs: rsm (lights, geometry; only for gather) -> geometry (camera) -> receivers (maps, visible
// surfaces, placement of the cascades). A view whose receivers have all their paths needs no work.
#pragma once

#include "forward/visible_surfaces.hpp"
#include "lpv/receivers.hpp"
#include "render/light_maps.hpp"

#include <optional>

namespace lucerna {

class ReceiversFrame {
 public:
  static bool isNeeded(const RenderSettings& settings, const SceneNeeds& needs);
  /// Whether they gather light from the lights' maps.
  static bool takesMaps(const RenderSettings& settings, const SceneNeeds& needs) {
    return isNeeded(settings, needs) && settings.lpv.transport == LpvTransport::gather &&
           settings.component != Component::direct;
  }
  /// `depth`: the frame's, of the picture's size.
  ReceiversFrame(const FrameParts& parts, const gl::Texture& depth);
  void resize(const gl::Texture& depth);

  /// Returns whether depth was drawn.
  bool record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort);
  void forget();
  void collect(bool wait = false) { receivers_.collect(wait); }
  /// Whether another frame of the same view would look the same.
  bool isSettled() const { return settled_; }

  /// Flags of shaders/forward/indirect.glsl, and its inputs.
  gl::ShaderFlags shadingFlags() const;
  void bindForShading() const { receivers_.bindForLookup(); }

  bool hasMaps() const { return maps_ && maps_->count() > 0; }
  const LpvReceivers& receivers() const { return receivers_; }
  /// Floors of the last view (LpvReceivers). The first: only with LpvTransport::gather.
  Image gatheredAtPixels() const {
    return receivers_.gatheredAtPixels(maps_ ? maps_->outputs() : std::vector<ReflectiveShadowMap::Outputs>{});
  }
  Image readFromCells(int paths) const;
  double largestTurns() const { return receivers_.mostTurns(); }
  void addStagePictures(std::vector<StagePicture>& pictures) const {
    if (maps_) maps_->addStagePictures(pictures);
    pictures.push_back({StagePicture::Kind::normal, "normals", &visible_.normal()});
    pictures.push_back({StagePicture::Kind::irradiance, "lpv receivers", &receivers_.irradiance()});
  }
  std::size_t gpuBytes() const { return (maps_ ? maps_->gpuBytes() : 0) + visible_.gpuBytes() + receivers_.gpuBytes(); }

 private:
  FrameParts parts_;
  std::optional<LightMaps> maps_;  ///< if they use maps
  VisibleSurfaces visible_;
  LpvReceivers receivers_;
  /// The view for which they were last updated, the frame of its first update, and whether no work is left.
  glm::dmat4 clip_{0.0};
  glm::dvec3 volumePosition_{0.0}, volumeDirection_{0.0};
  std::uint32_t since_ = 0;
  bool settled_ = false;
};

}  // namespace lucerna
