// The provenance of a result: the program, the processor and the command.
#pragma once

#include <string>

namespace lucerna {

/// "0.9.0, commit 1a2b3c4", as built; "commit unknown" if the sources were not a git checkout. "+": with changes.
std::string programVersion();
/// The processor's name and count, from /proc/cpuinfo; "unknown processor" elsewhere.
std::string cpuName();

}  // namespace lucerna
