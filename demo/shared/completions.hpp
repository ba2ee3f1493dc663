// Values that completions offer for an option, stored in the command line's own tree, invisible to help and parsing.
#pragma once

#include "render/settings.hpp"
#include "shared/command_line.hpp"

#include <string>
#include <vector>

namespace lucerna::demo {

/// `values` that end in '=' are keys followed by a value. Replaces earlier ones.
Option addCompletions(Option option, const std::vector<std::string>& values);

/// The values, possibly none. (CLI11 gives access to validators only on non-const options.)
std::vector<std::string> completionsOf(Option option);

/// The words joined by spaces.
std::string joined(const std::vector<std::string>& words);

/// "KEY=" of every setting of --set, followed by its values if they have names; only settings of that cost, or (null)
/// all.
std::vector<std::string> settingCompletions(const SettingCost* only = nullptr);

}  // namespace lucerna::demo
