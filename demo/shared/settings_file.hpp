// Settings files, such as those written by `lucerna tune` (no GL): a JSON object of "technique", "fidelity",
// "deviations", "settings", "spp" (only for path tracing) and "measured", which is for people.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

struct SettingsFile {
  std::optional<std::string> technique, fidelity;
  std::vector<std::string> deviations, settings;  ///< in the form that --deviation and --set take
  std::optional<std::uint32_t> spp;  ///< at least 1
};

/// Throws Error(badInput) naming file and key if a key is unknown or has another type. Whether techniques, deviations
/// and settings exist is not checked here.
SettingsFile readSettingsFile(const std::string& file);

}  // namespace lucerna::demo
