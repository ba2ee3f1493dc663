// JSON text to a value (no GL).
#pragma once

#include "base/error.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace lucerna {

/// Maximum nesting: functions that walk a value recurse once per level. Scenes need about ten.
inline constexpr int kMostJsonDepth = 200;

/// Throws Error(badInput) naming `name` if brackets are nested deeper than kMostJsonDepth.
void checkJsonDepth(std::string_view text, std::string_view name);

/// The whole text as one value. Throws Error(badInput) naming `name` if it is not JSON, or nested deeper than
/// kMostJsonDepth.
template <class T = nlohmann::json>
T parseJson(std::string_view text, std::string_view name) {
  checkJsonDepth(text, name);
  try {
    return T::parse(text);
  } catch (const typename T::exception& error) { throwBadInput("{}: not valid JSON: {}", name, error.what()); }
}

}  // namespace lucerna
