// Tests that take minutes have a short form, which always runs, and a long one where LUCERNA_LONG_TESTS is set
// (tests/run --all).
#pragma once

#include <cstdlib>

namespace lucerna::test {

inline bool longTests() { return std::getenv("LUCERNA_LONG_TESTS") != nullptr; }

}  // namespace lucerna::test
