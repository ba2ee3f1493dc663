// Technique path in the frame: a path traced picture that improves while the view stands still, shown with the frame's
// tone mapping.
//
// Stages, with their inputs: path tracing (scene, camera) -> film (the means so far). Nothing else is drawn: no shadow
// maps, no depth.
#pragma once

#include "gl/time_query.hpp"
#include "pathtracer/path_tracer.hpp"
#include "settings/render_settings.hpp"

namespace lucerna {

class PathFrame {
 public:
  /// `settings`: the frame's, which outlive it.
  PathFrame(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
            const RenderSettings& settings);
  void resize(glm::ivec2 size);

  /// `camera`: in the scene's coordinates. A new view gets PathSettings::leastSamples in each pixel at once, an
  /// unchanged view one more submission. `wholePicture`: all samples at once.
  void record(gl::TimeQuery& timer, const Camera& camera, const gl::Framebuffer& target,
              const gl::VertexArray& noAttributes, bool wholePicture);
  void forget() { hasView_ = false; }
  bool isSettled() const { return settled_; }

  const PathTracer& tracer() const { return tracer_; }
  std::size_t gpuBytes() const { return tracer_.gpuBytes(); }

 private:
  const RenderSettings& settings_;
  PathTracer tracer_;
  const gl::Program* film_;
  Camera camera_;  ///< of the film
  bool hasView_ = false, settled_ = false;
};

}  // namespace lucerna
