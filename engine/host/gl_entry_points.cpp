// The OpenGL 1.0 and 1.1 entry points, and glXGetProcAddressARB.
//
// GLEW loads everything newer by pointer, but leaves GL 1.0/1.1 to whatever GL library the executable links, and there
// can be only one of those, while this executable has three hosts. So these few dozen functions are defined here: each
// forwards to the current host's loader (OSMesaGetProcAddress, eglGetProcAddress, glfwGetProcAddress). GLEW, a shared
// library, finds its pointers through glXGetProcAddressARB: defined here too and exported by every executable that
// links the engine (CMakeLists.txt), so that it asks the current host.
#include "host/host_backends.hpp"

#include "base/error.hpp"

#define GLAPI extern "C"
#define GLAPIENTRY
#include <GL/gl.h>

#include <cstring>
#include <iterator>

namespace lucerna {

static GlProcWrapper g_wrapper = nullptr;

void wrapGlProcs(GlProcWrapper wrapper) { g_wrapper = wrapper; }

namespace detail {

namespace {

GlProcLoader g_loader = nullptr;
bool g_inWindow = false;

GlProc load(const char* name) {
  GlProc driver = g_loader(name);
  return g_wrapper && driver ? g_wrapper(name, driver) : driver;
}

enum class Slot {
  BlendFunc,
  Clear,
  ClearColor,
  ClearDepth,
  ClearStencil,
  ColorMask,
  CullFace,
  DepthFunc,
  DepthMask,
  DepthRange,
  Disable,
  DrawBuffer,
  Enable,
  Finish,
  Flush,
  FrontFace,
  GetBooleanv,
  GetDoublev,
  GetError,
  GetFloatv,
  GetIntegerv,
  GetPointerv,
  GetString,
  GetTexImage,
  GetTexLevelParameterfv,
  GetTexLevelParameteriv,
  GetTexParameterfv,
  GetTexParameteriv,
  Hint,
  IsEnabled,
  LineWidth,
  LogicOp,
  PixelStoref,
  PixelStorei,
  PointSize,
  PolygonMode,
  ReadBuffer,
  ReadPixels,
  Scissor,
  StencilFunc,
  StencilMask,
  StencilOp,
  TexImage1D,
  TexImage2D,
  TexParameterf,
  TexParameterfv,
  TexParameteri,
  TexParameteriv,
  Viewport,
  BindTexture,
  CopyTexSubImage2D,
  DeleteTextures,
  DrawArrays,
  DrawElements,
  GenTextures,
  IsTexture,
  PolygonOffset,
  TexSubImage1D,
  TexSubImage2D,
  count
};

constexpr const char* kNames[] = {"glBlendFunc",
                                  "glClear",
                                  "glClearColor",
                                  "glClearDepth",
                                  "glClearStencil",
                                  "glColorMask",
                                  "glCullFace",
                                  "glDepthFunc",
                                  "glDepthMask",
                                  "glDepthRange",
                                  "glDisable",
                                  "glDrawBuffer",
                                  "glEnable",
                                  "glFinish",
                                  "glFlush",
                                  "glFrontFace",
                                  "glGetBooleanv",
                                  "glGetDoublev",
                                  "glGetError",
                                  "glGetFloatv",
                                  "glGetIntegerv",
                                  "glGetPointerv",
                                  "glGetString",
                                  "glGetTexImage",
                                  "glGetTexLevelParameterfv",
                                  "glGetTexLevelParameteriv",
                                  "glGetTexParameterfv",
                                  "glGetTexParameteriv",
                                  "glHint",
                                  "glIsEnabled",
                                  "glLineWidth",
                                  "glLogicOp",
                                  "glPixelStoref",
                                  "glPixelStorei",
                                  "glPointSize",
                                  "glPolygonMode",
                                  "glReadBuffer",
                                  "glReadPixels",
                                  "glScissor",
                                  "glStencilFunc",
                                  "glStencilMask",
                                  "glStencilOp",
                                  "glTexImage1D",
                                  "glTexImage2D",
                                  "glTexParameterf",
                                  "glTexParameterfv",
                                  "glTexParameteri",
                                  "glTexParameteriv",
                                  "glViewport",
                                  "glBindTexture",
                                  "glCopyTexSubImage2D",
                                  "glDeleteTextures",
                                  "glDrawArrays",
                                  "glDrawElements",
                                  "glGenTextures",
                                  "glIsTexture",
                                  "glPolygonOffset",
                                  "glTexSubImage1D",
                                  "glTexSubImage2D"};
static_assert(std::size(kNames) == static_cast<std::size_t>(Slot::count));

GlProc g_entries[static_cast<std::size_t>(Slot::count)] = {};

template <Slot slot, class Return, class... Args>
Return entry(Args... args) {
  GlProc proc = g_entries[static_cast<std::size_t>(slot)];
  CHECK(proc != nullptr, "{} called without a context", kNames[static_cast<std::size_t>(slot)]);
  return reinterpret_cast<Return (*)(Args...)>(proc)(args...);
}

}  // namespace

void setGlLoader(GlProcLoader loader, bool inWindow) {
  g_loader = loader;
  g_inWindow = inWindow;
  for (std::size_t i = 0; i < std::size(kNames); ++i) g_entries[i] = loader ? load(kNames[i]) : nullptr;
}

// In a window, the window system answers glX names; elsewhere there is no GLX and GLEW must not find one.
extern "C" __attribute__((visibility("default"))) GlProc glXGetProcAddressARB(const GLubyte* name) {
  const char* text = reinterpret_cast<const char*>(name);
  if (!g_loader || (!g_inWindow && std::strncmp(text, "glX", 3) == 0)) return nullptr;
  return load(text);
}

extern "C" {

void GLAPIENTRY glBlendFunc(GLenum a0, GLenum a1) { entry<Slot::BlendFunc, void, GLenum, GLenum>(a0, a1); }
void GLAPIENTRY glClear(GLbitfield a0) { entry<Slot::Clear, void, GLbitfield>(a0); }
void GLAPIENTRY glClearColor(GLfloat a0, GLfloat a1, GLfloat a2, GLfloat a3) {
  entry<Slot::ClearColor, void, GLfloat, GLfloat, GLfloat, GLfloat>(a0, a1, a2, a3);
}
void GLAPIENTRY glClearDepth(GLdouble a0) { entry<Slot::ClearDepth, void, GLdouble>(a0); }
void GLAPIENTRY glClearStencil(GLint a0) { entry<Slot::ClearStencil, void, GLint>(a0); }
void GLAPIENTRY glColorMask(GLboolean a0, GLboolean a1, GLboolean a2, GLboolean a3) {
  entry<Slot::ColorMask, void, GLboolean, GLboolean, GLboolean, GLboolean>(a0, a1, a2, a3);
}
void GLAPIENTRY glCullFace(GLenum a0) { entry<Slot::CullFace, void, GLenum>(a0); }
void GLAPIENTRY glDepthFunc(GLenum a0) { entry<Slot::DepthFunc, void, GLenum>(a0); }
void GLAPIENTRY glDepthMask(GLboolean a0) { entry<Slot::DepthMask, void, GLboolean>(a0); }
void GLAPIENTRY glDepthRange(GLdouble a0, GLdouble a1) { entry<Slot::DepthRange, void, GLdouble, GLdouble>(a0, a1); }
void GLAPIENTRY glDisable(GLenum a0) { entry<Slot::Disable, void, GLenum>(a0); }
void GLAPIENTRY glDrawBuffer(GLenum a0) { entry<Slot::DrawBuffer, void, GLenum>(a0); }
void GLAPIENTRY glEnable(GLenum a0) { entry<Slot::Enable, void, GLenum>(a0); }
void GLAPIENTRY glFinish(void) { entry<Slot::Finish, void>(); }
void GLAPIENTRY glFlush(void) { entry<Slot::Flush, void>(); }
void GLAPIENTRY glFrontFace(GLenum a0) { entry<Slot::FrontFace, void, GLenum>(a0); }
void GLAPIENTRY glGetBooleanv(GLenum a0, GLboolean* a1) { entry<Slot::GetBooleanv, void, GLenum, GLboolean*>(a0, a1); }
void GLAPIENTRY glGetDoublev(GLenum a0, GLdouble* a1) { entry<Slot::GetDoublev, void, GLenum, GLdouble*>(a0, a1); }
GLenum GLAPIENTRY glGetError(void) { return entry<Slot::GetError, GLenum>(); }
void GLAPIENTRY glGetFloatv(GLenum a0, GLfloat* a1) { entry<Slot::GetFloatv, void, GLenum, GLfloat*>(a0, a1); }
void GLAPIENTRY glGetIntegerv(GLenum a0, GLint* a1) { entry<Slot::GetIntegerv, void, GLenum, GLint*>(a0, a1); }
void GLAPIENTRY glGetPointerv(GLenum a0, void** a1) { entry<Slot::GetPointerv, void, GLenum, void**>(a0, a1); }
const GLubyte* GLAPIENTRY glGetString(GLenum a0) { return entry<Slot::GetString, const GLubyte*, GLenum>(a0); }
void GLAPIENTRY glGetTexImage(GLenum a0, GLint a1, GLenum a2, GLenum a3, void* a4) {
  entry<Slot::GetTexImage, void, GLenum, GLint, GLenum, GLenum, void*>(a0, a1, a2, a3, a4);
}
void GLAPIENTRY glGetTexLevelParameterfv(GLenum a0, GLint a1, GLenum a2, GLfloat* a3) {
  entry<Slot::GetTexLevelParameterfv, void, GLenum, GLint, GLenum, GLfloat*>(a0, a1, a2, a3);
}
void GLAPIENTRY glGetTexLevelParameteriv(GLenum a0, GLint a1, GLenum a2, GLint* a3) {
  entry<Slot::GetTexLevelParameteriv, void, GLenum, GLint, GLenum, GLint*>(a0, a1, a2, a3);
}
void GLAPIENTRY glGetTexParameterfv(GLenum a0, GLenum a1, GLfloat* a2) {
  entry<Slot::GetTexParameterfv, void, GLenum, GLenum, GLfloat*>(a0, a1, a2);
}
void GLAPIENTRY glGetTexParameteriv(GLenum a0, GLenum a1, GLint* a2) {
  entry<Slot::GetTexParameteriv, void, GLenum, GLenum, GLint*>(a0, a1, a2);
}
void GLAPIENTRY glHint(GLenum a0, GLenum a1) { entry<Slot::Hint, void, GLenum, GLenum>(a0, a1); }
GLboolean GLAPIENTRY glIsEnabled(GLenum a0) { return entry<Slot::IsEnabled, GLboolean, GLenum>(a0); }
void GLAPIENTRY glLineWidth(GLfloat a0) { entry<Slot::LineWidth, void, GLfloat>(a0); }
void GLAPIENTRY glLogicOp(GLenum a0) { entry<Slot::LogicOp, void, GLenum>(a0); }
void GLAPIENTRY glPixelStoref(GLenum a0, GLfloat a1) { entry<Slot::PixelStoref, void, GLenum, GLfloat>(a0, a1); }
void GLAPIENTRY glPixelStorei(GLenum a0, GLint a1) { entry<Slot::PixelStorei, void, GLenum, GLint>(a0, a1); }
void GLAPIENTRY glPointSize(GLfloat a0) { entry<Slot::PointSize, void, GLfloat>(a0); }
void GLAPIENTRY glPolygonMode(GLenum a0, GLenum a1) { entry<Slot::PolygonMode, void, GLenum, GLenum>(a0, a1); }
void GLAPIENTRY glReadBuffer(GLenum a0) { entry<Slot::ReadBuffer, void, GLenum>(a0); }
void GLAPIENTRY glReadPixels(GLint a0, GLint a1, GLsizei a2, GLsizei a3, GLenum a4, GLenum a5, void* a6) {
  entry<Slot::ReadPixels, void, GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void*>(a0, a1, a2, a3, a4, a5, a6);
}
void GLAPIENTRY glScissor(GLint a0, GLint a1, GLsizei a2, GLsizei a3) {
  entry<Slot::Scissor, void, GLint, GLint, GLsizei, GLsizei>(a0, a1, a2, a3);
}
void GLAPIENTRY glStencilFunc(GLenum a0, GLint a1, GLuint a2) {
  entry<Slot::StencilFunc, void, GLenum, GLint, GLuint>(a0, a1, a2);
}
void GLAPIENTRY glStencilMask(GLuint a0) { entry<Slot::StencilMask, void, GLuint>(a0); }
void GLAPIENTRY glStencilOp(GLenum a0, GLenum a1, GLenum a2) {
  entry<Slot::StencilOp, void, GLenum, GLenum, GLenum>(a0, a1, a2);
}
void GLAPIENTRY glTexImage1D(GLenum a0, GLint a1, GLint a2, GLsizei a3, GLint a4, GLenum a5, GLenum a6,
                             const void* a7) {
  entry<Slot::TexImage1D, void, GLenum, GLint, GLint, GLsizei, GLint, GLenum, GLenum, const void*>(a0, a1, a2, a3, a4,
                                                                                                   a5, a6, a7);
}
void GLAPIENTRY glTexImage2D(GLenum a0, GLint a1, GLint a2, GLsizei a3, GLsizei a4, GLint a5, GLenum a6, GLenum a7,
                             const void* a8) {
  entry<Slot::TexImage2D, void, GLenum, GLint, GLint, GLsizei, GLsizei, GLint, GLenum, GLenum, const void*>(
      a0, a1, a2, a3, a4, a5, a6, a7, a8);
}
void GLAPIENTRY glTexParameterf(GLenum a0, GLenum a1, GLfloat a2) {
  entry<Slot::TexParameterf, void, GLenum, GLenum, GLfloat>(a0, a1, a2);
}
void GLAPIENTRY glTexParameterfv(GLenum a0, GLenum a1, const GLfloat* a2) {
  entry<Slot::TexParameterfv, void, GLenum, GLenum, const GLfloat*>(a0, a1, a2);
}
void GLAPIENTRY glTexParameteri(GLenum a0, GLenum a1, GLint a2) {
  entry<Slot::TexParameteri, void, GLenum, GLenum, GLint>(a0, a1, a2);
}
void GLAPIENTRY glTexParameteriv(GLenum a0, GLenum a1, const GLint* a2) {
  entry<Slot::TexParameteriv, void, GLenum, GLenum, const GLint*>(a0, a1, a2);
}
void GLAPIENTRY glViewport(GLint a0, GLint a1, GLsizei a2, GLsizei a3) {
  entry<Slot::Viewport, void, GLint, GLint, GLsizei, GLsizei>(a0, a1, a2, a3);
}
void GLAPIENTRY glBindTexture(GLenum a0, GLuint a1) { entry<Slot::BindTexture, void, GLenum, GLuint>(a0, a1); }
void GLAPIENTRY glCopyTexSubImage2D(GLenum a0, GLint a1, GLint a2, GLint a3, GLint a4, GLint a5, GLsizei a6,
                                    GLsizei a7) {
  entry<Slot::CopyTexSubImage2D, void, GLenum, GLint, GLint, GLint, GLint, GLint, GLsizei, GLsizei>(a0, a1, a2, a3, a4,
                                                                                                    a5, a6, a7);
}
void GLAPIENTRY glDeleteTextures(GLsizei a0, const GLuint* a1) {
  entry<Slot::DeleteTextures, void, GLsizei, const GLuint*>(a0, a1);
}
void GLAPIENTRY glDrawArrays(GLenum a0, GLint a1, GLsizei a2) {
  entry<Slot::DrawArrays, void, GLenum, GLint, GLsizei>(a0, a1, a2);
}
void GLAPIENTRY glDrawElements(GLenum a0, GLsizei a1, GLenum a2, const void* a3) {
  entry<Slot::DrawElements, void, GLenum, GLsizei, GLenum, const void*>(a0, a1, a2, a3);
}
void GLAPIENTRY glGenTextures(GLsizei a0, GLuint* a1) { entry<Slot::GenTextures, void, GLsizei, GLuint*>(a0, a1); }
GLboolean GLAPIENTRY glIsTexture(GLuint a0) { return entry<Slot::IsTexture, GLboolean, GLuint>(a0); }
void GLAPIENTRY glPolygonOffset(GLfloat a0, GLfloat a1) { entry<Slot::PolygonOffset, void, GLfloat, GLfloat>(a0, a1); }
void GLAPIENTRY glTexSubImage1D(GLenum a0, GLint a1, GLint a2, GLsizei a3, GLenum a4, GLenum a5, const void* a6) {
  entry<Slot::TexSubImage1D, void, GLenum, GLint, GLint, GLsizei, GLenum, GLenum, const void*>(a0, a1, a2, a3, a4, a5,
                                                                                               a6);
}
void GLAPIENTRY glTexSubImage2D(GLenum a0, GLint a1, GLint a2, GLint a3, GLsizei a4, GLsizei a5, GLenum a6, GLenum a7,
                                const void* a8) {
  entry<Slot::TexSubImage2D, void, GLenum, GLint, GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, const void*>(
      a0, a1, a2, a3, a4, a5, a6, a7, a8);
}

}  // extern "C"

}  // namespace detail

}  // namespace lucerna
