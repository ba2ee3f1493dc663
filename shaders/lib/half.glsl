// Rounds values to 16-bit floats before they are stored. OpenGL leaves open how imageStore and packHalf2x16 round; a
// driver that truncates (llvmpipe) loses half a unit in the last place per store, always downwards. Every driver stores
// a value rounded here unchanged.

// To the nearest half, ties to even. Below 2^-14 halves are 2^-24 apart, so values there are rounded to multiples of
// 2^-24.
vec4 roundToHalf(vec4 value) {
  uvec4 bits = floatBitsToUint(value);
  vec4 normal = uintBitsToFloat((bits + 0xFFFu + ((bits >> 13) & 1u)) & ~0x1FFFu);
  return mix(normal, roundEven(value * 16777216.0) / 16777216.0, lessThan(abs(value), vec4(6.103515625e-5)));
}
