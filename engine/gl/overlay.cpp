#include "gl/overlay.hpp"

#include "gl/pass.hpp"

#include <algorithm>
#include <array>

namespace lucerna::gl {

Overlay::Overlay(ProgramLibrary& programs)
    : program_(&programs.loadRaster("overlay", "lib/overlay.vert", "lib/overlay.frag")) {}

// Buffers grow to twice the required size, so that they rarely do.
void Overlay::reserve(std::size_t vertexBytes, std::size_t indexBytes) {
  if (vertexBytes <= vertices_.bytes() && indexBytes <= indices_.bytes()) return;
  if (vertexBytes > vertices_.bytes())
    vertices_ = Buffer("overlay vertices", 2 * vertexBytes, nullptr, Usage::streamDraw);
  if (indexBytes > indices_.bytes()) indices_ = Buffer("overlay indices", 2 * indexBytes, nullptr, Usage::streamDraw);
  const std::array<VertexArray::Attribute, 3> attributes{
      {{0, 2, offsetof(Vertex, position)}, {1, 2, offsetof(Vertex, uv)}, {2, 4, offsetof(Vertex, color)}}};
  vertexArray_ = VertexArray("overlay", vertices_, sizeof(Vertex), attributes, &indices_);
}

void Overlay::draw(const Framebuffer& target, std::span<const Vertex> vertices, std::span<const std::uint32_t> indices,
                   std::span<const Run> runs) {
  if (vertices.empty() || indices.empty() || target.size().x <= 0 || target.size().y <= 0) return;
  reserve(vertices.size_bytes(), indices.size_bytes());
  vertices_.upload(0, vertices.size_bytes(), vertices.data());
  indices_.upload(0, indices.size_bytes(), indices.data());
  const RasterPass pass("overlay", target, {});
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  program_->use();
  program_->set("pixels", glm::vec2(target.size()));
  vertexArray_.bind();
  for (const Run& run : runs) {
    const glm::ivec2 first = glm::max(run.corner, glm::ivec2(0)), last = glm::min(run.corner + run.size, target.size());
    if (last.x <= first.x || last.y <= first.y || run.indexCount == 0) continue;
    pass.restrictTo({first.x, target.size().y - last.y}, last - first);
    run.texture->bind(0);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(run.indexCount), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(run.firstIndex * sizeof(std::uint32_t)));
  }
}

}  // namespace lucerna::gl
