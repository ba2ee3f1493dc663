// The command `lucerna check`.
#pragma once

#include "command_line.hpp"

namespace lucerna::demo {

Work addCheck(Command app);

}  // namespace lucerna::demo
