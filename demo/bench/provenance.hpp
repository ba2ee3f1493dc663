// Where a figure comes from: which program on which processor, by which command.
#pragma once

#include <string>
#include <vector>

namespace lucerna::demo::bench {

/// "0.9.0, commit 1a2b3c4", as it was built; "commit unknown" where the sources were no git checkout. "+": with
/// changes.
std::string programVersion();
/// The processor's name and count, from /proc/cpuinfo; "unknown processor" elsewhere.
std::string cpuName();
/// A word of a command as a shell takes it: in single quotes where it holds more than letters, digits and _ - . / , = :
/// + @.
std::string shellWord(const std::string& word);
/// Words with spaces between.
std::string shellCommand(const std::vector<std::string>& words);

}  // namespace lucerna::demo::bench
