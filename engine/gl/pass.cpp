#include "gl/pass.hpp"

#include "base/error.hpp"
#include "gl/limits.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace lucerna::gl {

namespace {

std::string g_lastPass = "none";

/// LUCERNA_FINISH_PASSES=1: before each group the program waits for the GPU, then writes "pass NAME" to standard error.
/// The last such line names the work that does not end.
bool finishesPasses() {
  static const bool asked = [] {
    const char* value = std::getenv("LUCERNA_FINISH_PASSES");
    return value && *value && *value != '0';
  }();
  return asked;
}

}  // namespace

const std::string& lastPass() { return g_lastPass; }

void pushDebugGroup(const std::string& name) {
  g_lastPass = name;
  static const GLint most =
      [] {  // queried once: groups are pushed all the time, and a query stalls drivers with their own threads
        GLint length = 0;
        glGetIntegerv(GL_MAX_DEBUG_MESSAGE_LENGTH, &length);  // counts the terminating zero
        return length;
      }();
  if (finishesPasses()) {
    glFinish();
    std::fprintf(stderr, "pass %s\n", name.c_str());
  }
  glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, std::min(static_cast<GLint>(name.size()), most - 1), name.c_str());
}

DebugGroup::DebugGroup(const std::string& name) { pushDebugGroup(name); }

DebugGroup::~DebugGroup() { glPopDebugGroup(); }

RasterPass::RasterPass(const std::string& name, const Framebuffer& target, const RasterState& state) : group_(name) {
  const auto enable = [](GLenum capability, bool on) { on ? glEnable(capability) : glDisable(capability); };
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glViewport(0, 0, target.size().x, target.size().y);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);  // for clears; narrowed below
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_FRAMEBUFFER_SRGB);
  for (const GLenum never :
       std::initializer_list<GLenum>{GL_RASTERIZER_DISCARD, GL_COLOR_LOGIC_OP, GL_DITHER, GL_SAMPLE_ALPHA_TO_COVERAGE,
                                     GL_SAMPLE_MASK, GL_PRIMITIVE_RESTART})
    glDisable(never);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glDepthRange(0.0, 1.0);
  enable(GL_TEXTURE_CUBE_MAP_SEAMLESS, true);
  enable(GL_PROGRAM_POINT_SIZE, true);
  enable(GL_DEPTH_TEST, state.depth != Depth::off);
  glDepthFunc(state.depth == Depth::equalReadOnly ? GL_EQUAL : GL_LESS);
  if (state.depth == Depth::equalReadOnly) glDepthMask(GL_FALSE);
  enable(GL_CULL_FACE, state.cull != Cull::none);
  glCullFace(state.cull == Cull::front ? GL_FRONT : GL_BACK);
  glFrontFace(GL_CCW);
  enable(GL_BLEND, state.blend != Blend::none);
  for (GLuint attachment = 0; attachment < state.firstBlended; ++attachment) glDisablei(GL_BLEND, attachment);
  glBlendFunc(GL_ONE, GL_ONE);
  glBlendEquation(GL_FUNC_ADD);
  enable(GL_POLYGON_OFFSET_FILL, state.polygonOffset != glm::vec2(0.0f));
  glPolygonOffset(state.polygonOffset.x, state.polygonOffset.y);
  enable(GL_DEPTH_CLAMP, state.depthClamp);
}

RasterPass::~RasterPass() { glBindFramebuffer(GL_FRAMEBUFFER, 0); }

void RasterPass::clearColor(int attachment, const glm::vec4& value) const {
  glClearBufferfv(GL_COLOR, attachment, &value.x);
}

void RasterPass::clearDepth(float value) const { glClearBufferfv(GL_DEPTH, 0, &value); }

void RasterPass::restrictTo(const glm::ivec2& corner, const glm::ivec2& size) const {
  glEnable(GL_SCISSOR_TEST);
  glScissor(corner.x, corner.y, size.x, size.y);
}

void ComputePass::dispatch(const glm::ivec3& size, const glm::ivec3& groupSize) const {
  const glm::uvec3 groups((size + groupSize - 1) / groupSize);
  static const glm::uvec3 most = mostWorkGroups();  // queried once, as above
  if (glm::any(glm::greaterThan(groups, most)))
    throwMissingCapability("{} x {} x {} work groups; this driver's limit is {} x {} x {}", groups.x, groups.y,
                           groups.z, most.x, most.y, most.z);
  glDispatchCompute(groups.x, groups.y, groups.z);
}

void ComputePass::dispatchIndirect(const Buffer& groups, std::size_t offset) const {
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, groups.id());
  glDispatchComputeIndirect(static_cast<GLintptr>(offset));
}

void drawFullScreen(const VertexArray& emptyVertexArray) {
  emptyVertexArray.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace lucerna::gl
