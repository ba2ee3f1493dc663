#include "gl/live_objects.hpp"

#include <GL/glew.h>

#include <algorithm>

namespace lucerna::gl {

namespace {

/// Those of one kind. The newest name bounds them: Mesa gives each object a higher one, others may fill gaps.
template <class Generate, class Delete, class Is>
std::size_t countOf(const Generate& generate, const Delete& release, const Is& is) {
  constexpr GLuint kAtLeast = 65536;
  const GLuint newest = generate(), last = std::max(newest, kAtLeast);
  release(newest);
  std::size_t count = 0;
  for (GLuint name = 1; name <= last; ++name) count += is(name) == GL_TRUE;
  return count;
}

}  // namespace

std::size_t countLiveObjects() {
  const auto named = [](auto generate) {
    return [generate] {
      GLuint name = 0;
      generate(1, &name);
      return name;
    };
  };
  const auto released = [](auto release) { return [release](GLuint name) { release(1, &name); }; };
  return countOf(named(glGenBuffers), released(glDeleteBuffers), glIsBuffer) +
         countOf(named(glGenTextures), released(glDeleteTextures), glIsTexture) +
         countOf(named(glGenFramebuffers), released(glDeleteFramebuffers), glIsFramebuffer) +
         countOf(named(glGenRenderbuffers), released(glDeleteRenderbuffers), glIsRenderbuffer) +
         countOf(named(glGenVertexArrays), released(glDeleteVertexArrays), glIsVertexArray) +
         countOf(named(glGenSamplers), released(glDeleteSamplers), glIsSampler) +
         countOf(named(glGenQueries), released(glDeleteQueries), glIsQuery) +
         countOf(glCreateProgram, glDeleteProgram, glIsProgram);
}

}  // namespace lucerna::gl
