// The light paths in a picture, by the number of scatterings between lamp and camera; passing straight through a
// boundary is not a scattering.
#pragma once

#include <array>
#include <string_view>

namespace lucerna {

/// Stored in files: append new ones at the end.
enum class Transport {
  direct,  ///< 0 and 1: visible lights, and surfaces they light
  oneBounce,  ///< exactly 2
  oneBounceUnoccluded,  ///< exactly 2, without occlusion between the two scatterings: what a reflective shadow map
                        ///< gathers
  all,  ///< any number
  indirect  ///< 2 and more
};
constexpr std::array<std::string_view, 5> namesOf(Transport) {
  return {"direct", "one-bounce", "one-bounce-unoccluded", "all", "indirect"};
}
constexpr std::string_view nameOf(Transport transport) {
  return namesOf(transport)[static_cast<std::size_t>(transport)];
}

}  // namespace lucerna
