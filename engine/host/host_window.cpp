// A GLFW window: the walkthrough's host. The only one with a framebuffer 0.
#include "base/error.hpp"
#include "gl/api.hpp"
#include "host/host_backends.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <utility>

namespace lucerna::detail {

namespace {

std::string g_lastGlfwError;

class WindowHost final : public Host {
 public:
  explicit WindowHost(const HostOptions& options) : swapInterval_(options.swapAtRefresh ? 1 : 0) {
    if (!displayAvailable()) throwMissingCapability("host window: no display (neither DISPLAY nor WAYLAND_DISPLAY is set); try --host osmesa");
    glfwSetErrorCallback([](int, const char* text) { g_lastGlfwError = text; });
    if (!glfwInit()) throwMissingCapability("host window: {}", g_lastGlfwError);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debugContext ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_VISIBLE, options.windowVisible ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    for (const int robustness : {GLFW_LOSE_CONTEXT_ON_RESET, GLFW_NO_ROBUSTNESS}) {  // a context that reports resets, if possible
      glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, robustness);
      window_ = glfwCreateWindow(options.windowSize.x, options.windowSize.y, options.windowTitle.c_str(), nullptr, nullptr);
      if (window_) break;
    }
    if (!window_) {
      glfwTerminate();
      throwMissingCapability("host window: {}", g_lastGlfwError);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(swapInterval_);
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
      if (action != GLFW_PRESS) return;
      auto* self = static_cast<WindowHost*>(glfwGetWindowUserPointer(window));
      if (key == GLFW_KEY_ESCAPE) self->pressed_ += '\x1b';
      else if (key >= GLFW_KEY_SPACE && key <= GLFW_KEY_GRAVE_ACCENT) self->pressed_ += static_cast<char>(key);
    });
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
    glBlitFramebuffer(0, 0, size.x, size.y, 0, 0, target.x, target.y, GL_COLOR_BUFFER_BIT, size == target ? GL_NEAREST : GL_LINEAR);
    glfwSwapBuffers(window_);
  }

  HostInput poll() override {
    glfwPollEvents();
    HostInput input;
    input.closeRequested = glfwWindowShouldClose(window_);
    const auto held = [&](int key) { return glfwGetKey(window_, key) == GLFW_PRESS ? 1.0 : 0.0; };
    input.move = {held(GLFW_KEY_D) - held(GLFW_KEY_A), held(GLFW_KEY_E) - held(GLFW_KEY_Q), held(GLFW_KEY_W) - held(GLFW_KEY_S)};
    input.fast = held(GLFW_KEY_LEFT_SHIFT) + held(GLFW_KEY_RIGHT_SHIFT) > 0.0;
    glm::dvec2 mouse;
    glfwGetCursorPos(window_, &mouse.x, &mouse.y);
    const bool dragging = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
    if (dragging && dragging_) input.mouseDelta = mouse - mouse_;
    dragging_ = dragging;
    mouse_ = mouse;
    input.pressed = std::exchange(pressed_, {});
    return input;
  }

  glm::ivec2 framebufferSize() const override {
    glm::ivec2 size;
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    return size;
  }

  std::optional<int> swapInterval() const override { return swapInterval_; }
  void setTitle(const std::string& title) override { glfwSetWindowTitle(window_, title.c_str()); }

 private:
  GLFWwindow* window_ = nullptr;
  int swapInterval_;
  std::string pressed_;
  glm::dvec2 mouse_{0.0};
  bool dragging_ = false;
};

}  // namespace

std::unique_ptr<Host> createWindowHost(const HostOptions& options) { return std::make_unique<WindowHost>(options); }

}  // namespace lucerna::detail
