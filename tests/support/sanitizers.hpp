// Whether a sanitizer is built in: it brings its own allocator, and its libraries are not for others.
#pragma once

namespace lucerna::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

}  // namespace lucerna::test
