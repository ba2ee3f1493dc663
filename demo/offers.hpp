// What completions offer for the values of an option: kept in the command line's own tree, seen neither by help nor by parsing.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace lucerna::demo {

/// `values` that end in '=' are keys, which a value follows. What was offered before is replaced.
CLI::Option* offer(CLI::Option* option, const std::vector<std::string>& values);

/// What was offered; empty where nothing was. (CLI11 gives validators of options that may be changed alone.)
std::vector<std::string> offered(CLI::Option& option);

/// With spaces between them.
std::string joined(const std::vector<std::string>& words);

/// "KEY=" of every setting of --set, or of those that a radiosity solution depends on.
std::vector<std::string> offeredSettings(bool ofSolutions = false);

}  // namespace lucerna::demo
