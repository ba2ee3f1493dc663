// Coloured, textured triangles over a picture, in runs with a clip rectangle each: draws user interfaces.
//
// Vertices are in pixels of the target, (0,0) top left. Colours are written unchanged (an sRGB-encoded target takes
// sRGB-encoded colours) and alpha-blended over the picture.
#pragma once

#include "gl/objects.hpp"
#include "gl/program.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace lucerna::gl {

class Overlay {
 public:
  struct Vertex {
    glm::vec2 position;
    glm::vec2 uv;
    glm::vec4 color;  ///< 0..1, alpha not premultiplied
  };
  struct Run {
    glm::ivec2 corner, size;  ///< only these pixels are drawn; corner from the top left
    std::uint32_t firstIndex = 0, indexCount = 0;
    const Texture* texture = nullptr;  ///< multiplies the colour
  };

  explicit Overlay(ProgramLibrary& programs);
  void draw(const Framebuffer& target, std::span<const Vertex> vertices, std::span<const std::uint32_t> indices,
            std::span<const Run> runs);
  std::size_t gpuBytes() const { return vertices_.bytes() + indices_.bytes(); }

 private:
  void reserve(std::size_t vertexBytes, std::size_t indexBytes);
  const Program* program_;
  Buffer vertices_, indices_;
  VertexArray vertexArray_;
};

}  // namespace lucerna::gl
