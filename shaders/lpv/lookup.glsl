// Irradiance at a surface from the light propagation volume [LPV2015, 5.4]: trilinear coefficients, dot product with the SH
// cosine lobe about -n (light that arrives), E = 4 / (pi s^2) * <c, lobe(-n)>: the light is taken to come from the cell's centre,
// half a cell away, E = I / (s/2)^2 [Kaplanyan2010]. Stored coefficients are c / (E_ref s^2), so s cancels.
//
// Band 1 of the receiver's lobe is windowed by 3/4 (against ringing [Sloan2008]): two two-band cosine lobes give pi/4 + pi/3 cos, so
// light that travels away from a surface would count negative and blacken what others light. 3/4 is the largest window with which no
// sum of cosine lobes is negative anywhere. Deviation lpv.unwindowed: without it, as published.
#include "lib/sh.glsl"
#include "lpv/common.glsl"
layout(binding = 4) uniform sampler3D lpvRed;
layout(binding = 5) uniform sampler3D lpvGreen;
layout(binding = 6) uniform sampler3D lpvBlue;

// How far a point is inside a cascade: 1 well inside, 0 from where it has faded out.
float lpvCascadeWeight(int k, vec3 position) {
  vec3 away = abs(position - lpv.cascades[k].blendCentre);
  float rest = lpv.cascades[k].blendHalf - max(away.x, max(away.y, away.z));
  return clamp(rest / (lpv.blendBand * lpv.cascades[k].blendHalf), 0.0, 1.0);
}

vec3 lpvCascadeIrradiance(int k, vec3 position, vec3 normal) {
  float cells = float(lpv.shape.x);
  vec3 texel = (position - lpv.cascades[k].minimum) / lpv.cascades[k].cellSize + lpv.lookupOffset * normal;
  // x and y end in the sampler's border of zeros; z, where the next cascade's layers follow, does so by hand.
  float border = clamp(min(texel.z, cells - texel.z) + 0.5, 0.0, 1.0);
  texel.z = clamp(texel.z, 0.5, cells - 0.5) + float(k) * cells;
  vec3 uvw = texel / vec3(cells, cells, cells * float(lpv.shape.y));
#if FLUX_UNITS
  // Deviation lpv.flux-units: intensity towards the surface times 1.7, a factor set by eye.
  vec4 lobe = shBasis(-normal) * (1.7 * kPi / 4.0);
#elif UNWINDOWED
  vec4 lobe = shCosineLobe(-normal);
#else
  vec4 lobe = shCosineLobe(-normal) * vec4(1.0, vec3(0.75));
#endif
  vec3 c = vec3(dot(textureLod(lpvRed, uvw, 0.0), lobe), dot(textureLod(lpvGreen, uvw, 0.0), lobe),
                dot(textureLod(lpvBlue, uvw, 0.0), lobe));
  return max(c, 0.0) * (border * 4.0 / kPi * lpv.referenceIrradiance);
}

// From the finest cascade to the coarsest, each blended into the next near its border; the weights sum to 1.
vec3 lpvIrradiance(vec3 position, vec3 normal) {
  vec3 irradiance = vec3(0.0);
#if SUM_CASCADES
  // Deviation lpv.sum-cascades: every cascade adds its light once more.
  for (int k = 0; k < lpv.shape.y; ++k) irradiance += lpvCascadeIrradiance(k, position, normal);
  return irradiance;
#endif
  float left = 1.0;
  for (int k = 0; k < lpv.shape.y && left > 0.0; ++k) {
    float weight = left * lpvCascadeWeight(k, position);
    if (weight > 0.0) irradiance += weight * lpvCascadeIrradiance(k, position, normal);
    left -= weight;
  }
  return irradiance;
}
