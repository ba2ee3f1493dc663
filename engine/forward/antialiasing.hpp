// Smooth edges from frames of one view, each drawn for another point of every pixel (base/pixel_filter.hpp).
//
// Still: the frames' plain mean, which converges to the filtered picture. Moving: the mean so far is found in the frame
// before by the visible surface's place, also that of an object that moves (object_motion.hpp), and limited to what the
// new frame shows around the pixel, by mean and standard deviation [Salvi2016]; where another surface was seen before,
// it is dropped. A path traced picture in motion is carried on in the same way, without that limit. Pictures are linear
// radiance, in scene units.
#pragma once

#include "gl/objects.hpp"
#include "gl/program.hpp"

#include <glm/glm.hpp>

#include <array>
#include <optional>

namespace lucerna {

class Antialiasing {
 public:
  explicit Antialiasing(gl::ProgramLibrary& programs) : programs_(&programs) {}
  void resize(glm::ivec2 size);

  // The plain mean.
  void clear() { count_ = 0; }
  void add(const gl::Texture& radiance, const gl::VertexArray& noAttributes);
  int count() const { return count_; }
  void writeMean(const gl::Framebuffer& target, const gl::VertexArray& noAttributes);

  /// What a view in motion has to know of a frame.
  struct Frame {
    const gl::Texture& radiance;
    const gl::Texture& depth;
    glm::dmat4 clip;  ///< from world, through the pixels' centres
    glm::dvec3 camera;
    glm::dvec2 offset;  ///< of the frame's samples from there, in pixels
    bool lightMoves;  ///< lights are others than in the frame before, or surfaces whose motion is not known
    float frames = 1.0f;  ///< that `radiance` is the mean of
    /// Its noise would be taken for another surface's colours, and is not limited. At rest `radiance` is the mean since
    /// the motion's end, and `share` of the frames shown then counts beside it.
    bool isPathTraced = false;
    float share = 1.0f;
    const gl::Texture* objectMotion = nullptr;  ///< ObjectMotion::texture(), if anything has moved
  };
  /// Adds a frame to the running mean of at most `most` frames; the first one alone starts it. `moves`: the view
  /// differs from that of the frame before. `reprojects`: if not, a moving view shows its new frame alone.
  void accumulate(const Frame& frame, bool moves, bool reprojects, int most, const gl::VertexArray& noAttributes);
  bool hasShown() const { return history_.has_value(); }
  /// That of the last frame of accumulate().
  const glm::dmat4& clipBefore() const { return clip_; }
  /// The running mean; alpha: the number of frames in it.
  const gl::Texture& shown() const { return history_->radiance[current_]; }
  void writeShown(const gl::Framebuffer& target, const gl::VertexArray& noAttributes);
  void forget();

  std::size_t gpuBytes() const;

 private:
  struct History {
    std::array<gl::Texture, 2> radiance, distance;  ///< of this frame and the one before
    std::array<gl::Framebuffer, 2> targets;
    const gl::Program* program;
    const gl::Program* programOfMotion = nullptr;  ///< where objects move
  };
  void makeHistory();
  void drawScaled(const gl::Texture& from, float factor, const gl::VertexArray& noAttributes);

  gl::ProgramLibrary* programs_;
  glm::ivec2 size_{0};
  int count_ = 0;
  std::optional<gl::Texture> sum_;
  std::optional<gl::Framebuffer> sumTarget_;
  const gl::Program* scale_ = nullptr;
  std::optional<History> history_;  ///< only where frames are shown one by one
  std::size_t current_ = 0, atRest_ = 0;  ///< of history_; atRest_: as it was shown last in motion
  bool hasHistory_ = false;
  glm::dmat4 clip_{1.0};
};

}  // namespace lucerna
