// Dear ImGui in the engine's terms: input from a host's HostInput, triangles through gl::Overlay. No GL loader of
// ImGui's own (Debian's backend opens libGL.so.1 by itself, past EGL and OSMesa), so the panel works on every host.
//
// Controls are made through the functions below: each is known by its label, so that recorded input can ask for it by
// name (walk/input_file.hpp) wherever it lies.
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
  /// scale: of text and controls, 1 for 96 dots an inch.
  Ui(gl::ProgramLibrary& programs, Host& host, float scale);
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  /// Begins a frame of `size` pixels; ImGui's own functions may be called until end().
  void begin(const HostInput& input, glm::ivec2 size, double seconds);
  /// The same for a note while something long is made. The panel knows nothing of it: what is dragged there stays held.
  void beginNote(glm::ivec2 size, double seconds);
  /// Draws what was asked for over the target.
  void end(const gl::Framebuffer& target);
  /// Ends a frame without drawing it.
  void drop();
  /// Whether the mouse is the panel's and not the picture's, with the cursor and the buttons of this frame's input;
  /// ImGui itself says so only once the frame has begun.
  bool wantsMouse(const HostInput& input) const;
  bool wantsKeyboard() const { return ImGui::GetIO().WantTextInput; }
  float scale() const { return scale_; }
  std::size_t gpuBytes() const { return overlay_.gpuBytes() + font_.bytes(); }

  // ---- controls by name. Called right after the control.
  struct Place {
    glm::vec2 centre;
    bool visible;
  };
  /// Notes the window that is being made: where it lies the mouse is not the picture's.
  void noteWindow();
  /// Before all windows are made anew; without it those of the last frame stay.
  void beginWindows() { windows_.clear(); }
  /// Notes the control that was made last; `label` with its section before it, such as "Light/sun height".
  void note(const std::string& label);
  /// The section that the following controls belong to.
  void section(const std::string& name) { section_ = name; }
  /// Where that control lay in the last frame; the panel scrolls to it in the next one.
  std::optional<Place> find(const std::string& label);
  bool isThere(const std::string& label) const { return places_.contains(label); }
  /// All controls of all frames so far.
  const std::set<std::string>& labels() const { return labels_; }

 private:
  Host& host_;
  float scale_;
  ImGuiContext *panel_ = nullptr, *note_ = nullptr;
  gl::Overlay overlay_;
  gl::Texture font_;
  std::string section_, wanted_;
  std::vector<std::array<glm::vec2, 2>> windows_;  ///< corner and end
  bool held_ = false;  ///< a mouse button, in the last frame
  std::map<std::string, Place> places_;
  std::set<std::string> labels_;
  std::string clipboard_;
  std::vector<gl::Overlay::Vertex> vertices_;
  std::vector<std::uint32_t> indices_;
  std::vector<gl::Overlay::Run> runs_;
};

}  // namespace lucerna::demo
