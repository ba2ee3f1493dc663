// The subcommand `lucerna lab`.
#pragma once

#include "command_line.hpp"

namespace lucerna::demo {

/// Declared like the commands in commands.hpp.
Work addLab(Command app);
/// All but museum and mystery, which render: these depend on the engine only up to engine/gl.
void addLabs(Subcommands& commands);

}  // namespace lucerna::demo
