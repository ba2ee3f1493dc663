// Names of enum values, as the command line, files and JSON spell them: one table per enum, one parser for all.
//
// An enum class whose values count from 0 has names once a function namesOf(E) next to it returns them in order:
//   constexpr std::array<std::string_view, 2> namesOf(LpvLookup) { return {"flux", "published"}; }
#pragma once

#include "base/error.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace lucerna {

template <class E>
concept NamedEnum = requires(E value) {
  namesOf(value).size();
};

template <NamedEnum E>
constexpr std::string_view nameOf(E value) {
  const auto names = namesOf(value);
  const auto index = static_cast<std::size_t>(value);
  CHECK(index < names.size(), "value {} has no name", index);
  return names[index];
}

/// Throws Error(badInput) with the valid names; `what` is the beginning of the message, such as "--host".
template <NamedEnum E>
E parseName(std::string_view name, std::string_view what) {
  const auto names = namesOf(E{});
  std::string known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (name == names[i]) return static_cast<E>(i);
    known += (known.empty() ? "" : ", ") + std::string(names[i]);
  }
  throwBadInput("{} {}: unknown; expected one of {}", what, name, known);
}

}  // namespace lucerna
