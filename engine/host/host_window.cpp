// A GLFW window: the walkthrough's host. The only one with a framebuffer 0.
#include "base/error.hpp"
#include "host/api.hpp"
#include "host/host_backends.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

namespace lucerna::detail {

namespace {

std::string g_lastGlfwError;

class WindowHost final : public Host {
 public:
  explicit WindowHost(const HostOptions& options) : swapInterval_(options.swapAtRefresh ? 1 : 0) {
    if (!displayAvailable())
      throwMissingCapability("host window: no display (neither DISPLAY nor WAYLAND_DISPLAY is set); try --host osmesa");
    glfwSetErrorCallback([](int, const char* text) { g_lastGlfwError = text; });
    if (!glfwInit()) throwMissingCapability("host window: {}", g_lastGlfwError);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debugContext ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_VISIBLE, options.windowVisible ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    for (const int robustness :
         {GLFW_LOSE_CONTEXT_ON_RESET, GLFW_NO_ROBUSTNESS}) {  // a context that reports resets, if possible
      glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, robustness);
      window_ =
          glfwCreateWindow(options.windowSize.x, options.windowSize.y, options.windowTitle.c_str(), nullptr, nullptr);
      if (window_) break;
    }
    if (!window_) {
      glfwTerminate();
      throwMissingCapability("host window: {}", g_lastGlfwError);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(swapInterval_);
    glfwSetWindowUserPointer(window_, this);
    listen();
    setGlLoader([](const char* name) { return reinterpret_cast<GlProc>(glfwGetProcAddress(name)); }, true);
  }
  ~WindowHost() override {
    setGlLoader(nullptr, false);
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  HostKind kind() const override { return HostKind::window; }

  void present(unsigned framebuffer, glm::ivec2 size) override {
    const glm::ivec2 target = framebufferSize();
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glDisable(GL_SCISSOR_TEST);
    glBlitFramebuffer(0, 0, size.x, size.y, 0, 0, target.x, target.y, GL_COLOR_BUFFER_BIT,
                      size == target ? GL_NEAREST : GL_LINEAR);
    glfwSwapBuffers(window_);
  }

  void pump(double seconds) override {
    if (seconds > 0.0) glfwWaitEventsTimeout(seconds);
    else glfwPollEvents();
    if (glfwWindowShouldClose(window_)) input_.close();
  }

  glm::ivec2 framebufferSize() const override {
    glm::ivec2 size;
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    return size;
  }

  bool isMinimised() const override { return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE; }

  std::optional<int> swapInterval() const override { return swapInterval_; }
  void setTitle(const std::string& title) override { glfwSetWindowTitle(window_, title.c_str()); }
  void setWindowSize(glm::ivec2 size) override { glfwSetWindowSize(window_, std::max(size.x, 1), std::max(size.y, 1)); }
  bool isFullScreen() const override { return glfwGetWindowMonitor(window_) != nullptr; }

  // On the monitor that holds the window's centre.
  void setFullScreen(bool on) override {
    if (on == isFullScreen()) return;
    if (!on) {
      glfwSetWindowMonitor(window_, nullptr, place_.x, place_.y, size_.x, size_.y, GLFW_DONT_CARE);
      return;
    }
    glfwGetWindowPos(window_, &place_.x, &place_.y);
    glfwGetWindowSize(window_, &size_.x, &size_.y);
    const glm::ivec2 centre = place_ + size_ / 2;
    int count = 0;
    GLFWmonitor** monitors = glfwGetMonitors(&count);
    GLFWmonitor* chosen = glfwGetPrimaryMonitor();
    for (int i = 0; i < count; ++i) {
      glm::ivec2 corner, extent;
      glfwGetMonitorWorkarea(monitors[i], &corner.x, &corner.y, &extent.x, &extent.y);
      if (glm::all(glm::greaterThanEqual(centre, corner)) && glm::all(glm::lessThan(centre, corner + extent)))
        chosen = monitors[i];
    }
    if (!chosen) return;
    const GLFWvidmode* mode = glfwGetVideoMode(chosen);
    glfwSetWindowMonitor(window_, chosen, 0, 0, mode->width, mode->height, mode->refreshRate);
    glfwSwapInterval(swapInterval_);  // some drivers forget it
  }
  void setSwapInterval(int interval) override {
    swapInterval_ = interval;
    glfwSwapInterval(interval);
  }
  float contentScale() const override {
    float x = 1.0f, y = 1.0f;
    glfwGetWindowContentScale(window_, &x, &y);
    return std::max(x, y);
  }
  void setClipboard(const std::string& text) override { glfwSetClipboardString(window_, text.c_str()); }
  std::string clipboard() const override {
    const char* text = glfwGetClipboardString(window_);
    return text ? text : "";
  }

 private:
  static InputState& inputOf(GLFWwindow* window) {
    return static_cast<WindowHost*>(glfwGetWindowUserPointer(window))->input_;
  }
  /// The key by what is printed on it: letters, and the punctuation that is bound to something, wherever the layout has
  /// them. All other keys, such as digits (which some layouts reach by shift alone), by their place.
  static int keyOf(int key, int scancode) {
    const char* name = key >= 32 && key < 127 ? glfwGetKeyName(key, scancode) : nullptr;
    if (!name || name[0] == 0 || name[1] != 0) return key;
    if (name[0] >= 'a' && name[0] <= 'z') return name[0] - 'a' + 'A';
    return name[0] == '-' || name[0] == '=' || name[0] == '[' || name[0] == ']' ? name[0] : key;
  }
  void listen() {
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scancode, int action, int) {
      inputOf(window).key(keyOf(key, scancode), action != GLFW_RELEASE);
    });
    glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned character) { inputOf(window).text(utf8(character)); });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
      if (button <= GLFW_MOUSE_BUTTON_MIDDLE)
        inputOf(window).button(static_cast<MouseButton>(button), action == GLFW_PRESS);
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
      glm::ivec2 points, pixels;  // cursor positions are in screen coordinates, which may differ from pixels
      glfwGetWindowSize(window, &points.x, &points.y);
      glfwGetFramebufferSize(window, &pixels.x, &pixels.y);
      inputOf(window).cursor(glm::dvec2(x, y) * glm::dvec2(pixels) / glm::dvec2(glm::max(points, glm::ivec2(1))));
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* window, double x, double y) { inputOf(window).wheel({x, y}); });
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** files) {
      for (int i = 0; i < count; ++i) inputOf(window).drop(files[i]);
    });
    glfwSetWindowRefreshCallback(window_, [](GLFWwindow* window) { inputOf(window).expose(); });
    glfwSetWindowIconifyCallback(window_, [](GLFWwindow* window, int) { inputOf(window).expose(); });
    glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int, int) { inputOf(window).expose(); });
    glfwSetWindowFocusCallback(window_,
                               [](GLFWwindow* window, int focused) { inputOf(window).focus(focused == GLFW_TRUE); });
  }
  static std::string utf8(unsigned c) {
    const auto byte = [](unsigned value) { return static_cast<char>(value); };
    if (c < 0x80) return {byte(c)};
    if (c < 0x800) return {byte(0xc0 | c >> 6), byte(0x80 | (c & 0x3f))};
    if (c < 0x10000) return {byte(0xe0 | c >> 12), byte(0x80 | (c >> 6 & 0x3f)), byte(0x80 | (c & 0x3f))};
    return {byte(0xf0 | c >> 18), byte(0x80 | (c >> 12 & 0x3f)), byte(0x80 | (c >> 6 & 0x3f)), byte(0x80 | (c & 0x3f))};
  }

  GLFWwindow* window_ = nullptr;
  int swapInterval_;
  glm::ivec2 place_{0}, size_{1280, 720};  ///< the window's before full screen
};

}  // namespace

std::unique_ptr<Host> createWindowHost(const HostOptions& options) { return std::make_unique<WindowHost>(options); }

}  // namespace lucerna::detail
