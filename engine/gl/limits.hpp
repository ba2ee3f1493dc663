// What the driver allows beyond what OpenGL 4.3 guarantees.
#pragma once

#include "gl/api.hpp"

#include <cstddef>
#include <string_view>

namespace lucerna::gl {

/// The driver's value of a limit such as GL_MAX_TEXTURE_SIZE; only of those listed in limits.cpp. With LUCERNA_GL_MINIMA=1 in the environment no more
/// than OpenGL 4.3 guarantees, so that it can be seen what is said on the least of drivers.
GLint limit(GLenum name);

/// Throws Error(missingCapability), which names `what`, the limit and its value, where `needed` is over it. What is guaranteed costs no call of the driver.
void requireWithin(GLenum limitName, std::size_t needed, std::string_view what);

/// As above; the object's own name stands for `what` (see label()). identifier: GL_BUFFER, GL_TEXTURE.
void requireWithin(GLenum limitName, std::size_t needed, GLenum identifier, GLuint id);

}  // namespace lucerna::gl
