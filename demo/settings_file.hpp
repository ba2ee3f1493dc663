// Settings files, such as `lucerna tune` writes (no GL): a JSON object of "technique", "fidelity", "deviations",
// "settings", "spp" (path tracing alone) and "measured", which is for people.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

struct SettingsFile {
  std::optional<std::string> technique, fidelity;
  std::vector<std::string> deviations, settings;  ///< as --deviation and --set take them
  std::optional<std::uint32_t> spp;  ///< 1 and more
};

/// Throws Error(badInput) naming file and key where one is unknown or of another type. What techniques, deviations and
/// settings there are is not asked here.
SettingsFile readSettingsFile(const std::string& file);

}  // namespace lucerna::demo
