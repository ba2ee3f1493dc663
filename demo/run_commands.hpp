// Parses the command line and runs the named subcommand.
#pragma once

#include "command_line.hpp"

namespace lucerna::demo {

/// Returns the program's exit code; prints any error as one line.
int runCommands(Command app, const Work& work, int argc, char** argv);

}  // namespace lucerna::demo
