#include "base/log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>

namespace lucerna {

namespace {
LogLevel g_level = LogLevel::warnings;
std::vector<std::string> g_warnings;
}  // namespace

void setLogLevel(LogLevel level) { g_level = level; }
LogLevel logLevel() { return g_level; }

const std::vector<std::string>& loggedWarnings() { return g_warnings; }
void clearLoggedWarnings() { g_warnings.clear(); }

namespace detail {

void writeLog(LogLevel level, const std::string& message) {
  // Repeating a warning for every sweep point of a bench or frame of a walk adds nothing.
  const bool known =
      level == LogLevel::warnings && std::find(g_warnings.begin(), g_warnings.end(), message) != g_warnings.end();
  if (level == LogLevel::warnings) g_warnings.push_back(message);
  if (level > g_level || known) return;
  fmt::print(stderr, "{}{}\n", level == LogLevel::warnings ? "lucerna: warning: " : "lucerna: ", message);
}

}  // namespace detail
}  // namespace lucerna
