// Draw calls for the bound state (a pass, a program in use, a vertex array), and reads of framebuffers.
#pragma once

#include "gl/objects.hpp"

#include <glm/glm.hpp>

#include <cstdint>

namespace lucerna::gl {

void drawPoints(int count);
/// Vertices 0..count - 1, three per triangle.
void drawTriangles(int count, int instances = 1);
/// From the bound vertex array's index buffer, 32 bits per index.
void drawIndexedTriangles(std::uint32_t firstIndex, std::uint32_t count);

/// Draws triangles as edges or corners, for its lifetime within a pass.
class PolygonMode {
 public:
  enum class Parts { edges, corners };
  explicit PolygonMode(Parts parts);
  ~PolygonMode();
  PolygonMode(const PolygonMode&) = delete;
  PolygonMode& operator=(const PolygonMode&) = delete;
};

/// Clears an unsigned integer attachment of the pass' framebuffer.
void clearWords(int attachment, const glm::uvec4& value);

/// Reads the first attachment, bottom row first: 8-bit RGBA, or the red channel as floats. Rows without padding.
void readBytes(const Framebuffer& from, const glm::ivec2& corner, const glm::ivec2& size, std::uint8_t* rgba);
void readFloats(const Framebuffer& from, const glm::ivec2& corner, const glm::ivec2& size, float* red);

/// Waits until the GPU has finished all submitted work; for measurements.
void finish();

}  // namespace lucerna::gl
