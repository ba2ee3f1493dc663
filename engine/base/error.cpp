#include "base/error.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <cstdlib>

namespace lucerna::detail {

void checkFailed(const char* file, int line, const char* condition, const std::string& message) {
  fmt::print(stderr, "lucerna: {}:{}: check failed: {}: {}\n", file, line, condition, message);
  std::fflush(stderr);
  std::abort();
}

}  // namespace lucerna::detail
