// The reflective shadow maps of the lights whose reflected light a technique needs. They do not depend on the camera.
// While lights and geometry stand still they are drawn once (with frame.reuse=off in each frame).
#pragma once

#include "gl/time_query.hpp"
#include "frame/frame_parts.hpp"
#include "frame/stage_picture.hpp"
#include "rsm/reflective_shadow_map.hpp"

#include <vector>

namespace lucerna {

class LightMaps {
 public:
  /// albedo: of the texels too, for several bounces.
  LightMaps(const FrameParts& parts, bool albedo);

  /// One per light: the sun, the spots, the omnidirectional lights. Stage: rsm, if they are drawn.
  const std::vector<ReflectiveShadowMap::Outputs>& record(gl::TimeQuery& timer);
  const std::vector<ReflectiveShadowMap::Outputs>& outputs() const { return outputs_; }
  bool willBeDrawn() const { return !(parts_.settings.reuse && made_); }
  /// Lights or geometry have changed. False: other maps are needed, since a lamp has left the scene, say.
  bool follow();
  void forget() { made_ = false; }
  std::size_t count() const { return maps_.size(); }
  void addStagePictures(std::vector<StagePicture>& pictures) const;
  std::size_t gpuBytes() const;

 private:
  FrameParts parts_;
  std::vector<ReflectiveShadowMap> maps_;
  std::vector<ReflectiveShadowMap::Outputs> outputs_;  ///< of the last drawing
  bool made_ = false;
};

}  // namespace lucerna
