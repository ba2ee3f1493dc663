// lucerna cluster plan|run|status|join: work that is cut by --part, made by many machines that share a folder.
#pragma once

#include "subcommands.hpp"

namespace lucerna::demo {

Work addCluster(CLI::App& app);

}  // namespace lucerna::demo
