#include "gl/wait.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "gl/context.hpp"
#include "gl/pass.hpp"

#include <fmt/core.h>

#include <cstdlib>

namespace lucerna::gl {

namespace {
double g_limit = 0.0;
}

void setWaitLimit(double seconds) {
  const char* value = std::getenv("LUCERNA_GPU_SECONDS");
  g_limit = value && *value ? std::atof(value) : seconds;
}

void waitFor(GLsync fence) {
  constexpr GLuint64 kTenthOfASecond = 100'000'000;
  const auto start = Clock::now();
  GLenum status = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, kTenthOfASecond);
  while (status == GL_TIMEOUT_EXPIRED) {
    throwIfReset();
    if (const double seconds = secondsSince(start); g_limit > 0.0 && seconds > g_limit)
      throw Error(ErrorKind::fault, fmt::format("the GPU has not finished after {:.0f} s; the last pass was '{}' "
                                                "(LUCERNA_GPU_SECONDS sets another limit)",
                                                seconds, lastPass()));
    status = glClientWaitSync(fence, 0, kTenthOfASecond);
  }
  if (status == GL_WAIT_FAILED) throwIfError(lastPass());
}

void finish() {
  if (g_limit == 0.0) return glFinish();
  GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  if (!fence) throwIfError(lastPass());
  struct Delete {
    GLsync fence;
    ~Delete() { glDeleteSync(fence); }
  } const deleted{fence};
  waitFor(fence);
}

void waitBeforeReading() {
  if (g_limit > 0.0) finish();
}

}  // namespace lucerna::gl
