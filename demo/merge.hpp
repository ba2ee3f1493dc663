// lucerna merge PART...: parts of a path traced picture's samples as one picture, parts of frames, batches and rows as
// one folder (parts.hpp).
#pragma once

#include "command_line.hpp"

namespace lucerna::demo {

Work addMerge(Command app);

}  // namespace lucerna::demo
