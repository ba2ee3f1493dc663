// lucerna merge PART...: merges parts of a path traced picture's samples into one picture, and parts of frames, batches
// and rows into one folder (parts.hpp).
#pragma once

#include "shared/command_line.hpp"

#include <filesystem>
#include <vector>

namespace lucerna {
struct Film;
}

namespace lucerna::demo {

Work addMerge(Command app);

/// The film of all samples of these, in any order. Throws Error(badInput) if they do not belong together.
Film mergeFilms(const std::vector<std::filesystem::path>& parts);

}  // namespace lucerna::demo
