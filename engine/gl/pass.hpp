// Pass scopes: a pass sets all state it relies on and has a name, so no pass depends on what ran before.
#pragma once

#include "gl/objects.hpp"

#include <glm/glm.hpp>

#include <string>

namespace lucerna::gl {

enum class Cull { none, back, front };
enum class Blend { none, add };  ///< add: GL_ONE, GL_ONE, GL_FUNC_ADD
enum class Depth { off, lessWrite, equalReadOnly };  ///< test and write

struct RasterState {
  Depth depth = Depth::off;
  Cull cull = Cull::none;
  Blend blend = Blend::none;
  GLuint firstBlended = 0;  ///< earlier colour attachments are written, not blended
  glm::vec2 polygonOffset{0.0f};  ///< factor, units; off where both are zero
  bool depthClamp = false;
};

/// Opens a KHR_debug group; its name is truncated to GL_MAX_DEBUG_MESSAGE_LENGTH. glPopDebugGroup closes it.
void pushDebugGroup(const std::string& name);

/// The name last given to pushDebugGroup, for messages.
const std::string& lastPass();

/// A KHR_debug group for its lifetime.
class DebugGroup {
 public:
  explicit DebugGroup(const std::string& name);
  ~DebugGroup();
  DebugGroup(const DebugGroup&) = delete;
  DebugGroup& operator=(const DebugGroup&) = delete;
};

/// Draws into a framebuffer with a complete state, for its lifetime. Then the framebuffer is unbound: what a shader
/// reads from a texture that is attached to the bound one is undefined (OpenGL 4.3, 9.3.1).
class RasterPass {
 public:
  RasterPass(const std::string& name, const Framebuffer& target, const RasterState& state);
  ~RasterPass();
  RasterPass(const RasterPass&) = delete;
  RasterPass& operator=(const RasterPass&) = delete;
  void clearColor(int attachment, const glm::vec4& value) const;
  void clearDepth(float value = 1.0f) const;
  /// Restricts drawing to these pixels (scissor).
  void restrictTo(const glm::ivec2& corner, const glm::ivec2& size) const;

 private:
  DebugGroup group_;
};

/// Dispatches compute work. The barrier at its end makes the results visible to later draws and dispatches (objects
/// settle themselves before the API uses them); the one at its beginning lets it wait for earlier draws, which issue
/// none, before it writes what they access.
class ComputePass {
 public:
  explicit ComputePass(const std::string& name, Barrier atEnd = Barrier::none, Barrier atBegin = Barrier::none)
      : group_(name), atEnd_(atEnd) {
    memoryBarrier(atBegin);
  }
  ~ComputePass() { memoryBarrier(atEnd_); }
  ComputePass(const ComputePass&) = delete;
  ComputePass& operator=(const ComputePass&) = delete;
  /// Dispatches enough groups of `groupSize` to cover `size`.
  void dispatch(const glm::ivec3& size, const glm::ivec3& groupSize) const;
  /// Reads group counts from three words of the buffer at `offset` (bytes), written by an earlier pass that ended with
  /// Barrier::command.
  void dispatchIndirect(const Buffer& groups, std::size_t offset = 0) const;

 private:
  DebugGroup group_;
  Barrier atEnd_;
};

/// Draws three vertices that cover the picture; `emptyVertexArray` has no attributes.
void drawFullScreen(const VertexArray& emptyVertexArray);

}  // namespace lucerna::gl
