#include "gl/live_objects.hpp"

#include <GL/glew.h>

namespace lucerna::gl {

std::size_t countLiveObjects() {
  constexpr GLuint kLast = 65536;
  std::size_t count = 0;
  for (GLuint name = 1; name <= kLast; ++name)
    count += (glIsBuffer(name) == GL_TRUE) + (glIsTexture(name) == GL_TRUE) + (glIsFramebuffer(name) == GL_TRUE) +
             (glIsVertexArray(name) == GL_TRUE) + (glIsSampler(name) == GL_TRUE) + (glIsQuery(name) == GL_TRUE) +
             (glIsProgram(name) == GL_TRUE);
  return count;
}

}  // namespace lucerna::gl
