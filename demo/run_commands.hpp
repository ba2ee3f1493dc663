// Parses the command line and runs the subcommand that it names.
#pragma once

#include "command_line.hpp"

namespace lucerna::demo {

/// The exit code of the program; whatever goes wrong is printed as one line.
int runCommands(Command app, const Work& work, int argc, char** argv);

}  // namespace lucerna::demo
