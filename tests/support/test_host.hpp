// Where tests get their OpenGL from: LUCERNA_TEST_HOST=osmesa|egl|window; by default OSMesa where it is there, else
// EGL.
#pragma once

#include "host/host.hpp"

namespace lucerna::test {

/// Throws Error(badInput) where LUCERNA_TEST_HOST names no host.
HostKind testHost();

}  // namespace lucerna::test
