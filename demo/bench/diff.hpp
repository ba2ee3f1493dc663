// lucerna bench diff A B: compares two reports row by row.
#pragma once

#include "shared/commands.hpp"

namespace lucerna::demo {

Work addBenchDiff(Command app);

}  // namespace lucerna::demo
