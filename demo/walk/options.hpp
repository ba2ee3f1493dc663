// Options of `lucerna walk`.
#pragma once

#include "shared/commands.hpp"
#include "shared/parts.hpp"

#include <string>

namespace lucerna::demo {

struct WalkOptions {
  CommonOptions common;
  PictureOptions picture;
  PartOptions part;  ///< for recorded frames
  std::string scene, keys, record, views, playInput, shots = ".", panel = "auto";
  bool flicker = false, noFloor = false;
  /// Whether to render off-screen into files instead of a window.
  bool records() const { return !record.empty() || part.isPart() || !part.checkpoint.empty(); }
  int capture = -1;  ///< the frame that RenderDoc captures; negative: none
  // Of a scene that moves, with --record: frames a second of its time (0: they span it), and the first frame's time.
  double fps = 0.0, time = 0.0;
  int frames = 0;  ///< 0: 12 when recording, the whole path in a window
};

}  // namespace lucerna::demo
