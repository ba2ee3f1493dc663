#include "support/test_host.hpp"

#include <cstdlib>

namespace lucerna::test {

HostKind testHost() {
  static const HostKind kind = [] {
    const char* asked = std::getenv("LUCERNA_TEST_HOST");
    if (asked && *asked) return parseHostKind(asked);
    return osmesaAvailable() ? HostKind::osmesa : HostKind::egl;
  }();
  return kind;
}

}  // namespace lucerna::test
