// lucerna cluster plan|run|status|join: work divided by --part, done by many machines that share a folder.
#pragma once

#include "command_line.hpp"

namespace lucerna::demo {

Work addCluster(Command app);

}  // namespace lucerna::demo
