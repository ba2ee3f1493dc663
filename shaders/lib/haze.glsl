// A homogeneous medium in a box (shared/haze.h): its transmittance and phase function.
#include "shared/bindings.h"
#include "shared/haze.h"
layout(std140, binding = BLOCK_HAZE) uniform HazeBlock { HazeConstants haze; };

// Range of distances along the ray, x >= 0 to y, within the box; empty if y < x. `direction` is unit.
vec2 hazeRange(vec3 origin, vec3 direction) {
  // A ray parallel to a pair of planes is either always or never between them.
  vec3 along = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  vec3 a = (haze.low - origin) / along, b = (haze.high - origin) / along;
  vec3 enters = min(a, b), leaves = max(a, b);
  return vec2(max(max(enters.x, enters.y), max(enters.z, 0.0)), min(min(leaves.x, leaves.y), leaves.z));
}

// Transmittance from infinity to `origin` for light that travels against `towardsLight`: exp(-sigma_t d).
vec3 hazeTransmittance(vec3 origin, vec3 towardsLight) {
  vec2 range = hazeRange(origin, towardsLight);
  return exp(-haze.extinction * max(range.y - range.x, 0.0));
}

// In 1/sr, from the cosine between the directions of travel before and after [HenyeyGreenstein1941].
vec3 hazePhase(float cosine) {
  const float kOver4Pi = 0.079577471545947668;
  if (haze.isRayleigh > 0.5) return vec3(0.75 * kOver4Pi * (1.0 + cosine * cosine));
  vec3 g = haze.anisotropy, d = 1.0 + g * g - 2.0 * g * cosine;
  return kOver4Pi * (1.0 - g * g) / (d * sqrt(d));
}
