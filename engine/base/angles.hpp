#pragma once

#include <numbers>

namespace lucerna {

inline constexpr double kPi = std::numbers::pi;
/// Radians.
inline constexpr double kDegree = kPi / 180.0;

}  // namespace lucerna
