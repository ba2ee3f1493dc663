// Driver limits beyond the minima that OpenGL 4.3 guarantees.
#pragma once

#include "host/api.hpp"

#include <glm/glm.hpp>

#include <cstddef>
#include <string_view>

namespace lucerna::gl {

/// The driver's value of a limit such as GL_MAX_TEXTURE_SIZE; only for limits listed in limits.cpp. With
/// LUCERNA_GL_MINIMA=1 in the environment it is capped at the minimum that OpenGL 4.3 guarantees, for testing.
GLint limit(GLenum name);

/// The same for GL_MAX_COMPUTE_WORK_GROUP_COUNT, which has a value per axis.
glm::uvec3 mostWorkGroups();

/// Throws Error(missingCapability) naming `what`, the limit and its value if `needed` exceeds it. Values within the
/// guaranteed minimum need no driver call.
void requireWithin(GLenum limitName, std::size_t needed, std::string_view what);

/// The same with the object's label as `what` (see label()). identifier: GL_BUFFER, GL_TEXTURE.
void requireWithin(GLenum limitName, std::size_t needed, GLenum identifier, GLuint id);

}  // namespace lucerna::gl
