#include "forward/antialiasing.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>

namespace lucerna {

namespace {
constexpr GLuint kRadianceUnit = 0, kDepthUnit = 1, kBeforeUnit = 2, kDistanceBeforeUnit = 3, kMotionUnit = 4;
// Frames in the mean. A mean is read anew in every frame, which blurs it: beyond four that costs more than what more
// samples give (docs/measurements/forward.md, Antialiasing). What is lit anew looked other before. Ten added 2 points
// to the error of assets/cornell/moving.json (llvmpipe, one run each: 9.0 % for 6.9 % without earlier frames), two
// nothing (6.8 %): bench dynamic --live --frames 8 --fps 20 --time 1 --size 160x120 --reference-samples 64,
// irradiance-cache.
constexpr float kMostInMotion = 4.0f, kMostWhereLightMoves = 2.0f;
// Of path traced frames, whose noise is more than the blur of eight (docs/motion.md).
constexpr float kMostPathsInMotion = 8.0f, kMostPathsWhereLightMoves = 4.0f;
}  // namespace

void Antialiasing::resize(glm::ivec2 size) {
  size_ = size;
  count_ = 0;
  sum_.reset();
  sumTarget_.reset();
  history_.reset();
  hasHistory_ = false;
}

void Antialiasing::forget() {
  count_ = 0;
  hasHistory_ = false;
}

void Antialiasing::add(const gl::Texture& radiance, const gl::VertexArray& noAttributes) {
  if (!sum_) {
    sum_.emplace("sum of frames", gl::Format::rgba32f, size_);
    sumTarget_.emplace("sum of frames", std::array<const gl::Texture*, 1>{&*sum_});
  }
  gl::RasterState state;
  if (count_ > 0) state.blend = gl::Blend::add;
  const gl::RasterPass pass("sum of frames", *sumTarget_, state);
  drawScaled(radiance, 1.0f, noAttributes);
  ++count_;
}

void Antialiasing::writeMean(const gl::Framebuffer& target, const gl::VertexArray& noAttributes) {
  CHECK(count_ > 0, "no frames");
  const gl::RasterPass pass("mean of frames", target, {});
  drawScaled(*sum_, 1.0f / static_cast<float>(count_), noAttributes);
}

void Antialiasing::writeShown(const gl::Framebuffer& target, const gl::VertexArray& noAttributes) {
  const gl::RasterPass pass("earlier frames", target, {});
  drawScaled(shown(), 1.0f, noAttributes);
}

void Antialiasing::drawScaled(const gl::Texture& from, float factor, const gl::VertexArray& noAttributes) {
  if (!scale_) scale_ = &programs_->loadRaster("scaled picture", "lib/fullscreen.vert", "forward/scale.frag");
  scale_->use();
  scale_->set("factor", factor);
  from.bind(kRadianceUnit);
  gl::drawFullScreen(noAttributes);
}

void Antialiasing::makeHistory() {
  history_.emplace();
  for (std::size_t i = 0; i < 2; ++i) {
    gl::Sampling linear;
    linear.minFilter = linear.magFilter = gl::Filter::linear;
    history_->radiance[i] = gl::Texture("frames so far", gl::Format::rgba32f, size_, linear);
    history_->distance[i] = gl::Texture("distances of frames so far", gl::Format::r32f, size_);
    const std::array<const gl::Texture*, 2> targets{&history_->radiance[i], &history_->distance[i]};
    history_->targets[i] = gl::Framebuffer("frames so far", targets);
  }
  history_->program =
      &programs_->loadRaster("reprojection", "lib/fullscreen.vert", "forward/reproject.frag", {{"OBJECTS_MOVE", 0}});
}

void Antialiasing::accumulate(const Frame& frame, bool moves, bool reprojects, int most,
                              const gl::VertexArray& noAttributes) {
  if (!history_) makeHistory();
  const std::size_t before = frame.isPathTraced && !moves ? atRest_ : current_;
  current_ = 1 - before;
  if (moves || !hasHistory_) atRest_ = current_;
  const bool starts = !hasHistory_ || (moves && !reprojects);
  const gl::RasterPass pass("reprojection", history_->targets[current_], {});
  if (frame.objectMotion && !history_->programOfMotion)
    history_->programOfMotion = &programs_->loadRaster("reprojection of objects", "lib/fullscreen.vert",
                                                       "forward/reproject.frag", {{"OBJECTS_MOVE", 1}});
  const gl::Program& program = frame.objectMotion ? *history_->programOfMotion : *history_->program;
  program.use();
  const glm::dmat4 worldFromClip =
      glm::inverse(frame.clip) *
      glm::translate(glm::dmat4(1.0), glm::dvec3(2.0 * frame.offset / glm::dvec2(size_), 0.0));
  glm::dmat4 directions = glm::translate(glm::dmat4(1.0), -frame.camera);  // from there, without a place
  directions = glm::dmat4(1.0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0) * directions;
  program.set("beforeFromClip", glm::mat4(clip_ * worldFromClip));
  program.set("beforeFromFar", glm::mat4(clip_ * directions * worldFromClip));
  program.set("inverseDistance", glm::vec4(glm::transpose(worldFromClip)[3]));
  program.set("offset", glm::vec2(frame.offset));
  program.set("moves", moves ? 1 : 0);
  program.set("starts", starts ? 1 : 0);
  program.set("most", static_cast<float>(std::max(most, 1)));
  program.set("frames", frame.frames);
  program.set("share", frame.share);
  program.set("isPathTraced", frame.isPathTraced ? 1 : 0);
  const float mostFrames = frame.isPathTraced ? frame.lightMoves ? kMostPathsWhereLightMoves : kMostPathsInMotion
                           : frame.lightMoves ? kMostWhereLightMoves
                                              : kMostInMotion;
  program.set("mostInMotion", frame.frames * mostFrames);
  frame.radiance.bind(kRadianceUnit);
  frame.depth.bind(kDepthUnit);
  history_->radiance[before].bind(kBeforeUnit);
  history_->distance[before].bind(kDistanceBeforeUnit);
  if (frame.objectMotion) frame.objectMotion->bind(kMotionUnit);
  gl::drawFullScreen(noAttributes);
  clip_ = frame.clip;
  hasHistory_ = true;
}

std::size_t Antialiasing::gpuBytes() const {
  std::size_t bytes = sum_ ? sum_->bytes() : 0;
  if (history_)
    for (std::size_t i = 0; i < 2; ++i) bytes += history_->radiance[i].bytes() + history_->distance[i].bytes();
  return bytes;
}

}  // namespace lucerna
