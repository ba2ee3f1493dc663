// What the driver is and can do, and its debug messages.
#pragma once

#include "gl/api.hpp"

#include <string>
#include <utility>
#include <vector>

namespace lucerna::gl {

/// Strings, limits and the probed extensions. Nothing beyond OpenGL 4.3 core is used without a flag here.
struct Capabilities {
  std::string vendor, renderer, version, shadingLanguage;
  bool softwareRenderer = false;  ///< stage times then need glFinish and the wall clock beside the query

  // Probed extensions, each with its fall-back.
  bool clearTexture = false;        ///< ARB_clear_texture; else glTexSubImage3D of zeros
  bool anisotropicFilter = false;   ///< EXT/ARB_texture_filter_anisotropic; else trilinear
  bool shaderAtomicFloat = false;   ///< NV_shader_atomic_float: atomic LPV injection on r32f
  bool resetNotification = false;   ///< ARB_robustness, in a context that tells of resets: see throwIfReset
  bool shaderAtomicFp16Vector = false;  ///< NV_shader_atomic_fp16_vector: atomic LPV injection on rgba16f

  GLint maxTextureSize = 0, max3dTextureSize = 0, maxArrayTextureLayers = 0, maxTextureBufferSize = 0;
  GLint maxShaderStorageBlockSize = 0, maxComputeSharedMemory = 0, maxComputeInvocations = 0;
  GLint maxTextureImageUnits = 0, maxImageUnits = 0, maxColorAttachments = 0, maxSamples = 0;
  GLint maxGeometryOutputVertices = 0;
  float maxAnisotropy = 1.0f;
  int extensionCount = 0;

  /// (name, there is) of each probed extension, for `info`.
  std::vector<std::pair<std::string, bool>> probedExtensions() const;
  std::vector<std::pair<std::string, long>> limits() const;
};

/// Whether the driver tells of errors and hazards as they happen, by KHR_debug. It does so within the call at fault (GL_DEBUG_OUTPUT_SYNCHRONOUS), for
/// which drivers give up their own threads: for tests and verbose runs, not where anything is timed.
enum class DebugOutput { off, synchronous };
/// synchronous in a verbose run (LogLevel::verbose), else off.
DebugOutput defaultDebugOutput();

/// Throws where the driver has reset the GPU: from then on calls do nothing and pictures would be of nothing. To be asked when a submission that was waited
/// for is over, and once a frame. Needs a context that tells of resets (the hosts ask for one); else there is nothing to be known.
void throwIfReset();

/// Throws where a GL call failed since the last look: Error(missingCapability) where memory ran out, else Error(fault), with the error's name and
/// `after`, what was done last. Asked where something is allocated, where a result is read back and now and then in a frame: what goes wrong on the GPU is
/// never a black picture and exit code 0.
void throwIfError(const std::string& after);
/// The same for `bytes` of storage that were just asked for.
void throwIfNotAllocated(const std::string& name, std::size_t bytes);
/// Errors that were pending when the last context ended, empty where there were none; for the end of a command.
std::string takePendingErrors();

/// The context of the current host, as the engine sees it: probes it and listens to its debug output, where that is asked for.
/// Must outlive every gl object; one at a time.
class Context {
 public:
  explicit Context(DebugOutput debugOutput = defaultDebugOutput());
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Capabilities& capabilities() const { return capabilities_; }

  /// GL errors reported by the driver since the last call (KHR_debug type error where it is listened to, and glGetError). Tests fail on any.
  std::vector<std::string> takeErrors();

 private:
  Capabilities capabilities_;
  std::vector<std::string> errors_;
};

}  // namespace lucerna::gl
