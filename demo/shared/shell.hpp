// Words and commands as a shell takes them.
#pragma once

#include <string>
#include <vector>

namespace lucerna::demo::bench {

/// A word of a command as the shell needs it: in single quotes if it contains anything but letters, digits and _ - . /
/// , = : + @.
std::string shellWord(const std::string& word);
/// Words joined by spaces.
std::string shellCommand(const std::vector<std::string>& words);

}  // namespace lucerna::demo::bench
