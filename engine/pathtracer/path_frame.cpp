#include "pathtracer/path_frame.hpp"

#include "gl/pass.hpp"
#include "pathtracer/inspect_paths.hpp"

#include <algorithm>

namespace lucerna {

namespace {

PathTracer::Settings tracerSettings(const RenderSettings& settings) {
  PathTracer::Settings tracer;
  tracer.size = settings.size;
  tracer.filter = settings.filter;
  tracer.transport = transportOf(settings.component);
  const auto& path = settings.of<PathSettings>();
  tracer.bounces = path.scatterings;
  tracer.seed = path.seed;
  tracer.deviations = path.deviations;
  return tracer;
}

}  // namespace

PathFrame::PathFrame(const FrameParts& parts)
    : parts_(parts),
      tracer_(parts.context, parts.programs, parts.scene, tracerSettings(parts.settings)),
      film_(&parts.programs.loadRaster("film", "lib/fullscreen.vert", "pathtracer/film.frag")) {}

void PathFrame::resize() {
  tracer_.resize(parts_.settings.size);
  hasView_ = false;
}

void PathFrame::recordPicture(gl::TimeQuery& timer, const Camera& camera, FrameEffort effort) {
  const bool isNew = !hasView_ || !camera.seesAs(camera_);
  if (isNew) tracer_.setCamera(camera);
  camera_ = camera;
  hasView_ = true;
  {
    const gl::TimeQuery::Scope stage(timer, "path tracing");
    if (effort.wholePicture) tracer_.record(settings().samples);
    else if (isNew) tracer_.record(std::min(settings().leastSamples, settings().samples));
    else tracer_.advance(settings().samples);
    settled_ = tracer_.samples() >= settings().samples;
  }
  // In the middle of a tile's pass only short paths have ended, so the previous picture stays.
  if (!tracer_.isBetweenTiles()) return;
  const gl::TimeQuery::Scope stage(timer, "film");
  const gl::RasterPass pass("film", parts_.radianceTarget, {});
  film_->use();
  tracer_.bindMean(0);
  gl::drawFullScreen(parts_.noAttributes);
}

PixelInspection PathFrame::inspect(const Camera& camera, glm::ivec2 pixel) {
  constexpr std::uint32_t kMostSamples = 4096;
  const std::uint32_t samples = tracer_.samples() > 0 ? tracer_.samples() : settings().samples;
  return inspectPaths(parts_.context, parts_.programs, parts_.scene, camera, tracer_.settings(),
                      std::min(samples, kMostSamples), pixel);
}

}  // namespace lucerna
