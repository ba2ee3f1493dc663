// Keyboard and mouse events (no GL), filled by a window's callbacks or from a recorded input file.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <bitset>
#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// Keys: printable ones are the upper-case ASCII character on them, whatever the keyboard's layout; those without one
/// are named by their place on a US keyboard. Others are the values below (GLFW's).
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
  bool control = false, shift = false, alt = false;
};

/// What happened in one step of input. Empty without a window.
struct HostInput {
  bool closeRequested = false;
  std::vector<KeyEvent> keys;  ///< in order, none twice
  std::string text;  ///< typed text, UTF-8
  glm::dvec2 cursor{-1.0};  ///< framebuffer pixels, (0,0) top left
  std::array<bool, 3> buttons{};  ///< held, by MouseButton
  glm::dvec2 wheel{0.0};  ///< steps; +y away from the user
  std::vector<std::filesystem::path> dropped;  ///< files dropped onto the window
  bool focused = true;

  bool holds(MouseButton button) const { return buttons[static_cast<std::size_t>(button)]; }
  bool holdsAnyButton() const { return buttons != std::array<bool, 3>{}; }

  // The same, prepared for first-person movement.
  glm::dvec2 mouseDelta{0.0};  ///< pixels, while a button is held; +y down
  glm::dvec3 move{0.0};  ///< held keys: x right (D-A), y up (E-Q), z forward (W-S), each -1, 0 or 1
  bool fast = false;  ///< shift held
  std::string pressed;  ///< characters of the keys pressed in this step, upper case; Escape is '\x1b'
};

/// Queues events and hands them out step by step. However long a frame takes, none is lost, and each step is one that a
/// user interface of one frame can tell: no key or button changes twice, and a click, a typed text or an editing key
/// starts a new step where the order of both matters.
class InputState {
 public:
  void key(int key, bool down);
  void text(std::string_view utf8);
  void cursor(const glm::dvec2& position);
  void button(MouseButton button, bool down);
  void wheel(const glm::dvec2& steps) { open().wheel += steps; }
  void drop(const std::filesystem::path& file) { open().dropped.push_back(file); }
  void expose() { open(); }  ///< the window's content was lost: a step in which nothing is done
  void close() { open().closeRequested = true; }
  /// Releases all keys and buttons if the window loses focus, because no release events arrive then.
  void focus(bool focused);
  /// Whether a step waits.
  bool waits() const { return !steps_.empty(); }
  /// The oldest step that waits; if there is none, what is held.
  HostInput take();
  /// Whether Escape was pressed in a step that waits. It is taken out, so that nothing else acts on it.
  bool takeEscape();
  /// Whether the window was asked to close in a step that waits.
  bool closes() const;

 private:
  struct Step {
    HostInput input;
    bool clicked = false, edited = false;  ///< a button changed; a key without a character went down
  };
  bool held(int key) const { return keys_[static_cast<std::size_t>(key)]; }
  HostInput& open(bool anew = false);
  void noteHeld(HostInput& input) const;

  std::deque<Step> steps_;
  std::bitset<key::kCount> keys_;
  std::array<bool, 3> buttons_{};
  glm::dvec2 cursor_{-1.0}, lastCursor_{-1.0};  ///< of the last event; of the last step handed out
  bool focused_ = true;
  bool dragged_ = false;
};

}  // namespace lucerna
