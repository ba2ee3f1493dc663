// Values that have a name on the command line: a table of both, read either way.
#pragma once

#include "base/error.hpp"

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace lucerna {

template <class T, std::size_t N>
using NamedValues = std::array<std::pair<T, const char*>, N>;

template <class T, std::size_t N>
std::string_view nameIn(const NamedValues<T, N>& table, T value) {
  for (const auto& [known, name] : table)
    if (known == value) return name;
  CHECK(false, "value {} has no name", static_cast<int>(value));
  return {};
}

/// Throws Error(badInput) with the names that there are; `what` is what the message begins with.
template <class T, std::size_t N>
T valueIn(const NamedValues<T, N>& table, std::string_view name, std::string_view what) {
  std::string known;
  for (const auto& [value, text] : table) {
    if (name == text) return value;
    known += (known.empty() ? "" : ", ") + std::string(text);
  }
  throwBadInput("{} {}: unknown; there are {}", what, name, known);
}

}  // namespace lucerna
