// The subcommand `lucerna lab`.
#pragma once

#include "command_line.hpp"

namespace lucerna::demo {

/// As commands.hpp has the others.
Work addLab(Command app);
/// All but museum and mystery, which render: what these need of the engine ends with engine/gl.
void addLabs(Subcommands& commands);

}  // namespace lucerna::demo
