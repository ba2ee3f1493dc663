// Parses the command line and runs the subcommand that it names.
#pragma once

#include "subcommands.hpp"

namespace lucerna::demo {

/// The exit code of the program; whatever goes wrong is printed as one line.
int runCommands(CLI::App& app, const Work& work, int argc, char** argv);

}  // namespace lucerna::demo
