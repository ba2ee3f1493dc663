// Converts a virtual point light of the reflective shadow map for the grid; shared by all ways to fill it. Needs
// lib/sh.glsl and cascades/block.glsl. LOWEST_CELL is 0; 1 with the deviation lpv.first-cell.
#include "lib/clamped_int.glsl"
#include "lib/finite.glsl"

// Background, black, zero and non-finite texels carry no light.
bool isUsableVpl(vec4 position, vec3 normal, vec3 flux) {
  float length2 = dot(normal, normal);
  return position.w > 0.5 && allFinite(position.xyz) && allFinite(normal) && allFinite(flux) && length2 > 0.25 &&
         length2 < 4.0 && flux.r + flux.g + flux.b > 0.0;
}

// Its cell in cascade k. The light is first moved half a cell along its normal, so that it does not light its own
// surface [GPUPro2, p. 190].
bool vplCell(int k, vec3 position, vec3 normal, out ivec3 cell) {
  float s = grids.cascades[k].cellSize;
  vec3 inCells = (position + 0.5 * s * normal - grids.cascades[k].minimum) / s;
  cell = clampedInt(floor(inCells), ivec3(-1), ivec3(grids.shape.x));
  return all(greaterThanEqual(cell, ivec3(LOWEST_CELL))) && all(lessThan(cell, ivec3(grids.shape.x)));
}

// Intensity Phi / pi * max(0, cos) of unit flux, as stored: c / (E_ref s^2) is near 1 in any units, so that 16-bit
// floats neither overflow nor become subnormal.
vec4 vplLobe(int k, vec3 normal, float fluxScale) {
#if FLUX_UNITS
  // Deviation lpv.flux-units: neither the texel's area nor the cell's counts, so brightness depends on their number and
  // size.
  return shCosineLobe(normal) * (fluxScale / (kPi * grids.referenceIrradiance));
#else
  float s = grids.cascades[k].cellSize;
  return shCosineLobe(normal) * (fluxScale / (kPi * grids.referenceIrradiance * s * s));
#endif
}
