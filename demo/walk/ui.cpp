#include "walk/ui.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

constexpr std::pair<ImGuiKey, int> kImguiKeys[] = {{ImGuiKey_Tab, key::kTab},
                                                   {ImGuiKey_LeftArrow, key::kLeft},
                                                   {ImGuiKey_RightArrow, key::kRight},
                                                   {ImGuiKey_UpArrow, key::kUp},
                                                   {ImGuiKey_DownArrow, key::kDown},
                                                   {ImGuiKey_PageUp, key::kPageUp},
                                                   {ImGuiKey_PageDown, key::kPageDown},
                                                   {ImGuiKey_Home, key::kHome},
                                                   {ImGuiKey_End, key::kEnd},
                                                   {ImGuiKey_Insert, key::kInsert},
                                                   {ImGuiKey_Delete, key::kDelete},
                                                   {ImGuiKey_Backspace, key::kBackspace},
                                                   {ImGuiKey_Space, ' '},
                                                   {ImGuiKey_Enter, key::kEnter},
                                                   {ImGuiKey_Escape, key::kEscape},
                                                   {ImGuiKey_A, 'A'},
                                                   {ImGuiKey_C, 'C'},
                                                   {ImGuiKey_V, 'V'},
                                                   {ImGuiKey_X, 'X'},
                                                   {ImGuiKey_Y, 'Y'},
                                                   {ImGuiKey_Z, 'Z'}};

#if IMGUI_VERSION_NUM < 18700
void mapKeys(ImGuiIO& io) {
  for (const auto& [imguiKey, ours] : kImguiKeys) io.KeyMap[imguiKey] = ours;
}

void passInput(ImGuiIO& io, const HostInput& input, const glm::vec2& cursor) {
  io.MousePos = {cursor.x, cursor.y};
  for (int button = 0; button < 3; ++button) io.MouseDown[button] = input.buttons[static_cast<std::size_t>(button)];
  io.MouseWheel += static_cast<float>(input.wheel.y);
  io.MouseWheelH += static_cast<float>(input.wheel.x);
  for (const KeyEvent& event : input.keys) {
    io.KeysDown[event.key] = event.down;
    io.KeyCtrl = event.control;
    io.KeyShift = event.shift;
    io.KeyAlt = event.alt;
  }
}
#else
// A frame takes all input since the last one, as HostInput does, instead of one click in each.
void mapKeys(ImGuiIO& io) { io.ConfigInputTrickleEventQueue = false; }

void passInput(ImGuiIO& io, const HostInput& input, const glm::vec2& cursor) {
  io.AddMousePosEvent(cursor.x, cursor.y);
  for (int button = 0; button < 3; ++button)
    io.AddMouseButtonEvent(button, input.buttons[static_cast<std::size_t>(button)]);
  io.AddMouseWheelEvent(static_cast<float>(input.wheel.x), static_cast<float>(input.wheel.y));
  for (const KeyEvent& event : input.keys) {
    io.AddKeyEvent(ImGuiKey_ModCtrl, event.control);
    io.AddKeyEvent(ImGuiKey_ModShift, event.shift);
    io.AddKeyEvent(ImGuiKey_ModAlt, event.alt);
    for (const auto& [imguiKey, ours] : kImguiKeys)
      if (ours == event.key) io.AddKeyEvent(imguiKey, event.down);
  }
}
#endif

/// The default font, as a texture. Each context has its own: one that two share must be updated by the program itself
/// since 1.92.
gl::Texture makeFont(ImGuiIO& io, float size) {
  ImFontConfig font;
  font.SizePixels = size;
  io.Fonts->AddFontDefault(&font);
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
  gl::Sampling sampling;
  sampling.minFilter = sampling.magFilter = gl::Filter::linear;
  gl::Texture texture("font", gl::Format::rgba8, glm::ivec2(width, height), sampling);
  texture.upload(gl::Texels::rgbaByte, pixels);
  io.Fonts->ClearTexData();
  return texture;
}

// A texture's name for ImGui: a pointer before 1.91.4, an integer since.
ImTextureID nameOf(const gl::Texture& texture) { return (ImTextureID)(std::intptr_t)&texture; }
const gl::Texture* textureOf(ImTextureID name) { return (const gl::Texture*)(std::intptr_t)name; }

}  // namespace

Ui::Ui(gl::ProgramLibrary& programs, Host& host, float scale) : host_(host), scale_(scale), overlay_(programs) {
  panel_ = ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // do not write any file into the user's folders
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  mapKeys(io);
  io.ClipboardUserData = this;
  io.GetClipboardTextFn = [](void* self) -> const char* {
    Ui& ui = *static_cast<Ui*>(self);
    if (ui.host_.kind() == HostKind::window) ui.clipboard_ = ui.host_.clipboard();
    return ui.clipboard_.c_str();
  };
  io.SetClipboardTextFn = [](void* self, const char* text) {
    static_cast<Ui*>(self)->clipboard_ = text;
    static_cast<Ui*>(self)->host_.setClipboard(text);
  };
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 4.0f;
  style.Colors[ImGuiCol_WindowBg].w = 0.86f;
  style.Colors[ImGuiCol_PlotHistogram] = {0.58f, 0.42f, 0.08f, 1.0f};  // white numbers are drawn on it
  style.ScaleAllSizes(scale);
  const float fontSize = std::round(13.0f * scale);
  panelFont_ = makeFont(io, fontSize);
  io.Fonts->SetTexID(nameOf(panelFont_));
  note_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(note_);
  ImGuiIO& noteIo = ImGui::GetIO();
  noteIo.IniFilename = nullptr;
  noteIo.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  noteFont_ = makeFont(noteIo, fontSize);
  noteIo.Fonts->SetTexID(nameOf(noteFont_));
  ImGui::GetStyle() = style;
  ImGui::SetCurrentContext(panel_);
}

Ui::~Ui() {
  ImGui::DestroyContext(note_);
  ImGui::DestroyContext(panel_);
}

void Ui::beginNote(glm::ivec2 size, double seconds) {
  ImGui::SetCurrentContext(note_);
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(size.x), static_cast<float>(size.y)};
  io.DeltaTime = static_cast<float>(seconds);
  ImGui::NewFrame();
}

void Ui::begin(const HostInput& input, glm::ivec2 size, double seconds) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(size.x), static_cast<float>(size.y)};
  io.DeltaTime = static_cast<float>(std::clamp(seconds, 1e-4, 1.0));
  passInput(io, input, input.focused ? glm::vec2(input.cursor) : glm::vec2(-FLT_MAX));
  io.AddInputCharactersUTF8(input.text.c_str());
  places_.clear();
  held_ = input.buttons[0] || input.buttons[1] || input.buttons[2];
  escapes_ = std::ranges::any_of(input.keys, [](const KeyEvent& e) { return e.key == key::kEscape && e.down; });
  ImGui::NewFrame();
}

void Ui::noteWindow() {
  const ImVec2 corner = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  windows_.push_back({glm::vec2(corner.x, corner.y), glm::vec2(corner.x + size.x, corner.y + size.y)});
}

// A button belongs to where it went down, until it is let go; an open menu takes every click.
bool Ui::wantsMouse(const HostInput& input) const {
  if (held_) return ImGui::GetIO().WantCaptureMouse;
  if (showsList()) return true;
  const glm::vec2 cursor(input.cursor);
  return std::ranges::any_of(windows_, [&](const std::array<glm::vec2, 2>& window) {
    return glm::all(glm::greaterThanEqual(cursor, window[0])) && glm::all(glm::lessThan(cursor, window[1]));
  });
}

void Ui::drop() {
  ImGui::EndFrame();
  ImGui::SetCurrentContext(panel_);
}

void Ui::end(const gl::Framebuffer& target) {
  ImGui::Render();
  if (ImGui::GetCurrentContext() == panel_) wanted_.clear();
  const ImDrawData& data = *ImGui::GetDrawData();
  vertices_.clear();
  indices_.clear();
  runs_.clear();
  for (int i = 0; i < data.CmdListsCount; ++i) {
    const ImDrawList& list = *data.CmdLists[i];
    const auto firstVertex = static_cast<std::uint32_t>(vertices_.size());
    for (const ImDrawVert& v : list.VtxBuffer) {
      const ImVec4 color = ImGui::ColorConvertU32ToFloat4(v.col);
      vertices_.push_back({{v.pos.x, v.pos.y}, {v.uv.x, v.uv.y}, {color.x, color.y, color.z, color.w}});
    }
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const glm::ivec2 corner(static_cast<int>(command.ClipRect.x), static_cast<int>(command.ClipRect.y));
      const glm::ivec2 end(static_cast<int>(command.ClipRect.z), static_cast<int>(command.ClipRect.w));
      runs_.push_back({corner, end - corner, static_cast<std::uint32_t>(indices_.size()), command.ElemCount,
                       textureOf(command.GetTexID())});
      for (unsigned k = 0; k < command.ElemCount; ++k)
        indices_.push_back(firstVertex + command.VtxOffset + list.IdxBuffer[static_cast<int>(command.IdxOffset + k)]);
    }
  }
  overlay_.draw(target, vertices_, indices_, runs_);
  ImGui::SetCurrentContext(panel_);
}

void Ui::note(const std::string& label) {
  const std::string name = section_.empty() ? label : section_ + "/" + label;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  labels_.insert(name);
  places_[name] = {{0.5f * (low.x + high.x), 0.5f * (low.y + high.y)}, ImGui::IsItemVisible()};
  if (name == wanted_) ImGui::SetScrollHereY();
}

std::optional<Ui::Place> Ui::find(const std::string& label) {
  wanted_ = label;
  const auto found = places_.find(label);
  if (found == places_.end()) return {};
  return found->second;
}

}  // namespace lucerna::demo
