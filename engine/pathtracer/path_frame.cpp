#include "pathtracer/path_frame.hpp"

#include "gl/pass.hpp"
#include "pathtracer/inspect_paths.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace lucerna {

namespace {

/// Of a view at rest: with so many, earlier frames are no longer shown.
constexpr std::uint32_t kMostSamples = 16;

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
      film_(&parts.programs.loadRaster("film", "lib/fullscreen.vert", "pathtracer/film.frag",
                                       {{"DENOISED", tracerSettings(parts.settings).halves}})),
      chunks_(parts.settings.unmeasuredIterations),
      earlier_(parts.programs) {
  earlier_.resize(parts.settings.size);
  makeTracer();
}

void PathFrame::makeTracer() {
  denoiser_.reset();
  tracer_.emplace(parts_.context, parts_.programs, parts_.scene, tracerSettings(parts_.settings));
  if (tracer_->settings().halves) denoiser_.emplace(parts_.programs, *tracer_);
  hasView_ = false;
}

void PathFrame::resize() {
  tracer_->resize(parts_.settings.size);
  if (denoiser_) denoiser_->forget();
  firstHits_.reset();
  earlier_.resize(parts_.settings.size);
  forget();
}

void PathFrame::forget() { hasView_ = isShown_ = showsEarlier_ = false; }

bool PathFrame::follow(const SceneChange&) {
  if (hasView_ && isShown_ && parts_.settings.reprojection) keepShown();
  makeTracer();
  sceneMoves_ = true;
  return true;
}

void PathFrame::recordPicture(gl::TimeQuery& timer, const Camera& camera, FrameEffort effort) {
  const bool isOther = !hasView_ || !camera.seesAs(camera_);
  const bool moves = effort.isLive && isOther && isShown_ && parts_.settings.reprojection;
  if (moves && hasView_) {
    const gl::TimeQuery::Scope stage(timer, "first hits");
    keepShown();
  }
  const bool isNew = isOther || isOfMotion_;
  camera_ = camera;
  hasView_ = true;
  isShown_ = effort.isLive;
  {
    const gl::TimeQuery::Scope stage(timer, "path tracing");
    if (isNew) {
      tracer_->setCamera(camera);
      isOfMotion_ = moves;
      // Samples of frames in motion continue one another: with the same ones noise would stay where it is.
      if (moves) tracer_->setFirstSample(++motionFrame_ * settings().leastSamples);
      if (denoiser_) denoiser_->forget();
      denoisedSamples_ = 0;
    }
    if (effort.wholePicture) tracer_->record(settings().samples);
    else if (isNew) tracer_->record(std::min(settings().leastSamples, settings().samples));
    else tracer_->advance(settings().samples);
    settled_ = !isOfMotion_ && tracer_->samples() >= settings().samples;
  }
  // In the middle of a tile's pass only short paths have ended, so the previous picture stays.
  if (!tracer_->isBetweenTiles()) return;
  if (denoiser_) {
    const gl::TimeQuery::Scope stage(timer, "denoising");
    denoiseIfDue();
  }
  {
    const gl::TimeQuery::Scope stage(timer, "film");
    const gl::RasterPass pass("film", parts_.radianceTarget, {});
    film_->use();
    if (denoiser_) denoiser_->result().bind(0);
    else tracer_->bindMean(0);
    gl::drawFullScreen(parts_.noAttributes);
  }
  if (moves) {
    const gl::TimeQuery::Scope stage(timer, "first hits");
    drawFirstHits();
  }
  const bool stillShows = showsEarlier_ && !settled_ && tracer_->samples() < kMostSamples;
  showsEarlier_ = effort.isLive && parts_.settings.reprojection && (moves || stillShows);
  if (!showsEarlier_) return;
  const gl::TimeQuery::Scope stage(timer, "reprojection");
  showEarlier(moves);
}

// From the camera's place, without a far plane: mirrors show what lies beyond the scene.
glm::dmat4 PathFrame::clipFromCamera() const {
  const glm::dvec2 size(parts_.settings.size);
  const double aspect = size.x / size.y, half = camera_.halfHeight();
  const double diagonal = std::max(glm::length(parts_.scene.bounds.extent()), 1e-6);
  const double away = glm::length(camera_.position - parts_.scene.bounds.centre()) + diagonal;
  const glm::dmat4 clipFromView = camera_.isOrthographic()
                                      ? glm::ortho(-half * aspect, half * aspect, -half, half, 0.0, 4.0 * away)
                                      : glm::infinitePerspective(camera_.verticalFov, aspect, 1e-4 * diagonal);
  return clipFromView * glm::lookAt(glm::dvec3(0.0), camera_.direction, camera_.up);
}

void PathFrame::drawFirstHits() {
  constexpr int kGroup = 8;
  if (!firstHits_) {
    firstHits_.emplace();
    const RayScene& rays = tracer_->scene().rays();
    firstHits_->program = &parts_.programs.loadCompute(
        "first hits", "pathtracer/first_hits.comp",
        gl::with(tracer_->scene().flags(), {{"LINEAR_SEEDS", 0},
                                            {"GLOSSY", 0},
                                            {"SHARED_STACK", rays.sharedStack()},
                                            {"DIFFUSE_ONLY", tracer_->settings().diffuseOnly}}));
    firstHits_->constants = gl::Buffer("first hits", sizeof(shared::PathConstants), nullptr, gl::Usage::dynamicDraw);
    firstHits_->depth = gl::Texture("first hits", gl::Format::r32f, parts_.settings.size);
  }
  const shared::PathConstants& constants = tracer_->constants();
  firstHits_->constants.upload(0, sizeof constants, &constants);
  const gl::ComputePass pass("first hits", gl::Barrier::textureFetch);
  const gl::Program& program = *firstHits_->program;
  program.use();
  program.set("clipFromCamera", glm::mat4(clipFromCamera()));
  tracer_->scene().bind();
  firstHits_->constants.bindUniform(0);
  firstHits_->depth.bindImage(0, gl::Access::write);
  chunks_.forEach(parts_.settings.size, gl::kIterationsOfRay, kGroup, [&](glm::ivec2 corner, glm::ivec2 size) {
    program.set("firstPixel", corner);
    pass.dispatch(glm::ivec3(size, 1), glm::ivec3(kGroup, kGroup, 1));
  });
}

// Makes the picture at rest the first of the frames that are carried on.
void PathFrame::keepShown() {
  if (showsEarlier_) return;
  drawFirstHits();
  earlier_.forget();
  showEarlier(true);
  showsEarlier_ = true;
}

void PathFrame::showEarlier(bool moves) {
  const auto samples = static_cast<float>(tracer_->samples());
  const float share = moves ? 1.0f : std::max(0.0f, 1.0f - samples / static_cast<float>(kMostSamples));
  earlier_.accumulate({parts_.radiance, firstHits_->depth, glm::translate(clipFromCamera(), -camera_.position),
                       camera_.position, glm::dvec2(0.0), std::exchange(sceneMoves_, false), samples, true, share},
                      moves, true, std::numeric_limits<int>::max(), parts_.noAttributes);
  earlier_.writeShown(parts_.radianceTarget, parts_.noAttributes);
}

std::size_t PathFrame::gpuBytes() const {
  return tracer_->gpuBytes() + (denoiser_ ? denoiser_->gpuBytes() : 0) + earlier_.gpuBytes() +
         (firstHits_ ? firstHits_->constants.bytes() + firstHits_->depth.bytes() : 0);
}

// Only whole passes: before the end of one, the halves' tiles have different numbers of samples.
void PathFrame::denoiseIfDue() {
  const std::uint32_t samples = tracer_->samples();
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
  constexpr std::uint32_t kMostInspected = 4096;
  const std::uint32_t samples = tracer_->samples() > 0 ? tracer_->samples() : settings().samples;
  return inspectPaths(parts_.context, parts_.programs, parts_.scene, camera, tracer_->settings(),
                      std::min(samples, kMostInspected), pixel);
}

}  // namespace lucerna
