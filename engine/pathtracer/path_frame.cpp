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
  tracer.halves = path.denoise;
  return tracer;
}

}  // namespace

PathFrame::PathFrame(const FrameParts& parts)
    : parts_(parts),
      tracer_(parts.context, parts.programs, parts.scene, tracerSettings(parts.settings)),
      film_(&parts.programs.loadRaster("film", "lib/fullscreen.vert", "pathtracer/film.frag",
                                       {{"DENOISED", tracer_.settings().halves}})) {
  if (tracer_.settings().halves) denoiser_.emplace(parts.programs, tracer_);
}

void PathFrame::resize() {
  tracer_.resize(parts_.settings.size);
  if (denoiser_) denoiser_->forget();
  hasView_ = false;
}

void PathFrame::recordPicture(gl::TimeQuery& timer, const Camera& camera, FrameEffort effort) {
  const bool isNew = !hasView_ || !camera.seesAs(camera_);
  if (isNew) {
    tracer_.setCamera(camera);
    if (denoiser_) denoiser_->forget();
    denoisedSamples_ = 0;
  }
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
  if (denoiser_) {
    const gl::TimeQuery::Scope stage(timer, "denoising");
    denoiseIfDue();
  }
  const gl::TimeQuery::Scope stage(timer, "film");
  const gl::RasterPass pass("film", parts_.radianceTarget, {});
  film_->use();
  if (denoiser_) denoiser_->result().bind(0);
  else tracer_.bindMean(0);
  gl::drawFullScreen(parts_.noAttributes);
}

// Only whole passes: before the end of one, the halves' tiles have different numbers of samples.
void PathFrame::denoiseIfDue() {
  const std::uint32_t samples = tracer_.samples();
  if (samples < (settled_ ? denoisedSamples_ + 1 : std::max(2 * denoisedSamples_, 1u))) return;
  denoiser_->denoise();
  denoisedSamples_ = samples;
  denoisedError_.reset();
}

const DenoisedError& PathFrame::denoisedError() const {
  if (!denoisedError_) denoisedError_ = denoisedSamples_ > 0 ? denoiser_->error() : DenoisedError{};
  return *denoisedError_;
}

PixelInspection PathFrame::inspect(const Camera& camera, glm::ivec2 pixel) {
  constexpr std::uint32_t kMostSamples = 4096;
  const std::uint32_t samples = tracer_.samples() > 0 ? tracer_.samples() : settings().samples;
  return inspectPaths(parts_.context, parts_.programs, parts_.scene, camera, tracer_.settings(),
                      std::min(samples, kMostSamples), pixel);
}

}  // namespace lucerna
