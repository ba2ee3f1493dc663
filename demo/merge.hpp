// lucerna merge PART...: merges parts of a path traced picture's samples into one picture, and parts of frames, batches
// and rows into one folder (parts.hpp).
#pragma once

#include "command_line.hpp"

namespace lucerna::demo {

Work addMerge(Command app);

}  // namespace lucerna::demo
