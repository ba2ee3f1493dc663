// Owners of the OpenGL context: a GLFW window, EGL without a surface, or OSMesa (off-screen, Mesa's software renderer).
//
// One executable has all three. The rest of the engine draws only into framebuffer objects; framebuffer 0 exists only
// in a window, so only a host presents.
#pragma once

#include "base/log.hpp"
#include "base/named_values.hpp"
#include "host/input.hpp"

#include <glm/glm.hpp>

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

enum class HostKind { window, egl, osmesa };

constexpr std::array<std::string_view, 3> namesOf(HostKind) { return {"window", "egl", "osmesa"}; }
/// Throws Error(badInput) listing the three.
inline HostKind parseHostKind(std::string_view name) { return parseName<HostKind>(name, "--host"); }

struct HostOptions {
  glm::ivec2 windowSize{1280, 720};
  std::string windowTitle = "Lucerna";
  bool windowVisible = true;
  bool swapAtRefresh = true;  ///< wait for the display's refresh; off where frames per second are measured
  bool debugContext = logLevel() == LogLevel::verbose;  ///< where the host can: drivers say more in a debug context
};

class Host {
 public:
  virtual ~Host() = default;
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// Creates a context of OpenGL 4.3 core or newer, current on the calling thread, and loads GLEW's pointers.
  /// Throws Error(missingCapability) naming what is missing. One host at a time.
  static std::unique_ptr<Host> create(HostKind kind, const HostOptions& options = {});

  /// The default host: a window if `wantsWindow` and there is a display, else EGL if it gives a
  /// hardware renderer or LUCERNA_EGL_DEVICE chooses a device, else OSMesa, else EGL with a software renderer.
  static std::unique_ptr<Host> createDefault(bool wantsWindow, const HostOptions& options = {});

  virtual HostKind kind() const = 0;
  /// Shows a framebuffer's first colour attachment (top row last, as in GL) and waits for the swap. No effect
  /// off-screen.
  virtual void present(unsigned framebuffer, glm::ivec2 size) = 0;
  /// Queues what the user has done since the last call; with `seconds`, waits that long for something to happen.
  virtual void pump([[maybe_unused]] double seconds = 0.0) {}
  InputState& input() { return input_; }
  virtual glm::ivec2 framebufferSize() const = 0;
  /// Whether nobody can see the window. Its framebuffer may keep its size.
  virtual bool isMinimised() const { return false; }
  virtual void setTitle(const std::string&) {}

  // Only in a window; no effect elsewhere.
  virtual void setWindowSize(glm::ivec2) {}
  virtual void setFullScreen(bool) {}
  virtual bool isFullScreen() const { return false; }
  virtual void setSwapInterval(int) {}
  /// Scale of text and controls relative to 96 dots per inch: the system's scale for this window.
  virtual float contentScale() const { return 1.0f; }
  virtual void setClipboard(const std::string&) {}
  virtual std::string clipboard() const { return {}; }

  /// Number of display refreshes that present() waits for; none without a window.
  virtual std::optional<int> swapInterval() const { return {}; }

  /// Whether the renderer string names a software renderer (llvmpipe, softpipe): stage times then need glFinish.
  static bool isSoftwareRenderer(std::string_view renderer);

 protected:
  Host() = default;
  InputState input_;
};

/// Whether OSMesa was built in and its library can be loaded.
bool osmesaAvailable();

/// A device enumerated by EGL, described without a context.
struct EglDevice {
  enum class Kind { discrete, unknown, integrated, software };
  Kind kind = Kind::unknown;
  std::string driver;  ///< of the kernel or of EGL: "amdgpu", "i915", "swrast"; empty if unknown
  std::string node;  ///< "/dev/dri/renderD128"; may be empty
  std::string pci;  ///< vendor:device, "1002:73bf"; empty if not on PCI
  double videoBytes = 0.0;  ///< dedicated memory, if the kernel reports it (amdgpu)
};

std::string_view nameOf(EglDevice::Kind kind);

/// In EGL's order, as counted by LUCERNA_EGL_DEVICE=N. Empty without EGL or its extension for devices.
std::vector<EglDevice> eglDevices();

/// Indices into eglDevices() in the order in which host egl tries them: discrete, unknown, integrated, software; among
/// equals the one with more dedicated memory first, then EGL's order.
std::vector<std::size_t> eglPreference(const std::vector<EglDevice>& devices);

/// Describes a device's render node; `sys` is /sys except in tests. Heuristics, since no interface says "discrete".
/// NVIDIA (PCI vendor 10de): discrete. Intel (8086): integrated on PCI bus 0, else discrete. AMD (1002): discrete from
/// 2 GiB of video memory on; an APU has less, unless its firmware is configured otherwise. No PCI device: integrated
/// (part of the chip). Others, including virtual ones: unknown.
EglDevice describeRenderNode(const std::filesystem::path& node, const std::filesystem::path& sys = "/sys");

/// Whether a window could be opened (DISPLAY or WAYLAND_DISPLAY set).
bool displayAvailable();

}  // namespace lucerna
