// Irradiance at a surface from the light propagation volume: trilinearly filtered coefficients times a receiver's lobe.
// Stored coefficients are c / (E_ref s^2), so s cancels.
//
// FLUX_LOOKUP (lpv.lookup=flux): the flux that the propagation kernel would send through a face of a cell there,
// divided by the face's area. Towards one face it sends Omega_f I(front) + Omega_s sum of I(the four sides)
// (lpv/kernel.glsl). Without the clamps at 0 that is a0 c0 + a1 <c1, -n> with a0 = Y00 (Omega_f + 4 Omega_s) = Y00 2 pi
// / 3 and a1 = Y1 (Omega_f + 8 Omega_s / sqrt 5), so E = max(0, a0 c0 + a1 <c1, -n>) / s^2. In a field of constant
// intensity I this gives 2 pi / 3 I, consistent with the kernel.
// Otherwise as published [LPV2015, 5.4]: E = 4 / (pi s^2) <c, lobe(-n)>, the light of a source in the cell's centre,
// half a cell away, E = I / (s/2)^2 [Kaplanyan2010]. For light in transit that is 1.91 times too much.
//
// In this formula band 1 of the receiver's lobe is windowed by 3/4 (against ringing [Sloan2008]): two two-band cosine
// lobes give pi/4 + pi/3 cos, so light travelling away from a surface would count as negative and cancel other light.
// 3/4 is the largest window for which no sum of cosine lobes is negative anywhere. Deviation lpv.unwindowed: no window,
// as published.
#include "shared/bindings.h"
#include "lib/sh.glsl"
#include "cascades/block.glsl"
#include "cascades/weight.glsl"
layout(binding = UNIT_LPV_RED) uniform sampler3D lpvRed;
layout(binding = UNIT_LPV_GREEN) uniform sampler3D lpvGreen;
layout(binding = UNIT_LPV_BLUE) uniform sampler3D lpvBlue;

// Texel position in the stack for a lookup in cascade k; border: 0 outside the cascade, where the sampler cannot tell.
vec3 lpvPlace(int k, vec3 position, vec3 normal, out float border) {
  float cells = float(grids.shape.x);
  vec3 texel = (position - grids.cascades[k].minimum) / grids.cascades[k].cellSize + grids.lookupOffset * normal;
  // In x and y the sampler's border of zeros ends the cascade; along z, where the next cascade's layers follow, it is
  // done by hand.
  border = clamp(min(texel.z, cells - texel.z) + 0.5, 0.0, 1.0);
  texel.z = clamp(texel.z, 0.5, cells - 0.5) + float(k) * cells;
  return texel;
}

// The receiver's lobe: irradiance is its dot product with the light's coefficients, times 4 / pi and E_ref.
vec4 lpvLobe(vec3 normal) {
#if FLUX_LOOKUP
  // sr, as in lpv/kernel.glsl
  const float kFront = 0.40066968464623916, kSide = 0.42343135443673924, kRoot5 = 2.2360679774997897;
  return vec4(kY00 * (kFront + 4.0 * kSide), -kY1 * (kFront + 8.0 * kSide / kRoot5) * normal) * (kPi / 4.0);
#elif FLUX_UNITS
  // Deviation lpv.flux-units: intensity towards the surface times 1.7, a factor tuned by eye.
  return shBasis(-normal) * (1.7 * kPi / 4.0);
#elif UNWINDOWED
  return shCosineLobe(-normal);
#else
  return shCosineLobe(-normal) * vec4(1.0, vec3(0.75));
#endif
}

vec3 lpvCascadeIrradiance(int k, vec3 position, vec3 normal) {
  float cells = float(grids.shape.x), border;
  vec3 uvw = lpvPlace(k, position, normal, border) / vec3(cells, cells, cells * float(grids.shape.y));
  vec4 lobe = lpvLobe(normal);
  vec3 c = vec3(dot(textureLod(lpvRed, uvw, 0.0), lobe), dot(textureLod(lpvGreen, uvw, 0.0), lobe),
                dot(textureLod(lpvBlue, uvw, 0.0), lobe));
  return max(c, 0.0) * (border * 4.0 / kPi * grids.referenceIrradiance);
}

// From the finest cascade to the coarsest, each blended into the next near its border; the weights sum to 1.
vec3 lpvIrradiance(vec3 position, vec3 normal) {
  vec3 irradiance = vec3(0.0);
#if SUM_CASCADES
  // Deviation lpv.sum-cascades: every cascade adds its light on top.
  for (int k = 0; k < grids.shape.y; ++k) irradiance += lpvCascadeIrradiance(k, position, normal);
  return irradiance;
#endif
  float left = 1.0;
  for (int k = 0; k < grids.shape.y && left > 0.0; ++k) {
    float weight = left * cascadeWeight(k, position);
    if (weight > 0.0) irradiance += weight * lpvCascadeIrradiance(k, position, normal);
    left -= weight;
  }
  return irradiance;
}
