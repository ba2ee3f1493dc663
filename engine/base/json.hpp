// JSON text to a value (no GL).
#pragma once

#include "base/error.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace lucerna {

/// Objects and arrays inside of each other at most: what walks a value calls itself once a level. Scenes need about ten.
inline constexpr int kMostJsonDepth = 200;

/// Throws Error(badInput) naming `name` where brackets stand inside of each other deeper than kMostJsonDepth.
void checkJsonDepth(std::string_view text, std::string_view name);

/// The whole text as one value. Throws Error(badInput) naming `name` where it is no JSON, or nested deeper than kMostJsonDepth.
template <class T = nlohmann::json>
T parseJson(std::string_view text, std::string_view name) {
  checkJsonDepth(text, name);
  try {
    return T::parse(text);
  } catch (const typename T::exception& error) {
    throwBadInput("{}: not valid JSON: {}", name, error.what());
  }
}

}  // namespace lucerna
