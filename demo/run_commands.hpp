// Parses the command line and runs the subcommand that it names.
#pragma once

#include "commands.hpp"

#include <CLI/CLI.hpp>

#include <utility>
#include <vector>

namespace lucerna::demo {

using Command = std::pair<CLI::App*, Work>;

/// The exit code of the program; whatever goes wrong is printed as one line.
int runCommands(CLI::App& app, const std::vector<Command>& commands, int argc, char** argv);

}  // namespace lucerna::demo
