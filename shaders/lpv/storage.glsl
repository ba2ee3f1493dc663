// How the result is kept: in 16-bit floats, rounded to the nearest once, or with LPV_FULL_FLOAT, for tests, in 32 bits.
// All that is added up or handed from step to step on the way is kept in 32 bits.
#if LPV_FULL_FLOAT
vec4 toTexel(vec4 value) { return value; }
#else
#include "lib/half.glsl"
vec4 toTexel(vec4 value) { return roundToHalf(value); }
#endif
