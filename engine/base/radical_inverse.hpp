// Van der Corput's radical inverse to base 2: 1/2, 1/4, 3/4, 1/8 ... for 1, 2, 3, 4 ...
#pragma once

#include <cstdint>

namespace lucerna {

inline double radicalInverse(std::uint32_t index) {
  double sum = 0.0;
  for (double digit = 0.5; index != 0; index >>= 1, digit *= 0.5) sum += digit * (index & 1u);
  return sum;
}

}  // namespace lucerna
