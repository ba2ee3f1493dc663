// Dear ImGui on the engine's terms: input comes from the host's HostInput, triangles are drawn by gl::Overlay. Debian's
// ImGui backend is not used: it opens libGL.so.1 itself and so bypasses EGL and OSMesa. The panel works on every host.
// Compiles with Dear ImGui 1.86 (Debian 12) to 1.92.
//
// Controls are registered through the functions below by their labels, so that recorded input can find them by name
// (walk/input_file.hpp) wherever they are.
#pragma once

#include "gl/overlay.hpp"
#include "host/host.hpp"

#include <imgui.h>

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace lucerna::demo {

class Ui {
 public:
  /// scale: size of text and controls; 1 for 96 dots per inch.
  Ui(gl::ProgramLibrary& programs, Host& host, float scale);
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  /// Begins a frame of `size` pixels. ImGui's functions may be called until end().
  void begin(const HostInput& input, glm::ivec2 size, double seconds);
  /// Begins a frame for a note during long work. The panel is not part of it: what is being dragged there stays held.
  void beginNote(glm::ivec2 size, double seconds);
  /// Draws the frame over the target.
  void end(const gl::Framebuffer& target);
  /// Ends a frame without drawing it.
  void drop();
  /// Whether the mouse belongs to the panel and not to the picture, by the cursor and buttons of this frame's input.
  /// ImGui itself knows only after the frame has begun.
  bool wantsMouse(const HostInput& input) const;
  bool wantsKeyboard() const { return ImGui::GetIO().WantTextInput; }
  /// Whether a menu's list is open.
  bool showsList() const { return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup); }
  /// Whether Escape went down in this frame's input.
  bool escapes() const { return escapes_; }
  float scale() const { return scale_; }
  std::size_t gpuBytes() const { return overlay_.gpuBytes() + panelFont_.bytes() + noteFont_.bytes(); }

  // ---- controls by name. To be called right after the control.
  struct Place {
    glm::vec2 centre;
    bool visible;
  };
  /// Registers the current ImGui window: over it, the mouse does not belong to the picture.
  void noteWindow();
  /// Forgets all registered windows. Without this call, those of the last frame stay.
  void beginWindows() { windows_.clear(); }
  /// Registers the last control. Its name is `label` after its section, such as "Light/sun height".
  void note(const std::string& label);
  /// Sets the section of the controls that follow.
  void section(const std::string& name) { section_ = name; }
  /// Where that control was in the last frame. The panel scrolls to it in the next one.
  std::optional<Place> find(const std::string& label);
  bool isThere(const std::string& label) const { return places_.contains(label); }
  /// All controls of all frames so far.
  const std::set<std::string>& labels() const { return labels_; }

 private:
  Host& host_;
  float scale_;
  ImGuiContext *panel_ = nullptr, *note_ = nullptr;
  gl::Overlay overlay_;
  gl::Texture panelFont_, noteFont_;
  std::string section_, wanted_;
  std::vector<std::array<glm::vec2, 2>> windows_;  ///< lower and upper corner
  bool held_ = false;  ///< a mouse button was held in the last frame
  bool escapes_ = false;
  std::map<std::string, Place> places_;
  std::set<std::string> labels_;
  std::string clipboard_;
  std::vector<gl::Overlay::Vertex> vertices_;
  std::vector<std::uint32_t> indices_;
  std::vector<gl::Overlay::Run> runs_;
};

}  // namespace lucerna::demo
