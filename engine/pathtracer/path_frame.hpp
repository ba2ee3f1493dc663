// Technique path in the frame: a path traced picture that improves while the view stands still, shown with the frame's
// tone mapping.
//
// Stages, with their inputs: path tracing (scene, camera) -> film (the means so far). Nothing else is drawn: no shadow
// maps, no depth.
#pragma once

#include "frame/technique.hpp"
#include "pathtracer/path_tracer.hpp"

namespace lucerna {

class PathFrame final : public PictureTechnique {
 public:
  explicit PathFrame(const FrameParts& parts);
  void resize() override;

  /// A new view gets PathSettings::leastSamples in each pixel at once, an unchanged view one more submission.
  void recordPicture(gl::TimeQuery& timer, const Camera& camera, FrameEffort effort) override;
  void forget() override { hasView_ = false; }
  bool isSettled() const override { return settled_; }
  PixelInspection inspect(const Camera& camera, glm::ivec2 pixel) override;
  std::size_t gpuBytes() const override { return tracer_.gpuBytes(); }

  const PathTracer& tracer() const { return tracer_; }

 private:
  const PathSettings& settings() const { return parts_.settings.of<PathSettings>(); }

  FrameParts parts_;
  PathTracer tracer_;
  const gl::Program* film_;
  Camera camera_;  ///< of the film
  bool hasView_ = false, settled_ = false;
};

/// Null if the technique is another.
inline const PathTracer* pathOf(const FrameTechnique* technique) {
  const auto* frame = dynamic_cast<const PathFrame*>(technique);
  return frame ? &frame->tracer() : nullptr;
}

}  // namespace lucerna
