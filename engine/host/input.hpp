// Keyboard and mouse events since the last poll (no GL), filled by a window's callbacks or from a recorded input file.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <bitset>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// Keys: printable ones are their upper-case ASCII character on a US keyboard, others the values below (GLFW's).
namespace key {
inline constexpr int kEscape = 256, kEnter = 257, kTab = 258, kBackspace = 259, kInsert = 260, kDelete = 261,
                     kRight = 262, kLeft = 263, kDown = 264, kUp = 265, kPageUp = 266, kPageDown = 267, kHome = 268,
                     kEnd = 269, kF1 = 290, kF2 = 291, kF5 = 294, kF11 = 300, kF12 = 301, kLeftShift = 340,
                     kLeftControl = 341, kLeftAlt = 342, kRightShift = 344, kRightControl = 345, kRightAlt = 346,
                     kCount = 349;
/// "A", "F1", "space", "escape"; empty if a key has no name here.
std::string nameOf(int key);
/// The key of that name, any case; -1 if there is none.
int named(std::string_view name);
}  // namespace key

enum class MouseButton { left, right, middle };

struct KeyEvent {
  int key = 0;
  bool down = false;
  bool repeat = false;  ///< auto-repeat of a held key
  bool control = false, shift = false, alt = false;
};

/// Keyboard and mouse events since the last poll; empty without a window.
struct HostInput {
  bool closeRequested = false;
  std::vector<KeyEvent> keys;  ///< in order
  std::string text;  ///< typed text, UTF-8
  glm::dvec2 cursor{-1.0};  ///< framebuffer pixels, (0,0) top left
  std::array<bool, 3> buttons{};  ///< held, by MouseButton; also if pressed and released since the last poll
  glm::dvec2 wheel{0.0};  ///< steps; +y away from the user
  std::vector<std::filesystem::path> dropped;  ///< files dropped onto the window
  bool focused = true;

  // The same, prepared for first-person movement.
  glm::dvec2 mouseDelta{0.0};  ///< pixels, while the left button is held; +y down
  glm::dvec3 move{0.0};  ///< held keys: x right (D-A), y up (E-Q), z forward (W-S), each -1, 0 or 1
  bool fast = false;  ///< shift held
  std::string pressed;  ///< characters of the keys pressed since the last poll, upper case; Escape is '\x1b'
};

/// Collects events and hands them out frame by frame.
class InputState {
 public:
  void key(int key, bool down, bool repeat = false);
  void text(std::string_view utf8) { next_.text += utf8; }
  void cursor(const glm::dvec2& position) { cursor_ = position; }
  void button(MouseButton button, bool down);
  void wheel(const glm::dvec2& steps) { next_.wheel += steps; }
  void drop(const std::filesystem::path& file) { next_.dropped.push_back(file); }
  void close() { next_.closeRequested = true; }
  /// Releases all keys and buttons if the window loses focus, because no release events arrive then.
  void focus(bool focused);
  /// All events since the last call.
  HostInput take();

 private:
  bool held(int key) const { return keys_[static_cast<std::size_t>(key)]; }
  HostInput next_;
  std::bitset<key::kCount> keys_;
  std::array<bool, 3> buttons_{};
  glm::dvec2 cursor_{-1.0}, lastCursor_{-1.0};
  bool dragged_ = false;
};

}  // namespace lucerna
