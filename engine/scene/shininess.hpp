// The Blinn-Phong exponent of forward shading for a GGX lobe of the same width near its peak [GLTF2, appendix B]. Pure.
#pragma once

#include <algorithm>

namespace lucerna {

/// alpha 0..1; the exponent is at least 1, and for a smooth surface 2.5e6.
inline float shininessOf(float alpha) {
  const float least = std::max(alpha, 0.0009f);
  return std::max(2.0f / (least * least) - 2.0f, 1.0f);
}

}  // namespace lucerna
