// The subcommand `lucerna lab`.
#pragma once

#include "shared/command_line.hpp"

namespace lucerna::demo {

/// All but museum and mystery (originals/originals.hpp), which render: these depend on the engine only up to engine/gl.
void addLabs(Subcommands& commands);

}  // namespace lucerna::demo
