// lucerna merge PART... -o OUT: parts of a path traced picture's samples as one picture.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>

namespace lucerna::demo {

std::function<int()> addMerge(CLI::App& app);

}  // namespace lucerna::demo
