// Waiting for the GPU, with a limit: a dispatch that never ends must be an error, not a program that hangs.
#pragma once

#include "host/api.hpp"

namespace lucerna::gl {

/// Waits until all submitted commands have ended. Throws Error(fault) naming the last pass if a GPU takes longer than
/// the limit.
void finish();

/// The same for the commands before `fence`, once they have been flushed.
void waitFor(GLsync fence);

/// Before a call that waits on its own, such as glGetBufferSubData: waits here, within the limit. No effect without
/// one.
void waitBeforeReading();

/// Limit in seconds; 0: none. LUCERNA_GPU_SECONDS sets another one. A context sets it to kGpuSeconds on hardware and to
/// none on software renderers, whose long work is not a hang.
void setWaitLimit(double seconds);
constexpr double kGpuSeconds = 20.0;

}  // namespace lucerna::gl
