// EGL without a surface: a context on a GPU (or on Mesa's software driver) without a display server.
// Devices are enumerated first, hardware before software (a vendor's driver gives no surfaceless platform); Mesa's surfaceless
// platform is the fall-back.
#include "base/error.hpp"
#include "host/host_backends.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna::detail {

namespace {

bool hasExtension(const char* list, std::string_view name) {
  const std::string_view text = list ? list : "";
  for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if ((at == 0 || text[at - 1] == ' ') && (end == text.size() || text[end] == ' ')) return true;
  }
  return false;
}

std::vector<EGLDisplay> candidateDisplays() {
  std::vector<EGLDisplay> hardware, software;
  const char* clientExtensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto getPlatformDisplay =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (!getPlatformDisplay) return {};
  if (hasExtension(clientExtensions, "EGL_EXT_device_enumeration") || hasExtension(clientExtensions, "EGL_EXT_device_base")) {
    const auto queryDevices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    const auto queryString = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(eglGetProcAddress("eglQueryDeviceStringEXT"));
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    if (queryDevices && queryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count))
      for (EGLint i = 0; i < count; ++i) {
        const EGLDisplay display = getPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr);
        if (display == EGL_NO_DISPLAY) continue;
        const char* extensions = queryString ? queryString(devices[static_cast<std::size_t>(i)], EGL_EXTENSIONS) : nullptr;
        (hasExtension(extensions, "EGL_MESA_device_software") ? software : hardware).push_back(display);
      }
  }
  if (hasExtension(clientExtensions, "EGL_MESA_platform_surfaceless")) {
    const EGLDisplay display = getPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY) hardware.push_back(display);
  }
  hardware.insert(hardware.end(), software.begin(), software.end());
  return hardware;
}

class EglHost final : public Host {
 public:
  explicit EglHost(const HostOptions& options) {
    std::string reason = "no EGL display";
    for (EGLDisplay display : candidateDisplays()) {
      if (!eglInitialize(display, nullptr, nullptr)) {
        reason = "eglInitialize fails";
        continue;
      }
      if (makeContext(display, options)) return;
      reason = "no OpenGL 4.3 core context without a surface";
      eglTerminate(display);
    }
    throwMissingCapability("host egl: {}", reason);
  }
  ~EglHost() override {
    setGlLoader(nullptr, false);
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }
  HostKind kind() const override { return HostKind::egl; }
  void present(unsigned, glm::ivec2) override {}
  glm::ivec2 framebufferSize() const override { return {1, 1}; }

 private:
  bool makeContext(EGLDisplay display, const HostOptions& options) {
    const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (!hasExtension(extensions, "EGL_KHR_surfaceless_context")) return false;
    if (!eglBindAPI(EGL_OPENGL_API)) return false;
    const EGLint configAttributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display, configAttributes, &config, 1, &count) || count == 0) {
      if (!hasExtension(extensions, "EGL_KHR_no_config_context")) return false;
      config = nullptr;  // EGL_NO_CONFIG_KHR
    }
    // A context that tells of resets where that can be had: by EGL 1.5 or EGL_KHR_create_context, else by EGL_EXT_create_context_robustness.
    EGLContext context = EGL_NO_CONTEXT;
    for (const auto& [reset, strategy] : {std::pair<EGLint, EGLint>{EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET},
                                          {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT, EGL_LOSE_CONTEXT_ON_RESET_EXT},
                                          {EGL_NONE, EGL_NONE}}) {
      if (reset == EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT && !hasExtension(extensions, "EGL_EXT_create_context_robustness")) continue;
      const EGLint contextAttributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 3,
                                          EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                          EGL_CONTEXT_OPENGL_DEBUG, options.debugContext ? EGL_TRUE : EGL_FALSE, reset, strategy, EGL_NONE};
      context = eglCreateContext(display, config, EGL_NO_CONTEXT, contextAttributes);
      if (context != EGL_NO_CONTEXT) break;
    }
    if (context == EGL_NO_CONTEXT) return false;
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
      eglDestroyContext(display, context);
      return false;
    }
    display_ = display;
    context_ = context;
    setGlLoader([](const char* name) { return reinterpret_cast<GlProc>(eglGetProcAddress(name)); }, false);
    return true;
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<Host> createEglHost(const HostOptions& options) { return std::make_unique<EglHost>(options); }

}  // namespace lucerna::detail
