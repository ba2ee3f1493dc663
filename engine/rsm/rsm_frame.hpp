// Technique rsm in the frame: every light's reflective shadow map gathered at visible pixels.
//
// Stages, with their inputs: rsm (lights, geometry) -> geometry (camera) -> gather low, interpolation (both) -> gather
// full.
#pragma once

#include "forward/visible_surfaces.hpp"
#include "frame/technique.hpp"
#include "rsm/light_maps.hpp"
#include "rsm/rsm_gather.hpp"

namespace lucerna {

class RsmFrame final : public FrameTechnique {
 public:
  explicit RsmFrame(const FrameParts& parts);

  std::string surfaceShader() const override { return "rsm/surface.frag"; }
  gl::ShaderFlags surfaceFlags() const override { return {{"SHOW_REFUSED", gather_.settings().showRefused}}; }
  void resize() override;
  bool follow(const SceneChange&) override { return maps_.follow(); }

  /// Also draws depth.
  bool record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort) override;
  void bindForShading() const override;
  void collect(bool wait) override { gather_.collect(wait); }
  void forget() override { maps_.forget(); }

  void addShares(const InspectedPixel& pixel, PixelInspection& answer) override;
  void addStagePictures(std::vector<StagePicture>& pictures) const override;
  std::string summary() const override;
  double largestIterations() const override { return gather_.largestIterations(); }
  std::size_t gpuBytes() const override { return maps_.gpuBytes() + visible_.gpuBytes() + gather_.gpuBytes(); }

  const RsmGather& gather() const { return gather_; }

 private:
  RsmGather::Inputs inputsOf(gl::TimeQuery& timer, const FrameView& view);
  FrameParts parts_;
  LightMaps maps_;
  VisibleSurfaces visible_;
  RsmGather gather_;
};

/// Null if the technique is another.
inline const RsmGather* gatherOf(const FrameTechnique* technique) {
  const auto* frame = dynamic_cast<const RsmFrame*>(technique);
  return frame ? &frame->gather() : nullptr;
}

}  // namespace lucerna
