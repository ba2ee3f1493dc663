// Technique path in the frame: a path traced picture that improves while the view stands still, shown with the frame's
// tone mapping.
//
// Stages, with their inputs: path tracing (scene, camera) -> film (the means so far). With path.denoise a stage lies
// between them: denoising (the film, what pixels show), whenever the samples have doubled and at the end. Nothing else
// is drawn: no shadow maps, no depth.
#pragma once

#include "frame/technique.hpp"
#include "pathtracer/denoiser.hpp"
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
  std::size_t gpuBytes() const override { return tracer_.gpuBytes() + (denoiser_ ? denoiser_->gpuBytes() : 0); }

  const PathTracer& tracer() const { return tracer_; }
  /// Samples per pixel of the denoised picture shown; 0: it is not denoised.
  std::uint32_t denoisedSamples() const { return denoisedSamples_; }
  const DenoisedError& denoisedError() const;  ///< of that picture

 private:
  const PathSettings& settings() const { return parts_.settings.of<PathSettings>(); }

  void denoiseIfDue();

  FrameParts parts_;
  PathTracer tracer_;
  std::optional<Denoiser> denoiser_;  ///< with path.denoise
  std::uint32_t denoisedSamples_ = 0;
  mutable std::optional<DenoisedError> denoisedError_;  ///< once asked for
  const gl::Program* film_;
  Camera camera_;  ///< of the film
  bool hasView_ = false, settled_ = false;
};

/// Null if the technique is another.
inline const PathFrame* pathFrameOf(const FrameTechnique* technique) {
  return dynamic_cast<const PathFrame*>(technique);
}
inline const PathTracer* pathOf(const FrameTechnique* technique) {
  const PathFrame* frame = pathFrameOf(technique);
  return frame ? &frame->tracer() : nullptr;
}

}  // namespace lucerna
