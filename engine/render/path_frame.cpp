#include "render/path_frame.hpp"

#include "gl/pass.hpp"

#include <algorithm>

namespace lucerna {

namespace {

PathTracer::Settings tracerSettings(const RenderSettings& settings) {
  PathTracer::Settings tracer;
  tracer.size = settings.size;
  tracer.transport = transportOf(settings.component);
  tracer.bounces = settings.path.scatterings;
  tracer.seed = settings.path.seed;
  tracer.deviations = settings.path.deviations;
  return tracer;
}

bool isSameView(const Camera& a, const Camera& b) {
  return a.position == b.position && a.direction == b.direction && a.up == b.up && a.verticalFov == b.verticalFov;
}

}  // namespace

PathFrame::PathFrame(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                     const RenderSettings& settings)
    : settings_(settings),
      tracer_(context, programs, scene, tracerSettings(settings)),
      film_(&programs.loadRaster("film", "lib/fullscreen.vert", "pathtracer/film.frag")) {}

void PathFrame::resize(glm::ivec2 size) {
  tracer_.resize(size);
  hasView_ = false;
}

void PathFrame::record(gl::TimeQuery& timer, const Camera& camera, const gl::Framebuffer& target,
                       const gl::VertexArray& noAttributes, bool wholePicture) {
  const bool isNew = !hasView_ || !isSameView(camera, camera_);
  if (isNew) tracer_.setCamera(camera);
  camera_ = camera;
  hasView_ = true;
  {
    const gl::TimeQuery::Scope stage(timer, "path tracing");
    if (wholePicture) tracer_.record(settings_.path.samples);
    else if (isNew) tracer_.record(std::min(settings_.path.leastSamples, settings_.path.samples));
    else tracer_.advance(settings_.path.samples);
    settled_ = tracer_.samples() >= settings_.path.samples;
  }
  // In the middle of a tile's pass only short paths have ended, so the previous picture stays.
  if (!tracer_.isBetweenTiles()) return;
  const gl::TimeQuery::Scope stage(timer, "film");
  const gl::RasterPass pass("film", target, {});
  film_->use();
  tracer_.bindMean(0);
  gl::drawFullScreen(noAttributes);
}

}  // namespace lucerna
