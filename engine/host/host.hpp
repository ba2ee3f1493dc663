// Who owns the OpenGL context: a GLFW window, EGL without a surface, or OSMesa (off-screen, Mesa's software rasteriser).
//
// One executable holds all three. The rest of the engine draws into framebuffer objects only; framebuffer 0 exists in a
// window alone, so only a host presents.
#pragma once

#include <glm/glm.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace lucerna {

enum class HostKind { window, egl, osmesa };

std::string_view nameOf(HostKind kind);
/// "window", "egl" or "osmesa"; anything else throws Error(badInput) listing the three.
HostKind parseHostKind(std::string_view name);

struct HostOptions {
  glm::ivec2 windowSize{1280, 720};
  std::string windowTitle = "Lucerna";
  bool windowVisible = true;
  bool swapAtRefresh = true;  ///< a window waits for the display's refresh; off where frames a second are measured, which would be the display's
  bool debugContext = false;  ///< ask for a debug context where the host can
};

/// What the keyboard and mouse did since the last poll; empty without a window.
struct HostInput {
  bool closeRequested = false;
  glm::dvec2 mouseDelta{0.0};     ///< pixels, while the left button is held; +y down
  glm::dvec3 move{0.0};           ///< held keys: x right (D-A), y up (E-Q), z forward (W-S), each -1, 0 or 1
  bool fast = false;              ///< shift held
  std::string pressed;            ///< characters of the keys pressed since the last poll, upper case; Escape is '\x1b'
};

class Host {
 public:
  virtual ~Host() = default;
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// Makes a context of OpenGL 4.3 core or newer, current on the calling thread, and loads GLEW's pointers.
  /// Throws Error(missingCapability) saying what lacks. One host at a time.
  static std::unique_ptr<Host> create(HostKind kind, const HostOptions& options = {});

  /// The default where none is asked for: a window if `wantsWindow` and there is a display, else EGL where it gives a
  /// hardware renderer, else OSMesa.
  static std::unique_ptr<Host> createDefault(bool wantsWindow, const HostOptions& options = {});

  virtual HostKind kind() const = 0;
  /// Shows a framebuffer's first colour attachment (top row last, as GL keeps it) and waits for the swap. No effect off-screen.
  virtual void present(unsigned framebuffer, glm::ivec2 size) = 0;
  virtual HostInput poll() { return {}; }
  virtual glm::ivec2 framebufferSize() const = 0;
  virtual void setTitle(const std::string&) {}
  /// Refreshes of the display that present() waits for; none without a window.
  virtual std::optional<int> swapInterval() const { return {}; }

  /// Whether the renderer string names a software rasteriser (llvmpipe, softpipe): stage times then need glFinish.
  static bool isSoftwareRenderer(std::string_view renderer);

 protected:
  Host() = default;
};

/// Whether a window could be opened at all (DISPLAY or WAYLAND_DISPLAY set).
bool displayAvailable();

}  // namespace lucerna
