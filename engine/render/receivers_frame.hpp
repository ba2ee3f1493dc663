// Technique lpv with transport gather or rays in the frame: irradiance kept at points of surfaces, which camera and
// grids choose.
//
// Stages, with their inputs: rsm (lights, geometry; gather alone) -> geometry (camera) -> receivers (maps, visible
// surfaces, placement of the cascades). Nothing is done for a view whose receivers have all their paths.
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

  /// Whether depth was drawn.
  bool record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort);
  void forget();
  void collect(bool wait = false) { receivers_.collect(wait); }
  /// Whether another frame of the same view would show the same.
  bool isSettled() const { return settled_; }

  /// Of shaders/forward/indirect.glsl, and what it reads.
  gl::ShaderFlags shadingFlags() const;
  void bindForShading() const { receivers_.bindForLookup(); }

  bool hasMaps() const { return maps_ && maps_->count() > 0; }
  const LpvReceivers& receivers() const { return receivers_; }
  void addStagePictures(std::vector<StagePicture>& pictures) const {
    if (maps_) maps_->addStagePictures(pictures);
    pictures.push_back({StagePicture::Kind::normal, "normals", &visible_.normal()});
    pictures.push_back({StagePicture::Kind::irradiance, "lpv receivers", &receivers_.irradiance()});
  }
  std::size_t gpuBytes() const { return (maps_ ? maps_->gpuBytes() : 0) + visible_.gpuBytes() + receivers_.gpuBytes(); }

 private:
  FrameParts parts_;
  std::optional<LightMaps> maps_;  ///< where they take them
  VisibleSurfaces visible_;
  LpvReceivers receivers_;
  /// The view that they were brought up to date for, since which frame, and whether nothing of it waits any more.
  glm::dmat4 clip_{0.0};
  glm::dvec3 volumePosition_{0.0}, volumeDirection_{0.0};
  std::uint32_t since_ = 0;
  bool settled_ = false;
};

}  // namespace lucerna
