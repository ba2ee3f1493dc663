// Errors and checks (no GL).
//
// Three kinds:
// - CHECK(condition, ...) for programmer errors: prints the condition, the values given and the place, then aborts.
// - Error for files, options, shaders and contexts: its message names the file, the line or key, the problem and what
//   would be valid. The command line prints that message and exits with exitCode().
// - Stopped for work that its caller ended early (Ctrl-C).
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace lucerna {

/// The kind decides the exit code of the program.
enum class ErrorKind {
  fault = 1,  ///< internal error
  badInput = 2,  ///< a file or option that cannot be used
  missingCapability = 3,  ///< something is missing on this machine or in its driver
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }
  int exitCode() const { return static_cast<int>(kind_); }

 private:
  ErrorKind kind_;
};

/// Work that its caller stopped. Finished work is kept; the message says where.
class Stopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class... Args>
[[noreturn]] void throwBadInput(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ErrorKind::badInput, fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
[[noreturn]] void throwMissingCapability(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ErrorKind::missingCapability, fmt::format(format, std::forward<Args>(args)...));
}

namespace detail {
[[noreturn]] void checkFailed(const char* file, int line, const char* condition, const std::string& message);
}

}  // namespace lucerna

/// CHECK(n < size, "n = {}, size = {}", n, size): a programmer error aborts, with values. On in every build.
#define CHECK(condition, ...)                                                                     \
  do {                                                                                            \
    if (!(condition)) [[unlikely]]                                                                \
      ::lucerna::detail::checkFailed(__FILE__, __LINE__, #condition, ::fmt::format(__VA_ARGS__)); \
  } while (false)
