// What completions offer for the values of an option: kept in the command line's own tree, seen neither by help nor by
// parsing.
#pragma once

#include "settings/settings.hpp"
#include "command_line.hpp"

#include <string>
#include <vector>

namespace lucerna::demo {

/// `values` that end in '=' are keys, which a value follows. What was offered before is replaced.
Option offer(Option option, const std::vector<std::string>& values);

/// What was offered; empty where nothing was. (CLI11 gives validators of options that may be changed alone.)
std::vector<std::string> offered(Option option);

/// With spaces between them.
std::string joined(const std::vector<std::string>& words);

/// "KEY=" of every setting of --set, with its values where they have names; of those that cost as much, or (null) all.
std::vector<std::string> offeredSettings(const SettingCost* only = nullptr);

}  // namespace lucerna::demo
