// The settings and deviations as documents: docs/settings.md, and the same as JSON. Both are generated from the tables.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace lucerna::demo {

/// docs/settings.md; `lucerna info --settings` prints it, and a test compares the two.
std::string settingsPage();

/// An array of objects: key, type, least, most, choices, word, unit, default, meaning, source, cost, techniques,
/// transports.
nlohmann::ordered_json settingsJson();

}  // namespace lucerna::demo
