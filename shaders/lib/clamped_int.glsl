// Floats to integers. GLSL leaves the result open where the integer cannot hold the value, and for NaN: processors and
// GPUs saturate, wrap, or give the lowest integer. So the value is clamped first, and NaN gives `low`. Bounds up to
// 2^24, which floats hold exactly. Shaders convert floats by these functions, or say why a bare conversion is bounded
// (Form.FloatsAreClampedBeforeTheyBecomeIntegers). NaN is told by its bits, because compilers may turn comparisons
// around (lib/finite.glsl).
bvec3 isNumber(vec3 v) { return lessThanEqual(floatBitsToUint(v) & 0x7fffffffu, uvec3(0x7f800000u)); }

ivec3 clampedInt(vec3 v, ivec3 low, ivec3 high) {
  return ivec3(mix(vec3(low), clamp(v, vec3(low), vec3(high)), isNumber(v)));  // bounded: clamped, and no NaN
}
ivec2 clampedInt(vec2 v, ivec2 low, ivec2 high) { return clampedInt(v.xyy, low.xyy, high.xyy).xy; }
int clampedInt(float v, int low, int high) { return clampedInt(vec3(v), ivec3(low), ivec3(high)).x; }
uint clampedUint(float v, uint high) { return uint(clampedInt(v, 0, int(high))); }
