// All settings: those of the techniques, and of shadow maps, textures and the frame (no GL calls).
#pragma once

#include "frame/setting.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// References stay valid until a technique is added.
const std::vector<Setting>& allSettings();

/// Null if there is none.
const Setting* findSetting(std::string_view key);

/// A parsed "KEY=VALUE".
struct SettingAssignment {
  const Setting* setting;
  std::string value;
};
/// Throws Error(badInput) whose message begins with `where` and lists the valid keys. `only`: keys of that cost; null:
/// all.
SettingAssignment parseAssignment(std::string_view assignment, std::string_view where = "",
                                  const SettingCost* only = nullptr);

/// Parses "KEY=VALUE" each, as parseAssignment() and parseSetting() do. A setting that is read only with a value of
/// another (cache.transport) chooses that value, unless it is given too. Settings that are not read are warnings.
void applySettings(RenderSettings& settings, const std::vector<std::string>& assignments, std::string_view where = "");

/// Whether the technique reads the setting: empty if it always does, "cache.transport=gather" if only with that value;
/// nothing if it never does.
std::optional<std::string_view> readWith(const Setting& setting, std::string_view technique);
/// Whether the technique of `settings`, with its other values, reads the setting.
bool isRead(const Setting& setting, const RenderSettings& settings);
/// The only technique that reads the setting; none if several do.
std::optional<std::string_view> onlyTechnique(const Setting& setting);

}  // namespace lucerna
