// Logging to standard error, one line per message. Results go to standard output.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

namespace lucerna {

enum class LogLevel { quiet, warnings, info, verbose };

void setLogLevel(LogLevel level);
LogLevel logLevel();

namespace detail {
void writeLog(LogLevel level, const std::string& message);
}

template <class... Args>
void logWarning(fmt::format_string<Args...> format, Args&&... args) {
  detail::writeLog(LogLevel::warnings, fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
void logInfo(fmt::format_string<Args...> format, Args&&... args) {
  detail::writeLog(LogLevel::info, fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
void logVerbose(fmt::format_string<Args...> format, Args&&... args) {
  detail::writeLog(LogLevel::verbose, fmt::format(format, std::forward<Args>(args)...));
}

/// Every warning written so far in this process (tests and `--json` read it).
const std::vector<std::string>& loggedWarnings();
void clearLoggedWarnings();

}  // namespace lucerna
