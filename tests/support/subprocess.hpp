// Runs a program as a user would: a shell command, its two outputs and its exit code.
#pragma once

#include <string>

namespace lucerna::test {

struct RunResult {
  int exitCode = -1;  ///< 128 + signal when it was killed
  std::string out, err;
};

/// Runs a shell command and waits for it, with LUCERNA_HOST set to testHost().
RunResult run(const std::string& command);

/// The built executable with arguments; LUCERNA_BINARY is set by the build.
#define RUN_LUCERNA(arguments) ::lucerna::test::run(std::string("'" LUCERNA_BINARY "' ") + (arguments))

}  // namespace lucerna::test
