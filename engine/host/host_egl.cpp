// EGL without a surface: a context on a GPU (or on Mesa's software driver) without a display server.
// Devices are enumerated (vendor drivers have no surfaceless platform) and tried in the order of eglPreference; if
// LUCERNA_EGL_DEVICE names a device, only that one is tried. Mesa's surfaceless platform comes before software devices.
#include "base/error.hpp"
#include "host/egl_device.hpp"
#include "host/host_backends.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <optional>
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

/// EGL functions without a display, which enumerate devices.
struct DeviceFunctions {
  PFNEGLGETPLATFORMDISPLAYEXTPROC getPlatformDisplay = nullptr;
  PFNEGLQUERYDEVICESEXTPROC queryDevices = nullptr;
  PFNEGLQUERYDEVICESTRINGEXTPROC queryString = nullptr;

  DeviceFunctions() {
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    getPlatformDisplay =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (!hasExtension(extensions, "EGL_EXT_device_enumeration") && !hasExtension(extensions, "EGL_EXT_device_base"))
      return;
    queryDevices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    queryString = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(eglGetProcAddress("eglQueryDeviceStringEXT"));
  }
  std::vector<EGLDeviceEXT> devices() const {
    EGLint count = 0;
    if (!queryDevices || !queryDevices(0, nullptr, &count)) return {};
    std::vector<EGLDeviceEXT> all(static_cast<std::size_t>(count));
    if (!queryDevices(count, all.data(), &count)) return {};
    all.resize(static_cast<std::size_t>(count));
    return all;
  }
  EGLDisplay display(EGLDeviceEXT device) const {
    return getPlatformDisplay ? getPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device, nullptr) : EGL_NO_DISPLAY;
  }
  EglDevice describe(EGLDeviceEXT device) const {
    const char* extensions = queryString ? queryString(device, EGL_EXTENSIONS) : nullptr;
    EglDevice result;
    if (hasExtension(extensions, "EGL_MESA_device_software")) {
      result.kind = EglDevice::Kind::software;
      result.driver = "Mesa's software rasteriser";
      return result;
    }
    const char* node = nullptr;
    if (hasExtension(extensions, "EGL_EXT_device_drm_render_node"))
      node = queryString(device, EGL_DRM_RENDER_NODE_FILE_EXT);
    if (!node && hasExtension(extensions, "EGL_EXT_device_drm")) node = queryString(device, EGL_DRM_DEVICE_FILE_EXT);
    if (node) result = describeRenderNode(node);
    // NVIDIA's own driver, if its module has no node.
    if (!node && hasExtension(extensions, "EGL_NV_device_cuda"))
      result.kind = EglDevice::Kind::discrete, result.driver = "nvidia";
    return result;
  }
};

std::string firstLine(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

/// "0x1002" without its 0x.
std::string hexDigits(const std::filesystem::path& file) {
  const std::string line = firstLine(file);
  return line.starts_with("0x") ? line.substr(2) : line;
}

/// The displays to try, one after the other. Throws Error(badInput) for an unknown LUCERNA_EGL_DEVICE.
std::vector<EGLDisplay> candidateDisplays() {
  const DeviceFunctions egl;
  const std::vector<EGLDeviceEXT> handles = egl.devices();
  std::vector<EglDevice> devices;
  for (EGLDeviceEXT device : handles) devices.push_back(egl.describe(device));

  if (const auto chosen = chosenEglDevice()) return {egl.display(handles[eglDeviceNamed(*chosen, devices)])};

  // Mesa's surfaceless platform comes after the devices and before software: it may know hardware that is not
  // enumerated.
  EGLDisplay surfaceless = EGL_NO_DISPLAY;
  if (egl.getPlatformDisplay &&
      hasExtension(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless"))
    surfaceless = egl.getPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  std::vector<EGLDisplay> displays, software;
  for (std::size_t i : eglPreference(devices))
    (devices[i].kind == EglDevice::Kind::software ? software : displays).push_back(egl.display(handles[i]));
  displays.push_back(surfaceless);
  displays.insert(displays.end(), software.begin(), software.end());
  return displays;
}

class EglHost final : public Host {
 public:
  explicit EglHost(const HostOptions& options) {
    std::string reason = "no EGL display";
    for (EGLDisplay display : candidateDisplays()) {
      if (display == EGL_NO_DISPLAY) continue;
      if (!eglInitialize(display, nullptr, nullptr)) {
        reason = "eglInitialize fails";
        continue;
      }
      if (makeContext(display, options)) return;
      reason = "no OpenGL 4.3 core context without a surface";
      eglTerminate(display);
    }
    if (const auto chosen = chosenEglDevice())
      throwMissingCapability("host egl: device {} (LUCERNA_EGL_DEVICE): {}", *chosen, reason);
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
    // A context that reports resets if possible: by EGL 1.5 or EGL_KHR_create_context, else by
    // EGL_EXT_create_context_robustness.
    EGLContext context = EGL_NO_CONTEXT;
    for (const auto& [reset, strategy] :
         {std::pair<EGLint, EGLint>{EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET},
          {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT, EGL_LOSE_CONTEXT_ON_RESET_EXT},
          {EGL_NONE, EGL_NONE}}) {
      if (reset == EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT &&
          !hasExtension(extensions, "EGL_EXT_create_context_robustness"))
        continue;
      const EGLint contextAttributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                          4,
                                          EGL_CONTEXT_MINOR_VERSION,
                                          3,
                                          EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                          EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                          EGL_CONTEXT_OPENGL_DEBUG,
                                          options.debugContext ? EGL_TRUE : EGL_FALSE,
                                          reset,
                                          strategy,
                                          EGL_NONE};
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

std::optional<std::string> chosenEglDevice() {
  const char* value = std::getenv("LUCERNA_EGL_DEVICE");
  return value && *value ? std::optional<std::string>(value) : std::nullopt;
}

std::unique_ptr<Host> createEglHost(const HostOptions& options) { return std::make_unique<EglHost>(options); }

}  // namespace lucerna::detail

namespace lucerna {

std::string_view nameOf(EglDevice::Kind kind) {
  switch (kind) {
    case EglDevice::Kind::discrete: return "discrete";
    case EglDevice::Kind::unknown: return "unknown";
    case EglDevice::Kind::integrated: return "integrated";
    case EglDevice::Kind::software: return "software";
  }
  return "?";
}

std::vector<EglDevice> eglDevices() {
  const detail::DeviceFunctions egl;
  std::vector<EglDevice> devices;
  for (EGLDeviceEXT device : egl.devices()) devices.push_back(egl.describe(device));
  return devices;
}

std::vector<std::size_t> eglPreference(const std::vector<EglDevice>& devices) {
  std::vector<std::size_t> order(devices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (devices[a].kind != devices[b].kind) return devices[a].kind < devices[b].kind;
    return devices[a].videoBytes > devices[b].videoBytes;
  });
  return order;
}

EglDevice describeRenderNode(const std::filesystem::path& node, const std::filesystem::path& sys) {
  EglDevice device;
  device.node = node.string();
  std::error_code missing;
  const std::filesystem::path entry =
      std::filesystem::canonical(sys / "class/drm" / node.filename() / "device", missing);
  if (missing) return device;
  device.driver = std::filesystem::read_symlink(entry / "driver", missing).filename().string();
  const std::string vendor = detail::hexDigits(entry / "vendor");
  if (vendor.empty()) {
    device.kind = EglDevice::Kind::integrated;
    return device;
  }
  device.pci = vendor + ":" + detail::hexDigits(entry / "device");
  device.videoBytes = std::strtod(detail::firstLine(entry / "mem_info_vram_total").c_str(), nullptr);
  const std::string slot = entry.filename().string();  // domain:bus:device.function
  if (vendor == "10de") device.kind = EglDevice::Kind::discrete;
  if (vendor == "8086")
    device.kind = slot.starts_with("0000:00:") ? EglDevice::Kind::integrated : EglDevice::Kind::discrete;
  if (vendor == "1002")
    device.kind = device.videoBytes >= 0x1p31 ? EglDevice::Kind::discrete : EglDevice::Kind::integrated;
  return device;
}

}  // namespace lucerna
