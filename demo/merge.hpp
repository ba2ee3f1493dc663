// lucerna merge PART...: parts of a path traced picture's samples as one picture, parts of frames, batches and rows as
// one folder (parts.hpp).
#pragma once

#include "subcommands.hpp"

namespace lucerna::demo {

Work addMerge(CLI::App& app);

}  // namespace lucerna::demo
