// What is kept of the window: pictures with a note on how they were made, videos, a frame for RenderDoc.
#pragma once

#include "gl/objects.hpp"
#include "walk/renderdoc.hpp"
#include "walk/state.hpp"
#include "walk/video.hpp"

#include <optional>

namespace lucerna::demo {

class Recorder {
 public:
  /// The presented picture.
  struct Shown {
    const gl::Texture& picture;
    glm::ivec2 view;  ///< the window without the panel
  };
  explicit Recorder(WalkState& state);

  void takeShot(const Shown& shown);
  /// Adds the picture to the video that is being recorded, or ends it; seconds: for which it is shown.
  void record(const Shown& shown, double seconds);
  bool isRecording() const { return video_.has_value(); }
  void beginCapture(bool isRequested);
  void endCapture();

 private:
  WalkState& state_;
  std::optional<Video> video_;
  std::optional<RenderDoc> renderDoc_;
  bool captures_ = false;  ///< in this frame
};

}  // namespace lucerna::demo
