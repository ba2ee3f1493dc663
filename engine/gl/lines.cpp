#include "gl/lines.hpp"

#include "gl/pass.hpp"

#include <array>

namespace lucerna::gl {

Lines::Lines(ProgramLibrary& programs)
    : program_(&programs.loadRaster("lines", "lib/lines.vert", "lib/lines.frag")),
      noDepth_("no depth", Format::r32f, glm::ivec2(1)) {}

void Lines::draw(const Framebuffer& target, const Placement& placement, const View& view, std::span<const Line> lines,
                 float width) {
  if (lines.empty() || placement.size.x <= 0 || placement.size.y <= 0) return;
  constexpr std::array<glm::vec2, 6> kCorners{{{0, -1}, {1, -1}, {1, 1}, {0, -1}, {1, 1}, {0, 1}}};
  std::vector<Vertex> vertices;
  vertices.reserve(kCorners.size() * lines.size());
  for (const Line& line : lines)
    for (const glm::vec2& corner : kCorners) vertices.push_back({line.start, line.end, corner, line.color});
  const std::size_t bytes = vertices.size() * sizeof(Vertex);
  if (bytes > vertices_.bytes()) {  // twice the required size, so that it rarely grows
    vertices_ = Buffer("lines", 2 * bytes, nullptr, Usage::streamDraw);
    const std::array<VertexArray::Attribute, 4> attributes{{{0, 3, offsetof(Vertex, start)},
                                                            {1, 3, offsetof(Vertex, end)},
                                                            {2, 2, offsetof(Vertex, corner)},
                                                            {3, 4, offsetof(Vertex, color)}}};
    vertexArray_ = VertexArray("lines", vertices_, sizeof(Vertex), attributes, nullptr);
  }
  vertices_.upload(0, bytes, vertices.data());
  const RasterPass pass("lines", target, {});
  pass.restrictTo(placement.corner, placement.size);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  program_->use();
  program_->set("clipFromWorld", view.clipFromWorld);
  program_->set("pixels", glm::vec2(target.size()));
  program_->set("middle", placement.middle);
  program_->set("centre", placement.centre);
  program_->set("scale", placement.scale);
  program_->set("width", width);
  program_->set("nearest", view.near);
  program_->set("hasDepth", view.depth ? 1 : 0);
  program_->set("planes", glm::vec2(view.near, view.far));
  (view.depth ? *view.depth : noDepth_).bind(0);
  vertexArray_.bind();
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
}

}  // namespace lucerna::gl
