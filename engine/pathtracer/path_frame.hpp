// Technique path in the frame: a path traced picture that improves while the view stands still, shown with the frame's
// tone mapping.
//
// Stages, with their inputs: path tracing (scene, camera) -> film (the means so far). With path.denoise a stage lies
// between them: denoising (the film, what pixels show), whenever the samples have doubled and at the end. Nothing else
// is drawn: no shadow maps, no depth.
//
// While the view or the scene moves (picture.reprojection), samples of earlier frames are shown where they are found
// again by depth (forward/antialiasing): first hits -> reprojection. After that they fade out as the film fills. The
// film never holds them, and at rest begins with its first sample, as without motion.
#pragma once

#include "forward/antialiasing.hpp"
#include "frame/technique.hpp"
#include "gl/picture_chunks.hpp"
#include "pathtracer/denoiser.hpp"
#include "pathtracer/path_tracer.hpp"

namespace lucerna {

class PathFrame final : public PictureTechnique {
 public:
  explicit PathFrame(const FrameParts& parts);
  void resize() override;

  /// A new view gets PathSettings::leastSamples in each pixel at once, an unchanged view one more submission.
  void recordPicture(gl::TimeQuery& timer, const Camera& camera, FrameEffort effort) override;
  bool follow(const SceneChange&) override;
  void forget() override;
  bool isSettled() const override { return settled_; }
  PixelInspection inspect(const Camera& camera, glm::ivec2 pixel) override;
  double largestIterations() const override { return chunks_.largestIterations(); }
  std::size_t gpuBytes() const override;

  const PathTracer& tracer() const { return *tracer_; }
  /// Samples per pixel of the denoised picture shown; 0: it is not denoised.
  std::uint32_t denoisedSamples() const { return denoisedSamples_; }
  const DenoisedError& denoisedError() const;  ///< of that picture

 private:
  const PathSettings& settings() const { return parts_.settings.of<PathSettings>(); }

  void makeTracer();
  void denoiseIfDue();
  glm::dmat4 clipFromCamera() const;
  void drawFirstHits();
  void keepShown();
  void showEarlier(bool moves);

  FrameParts parts_;
  std::optional<PathTracer> tracer_;  ///< of the scene as it is; always set after construction
  std::optional<Denoiser> denoiser_;  ///< with path.denoise
  std::uint32_t denoisedSamples_ = 0;
  mutable std::optional<DenoisedError> denoisedError_;  ///< once asked for
  const gl::Program* film_;
  Camera camera_;  ///< of the film, and of the picture shown
  bool hasView_ = false, settled_ = false;

  // Motion.
  struct FirstHits {
    const gl::Program* program;
    gl::Buffer constants;
    gl::Texture depth;  ///< in clip space
  };
  std::optional<FirstHits> firstHits_;  ///< once anything has moved
  gl::PictureChunks chunks_;
  Antialiasing earlier_;
  std::uint32_t motionFrame_ = 0;
  bool isShown_ = false;  ///< a frame of a sequence is
  bool isOfMotion_ = false;  ///< the film is: it has other samples than that of a view at rest
  bool showsEarlier_ = false;  ///< the picture shown does: it is the last of earlier_
  bool sceneMoves_ = false;  ///< since the last frame
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
