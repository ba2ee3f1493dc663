// The driver's identity, capabilities and debug messages.
#pragma once

#include "host/api.hpp"

#include <string>
#include <utility>
#include <vector>

namespace lucerna::gl {

/// Strings, limits and the probed extensions. Nothing beyond OpenGL 4.3 core is used without a flag here.
struct Capabilities {
  std::string vendor, renderer, version, shadingLanguage;
  bool softwareRenderer = false;  ///< stage times then need glFinish and the wall clock

  // Probed extensions, each with its fall-back.
  bool clearTexture = false;  ///< ARB_clear_texture; else glTexSubImage3D of zeros
  bool anisotropicFilter = false;  ///< EXT/ARB_texture_filter_anisotropic; else trilinear
  bool shaderAtomicFloat = false;  ///< NV_shader_atomic_float: atomic LPV injection on r32f
  bool resetNotification = false;  ///< ARB_robustness, in a context that reports resets: see throwIfReset
  bool shaderAtomicFp16Vector = false;  ///< NV_shader_atomic_fp16_vector: atomic LPV injection on rgba16f

  GLint maxTextureSize = 0, max3dTextureSize = 0, maxArrayTextureLayers = 0, maxTextureBufferSize = 0;
  GLint maxShaderStorageBlockSize = 0, maxComputeSharedMemory = 0, maxComputeInvocations = 0;
  GLint maxTextureImageUnits = 0, maxImageUnits = 0, maxColorAttachments = 0, maxSamples = 0;
  GLint maxGeometryOutputVertices = 0;
  float maxAnisotropy = 1.0f;
  int extensionCount = 0;

  /// (name, available) of each probed extension, for `info`.
  std::vector<std::pair<std::string, bool>> probedExtensions() const;
  std::vector<std::pair<std::string, long>> limits() const;
};

/// Whether the driver reports errors and hazards as they happen (KHR_debug). It does so within the failing call
/// (GL_DEBUG_OUTPUT_SYNCHRONOUS), for which drivers disable their own threads: for tests and verbose runs, not for
/// measurements.
enum class DebugOutput { off, synchronous };
/// synchronous in a verbose run (LogLevel::verbose), else off.
DebugOutput defaultDebugOutput();

/// Throws if the driver has reset the GPU: from then on calls have no effect and pictures would be empty. Call it after
/// waiting for a submission and once per frame. Needs a context that reports resets (the hosts ask for one); otherwise
/// it has no effect.
void throwIfReset();

/// Throws if a GL call has failed since the last check: Error(missingCapability) if memory ran out, else Error(fault),
/// with the error's name and `after`, the last operation. Called after allocations and read-backs, and now and then in
/// a frame, so that a GPU failure is never a black picture and exit code 0.
void throwIfError(const std::string& after);
/// The same for `bytes` of storage that were just requested.
void throwIfNotAllocated(const std::string& name, std::size_t bytes);
/// Errors and findings (Context::takeErrors) pending when the last context ended, or an empty string; for the end of a
/// command.
std::string takePendingErrors();

/// The context of the current host: probes it and listens to its debug output if requested.
/// Must outlive every gl object; one at a time.
class Context {
 public:
  explicit Context(DebugOutput debugOutput = defaultDebugOutput());
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Capabilities& capabilities() const { return capabilities_; }

  /// GL errors reported by the driver since the last call (KHR_debug errors if listening, and glGetError), and findings
  /// of the barrier ledger (gl/barrier_ledger.hpp). Tests fail on any.
  std::vector<std::string> takeErrors();

 private:
  Capabilities capabilities_;
  std::vector<std::string> errors_;
};

}  // namespace lucerna::gl
