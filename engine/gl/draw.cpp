#include "gl/draw.hpp"

#include <glm/gtc/type_ptr.hpp>

namespace lucerna::gl {

void drawPoints(int count) { glDrawArrays(GL_POINTS, 0, count); }

void drawTriangles(int count, int instances) {
  if (instances == 1) glDrawArrays(GL_TRIANGLES, 0, count);
  else glDrawArraysInstanced(GL_TRIANGLES, 0, count, instances);
}

void drawIndexedTriangles(std::uint32_t firstIndex, std::uint32_t count) {
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(sizeof(std::uint32_t) * firstIndex));
}

PolygonMode::PolygonMode(Parts parts) { glPolygonMode(GL_FRONT_AND_BACK, parts == Parts::edges ? GL_LINE : GL_POINT); }

PolygonMode::~PolygonMode() { glPolygonMode(GL_FRONT_AND_BACK, GL_FILL); }

void clearWords(int attachment, const glm::uvec4& value) {
  glClearBufferuiv(GL_COLOR, attachment, glm::value_ptr(value));
}

void readBytes(const Framebuffer& from, const glm::ivec2& corner, const glm::ivec2& size, std::uint8_t* rgba) {
  glBindFramebuffer(GL_FRAMEBUFFER, from.id());
  glReadPixels(corner.x, corner.y, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}

void readFloats(const Framebuffer& from, const glm::ivec2& corner, const glm::ivec2& size, float* red) {
  glBindFramebuffer(GL_FRAMEBUFFER, from.id());
  glReadPixels(corner.x, corner.y, size.x, size.y, GL_RED, GL_FLOAT, red);
}

void finish() { glFinish(); }

}  // namespace lucerna::gl
