// Technique rsm in the frame: every light's reflective shadow map gathered at visible pixels.
//
// Stages, with their inputs: rsm (lights, geometry) -> geometry (camera) -> gather low, interpolation (both) -> gather
// full.
#pragma once

#include "forward/visible_surfaces.hpp"
#include "render/light_maps.hpp"
#include "rsm/rsm_gather.hpp"

namespace lucerna {

class RsmFrame {
 public:
  static bool isNeeded(const RenderSettings& settings, const SceneFeatures& features) {
    return settings.technique == Technique::rsm && settings.component != Component::direct &&
           RsmGather::isNeeded(features);
  }
  /// `depth`: the frame's, of the picture's size.
  RsmFrame(const FrameParts& parts, const gl::Texture& depth);
  void resize(const gl::Texture& depth);

  /// Also draws depth.
  void record(gl::TimeQuery& timer, const FrameView& view);
  /// What it gathered for one pixel of the last frame, which must have had this view; pixels from the lower left.
  std::vector<AskedPart> ask(gl::TimeQuery& timer, const FrameView& view, glm::ivec2 pixel) {
    return gather_.ask(parts_.programs, inputsOf(timer, view), pixel);
  }
  void forget() { maps_.forget(); }
  void collect(bool wait = false) { gather_.collect(wait); }

  /// Flags of shaders/forward/indirect.glsl, and its inputs.
  bool showsRefused() const { return gather_.settings().showRefused; }
  gl::ShaderFlags shadingFlags() const { return {{"GATHERED", 1}, {"SHOW_REFUSED", gather_.settings().showRefused}}; }
  void bindForShading() const;

  const RsmGather& gather() const { return gather_; }
  double largestIterations() const { return gather_.largestIterations(); }
  void addStagePictures(std::vector<StagePicture>& pictures) const {
    maps_.addStagePictures(pictures);
    pictures.push_back({StagePicture::Kind::normal, "normals", &visible_.normal()});
  }
  std::size_t gpuBytes() const { return maps_.gpuBytes() + visible_.gpuBytes() + gather_.gpuBytes(); }

 private:
  RsmGather::Inputs inputsOf(gl::TimeQuery& timer, const FrameView& view);
  FrameParts parts_;
  LightMaps maps_;
  VisibleSurfaces visible_;
  RsmGather gather_;
};

}  // namespace lucerna
