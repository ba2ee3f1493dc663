// Floats to integers. GLSL leaves the result open where the integer cannot hold the value, and for NaN: processors and
// GPUs saturate, wrap, or give the lowest integer. So the value is clamped first, and NaN gives `low`. Bounds must be
// numbers that floats hold exactly. Shaders convert floats by these functions, or say why a bare conversion is bounded
// (ShaderForm.FloatsAreClampedBeforeTheyBecomeIntegers). NaN is told by its bits, because compilers may turn
// comparisons around (lib/finite.glsl).
bvec4 isNumber(vec4 v) { return lessThanEqual(floatBitsToUint(v) & 0x7fffffffu, uvec4(0x7f800000u)); }

ivec4 clampedInt(vec4 v, ivec4 low, ivec4 high) {
  return ivec4(mix(vec4(low), clamp(v, vec4(low), vec4(high)), isNumber(v)));  // bounded: clamped, and no NaN
}
ivec3 clampedInt(vec3 v, ivec3 low, ivec3 high) { return clampedInt(v.xyzz, low.xyzz, high.xyzz).xyz; }
ivec2 clampedInt(vec2 v, ivec2 low, ivec2 high) { return clampedInt(v.xyxy, low.xyxy, high.xyxy).xy; }
int clampedInt(float v, int low, int high) { return clampedInt(vec4(v), ivec4(low), ivec4(high)).x; }
