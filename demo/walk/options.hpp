// What `lucerna walk` was asked for.
#pragma once

#include "commands.hpp"

#include <string>

namespace lucerna::demo {

struct WalkOptions {
  CommonOptions common;
  PictureOptions picture;
  std::string scene, keys, record, views, playInput, shots = ".", panel = "auto";
  bool flicker = false;
  int frames = 0;  ///< 0: 12 when recording, the whole path in a window
};

}  // namespace lucerna::demo
