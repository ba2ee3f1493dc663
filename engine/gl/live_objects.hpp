// How many OpenGL objects exist, by asking the driver: for tests of long runs, which must end with as many as they
// began.
#pragma once

#include <cstddef>

namespace lucerna::gl {

/// Buffers, textures, framebuffers, vertex arrays, samplers, queries and programs of the current context with names up
/// to 65536. Drivers give the smallest free names first (Mesa), or small ones. Takes some milliseconds.
std::size_t countLiveObjects();

}  // namespace lucerna::gl
