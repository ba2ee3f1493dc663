// lucerna bench diff A B: two reports row by row.
#pragma once

#include "commands.hpp"

namespace lucerna::demo {

Work addBenchDiff(CLI::App& app);

}  // namespace lucerna::demo
