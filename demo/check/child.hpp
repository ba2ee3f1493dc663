// A child process under a time limit, with what it says it is doing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo::check {

struct ChildEnd {
  bool timedOut = false;  ///< killed at its limit
  bool stuck = false;  ///< killed, but still there 5 s later: the driver does not let it go
  bool stopped = false;  ///< killed since this process was interrupted
  int code = 0;  ///< exit code, if it exited
  int signal = 0;  ///< that ended it; 0: none
  double seconds = 0.0;
  double quiet = 0.0;  ///< seconds from its last sign of life to its end
  std::string place;  ///< "frame 3, pass lpv > gather": from its last lines "at ..." and "pass ..."
  std::string message;  ///< its last line "lucerna: ...", without that
};

/// Runs this program with other arguments. Both outputs are appended to `log`. `environment`: "NAME=VALUE" in addition.
/// It and its own children are killed after `seconds`, and when this process ends or is interrupted.
ChildEnd runChild(const std::vector<std::string>& arguments, const std::vector<std::string>& environment,
                  const std::filesystem::path& log, double seconds);

}  // namespace lucerna::demo::check
