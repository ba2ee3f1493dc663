// How many OpenGL objects exist, by asking the driver: for tests of long runs, which must end with as many as they
// began.
#pragma once

#include <cstddef>

namespace lucerna::gl {

/// Buffers, textures, framebuffers, vertex arrays, samplers, queries and programs of the current context, with names up
/// to the newest of their kind, or to 65536. Takes some milliseconds.
std::size_t countLiveObjects();

}  // namespace lucerna::gl
