// Storage format of the result: 16-bit floats, rounded to nearest once, or 32 bits with GRID_FULL_FLOAT, for tests. All
// sums and intermediate values are kept in 32 bits.
#if GRID_FULL_FLOAT
vec4 toTexel(vec4 value) { return value; }
#else
#include "lib/half.glsl"
vec4 toTexel(vec4 value) { return roundToHalf(value); }
#endif
