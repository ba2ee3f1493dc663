// Draw calls for what is bound (a pass, a program in use, a vertex array), and reads of framebuffers.
#pragma once

#include "gl/objects.hpp"

#include <glm/glm.hpp>

#include <cstdint>

namespace lucerna::gl {

void drawPoints(int count);
/// Vertices 0..count - 1, three a triangle.
void drawTriangles(int count, int instances = 1);
/// Of the bound vertex array's indices, 32 bits each.
void drawIndexedTriangles(std::uint32_t firstIndex, std::uint32_t count);

/// Triangles as their edges or corners, for a lifetime within a pass.
class PolygonMode {
 public:
  enum class Parts { edges, corners };
  explicit PolygonMode(Parts parts);
  ~PolygonMode();
  PolygonMode(const PolygonMode&) = delete;
  PolygonMode& operator=(const PolygonMode&) = delete;
};

/// An attachment of unsigned integers of the pass' framebuffer.
void clearWords(int attachment, const glm::uvec4& value);

/// Of the first attachment, bottom row first: 8 bits RGBA, or floats of red alone. Rows without padding.
void readBytes(const Framebuffer& from, const glm::ivec2& corner, const glm::ivec2& size, std::uint8_t* rgba);
void readFloats(const Framebuffer& from, const glm::ivec2& corner, const glm::ivec2& size, float* red);

/// Waits until the GPU has done all that it was given; for measurements.
void finish();

}  // namespace lucerna::gl
