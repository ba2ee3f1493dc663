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

/// The context of the current host, as the engine sees it: probes it and listens to its debug output.
/// Must outlive every gl object; one at a time.
class Context {
 public:
  Context();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Capabilities& capabilities() const { return capabilities_; }

  /// GL errors reported by the driver since the last call (KHR_debug type error, and glGetError). Tests fail on any.
  std::vector<std::string> takeErrors();

 private:
  Capabilities capabilities_;
  std::vector<std::string> errors_;
};

}  // namespace lucerna::gl
