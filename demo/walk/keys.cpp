#include "walk/keys.hpp"

#include <fmt/format.h>

namespace lucerna::demo {

namespace {

constexpr KeyBinding kKeys[] = {
    {key::kF1, false, Action::help, "this list"},
    {key::kF2, false, Action::panel, "the panel"},
    {key::kF5, false, Action::reload, "reload changed shaders"},
    {'L', false, Action::reload, "the same"},
    {key::kF11, false, Action::fullScreen, "full screen"},
    {key::kF12, false, Action::shot, "save the picture: PNG as shown, HDR linear, settings inside"},
    {'V', false, Action::video, "record a video, end it (ffmpeg)"},
    {key::kF11, true, Action::capture, "capture a frame for RenderDoc (requires walk --capture N)"},
    {' ', false, Action::pause, "pause and resume along the path"},
    {'P', false, Action::hold, "hold a scene that moves, and let it go on"},
    {'R', false, Action::follow, "leave the path, return to it"},
    {'[', false, Action::slower, "half the speed along the path"},
    {']', false, Action::faster, "twice the speed along the path"},
    {'O', false, Action::loop, "repeat the path at its end"},
    {'K', false, Action::addKeyFrame, "this view as a new key frame"},
    {'-', false, Action::darker, "less exposure"},
    {'=', false, Action::brighter, "more exposure"},
    {'0', false, Action::autoExposure, "automatic exposure, on or off"},
    {'1', false, Action::direct, "technique direct"},
    {'2', false, Action::rsm, "technique rsm"},
    {'3', false, Action::lpv, "technique lpv"},
    {'4', false, Action::cache, "technique irradiance-cache"},
    {'5', false, Action::radiosity, "technique radiosity"},
    {'6', false, Action::path, "the path-traced reference; as B where two pictures are shown"},
    {'Z', true, Action::undo, "undo the last change of settings or light"},
    {'Y', true, Action::redo, "make it again; also control shift Z"},
    {key::kTab, false, Action::flicker, "switch between A and B"},
    {'X', false, Action::wipe, "A and B divided by a wipe, dragged with the right button"},
    {'B', false, Action::sideBySide, "A and B side by side"},
    {'J', false, Action::reprojection, "edges smoothed by earlier frames while the view moves, on or off"},
    {'Z', false, Action::magnifier, "magnifier with values"},
    {'H', false, Action::nextView, "picture, signed error, relative error, z-score, FLIP"},
    {'T', false, Action::liveReference, "live reference: a reference of this view while the camera rests"},
    {'I', false, Action::inspect, "what lit the pixel under the cursor"},
    {'F', false, Action::fit, "show the whole picture again, after zooming"},
    {'C', false, Action::orbit, "the mouse moves around what is in the middle, or looks around"},
    {key::kEscape, false, Action::end,
     "stop the current work, close a list, this help; otherwise quit, after a question"},
};

}  // namespace

std::span<const KeyBinding> allKeys() { return kKeys; }

std::optional<Action> actionOf(const KeyEvent& event) {
  if (!event.down || event.alt) return {};
  if (event.key == 'Z' && event.control && event.shift) return Action::redo;
  for (const KeyBinding& binding : kKeys)
    if (binding.key == event.key && binding.control == event.control) return binding.action;
  return {};
}

std::string nameOf(const KeyBinding& binding) { return (binding.control ? "control " : "") + key::nameOf(binding.key); }

std::string keysHelp() {
  std::string text = "Keys in the window:\n";
  for (const KeyBinding& binding : kKeys) text += fmt::format("  {:<20} {}\n", nameOf(binding), binding.meaning);
  text += fmt::format("  {:<20} {}\n", "W A S D Q E", "move; with shift four times as fast");
  text += fmt::format("  {:<20} {}\n", "left button", "look around by dragging; around (C): orbit, with shift pan");
  text += fmt::format("  {:<20} {}\n", "right button", "draw the wipe");
  text += fmt::format("  {:<20} {}\n", "middle button", "move the zoomed picture; around (C): pan");
  text += fmt::format("  {:<20} {}\n", "wheel", "zoom into the picture; around (C): closer, farther");
  text += fmt::format("  {:<20} {}\n", "drop a file", "load a scene, or a picture to compare with");
  return text;
}

}  // namespace lucerna::demo
