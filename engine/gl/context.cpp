#include "gl/context.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "gl/barrier_ledger.hpp"
#include "gl/limits.hpp"
#include "gl/wait.hpp"
#include "host/host.hpp"

#include <set>

namespace lucerna::gl {

namespace {

std::string string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

void GLAPIENTRY onDebugMessage(GLenum, GLenum type, GLuint, GLenum severity, GLsizei, const GLchar* message,
                               const void* user) {
  if (type == GL_DEBUG_TYPE_ERROR) {
    logVerbose("OpenGL error: {}", message);
    static_cast<std::vector<std::string>*>(const_cast<void*>(user))->emplace_back(message);
  } else if (severity == GL_DEBUG_SEVERITY_HIGH || type == GL_DEBUG_TYPE_PERFORMANCE) {
    logVerbose("OpenGL: {}", message);
  }
}

std::string g_pendingErrors;

/// Of OpenGL 4.5 and KHR_robustness: the error of every call after a reset.
constexpr GLenum kContextLost = 0x0507;

const char* nameOfError(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM: return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE: return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION: return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION: return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY: return "GL_OUT_OF_MEMORY";
    case GL_STACK_OVERFLOW: return "GL_STACK_OVERFLOW";
    case GL_STACK_UNDERFLOW: return "GL_STACK_UNDERFLOW";
    case kContextLost: return "GL_CONTEXT_LOST";
    default: return "an unknown error";
  }
}

/// The first error since the last check, GL_OUT_OF_MEMORY before others. A lost context reports errors forever.
GLenum firstError() {
  GLenum first = GL_NO_ERROR;
  GLenum error = glGetError();
  for (int i = 0; error != GL_NO_ERROR && i < 16; ++i, error = glGetError())
    if (first == GL_NO_ERROR || error == GL_OUT_OF_MEMORY) first = error;
  return first;
}

/// outOfMemory: the message if memory ran out; place: the last operation, for every other error.
void throwFirstError(const std::string& outOfMemory, const std::string& place) {
  const GLenum error = firstError();
  if (error == GL_OUT_OF_MEMORY) throwMissingCapability("{}", outOfMemory);
  if (error == kContextLost) {
    throwIfReset();
    throw Error(ErrorKind::missingCapability, "the driver reset the GPU: cannot continue");
  }
  if (error != GL_NO_ERROR)
    throw Error(ErrorKind::fault, fmt::format("internal error: OpenGL reports {} ({})", nameOfError(error), place));
}

}  // namespace

void throwIfError(const std::string& after) { throwFirstError("the driver is out of memory (" + after + ")", after); }

void throwIfNotAllocated(const std::string& name, std::size_t bytes) {
  throwFirstError(fmt::format("{}: the driver cannot allocate {} bytes", name, bytes),
                  fmt::format("{}, {} bytes", name, bytes));
}

std::string takePendingErrors() { return std::exchange(g_pendingErrors, {}); }

std::vector<std::pair<std::string, bool>> Capabilities::probedExtensions() const {
  return {{"ARB_clear_texture", clearTexture},
          {"texture_filter_anisotropic", anisotropicFilter},
          {"reset notification", resetNotification},
          {"NV_shader_atomic_float", shaderAtomicFloat},
          {"NV_shader_atomic_fp16_vector", shaderAtomicFp16Vector}};
}

std::vector<std::pair<std::string, long>> Capabilities::limits() const {
  return {{"texture size", maxTextureSize},
          {"3D texture size", max3dTextureSize},
          {"array texture layers", maxArrayTextureLayers},
          {"buffer texels", maxTextureBufferSize},
          {"colour attachments", maxColorAttachments},
          {"texture units a stage", maxTextureImageUnits},
          {"image units", maxImageUnits},
          {"samples", maxSamples},
          {"geometry output vertices", maxGeometryOutputVertices},
          {"storage block bytes", maxShaderStorageBlockSize},
          {"compute shared memory bytes", maxComputeSharedMemory},
          {"compute invocations a group", maxComputeInvocations},
          {"anisotropy", static_cast<long>(maxAnisotropy)}};
}

void throwIfReset() {
  if (!glGetGraphicsResetStatusARB) return;
  const GLenum status = glGetGraphicsResetStatusARB();
  if (status == GL_NO_ERROR) return;
  const bool ours = status == GL_GUILTY_CONTEXT_RESET_ARB;
  const char* whose = ours ? "because of work of this program that took too long or failed"
                      : status == GL_INNOCENT_CONTEXT_RESET_ARB ? "because of work of another program"
                                                                : "and does not say because of whose work";
  throw Error(ours ? ErrorKind::fault : ErrorKind::missingCapability,
              fmt::format("the driver reset the GPU {}: cannot continue", whose));
}

DebugOutput defaultDebugOutput() {
  return logLevel() == LogLevel::verbose ? DebugOutput::synchronous : DebugOutput::off;
}

Context::Context(DebugOutput debugOutput) {
  Capabilities& c = capabilities_;
  c.vendor = string(GL_VENDOR);
  c.renderer = string(GL_RENDERER);
  c.version = string(GL_VERSION);
  c.shadingLanguage = string(GL_SHADING_LANGUAGE_VERSION);
  c.softwareRenderer = Host::isSoftwareRenderer(c.renderer);

  setWaitLimit(c.softwareRenderer ? 0.0 : kGpuSeconds);

  std::set<std::string> extensions;
  glGetIntegerv(GL_NUM_EXTENSIONS, &c.extensionCount);
  for (GLint i = 0; i < c.extensionCount; ++i)
    extensions.emplace(reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i))));
  const auto has = [&](const char* name) { return extensions.contains(name); };
  c.clearTexture = has("GL_ARB_clear_texture") && glClearTexImage;
  c.anisotropicFilter = has("GL_EXT_texture_filter_anisotropic") || has("GL_ARB_texture_filter_anisotropic");
  c.shaderAtomicFloat = has("GL_NV_shader_atomic_float");
  c.shaderAtomicFp16Vector = has("GL_NV_shader_atomic_fp16_vector");

  if (has("GL_ARB_robustness") && glGetGraphicsResetStatusARB) {
    GLint strategy = 0;
    glGetIntegerv(GL_RESET_NOTIFICATION_STRATEGY_ARB, &strategy);
    c.resetNotification = strategy == GL_LOSE_CONTEXT_ON_RESET_ARB;
  }

  c.maxTextureSize = limit(GL_MAX_TEXTURE_SIZE);
  c.max3dTextureSize = limit(GL_MAX_3D_TEXTURE_SIZE);
  c.maxArrayTextureLayers = limit(GL_MAX_ARRAY_TEXTURE_LAYERS);
  c.maxTextureBufferSize = limit(GL_MAX_TEXTURE_BUFFER_SIZE);
  c.maxShaderStorageBlockSize = limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
  c.maxComputeSharedMemory = limit(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
  c.maxComputeInvocations = limit(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
  c.maxTextureImageUnits = limit(GL_MAX_TEXTURE_IMAGE_UNITS);
  c.maxImageUnits = limit(GL_MAX_IMAGE_UNITS);
  c.maxColorAttachments = limit(GL_MAX_COLOR_ATTACHMENTS);
  c.maxSamples = limit(GL_MAX_SAMPLES);
  c.maxGeometryOutputVertices = limit(GL_MAX_GEOMETRY_OUTPUT_VERTICES);
  if (c.anisotropicFilter) glGetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY_EXT, &c.maxAnisotropy);

  if (debugOutput == DebugOutput::synchronous) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(onDebugMessage, &errors_);
  } else {
    glDisable(GL_DEBUG_OUTPUT);  // on by default in a debug context
    glDisable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  }
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
}

Context::~Context() {
  glDebugMessageCallback(nullptr, nullptr);
  for (const std::string& error : takeErrors()) g_pendingErrors += (g_pendingErrors.empty() ? "" : "; ") + error;
}

std::vector<std::string> Context::takeErrors() {
  if (const GLenum error = firstError(); error != GL_NO_ERROR && errors_.empty()) errors_.push_back(nameOfError(error));
  if (BarrierLedger* ledger = barrierLedger())
    for (std::string& finding : ledger->takeFindings()) errors_.push_back(std::move(finding));
  return std::exchange(errors_, {});
}

}  // namespace lucerna::gl
