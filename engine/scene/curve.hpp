// A value that changes over time: keys and what lies between them (no GL, pure).
#pragma once

#include "scene/json_value.hpp"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace lucerna {

struct Curve {
  enum class Interpolation {
    step,  ///< the last key's value
    linear,  ///< of rotations: along the great arc [Shoemake1985]
    cubic,  ///< Hermite's, monotone between keys, so that it leaves no range that they keep [FritschButland1984]
    tangents,  ///< Hermite's with tangents as given: in, value, out for each key [GLTF2, appendix C]
  };
  Interpolation interpolation = Interpolation::linear;
  bool isRotation = false;  ///< values are quaternions x, y, z, w
  bool loops = false;  ///< starts again after the last key, also before the first
  std::size_t width = 1;  ///< numbers of a value
  std::vector<double> times;  ///< rising, seconds
  std::vector<double> values;  ///< `width` a key; with tangents three times as many

  /// The value at a time; before the first and after the last key theirs. `out`: `width` numbers.
  void at(double seconds, std::span<double> out) const;
};

/// The curve that a scene's JSON has in the place of a number or an array of numbers:
///   {"times": [seconds, rising], "values": [one a time], "interpolation": "step", "linear" (default) or "cubic",
///    "loop": true: it starts again after the last time (false)}
/// Throws Error(badInput) naming file and key.
Curve readCurve(const Value& value);

/// The times of all keys of all curves inside, rising.
std::vector<double> keyTimesIn(const Json& json);

}  // namespace lucerna
