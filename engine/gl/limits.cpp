#include "gl/limits.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace lucerna::gl {

namespace {

struct Limit {
  GLenum value;
  const char* name;
  GLint guaranteed;
};

/// OpenGL 4.3 core, tables 23.53 to 23.67 (implementation dependent values).
constexpr std::array kLimits{
    Limit{GL_MAX_TEXTURE_SIZE, "GL_MAX_TEXTURE_SIZE", 16384},
    Limit{GL_MAX_3D_TEXTURE_SIZE, "GL_MAX_3D_TEXTURE_SIZE", 2048},
    Limit{GL_MAX_ARRAY_TEXTURE_LAYERS, "GL_MAX_ARRAY_TEXTURE_LAYERS", 2048},
    Limit{GL_MAX_TEXTURE_BUFFER_SIZE, "GL_MAX_TEXTURE_BUFFER_SIZE", 1 << 16},
    Limit{GL_MAX_SHADER_STORAGE_BLOCK_SIZE, "GL_MAX_SHADER_STORAGE_BLOCK_SIZE", 1 << 24},
    Limit{GL_MAX_UNIFORM_BLOCK_SIZE, "GL_MAX_UNIFORM_BLOCK_SIZE", 1 << 14},
    Limit{GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, "GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS", 0},
    Limit{GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, "GL_MAX_COMPUTE_SHARED_MEMORY_SIZE", 1 << 15},
    Limit{GL_MAX_COMPUTE_WORK_GROUP_COUNT, "GL_MAX_COMPUTE_WORK_GROUP_COUNT", 65535},
    Limit{GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, "GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS", 1024},
    Limit{GL_MAX_TEXTURE_IMAGE_UNITS, "GL_MAX_TEXTURE_IMAGE_UNITS", 16},
    Limit{GL_MAX_IMAGE_UNITS, "GL_MAX_IMAGE_UNITS", 8},
    Limit{GL_MAX_COLOR_ATTACHMENTS, "GL_MAX_COLOR_ATTACHMENTS", 8},
    Limit{GL_MAX_SAMPLES, "GL_MAX_SAMPLES", 4},
    Limit{GL_MAX_GEOMETRY_OUTPUT_VERTICES, "GL_MAX_GEOMETRY_OUTPUT_VERTICES", 256},
};

const Limit& find(GLenum name) {
  const auto found = std::find_if(kLimits.begin(), kLimits.end(), [&](const Limit& l) { return l.value == name; });
  CHECK(found != kLimits.end(), "limit {:#x}", name);
  return *found;
}

GLint held(GLint value, const Limit& known) {
  const char* minima = std::getenv("LUCERNA_GL_MINIMA");
  return minima && *minima && *minima != '0' ? std::min(value, known.guaranteed) : value;
}

}  // namespace

GLint limit(GLenum name) {
  const Limit& known = find(name);
  GLint value = 0;
  glGetIntegerv(name, &value);
  return held(value, known);
}

glm::uvec3 mostWorkGroups() {
  glm::uvec3 most(0u);
  for (GLuint axis = 0; axis < 3; ++axis) {
    GLint value = 0;
    glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, axis, &value);
    most[static_cast<int>(axis)] = static_cast<GLuint>(held(value, find(GL_MAX_COMPUTE_WORK_GROUP_COUNT)));
  }
  return most;
}

void requireWithin(GLenum limitName, std::size_t needed, std::string_view what) {
  const Limit& known = find(limitName);
  if (needed <= static_cast<std::size_t>(known.guaranteed)) return;
  if (const GLint value = limit(limitName); needed > static_cast<std::size_t>(value))
    throwMissingCapability("{}: {} needed, this driver's {} is {}", what, needed, known.name, value);
}

void requireWithin(GLenum limitName, std::size_t needed, GLenum identifier, GLuint id) {
  if (needed <= static_cast<std::size_t>(find(limitName).guaranteed)) return;
  std::array<char, 256> name{};
  glGetObjectLabel(identifier, id, static_cast<GLsizei>(name.size()), nullptr, name.data());
  requireWithin(limitName, needed, std::string_view(name.data()));
}

}  // namespace lucerna::gl
