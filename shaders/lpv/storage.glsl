// How the grids are kept. What a frame hands on, and what a step hands to the next, in 16-bit floats, each rounded to the nearest once;
// sums in 32 bits. With LPV_FULL_FLOAT, for tests, all in 32. Needs lpv/common.glsl.
#if LPV_FULL_FLOAT
#define LPV_STORED vec4
vec4 fromStored(vec4 stored) { return stored; }
vec4 toStored(vec4 value) { return value; }
vec4 toTexel(vec4 value) { return value; }
#else
#include "lib/half.glsl"
#define LPV_STORED uvec2
vec4 fromStored(uvec2 stored) { return vec4(unpackHalf2x16(stored.x), unpackHalf2x16(stored.y)); }
vec4 toTexel(vec4 value) { return roundToHalf(value); }
uvec2 toStored(vec4 value) {
  vec4 rounded = roundToHalf(value);
  return uvec2(packHalf2x16(rounded.xy), packHalf2x16(rounded.zw));
}
#endif
