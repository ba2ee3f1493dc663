#include "host/egl_device.hpp"

#include "base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <utility>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// One line for messages: "0 discrete amdgpu 1002:73bf /dev/dri/renderD128; 1 ...".
std::string listed(const std::vector<EglDevice>& devices) {
  std::string text;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    text += fmt::format("{}{} {}", i ? "; " : "", i, nameOf(devices[i].kind));
    for (const std::string& part : {devices[i].driver, devices[i].pci, devices[i].node})
      if (!part.empty()) text += " " + part;
  }
  return text.empty() ? "none" : text;
}

[[noreturn]] void refuse(const std::string& name, const std::string& why, const std::vector<EglDevice>& devices) {
  throwBadInput("LUCERNA_EGL_DEVICE={}: {}; EGL lists: {}", name, why, listed(devices));
}

std::optional<std::size_t> numberOf(const std::string& text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// "0000:65:00.0"; empty if the kernel does not report it. Slots have fixed-width numbers, so they sort as text.
std::string slotOf(const EglDevice& device, const fs::path& sys) {
  if (device.node.empty()) return {};
  std::error_code missing;
  const fs::path entry = fs::canonical(sys / "class/drm" / fs::path(device.node).filename() / "device", missing);
  return missing ? std::string() : entry.filename().string();
}

/// Slots of NVIDIA's devices whose UUID begins with `uuid`, from the driver's own list.
std::vector<std::string> slotsOfUuid(const std::string& uuid, const fs::path& proc) {
  std::vector<std::string> slots;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(proc / "driver/nvidia/gpus", missing)) {
    std::ifstream information(entry.path() / "information");
    for (std::string line; std::getline(information, line);)
      if (line.starts_with("GPU UUID:"))
        if (const auto at = line.find("GPU-"); at != std::string::npos && line.substr(at).starts_with(uuid))
          slots.push_back(entry.path().filename().string());
  }
  return slots;
}

}  // namespace

std::size_t eglDeviceNamed(const std::string& name, const std::vector<EglDevice>& devices, const fs::path& sys,
                           const fs::path& proc) {
  const auto colon = name.find(':');
  if (colon == std::string::npos) {
    const auto number = numberOf(name);
    if (!number || *number >= devices.size()) refuse(name, "no such device", devices);
    return *number;
  }
  const std::string family = name.substr(0, colon), which = name.substr(colon + 1);
  if (family != "cuda" && family != "rocm") refuse(name, "no such device", devices);
  std::vector<std::pair<std::string, std::size_t>> known;  // pairs of slot and index
  for (std::size_t i = 0; i < devices.size(); ++i)
    if (devices[i].driver == (family == "cuda" ? "nvidia" : "amdgpu")) known.emplace_back(slotOf(devices[i], sys), i);
  std::sort(known.begin(), known.end());  // without slots: EGL's order
  if (const auto number = numberOf(which)) {
    if (*number >= known.size()) refuse(name, "no such device", devices);
    return known[*number].second;
  }
  if (family == "cuda" && which.starts_with("MIG-"))
    refuse(name, "a part of a GPU, which OpenGL cannot use: request a whole one", devices);
  if (family != "cuda" || !which.starts_with("GPU-")) refuse(name, "no such device", devices);
  const std::vector<std::string> slots = slotsOfUuid(which, proc);
  if (slots.size() > 1) refuse(name, "more than one device", devices);
  if (!slots.empty())
    for (const auto& [slot, index] : known)
      if (slot == slots.front() || (slot.empty() && known.size() == 1)) return index;  // the only device
  refuse(name, "no such device", devices);
}

}  // namespace lucerna
